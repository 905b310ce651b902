//! The scale of colours below a picture: its name with the unit, the colours, and round values.

use super::canvas::Image;
use super::colour_scale::ColourScale;
use super::error::PictureError;
use super::sheet::INK;
use super::text::Line;
use super::ticks::Ticks;
use isosheet_files::DataError;

/// Size of the letters, as part of the height of the whole picture, and the smallest, pixels.
const LETTERS: f64 = 1.0 / 28.0;
const SMALLEST: f64 = 9.0;

// Lengths in sizes of letters, from above.
/// From the top of the strip to the base line of the title.
const TITLE: f64 = 0.9;
/// From there to the bar.
const GAP: f64 = 0.45;
const BAR: f64 = 0.75;
/// The length of a tick.
const TICK: f64 = 0.3;
/// From the end of a tick to the base line of the values.
const VALUES: f64 = 0.95;
/// From there to the end of the strip.
const BELOW: f64 = 0.55;
/// The pointed end of a bar beyond which there are values.
const POINT: f64 = 0.65;
/// The least room between two values.
const ROOM: f64 = 1.0;

/// The length of a bar, as part of the width of the picture, and in sizes of letters the longest.
const LENGTH: f64 = 0.8;
const LONGEST: f64 = 28.0;

/// Part of the width of a picture that its title has at most.
const FILLED: f64 = 0.94;

/// As many values are named at most.
const MOST: usize = 6;

/// Samples for each pixel of the bar, each way.
const SAMPLES: usize = 4;

/// The strip with the scale of colours that belongs below a picture, whose height is that of both.
///
/// # Errors
/// Errors of [`ColourScale::validate`], and [`PictureError::Options`] where the strip would take more than
/// half of the picture.
pub fn strip(scale: &ColourScale, [width, height]: [usize; 2]) -> Result<Image, PictureError> {
    scale.validate()?;
    let letters = (LETTERS * height as f64).max(SMALLEST);
    let needed = (letters * (TITLE + GAP + BAR + TICK + VALUES + BELOW)).ceil() as usize;
    if 2 * needed > height {
        let message =
            format!("a scale of colours takes {needed} pixels of the height, which is {height}");
        let remedy = "give at least twice as much height, or leave the colour out";
        return Err(PictureError::Options(DataError::new(message, remedy)));
    }
    let mut image = Image::white(width, needed);
    let middle = 0.5 * width as f64;
    let length = (LENGTH * width as f64).min(LONGEST * letters);
    let left = middle - 0.5 * length;
    let values = Values::fitting(scale, letters, length);
    let wide = Line::new(&values.title, letters).width;
    let fits = FILLED * width as f64;
    let title = Line::new(&values.title, letters * (fits / wide).min(1.0));
    title.draw(
        &mut image,
        [middle - 0.5 * title.width, TITLE * letters],
        INK,
    );
    let top = (letters * (TITLE + GAP)).round();
    let bar = Bar {
        scale,
        left,
        length,
        top,
        height: (BAR * letters).round(),
        point: POINT * letters,
    };
    bar.draw(&mut image);
    let below = bar.top + bar.height;
    for (place, line) in &values.lines {
        let x = left + place * length;
        let half = 0.5 * (letters / 14.0).max(1.0);
        image.fill(
            [x - half, x + half],
            [below, below + TICK * letters],
            |_, _| Some(INK),
        );
        let base = below + letters * (TICK + VALUES);
        line.draw(&mut image, [x - 0.5 * line.width, base], INK);
    }
    Ok(image)
}

/// The values that are named below a bar.
struct Values {
    title: String,
    /// The place of each along the bar, from 0 to 1.
    lines: Vec<(f64, Line)>,
}

impl Values {
    /// As many as have room.
    fn fitting(scale: &ColourScale, letters: f64, length: f64) -> Self {
        let of = |most: usize| {
            let Ticks { title, labels } = Ticks::of(scale, most);
            let lines = labels.into_iter();
            let lines =
                lines.map(|(value, label)| (scale.place(value), Line::new(&label, letters)));
            Self {
                title,
                lines: lines.collect(),
            }
        };
        let fits = |values: &Self| {
            values.lines.windows(2).all(|pair| {
                let [(p, a), (q, b)] = pair else { return true };
                (q - p) * length > 0.5 * (a.width + b.width) + ROOM * letters
            })
        };
        (2..=MOST).rev().map(of).find(fits).unwrap_or_else(|| of(1))
    }
}

/// The colours from left to right, with a point at an end beyond which there are values. Pixels.
struct Bar<'a> {
    scale: &'a ColourScale,
    left: f64,
    length: f64,
    top: f64,
    height: f64,
    point: f64,
}

impl Bar<'_> {
    fn draw(&self, image: &mut Image) {
        let Self {
            scale,
            left,
            length,
            top,
            height,
            point,
        } = *self;
        let [below, above] = scale.is_open.map(|open| if open { point } else { 0.0 });
        let colour = |x: f64, y: f64| {
            // How far a point is beyond an end, as part of the room that a pointed end has there.
            let aside = (2.0 * (y - top) / height - 1.0).abs();
            let part = (x - left) / length;
            let beyond = f64::max(
                (left - x) / below.max(1e-9),
                (x - left - length) / above.max(1e-9),
            );
            (beyond + aside <= 1.0 || (0.0..=1.0).contains(&part)).then(|| scale.map.colour(part))
        };
        image.fill(
            [left - below, left + length + above],
            [top, top + height],
            colour,
        );
    }
}

impl Image {
    /// Fills what a colour is given for, between two columns and two rows, pixels.
    fn fill(
        &mut self,
        columns: [f64; 2],
        rows: [f64; 2],
        colour: impl Fn(f64, f64) -> Option<[u8; 3]>,
    ) {
        let pixels = |[low, high]: [f64; 2]| low.floor() as i64..high.ceil() as i64;
        let inside = |c: f64, [low, high]: [f64; 2]| (low..high).contains(&c);
        for y in pixels(rows) {
            for x in pixels(columns) {
                let samples = (0..SAMPLES * SAMPLES).filter_map(|k| {
                    let sample = |c: i64, k: usize| c as f64 + (k as f64 + 0.5) / SAMPLES as f64;
                    let (x, y) = (sample(x, k % SAMPLES), sample(y, k / SAMPLES));
                    let is_inside = inside(x, columns) && inside(y, rows);
                    is_inside.then(|| colour(x, y)).flatten()
                });
                let samples: Vec<[u8; 3]> = samples.collect();
                let Some(middle) = samples.get(samples.len() / 2) else {
                    continue;
                };
                let part = samples.len() as f32 / (SAMPLES * SAMPLES) as f32;
                // Colours hardly change within a pixel.
                self.cover([x, y], *middle, part);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::srgb;
    use super::super::colour_scale::{ColourMap, Spacing};
    use super::*;

    fn scale(is_open: [bool; 2]) -> ColourScale {
        ColourScale {
            name: "gap".into(),
            unit: "m".into(),
            range: [0.0, 1.0],
            is_open,
            spacing: Spacing::Linear,
            map: ColourMap::Sequential,
        }
    }

    /// The row in the middle of the bar has the colours from end to end, and a point where values are beyond.
    #[test]
    fn bars_have_all_colours_and_points_where_they_go_on() {
        let size = [400, 280];
        let row = |is_open| {
            let image = strip(&scale(is_open), size).unwrap();
            // Letters of 10 pixels: 9 + 4.5 to the bar, which is 8 pixels high.
            let row = &image.pixels[18 * 400..19 * 400];
            row.iter().map(|c| c.map(srgb)).collect::<Vec<_>>()
        };
        let closed = row([false; 2]);
        // The bar has 280 pixels.
        assert_eq!(closed[59], [255; 3]);
        assert_eq!(closed[340], [255; 3]);
        for (x, place) in [(60, 0.0), (200, 0.5), (339, 1.0)] {
            let expected = ColourMap::Sequential.colour(place);
            let off = (0..3).map(|k| closed[x][k].abs_diff(expected[k])).max();
            assert!(off.unwrap() <= 2, "{x}: {:?} and {expected:?}", closed[x]);
        }
        let open = row([false, true]);
        assert_eq!(open[59], [255; 3]);
        assert_eq!(open[341], ColourMap::Sequential.colour(1.0));
        let dark = |x: &usize| closed[*x] != [255; 3];
        assert_eq!((0..400).filter(dark).count(), 280);
    }

    /// Nothing of the strip is outside of a narrow picture, and pictures without room are refused.
    #[test]
    fn narrow_pictures_have_smaller_titles_and_fewer_values() {
        let name = "crease short of its angle".to_owned();
        let long = ColourScale {
            name,
            ..scale([true; 2])
        };
        let image = strip(&long, [120, 400]).unwrap();
        let [width, height] = image.size();
        let is_white = |x: usize| (0..height).all(|y| image.pixels[y * width + x] == [1.0; 3]);
        assert!(is_white(0) && is_white(width - 1));
        assert!((0..width).filter(|x| !is_white(*x)).count() > 100);
        assert!(strip(&long, [400, 60]).is_err());
    }
}
