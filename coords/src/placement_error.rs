//! Why a frame has no angle, or a vertex no position.

use isosheet_mesh::Advice;
use isosheet_mesh::wording::brief;
use thiserror::Error;

/// Why a vertex cannot be placed, or a coordinate is not defined.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlacementError {
    /// Two points that must differ coincide, or a coordinate is not finite.
    #[error(
        "two vertices coincide or are not finite (distance {distance})",
        distance = brief(*distance)
    )]
    Coincident {
        /// Distance found, metres.
        distance: f64,
    },
    /// The edge points along the polar axis of its spherical frame.
    #[error(
        "the edge points at the pole of its spherical frame (sine {sine})",
        sine = brief(*sine)
    )]
    Pole {
        /// Sine of the angle to the polar axis.
        sine: f64,
    },
    /// The edge points against the reference edge of its frame.
    #[error(
        "the edge is antiparallel to its reference edge (1 + cosine {one_plus_cosine})",
        one_plus_cosine = brief(*one_plus_cosine)
    )]
    Antiparallel {
        /// One plus the cosine of the angle between the two.
        one_plus_cosine: f64,
    },
    /// The vertex lies on the line it should turn about.
    #[error(
        "the vertex lies on the line of its two known neighbours (sine {sine}): its angle is undefined",
        sine = brief(*sine)
    )]
    OnAxis {
        /// Sine of the angle at vertex I.
        sine: f64,
    },
    /// The spheres around the known neighbours have no common point: Eq. 10 is violated.
    #[error(
        "no position keeps the edge lengths: the squared height would be {height_squared} of the squared edge length",
        height_squared = brief(*height_squared)
    )]
    OutOfReach {
        /// Squared height (or radius) over squared length of the first edge; negative.
        height_squared: f64,
    },
    /// Three known neighbours on a line: the degenerate case of Fig. 7.
    #[error(
        "the three known neighbours are collinear (sine {sine}): one coordinate is free",
        sine = brief(*sine)
    )]
    Collinear {
        /// Sine of the smallest angle of their triangle.
        sine: f64,
    },
    /// The position is at a fold of the map (flat configuration): it has no derivative there.
    #[error(
        "the placement has no derivative here: the vertex is in the plane of its known neighbours"
    )]
    Flat,
}

impl Advice for PlacementError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Pole { .. } | Self::Antiparallel { .. } => Some("rebase the chart"),
            Self::Coincident { .. }
            | Self::OnAxis { .. }
            | Self::OutOfReach { .. }
            | Self::Collinear { .. }
            | Self::Flat => None,
        }
    }
}
