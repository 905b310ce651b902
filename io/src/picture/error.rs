//! Why a picture cannot be made.

use isosheet_collide::ObstacleError;
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, VertexId};

/// Why a picture cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The picture has no pixels.
    #[error("the picture has {width} x {height} pixels")]
    Size {
        /// Width, pixels.
        width: usize,
        /// Height, pixels.
        height: usize,
    },
    /// There is no frame to draw.
    #[error("there is no such frame")]
    NoFrames,
    /// A picture of an animation has another size than the animation.
    #[error(
        "picture {frame} has {} x {} pixels, the animation {} x {}",
        found[0], found[1], size[0], size[1]
    )]
    FrameSize {
        /// The picture, from 0.
        frame: usize,
        /// Its width and height, pixels.
        found: [usize; 2],
        /// Width and height of the animation, pixels.
        size: [usize; 2],
    },
    /// An angle of the viewer is out of range.
    #[error("the {name} is {value} degrees", value = given(*value))]
    Angle {
        /// Which angle.
        name: &'static str,
        /// Its value, degrees.
        value: f64,
    },
    /// The wires have no width.
    #[error("wires have the width {width}", width = brief(*width))]
    Wire {
        /// The width given, pixels.
        width: f64,
    },
    /// The positions do not belong to the sheet.
    #[error("there are {count} coordinates for {vertices} vertices")]
    Coordinates {
        /// Coordinates given.
        count: usize,
        /// Vertices of the sheet.
        vertices: usize,
    },
    /// A coordinate is not finite.
    #[error("{vertex} is at {value}", value = given(*value))]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
        /// The coordinate, metres.
        value: f64,
    },
    /// A pin is no vertex of the sheet.
    #[error("the pin {vertex} is none of the {vertices} vertices of the sheet")]
    Pin {
        /// The vertex given.
        vertex: VertexId,
        /// Vertices of the sheet.
        vertices: usize,
    },
    /// A body has no geometry.
    #[error(transparent)]
    Body(#[from] ObstacleError),
    /// A vector drawing cannot be read.
    #[error("cannot read the vector drawing: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// A PNG file cannot be made.
    #[error("cannot write the PNG file: {0}")]
    Png(#[from] png::EncodingError),
}

impl Advice for PictureError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Size { .. } => Some("give at least one each way, and no more than memory holds"),
            Self::NoFrames => Some("choose frames that the run has"),
            Self::FrameSize { .. } => Some("draw all pictures in one size"),
            Self::Angle { .. } => Some("give a finite one, and an elevation from -90 to 90"),
            Self::Wire { .. } => Some("give a finite one of at least 0 pixels"),
            Self::Coordinates { .. } => Some("give three for each vertex"),
            Self::NotFinite { .. } => Some("draw finite positions"),
            Self::Pin { .. } => Some("name one of them"),
            Self::Body(error) => error.advice(),
            Self::Svg(..) => Some("give an SVG document"),
            Self::Png(..) => None,
        }
    }
}
