//! Text in pictures, in a font that comes with the program.

use super::canvas::Image;
use ab_glyph::{Font, FontRef, OutlinedGlyph, PxScale, ScaleFont, point};
use std::sync::LazyLock;

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).expect("the font is whole")
});

/// Superscripts, not all of which the font has, and what is raised in their place.
const SUPERSCRIPTS: [(char, char); 11] = [
    ('⁻', '−'),
    ('⁰', '0'),
    ('¹', '1'),
    ('²', '2'),
    ('³', '3'),
    ('⁴', '4'),
    ('⁵', '5'),
    ('⁶', '6'),
    ('⁷', '7'),
    ('⁸', '8'),
    ('⁹', '9'),
];

/// The size of superscripts, and how far their base line is above that of the text, as parts of the size of
/// letters.
const RAISED_SIZE: f32 = 0.65;
const RAISED: f32 = 0.35;

/// A line of text, from its left end on its base line.
pub(super) struct Line {
    glyphs: Vec<OutlinedGlyph>,
    /// Pixels.
    pub(super) width: f64,
}

impl Line {
    /// A text in letters of a size: capitals and digits are 0.69 times as high.
    pub(super) fn new(text: &str, size: f64) -> Self {
        let font = &*FONT;
        let of_em = font
            .units_per_em()
            .map_or(1.0, |units| font.height_unscaled() / units);
        let font = font.as_scaled(PxScale::from(size as f32 * of_em));
        let (mut x, mut before) = (0.0, None);
        let mut glyphs = Vec::new();
        for letter in text.chars() {
            let raised = SUPERSCRIPTS.iter().find(|(sign, _)| *sign == letter);
            let (letter, part, up) = match raised {
                Some((_, plain)) => (*plain, RAISED_SIZE, RAISED * size as f32),
                None => (letter, 1.0, 0.0),
            };
            let id = font.glyph_id(letter);
            x += before.map_or(0.0, |before| font.kern(before, id));
            let scale = font.scale().x * part;
            let glyph = id.with_scale_and_position(scale, point(x, -up));
            glyphs.extend(font.outline_glyph(glyph));
            x += part * font.h_advance(id);
            before = raised.is_none().then_some(id);
        }
        Self {
            glyphs,
            width: f64::from(x),
        }
    }

    /// Writes the text with its left end at a place, pixels from the upper left corner. What is outside of
    /// the picture is left out.
    pub(super) fn draw(&self, image: &mut Image, [left, base]: [f64; 2], ink: [u8; 3]) {
        let [left, base] = [left.round() as i64, base.round() as i64];
        for glyph in &self.glyphs {
            let corner = glyph.px_bounds().min;
            let [x0, y0] = [left + corner.x as i64, base + corner.y as i64];
            glyph.draw(|x, y, cover| {
                image.cover([x0 + i64::from(x), y0 + i64::from(y)], ink, cover);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All that labels are made of is in the font, and a line is as wide as its ink.
    #[test]
    fn letters_leave_ink_where_they_are() {
        let signs = "abcXYZ0123456789 (°·−+/)µ";
        for letter in signs.chars() {
            assert_ne!(FONT.glyph_id(letter).0, 0, "{letter}");
        }
        let line = Line::new("M2", 30.0);
        let mut image = Image::white(60, 40);
        line.draw(&mut image, [4.0, 35.0], [0; 3]);
        let dark = |k: &usize| image.pixels[*k][0] < 0.5;
        let inked: Vec<usize> = (0..60 * 40).filter(dark).collect();
        let columns = inked.iter().map(|k| k % 60);
        let rows = inked.iter().map(|k| k / 60);
        let (left, right) = (columns.clone().min().unwrap(), columns.max().unwrap());
        assert!(
            left >= 4
                && right as f64 <= 4.0 + line.width
                && (right - left) as f64 > 0.7 * line.width
        );
        // 0.69 of 30 pixels above the base line.
        assert!((13..=16).contains(&rows.clone().min().unwrap()));
        assert!((33..=35).contains(&rows.max().unwrap()));
        // Beyond the border nothing is written.
        line.draw(&mut image, [50.0, 60.0], [0; 3]);
    }
}
