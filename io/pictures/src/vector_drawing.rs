//! Vector drawings as pixels, with a font that comes with the program.

use super::canvas::png;
use super::error::PictureError;
use resvg::{tiny_skia, usvg};

/// An SVG document as a PNG file on white, `scale` pixels for a pixel of the document.
///
/// No fonts of the system are used: all text is in one built-in font, so that equal documents give equal
/// files everywhere.
///
/// # Errors
/// [`PictureError::Svg`] if the document cannot be read, [`PictureError::Options`] if it is empty or too
/// large.
pub fn svg_to_png(svg: &str, scale: f32) -> Result<Vec<u8>, PictureError> {
    let pixels = pixels(svg, scale)?;
    let data: Vec<u8> = pixels
        .data()
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    png(pixels.width(), pixels.height(), &data)
}

fn pixels(svg: &str, scale: f32) -> Result<tiny_skia::Pixmap, PictureError> {
    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().and_then(|f| f.families.first());
    if let Some(family) = family.map(|(name, _)| name.clone()) {
        fonts.set_sans_serif_family(family);
    }
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree.size();
    let [width, height] = [size.width(), size.height()].map(|s| (s * scale).ceil() as u32);
    let mut pixels = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| PictureError::size(width as usize, height as usize))?;
    // The last row and column may be covered in part only.
    pixels.fill(tiny_skia::Color::WHITE);
    let transform = tiny_skia::Transform::from_scale(scale, scale);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_and_letters_leave_ink() {
        let document = |inside: &str| {
            format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"60\" height=\"40\">{inside}</svg>"
            )
        };
        let dark = |inside: &str| {
            let pixels = pixels(&document(inside), 1.0).unwrap();
            assert_eq!((pixels.width(), pixels.height()), (60, 40));
            pixels.pixels().iter().filter(|p| p.red() < 128).count()
        };
        assert_eq!(dark(""), 0);
        assert_eq!(dark("<rect width=\"30\" height=\"20\"/>"), 600);
        assert!(dark("<text y=\"30\" font-family=\"sans-serif\">M2</text>") > 20);
        assert!(matches!(pixels("<svg", 1.0), Err(PictureError::Svg(_))));
        let file = svg_to_png(&document(""), 1.5).unwrap();
        let info = png::Decoder::new(std::io::Cursor::new(file)).read_info();
        assert_eq!(info.unwrap().info().size(), (90, 60));
    }
}
