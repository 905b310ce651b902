//! Reading STL files (stereolithography).

use super::error::{CORRECT, Located, Location, announced, cut_short};
use super::faces::Polyhedron;
use isosheet_files::DataError;
use std::io::Cursor;

/// Bytes before the first facet of a binary file: a comment of 80 bytes and the number of facets.
const HEADER: usize = 84;

/// Bytes of a facet of a binary file: normal and three corners as `f32`, two bytes of attributes.
const FACET: usize = 50;

/// Reads the facets of an STL file; each has three vertices of its own.
///
/// A file is binary if it has the length that its number of facets needs, or if it does not begin with
/// `solid`. A text may have several solids. Coordinates are `f32` in the binary form, and are read as such in
/// the text form too. Normals are skipped: the order of the corners says which side is outside.
pub(super) fn parse(bytes: &[u8]) -> Result<Polyhedron, Located> {
    let mut mesh = Polyhedron::default();
    if bytes.is_empty() {
        return Ok(mesh);
    }
    let header = bytes.get(80..HEADER).map(|b| {
        let count = u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        (count, HEADER as u64 + FACET as u64 * u64::from(count))
    });
    let length = bytes.len() as u64;
    let is_text = bytes
        .trim_ascii_start()
        .to_ascii_lowercase()
        .starts_with(b"solid");
    match header {
        Some((_, needed)) if needed == length => binary(&mut mesh, bytes)?,
        _ if is_text => text(&mut mesh, &String::from_utf8_lossy(bytes))?,
        Some((_, needed)) if needed < length => binary(&mut mesh, bytes)?,
        Some((count, needed)) => {
            let [needed, available] = [needed, length].map(|bytes| bytes - HEADER as u64);
            let problem = announced("facets", count.into(), needed, available);
            return Err((Some(Location::Byte(80)), problem.into()));
        }
        None => {
            let problem = cut_short("the number of facets of a binary STL file");
            return Err((Some(Location::Byte(bytes.len())), problem.into()));
        }
    }
    Ok(mesh)
}

fn binary(mesh: &mut Polyhedron, bytes: &[u8]) -> Result<(), Located> {
    // The comment of a binary file may begin with "solid" as a text does.
    let rest = &bytes[80..];
    let file = [&[0; 80][..], rest].concat();
    let place = |facet: usize| Some(Location::Byte(HEADER + FACET * facet));
    facets(mesh, file, &place)
}

fn text(mesh: &mut Polyhedron, text: &str) -> Result<(), Located> {
    let mut solid = String::new();
    let no_place = |_| None;
    for line in text.lines() {
        let line = line.trim_start().to_ascii_lowercase();
        if line.split_whitespace().next() == Some("solid") {
            if !solid.is_empty() {
                facets(mesh, std::mem::take(&mut solid).into_bytes(), &no_place)?;
            }
            // The name of the solid is left out: it may be missing or in any encoding.
            solid.push_str("solid \n");
        } else {
            solid.push_str(&line);
            solid.push('\n');
        }
    }
    facets(mesh, solid.into_bytes(), &no_place)
}

/// Adds the facets of one solid.
fn facets(
    mesh: &mut Polyhedron,
    file: Vec<u8>,
    place: &dyn Fn(usize) -> Option<Location>,
) -> Result<(), Located> {
    let mut file = Cursor::new(file);
    let failed = |facet: usize, problem: String| {
        let message = format!("facet {facet} (from 0): {problem}");
        (
            place(facet),
            DataError::new(message, CORRECT).at(facet).into(),
        )
    };
    let first = mesh.face_count();
    let reader = stl_io::create_stl_reader(&mut file).map_err(|e| failed(first, e.to_string()))?;
    for facet in reader {
        let k = mesh.face_count();
        let facet = facet.map_err(|e| failed(k, e.to_string()))?;
        for corner in facet.vertices {
            let pushed = mesh.push_vertex(corner.0.map(f64::from));
            pushed.map_err(|problem| (place(k), problem.into()))?;
        }
        let vertex = 3 * k as i64;
        mesh.push_face([vertex, vertex + 1, vertex + 2], Location::Face(k));
    }
    Ok(())
}
