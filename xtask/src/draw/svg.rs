//! Writing a drawing as SVG, and as PNG: the SVG file, rasterised with a font that comes with the program.

use super::drawing::{Anchor, Drawing, Item};
use super::{Colour, palette};
use anyhow::Result;
use isosheet_pictures::svg_to_png;
use maud::{Markup, html};

/// Free space around the drawing, points.
const MARGIN: f64 = 2.0;

/// Fonts by falling preference; every system has one of them.
pub(super) const FAMILY: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

/// Pixels of a PNG file for a pixel of the SVG file, of which there are 96 to the inch: 216 to the inch,
/// enough for print in a column.
const SCALE: f32 = 216.0 / 96.0;

/// What is written as SVG: drawings and charts.
pub(crate) trait Vector {
    /// An SVG document as part of a page, larger by a factor; `title` is read by screen readers.
    fn document(&self, title: &str, factor: f64) -> Markup;

    /// An SVG file, in the size that the drawing has of its own.
    fn to_svg(&self, title: &str) -> String {
        self.document(title, 1.0).into_string()
    }

    /// A PNG file.
    ///
    /// No fonts of the system are used, so that equal drawings give equal files everywhere.
    fn to_png(&self, title: &str) -> Result<Vec<u8>> {
        Ok(svg_to_png(&self.to_svg(title), SCALE)?)
    }
}

/// The size of a document is that of its contents.
impl Vector for Drawing {
    fn document(&self, title: &str, factor: f64) -> Markup {
        let bounds = self.bounds();
        let corner = [bounds.min[0] - MARGIN, bounds.max[1] + MARGIN];
        let size = [bounds.width(), bounds.height()].map(|s| s + 2.0 * MARGIN);
        let place = |p: &[f64; 2]| [p[0] - corner[0], corner[1] - p[1]];
        let items = html! { @for item in &self.items { (element(item, &place)) } };
        paper(title, (size, factor), size, &items)
    }
}

/// A document of a size in points, enlarged by a factor, with contents that fill `seen` in units of their
/// own.
pub(super) fn paper(
    title: &str,
    (size, factor): ([f64; 2], f64),
    seen: [f64; 2],
    contents: &Markup,
) -> Markup {
    let [width, height] = size.map(|s| format!("{:.2}pt", factor * s));
    let seen = format!("0 0 {:.2} {:.2}", seen[0], seen[1]);
    html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(width) height=(height) role="img" aria-label=(title)
            viewBox=(seen) font-family=(FAMILY) fill="none" stroke-linecap="round" stroke-linejoin="round" {
            // White paper: dark lines on a dark viewer's page would vanish.
            rect width="100%" height="100%" fill=(hex(palette::WHITE)) {}
            (contents)
        }
    }
}

/// A length to a hundredth of a point.
fn points(length: f64) -> String {
    let text = format!("{length:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn hex(Colour { rgb: [r, g, b], .. }: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The opacity of a colour that is not opaque.
fn opacity(colour: Colour) -> Option<f64> {
    (colour.alpha < 1.0).then_some(colour.alpha)
}

/// An item whose points are where `place` says, y downwards.
fn element(item: &Item, place: &impl Fn(&[f64; 2]) -> [f64; 2]) -> Markup {
    let path = |path: &[[f64; 2]]| {
        let places = path.iter().map(place);
        let places = places.map(|[x, y]| format!("{},{}", points(x), points(y)));
        places.collect::<Vec<_>>().join(" ")
    };
    match item {
        Item::Polygon { points, fill } => html! {
            polygon points=(path(points)) fill=(hex(*fill)) fill-opacity=[opacity(*fill)] {}
        },
        Item::Line {
            points: line,
            stroke,
        } => {
            let colour = stroke.colour;
            let dash = stroke.dash.map(|[on, off]| format!("{on} {off}"));
            html! {
                polyline points=(path(line)) stroke=(hex(colour)) stroke-opacity=[opacity(colour)]
                    stroke-width=(stroke.width) stroke-dasharray=[dash] {}
            }
        }
        Item::Disc {
            centre,
            radius,
            fill,
        } => {
            let [x, y] = place(centre).map(points);
            html! { circle cx=(x) cy=(y) r=(points(*radius)) fill=(hex(*fill)) fill-opacity=[opacity(*fill)] {} }
        }
        Item::Text {
            at,
            text,
            size,
            anchor,
            colour,
        } => {
            let [x, y] = place(at).map(points);
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
            };
            html! {
                text x=(x) y=(y) font-size=(size) text-anchor=(anchor) fill=(hex(*colour)) fill-opacity=[opacity(*colour)] { (text) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Stroke, Vertical};

    #[test]
    fn size_follows_the_contents() {
        let mut d = Drawing::new();
        let line = [[10.0, 10.0], [110.0, 60.0]];
        d.line(&line, Stroke::new(palette::INK, 1.0).dashed());
        let (text, middle) = ("v₁ᵗ & more", Anchor::Middle);
        d.text(
            [60.0, 35.0],
            text,
            10.0,
            middle,
            Vertical::Centre,
            palette::INK,
        );
        let svg = d.to_svg("A \"test\"");
        for part in [
            "width=\"105.00pt\" height=\"55.00pt\"",
            "aria-label=\"A &quot;test&quot;\"",
            "<polyline points=\"2.5,52.5 102.5,2.5\"",
            "stroke-dasharray=\"2.6 2\"",
            ">v₁ᵗ &amp; more</text>",
        ] {
            assert!(svg.contains(part), "{part} is missing in {svg}");
        }
    }

    #[test]
    fn shapes_and_letters_leave_ink() {
        let dark = |d: &Drawing| {
            let bytes = d.to_png("t").unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
                .read_info()
                .unwrap();
            let mut data = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut data).unwrap();
            assert_eq!(info.color_type, png::ColorType::Rgb);
            let ink = data.chunks(3).filter(|p| p[0] < 128).count();
            (ink, info.width * info.height)
        };
        let mut d = Drawing::new();
        let square = [[0.0, 0.0], [50.0, 0.0], [50.0, 40.0], [0.0, 40.0]];
        d.polygon(&square, palette::WHITE);
        let (none, size) = dark(&d);
        assert_eq!((none, size), (0, 162 * 132));
        let mut letters = d.clone();
        letters.label([25.0, 20.0], "M² − ε", palette::INK);
        let (some, _) = dark(&letters);
        assert!(some > 100, "{some} dark pixels");
        d.polygon(&square[..3], palette::INK);
        let (half, _) = dark(&d);
        assert!(half.abs_diff(75 * 120) < 400, "{half} dark pixels");
    }
}
