//! Colours that readers with any colour vision tell apart.

/// An RGB colour with opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Colour {
    /// Red, green and blue.
    pub(crate) rgb: [u8; 3],
    /// Opacity, 0 to 1.
    pub(crate) alpha: f64,
}

impl Colour {
    /// An opaque colour.
    pub(crate) const fn new(r: u8, g: u8, b: u8) -> Self {
        Self {
            rgb: [r, g, b],
            alpha: 1.0,
        }
    }

    /// This colour with the given opacity.
    pub(crate) const fn alpha(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }

    /// The colour on the way to another one, `part` = 0 here, 1 there.
    pub(crate) fn mix(self, other: Self, part: f64) -> Self {
        let channel = |k: usize| {
            let (a, b) = (f64::from(self.rgb[k]), f64::from(other.rgb[k]));
            (a + (b - a) * part).round().clamp(0.0, 255.0) as u8
        };
        Self {
            rgb: [channel(0), channel(1), channel(2)],
            alpha: self.alpha,
        }
    }

    /// Mixed with white; `part` = 1 is white.
    pub(crate) fn tint(self, part: f64) -> Self {
        self.mix(palette::WHITE, part)
    }
}

/// The palette of Okabe and Ito (2008), made to be told apart under every kind of colour vision, and greys.
pub(crate) mod palette {
    use super::Colour;

    pub(crate) const BLACK: Colour = Colour::new(0, 0, 0);
    pub(crate) const INK: Colour = Colour::new(34, 34, 34);
    pub(crate) const GREY: Colour = Colour::new(140, 140, 140);
    pub(crate) const PALE: Colour = Colour::new(205, 205, 205);
    pub(crate) const WHITE: Colour = Colour::new(255, 255, 255);
    pub(crate) const ORANGE: Colour = Colour::new(230, 159, 0);
    pub(crate) const SKY: Colour = Colour::new(86, 180, 233);
    pub(crate) const GREEN: Colour = Colour::new(0, 158, 115);
    pub(crate) const BLUE: Colour = Colour::new(0, 114, 178);
    pub(crate) const VERMILION: Colour = Colour::new(213, 94, 0);
    pub(crate) const PURPLE: Colour = Colour::new(204, 121, 167);
}
