//! Writing a drawing as PNG: its SVG file, rasterised with a font that comes with the program.

use super::drawing::Drawing;
use anyhow::{Context, Result};
use resvg::{tiny_skia, usvg};

/// Pixels for a point: 216 to the inch, enough for print in a column.
const SCALE: f32 = 3.0;

impl Drawing {
    /// The drawing as a PNG file; `title` as for [`Drawing::to_svg`].
    ///
    /// No fonts of the system are used, so that equal drawings give equal files everywhere.
    pub(crate) fn to_png(&self, title: &str) -> Result<Vec<u8>> {
        let mut options = usvg::Options::default();
        let fonts = options.fontdb_mut();
        fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
        let family = fonts
            .faces()
            .next()
            .and_then(|f| f.families.first())
            .map(|(name, _)| name.clone())
            .context("the built-in font cannot be read")?;
        fonts.set_sans_serif_family(family);
        let tree = usvg::Tree::from_str(&self.to_svg(title)?, &options)
            .context("cannot read the drawing back")?;
        // Sizes in the file are points of 96 / 72 pixels.
        let scale = SCALE * 72.0 / 96.0;
        let size = tree.size();
        let [width, height] = [size.width(), size.height()].map(|s| (s * scale).ceil() as u32);
        let mut pixels = tiny_skia::Pixmap::new(width, height)
            .with_context(|| format!("no memory for {width} x {height} pixels"))?;
        // The last row and column may be covered in part only.
        pixels.fill(tiny_skia::Color::WHITE);
        resvg::render(
            &tree,
            tiny_skia::Transform::from_scale(scale, scale),
            &mut pixels.as_mut(),
        );
        let data: Vec<u8> = pixels
            .data()
            .chunks_exact(4)
            .flat_map(|p| [p[0], p[1], p[2]])
            .collect();
        crate::render::png(width, height, &data)
    }
}

#[cfg(test)]
mod tests {
    use crate::draw::{Anchor, Drawing, TEXT, Vertical, palette};

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
        let write = |d: &mut Drawing, text| {
            d.text(
                [25.0, 20.0],
                text,
                TEXT,
                Anchor::Middle,
                Vertical::Centre,
                palette::INK,
            );
        };
        let mut letters = d.clone();
        write(&mut letters, "~M~^{2} − ε");
        let (some, _) = dark(&letters);
        assert!(some > 100, "{some} dark pixels");
        d.polygon(&square[..3], palette::INK);
        let (half, _) = dark(&d);
        assert!(half.abs_diff(75 * 120) < 400, "{half} dark pixels");
    }
}
