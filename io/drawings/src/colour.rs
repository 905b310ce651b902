//! Colours of lines.

use std::fmt;

/// A colour of a line: red, green and blue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Colour(pub [u8; 3]);

/// Hues in degrees around the named colours. Drawing programs write many reds; cyan and magenta are colours
/// of screens and also of inks.
const HUES: [(&str, f64); 8] = [
    ("red", 0.0),
    ("yellow", 60.0),
    ("green", 120.0),
    ("cyan", 180.0),
    ("blue", 240.0),
    ("magenta", 300.0),
    ("cyan", 197.0),
    ("magenta", 325.0),
];

impl Colour {
    /// Black.
    pub const BLACK: Self = Self([0; 3]);

    /// The names of colours that [`name`](Self::name) knows.
    pub const NAMES: [&str; 9] = [
        "black", "white", "grey", "red", "yellow", "green", "cyan", "blue", "magenta",
    ];

    /// The colour that a text says as style sheets do, such as `#ff8000`, whatever its opacity.
    pub fn parse(text: &str) -> Option<Self> {
        let colour: svgtypes::Color = text.parse().ok()?;
        Some(Self([colour.red, colour.green, colour.blue]))
    }

    /// The name of the colour that it looks like; none between two hues.
    pub fn name(self) -> Option<&'static str> {
        let [r, g, b] = self.0.map(f64::from);
        let (most, least) = (r.max(g).max(b), r.min(g).min(b));
        let chroma = most - least;
        if chroma < 0.25 * most.max(64.0) {
            return Some(match most {
                ..80.0 => "black",
                240.0.. => "white",
                _ => "grey",
            });
        }
        let sextant = if most == r {
            ((g - b) / chroma).rem_euclid(6.0)
        } else if most == g {
            (b - r) / chroma + 2.0
        } else {
            (r - g) / chroma + 4.0
        };
        let hue = 60.0 * sextant;
        let away = |h: f64| (hue - h + 180.0).rem_euclid(360.0) - 180.0;
        let named = HUES.iter().find(|(_, h)| away(*h).abs() <= 20.0);
        named.map(|(name, _)| *name)
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        match self.name() {
            Some(name) => f.write_str(name),
            None => write!(f, "#{r:02x}{g:02x}{b:02x}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_drawing_programs_have_names() {
        for (colour, name) in [
            ([0, 0, 0], Some("black")),
            ([35, 31, 32], Some("black")),
            ([255, 255, 255], Some("white")),
            ([128, 128, 128], Some("grey")),
            ([255, 0, 0], Some("red")),
            ([237, 28, 36], Some("red")),
            ([0, 255, 0], Some("green")),
            ([0, 128, 0], Some("green")),
            ([0, 0, 255], Some("blue")),
            ([46, 49, 146], Some("blue")),
            ([255, 255, 0], Some("yellow")),
            ([236, 0, 140], Some("magenta")),
            ([230, 0, 126], Some("magenta")),
            ([0, 159, 227], Some("cyan")),
            ([0, 174, 239], Some("cyan")),
            ([255, 0, 255], Some("magenta")),
            ([255, 128, 0], None),
        ] {
            assert_eq!(Colour(colour).name(), name, "{colour:?}");
        }
        assert_eq!(Colour([255, 128, 0]).to_string(), "#ff8000");
    }
}
