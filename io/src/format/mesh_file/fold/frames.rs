//! Frames of FOLD files and what they inherit.

use super::FoldProblem;
use crate::format::mesh_file::MeshFileProblem;
use crate::format::mesh_file::error::excerpt;
use serde::Deserialize;

/// What is used of a frame. All keys of the format are optional.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Frame {
    frame_parent: Option<usize>,
    frame_inherit: Option<bool>,
    frame_classes: Option<Vec<String>>,
    frame_unit: Option<String>,
    pub(super) vertices_coords: Option<Vec<Vec<f64>>>,
    pub(super) edges_vertices: Option<Vec<[u32; 2]>>,
    pub(super) edges_assignment: Option<Vec<Option<String>>>,
    /// In degrees. Version 1.0 has the plural.
    #[serde(rename = "edges_foldAngle", alias = "edges_foldAngles")]
    pub(super) fold_angles: Option<Vec<Option<f64>>>,
    pub(super) faces_vertices: Option<Vec<Vec<i64>>>,
}

/// The frames besides the key frame, whose keys are those of the file itself.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct File {
    file_frames: Option<Vec<Frame>>,
}

/// Reads one frame with what it inherits; without a number the first that has vertices.
pub(super) fn read(bytes: &[u8], wanted: Option<usize>) -> Result<Frame, MeshFileProblem> {
    if bytes.trim_ascii().is_empty() {
        return Err(MeshFileProblem::Empty);
    }
    let key: Frame = serde_json::from_slice(bytes).map_err(MeshFileProblem::Json)?;
    let file: File = serde_json::from_slice(bytes).map_err(MeshFileProblem::Json)?;
    let frames = [vec![key], file.file_frames.unwrap_or_default()].concat();
    if let Some(frame) = wanted {
        let last = frames.len() - 1;
        if frame > last {
            return Err(FoldProblem::NoFrame { frame, last }.into());
        }
        return Ok(inherited(&frames, frame)?);
    }
    for k in 0..frames.len() {
        let frame = inherited(&frames, k)?;
        if frame
            .vertices_coords
            .as_ref()
            .is_some_and(|v| !v.is_empty())
        {
            return Ok(frame);
        }
    }
    Err(FoldProblem::NoCoordinates.into())
}

/// A frame with the keys of its ancestors that it does not have itself. A frame that inherits and names no
/// parent inherits from the key frame.
fn inherited(frames: &[Frame], number: usize) -> Result<Frame, FoldProblem> {
    let mut frame = frames[number].clone();
    let (mut at, mut steps) = (number, 0);
    while at != 0 && frames[at].frame_inherit == Some(true) {
        let parent = frames[at].frame_parent.unwrap_or(0);
        steps += 1;
        // A chain without a circle is no longer than the list of frames.
        if parent >= frames.len() || steps > frames.len() {
            return Err(FoldProblem::Parent { frame: at, parent });
        }
        at = parent;
        let from = frames[parent].clone();
        frame = Frame {
            frame_classes: frame.frame_classes.or(from.frame_classes),
            frame_unit: frame.frame_unit.or(from.frame_unit),
            vertices_coords: frame.vertices_coords.or(from.vertices_coords),
            edges_vertices: frame.edges_vertices.or(from.edges_vertices),
            edges_assignment: frame.edges_assignment.or(from.edges_assignment),
            fold_angles: frame.fold_angles.or(from.fold_angles),
            faces_vertices: frame.faces_vertices.or(from.faces_vertices),
            ..frame
        };
    }
    Ok(frame)
}

impl Frame {
    /// Whether the frame says that it is of a class such as `creasePattern` or `foldedForm`.
    pub(super) fn has_class(&self, class: &str) -> bool {
        self.frame_classes.iter().flatten().any(|c| c == class)
    }

    /// The unit of the frame in metres; 1 if it has none.
    pub(super) fn metres(&self) -> Result<f64, FoldProblem> {
        Ok(match self.frame_unit.as_deref() {
            None | Some("unit" | "m") => 1.0,
            Some("in") => 0.0254,
            // A typographic point is the 72nd part of an inch.
            Some("pt") => 0.0254 / 72.0,
            Some("cm") => 1e-2,
            Some("mm") => 1e-3,
            Some("um") => 1e-6,
            Some("nm") => 1e-9,
            Some(found) => {
                let found = excerpt(found);
                return Err(FoldProblem::Unit { found });
            }
        })
    }
}
