//! Polygons of a file, and what becomes of them.

use super::error::{COPY, Located, Location, MeshFileProblem, no_such_vertex};
use super::{FaceGroups, MeshFile, MeshOptions, Polygons, ReadingChanges, polygon};
use isosheet_drawings::DrawnLines;
use isosheet_files::DataError;
use isosheet_mesh::wording::{counted, given};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

/// Vertices and polygons as a file has them.
#[derive(Debug, Default)]
pub(super) struct Polyhedron {
    /// Coordinates x0 y0 z0 x1 ...
    pub(super) positions: Vec<f64>,
    /// Corners of all faces, one after the other, from 0; whether each exists is checked at the end.
    corners: Vec<i64>,
    /// Texture coordinates of the corners; none beyond the end.
    texture: Vec<Option<[f64; 2]>>,
    /// Groups of the faces.
    pub(super) groups: FaceGroups,
    /// The end of each face in `corners`, and its place.
    ends: Vec<(usize, Location)>,
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
    pub(super) fn push_face(&mut self, corners: impl IntoIterator<Item = i64>, place: Location) {
        self.corners.extend(corners);
        self.ends.push((self.corners.len(), place));
    }

    /// Gives the corners of the last face texture coordinates.
    pub(super) fn push_texture(&mut self, corners: impl IntoIterator<Item = Option<[f64; 2]>>) {
        let first = self.ends.iter().rev().nth(1).map_or(0, |face| face.0);
        self.texture.resize(first, None);
        self.texture.extend(corners);
    }

    /// Adds the last face to a group.
    pub(super) fn push_group(&mut self, group: &str) {
        self.groups.add(group, self.face_count() as u32 - 1);
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
    pub(super) fn push_vertex(&mut self, p: [f64; 3]) -> Result<(), DataError> {
        if let Some(axis) = p.iter().position(|c| !c.is_finite()) {
            let vertex = self.positions.len() / 3 + self.first as usize;
            let (axis, value) = (["x", "y", "z"][axis], p[axis]);
            let message = format!("coordinate {axis} of vertex {vertex} is {}", given(value));
            let error = DataError::new(message, "export it with finite coordinates");
            return Err(error.at(vertex).value(value));
        }
        self.positions.extend_from_slice(&p);
        Ok(())
    }

    /// Checks the indices and cuts the polygons into triangles.
    pub(super) fn assemble(self, options: &MeshOptions) -> Result<MeshFile, Located> {
        let vertices = self.positions.len() / 3;
        if u32::try_from(vertices).is_err() {
            let message =
                format!("the file has {vertices} vertices, more than 32-bit numbers can count");
            return Err((None, DataError::new(message, "split it").into()));
        }
        let missing = match (vertices, self.ends.len()) {
            (0, 0) => Some(empty()),
            (0, faces) => {
                let faces = counted(faces, "face", "faces");
                let message = format!("the file has {faces} but no vertices");
                Some(DataError::new(message, "export it with its vertices"))
            }
            (vertices, 0) => {
                let message = format!(
                    "the file has {}, {} and {}, but no faces",
                    counted(vertices, "vertex", "vertices"),
                    counted(self.lines, "line element", "line elements"),
                    counted(self.points, "point element", "point elements")
                );
                Some(DataError::new(message, "export it with its faces"))
            }
            _ => None,
        };
        if let Some(missing) = missing {
            return Err((None, missing.into()));
        }
        let mut mesh = MeshFile {
            faces: Vec::with_capacity(self.ends.len()),
            polygons: 0,
            diagonals: Vec::new(),
            creases: Vec::new(),
            drawn: DrawnLines::default(),
            groups: FaceGroups::default(),
            texture: Vec::new(),
            changes: ReadingChanges::default(),
            left_out: BTreeMap::new(),
            path: PathBuf::new(),
            time: None,
            positions: Vec::new(),
            in_metres: false,
        };
        let mut start = 0;
        let mut origin = Vec::with_capacity(self.ends.len());
        for (face, &(end, place)) in (0..).zip(&self.ends) {
            let added = self.triangles(start..end, options, &mut mesh);
            added.map_err(|problem| (Some(place), problem))?;
            if !self.texture.is_empty() {
                for triangle in &mesh.faces[origin.len()..] {
                    mesh.texture.push(self.texture_of(start..end, triangle));
                }
            }
            origin.resize(mesh.faces.len(), face);
            start = end;
        }
        mesh.groups = self.groups.of_parts(&origin);
        mesh.positions = self.positions;
        Ok(mesh)
    }

    /// The texture coordinates of the corners of a triangle of a face.
    fn texture_of(&self, face: Range<usize>, triangle: &[u32; 3]) -> Option<[[f64; 2]; 3]> {
        let of_corner = |v: u32| {
            let mut corners = face.clone();
            let corner = corners.find(|&k| self.corners[k] == i64::from(v))?;
            *self.texture.get(corner)?
        };
        let [a, b, c] = triangle.map(of_corner);
        Some([a?, b?, c?])
    }

    /// Adds the triangles of one face to a mesh.
    fn triangles(
        &self,
        range: Range<usize>,
        options: &MeshOptions,
        mesh: &mut MeshFile,
    ) -> Result<(), MeshFileProblem> {
        let count = self.positions.len() / 3;
        let vertex = |&k: &i64| match u32::try_from(k) {
            Ok(v) if (v as usize) < count => Ok(v),
            _ => Err(no_such_vertex(
                k.saturating_add(self.first),
                count,
                self.first,
            )),
        };
        let corners = range.len();
        match self.corners[range] {
            [ref a, ref b, ref c] => mesh.faces.push([vertex(a)?, vertex(b)?, vertex(c)?]),
            [] | [_] | [_, _] => {
                let message = format!("a face has {corners} corners, and needs at least three");
                return Err(DataError::new(message, "remove it or complete it").into());
            }
            ref face => {
                let face: Vec<u32> = face.iter().map(vertex).collect::<Result<_, _>>()?;
                if options.polygons == Polygons::Refuse {
                    let message = format!(
                        "a face has {corners} corners, and a rigid sheet is made of triangles"
                    );
                    let remedy = "triangulate the file, or ask for `Polygons::Triangulate` (each diagonal is a new \
                                  crease)";
                    return Err(MeshFileProblem::Polygon(DataError::new(message, remedy)));
                }
                let limit = polygon::MOST_CORNERS;
                if corners > limit {
                    let message = format!(
                        "a face has {corners} corners, more than the {limit} of a polygon that is cut into triangles"
                    );
                    return Err(DataError::new(message, "triangulate the file first").into());
                }
                let points = self.positions.as_chunks::<3>().0;
                let pieces = polygon::triangulate(&face, |v| points[v as usize])
                    .ok_or_else(|| {
                        let message = format!(
                            "the outline of a face of {corners} corners crosses or touches itself, or has no area, \
                             so that it cannot be cut into triangles"
                        );
                        DataError::new(message, "correct the face, or remove it")
                    })?;
                mesh.diagonals.extend(pieces.cuts);
                mesh.faces.extend(pieces.triangles);
                mesh.polygons += 1;
            }
        }
        Ok(())
    }
}

/// There is nothing in the file but comments.
pub(super) fn empty() -> DataError {
    let message = "the file has no vertices and no faces: it is empty, or was cut short";
    DataError::new(message, COPY)
}
