//! Reading FOLD files (Flexible Origami List Datastructure, versions 1.0 to 1.2,
//! <https://github.com/edemaine/fold>).

mod cuts;
mod frames;
mod lines;
mod sides;
#[cfg(test)]
mod tests;

use super::error::{Located, Location};
use super::faces::Polyhedron;
use super::plane::{self, NEAR, Point};
use super::{EdgeAssignment, FileCrease, MeshFile, MeshOptions};
use crate::mesh_file::pattern::{self, FileUnit, Planar, planar};
use frames::FrameRecord;
use isosheet_files::DataError;
use isosheet_mesh::wording::{brief, counted};
pub(crate) use lines::LineRecord;
use std::collections::HashMap;

/// Reads a frame of a FOLD file.
///
/// - Vertices have two or three coordinates; two mean z = 0. A `frame_unit` that is a length is converted to
///   metres.
/// - Without `faces_vertices` the faces come from the flat crease pattern, and also if the faces of the file
///   leave out creases. Vertices of the pattern that are at one place are one then.
/// - The faces of a flat frame that is no folded form are made counter-clockwise, as the format demands.
///   Mountains, valleys and fold angles are as seen from the side from which faces are counter-clockwise, so
///   that those at reversed faces are turned with them.
/// - Edges with the assignment `C` separate the sheet: vertices there are doubled.
/// - Fold angles are degrees in the file.
/// - The keys `isosheet:lines` and `edges_isosheet:lines` say which lines of a drawing edges follow
///   ([`lines`]).
/// - The key `faces_isosheet:group` has the name of a group, or null, for each of `faces_vertices`.
pub(super) fn parse(bytes: &[u8], options: &MeshOptions) -> Result<MeshFile, Located> {
    let plain = |problem| (None, problem);
    let frame = frames::read(bytes, options.frame.as_ref()).map_err(plain)?;
    let mut polyhedron = Polyhedron::default();
    add_vertices(&frame, &mut polyhedron).map_err(|e| plain(e.into()))?;
    let vertices = polyhedron.positions.len() / 3;
    let is_folded = frame.has_class("foldedForm");
    let mut edges = read_edges(&frame, vertices).map_err(|e| plain(e.into()))?;
    let drawn = lines::read(
        frame.lines.as_deref().unwrap_or_default(),
        frame.lines_of_edges.as_deref().unwrap_or_default(),
        &mut edges,
    );
    let drawn = drawn.map_err(|e| plain(e.into()))?;
    if !is_folded {
        check_angles(&edges).map_err(|e| plain(e.into()))?;
    }
    let points = polyhedron.positions.as_chunks::<3>().0;
    let is_flat = points.iter().all(|p| p[2] == 0.0);
    let mut drawing = Planar::default();
    let given = frame
        .faces_vertices
        .as_ref()
        .filter(|faces| !faces.is_empty());
    // Faces that leave out creases are no faces of the pattern.
    let is_pattern = is_flat && !is_folded && frame.groups.is_none() && !edges.is_empty();
    // What refers to vertices that do not exist is refused below.
    let exist = |faces: &[Vec<i64>]| {
        faces
            .iter()
            .flatten()
            .all(|v| (0..vertices as i64).contains(v))
    };
    let faces_fit = |faces: &[Vec<i64>]| !is_pattern || !exist(faces) || sides::fit(faces, &edges);
    let mut replaced_faces = 0;
    let mut faces = match given {
        Some(faces) if faces_fit(faces) => faces.clone(),
        _ if edges.is_empty() => Vec::new(),
        _ if !is_flat => {
            let message = "the file has no `faces_vertices`, and its vertices do not lie in the plane z = 0, in which \
                           alone faces can be made";
            let error = DataError::new(message, "export the file with its faces");
            return Err(plain(error.into()));
        }
        _ => {
            replaced_faces = given.map_or(0, Vec::len);
            drawing = match is_folded {
                true => folded_drawing(points, &edges),
                false => pattern::of_edges(points, &edges, options.weld),
            }
            .and_then(|planar| planar.closed(FileUnit::SAME))
            .map_err(|e| plain(without_faces(e).into()))?;
            edges = std::mem::take(&mut drawing.edges);
            polyhedron.positions = std::mem::take(&mut drawing.points).into_flattened();
            std::mem::take(&mut drawing.faces)
        }
    };
    let points = polyhedron.positions.as_chunks::<3>().0;
    let (mut sides, mut reversed_faces) = (Vec::new(), 0);
    for (k, face) in faces.iter_mut().enumerate() {
        let is_reversed = is_flat && !is_folded && is_clockwise(points, face);
        if is_reversed {
            face.reverse();
            reversed_faces += 1;
        }
        sides.extend(sides::sides_of(k, face, is_reversed));
    }
    if !faces.is_empty() {
        sides::check_faces(&edges, &sides).map_err(|e| plain(e.into()))?;
    }
    sides::turn(&mut edges, &sides).map_err(|e| plain(e.into()))?;
    let groups = read_groups(&frame, faces.len()).map_err(|e| plain(e.into()))?;
    for (k, face) in faces.into_iter().enumerate() {
        polyhedron.push_face(face, Location::Face(k));
        if let Some(Some(group)) = groups.get(k) {
            polyhedron.push_group(group);
        }
    }
    polyhedron.lines = edges.len();
    let mut mesh = polyhedron.assemble(options)?;
    mesh.in_metres = frame.has_length();
    mesh.changes.welded_vertices = drawing.welded;
    mesh.drawn = drawn;
    drawing.edges = edges;
    mesh.take_edges(drawing);
    mesh.changes.reversed_faces = reversed_faces;
    mesh.changes.replaced_faces = replaced_faces;
    mesh.changes.inner_boundaries = mesh.boundaries_inside().count();
    if given.is_none() || replaced_faces > 0 {
        mesh.drop_unreferenced();
    }
    mesh.separate_cuts();
    Ok(mesh)
}

/// The planar graph of a folded form without faces, in which vertices at one place are different ones.
fn folded_drawing(points: &[Point], edges: &[FileCrease]) -> Result<Planar, DataError> {
    planar(points.to_vec(), edges, NEAR * pattern::extent(points))
}

/// The edges of a file make no faces.
fn without_faces(mut e: DataError) -> DataError {
    e.message = format!(
        "the file has no `faces_vertices` that fit its edges, and {}",
        e.message
    );
    e
}

fn add_vertices(frame: &FrameRecord, polyhedron: &mut Polyhedron) -> Result<(), DataError> {
    let unit = frame.metres()?;
    for (vertex, p) in frame.vertices_coords.iter().flatten().enumerate() {
        let [x, y, rest @ ..] = &p[..] else {
            let message = format!("vertex {vertex} has {} coordinates", p.len());
            return Err(DataError::new(message, "give two or three").at(vertex));
        };
        let (z, more) = rest.split_first().unwrap_or((&0.0, &[]));
        if more.iter().any(|&c| c != 0.0) {
            let message = format!("vertex {vertex} has a fourth coordinate");
            let remedy = "give two or three: only the space of three dimensions is supported";
            return Err(DataError::new(message, remedy).at(vertex));
        }
        polyhedron.push_vertex([x, y, z].map(|c| unit * c))?;
    }
    Ok(())
}

/// The group of each face, if faces have any.
fn read_groups(frame: &FrameRecord, faces: usize) -> Result<&[Option<String>], DataError> {
    let groups = frame.groups.as_deref().unwrap_or_default();
    match groups.len() {
        0 => Ok(groups),
        found if found == faces => Ok(groups),
        found => {
            let message = format!("`faces_isosheet:group` has {found} entries for {faces} faces");
            let remedy = "give one for each of `faces_vertices`, null for a face of no group";
            Err(DataError::new(message, remedy))
        }
    }
}

/// The edges with their assignments and angles.
fn read_edges(frame: &FrameRecord, vertices: usize) -> Result<Vec<FileCrease>, DataError> {
    let Some(ends) = &frame.edges_vertices else {
        return Ok(Vec::new());
    };
    let same_length = |array: &str, got: Option<usize>| match got {
        Some(got) if got != ends.len() => {
            let message = format!("`{array}` has {got} entries for {} edges", ends.len());
            Err(DataError::new(message, "give one for each edge"))
        }
        _ => Ok(()),
    };
    let (assignments, angles) = (&frame.edges_assignment, &frame.fold_angles);
    same_length("edges_assignment", assignments.as_ref().map(Vec::len))?;
    same_length("edges_foldAngle", angles.as_ref().map(Vec::len))?;
    let mut seen = HashMap::new();
    let crease = |(edge, &ends): (usize, &[u32; 2])| {
        if let Some(&vertex) = ends.iter().find(|&&v| v as usize >= vertices) {
            let message = format!(
                "edge {edge} refers to vertex {vertex}, but the file has {}, counted from 0",
                counted(vertices, "vertex", "vertices")
            );
            return Err(DataError::new(message, "correct `edges_vertices`").at(edge));
        }
        let [a, b] = ends;
        if a == b {
            let message = format!("edge {edge} leads from vertex {a} to the same vertex");
            return Err(DataError::new(message, "remove it").at(edge));
        }
        if let Some(first) = seen.insert(sides::sorted(ends), edge) {
            let message = format!(
                "edges {first} and {edge} are the same edge, between the vertices {a} and {b}"
            );
            return Err(DataError::new(message, "remove one of them").at(edge));
        }
        let text = assignments.as_ref().and_then(|a| a[edge].as_deref());
        let angle = angles.as_ref().and_then(|a| a[edge]);
        if let Some(degrees) = angle.filter(|a| !(-180.0..=180.0).contains(a)) {
            let message = format!("edge {edge} has the fold angle {} degrees", brief(degrees));
            let error = DataError::new(message, "give -180 to 180");
            return Err(error.at(edge).value(degrees));
        }
        Ok(FileCrease {
            ends,
            assignment: assignment(edge, text)?,
            angle: angle.map(f64::to_radians),
            drawn: None,
        })
    };
    ends.iter().enumerate().map(crease).collect()
}

/// Refuses fold angles of a crease pattern that its assignments exclude. The angles of a folded form are what
/// the folds have come to.
fn check_angles(edges: &[FileCrease]) -> Result<(), DataError> {
    let contradicts = |crease: &FileCrease| {
        let angle = crease.angle.unwrap_or(0.0);
        match crease.assignment {
            EdgeAssignment::Mountain => angle > 0.0,
            EdgeAssignment::Valley => angle < 0.0,
            EdgeAssignment::Flat | EdgeAssignment::Join => angle != 0.0,
            EdgeAssignment::Boundary | EdgeAssignment::Unassigned | EdgeAssignment::Cut => false,
        }
    };
    match edges.iter().position(contradicts) {
        Some(edge) => {
            let degrees = edges[edge].angle.unwrap_or(0.0).to_degrees();
            let message = format!(
                "edge {edge} {} and has the fold angle {} degrees",
                edges[edge].assignment,
                brief(degrees)
            );
            let remedy = "correct one of them: mountains have negative angles, valleys positive ones, flat edges 0";
            Err(DataError::new(message, remedy).at(edge).value(degrees))
        }
        None => Ok(()),
    }
}

fn assignment(edge: usize, text: Option<&str>) -> Result<EdgeAssignment, DataError> {
    Ok(match text {
        Some("B" | "b") => EdgeAssignment::Boundary,
        Some("M" | "m") => EdgeAssignment::Mountain,
        Some("V" | "v") => EdgeAssignment::Valley,
        Some("F" | "f") => EdgeAssignment::Flat,
        Some("U" | "u") | None => EdgeAssignment::Unassigned,
        Some("C" | "c") => EdgeAssignment::Cut,
        Some("J" | "j") => EdgeAssignment::Join,
        Some(text) => {
            let found = super::error::excerpt(text);
            let message = format!("edge {edge} has the assignment {found:?}");
            return Err(DataError::new(message, "use B, M, V, F, U, C or J").at(edge));
        }
    })
}

/// Whether a polygon in the plane z = 0 has a negative area; not if it refers to vertices that do not exist.
fn is_clockwise(points: &[[f64; 3]], face: &[i64]) -> bool {
    let corner = |&v: &i64| usize::try_from(v).ok().and_then(|v| points.get(v));
    let Some(corners) = face.iter().map(corner).collect::<Option<Vec<_>>>() else {
        return false;
    };
    plane::twice_area(corners.into_iter()) < 0.0
}
