//! Pictures in linear light, and their PNG files.

use super::error::PictureError;

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
    let s = if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    };
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

/// A corner of something drawn: pixel coordinates (y downwards) and nearness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) nearness: f64,
    /// Factor on the colour.
    pub(super) shade: f64,
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

    /// Width and height, pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
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

/// The PNG file of a picture given as rows of three sRGB bytes a pixel.
pub(super) fn png(width: u32, height: u32, data: &[u8]) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}

/// A picture with depth: what is nearer hides what is farther.
#[derive(Clone, Debug)]
pub(super) struct Depth {
    pub(super) image: Image,
    nearness: Vec<f64>,
}

impl Depth {
    /// An empty white scene.
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self {
            image: Image::white(width, height),
            nearness: vec![f64::NEG_INFINITY; width * height],
        }
    }

    /// A triangle whose shade is interpolated between its corners.
    pub(super) fn triangle(&mut self, c: &[Corner; 3], colour: Light) {
        let area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
        if area.abs() < 1e-9 {
            return;
        }
        let (w, h) = (self.image.width, self.image.height);
        let bound = |f: fn(&Corner) -> f64, limit: usize| {
            let low = c.iter().map(f).fold(f64::INFINITY, f64::min);
            let high = c.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
            let last = (high.ceil().max(0.0) as usize).min(limit);
            (low.floor().max(0.0) as usize).min(last)..last
        };
        for y in bound(|c| c.y, h) {
            for x in bound(|c| c.x, w) {
                let p = [x as f64 + 0.5, y as f64 + 0.5];
                let part = |i: usize, j: usize| {
                    ((c[i].x - p[0]) * (c[j].y - p[1]) - (c[j].x - p[0]) * (c[i].y - p[1])) / area
                };
                let b = [part(1, 2), part(2, 0), part(0, 1)];
                // A hair of overlap closes the cracks between neighbouring triangles.
                if b.iter().any(|b| *b < -1e-7) {
                    continue;
                }
                let blend = |f: fn(&Corner) -> f64| (0..3).map(|k| b[k] * f(&c[k])).sum::<f64>();
                let nearness = blend(|c| c.nearness);
                let k = y * w + x;
                if nearness > self.nearness[k] {
                    self.nearness[k] = nearness;
                    let shade = blend(|c| c.shade) as f32;
                    self.image.pixels[k] = colour.map(|l| l * shade);
                }
            }
        }
    }

    /// A line of the given width (pixels), mixed with what is behind it by `cover`.
    pub(super) fn line(&mut self, a: &Corner, b: &Corner, width: f64, colour: Light, cover: f32) {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let square = (dx * dx + dy * dy).max(1e-12);
        let radius = 0.5 * width;
        let (w, h) = (self.image.width, self.image.height);
        let range = |low: f64, high: f64, limit: usize| {
            let last = ((high + radius).ceil().max(0.0) as usize).min(limit);
            ((low - radius).floor().max(0.0) as usize).min(last)..last
        };
        for y in range(a.y.min(b.y), a.y.max(b.y), h) {
            for x in range(a.x.min(b.x), a.x.max(b.x), w) {
                let p = [x as f64 + 0.5 - a.x, y as f64 + 0.5 - a.y];
                let s = ((p[0] * dx + p[1] * dy) / square).clamp(0.0, 1.0);
                if (p[0] - s * dx).hypot(p[1] - s * dy) > radius {
                    continue;
                }
                let k = y * w + x;
                if a.nearness + s * (b.nearness - a.nearness) > self.nearness[k] {
                    let below = self.image.pixels[k];
                    for i in 0..3 {
                        self.image.pixels[k][i] = below[i] + cover * (colour[i] - below[i]);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f64, y: f64, nearness: f64) -> Corner {
        Corner {
            x,
            y,
            nearness,
            shade: 1.0,
        }
    }

    #[test]
    fn the_nearer_triangle_hides_the_farther_in_either_order() {
        let big = |z| {
            [
                corner(-10.0, -10.0, z),
                corner(40.0, -10.0, z),
                corner(-10.0, 40.0, z),
            ]
        };
        for order in [[0, 1], [1, 0]] {
            let mut d = Depth::new(8, 8);
            for k in order {
                let colour = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][k];
                d.triangle(&big([1.0, 2.0][k]), colour);
            }
            assert!(d.image.pixels.iter().all(|p| *p == [0.0, 1.0, 0.0]));
        }
    }

    #[test]
    fn neighbouring_triangles_leave_no_crack() {
        let mut d = Depth::new(64, 64);
        let (a, b, c, e) = (
            corner(3.0, 5.0, 0.0),
            corner(60.0, 9.0, 0.0),
            corner(7.0, 58.0, 0.0),
            corner(55.0, 61.0, 0.0),
        );
        d.triangle(&[a, b, c], [0.0; 3]);
        d.triangle(&[b, e, c], [0.0; 3]);
        for k in 14..50 {
            // Across the common side.
            let p = d.image.pixels[k * 64 + k];
            assert_eq!(p, [0.0; 3], "pixel {k}");
        }
    }

    #[test]
    fn averaging_and_png() {
        let mut image = Image::white(4, 2);
        image.pixels[0] = [0.0; 3];
        let small = image.reduced(2);
        assert_eq!((small.width, small.height), (2, 1));
        assert_eq!(small.pixels, vec![[0.75; 3], [1.0; 3]]);
        let bytes = small.to_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut data).unwrap();
        // 0.75 of full light is 225 of 255 in sRGB.
        assert_eq!(data, [225, 225, 225, 255, 255, 255]);
    }

    #[test]
    fn colours_survive_the_way_to_light_and_back() {
        for c in 0..=255u8 {
            assert_eq!(srgb(light([c; 3])[0]), c);
        }
    }
}
