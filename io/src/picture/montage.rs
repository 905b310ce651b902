//! Pictures in a grid, with labels.

use super::canvas::Image;
use super::error::PictureError;
use super::vector_drawing;

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

    /// The number of columns from the first to the last that is not white.
    fn ink_width(&self) -> usize {
        let rows = self.pixels.chunks_exact(self.width.max(1));
        let inked = |x: &usize| rows.clone().any(|row| row[*x] != [1.0; 3]);
        let mut columns = (0..self.width).filter(inked);
        let first = columns.next();
        first.map_or(0, |first| columns.next_back().unwrap_or(first) + 1 - first)
    }

    /// Copies another picture in, its upper left corner at (x, y).
    fn paste(&mut self, other: &Self, x: usize, y: usize) {
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let width = other.width.min(self.width.saturating_sub(x));
            let to = (y + row) * self.width + x;
            self.pixels[to..to + width]
                .copy_from_slice(&other.pixels[row * other.width..row * other.width + width]);
        }
    }
}

/// Puts pictures of one size into rows of `columns`.
///
/// # Errors
/// [`PictureError::Options`] for pictures without pixels.
pub fn montage(frames: &[Labelled], columns: usize) -> Result<Image, PictureError> {
    let [width, height] = frames.first().map_or([1, 1], |f| f.image.size());
    let columns = columns.clamp(1, frames.len().max(1));
    let rows = frames.len().div_ceil(columns).max(1);
    let mut all = Image::white(width * columns, (height + STRIP) * rows);
    for (k, frame) in frames.iter().enumerate() {
        let (x, y) = (width * (k % columns), (height + STRIP) * (k / columns));
        all.paste(&frame.image, x, y);
        if !frame.label.is_empty() {
            all.paste(&label(&frame.label, width)?, x, y + height);
        }
    }
    Ok(all)
}

/// Part of the width of a picture that its label has at most.
const FILLED: f64 = 0.94;

/// The strip below a picture; letters are smaller where they would not fit.
fn label(text: &str, width: usize) -> Result<Image, PictureError> {
    // No letter is wider than it is high.
    let room = width.max((LABEL * text.chars().count() as f64) as usize);
    let wide = strip(text, room, LABEL)?.ink_width() as f64;
    let fits = FILLED * width as f64;
    strip(text, width, LABEL * (fits / wide).min(1.0))
}

/// A strip with a text in its middle, in letters of a size, pixels.
fn strip(text: &str, width: usize, size: f64) -> Result<Image, PictureError> {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    vector_drawing::image(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{STRIP}\"><text x=\"{}\" y=\"{}\" \
         font-size=\"{size}\" text-anchor=\"middle\" font-family=\"sans-serif\" fill=\"#222222\">{text}</text></svg>",
        0.5 * width as f64,
        0.43 * STRIP as f64
    ))
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
        let all = montage(&vec![frame; 5], 3).unwrap();
        assert_eq!((all.width, all.height), (180, 2 * (40 + STRIP)));
        let dark = all.pixels.iter().filter(|p| p[0] < 0.5).count();
        assert!(dark > 5 * 20, "the labels are written: {dark} dark pixels");
    }

    #[test]
    fn long_labels_are_whole_and_short_ones_are_large() {
        let text = "a cloth that is pulled from under a vase";
        let long = label(text, 480).unwrap();
        assert!(
            (440..=452).contains(&long.ink_width()),
            "{}",
            long.ink_width()
        );
        let short = label("a vase", 480).unwrap();
        assert_eq!(short.pixels, strip("a vase", 480, LABEL).unwrap().pixels);
        assert!((80..200).contains(&short.ink_width()));
    }
}
