//! Frames of FOLD files and what they inherit.

use super::lines::LineRecord;
use crate::mesh_file::error::{CORRECT, excerpt};
use crate::mesh_file::faces::empty;
use crate::mesh_file::{FoldFrame, MeshFileProblem};
use isosheet_files::DataError;
use serde::Deserialize;

/// What is used of a frame. All keys of the format are optional.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct FrameRecord {
    frame_title: Option<String>,
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
    /// The groups of each face.
    #[serde(rename = "faces_isosheet:group")]
    pub(super) groups: Option<Vec<Option<String>>>,
    /// How the lines of a drawing are drawn that edges follow, and of each edge which of them.
    #[serde(rename = "isosheet:lines")]
    pub(super) lines: Option<Vec<LineRecord>>,
    #[serde(rename = "edges_isosheet:lines")]
    pub(super) lines_of_edges: Option<Vec<Vec<usize>>>,
    /// The other frames; in the key frame alone, which has the keys of the file itself.
    file_frames: Option<Vec<FrameRecord>>,
}

/// Reads one frame with what it inherits; without a number the first that has vertices.
pub(super) fn read(
    bytes: &[u8],
    wanted: Option<&FoldFrame>,
) -> Result<FrameRecord, MeshFileProblem> {
    if bytes.trim_ascii().is_empty() {
        return Err(empty().into());
    }
    let mut key: FrameRecord = serde_json::from_slice(bytes)
        .map_err(|e| DataError::new(format!("the file is not valid FOLD: {e}"), CORRECT))?;
    let others = key.file_frames.take().unwrap_or_default();
    let frames: Vec<FrameRecord> = std::iter::once(key).chain(others).collect();
    if let Some(wanted) = wanted {
        return Ok(inherited(&frames, number_of(&frames, wanted)?)?);
    }
    for k in 0..frames.len() {
        let chain = ancestry(&frames, k)?;
        let mut coordinates = chain
            .iter()
            .filter_map(|&a| frames[a].vertices_coords.as_ref());
        if coordinates.next().is_some_and(|c| !c.is_empty()) {
            return Ok(inherited(&frames, k)?);
        }
    }
    let message = "no frame has `vertices_coords`, so the file has no shape";
    Err(DataError::new(message, "export it with coordinates").into())
}

/// The number of the frame that is asked for.
fn number_of(frames: &[FrameRecord], wanted: &FoldFrame) -> Result<usize, MeshFileProblem> {
    let problem = |found: Vec<usize>| {
        let what = match found.len() {
            0 => format!("there is no frame {wanted}"),
            count => format!("{count} frames have the title {wanted}"),
        };
        let message = format!("{what}; the frames of the file are {}", listed(frames));
        MeshFileProblem::Frame(DataError::new(message, "give the number of one of these"))
    };
    match wanted {
        FoldFrame::Number(number) if *number < frames.len() => Ok(*number),
        FoldFrame::Number(_) => Err(problem(Vec::new())),
        FoldFrame::Title(title) => {
            let has_title = |k: &usize| frames[*k].frame_title.as_ref() == Some(title);
            let found: Vec<usize> = (0..frames.len()).filter(has_title).collect();
            match found[..] {
                [number] => Ok(number),
                _ => Err(problem(found)),
            }
        }
    }
}

/// Most frames that an error lists: they fit on a screen.
const MOST_LISTED: usize = 12;

/// Characters of a title that an error shows.
const LONGEST_TITLE: usize = 80;

/// The frames of a file, with titles and classes, for an error.
fn listed(frames: &[FrameRecord]) -> String {
    let name = |(k, frame): (usize, &FrameRecord)| {
        let title = frame.frame_title.as_deref();
        let title = title.map_or(String::new(), |title| {
            let short: String = title.chars().take(LONGEST_TITLE).collect();
            format!(" {short:?}")
        });
        let classes: Vec<String> = frame
            .frame_classes
            .iter()
            .flatten()
            .map(|c| excerpt(c))
            .collect();
        match classes.is_empty() {
            true => format!("{k}{title}"),
            false => format!("{k}{title} ({})", classes.join(", ")),
        }
    };
    let mut names: Vec<String> = frames
        .iter()
        .enumerate()
        .take(MOST_LISTED)
        .map(name)
        .collect();
    if frames.len() > MOST_LISTED {
        names.push(format!("and so on to {}", frames.len() - 1));
    }
    names.join(", ")
}

/// More ancestors of a frame are refused: a circle has no end.
const MOST_ANCESTORS: usize = 1000;

/// A frame and its ancestors, from which it inherits, the nearest first. A frame that inherits and names no
/// parent inherits from the key frame.
fn ancestry(frames: &[FrameRecord], number: usize) -> Result<Vec<usize>, DataError> {
    let mut chain = vec![number];
    let mut at = number;
    while at != 0 && frames[at].frame_inherit == Some(true) {
        let parent = frames[at].frame_parent.unwrap_or(0);
        if parent >= frames.len() || chain.len() > MOST_ANCESTORS {
            let message = format!(
                "frame {at} inherits from frame {parent}, which does not exist, inherits from it in turn, or has too \
                 many ancestors"
            );
            return Err(DataError::new(message, "correct `frame_parent`").at(at));
        }
        chain.push(parent);
        at = parent;
    }
    Ok(chain)
}

/// A frame with the keys of its ancestors that it does not have itself.
fn inherited(frames: &[FrameRecord], number: usize) -> Result<FrameRecord, DataError> {
    let chain = ancestry(frames, number)?;
    let merge = |frame: FrameRecord, &ancestor: &usize| {
        let from = &frames[ancestor];
        FrameRecord {
            frame_title: None,
            frame_parent: None,
            frame_inherit: None,
            frame_classes: frame.frame_classes.or_else(|| from.frame_classes.clone()),
            frame_unit: frame.frame_unit.or_else(|| from.frame_unit.clone()),
            vertices_coords: frame
                .vertices_coords
                .or_else(|| from.vertices_coords.clone()),
            edges_vertices: frame.edges_vertices.or_else(|| from.edges_vertices.clone()),
            edges_assignment: frame
                .edges_assignment
                .or_else(|| from.edges_assignment.clone()),
            fold_angles: frame.fold_angles.or_else(|| from.fold_angles.clone()),
            faces_vertices: frame.faces_vertices.or_else(|| from.faces_vertices.clone()),
            groups: frame.groups.or_else(|| from.groups.clone()),
            lines: frame.lines.or_else(|| from.lines.clone()),
            lines_of_edges: (frame.lines_of_edges).or_else(|| from.lines_of_edges.clone()),
            file_frames: None,
        }
    };
    Ok(chain.iter().fold(FrameRecord::default(), merge))
}

impl FrameRecord {
    /// Whether the frame says that it is of a class such as `creasePattern` or `foldedForm`.
    pub(super) fn has_class(&self, class: &str) -> bool {
        self.frame_classes.iter().flatten().any(|c| c == class)
    }

    /// Whether the unit of the frame is a length.
    pub(super) fn has_length(&self) -> bool {
        self.frame_unit
            .as_deref()
            .is_some_and(|unit| unit != "unit")
    }

    /// The unit of the frame in metres; 1 if it has none.
    pub(super) fn metres(&self) -> Result<f64, DataError> {
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
                let message = format!("the unit {found:?} is unknown");
                let remedy = "use unit, in, pt, m, cm, mm, um or nm";
                return Err(DataError::new(message, remedy));
            }
        })
    }
}
