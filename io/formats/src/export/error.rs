//! What can be wrong with a mesh or a series that is to be written.

use isosheet_files::{DataError, FileError};
use isosheet_mesh::wording::given;
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
    /// The frames that are asked for do not exist, or their rate makes no sense.
    #[error(transparent)]
    Frames(DataError),
    /// What is to be written does not fit together, or the format cannot hold it.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The faces of the trajectory are no surface.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Advice for ExportError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Extension { extension, .. } => Some(match &extension.to_lowercase()[..] {
                "abc" => {
                    "write .usda, which Blender, Houdini and Maya read where they read Alembic, or .glb"
                }
                "fbx" => {
                    "write .glb or .usda, which Blender and engines of games read where they read FBX"
                }
                _ => "choose a known format",
            }),
            Self::Frames(error) | Self::Data(error) => error.advice(),
            Self::Topology(error) => error.advice(),
            Self::File(error) => error.advice(),
        }
    }
}

/// Checks that coordinates are finite and that faces refer to vertices.
pub(super) fn check_mesh(x: &[f64], faces: &[[u32; 3]]) -> Result<(), ExportError> {
    if let Some(k) = x.iter().position(|c| !c.is_finite()) {
        let why = ", and the file was not written";
        return Err(wrong_coordinate(
            k,
            x[k],
            why,
            "go back to the last state that was finite",
        ));
    }
    let count = x.len() / 3;
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
            let message =
                format!("face {face} refers to vertex {vertex} of {count}, counted from 0");
            return Err(DataError::new(message, "correct the mesh").at(face).into());
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
        let why = ", too large for the 32-bit floats of this format";
        let remedy = "scale the mesh, or use a format with 64 bits";
        Err(wrong_coordinate(k, c, why, remedy))
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
    T::try_from(count).map_err(|_| {
        let message =
            format!("the file would have {count} {what}, more than the {limit} of this format");
        DataError::new(message, "write fewer frames, or use another format").into()
    })
}

/// An entry of a list of coordinates that cannot be written, and why.
fn wrong_coordinate(entry: usize, value: f64, why: &str, remedy: &'static str) -> ExportError {
    let (vertex, axis) = (VertexId::from_index(entry / 3), ["x", "y", "z"][entry % 3]);
    let message = format!("coordinate {axis} of {vertex} is {}{why}", given(value));
    let error = DataError::new(message, remedy);
    error.at(vertex.index()).value(value).into()
}

/// There is another number of values than there should be.
pub(super) fn check_count(what: &str, got: usize, expected: usize) -> Result<(), ExportError> {
    if got == expected {
        return Ok(());
    }
    let message = format!("{what}: there are {got} values, {expected} are needed");
    Err(DataError::plain(message).into())
}
