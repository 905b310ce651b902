//! Polygons of a file, and what becomes of them.

use super::error::{Located, MeshFileProblem, Place};
use super::{MeshFile, MeshOptions, Polygons, ReadingChanges, polygon};
use std::path::PathBuf;

/// Vertices and polygons as a file has them.
#[derive(Debug, Default)]
pub(super) struct Polyhedron {
    /// Coordinates x0 y0 z0 x1 ...
    pub(super) positions: Vec<f64>,
    /// Corners of all faces, one after the other, from 0; whether each exists is checked at the end.
    corners: Vec<i64>,
    /// The end of each face in `corners`, and its place.
    ends: Vec<(usize, Place)>,
    /// The first vertices of the objects of the file, where it has several and they do not share vertices.
    parts: Vec<usize>,
    /// The number that the format gives to the first vertex, for errors.
    first: i64,
    /// Elements of the file that are not faces, for errors.
    pub(super) lines: usize,
    pub(super) points: usize,
}

impl Polyhedron {
    /// Nothing yet, in a format that gives the number `first` to the first vertex.
    pub(super) fn counted_from(first: i64) -> Self {
        Self {
            first,
            ..Self::default()
        }
    }

    /// Adds a face with corners counted from 0.
    pub(super) fn push_face(&mut self, corners: impl IntoIterator<Item = i64>, place: Place) {
        self.corners.extend(corners);
        self.ends.push((self.corners.len(), place));
    }

    /// Says that the vertices that follow belong to another object of the file.
    pub(super) fn begin_part(&mut self) {
        self.parts.push(self.positions.len() / 3);
    }

    /// Checks the faces as [`Self::assemble`] does, and makes copies of a vertex one, each object for itself.
    pub(super) fn assemble_copies(mut self, options: &MeshOptions) -> Result<MeshFile, Located> {
        let parts = std::mem::take(&mut self.parts);
        let mut mesh = self.assemble(options)?;
        if options.weld.is_none() {
            mesh.weld(0.0, &parts);
        }
        Ok(mesh)
    }

    /// The number of faces.
    pub(super) fn face_count(&self) -> usize {
        self.ends.len()
    }

    /// Adds a vertex.
    pub(super) fn push_vertex(&mut self, p: [f64; 3]) -> Result<(), MeshFileProblem> {
        if let Some(axis) = p.iter().position(|c| !c.is_finite()) {
            return Err(MeshFileProblem::NonFinite {
                vertex: self.positions.len() / 3 + self.first as usize,
                axis,
                value: p[axis],
            });
        }
        self.positions.extend_from_slice(&p);
        Ok(())
    }

    /// Checks the indices and cuts the polygons into triangles.
    pub(super) fn assemble(self, options: &MeshOptions) -> Result<MeshFile, Located> {
        let vertices = self.positions.len() / 3;
        if u32::try_from(vertices).is_err() {
            return Err((None, MeshFileProblem::TooManyVertices { vertices }));
        }
        match (vertices, self.ends.len()) {
            (0, 0) => return Err((None, MeshFileProblem::Empty)),
            (0, faces) => return Err((None, MeshFileProblem::NoVertices { faces })),
            (vertices, 0) => {
                let (lines, points) = (self.lines, self.points);
                let problem = MeshFileProblem::NoFaces {
                    vertices,
                    lines,
                    points,
                };
                return Err((None, problem));
            }
            _ => {}
        }
        let mut mesh = MeshFile {
            faces: Vec::with_capacity(self.ends.len()),
            polygons: 0,
            diagonals: Vec::new(),
            creases: Vec::new(),
            changes: ReadingChanges::default(),
            path: PathBuf::new(),
            positions: Vec::new(),
        };
        let mut start = 0;
        for &(end, place) in &self.ends {
            let added = self.triangles(start..end, options, &mut mesh);
            added.map_err(|problem| (Some(place), problem))?;
            start = end;
        }
        mesh.positions = self.positions;
        Ok(mesh)
    }

    /// Adds the triangles of one face to a mesh.
    fn triangles(
        &self,
        range: std::ops::Range<usize>,
        options: &MeshOptions,
        mesh: &mut MeshFile,
    ) -> Result<(), MeshFileProblem> {
        let count = self.positions.len() / 3;
        let vertex = |&k: &i64| match u32::try_from(k) {
            Ok(v) if (v as usize) < count => Ok(v),
            _ => Err(MeshFileProblem::IndexOutOfRange {
                index: k.saturating_add(self.first),
                count,
                first: self.first,
            }),
        };
        let corners = range.len();
        match self.corners[range] {
            [ref a, ref b, ref c] => mesh.faces.push([vertex(a)?, vertex(b)?, vertex(c)?]),
            [] | [_] | [_, _] => return Err(MeshFileProblem::TooFewCorners { corners }),
            ref face => {
                let face: Vec<u32> = face.iter().map(vertex).collect::<Result<_, _>>()?;
                if options.polygons == Polygons::Refuse {
                    return Err(MeshFileProblem::Polygon { corners });
                }
                let limit = polygon::MOST_CORNERS;
                if corners > limit {
                    return Err(MeshFileProblem::LargePolygon { corners, limit });
                }
                let points = self.positions.as_chunks::<3>().0;
                let pieces = polygon::triangulate(&face, |v| points[v as usize])
                    .ok_or(MeshFileProblem::CrossedPolygon { corners })?;
                mesh.diagonals.extend(pieces.cuts);
                mesh.faces.extend(pieces.triangles);
                mesh.polygons += 1;
            }
        }
        Ok(())
    }
}
