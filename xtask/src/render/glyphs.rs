//! Labels in pictures: the few letters they need, as strokes.

use super::canvas::{Image, Light};
use std::f64::consts::TAU;

/// A letter: its width and its strokes, in units of the height of digits, y upwards from the baseline.
struct Glyph {
    width: f64,
    strokes: Vec<Vec<[f64; 2]>>,
}

/// Points on an ellipse, angles in turns counter-clockwise from the right.
fn arc(cx: f64, cy: f64, rx: f64, ry: f64, from: f64, to: f64) -> Vec<[f64; 2]> {
    let n = 2 + (24.0 * (to - from).abs()) as usize;
    (0..=n)
        .map(|k| {
            let (s, c) = (TAU * (from + (to - from) * k as f64 / n as f64)).sin_cos();
            [cx + rx * c, cy + ry * s]
        })
        .collect()
}

fn joined(parts: &[&[[f64; 2]]]) -> Vec<[f64; 2]> {
    parts.concat()
}

fn glyph(c: char) -> Option<Glyph> {
    let digit = |strokes| {
        Some(Glyph {
            width: 0.56,
            strokes,
        })
    };
    match c {
        '0' => digit(vec![arc(0.28, 0.5, 0.25, 0.5, 0.0, 1.0)]),
        '1' => digit(vec![vec![[0.08, 0.78], [0.32, 1.0], [0.32, 0.0]]]),
        '2' => digit(vec![joined(&[
            &arc(0.28, 0.73, 0.24, 0.27, 0.45, -0.12),
            &[[0.04, 0.0], [0.54, 0.0]],
        ])]),
        '3' => digit(vec![
            arc(0.26, 0.75, 0.22, 0.25, 0.42, -0.25),
            arc(0.26, 0.26, 0.26, 0.26, 0.25, -0.42),
        ]),
        '4' => digit(vec![vec![
            [0.42, 0.0],
            [0.42, 1.0],
            [0.02, 0.3],
            [0.56, 0.3],
        ]]),
        '5' => digit(vec![joined(&[
            &[[0.5, 1.0], [0.12, 1.0], [0.08, 0.54]],
            &arc(0.26, 0.32, 0.27, 0.32, 0.36, -0.42),
        ])]),
        '6' => digit(vec![
            arc(0.28, 0.3, 0.25, 0.3, 0.0, 1.0),
            joined(&[&arc(0.30, 0.5, 0.27, 0.5, 0.17, 0.5), &[[0.03, 0.32]]]),
        ]),
        '7' => digit(vec![vec![[0.04, 1.0], [0.54, 1.0], [0.2, 0.0]]]),
        '8' => digit(vec![
            arc(0.28, 0.76, 0.21, 0.24, 0.0, 1.0),
            arc(0.28, 0.26, 0.26, 0.26, 0.0, 1.0),
        ]),
        '9' => digit(vec![
            arc(0.28, 0.7, 0.25, 0.3, 0.0, 1.0),
            joined(&[&[[0.53, 0.68]], &arc(0.26, 0.5, 0.27, 0.5, 0.0, -0.33)]),
        ]),
        '.' => Some(Glyph {
            width: 0.14,
            strokes: vec![vec![[0.07, 0.02], [0.07, 0.021]]],
        }),
        's' => Some(Glyph {
            width: 0.42,
            strokes: vec![joined(&[
                &arc(0.21, 0.49, 0.19, 0.17, 0.10, 0.72),
                &arc(0.20, 0.16, 0.20, 0.16, 0.22, -0.40),
            ])],
        }),
        ' ' => Some(Glyph {
            width: 0.2,
            strokes: Vec::new(),
        }),
        _ => None,
    }
}

/// Space between letters.
const GAP: f64 = 0.16;

/// Width of a label, in units of `size`, the height of its digits. Letters without a drawing are left out.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let widths: Vec<f64> = text.chars().filter_map(glyph).map(|g| g.width).collect();
    size * (widths.iter().sum::<f64>() + GAP * widths.len().saturating_sub(1) as f64)
}

/// Draws a label with the left end of its baseline at (x, y), pixels.
pub(super) fn write(image: &mut Image, text: &str, at: [f64; 2], size: f64, colour: Light) {
    let mut x = at[0];
    let radius = 0.065 * size;
    for glyph in text.chars().filter_map(glyph) {
        for stroke in &glyph.strokes {
            for pair in stroke.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|p| [x + size * p[0], at[1] - size * p[1]]);
                image.capsule(a, b, radius, colour);
            }
        }
        x += size * (glyph.width + GAP);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_digits_are_drawn_inside_their_width() {
        for c in "0123456789.s".chars() {
            let g = glyph(c).unwrap();
            assert!(!g.strokes.is_empty());
            for p in g.strokes.iter().flatten() {
                assert!((-0.02..=g.width + 0.02).contains(&p[0]), "{c}: {p:?}");
                assert!((-0.02..=1.02).contains(&p[1]), "{c}: {p:?}");
            }
        }
        assert!(width("0.25 s", 10.0) > width("0.2 s", 10.0));
    }
}
