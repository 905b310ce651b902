//! How large the mesh of a scene is, before it is made.

use crate::meshes::mesh::Mesh;
use crate::sheets::sheet::SheetKey;
use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_files::{bytes_in_words, memory};
use isosheet_mesh::wording::brief;

/// Memory that a run needs for each face of its sheet at least, bytes, for its model and for the matrix of a
/// step with its factors. Measured were 4700 for strips of one row of cells and 5500 for a square of 45 000
/// faces.
pub const MEMORY_OF_FACE: f64 = 4000.0;

/// Number of faces above which generators of meshes refuse to make one, with a reason at its key.
const MOST_GENERATED: f64 = 16_777_216.0;

/// Refuses sheets that memory cannot hold.
pub(crate) fn check_memory(faces: f64, key: Key) -> Result<(), Problem> {
    let (needed, free) = (MEMORY_OF_FACE * faces, memory::free() as f64);
    if needed <= free {
        return Ok(());
    }
    let message = format!(
        "{} faces need {} of memory, and {} are free",
        brief(faces),
        bytes_in_words(needed),
        bytes_in_words(free)
    );
    Err(Problem::new(key, message, "make the mesh coarser"))
}

/// Refuses sheets of a scene that memory cannot hold together, as far as their numbers of faces are known
/// before they are made; `key` is that of a sheet by its number.
pub(crate) fn check_sheets(sheets: &[SheetKey], key: impl Fn(usize) -> Key) -> Result<(), Problem> {
    let mut all = 0.0;
    for (k, sheet) in sheets.iter().enumerate() {
        let key = key(k);
        let faces = sheet.mesh.face_count();
        if faces > MOST_GENERATED {
            continue;
        }
        all += faces * refined(sheet.refine);
        check_memory(
            all,
            match sheet.refine {
                0 => key.name("mesh").name(sheet.mesh.name()),
                _ => key.name("refine"),
            },
        )?;
    }
    Ok(())
}

/// How many faces become of each one that is divided so often.
pub(crate) fn refined(times: usize) -> f64 {
    4_f64.powf(times as f64)
}

impl Mesh {
    /// The number of faces of a mesh that is made by formula, or about that; zero of a file, which is not
    /// read yet, and of patterns that have a few.
    fn face_count(&self) -> f64 {
        let product = |a: usize, b: usize| a as f64 * b as f64;
        match self {
            Self::Square { level, .. } => 8.0 * refined(*level as usize),
            Self::Rectangle { columns, rows, .. } => 2.0 * product(*columns, *rows),
            Self::Disk { rings, .. } => 6.0 * product(*rings, *rings),
            Self::Annulus {
                segments, rings, ..
            } => 2.0 * product(*segments, *rings),
            Self::Fan { triangles, .. } => *triangles as f64,
            Self::Polygon {
                outline, spacing, ..
            } => {
                let corners = outline.corners();
                let next = corners.iter().cycle().skip(1);
                let twice: f64 = corners
                    .iter()
                    .zip(next)
                    .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
                    .sum();
                let of_face = 0.75_f64.sqrt() * spacing * spacing;
                twice.abs() / of_face
            }
            Self::PolygonRings { outline, rings } => {
                outline.corners().len() as f64 * product(*rings, *rings)
            }
            Self::Miura(miura) => 2.0 * product(miura.columns, miura.rows),
            Self::Waterbomb(pattern) => 8.0 * product(pattern.columns, pattern.rows),
            Self::Yoshimura(pattern) => 2.0 * product(pattern.columns, pattern.rows),
            Self::Kresling(pattern) => 2.0 * product(pattern.columns, pattern.rows),
            Self::Hypar(pattern) => 8.0 * pattern.rings as f64,
            Self::StripBetween(strip) => 2.0 * product(strip.columns, strip.rows),
            Self::Triangles { faces, .. } => faces.len() as f64,
            Self::Octagon { .. }
            | Self::DegreeFour(_)
            | Self::SquareTwist(_)
            | Self::File(_)
            | Self::Drawing(_) => 0.0,
        }
    }
}
