//! Supports and bodies that ask for more than the lengths allow.

use crate::model::support::Support;
use isosheet_mesh::VertexId;
use isosheet_mesh::wording::{brief, given, listed};
use std::fmt;

/// A demand that cannot be met.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
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
        write!(f, "{} asks", self.by)?;
        if !self.pressed.is_empty() {
            write!(f, " at {}", listed(&self.pressed))?;
        }
        write!(f, " for {} m more than ", brief(self.distance))?;
        match self.strain_limit {
            Some(limit) => write!(f, "the strain limit of {}", given(limit))?,
            None => f.write_str("the rods")?,
        }
        if let Some((last, first)) = self.against.split_last() {
            let plural = if first.is_empty() { "body" } else { "bodies" };
            let numbers = first
                .iter()
                .map(|body| format!("{body}, "))
                .collect::<String>();
            write!(f, " and {plural} {numbers}{last}")?;
        }
        let allows = match self.strain_limit {
            Some(_) if self.against.is_empty() => "allows",
            _ => "allow",
        };
        write!(f, " {allows} at t = {} s", brief(self.t))
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
