//! Why a plate cannot be made.

use crate::direction::DirectionError;
use crate::options::OptionsError;
use crate::patched::NoFace;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, EdgeId, FaceId, VertexId};
use isosheet_motion::MotionError;
use isosheet_motion::ProfileError;

/// Why the bending stiffness of a plate cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlateBendingError {
    /// The flexural rigidity is negative or not finite.
    #[error("the flexural rigidity is {rigidity} N m", rigidity = given(*rigidity))]
    Rigidity {
        /// The rigidity given, N m.
        rigidity: f64,
    },
    /// Poisson's ratio is out of range.
    #[error("Poisson's ratio is {ratio}", ratio = given(*ratio))]
    Poisson {
        /// The ratio given.
        ratio: f64,
    },
    /// The coupling of the two directions of an orthotropic plate leaves a bend without resistance.
    #[error("the coupling D12 of the plate is {coupling} N m", coupling = given(*coupling))]
    Coupling {
        /// The coupling, N m.
        coupling: f64,
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
    /// The natural curvature makes no sense.
    #[error(transparent)]
    Curl {
        /// Why.
        source: CurlError,
    },
    /// The motion of a clamp makes no sense.
    #[error(transparent)]
    Motion {
        /// Why.
        source: MotionError,
    },
    /// A clamped vertex does not exist.
    #[error("{vertex} is named as clamped, but the sheet has {count} vertices")]
    NoVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// An edge of a crease does not exist.
    #[error("{edge} is named as a crease, but the sheet has {count} edges")]
    NoEdge {
        /// The edge.
        edge: EdgeId,
        /// Number of edges.
        count: usize,
    },
    /// The plate cannot yield as it is to.
    #[error("the yield of the plate cannot be used: {source}")]
    Yield {
        /// What is wrong with it.
        source: OptionsError,
    },
}

impl Advice for PlateBendingError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Yield { source } => source.advice(),
            Self::Rigidity { .. } => {
                Some("give a finite one of at least 0; above 0 if it depends on the direction")
            }
            Self::Coupling { .. } => Some("give one whose square is less than D11 D22"),
            Self::Direction { source } => source.advice(),
            Self::Patch(error) => error.advice(),
            Self::Curl { source } => source.advice(),
            Self::Motion { source } => source.advice(),
            Self::Poisson { .. } => Some("give a value from 0 to 0.5"),
            Self::NoVertex { .. } | Self::NoEdge { .. } => None,
        }
    }
}

/// Why a curl makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurlError {
    /// A curvature is not finite.
    #[error("the natural curvature is {value} 1/m")]
    Curvature {
        /// The curvature, 1/m.
        value: f64,
    },
    /// There are not as many curvatures as faces.
    #[error("{found} natural curvatures are given for {expected} faces")]
    Count {
        /// How many there are.
        found: usize,
        /// Number of faces.
        expected: usize,
    },
    /// An edge is longer than the diameter of the circle that it would be a chord of.
    #[error(
        "{face} would roll up to the radius {radius} m, and has an edge of {length} m",
        radius = given(*radius), length = given(*length)
    )]
    Sharp {
        /// The face.
        face: FaceId,
        /// The smallest radius of curvature, metres.
        radius: f64,
        /// Its longest edge, metres.
        length: f64,
    },
    /// The direction is none.
    #[error(transparent)]
    Direction(#[from] DirectionError),
    /// The profile makes no sense.
    #[error(transparent)]
    Profile(#[from] ProfileError),
}

impl Advice for CurlError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Count { .. } => Some("give one for each face"),
            Self::Sharp { .. } => {
                Some("make the mesh finer, with edges below half the radius, or the radius larger")
            }
            Self::Curvature { .. } => Some("give finite curvatures, one over a radius"),
            Self::Direction(error) => error.advice(),
            Self::Profile(error) => error.advice(),
        }
    }
}
