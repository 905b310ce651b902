//! What presses the sheet where no step is found.

use isosheet_mesh::VertexId;
use isosheet_mesh::wording::{brief, listed};
use std::fmt;

/// A body that moves against the resistance of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressing {
    /// Its number.
    pub body: usize,
    /// The sum of its normal forces on the sheet at the last accepted state, newtons.
    pub force: f64,
    /// The vertices that it touches, those with the largest forces first.
    pub vertices: Vec<VertexId>,
    /// The other bodies that the sheet touches.
    pub against: Vec<usize>,
}

impl Pressing {
    /// What presses the sheet, in words, with bodies by the names that `name` gives for their numbers.
    pub fn named(&self, name: impl Fn(usize) -> String) -> String {
        let force = brief(self.force);
        let mut words = format!("{} presses the sheet with {force} N", name(self.body));
        for (k, other) in self.against.iter().enumerate() {
            words += if k == 0 { " against " } else { " and " };
            words += &name(*other);
        }
        format!("{words} at {}", listed(&self.vertices))
    }
}

impl fmt::Display for Pressing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.named(|body| format!("body {body}")))
    }
}
