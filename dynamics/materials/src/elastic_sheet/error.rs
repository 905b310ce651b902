//! Why an elastic sheet cannot be made.

use crate::direction::DirectionError;
use crate::patched::NoFace;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, FaceId};
use isosheet_motion::ProfileError;

/// Why an elastic sheet cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ElasticSheetError {
    /// The stiffness is not positive or not finite.
    #[error("the membrane stiffness is {stiffness} N/m", stiffness = given(*stiffness))]
    Stiffness {
        /// The stiffness given, N/m.
        stiffness: f64,
    },
    /// Poisson's ratio is out of range.
    #[error("Poisson's ratio is {ratio}", ratio = given(*ratio))]
    Poisson {
        /// The ratio given.
        ratio: f64,
    },
    /// Poisson's ratio of an orthotropic sheet leaves a strain without resistance.
    #[error(
        "Poisson's ratio nu12 is {ratio}, and the root of E1 / E2 is {bound}",
        ratio = given(*ratio), bound = given(*bound)
    )]
    Coupling {
        /// The ratio given.
        ratio: f64,
        /// What it has to be less than.
        bound: f64,
    },
    /// The direction of the material is none.
    #[error(transparent)]
    Direction {
        /// Why.
        source: DirectionError,
    },
    /// A patch has a face that the sheet has not.
    #[error(transparent)]
    Patch(#[from] NoFace),
    /// The limit of the strain is not a positive number below one half.
    #[error("the limit of the strain is {limit}", limit = given(*limit))]
    Limit {
        /// The limit given.
        limit: f64,
    },
    /// The function of time by which lengths grow cannot be used.
    #[error("the swelling cannot be used: {0}")]
    Profile(#[from] ProfileError),
    /// A face has no area at rest, so that it has no strain.
    #[error("{face} has the area {area} m2 at rest", area = given(*area))]
    Face {
        /// The face.
        face: FaceId,
        /// Its area at rest, m2.
        area: f64,
    },
}

impl Advice for ElasticSheetError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Stiffness { .. } => Some("give a finite one above 0"),
            Self::Poisson { .. } => Some("give a value from 0 to 0.5"),
            Self::Coupling { .. } => Some("give a ratio whose size is less than this root"),
            Self::Direction { source } => source.advice(),
            Self::Patch(error) => error.advice(),
            Self::Limit { .. } => Some("give a value above 0 and below 0.5, for instance 0.01"),
            Self::Profile(error) => error.advice(),
            Self::Face { .. } => Some("remove the face, or mend the mesh"),
        }
    }
}
