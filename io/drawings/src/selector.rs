//! Lines that are meant, by layer, colour or dash.

use crate::{Colour, DrawnLines, Pen};
use isosheet_files::DataError;
use isosheet_mesh::wording::quoted;
use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

/// Some lines of a drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Selector {
    /// Lines in a layer, in a group or with a name of this text, in capital or small letters: `layer:NAME`.
    Layer(String),
    /// Lines of exactly this colour: `#rrggbb`.
    Exact(Colour),
    /// Lines of a colour that looks like the one of this name: `red`.
    Named(&'static str),
    /// Dashed lines: `dashed`.
    Dashed,
    /// Lines that are not dashed: `solid`.
    Solid,
}

impl Selector {
    /// Whether lines of a pen are meant.
    pub fn selects(&self, pen: &Pen) -> bool {
        match self {
            Self::Layer(name) => {
                let mut layers = pen.layers.iter();
                layers.any(|l| l.to_lowercase() == name.to_lowercase())
            }
            Self::Exact(colour) => pen.colour == *colour,
            Self::Named(name) => pen.colour.name() == Some(name),
            Self::Dashed => pen.dashed,
            Self::Solid => !pen.dashed,
        }
    }

    /// Whether one of the lines is meant that an edge follows, by its
    /// number in [`DrawnLines`].
    pub fn selects_any(&self, lines: &DrawnLines, drawn: Option<u32>) -> bool {
        lines.pens_of(drawn).any(|pen| self.selects(pen))
    }

    /// Which of several selectors counts: the lowest.
    pub(super) fn rank(&self) -> usize {
        match self {
            Self::Layer(_) => 0,
            Self::Exact(_) => 1,
            Self::Named(_) => 2,
            Self::Dashed | Self::Solid => 3,
        }
    }
}

impl FromStr for Selector {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(name) = text.strip_prefix("layer:") {
            return Ok(Self::Layer(name.to_owned()));
        }
        if let Some(name) = Colour::NAMES.into_iter().find(|name| *name == text) {
            return Ok(Self::Named(name));
        }
        match text {
            "dashed" => return Ok(Self::Dashed),
            "solid" => return Ok(Self::Solid),
            "gray" => return Ok(Self::Named("grey")),
            _ => {}
        }
        match Colour::parse(text) {
            Some(colour) => Ok(Self::Exact(colour)),
            None => Err(format!(
                "{text:?} selects no lines: write layer:NAME, a colour such as red or #ff8000, dashed or solid"
            )),
        }
    }
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Layer(name) => write!(f, "layer:{name}"),
            Self::Exact(Colour([r, g, b])) => write!(f, "#{r:02x}{g:02x}{b:02x}"),
            Self::Named(name) => f.write_str(name),
            Self::Dashed => f.write_str("dashed"),
            Self::Solid => f.write_str("solid"),
        }
    }
}

/// Refuses a selector that selects nothing: what it was meant for would be taken for something else.
///
/// # Errors
/// [`DataError`] with the colours and layers that there are.
pub fn refuse_idle(selector: &Selector, pens: &[Pen]) -> Result<(), DataError> {
    if pens.iter().any(|pen| selector.selects(pen)) {
        return Ok(());
    }
    let colours: BTreeSet<String> = pens.iter().map(|p| p.colour.to_string()).collect();
    let layers: BTreeSet<&str> = pens
        .iter()
        .flat_map(|p| &p.layers)
        .map(String::as_str)
        .collect();
    let message = format!(
        "{selector} selects no line: the colours are {}, and the layers and names {}",
        listed(colours.into_iter().collect()),
        listed(layers.iter().map(|name| quoted(name)).collect())
    );
    Err(DataError::new(
        message,
        "name lines that the drawing has, or leave it out",
    ))
}

/// Most names that an error lists.
const MOST_LISTED: usize = 12;

/// The first of some names, and the number of the others.
pub fn listed(names: Vec<String>) -> String {
    match names.len() {
        0 => "none".to_owned(),
        n if n > MOST_LISTED => format!(
            "{} and {} more",
            names[..MOST_LISTED].join(", "),
            n - MOST_LISTED
        ),
        _ => names.join(", "),
    }
}
