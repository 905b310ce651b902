//! Supports and bodies that ask for more than the lengths allow.

use crate::report::support::Support;
use isosheet_mesh::VertexId;
use isosheet_mesh::wording::{brief, given, listed};
use std::fmt;

/// A demand that cannot be met.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Infeasibility {
    /// Of what moves, that which does most of the work.
    pub by: Driver,
    /// How far it would have to stay back for the lengths and gaps to be kept, to first order; metres.
    pub distance: f64,
    /// When it asks for this, seconds.
    pub t: f64,
    /// The limit of the strain, where an elastic sheet does not allow it, and not rods.
    pub strain_limit: Option<f64>,
    /// The vertices that bodies press, those pressed most first.
    #[serde(serialize_with = "as_numbers")]
    pub pressed: Vec<VertexId>,
    /// The other bodies that press the sheet.
    pub against: Vec<usize>,
}

fn as_numbers<S: serde::Serializer>(vertices: &[VertexId], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(vertices.iter().map(|v| v.0))
}

impl fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.named(|body| format!("body {body}")))
    }
}

impl Infeasibility {
    /// The demand in words, with bodies by the names that `name` gives for their numbers.
    pub fn named(&self, name: impl Fn(usize) -> String) -> String {
        let by = match self.by {
            Driver::Support(support) => support.to_string(),
            Driver::Body(body) => name(body),
        };
        let mut words = format!("{by} asks");
        if !self.pressed.is_empty() {
            words += &format!(" at {}", listed(&self.pressed));
        }
        words += &format!(" for {} m more than ", brief(self.distance));
        match self.strain_limit {
            Some(limit) => words += &format!("the strain limit of {}", given(limit)),
            None => words += "the rods",
        }
        for other in &self.against {
            words += &format!(" and {}", name(*other));
        }
        let allows = match self.strain_limit {
            Some(_) if self.against.is_empty() => "allows",
            _ => "allow",
        };
        format!("{words} {allows} at t = {} s", brief(self.t))
    }
}

/// What moves as the scene prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Driver {
    /// A support.
    Support(Support),
    /// A body, by its number.
    Body(usize),
}

impl fmt::Display for Driver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Support(support) => write!(f, "{support}"),
            Self::Body(body) => write!(f, "body {body}"),
        }
    }
}
