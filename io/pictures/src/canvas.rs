//! Pictures in linear light, and their PNG files.

use super::error::PictureError;
use std::sync::LazyLock;

/// A linear RGB colour, 0 to 1.
pub(super) type Light = [f32; 3];

/// The linear light of an sRGB colour.
pub(super) fn light(rgb: [u8; 3]) -> Light {
    rgb.map(|c| {
        let c = f32::from(c) / 255.0;
        if c <= 0.040_45 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// The sRGB value of a component of linear light.
pub(super) fn srgb(c: f32) -> u8 {
    let c = c.clamp(0.0, 1.0);
    let (least, next) = &*TABLE;
    let mut value = least[(c * PARTS) as usize];
    // No part has more than one of them: a value is at least 1 / (255 * 12.92) of full light wide.
    while c >= next[usize::from(value)] {
        value += 1;
    }
    value
}

/// Equal parts of full light.
const PARTS: f32 = 4096.0;

/// The sRGB value at the beginning of each part of full light, and of each value the least light that has the
/// next one.
static TABLE: LazyLock<(Vec<u8>, Vec<f32>)> = LazyLock::new(|| {
    let least = (0..=PARTS as u32).map(|part| exact_srgb(part as f32 / PARTS));
    let next = (0..=u8::MAX).map(|value| {
        // Positive floats are in the order of their bits.
        let (mut low, mut high) = (0, f32::INFINITY.to_bits());
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if value < u8::MAX && exact_srgb(f32::from_bits(middle)) > value {
                high = middle;
            } else {
                low = middle;
            }
        }
        f32::from_bits(high)
    });
    (least.collect(), next.collect())
});

/// The sRGB value of positive light.
fn exact_srgb(c: f32) -> u8 {
    let s = if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    };
    // Conversion from floats saturates.
    (255.0 * s).round() as u8
}

/// A picture in linear light.
#[derive(Clone, Debug)]
pub struct Image {
    /// Width, pixels.
    pub(super) width: usize,
    /// Height, pixels.
    pub(super) height: usize,
    /// Row by row from above.
    pub(super) pixels: Vec<Light>,
}

impl Image {
    /// A white picture.
    pub(super) fn white(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[1.0; 3]; width * height],
        }
    }

    /// Copies another picture in, its upper left corner at (x, y).
    pub(super) fn paste(&mut self, other: &Self, x: usize, y: usize) {
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let width = other.width.min(self.width.saturating_sub(x));
            let to = (y + row) * self.width + x;
            self.pixels[to..to + width]
                .copy_from_slice(&other.pixels[row * other.width..row * other.width + width]);
        }
    }

    /// This picture with another one of the same width below it.
    pub fn above(&self, other: &Self) -> Self {
        let mut both = Self::white(self.width, self.height + other.height);
        both.paste(self, 0, 0);
        both.paste(other, 0, self.height);
        both
    }

    /// Covers a part of a pixel with an sRGB colour, if there is one at this place. Colours are mixed by
    /// their sRGB values, as other programs do: fine letters would be pale in linear light.
    pub(super) fn cover(&mut self, [x, y]: [i64; 2], ink: [u8; 3], part: f32) {
        let inside = |c: i64, size: usize| usize::try_from(c).ok().filter(|c| *c < size);
        let (Some(x), Some(y)) = (inside(x, self.width), inside(y, self.height)) else {
            return;
        };
        let pixel = &mut self.pixels[y * self.width + x];
        let mixed = [0, 1, 2].map(|k| {
            let [from, to] = [srgb(pixel[k]), ink[k]].map(f32::from);
            (from + part * (to - from)).round() as u8
        });
        *pixel = light(mixed);
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Three sRGB bytes for each pixel, row by row from above.
    pub fn to_rgb(&self) -> Vec<u8> {
        srgb_bytes(self)
    }

    /// The picture as a PNG file, sRGB, eight bits.
    ///
    /// # Errors
    /// [`PictureError::Png`] for more pixels than a PNG file may have.
    pub fn to_png(&self) -> Result<Vec<u8>, PictureError> {
        png(self.width as u32, self.height as u32, &srgb_bytes(self))
    }
}

/// Three sRGB bytes for each pixel.
pub(super) fn srgb_bytes(image: &Image) -> Vec<u8> {
    image.pixels.iter().flat_map(|p| p.map(srgb)).collect()
}

/// The compression of files. Pictures have few colours, and more differences of colours, of which a filter
/// makes files: without one they are as large at this level as with one at the highest, in a fifth of the
/// time.
const LEVEL: u8 = 4;

/// A writer of PNG files with three sRGB bytes a pixel.
pub(super) fn encoder(
    bytes: &mut Vec<u8>,
    width: u32,
    height: u32,
) -> png::Encoder<'_, &mut Vec<u8>> {
    let mut encoder = png::Encoder::new(bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_deflate_compression(png::DeflateCompression::Level(LEVEL));
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder
}

/// The PNG file of a picture given as rows of three sRGB bytes a pixel.
pub(super) fn png(width: u32, height: u32, data: &[u8]) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let encoder = encoder(&mut bytes, width, height);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_files() {
        let mut image = Image::white(2, 1);
        image.pixels[0] = [0.75; 3];
        let bytes = image.to_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut data).unwrap();
        // 0.75 of full light is 225 of 255 in sRGB.
        assert_eq!(data, [225, 225, 225, 255, 255, 255]);
    }

    /// Values from the table agree with the formula, also at both sides of each step.
    #[test]
    fn the_table_is_the_formula() {
        for k in 0..=100_000u32 {
            let c = k as f32 / 1e5;
            assert_eq!(srgb(c), exact_srgb(c), "{c}");
        }
        for next in &TABLE.1[..255] {
            for c in [next.next_down(), *next, next.next_up()] {
                assert_eq!(srgb(c), exact_srgb(c), "{c}");
            }
        }
        assert_eq!([-1.0, 0.0, 2.0].map(srgb), [0, 0, 255]);
    }

    #[test]
    fn colours_survive_the_way_to_light_and_back() {
        for c in 0..=255u8 {
            assert_eq!(srgb(light([c; 3])[0]), c);
        }
    }
}
