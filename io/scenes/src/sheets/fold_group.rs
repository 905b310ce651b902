//! Groups of creases that fold one after the other.

use crate::meshes::drawing::check_lines;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use isosheet_drawings::{DrawnLines, Selector, refuse_idle};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Some creases of a pattern.
///
/// ```toml
/// version = 1
///
/// [sheet]
/// mesh = { file = { path = "crane.fold" } }
/// material = "office paper"
///
/// [folding]
/// stiffness = 0.05
/// time = 3
/// order = ["valleys", { edges = [3, 7] }, { drawn = ["layer:Wings"] }, "mountains"]
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FoldGroup {
    /// Creases with a negative angle.
    Mountains,
    /// Creases with a positive angle.
    Valleys,
    /// Creases by the numbers of their edges in the file, from 0. (For a drawing, the numbers in the FOLD
    /// file that `isosheet convert` makes of it.)
    Edges(Vec<usize>),
    /// Creases along lines of the drawing that the mesh is made of, in the words that select lines there:
    /// `["layer:Wings", "#e6007e"]`. The mesh is an SVG file, a drawing, or a FOLD file that `isosheet mesh`
    /// made of one.
    Drawn(Vec<String>),
}

/// A crease that is driven to an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatternCrease {
    /// The number of its edge in the file.
    pub(crate) edge: usize,
    /// Radians.
    pub(crate) angle: f64,
    /// The lines that it follows.
    pub(crate) drawn: Option<u32>,
}

impl FoldGroup {
    /// Whether it has a crease of a mesh that is made of some lines.
    pub(crate) fn has(&self, crease: &PatternCrease, lines: &DrawnLines) -> bool {
        match self {
            Self::Mountains => crease.angle < 0.0,
            Self::Valleys => crease.angle > 0.0,
            Self::Edges(edges) => edges.contains(&crease.edge),
            Self::Drawn(_) => self
                .selectors()
                .any(|(_, selector)| selector.selects_any(lines, crease.drawn)),
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        if let Self::Drawn(lines) = self {
            check_lines(lines, &key.name("drawn"), checks);
        }
    }

    /// Refuses words that select no line.
    pub(crate) fn refuse_idle(&self, lines: &DrawnLines, key: &Key) -> Result<(), Problem> {
        for (k, selector) in self.selectors() {
            let key = key.name("drawn").entry(k);
            if lines.pens().is_empty() {
                let message = "the mesh of the sheet does not say which lines of a drawing its creases follow";
                let remedy = "fold the drawing itself, or a FOLD file that `isosheet mesh` made of it, or name creases by the \
                              numbers of their edges";
                return Err(Problem::new(key, message, remedy));
            }
            refuse_idle(&selector, lines.pens()).map_err(|e| Problem::from_error(key, &e))?;
        }
        Ok(())
    }

    /// The selectors of lines with their numbers; selectors that cannot be read were refused.
    fn selectors(&self) -> impl Iterator<Item = (usize, Selector)> {
        let lines = match self {
            Self::Drawn(lines) => &lines[..],
            Self::Mountains | Self::Valleys | Self::Edges(_) => &[],
        };
        let lines = lines.iter().enumerate();
        lines.filter_map(|(k, text)| Some((k, text.parse().ok()?)))
    }

    /// As a sentence has it.
    pub fn in_words(&self) -> String {
        match self {
            Self::Mountains => "mountains".to_owned(),
            Self::Valleys => "valleys".to_owned(),
            Self::Edges(edges) => {
                let numbers: Vec<String> = edges.iter().map(usize::to_string).collect();
                format!("edges {}", numbers.join(" "))
            }
            Self::Drawn(lines) => lines.join(", "),
        }
    }
}

/// As a command line has it: `mountains`, `valleys`, numbers of edges, or lines of the drawing with `,`
/// between them.
impl FromStr for FoldGroup {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "mountain" | "mountains" => return Ok(Self::Mountains),
            "valley" | "valleys" => return Ok(Self::Valleys),
            _ => {}
        }
        let words = text.split([' ', ',']).filter(|word| !word.is_empty());
        let edges: Result<Vec<usize>, _> = words.map(str::parse).collect();
        if let Some(edges) = edges.ok().filter(|edges| !edges.is_empty()) {
            return Ok(Self::Edges(edges));
        }
        let lines = text.split(',').map(str::trim);
        let lines: Vec<String> = lines
            .filter(|line| !line.is_empty())
            .map(str::to_owned)
            .collect();
        match lines.iter().all(|line| line.parse::<Selector>().is_ok()) && !lines.is_empty() {
            true => Ok(Self::Drawn(lines)),
            false => Err(format!(
                "{text:?} is no group of creases: write mountains, valleys, numbers of edges, or lines of the drawing \
                 (layer:NAME, a colour such as red or #ff8000, dashed or solid)"
            )),
        }
    }
}

/// As a scene has it.
impl fmt::Display for FoldGroup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mountains => f.write_str("\"mountains\""),
            Self::Valleys => f.write_str("\"valleys\""),
            Self::Edges(edges) => write!(f, "{{ edges = {edges:?} }}"),
            Self::Drawn(lines) => {
                let lines = toml::Value::from(lines.clone());
                write!(f, "{{ drawn = {lines} }}")
            }
        }
    }
}
