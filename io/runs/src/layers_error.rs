//! Why the layers of a folded sheet have no order.

use isosheet_mesh::wording::brief;
use isosheet_mesh::{Advice, FaceId};
use thiserror::Error;

/// Why the panels of a run have no order.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LayersError {
    /// The run has no frame, or its scene does not fold a crease pattern.
    #[error("the run folds no crease pattern")]
    NoPattern,
    /// A panel is not flat on the others at the end.
    #[error("the sheet is not folded flat: a panel is {off:.0} degrees off the others at the end")]
    NotFlat {
        /// Its angle to the largest panel, degrees.
        off: f64,
    },
    /// Panels pass through each other.
    #[error("panels pass through each other from {:.0} % of the folding on", 100.0 * part)]
    Passing {
        /// The part of the folding that is done by then.
        part: f64,
    },
    /// Two panels lie in one place.
    #[error("two panels lie in one place: they are {} m apart, and {} m tell an order", brief(*apart), brief(*least))]
    Touching {
        /// Their mean distance, metres.
        apart: f64,
        /// The least distance that tells an order, metres.
        least: f64,
    },
    /// Panels lie on each other in a circle and have no layers one above the other.
    #[error("{} panels lie on each other in a circle, each on the one before: with the faces {}", faces.len(), numbers(faces))]
    Circle {
        /// A face of each panel.
        faces: Vec<FaceId>,
    },
}

fn numbers(faces: &[FaceId]) -> String {
    let numbers: Vec<String> = faces.iter().map(|f| f.index().to_string()).collect();
    numbers.join(", ")
}

impl Advice for LayersError {
    fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::NoPattern => "give the folder of a run of `isosheet fold`",
            Self::NotFlat { .. } => {
                "layers are of a sheet that is folded flat, by 180 degrees at each crease"
            }
            Self::Passing { .. } | Self::Touching { .. } => {
                "fold the pattern with `--contact`, so that panels keep a gap"
            }
            Self::Circle { .. } => {
                "look at the page of the run, which shows the panels from all sides"
            }
        })
    }
}
