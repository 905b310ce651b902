//! Units of drawings.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The length that a unit of a drawing means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]

pub enum DrawingUnit {
    /// Metres.
    #[serde(rename = "m")]
    Metre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
    /// Inches.
    #[serde(rename = "in")]
    Inch,
    /// Points of printers, 1/72 inch.
    #[serde(rename = "pt")]
    Point,
    /// Pixels of pages, 1/96 inch.
    #[serde(rename = "px")]
    Pixel,
}

impl DrawingUnit {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Metre,
        Self::Centimetre,
        Self::Millimetre,
        Self::Inch,
        Self::Point,
        Self::Pixel,
    ];

    /// Its name: m, cm, mm, in, pt or px.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Inch => "in",
            Self::Point => "pt",
            Self::Pixel => "px",
        }
    }

    /// A length of so many, metres.
    pub fn metres(self, count: f64) -> f64 {
        match self {
            Self::Metre => count,
            Self::Centimetre => count / 100.0,
            Self::Millimetre => count / 1000.0,
            Self::Inch => count * 0.0254,
            Self::Point => count * 0.0254 / 72.0,
            Self::Pixel => count * 0.0254 / 96.0,
        }
    }
}

impl FromStr for DrawingUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|u| u.name() == text);
        found.ok_or_else(|| format!("{text:?} is no unit: use m, cm, mm, in, pt or px"))
    }
}

/// A length with its unit, such as `5mm`; metres without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// The length, metres.
    pub metres: f64,
}

impl FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let split = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let (number, unit) = text.split_at(split.len());
        let unit = match unit {
            "" => DrawingUnit::Metre,
            unit => unit.parse()?,
        };
        match number.trim().parse() {
            Ok(number) => Ok(Self {
                metres: unit.metres(number),
            }),
            Err(_) => Err(format!("{text:?} is no length: write it as 5mm or 0.005m")),
        }
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mm = 1e3 * self.metres;
        // Drawings are exact to hundredths of a millimetre.
        match (1.0..1e5).contains(&mm.abs()) {
            true => write!(f, "{} mm", (100.0 * mm).round() / 100.0),
            false => write!(f, "{} mm", isosheet_mesh::wording::brief(mm)),
        }
    }
}
