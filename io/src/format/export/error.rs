//! What can be wrong with a mesh or a series that is to be written.

use crate::format::{TrajectoryError, WriteError};
use isosheet_mesh::wording::{brief, counted, given};
use isosheet_mesh::{Advice, TopologyError, VertexId};
use thiserror::Error;

/// A mesh or a series of frames that cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The extension is not that of a format that is written.
    #[error(
        "{} is no format that can be written here (known are {})",
        if extension.is_empty() { "a name without extension".to_owned() } else { format!(".{extension}") },
        known.join(", ")
    )]
    Extension {
        /// The extension found, without a dot.
        extension: String,
        /// The extensions that are known.
        known: Vec<String>,
    },
    /// The trajectory has no frames.
    #[error("the trajectory has no frames")]
    NoFrames,
    /// There is no such frame.
    #[error(
        "there is no frame {frame}: the trajectory has {}, counted from 0",
        counted(*count, "frame", "frames")
    )]
    NoFrame {
        /// The frame.
        frame: usize,
        /// The number of frames.
        count: usize,
    },
    /// The rate of frames is not positive.
    #[error("{rate} frames a second were asked for")]
    Rate {
        /// Frames a second.
        rate: f64,
    },
    /// The last frame comes before the first one.
    #[error("frames from {first} to {last} were asked for")]
    Range {
        /// The first frame.
        first: usize,
        /// The last frame.
        last: usize,
    },
    /// A body has no pose, or another number of them than there are frames.
    #[error("{body} has {got} poses, and the trajectory {frames} frames")]
    Poses {
        /// The body.
        body: String,
        /// The number of its poses.
        got: usize,
        /// The number of frames.
        frames: usize,
    },
    /// The name of a body is none in all formats.
    #[error("{name:?} is no name of a body")]
    BodyName {
        /// The name.
        name: String,
    },
    /// The option `every` is 0.
    #[error("every 0th frame was asked for")]
    Every,
    /// The faces of the trajectory are no surface.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// The edges of the trajectory are not those of its faces.
    #[error(
        "the trajectory has no rest length of the edge between {a} and {b}: its edges do not belong \
         to its faces"
    )]
    MissingEdge {
        /// One end.
        a: VertexId,
        /// The other end.
        b: VertexId,
    },
    /// A rest length is not positive.
    #[error("the edge between {a} and {b} has the rest length {length} m", length = brief(*length))]
    RestLength {
        /// One end.
        a: VertexId,
        /// The other end.
        b: VertexId,
        /// The length, in metres.
        length: f64,
    },
    /// The number of assignments or values does not fit.
    #[error("{what}: there are {got} values, {expected} are needed")]
    Count {
        /// What the values are.
        what: String,
        /// How many there are.
        got: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A value of a field is NaN or infinite.
    #[error("value {index} of the field {name:?} is {value}", value = given(*value))]
    FieldNotFinite {
        /// The field.
        name: String,
        /// The index in its values.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Two fields have one name.
    #[error("there are two fields with the name {name:?}")]
    FieldName {
        /// The name.
        name: String,
    },
    /// A coordinate is not finite.
    #[error(
        "coordinate {} of {vertex} is {value}, and the file was not written", ["x", "y", "z"][*axis],
        value = given(*value)
    )]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// A coordinate is too large for the 32-bit floats of the format.
    #[error(
        "coordinate {} of {vertex} is {value}, too large for the 32-bit floats of this format", ["x", "y", "z"][*axis],
        value = given(*value)
    )]
    SinglePrecision {
        /// The vertex.
        vertex: VertexId,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// A face refers to a vertex that does not exist.
    #[error("face {face} refers to vertex {vertex} of {count}, counted from 0")]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// The format cannot hold so much.
    #[error("the file would have {count} {what}, more than the {limit} of this format")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How much there is.
        count: usize,
        /// How much there may be.
        limit: usize,
    },
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] WriteError),
    /// The frames could not be written as a trajectory.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
}

impl Advice for ExportError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Extension { .. } => Some("choose a known format"),
            Self::NoFrames => Some("let the run take a step, or record a state"),
            Self::NoFrame { .. } => Some("name one of these"),
            Self::Rate { .. } => Some("give a positive number"),
            Self::Range { .. } => Some("name the first one first"),
            Self::Poses { .. } => {
                Some("give a pose for each frame, or a single one for a body at rest")
            }
            Self::BodyName { .. } => {
                Some("use ASCII letters, digits and _, and no digit at the beginning")
            }
            Self::Every => Some("give 1 for all frames, 2 for every second one"),
            Self::Topology(error) => error.advice(),
            Self::RestLength { .. } => Some("give a positive length"),
            Self::FieldNotFinite { .. } => Some("give finite values"),
            Self::FieldName { .. } => Some(
                "rename one (strain, fold_angle, sheet, rod_force, contact_force, gap, plastic_angle, plastic_curvature_1 and _2, uv and TimeValue are \
                 taken)",
            ),
            Self::NotFinite { .. } => Some("go back to the last state that was finite"),
            Self::SinglePrecision { .. } => Some("scale the mesh, or use a format with 64 bits"),
            Self::IndexOutOfRange { .. } => Some("correct the mesh"),
            Self::TooLarge { .. } => Some("write fewer frames, or use another format"),
            Self::File(error) => error.advice(),
            Self::Trajectory(error) => error.advice(),
            Self::MissingEdge { .. } | Self::Count { .. } => None,
        }
    }
}

/// Checks that coordinates are finite and that faces refer to vertices.
pub(super) fn check_mesh(x: &[f64], faces: &[[u32; 3]]) -> Result<(), ExportError> {
    if let Some(k) = x.iter().position(|c| !c.is_finite()) {
        return Err(ExportError::NotFinite {
            vertex: VertexId::from_index(k / 3),
            axis: k % 3,
            value: x[k],
        });
    }
    let count = x.len() / 3;
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
            return Err(ExportError::IndexOutOfRange {
                face,
                vertex,
                count,
            });
        }
    }
    Ok(())
}

/// Coordinates as 32-bit floats, of which the difference of any two is finite too.
pub(super) fn single(x: &[f64]) -> Result<Vec<[f32; 3]>, ExportError> {
    let narrow = |(k, &c): (usize, &f64)| {
        let value = c as f32;
        if value.abs() <= f32::MAX / 2.0 {
            return Ok(value);
        }
        Err(ExportError::SinglePrecision {
            vertex: VertexId::from_index(k / 3),
            axis: k % 3,
            value: c,
        })
    };
    let numbers: Vec<f32> = x.iter().enumerate().map(narrow).collect::<Result<_, _>>()?;
    Ok(numbers.as_chunks::<3>().0.to_vec())
}

/// A count that the format holds in so many bits.
pub(super) fn fits<T: TryFrom<usize>>(
    what: &'static str,
    count: usize,
    limit: usize,
) -> Result<T, ExportError> {
    T::try_from(count).map_err(|_| ExportError::TooLarge { what, count, limit })
}
