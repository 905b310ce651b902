//! Charts: one panel each, with axes, series, a legend to the right, and marks of runs without a value.

use super::{
    Anchor, Axis, Colour, Drawing, Marker, SMALL, Series, Stroke, TEXT, Vertical, palette, text,
};

/// Heights above the axes of the line of runs without a value and of the title, points.
const NOT_ENDED: f64 = 13.0;
const TITLE: f64 = 9.0;

/// A run without a value, such as one that did not end: a mark above the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Missing {
    /// Where on the horizontal axis it is.
    pub(crate) x: f64,
    /// How far beside that place the mark is drawn, points.
    pub(crate) beside: f64,
    pub(crate) colour: Colour,
    pub(crate) marker: Marker,
}

/// Where the names of the series are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Legend {
    None,
    /// To the right of the chart.
    Right,
}

/// Axes and what is drawn in them.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    /// Written above; none when empty.
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Size of the area inside the axes, points.
    pub(crate) size: [f64; 2],
    /// Points outside the vertical axis are left out.
    pub(crate) series: Vec<Series>,
    /// Runs without a value, on a line above the axes; without it there is no such line.
    pub(crate) missing: Option<Vec<Missing>>,
    pub(crate) legend: Legend,
}

impl Chart {
    /// A chart with a legend and without a title.
    pub(crate) fn new(x: Axis, y: Axis, size: [f64; 2], series: Vec<Series>) -> Self {
        Self {
            title: String::new(),
            x,
            y,
            size,
            series,
            missing: None,
            legend: Legend::Right,
        }
    }

    /// A chart with logarithmic axes that hold all points; values that are not positive are left out.
    pub(crate) fn log_log(x: &str, y: &str, size: [f64; 2], series: Vec<Series>) -> Self {
        let x = Axis::holding(x, values(&series, 0));
        let y = Axis::holding(y, values(&series, 1));
        Self::new(x, y, size, series)
    }

    /// A chart with a linear axis from 0 and a logarithmic one that hold all points; values that are not
    /// positive are left out.
    pub(crate) fn semi_log(x: &str, y: &str, size: [f64; 2], series: Vec<Series>) -> Self {
        let high = values(&series, 0).fold(f64::MIN_POSITIVE, f64::max);
        let x = Axis::round(x, [0.0, high], 5);
        let y = Axis::holding(y, values(&series, 1));
        Self::new(x, y, size, series)
    }

    /// The same with a title.
    pub(crate) fn titled(self, title: impl Into<String>) -> Self {
        let title = title.into();
        Self { title, ..self }
    }

    /// The same with the legend elsewhere.
    pub(crate) fn with_legend(self, legend: Legend) -> Self {
        Self { legend, ..self }
    }

    /// The same with a line of runs without a value.
    pub(crate) fn with_missing(self, missing: Vec<Missing>) -> Self {
        let missing = Some(missing);
        Self { missing, ..self }
    }

    /// The drawing, its origin at the lower left corner of the area inside the axes.
    pub(crate) fn draw(&self) -> Drawing {
        let mut d = Drawing::new();
        self.axes(&mut d);
        for s in &self.series {
            let on_axis = s.points.iter().filter(|p| self.y.holds(p[1]));
            let points: Vec<[f64; 2]> = on_axis.map(|p| self.place(*p)).collect();
            s.draw(&mut d, &points, &points);
        }
        if self.legend == Legend::Right {
            self.names(&mut d);
        }
        let ([width, mut top], ink) = (self.size, palette::INK);
        if let Some(missing) = &self.missing {
            top += NOT_ENDED;
            self.not_ended(&mut d, missing);
        }
        if !self.title.is_empty() {
            let (at, middle) = ([0.5 * width, top + TITLE], Anchor::Middle);
            d.text(at, &self.title, TEXT, middle, Vertical::Above, ink);
        }
        d
    }

    /// Where a point is in the drawing.
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [w, h] = self.size;
        [w * self.x.part(x), h * self.y.part(y)]
    }

    /// Lines, ticks and labels of the axes.
    fn axes(&self, d: &mut Drawing) {
        let ([w, h], ink) = (self.size, palette::INK);
        let frame = Stroke::new(ink, 0.6);
        let grid = Stroke::new(palette::PALE, 0.4);
        for (value, text) in &self.x.ticks {
            let x = self.x.part(*value) * w;
            d.line(&[[x, 0.0], [x, -3.0]], frame);
            d.text([x, -5.0], text, SMALL, Anchor::Middle, Vertical::Below, ink);
        }
        let mut widest: f64 = 0.0;
        for (value, text) in &self.y.ticks {
            let y = self.y.part(*value) * h;
            d.line(&[[0.0, y], [w, y]], grid);
            d.line(&[[0.0, y], [-3.0, y]], frame);
            d.text([-5.0, y], text, SMALL, Anchor::End, Vertical::Centre, ink);
            widest = widest.max(text::width(text, SMALL));
        }
        d.line(&[[0.0, h], [0.0, 0.0], [w, 0.0]], frame);
        let (at, below) = ([0.5 * w, -17.0], Vertical::Below);
        d.text(at, &self.x.label, TEXT, Anchor::Middle, below, ink);
        d.text_upwards([-12.0 - widest, 0.5 * h], &self.y.label, TEXT, ink);
    }

    /// The legend.
    fn names(&self, d: &mut Drawing) {
        let [w, h] = self.size;
        let named = self.series.iter().filter(|s| !s.name.is_empty());
        for (k, s) in named.enumerate() {
            let y = h - 6.0 - 12.5 * k as f64;
            let (a, b) = (w + 14.0, w + 32.0);
            s.draw(d, &[[a, y], [b, y]], &[[0.5 * (a + b), y]]);
            let (at, start, ink) = ([b + 5.0, y], Anchor::Start, palette::INK);
            d.text(at, &s.name, SMALL, start, Vertical::Centre, ink);
        }
    }

    /// The line above the axes with the runs without a value.
    fn not_ended(&self, d: &mut Drawing, missing: &[Missing]) {
        let ([width, height], grey) = (self.size, palette::GREY);
        let y = height + NOT_ENDED;
        d.line(&[[0.0, y], [width, y]], Stroke::new(grey, 0.5).dashed());
        let (at, centre) = ([-4.0, y], Vertical::Centre);
        d.text(at, "no value", 6.0, Anchor::End, centre, grey);
        let rim = Stroke::new(palette::WHITE, 0.4);
        for m in missing {
            let x = width * self.x.part(m.x) + m.beside;
            m.marker.draw(d, [x, y], 1.8, m.colour, rim);
        }
    }
}

/// One coordinate of all points.
fn values(series: &[Series], k: usize) -> impl Iterator<Item = f64> + '_ {
    let of = move |s: &Series| s.points.iter().map(|p| p[k]).collect::<Vec<_>>();
    series.iter().flat_map(of)
}
