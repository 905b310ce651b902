//! Values as colours.

use super::error::PictureError;
use isosheet_files::DataError;
use isosheet_mesh::wording::given;

/// Colours in their order, between which the others are interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// From dark to light: viridis by Smith and van der Walt (CC0), every eighth part.
    Sequential,
    /// From blue by grey to red, after Moreland (2009), "Diverging Color Maps for Scientific Visualization",
    /// every eighth part.
    Diverging,
    /// From dark to orange: inferno by Smith and van der Walt (CC0), the first seven tenths of it, whose
    /// colours stand out from both sides of paper.
    Dark,
}

const VIRIDIS: [u32; 9] = [
    0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725,
];
const COOLWARM: [u32; 9] = [
    0x3b4cc0, 0x688aef, 0x99baff, 0xc9d8ef, 0xdddddd, 0xf7c4ad, 0xf49a7b, 0xde614d, 0xb40426,
];
const INFERNO: [u32; 8] = [
    0x000004, 0x160b39, 0x420a68, 0x6a176e, 0x932667, 0xbc3754, 0xdd513a, 0xf37819,
];

impl ColourMap {
    /// The sRGB colour at a place from 0 to 1; places beyond have that of the end.
    pub fn colour(self, place: f64) -> [u8; 3] {
        let stops: &[u32] = match self {
            Self::Sequential => &VIRIDIS,
            Self::Diverging => &COOLWARM,
            Self::Dark => &INFERNO,
        };
        let place = place.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let first = (place as usize).min(stops.len() - 2);
        let part = place - first as f64;
        [16, 8, 0].map(|shift| {
            let [a, b] = [first, first + 1].map(|k| f64::from((stops[k] >> shift) & 255));
            (a + part * (b - a)).round() as u8
        })
    }
}

/// How values are laid out between the ends of a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// By value.
    Linear,
    /// By logarithm; both ends are positive, or equal.
    Logarithmic,
}

/// Which value of a quantity has which colour.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourScale {
    /// The name of the quantity.
    pub name: String,
    /// Its unit, empty for a number without one.
    pub unit: String,
    /// The values at both ends, of which the second may not be below the first.
    pub range: [f64; 2],
    /// Whether there are values below the first end, and above the second, which have the colours of the
    /// ends.
    pub is_open: [bool; 2],
    /// How values are laid out between the ends.
    pub spacing: Spacing,
    /// The colours.
    pub map: ColourMap,
}

impl ColourScale {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`PictureError::Options`] for an end that is not finite, for ends in the wrong order, and for a
    /// logarithmic scale with an end that is not positive.
    pub fn validate(&self) -> Result<(), PictureError> {
        let [low, high] = self.range;
        let wrong = |message: String, remedy, value: f64| {
            Err(PictureError::Options(
                DataError::new(message, remedy).value(value),
            ))
        };
        let range = format!("the range of colours is {}..{}", given(low), given(high));
        if let Some(end) = self.range.into_iter().find(|end| !end.is_finite()) {
            return wrong(range, "give finite values", end);
        }
        if high < low {
            return wrong(range, "give the smaller value first", high);
        }
        if self.spacing == Spacing::Logarithmic && low <= 0.0 && high > low {
            let message = format!("{range}, and {} has a logarithmic scale", self.name);
            return wrong(message, "give positive values", low);
        }
        Ok(())
    }

    /// The place of a value, 0 and 1 at the ends, less and more beyond. Where both ends are equal all values
    /// are in the middle. On a logarithmic scale zero is at the low end.
    pub fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        match self.spacing {
            _ if low >= high => 0.5,
            Spacing::Linear => (value - low) / (high - low),
            Spacing::Logarithmic if value > 0.0 => (value / low).ln() / (high / low).ln(),
            Spacing::Logarithmic => 0.0,
        }
    }

    /// The sRGB colour of a value.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        self.map.colour(self.place(value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(range: [f64; 2], spacing: Spacing) -> ColourScale {
        ColourScale {
            name: "strain".into(),
            unit: String::new(),
            range,
            is_open: [false; 2],
            spacing,
            map: ColourMap::Sequential,
        }
    }

    #[test]
    fn values_have_colours_by_their_place() {
        let linear = scale([2.0, 4.0], Spacing::Linear);
        assert_eq!(linear.colour(2.0), [0x44, 0x01, 0x54]);
        assert_eq!(linear.colour(3.0), [0x21, 0x91, 0x8c]);
        assert_eq!(linear.colour(4.0), [0xfd, 0xe7, 0x25]);
        assert_eq!(linear.colour(9.0), linear.colour(4.0));
        let logarithmic = scale([1e-6, 1e-2], Spacing::Logarithmic);
        assert_eq!(logarithmic.colour(1e-4), linear.colour(3.0));
        assert_eq!(logarithmic.colour(0.0), linear.colour(2.0));
        let equal = scale([0.0, 0.0], Spacing::Logarithmic);
        assert_eq!(equal.colour(0.0), linear.colour(3.0));
    }

    #[test]
    fn ranges_that_make_no_sense_are_refused() {
        for (range, spacing, words) in [
            ([1.0, 0.5], Spacing::Linear, "1..0.5"),
            ([0.0, f64::NAN], Spacing::Linear, "0..NaN"),
            ([0.0, 1.0], Spacing::Logarithmic, "logarithmic"),
        ] {
            let error = scale(range, spacing).validate().unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        for (range, spacing) in [
            ([1.0, 1.0], Spacing::Linear),
            ([0.0, 0.0], Spacing::Logarithmic),
            ([-1.0, 1.0], Spacing::Linear),
        ] {
            scale(range, spacing).validate().unwrap();
        }
    }
}
