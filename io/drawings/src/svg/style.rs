//! Styles of elements: attributes, style sheets and inheritance.

use super::style_sheet::Rules;
use crate::colour::Colour;
use isosheet_files::DataError;
use roxmltree::Node;
use simplecss::DeclarationTokenizer;
use svgtypes::{Color, Paint};

/// How lines or areas are painted.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Ink {
    Nothing,
    Paint {
        colour: Colour,
        /// How opaque the colour itself is, from 0 to 1.
        alpha: f64,
    },
    /// A colour that is not understood: how what is written begins.
    Unknown(String),
}

impl Ink {
    const BLACK: Self = Self::of((Colour::BLACK, 1.0));

    const fn of((colour, alpha): (Colour, f64)) -> Self {
        Self::Paint { colour, alpha }
    }
}

/// What an element passes on to those in it.
#[derive(Clone, Debug)]
pub(super) struct Style {
    pub(super) stroke: Ink,
    pub(super) fill: Ink,
    pub(super) dashed: bool,
    /// The opacity of lines alone.
    pub(super) stroke_opacity: f64,
    /// The opacity of areas alone.
    pub(super) fill_opacity: f64,
    /// The product of the opacities of all groups.
    pub(super) group_opacity: f64,
    pub(super) visible: bool,
    /// Whether it is shown at all, with all that is in it.
    pub(super) shown: bool,
    current: Ink,
    /// The map of the element and the point about which it is, as they are written; inner elements do not
    /// have them.
    pub(super) transform: Option<String>,
    pub(super) transform_origin: Option<String>,
}

impl Style {
    pub(super) fn initial() -> Self {
        Self {
            stroke: Ink::Nothing,
            fill: Ink::BLACK,
            dashed: false,
            stroke_opacity: 1.0,
            fill_opacity: 1.0,
            group_opacity: 1.0,
            visible: true,
            shown: true,
            current: Ink::BLACK,
            transform: None,
            transform_origin: None,
        }
    }

    /// The style of an element in one of this style.
    pub(super) fn of(&self, node: Node<'_, '_>, rules: &Rules<'_>) -> Result<Self, DataError> {
        let mut style = Self {
            transform: None,
            transform_origin: None,
            ..self.clone()
        };
        for attribute in node.attributes().filter(|a| a.namespace().is_none()) {
            style.set(attribute.name(), attribute.value());
        }
        for declaration in rules.of(node)? {
            style.set(declaration.name, declaration.value);
        }
        let own = node.attribute("style").unwrap_or_default();
        for declaration in DeclarationTokenizer::from(own) {
            style.set(declaration.name, declaration.value);
        }
        Ok(style)
    }

    /// Takes over a property; what cannot be read changes nothing.
    fn set(&mut self, name: &str, value: &str) {
        let value = value.trim();
        if ["inherit", "unset", "revert", "revert-layer"].contains(&value) {
            return;
        }
        match name {
            "stroke" => self.stroke = self.ink(value),
            "fill" => self.fill = self.ink(value),
            "color" => self.current = self.ink(value),
            "stroke-dasharray" => {
                let digits = value.split(|c: char| c == ',' || c.is_whitespace());
                let gap = |part: &str| {
                    part.trim_end_matches(|c: char| c.is_alphabetic() || c == '%')
                        .parse()
                        .unwrap_or(0.0)
                        > 0.0
                };
                self.dashed = value != "none" && digits.into_iter().any(gap);
            }
            "stroke-opacity" => self.stroke_opacity = part(value).unwrap_or(self.stroke_opacity),
            "fill-opacity" => self.fill_opacity = part(value).unwrap_or(self.fill_opacity),
            "opacity" => self.group_opacity *= part(value).unwrap_or(1.0),
            "transform" => self.transform = Some(value.to_owned()),
            "transform-origin" => self.transform_origin = Some(value.to_owned()),
            "visibility" => self.visible = value == "visible",
            "display" => self.shown &= value != "none",
            _ => {}
        }
    }

    /// What a value paints with.
    fn ink(&self, value: &str) -> Ink {
        match colour(value) {
            Some((_, 0.0)) => return Ink::Nothing,
            Some(painted) => return Ink::of(painted),
            None if value.eq_ignore_ascii_case("none") => return Ink::Nothing,
            None if value.eq_ignore_ascii_case("currentcolor") => return self.current.clone(),
            None => {}
        }
        match Paint::from_str(value) {
            // A gradient or a pattern has no colour of its own.
            Ok(_) => Ink::of((Colour([128; 3]), 1.0)),
            Err(_) => Ink::Unknown(value.chars().take(LONGEST).collect()),
        }
    }
}

/// So many characters of a colour that is not understood are told.
const LONGEST: usize = 40;

/// A colour, and how opaque it is, from 0 to 1; none of what is no colour, or one of a kind that is not
/// known.
fn colour(value: &str) -> Option<(Colour, f64)> {
    // The colour of a printer follows that of screens.
    let screen = value.split_once("icc-color(");
    let value = screen.map_or(value, |(screen, _)| screen.trim_end());
    // The library knows no alpha in percent, and rounds others to a byte.
    if let Some((opaque, alpha)) = without_alpha(value) {
        let (colour, _) = parts(opaque.parse().ok()?);
        return Some((colour, alpha));
    }
    value.parse().ok().map(parts)
}

fn parts(c: Color) -> (Colour, f64) {
    (Colour([c.red, c.green, c.blue]), f64::from(c.alpha) / 255.0)
}

/// A function for a colour without its alpha, and this: that after a slash, or the fourth of its values.
fn without_alpha(value: &str) -> Option<(String, f64)> {
    let function = value.strip_suffix(')')?;
    let (opaque, alpha) = match function.matches(',').count() {
        3 => function.rsplit_once(',')?,
        _ => function.rsplit_once('/')?,
    };
    Some((format!("{})", opaque.trim_end()), part(alpha.trim())?))
}

/// A number from 0 to 1, or a percentage.
fn part(value: &str) -> Option<f64> {
    let part: f64 = match value.strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().ok()? / 100.0,
        None => value.parse().ok()?,
    };
    part.is_finite().then(|| part.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths and percentages are positive in a dash, as SVG has them.
    #[test]
    fn dashes_have_units_and_percentages() {
        for (value, dashed) in [
            ("2%,1%", true),
            ("2% 1%", true),
            ("3,2", true),
            ("1.5mm", true),
            ("none", false),
            ("0", false),
            ("0%", false),
            ("", false),
        ] {
            let mut style = Style::initial();
            style.set("stroke-dasharray", value);
            assert_eq!(style.dashed, dashed, "{value:?}");
        }
    }

    #[test]
    fn colours_have_an_alpha() {
        let red = Colour([255, 0, 0]);
        for (value, alpha) in [
            ("red", 1.0),
            ("#f00", 1.0),
            ("#f008", 136.0 / 255.0),
            ("#ff000080", 128.0 / 255.0),
            ("rgb(255,0,0)", 1.0),
            ("rgba(255,0,0,0.5)", 0.5),
            ("rgba(100%, 0%, 0%, 50%)", 0.5),
            ("rgb(255, 0, 0, .5)", 0.5),
            ("rgb(255 0 0)", 1.0),
            ("rgb(255 0 0 / 0.5)", 0.5),
            ("rgb(255 0 0 / 50%)", 0.5),
            ("rgb(255 0 0/50%)", 0.5),
            ("rgb(100% 0% 0% / 25%)", 0.25),
            ("hsla(0,100%,50%,.5)", 0.5),
            ("hsl(0 100% 50% / 50%)", 0.5),
            ("hwb(0 0% 0% / 0.25)", 0.25),
        ] {
            assert_eq!(colour(value), Some((red, alpha)), "{value}");
        }
        let style = Style::initial();
        for nothing in [
            "none",
            "transparent",
            "rgba(0,0,0,0)",
            "#0000",
            "rgb(1 2 3 / 0%)",
        ] {
            assert_eq!(style.ink(nothing), Ink::Nothing, "{nothing}");
        }
        for unknown in [
            "rebeccapurple",
            "color(srgb 1 0 0)",
            "rgb(255 0 0 / x)",
            "lab(50% 40 59)",
        ] {
            assert_eq!(style.ink(unknown), Ink::Unknown(unknown.to_owned()));
        }
        assert_eq!(style.ink("currentColor"), Ink::BLACK);
        assert_eq!(style.ink("currentcolor"), Ink::BLACK);
        let grey = Ink::of((Colour([128; 3]), 1.0));
        assert_eq!(style.ink("url(#gradient)"), grey);
        let printed = style.ink("#ff0000 icc-color(acmecmyk, 0, 1, 1, 0)");
        assert_eq!(printed, Ink::of((red, 1.0)));
    }
}
