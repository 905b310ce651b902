//! Writing a drawing as PNG: its SVG file, rasterised with a font that comes with the program.

use super::drawing::Drawing;
use anyhow::Result;
use isosheet_io::picture::svg_to_png;

/// Pixels for a pixel of the SVG file, of which there are 96 to the inch: 216 to the inch, enough for print
/// in a column.
const SCALE: f32 = 216.0 / 96.0;

impl Drawing {
    /// The drawing as a PNG file; `title` as for [`Drawing::to_svg`].
    ///
    /// No fonts of the system are used, so that equal drawings give equal files everywhere.
    pub(crate) fn to_png(&self, title: &str) -> Result<Vec<u8>> {
        Ok(svg_to_png(&self.to_svg(title), SCALE)?)
    }
}

#[cfg(test)]
mod tests {
    use crate::draw::{Drawing, palette};

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
        letters.label([25.0, 20.0], "~M~^{2} − ε", palette::INK);
        let (some, _) = dark(&letters);
        assert!(some > 100, "{some} dark pixels");
        d.polygon(&square[..3], palette::INK);
        let (half, _) = dark(&d);
        assert!(half.abs_diff(75 * 120) < 400, "{half} dark pixels");
    }
}
