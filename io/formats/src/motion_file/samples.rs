//! Samples of a mesh in motion, each in a mesh file of its own.

use crate::{Clock, MeshFile, MeshFileError, MeshFileProblem, MovingMesh, read_mesh};
use isosheet_files::FileError;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::counted;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// When the samples are.
pub(super) enum SampleTimes {
    /// At times in seconds.
    Seconds(Vec<f64>),
    /// At the times of their files, if all files have one, and else at a number of frames each, in the order
    /// of the numbers of the files.
    Numbers(Vec<u64>),
}

/// Reads the samples of the mesh in motion at `path`. Polygons are cut into triangles as they are in the
/// first one.
pub(super) fn read(
    path: &Path,
    times: SampleTimes,
    files: &[PathBuf],
) -> Result<MovingMesh, FileError> {
    let Some((first_file, others)) = files.split_first() else {
        return Err(FileError::content(
            path,
            "it has no samples",
            "name a mesh in motion that has some",
        ));
    };
    let first = read_one(first_file)?;
    let mut own_times = vec![first.time()];
    let mut x = first.positions.clone();
    for (number, file) in (1..).zip(others) {
        let mesh = read_one(file)?;
        check(&mesh, &first, number, [file, first_file])?;
        own_times.push(mesh.time());
        x.extend_from_slice(&mesh.positions);
    }
    let own_times: Option<Vec<f64>> = own_times.into_iter().collect();
    let times = match (times, own_times) {
        (SampleTimes::Seconds(times), _) | (SampleTimes::Numbers(_), Some(times)) => {
            (Clock::Seconds, times)
        }
        (SampleTimes::Numbers(numbers), None) => {
            check_distances(path, &numbers)?;
            let frames = (0..numbers.len()).map(|k| k as f64);
            (Clock::Frames, frames.collect())
        }
    };
    let corners: Vec<i64> = first
        .faces
        .as_flattened()
        .iter()
        .map(|v| i64::from(*v))
        .collect();
    MovingMesh::new(path, times, x, &corners)
}

/// Refuses numbers of frames, in increasing order, of which one seems to be missing.
fn check_distances(path: &Path, numbers: &[u64]) -> Result<(), FileError> {
    let pairs = || numbers.windows(2).map(|pair| (pair[0], pair[1] - pair[0]));
    let least = pairs().map(|(_, distance)| distance).min();
    match pairs().find(|(_, distance)| Some(*distance) != least) {
        None => Ok(()),
        Some((before, distance)) => Err(FileError::content(
            path,
            format!(
                "number {} follows {before}, and others are {} apart",
                before + distance,
                least.unwrap_or_default()
            ),
            "export the samples that are missing: numbers are consecutive, or all at one distance (0, 10, 20, ...); a \
             list of files with their times (.pvd) may have any times",
        )),
    }
}

/// Refuses another mesh than that of the first sample.
fn check(
    mesh: &MeshFile,
    first: &MeshFile,
    number: usize,
    [file, first_file]: [&PathBuf; 2],
) -> Result<(), FileError> {
    let counts = |mesh: &MeshFile| [mesh.vertex_count(), mesh.faces.len() - mesh.diagonals.len()];
    let ([vertices, faces], [vertices_before, faces_before]) = (counts(mesh), counts(first));
    let first_name = first_file.file_name().unwrap_or_default().to_string_lossy();
    let problem = if vertices != vertices_before {
        let vertices = counted(vertices, "vertex", "vertices");
        format!("sample {number} has {vertices}, and {first_name} has {vertices_before}")
    } else if faces != faces_before {
        let faces = counted(faces, "face", "faces");
        format!("sample {number} has {faces}, and {first_name} has {faces_before}")
    } else if mesh.faces != first.faces && outline(mesh) != outline(first) {
        format!("sample {number} has faces between other vertices than {first_name}")
    } else {
        return Ok(());
    };
    Err(FileError::content(
        file,
        problem,
        "export all samples with the same vertices and faces in the same order, without modifiers that change these",
    ))
}

/// The sides of the faces as the file has them, from vertex to vertex.
fn outline(mesh: &MeshFile) -> BTreeSet<[u32; 2]> {
    let mut sides: BTreeSet<[u32; 2]> = BTreeSet::new();
    for &[a, b, c] in &mesh.faces {
        sides.extend([[a, b], [b, c], [c, a]]);
    }
    for &[a, b] in &mesh.diagonals {
        sides.remove(&[a, b]);
        sides.remove(&[b, a]);
    }
    sides
}

fn read_one(path: &Path) -> Result<MeshFile, FileError> {
    read_mesh(path).map_err(|error| {
        let advice = error.advice().unwrap_or("export the sample again");
        let MeshFileError { place, problem, .. } = error;
        match problem {
            MeshFileProblem::Read(error) => FileError::unreadable(path, error),
            problem => {
                let place = place.map(|p| format!("{p}: ")).unwrap_or_default();
                FileError::content(path, format!("{place}{problem}"), advice)
            }
        }
    })
}
