//! Wavefront OBJ files.

use super::error::{check_count, check_mesh};
use super::{ExportError, Series};
use crate::FaceGroups;
use isosheet_files::{FileWriter, NumberedFiles, write_atomically};
use isosheet_mesh::Topology;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes the mesh at positions `x` (length 3V, metres) as an OBJ file, atomically.
///
/// Vertices and faces keep their order; numbers have as many digits as are needed to read them back exactly.
///
/// # Errors
/// [`ExportError::Data`] for another number of coordinates and for one that is not finite,
/// [`ExportError::File`]; nothing is written then.
pub fn write_obj(path: &Path, topology: &Topology, x: &[f64]) -> Result<(), ExportError> {
    let expected = 3 * topology.vertex_count();
    check_count("coordinates of a mesh", x.len(), expected)?;
    let faces: Vec<[u32; 3]> = topology.faces().iter().map(|f| f.map(|v| v.0)).collect();
    check_mesh(x, &faces)?;
    write(path, &faces, x, &Extras::default())
}

/// The file of frame `frame` in `folder`: `frame_00000.obj` and so on, so that names sort as frames do.
pub fn frame_path(folder: &Path, frame: usize) -> PathBuf {
    NumberedFiles::new(folder, "frame", "obj").path(frame)
}

/// Writes one mesh.
pub(super) fn write(
    path: &Path,
    faces: &[[u32; 3]],
    x: &[f64],
    extras: &Extras<'_>,
) -> Result<(), ExportError> {
    Ok(write_atomically(path, |w| {
        write_lines(w, faces, x, extras)
    })?)
}

/// Texture coordinates, and a group for each of several sheets.
pub(super) fn extras<'a>(series: &'a Series<'_>) -> Extras<'a> {
    let sheets = series.sheets().iter();
    Extras {
        uv: series.uv(),
        groups: sheets
            .map(|s| (s.name.clone(), s.part.faces.start))
            .collect(),
    }
}

/// Writes one file for each frame in a folder, and beside it one with the bodies in their places, one object
/// each; of bodies that rest a single one. Returns the files, and how many of an earlier export were removed.
pub(super) fn write_series(
    path: &Path,
    series: &Series<'_>,
) -> Result<(Vec<PathBuf>, usize), ExportError> {
    let folder = path.with_extension("");
    let [bodies, frames] = ["bodies", "frame"].map(|n| NumberedFiles::new(&folder, n, "obj"));
    let mut files = Vec::new();
    let placed = series.frames_of_bodies();
    for &frame in placed {
        let file = bodies.path(frame);
        write_bodies(&file, series, frame)?;
        files.push(file);
    }
    let extras = extras(series);
    for &frame in series.frames() {
        let file = frames.path(frame);
        write(&file, series.faces(), series.state(frame).1, &extras)?;
        files.push(file);
    }
    let removed = frames.keep_only(series.frames())? + bodies.keep_only(placed)?;
    Ok((files, removed))
}

/// Writes the bodies in their places in one frame.
fn write_bodies(path: &Path, series: &Series<'_>, frame: usize) -> Result<(), ExportError> {
    Ok(write_atomically(path, |w| {
        let mut first = 1;
        for body in series.bodies() {
            writeln!(w, "o {}", body.name)?;
            for [x, y, z] in body.placed(frame).as_chunks::<3>().0 {
                writeln!(w, "v {x} {y} {z}")?;
            }
            for face in &body.faces {
                let [a, b, c] = face.map(|v| u64::from(v) + first);
                writeln!(w, "f {a} {b} {c}")?;
            }
            first += (body.positions.len() / 3) as u64;
        }
        Ok(())
    })?)
}

/// What a file may have beside positions and faces.
#[derive(Clone, Debug, Default)]
pub(super) struct Extras<'a> {
    /// Texture coordinates of the vertices.
    pub(super) uv: Option<&'a [[f64; 2]]>,
    /// Faces that follow one another and have the same groups: the names of these, and the number of the
    /// first face, ascending.
    pub(super) groups: Vec<(String, usize)>,
}

impl Extras<'_> {
    /// The groups of so many faces. Names are separated by spaces in a file, and have none.
    pub(super) fn of_groups(groups: &FaceGroups, faces: usize) -> Self {
        let mut names = vec![String::new(); faces];
        for (name, own) in groups.iter() {
            let word = name.replace(char::is_whitespace, "_");
            for &face in own {
                let names = &mut names[face as usize];
                if !names.is_empty() {
                    names.push(' ');
                }
                names.push_str(&word);
            }
        }
        let mut runs: Vec<(String, usize)> = Vec::new();
        for (face, names) in names.into_iter().enumerate() {
            if runs.last().map_or("", |run| &run.0) != names {
                runs.push((names, face));
            }
        }
        Self {
            uv: None,
            groups: runs,
        }
    }
}

/// The lines of a file; the positions are finite and the corners exist.
fn write_lines(
    w: &mut FileWriter<'_>,
    faces: &[[u32; 3]],
    x: &[f64],
    extras: &Extras<'_>,
) -> io::Result<()> {
    let (vertices, uv) = (x.len() / 3, extras.uv);
    writeln!(w, "# isosheet: {vertices} vertices, {} faces", faces.len())?;
    for p in x.chunks_exact(3) {
        writeln!(w, "v {} {} {}", p[0], p[1], p[2])?;
    }
    for [u, v] in uv.into_iter().flatten() {
        writeln!(w, "vt {u} {v}")?;
    }
    let mut groups = extras.groups.iter().peekable();
    for (k, corners) in faces.iter().enumerate() {
        while let Some((name, _)) = groups.next_if(|(_, first)| *first <= k) {
            writeln!(w, "g {name}")?;
        }
        let [a, b, c] = corners.map(|v| v + 1);
        match uv {
            Some(_) => writeln!(w, "f {a}/{a} {b}/{b} {c}/{c}")?,
            None => writeln!(w, "f {a} {b} {c}")?,
        }
    }
    Ok(())
}
