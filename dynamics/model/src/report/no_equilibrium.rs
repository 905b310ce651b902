//! Why a sheet has no equilibrium.

use isosheet_mesh::wording::brief;
use std::fmt;

/// Why a search for an equilibrium cannot end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoEquilibrium {
    /// The sheet moves on and on.
    Unheld {
        /// How far a vertex has moved, metres.
        distance: f64,
    },
    /// The search has not come to an end.
    NotFound,
    /// Forces balance only where a disturbance grows.
    Unstable,
    /// A force that depends on velocities acts at rest too, such as that of wind.
    Wind,
}

impl NoEquilibrium {
    /// What to do.
    pub fn advice(self) -> &'static str {
        match self {
            Self::Unheld { .. } => {
                "hold the sheet with a support, or let it begin where it lies on something: one that slides off has \
                 no equilibrium"
            }
            Self::NotFound | Self::Unstable => {
                "refine the mesh where it bends most, or let the sheet come to rest with another integrator"
            }
            Self::Wind => {
                "let the sheet come to rest with another integrator, or leave the wind out"
            }
        }
    }
}

impl fmt::Display for NoEquilibrium {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unheld { distance } => {
                let distance = brief(*distance);
                write!(
                    f,
                    "the sheet has moved by {distance} m, and nothing stops it"
                )
            }
            Self::NotFound => f.write_str("the search has not come to rest"),
            Self::Unstable => f.write_str("forces balance only where the least disturbance grows"),
            Self::Wind => {
                f.write_str("wind, or another force that depends on velocities, acts at rest")
            }
        }
    }
}
