//! Writing a drawing as SVG.

use super::drawing::{Anchor, Drawing, Item, Turned};
use super::{Colour, palette, text};
use maud::{Markup, html};
use std::fmt::Write;

/// Free space around the drawing, points.
const MARGIN: f64 = 2.0;

/// Fonts by falling preference; every system has one of them.
const FAMILY: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

impl Drawing {
    /// The drawing as an SVG document whose size is that of its contents; `title` is read by screen readers.
    pub(crate) fn to_svg(&self, title: &str) -> String {
        let bounds = self.bounds();
        let (left, top) = (bounds.min[0] - MARGIN, bounds.max[1] + MARGIN);
        let [w, h] = [bounds.width(), bounds.height()].map(|s| s + 2.0 * MARGIN);
        let place = |p: &[f64; 2]| [p[0] - left, top - p[1]];
        let svg = html! {
            svg width=(format!("{w:.2}pt")) height=(format!("{h:.2}pt")) role="img" aria-label=(title)
                stroke-linecap="round" stroke-linejoin="round" font-family=(FAMILY)
                viewBox=(format!("0 0 {w:.2} {h:.2}")) xmlns="http://www.w3.org/2000/svg" {
                // White paper: dark lines on a dark viewer's page would vanish.
                rect width="100%" height="100%" fill=(rgb(palette::WHITE)) {}
                @for item in &self.items { (element(item, &place)) }
            }
        };
        svg.into_string() + "\n"
    }
}

fn rgb(colour: Colour) -> String {
    let [r, g, b] = colour.rgb;
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The opacity of a colour, unless it is full.
fn opacity(colour: Colour) -> Option<f64> {
    (colour.alpha < 1.0).then_some(colour.alpha)
}

/// The commands of a path through points.
fn path(points: &[[f64; 2]], place: &impl Fn(&[f64; 2]) -> [f64; 2]) -> String {
    let mut commands = String::new();
    for (k, [x, y]) in points.iter().map(place).enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(commands, "{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
    }
    commands
}

fn element(item: &Item, place: &impl Fn(&[f64; 2]) -> [f64; 2]) -> Markup {
    match item {
        Item::Polygon { points, fill } => html! {
            path d={ (path(points, place)) "Z" } fill=(rgb(*fill)) fill-opacity=[opacity(*fill)] {}
        },
        Item::Line { points, stroke } => html! {
            path d=(path(points, place)) fill="none" stroke=(rgb(stroke.colour)) stroke-width=(stroke.width)
                stroke-opacity=[opacity(stroke.colour)]
                stroke-dasharray=[stroke.dash.map(|[on, off]| format!("{on} {off}"))] {}
        },
        Item::Disc {
            centre,
            radius,
            fill,
        } => {
            let [x, y] = place(centre).map(|c| format!("{c:.2}"));
            html! { circle cx=(x) cy=(y) r=(format!("{radius:.2}")) fill=(rgb(*fill)) {} }
        }
        Item::Text {
            at,
            text,
            size,
            anchor,
            colour,
            turned,
        } => {
            let [x, y] = place(at).map(|c| format!("{c:.2}"));
            let anchor = match anchor {
                Anchor::Start => None,
                Anchor::Middle => Some("middle"),
                Anchor::End => Some("end"),
            };
            let turn = (*turned == Turned::Upwards).then(|| format!("rotate(-90 {x} {y})"));
            html! {
                text x=(x) y=(y) font-size=(size) fill=(rgb(*colour)) text-anchor=[anchor] transform=[turn] {
                    (text::markup(text, *size))
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Stroke, Vertical, palette};

    #[test]
    fn size_follows_the_contents() {
        let mut d = Drawing::new();
        let stroke = Stroke::new(palette::INK, 1.0);
        d.line(&[[10.0, 10.0], [110.0, 60.0]], stroke.dashed());
        d.label([60.0, 35.0], "~M~^{1} & more", palette::INK);
        let (at, ink) = ([60.0, 30.0], palette::INK);
        d.text(at, "x", 9.0, Anchor::End, Vertical::Centre, ink);
        let svg = d.to_svg("A \"test\"");
        for part in [
            "width=\"105.00pt\" height=\"55.00pt\"",
            "aria-label=\"A &quot;test&quot;\"",
            "<tspan font-style=\"italic\">M</tspan>",
            "&amp; more",
            "stroke-dasharray=\"2.6 2\"",
            "text-anchor=\"end\"",
        ] {
            assert!(svg.contains(part), "{part} is missing in {svg}");
        }
    }
}
