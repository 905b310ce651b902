//! Pictures in a grid, with labels.

use super::canvas::{Image, light};
use super::glyphs;

/// A picture and the label below it.
#[derive(Clone, Debug)]
pub(crate) struct Labelled {
    pub(crate) image: Image,
    pub(crate) label: String,
}

/// Height of the labels' digits, pixels.
const LABEL: f64 = 27.0;

/// Height of the strip below each picture that holds its label, pixels.
const STRIP: usize = 84;

/// Pixels rendered for each pixel of the labels, each way.
const FINE: usize = 4;

/// Puts pictures of one size into rows of `columns`.
pub(crate) fn montage(frames: &[Labelled], columns: usize) -> Image {
    let [width, height] = frames
        .first()
        .map_or([1, 1], |f| [f.image.width, f.image.height]);
    let columns = columns.clamp(1, frames.len().max(1));
    let rows = frames.len().div_ceil(columns).max(1);
    let mut all = Image::white(width * columns, (height + STRIP) * rows);
    for (k, frame) in frames.iter().enumerate() {
        let (x, y) = (width * (k % columns), (height + STRIP) * (k / columns));
        all.paste(&frame.image, x, y);
        let mut strip = Image::white(width * FINE, STRIP * FINE);
        let size = LABEL * FINE as f64;
        let left = 0.5 * (strip.width as f64 - glyphs::width(&frame.label, size));
        glyphs::write(
            &mut strip,
            &frame.label,
            [left, 1.35 * size],
            size,
            light([34, 34, 34]),
        );
        all.paste(&strip.reduced(FINE), x, y + height);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_fill_rows() {
        let frame = Labelled {
            image: Image::white(60, 40),
            label: "0.10 s".into(),
        };
        let all = montage(&vec![frame; 5], 3);
        assert_eq!((all.width, all.height), (180, 2 * (40 + STRIP)));
        let dark = all.pixels.iter().filter(|p| p[0] < 0.5).count();
        assert!(dark > 5 * 20, "the labels are written: {dark} dark pixels");
    }
}
