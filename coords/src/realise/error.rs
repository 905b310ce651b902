//! Why a realisation fails.

use crate::assignment::Closure;
use crate::placement_error::PlacementError;
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, AngleTriple, EdgeId, VertexId};
use thiserror::Error;

/// Why a state cannot be realised, or coordinates cannot be read from it.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RealiseError {
    /// Eq. 10 is violated at an edge: its two triangles cannot be closed.
    #[error(
        "Eq. 10 is violated at {edge}, {vertex} cannot be placed: angles alpha {:.6}, beta {:.6}, gamma {:.6} rad \
         (|alpha - beta| <= gamma <= alpha + beta needed; squared height {height_squared})",
        angles.alpha, angles.beta, angles.gamma,
        height_squared = brief(*height_squared)
    )]
    Incompatible {
        /// The common edge of the two triangles.
        edge: EdgeId,
        /// The end of it that is being placed; the angles are those at the other end.
        vertex: VertexId,
        /// The angles, gamma from positions; [`AngleTriple::margin`] is negative.
        angles: AngleTriple,
        /// Squared height over the squared length of the first edge; negative.
        height_squared: f64,
    },
    /// Another placement failed.
    #[error("{vertex} cannot be placed from {known:?}: {source}")]
    Placement {
        /// The vertex.
        vertex: VertexId,
        /// The known vertices.
        known: Vec<VertexId>,
        /// The reason.
        source: PlacementError,
    },
    /// The coordinates do not satisfy the closure equations.
    #[error(
        "{count} closure edges do not have their lengths: the worst is {} with strain {strain} \
         (tolerance {tolerance})", worst.edge,
        strain = brief(*strain), tolerance = given(*tolerance)
    )]
    Closure {
        /// Number of closure edges.
        count: usize,
        /// The worst one.
        worst: Closure,
        /// Its strain, (length - rest length) / rest length.
        strain: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// Two edges meet elsewhere than in a common end.
    #[error("{} and {} come within {} m of each other", edges[0], edges[1], brief(*distance))]
    EdgesMeet {
        /// The edges.
        edges: [EdgeId; 2],
        /// How close they come, metres.
        distance: f64,
    },
    /// A slice has the wrong length.
    #[error("{what} has {found} values, expected {expected}")]
    WrongLength {
        /// Which argument.
        what: &'static str,
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
    },
    /// A value is not finite.
    #[error("{what} has the value {value} at index {index}", value = given(*value))]
    NotFinite {
        /// Which argument.
        what: &'static str,
        /// Index of the value.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A tolerance is out of range.
    #[error(
        "option {name} is {value}, outside the range from 2.2e-16, the round-off of a length, to \
         {max}",
        value = given(*value), max = given(*max)
    )]
    Tolerance {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Largest value that makes sense.
        max: f64,
    },
}

impl Advice for RealiseError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Placement { source, .. } => source.advice(),
            Self::Tolerance { .. } => Some("give a value in this range"),
            Self::Incompatible { .. }
            | Self::Closure { .. }
            | Self::EdgesMeet { .. }
            | Self::WrongLength { .. }
            | Self::NotFinite { .. } => None,
        }
    }
}
