//! Writing a drawing as SVG through the backend of plotters.

use super::drawing::{Anchor, Drawing, Item, Turned};
use super::{Colour, palette, text};
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    FontStyle, FontTransform, IntoFont, RGBAColor, RGBColor, ShapeStyle, TextStyle,
};

/// The backend rounds to whole units: a twentieth of a point each.
const UNITS: f64 = 20.0;

/// Free space around the drawing, points.
const MARGIN: f64 = 2.0;

/// Fonts by falling preference; every system has one of them.
const FAMILY: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

/// The SVG backend divides font sizes by this, to match the bitmap backends.
const FONT_DIVISOR: f64 = 1.24;

/// The backend writes to a string, which cannot fail.
const TO_MEMORY: &str = "a string is written to";

/// A position in units of the backend.
type Coord = (i32, i32);

fn style(colour: Colour, width: f64) -> ShapeStyle {
    let [r, g, b] = colour.rgb;
    ShapeStyle {
        color: RGBAColor(r, g, b, colour.alpha),
        filled: true,
        stroke_width: (width * UNITS).round().max(1.0) as u32,
    }
}

impl Drawing {
    /// The drawing as an SVG document whose size is that of its contents; `title` is read by screen readers.
    pub(crate) fn to_svg(&self, title: &str) -> String {
        let bounds = self.bounds();
        let left = bounds.min[0] - MARGIN;
        let top = bounds.max[1] + MARGIN;
        let size = [
            bounds.width() + 2.0 * MARGIN,
            bounds.height() + 2.0 * MARGIN,
        ];
        let units = size.map(|s| (s * UNITS).ceil() as u32);
        let map = |p: &[f64; 2]| -> Coord {
            (
                ((p[0] - left) * UNITS).round() as i32,
                ((top - p[1]) * UNITS).round() as i32,
            )
        };
        let mut svg = String::new();
        let mut backend = SVGBackend::with_string(&mut svg, (units[0], units[1]));
        // White paper: dark lines on a dark viewer's page would vanish.
        let corner = (units[0] as i32, units[1] as i32);
        backend
            .draw_rect((0, 0), corner, &style(palette::WHITE, 0.0), true)
            .expect(TO_MEMORY);
        for item in &self.items {
            draw(&mut backend, item, &map);
        }
        backend.present().expect(TO_MEMORY);
        drop(backend);
        let head = format!("width=\"{}\" height=\"{}\" viewBox", units[0], units[1]);
        let points = units.map(|u| f64::from(u) / UNITS);
        let title = title
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('"', "&quot;");
        let replaced = format!(
            "width=\"{:.2}pt\" height=\"{:.2}pt\" role=\"img\" aria-label=\"{title}\" stroke-linecap=\"round\" \
             stroke-linejoin=\"round\" viewBox",
            points[0], points[1]
        );
        // The vertical positions given are baselines; full opacity and spaces at line ends need no words.
        let svg = svg
            .replacen(&head, &replaced, 1)
            .replace(" dy=\"0.5ex\"", "")
            .replace(" opacity=\"1\"", "")
            .replace(" \"/>", "\"/>");
        text::decode(&svg)
    }
}

fn draw(backend: &mut SVGBackend<'_>, item: &Item, map: &impl Fn(&[f64; 2]) -> Coord) {
    let written = match item {
        Item::Polygon { points, fill } => {
            backend.fill_polygon(points.iter().map(map), &style(*fill, 0.0))
        }
        Item::Line { points, stroke } => {
            let style = style(stroke.colour, stroke.width);
            match stroke.dash {
                None => backend.draw_path(points.iter().map(map), &style),
                Some(dash) => dashes(points, dash)
                    .iter()
                    .try_for_each(|piece| backend.draw_path(piece.iter().map(map), &style)),
            }
        }
        Item::Disc {
            centre,
            radius,
            fill,
        } => backend.draw_circle(
            map(centre),
            (radius * UNITS).round() as u32,
            &style(*fill, 0.0),
            true,
        ),
        Item::Text {
            at,
            text,
            size,
            anchor,
            colour,
            turned,
        } => {
            let [r, g, b] = colour.rgb;
            let h = match anchor {
                Anchor::Start => HPos::Left,
                Anchor::Middle => HPos::Center,
                Anchor::End => HPos::Right,
            };
            let transform = match turned {
                Turned::No => FontTransform::None,
                Turned::Upwards => FontTransform::Rotate270,
            };
            let colour = RGBColor(r, g, b);
            let font = (FAMILY, size * UNITS * FONT_DIVISOR, FontStyle::Normal)
                .into_font()
                .transform(transform);
            let style = TextStyle::from(font)
                .color(&colour)
                .pos(Pos::new(h, VPos::Center));
            backend.draw_text(&text::encode(text), &style, map(at))
        }
    };
    written.expect(TO_MEMORY);
}

/// Cuts a polyline into dashes.
fn dashes(points: &[[f64; 2]], [on, off]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    let mut drawing = true;
    let mut left = on;
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let p = [0, 1].map(|k| a[k] + (b[k] - a[k]) * done / length);
            if drawing {
                piece.push(p);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![p];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
        left -= length - done;
        if drawing {
            piece.push(b);
        }
    }
    if drawing && piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Stroke, Vertical, palette};

    #[test]
    fn size_follows_the_contents() {
        let mut d = Drawing::new();
        d.line(
            &[[10.0, 10.0], [110.0, 60.0]],
            Stroke::new(palette::INK, 1.0),
        );
        d.text(
            [60.0, 35.0],
            "~M~^{1} & more",
            9.0,
            Anchor::Middle,
            Vertical::Centre,
            palette::INK,
        );
        let svg = d.to_svg("A \"test\"");
        assert!(
            svg.contains("width=\"105.00pt\" height=\"55.00pt\""),
            "{svg}"
        );
        assert!(svg.contains("aria-label=\"A &quot;test&quot;\""), "{svg}");
        assert!(
            svg.contains("<tspan font-style=\"italic\">M</tspan>"),
            "{svg}"
        );
        assert!(svg.contains("&amp; more"), "{svg}");
        assert!(!svg.contains("0.5ex"), "{svg}");
    }

    #[test]
    fn dashes_cover_the_line_and_turn_corners() {
        let pieces = dashes(&[[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]], [2.0, 1.0]);
        assert_eq!(pieces.len(), 3);
        assert_eq!(pieces[0], vec![[0.0, 0.0], [2.0, 0.0]]);
        let total: f64 = pieces
            .iter()
            .flat_map(|p| p.windows(2))
            .map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]))
            .sum();
        assert!((total - 5.0).abs() < 1e-12, "{total}");
    }
}
