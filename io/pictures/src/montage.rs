//! Pictures in a grid, with labels.

use super::canvas::Image;
use super::sheet::INK;
use super::text::Line;

/// A picture and the label below it.
#[derive(Clone, Debug)]
pub struct Labelled {
    /// The picture.
    pub image: Image,
    /// The label; none when empty.
    pub label: String,
}

/// Size of the labels, pixels: digits are 0.69 times as high in the built-in font.
const LABEL: f64 = 39.0;

/// Height of the strip below each picture that holds its label, pixels.
const STRIP: usize = 84;

/// Where the base line of labels is, as part of the height of the strip.
const BASE: f64 = 0.43;

impl Image {
    /// The picture made smaller by averaging squares of `n` x `n` pixels.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn reduced(&self, n: usize) -> Self {
        let mut out = Self::white(self.width / n, self.height / n);
        let weight = 1.0 / (n * n) as f32;
        for y in 0..out.height {
            for x in 0..out.width {
                let mut sum = [0.0; 3];
                for row in 0..n {
                    let start = (y * n + row) * self.width + x * n;
                    for p in &self.pixels[start..start + n] {
                        for k in 0..3 {
                            sum[k] += p[k];
                        }
                    }
                }
                out.pixels[y * out.width + x] = sum.map(|s| s * weight);
            }
        }
        out
    }
}

/// Puts pictures of one size into rows of `columns`.
pub fn montage(frames: &[Labelled], columns: usize) -> Image {
    let [width, height] = frames.first().map_or([1, 1], |f| f.image.size());
    let columns = columns.clamp(1, frames.len().max(1));
    let rows = frames.len().div_ceil(columns).max(1);
    let mut all = Image::white(width * columns, (height + STRIP) * rows);
    for (k, frame) in frames.iter().enumerate() {
        let (x, y) = (width * (k % columns), (height + STRIP) * (k / columns));
        all.paste(&frame.image, x, y);
        if !frame.label.is_empty() {
            all.paste(&label(&frame.label, width), x, y + height);
        }
    }
    all
}

/// Part of the width of a picture that its label has at most.
const FILLED: f64 = 0.94;

/// The strip below a picture; letters are smaller where they would not fit.
fn label(text: &str, width: usize) -> Image {
    let fits = FILLED * width as f64;
    let wide = Line::new(text, LABEL).width;
    let line = Line::new(text, LABEL * (fits / wide).min(1.0));
    let mut strip = Image::white(width, STRIP);
    let left = 0.5 * (width as f64 - line.width);
    line.draw(&mut strip, [left, BASE * STRIP as f64], INK);
    strip
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_fill_rows() {
        let frame = Labelled {
            image: Image::white(60, 40),
            label: "0 < s".into(),
        };
        let all = montage(&vec![frame; 5], 3);
        assert_eq!((all.width, all.height), (180, 2 * (40 + STRIP)));
        let dark = all.pixels.iter().filter(|p| p[0] < 0.5).count();
        assert!(dark > 5 * 20, "the labels are written: {dark} dark pixels");
    }

    #[test]
    fn long_labels_are_whole_and_short_ones_are_large() {
        let ink = |text: &str| {
            let image = label(text, 480);
            let inked = |x: &usize| (0..STRIP).any(|y| image.pixels[y * 480 + x] != [1.0; 3]);
            let columns: Vec<usize> = (0..480).filter(inked).collect();
            (columns[0], columns[columns.len() - 1])
        };
        let (left, right) = ink("a cloth that is pulled from under a vase");
        assert!((440..=452).contains(&(right - left)), "{left} to {right}");
        let (left, right) = ink("a vase");
        let wide = Line::new("a vase", LABEL).width;
        assert!(
            ((right - left) as f64 - wide).abs() < 0.1 * wide,
            "{left} to {right}"
        );
    }
}
