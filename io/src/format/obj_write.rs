//! Writing Wavefront OBJ files.

use isosheet_mesh::wording::given;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use isosheet_mesh::{Advice, Topology, VertexId};
use thiserror::Error;

use crate::format::atomic::{WriteError, write_atomically};

/// A state that cannot be written as OBJ.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ObjWriteError {
    /// The position array does not belong to the mesh.
    #[error(
        "there are {got} coordinates, but the mesh has {vertices} vertices, three coordinates each"
    )]
    WrongLength {
        /// The length of the array.
        got: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
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
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] WriteError),
}

impl Advice for ObjWriteError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NotFinite { .. } => Some("go back to the last state that was finite"),
            Self::File(error) => error.advice(),
            Self::WrongLength { .. } => None,
        }
    }
}

/// Writes the mesh at positions `x` (length 3V, metres) as an OBJ file, atomically.
///
/// Vertices and faces keep their order; numbers have as many digits as are needed to read them back exactly.
///
/// # Errors
/// [`ObjWriteError`]; nothing is written then.
pub fn write_obj(path: &Path, topology: &Topology, x: &[f64]) -> Result<(), ObjWriteError> {
    check(topology, x)?;
    Ok(write_atomically(path, |w| {
        write_lines(w, corners(topology), x, &Extras::default())
    })?)
}

/// [`write_obj`] to any writer, for example into memory.
///
/// # Errors
/// [`ObjWriteError`] for bad positions; errors of the writer as [`WriteError::Write`] without a path.
pub fn write_obj_to(
    w: &mut impl Write,
    topology: &Topology,
    x: &[f64],
) -> Result<(), ObjWriteError> {
    check(topology, x)?;
    let failed = |source| WriteError::Write {
        path: PathBuf::new(),
        source,
    };
    Ok(write_lines(w, corners(topology), x, &Extras::default()).map_err(failed)?)
}

/// The file of frame `frame` in `folder`: `frame_00000.obj` and so on, so that names sort as frames do.
pub fn frame_path(folder: &Path, frame: usize) -> PathBuf {
    folder.join(format!("frame_{frame:05}.obj"))
}

/// The frame whose file has a name, of names that [`frame_path`] gives.
#[cfg(feature = "run")]
pub(crate) fn frame_number(name: &Path) -> Option<usize> {
    let digits = name.to_str()?.strip_prefix("frame_")?;
    let frame = digits.strip_suffix(".obj")?.parse().ok()?;
    (frame_path(Path::new(""), frame) == name).then_some(frame)
}

fn check(topology: &Topology, x: &[f64]) -> Result<(), ObjWriteError> {
    if x.len() != 3 * topology.vertex_count() {
        return Err(ObjWriteError::WrongLength {
            got: x.len(),
            vertices: topology.vertex_count(),
        });
    }
    match x.iter().position(|c| !c.is_finite()) {
        Some(k) => Err(ObjWriteError::NotFinite {
            vertex: VertexId::from_index(k / 3),
            axis: k % 3,
            value: x[k],
        }),
        None => Ok(()),
    }
}

fn corners(topology: &Topology) -> impl ExactSizeIterator<Item = [u32; 3]> {
    topology.faces().iter().map(|f| f.map(|v| v.0))
}

/// What a file may have beside positions and faces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Extras<'a> {
    /// Texture coordinates of the vertices.
    pub(crate) uv: Option<&'a [[f64; 2]]>,
    /// Groups of faces that follow one another: the name of each, and the number of its first face,
    /// ascending.
    pub(crate) groups: Vec<(&'a str, usize)>,
}

/// The lines of a file; the positions are finite and the corners exist.
pub(crate) fn write_lines(
    w: &mut impl Write,
    faces: impl ExactSizeIterator<Item = [u32; 3]>,
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
    for (k, corners) in faces.enumerate() {
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
