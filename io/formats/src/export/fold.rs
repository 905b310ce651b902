//! FOLD 1.2 files.

use super::{ExportError, Series};
use crate::mesh_file::{EdgeAssignment, LineRecord, MeshFile};
use isosheet_files::{FileWriter, write_atomically};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What all frames of a file have in common, and what its first frame has.
#[derive(Serialize)]
struct FoldFile<'a> {
    file_spec: f64,
    file_creator: &'a str,
    file_classes: &'a [&'a str],
    frame_classes: &'a [&'a str],
    frame_attributes: &'a [&'a str],
    #[serde(skip_serializing_if = "Option::is_none")]
    frame_unit: Option<&'a str>,
    #[serde(rename = "isosheet:time", skip_serializing_if = "Option::is_none")]
    time: Option<f64>,
    vertices_coords: &'a [[f64; 3]],
    edges_vertices: Vec<[u32; 2]>,
    edges_assignment: Vec<&'a str>,
    /// Left out where no edge has an angle.
    #[serde(rename = "edges_foldAngle", skip_serializing_if = "Vec::is_empty")]
    fold_angles: Vec<Option<f64>>,
    /// Left out where edges follow no lines of a drawing.
    #[serde(rename = "isosheet:lines", skip_serializing_if = "Vec::is_empty")]
    lines: Vec<LineRecord>,
    #[serde(rename = "edges_isosheet:lines", skip_serializing_if = "Vec::is_empty")]
    lines_of_edges: Vec<Vec<usize>>,
    faces_vertices: &'a [[u32; 3]],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    file_frames: Vec<FoldFileFrame<'a>>,
}

/// A frame that has the edges and faces of the first one.
#[derive(Serialize)]
struct FoldFileFrame<'a> {
    frame_parent: u32,
    frame_inherit: bool,
    frame_classes: &'a [&'a str],
    #[serde(rename = "isosheet:time", skip_serializing_if = "Option::is_none")]
    time: Option<f64>,
    vertices_coords: &'a [[f64; 3]],
    /// Left out where they agree with the first frame.
    #[serde(rename = "edges_foldAngle", skip_serializing_if = "Vec::is_empty")]
    fold_angles: Vec<f64>,
}

const FOLDED: &[&str] = &["foldedForm"];
const PATTERN: &[&str] = &["creasePattern"];

/// Writes a series: the first frame as key frame, the others with their positions and fold angles. Fold
/// angles follow from the positions, in degrees.
///
/// Edges of the boundary are `B`; the others are `M`, `V` and `F` as the series knows, and `U` otherwise.
pub(super) fn write_series(path: &Path, series: &Series<'_>) -> Result<Vec<PathBuf>, ExportError> {
    let first = series.mesh(series.frames()[0])?;
    let degrees = |frame: usize| series.fold_angles(frame).into_iter().map(f64::to_degrees);
    let frames = series.frames();
    let (time, x) = series.state(frames[0]);
    let later = |&frame: &usize| {
        let (time, x) = series.state(frame);
        FoldFileFrame {
            frame_parent: 0,
            frame_inherit: true,
            frame_classes: FOLDED,
            time: Some(time),
            vertices_coords: x.as_chunks().0,
            fold_angles: degrees(frame).collect(),
        }
    };
    let file = FoldFile {
        file_spec: 1.2,
        file_creator: "isosheet",
        file_classes: if frames.len() > 1 {
            &["animation"]
        } else {
            &["singleModel"]
        },
        frame_classes: FOLDED,
        frame_attributes: &["3D", "manifold", "orientable"],
        frame_unit: Some("m"),
        time: Some(time),
        vertices_coords: x.as_chunks().0,
        edges_vertices: first.creases.iter().map(|c| c.ends).collect(),
        edges_assignment: first.creases.iter().map(|c| letter(c.assignment)).collect(),
        fold_angles: degrees(frames[0]).map(Some).collect(),
        lines: Vec::new(),
        lines_of_edges: Vec::new(),
        faces_vertices: series.faces(),
        file_frames: frames[1..].iter().map(later).collect(),
    };
    write_atomically(path, |w| write_json(w, &file))?;
    Ok(vec![path.to_owned()])
}

/// Writes one mesh with the creases that were read, and the lines of a drawing that they follow. Their fold
/// angles are taken from the file they were read from. Where it has none, mountains and valleys of a flat
/// pattern fold by 180 degrees, flat edges by 0, and the angle of others is null. Edges that were not read
/// are `B` if they have one face, and `U` otherwise.
pub(super) fn write_mesh(path: &Path, mesh: &MeshFile) -> Result<(), ExportError> {
    write_frames(path, mesh, Vec::new())
}

/// Writes a mesh as [`write_mesh`], and where its vertices are when it is folded as a second frame.
pub(super) fn write_folded(
    path: &Path,
    mesh: &MeshFile,
    folded: &[f64],
) -> Result<(), ExportError> {
    let frame = FoldFileFrame {
        frame_parent: 0,
        frame_inherit: true,
        frame_classes: FOLDED,
        time: None,
        vertices_coords: folded.as_chunks().0,
        fold_angles: Vec::new(),
    };
    write_frames(path, mesh, vec![frame])
}

/// Writes a mesh with frames that follow it.
fn write_frames(
    path: &Path,
    mesh: &MeshFile,
    file_frames: Vec<FoldFileFrame<'_>>,
) -> Result<(), ExportError> {
    let points = mesh.positions.as_chunks::<3>().0;
    let mut faces_at: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for &[a, b, c] in &mesh.faces {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            *faces_at.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let is_flat = points.iter().all(|p| p[2] == 0.0);
    let area = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| points[v as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let is_pattern = is_flat && mesh.faces.iter().all(|f| area(f) >= 0.0);
    let (mut ends, mut assignments, mut angles) = (Vec::new(), Vec::new(), Vec::new());
    let mut lines_of_edges = Vec::new();
    for crease in &mesh.creases {
        let [a, b] = crease.ends;
        faces_at.remove(&[a.min(b), a.max(b)]);
        ends.push(crease.ends);
        assignments.push(letter(crease.assignment));
        let whole = whole_angle(crease.assignment).filter(|_| is_pattern);
        angles.push(crease.angle.map(f64::to_degrees).or(whole));
        lines_of_edges.push(mesh.drawn.numbers(crease.drawn).collect());
    }
    for (edge, faces) in faces_at {
        ends.push(edge);
        assignments.push(if faces == 1 { "B" } else { "U" });
        angles.push(None);
        lines_of_edges.push(Vec::new());
    }
    let lines: Vec<LineRecord> = mesh.drawn.pens().iter().map(LineRecord::from).collect();
    if lines.is_empty() {
        lines_of_edges.clear();
    }
    if angles.iter().all(Option::is_none) {
        angles.clear();
    }
    let file = FoldFile {
        file_spec: 1.2,
        file_creator: "isosheet",
        file_classes: &["singleModel"],
        frame_classes: if is_pattern { PATTERN } else { FOLDED },
        frame_attributes: &[if is_flat { "2D" } else { "3D" }],
        frame_unit: mesh.in_metres.then_some("m"),
        time: None,
        vertices_coords: points,
        edges_vertices: ends,
        edges_assignment: assignments,
        fold_angles: angles,
        lines,
        lines_of_edges,
        faces_vertices: &mesh.faces,
        file_frames,
    };
    Ok(write_atomically(path, |w| write_json(w, &file))?)
}

/// The angle of an edge of a pattern that is folded flat, degrees, where its assignment says it.
fn whole_angle(assignment: EdgeAssignment) -> Option<f64> {
    match assignment {
        EdgeAssignment::Mountain => Some(-180.0),
        EdgeAssignment::Valley => Some(180.0),
        EdgeAssignment::Flat | EdgeAssignment::Join => Some(0.0),
        EdgeAssignment::Boundary | EdgeAssignment::Unassigned | EdgeAssignment::Cut => None,
    }
}

fn letter(assignment: EdgeAssignment) -> &'static str {
    match assignment {
        EdgeAssignment::Boundary => "B",
        EdgeAssignment::Mountain => "M",
        EdgeAssignment::Valley => "V",
        EdgeAssignment::Flat => "F",
        EdgeAssignment::Unassigned => "U",
        // Its two sides have vertices of their own by now.
        EdgeAssignment::Cut => "B",
        EdgeAssignment::Join => "J",
    }
}

fn write_json(w: &mut FileWriter<'_>, file: &FoldFile<'_>) -> io::Result<()> {
    serde_json::to_writer(&mut *w, file)?;
    w.write_all(b"\n")
}
