//! Charts by plotters: axes, ticks, series, error bars, a legend to the right.

use super::axis::Axis;
use super::colour::{Colour, palette};
use super::marker::Marker;
use super::series::Series;
use super::svg::{FAMILY, Vector, paper};
use super::text::{SMALL, TEXT};
use maud::{Markup, PreEscaped};
use plotters::backend::SVGBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{EmptyElement, PathElement, Polygon};
use plotters::prelude::{DashedLineSeries, LineSeries, SeriesLabelPosition};
use plotters::style::{Color, IntoFont, RGBAColor, ShapeStyle, TextStyle};
use std::error::Error;

/// Units of the backend, which rounds to whole ones, for a point.
const UNITS: f64 = 10.0;

/// The SVG backend divides sizes of fonts by this.
const FONT_DIVISOR: f64 = 1.24;

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
    title: String,
    x: Axis,
    y: Axis,
    /// Size of the area inside the axes, points.
    size: [f64; 2],
    /// Points outside the vertical axis are left out.
    series: Vec<Series>,
    legend: Legend,
}

/// Charts in rows.
#[derive(Clone, Debug)]
pub(crate) struct Charts(pub(crate) Vec<Vec<Chart>>);

/// Sizes of what is around the area inside the axes, points: labels of the axes, title, free room (also
/// around all charts), and what a legend needs besides its lines and names.
const LEFT: f64 = 42.0;
const BELOW: f64 = 28.0;
const TITLE: f64 = 14.0;
const ROOM: f64 = 8.0;
const LEGEND: f64 = 26.0;

/// Length of the lines of a legend, points.
const SAMPLE: f64 = 18.0;

/// Lengths of dashes and of the gaps between them, points.
const DASH: [f64; 2] = [2.6, 2.0];

/// The largest number of ticks that plotters chooses for an axis.
const TICKS: usize = 7;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn Error>>;

impl Chart {
    /// A chart with a legend and without a title.
    pub(crate) fn new(x: Axis, y: Axis, size: [f64; 2], series: Vec<Series>) -> Self {
        Self {
            title: String::new(),
            x,
            y,
            size,
            series,
            legend: Legend::Right,
        }
    }

    /// A chart with logarithmic axes that hold all points; values that are not positive are left out.
    pub(crate) fn log_log(x: &str, y: &str, size: [f64; 2], series: Vec<Series>) -> Self {
        let x = Axis::decades(x, values(&series, 0));
        let y = Axis::decades(y, values(&series, 1));
        Self::new(x, y, size, series)
    }

    /// This chart with a title.
    pub(crate) fn titled(self, title: impl Into<String>) -> Self {
        let title = title.into();
        Self { title, ..self }
    }

    /// This chart with the legend at another place.
    pub(crate) fn with_legend(self, legend: Legend) -> Self {
        Self { legend, ..self }
    }

    /// Height of the title, points.
    fn above(&self) -> f64 {
        if self.title.is_empty() { 0.0 } else { TITLE }
    }

    /// Width to the right of the area inside the axes, points.
    fn beside(&self) -> f64 {
        let lengths = self.named().map(|s| s.name.chars().count());
        // Letters are about half as wide as high.
        let legend = |n| LEGEND + SAMPLE + 0.53 * SMALL * n as f64;
        lengths.max().map_or(2.0 * ROOM, legend)
    }

    /// Size with everything around the axes, points.
    fn outer(&self) -> [f64; 2] {
        let [w, h] = self.size;
        [LEFT + w + self.beside(), self.above() + ROOM + h + BELOW]
    }

    /// The series of the legend.
    fn named(&self) -> impl Iterator<Item = &Series> {
        let has_legend = self.legend == Legend::Right;
        let is_named = move |s: &&Series| has_legend && !s.name.is_empty();
        self.series.iter().filter(is_named)
    }

    fn draw(&self, area: &Area<'_>) -> Drawn {
        let title = units(self.above());
        let (head, body) = area.split_vertically(title);
        if !self.title.is_empty() {
            let size = (units(self.size[0]), title);
            let middle = head.shrink((units(LEFT), 0), size);
            middle.titled(&self.title, font(TEXT, palette::INK))?;
        }
        let (left, side) = body.split_horizontally(units(LEFT + self.size[0] + ROOM));
        let mut chart = ChartBuilder::on(&left)
            .margin_top(units(ROOM))
            .margin_right(units(ROOM))
            .y_label_area_size(units(LEFT))
            .x_label_area_size(units(BELOW))
            .build_cartesian_2d(self.x.clone(), self.y.clone())?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .max_light_lines(0)
            .x_labels(TICKS)
            .y_labels(TICKS)
            .set_all_tick_mark_size(units(3.0))
            .bold_line_style(stroke(palette::PALE, 0.4))
            .axis_style(stroke(palette::INK, 0.6))
            .label_style(font(SMALL, palette::INK))
            .axis_desc_style(font(TEXT, palette::INK))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .draw()?;
        for s in &self.series {
            let holds = |p: &&[f64; 2]| self.x.holds(p[0]) && self.y.holds(p[1]);
            let points = s.points.iter().filter(holds).map(|p| (p[0], p[1]));
            let (look, line) = (s.look(), stroke(s.colour, 1.1));
            if s.is_dashed {
                let [on, off] = DASH.map(units);
                chart.draw_series(DashedLineSeries::new(points.clone(), on, off, line))?;
            } else {
                chart.draw_series(LineSeries::new(points.clone(), line))?;
            }
            let bars = s.points.iter().zip(&s.bars);
            let bars = bars.filter(|(p, [low, high])| {
                self.x.holds(p[0]) && self.y.holds(*low) && self.y.holds(*high)
            });
            let thin = stroke(s.colour, 0.7);
            for (p, [low, high]) in bars {
                let ends = [(p[0], *low), (p[0], *high)];
                chart.draw_series([PathElement::new(ends, thin)])?;
                let half = units(1.6);
                let cap = || PathElement::new([(-half, 0), (half, 0)], thin);
                chart.draw_series(ends.map(|end| EmptyElement::at(end) + cap()))?;
            }
            let marked = points.filter(|_| s.marker.is_some()).map(|p| {
                let [rim, inside] = look.symbol(2.4);
                EmptyElement::at(p) + rim + inside
            });
            chart.draw_series(marked)?;
        }
        self.draw_legend(&side)
    }

    /// The names of the series in an area beside the axes.
    fn draw_legend(&self, side: &Area<'_>) -> Drawn {
        if self.named().next().is_none() {
            return Ok(());
        }
        let axis = || 0.0..1.0;
        let mut legend = ChartBuilder::on(side).build_cartesian_2d(axis(), axis())?;
        for s in self.named() {
            let (look, none) = (s.look(), Vec::<PathElement<(f64, f64)>>::new());
            legend
                .draw_series(none)?
                .label(&s.name)
                .legend(move |(x, y)| {
                    let ([rim, inside], [start, end]) = (look.symbol(2.4), look.sample());
                    let middle = (x + units(0.5 * SAMPLE), y);
                    EmptyElement::at(middle) + start + end + rim + inside
                });
        }
        legend
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .margin(units(2.0))
            .legend_area_size(units(SAMPLE + 4.0))
            .label_font(font(SMALL, palette::INK))
            .draw()?;
        Ok(())
    }
}

/// How a series looks.
#[derive(Clone, Copy, Debug)]
struct Look {
    colour: Colour,
    marker: Option<Marker>,
    is_dashed: bool,
}

impl Series {
    fn look(&self) -> Look {
        Look {
            colour: self.colour,
            marker: self.marker,
            is_dashed: self.is_dashed,
        }
    }
}

impl Look {
    /// The symbol, a white rim below it; invisible without a marker.
    fn symbol(self, radius: f64) -> [Polygon<(i32, i32)>; 2] {
        let of = |radius: f64, colour: Colour| {
            let corners = self.marker.unwrap_or(Marker::Disc).corners(radius);
            let corners = corners.into_iter().map(|[x, y]| (units(x), units(-y)));
            let alpha = self.marker.map_or(0.0, |_| colour.alpha);
            Polygon::new(corners.collect::<Vec<_>>(), rgba(colour.alpha(alpha)))
        };
        [of(radius + 0.5, palette::WHITE), of(radius, self.colour)]
    }

    /// The two halves of the line in a legend.
    fn sample(self) -> [PathElement<(i32, i32)>; 2] {
        let gap = if self.is_dashed { 0.15 } else { 0.0 };
        let line = stroke(self.colour, 1.1);
        let halves = [[-0.5, -gap], [gap, 0.5]];
        halves.map(|ends| PathElement::new(ends.map(|x| (units(x * SAMPLE), 0)), line))
    }
}

impl Charts {
    /// Charts side by side.
    pub(crate) fn row(charts: impl IntoIterator<Item = Chart>) -> Self {
        Self(vec![charts.into_iter().collect()])
    }

    fn draw(&self, svg: &mut String) -> Result<[f64; 2], Box<dyn Error>> {
        let height = |row: &Vec<Chart>| row.iter().map(|c| c.outer()[1]).fold(0.0, f64::max);
        let width = |row: &Vec<Chart>| row.iter().map(|c| c.outer()[0]).sum();
        let size = [
            self.0.iter().map(width).fold(1.0, f64::max),
            self.0
                .iter()
                .map(|row| height(row) + ROOM)
                .sum::<f64>()
                .max(1.0),
        ];
        let size = size.map(|s| s + 2.0 * ROOM);
        let [w, h] = size.map(|s| units(s) as u32);
        let root = SVGBackend::with_string(svg, (w, h)).into_drawing_area();
        let mut y = ROOM;
        for row in &self.0 {
            let mut x = ROOM;
            for chart in row {
                let outer = chart.outer();
                let [x0, y0, w, h] = [x, y, outer[0], outer[1]].map(units);
                chart.draw(&root.clone().shrink((x0, y0), (w, h)))?;
                x += outer[0];
            }
            y += height(row) + ROOM;
        }
        root.present()?;
        Ok(size)
    }
}

impl From<Chart> for Charts {
    fn from(chart: Chart) -> Self {
        Self::row([chart])
    }
}

impl Vector for Charts {
    fn document(&self, title: &str, factor: f64) -> Markup {
        let mut svg = String::new();
        let drawn = self.draw(&mut svg);
        // The backend writes to memory, and sizes of texts are estimated without fonts.
        let size = drawn.expect("nothing that can fail is asked of the backend");
        paper(
            title,
            (size, factor),
            size.map(|s| f64::from(units(s))),
            &PreEscaped(svg),
        )
    }
}

fn units(points: f64) -> i32 {
    (points * UNITS).round() as i32
}

fn rgba(
    Colour {
        rgb: [r, g, b],
        alpha,
    }: Colour,
) -> RGBAColor {
    RGBAColor(r, g, b, alpha)
}

fn stroke(colour: Colour, width: f64) -> ShapeStyle {
    rgba(colour).stroke_width(units(width) as u32)
}

fn font(size: f64, colour: Colour) -> TextStyle<'static> {
    let font = (FAMILY, size * UNITS * FONT_DIVISOR).into_font();
    TextStyle {
        color: rgba(colour).to_backend_color(),
        ..font.into()
    }
}

/// One coordinate of all points.
fn values(series: &[Series], k: usize) -> impl Iterator<Item = f64> + '_ {
    series
        .iter()
        .flat_map(move |s| s.points.iter().map(move |p| p[k]))
}
