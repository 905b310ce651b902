//! SVG files that are written.

use crate::stroke::{LAYERS, MILLIMETRES, Stroke, bounds, of_class};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The width of lines, and the margin around them, millimetres.
const WIDTH: f64 = 0.2;
const MARGIN: f64 = 5.0;

/// The text of a drawing with a layer for each class of lines.
pub(crate) fn text(lines: &[Stroke]) -> String {
    let [x, y] = bounds(lines).map(|range| range.map(|c| MILLIMETRES * c));
    let [width, height] = [x, y].map(|[low, high]| high - low + 2.0 * MARGIN);
    // Thirteen digits of the longer side: the others are round-off.
    let digits = 13.0 - width.max(height).log10().ceil();
    let digits = digits.max(0.0) as usize;
    let number = |value: f64| {
        let text = format!("{value:.digits$}");
        let text = if digits > 0 {
            text.trim_end_matches('0').trim_end_matches('.')
        } else {
            &text
        };
        if text == "-0" {
            "0".to_owned()
        } else {
            text.to_owned()
        }
    };
    let [width, height] = [width, height].map(number);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"{width}mm\" \
         height=\"{height}mm\" viewBox=\"0 0 {width} {height}\" fill=\"none\" stroke-width=\"{WIDTH}\">\n"
    );
    // Of the page y runs downwards.
    let place = |p: &[f64; 2]| {
        let [px, py] = p.map(|c| MILLIMETRES * c);
        format!(
            "{} {}",
            number(px - x[0] + MARGIN),
            number(y[1] - py + MARGIN)
        )
    };
    for (class, name, colour, _) in LAYERS {
        // Lines of one opacity are one path.
        let mut paths: BTreeMap<u64, String> = BTreeMap::new();
        for line in of_class(lines, class) {
            let path = paths.entry(line.opacity().to_bits()).or_default();
            let drawn = match line.is_closed() {
                true => &line.points[..line.points.len() - 1],
                false => &line.points[..],
            };
            for (k, p) in drawn.iter().enumerate() {
                let letter = if k == 0 { 'M' } else { 'L' };
                let _ = write!(path, "{letter}{}", place(p));
            }
            path.push_str(if line.is_closed() { "Z" } else { "" });
        }
        if paths.is_empty() {
            continue;
        }
        let [r, g, b] = colour.0;
        let _ = writeln!(
            text,
            "  <g id=\"{name}\" inkscape:groupmode=\"layer\" inkscape:label=\"{name}\" \
             stroke=\"#{r:02x}{g:02x}{b:02x}\">"
        );
        for (opacity, path) in paths {
            let opacity = match f64::from_bits(opacity) {
                1.0 => String::new(),
                part => format!(" stroke-opacity=\"{part}\""),
            };
            let _ = writeln!(text, "    <path{opacity} d=\"{path}\"/>");
        }
        text.push_str("  </g>\n");
    }
    text.push_str("</svg>\n");
    text
}
