//! Styles of elements: attributes, style sheets and inheritance.

use super::super::colour::Colour;
use roxmltree::Node;
use simplecss::{AttributeOperator, DeclarationTokenizer, Element, PseudoClass, StyleSheet};
use svgtypes::Paint;

/// How lines or areas are painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ink {
    Nothing,
    Colour(Colour),
}

/// What an element passes on to those in it.
#[derive(Clone, Debug)]
pub(super) struct Style {
    pub(super) stroke: Ink,
    pub(super) fill: Ink,
    pub(super) dashed: bool,
    /// That of lines alone.
    stroke_opacity: f64,
    /// The product of those of all groups.
    group_opacity: f64,
    pub(super) visible: bool,
    /// Whether it is shown at all, with all that is in it.
    pub(super) shown: bool,
    current: Colour,
}

impl Style {
    pub(super) fn initial() -> Self {
        Self {
            stroke: Ink::Nothing,
            fill: Ink::Colour(Colour::BLACK),
            dashed: false,
            stroke_opacity: 1.0,
            group_opacity: 1.0,
            visible: true,
            shown: true,
            current: Colour::BLACK,
        }
    }

    pub(super) fn opacity(&self) -> f64 {
        self.stroke_opacity * self.group_opacity
    }

    /// The style of an element in one of this style.
    pub(super) fn of(&self, node: Node<'_, '_>, sheet: &StyleSheet<'_>) -> Self {
        let mut style = self.clone();
        for attribute in node.attributes().filter(|a| a.namespace().is_none()) {
            style.set(attribute.name(), attribute.value());
        }
        let rules = sheet.rules.iter();
        for rule in rules.filter(|rule| rule.selector.matches(&Styled(node))) {
            for declaration in &rule.declarations {
                style.set(declaration.name, declaration.value);
            }
        }
        let own = node.attribute("style").unwrap_or_default();
        for declaration in DeclarationTokenizer::from(own) {
            style.set(declaration.name, declaration.value);
        }
        style
    }

    /// Takes over a property; what cannot be read changes nothing.
    fn set(&mut self, name: &str, value: &str) {
        let value = value.trim();
        if value == "inherit" {
            return;
        }
        match name {
            "stroke" => self.stroke = self.ink(value).unwrap_or(self.stroke),
            "fill" => self.fill = self.ink(value).unwrap_or(self.fill),
            "color" => {
                if let Ok(Paint::Color(c)) = Paint::from_str(value) {
                    self.current = Colour([c.red, c.green, c.blue]);
                }
            }
            "stroke-dasharray" => {
                let digits = value.split(|c: char| c == ',' || c.is_whitespace());
                let gap = |part: &str| {
                    part.trim_end_matches(char::is_alphabetic)
                        .parse()
                        .unwrap_or(0.0)
                        > 0.0
                };
                self.dashed = value != "none" && digits.into_iter().any(gap);
            }
            "stroke-opacity" => self.stroke_opacity = part(value).unwrap_or(self.stroke_opacity),
            "opacity" => self.group_opacity *= part(value).unwrap_or(1.0),
            "visibility" => self.visible = value == "visible",
            "display" => self.shown &= value != "none",
            _ => {}
        }
    }

    fn ink(&self, value: &str) -> Option<Ink> {
        Some(match Paint::from_str(value).ok()? {
            Paint::None => Ink::Nothing,
            Paint::Inherit => return None,
            Paint::CurrentColor => Ink::Colour(self.current),
            Paint::Color(c) if c.alpha == 0 => Ink::Nothing,
            Paint::Color(c) => Ink::Colour(Colour([c.red, c.green, c.blue])),
            // A gradient or a pattern has no colour of its own.
            _ => Ink::Colour(Colour([128; 3])),
        })
    }
}

/// A number from 0 to 1, or a percentage.
fn part(value: &str) -> Option<f64> {
    let part: f64 = match value.strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().ok()? / 100.0,
        None => value.parse().ok()?,
    };
    part.is_finite().then(|| part.clamp(0.0, 1.0))
}

/// An element as selectors of style sheets see it.
struct Styled<'a, 'input>(Node<'a, 'input>);

impl Element for Styled<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Self)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Self)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0
            .attribute(name)
            .is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.0.prev_sibling_element().is_none()
    }
}
