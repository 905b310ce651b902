//! Edges and the faces beside them: whether an edge is a mountain or a valley depends on the side of these
//! that it is seen from.

use crate::mesh_file::{EdgeAssignment, FileCrease, MeshFile};
use isosheet_files::DataError;
use isosheet_mesh::FaceId;
use std::collections::{HashMap, HashSet};

/// A side of a face.
pub(super) struct Side {
    pub(super) ends: [u32; 2],
    /// The face, from 0.
    pub(super) face: usize,
    /// Whether the face was reversed.
    pub(super) is_reversed: bool,
}

/// The sides of a face of any number of corners.
pub(super) fn sides_of<C: Copy + TryInto<u32>>(
    face: usize,
    corners: &[C],
    is_reversed: bool,
) -> impl Iterator<Item = Side> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).filter_map(move |(&a, &b)| {
        // Corners that do not exist are refused where the faces are assembled.
        let ends = sorted([a.try_into().ok()?, b.try_into().ok()?]);
        Some(Side {
            ends,
            face,
            is_reversed,
        })
    })
}

/// Whether faces belong to a crease pattern with these edges: every crease is a side of one, and no outline
/// goes to and fro along an edge.
pub(super) fn fit(faces: &[Vec<i64>], edges: &[FileCrease]) -> bool {
    let turns_back = |face: &Vec<i64>| {
        let n = face.len();
        (0..n).any(|k| n > 2 && face[k] == face[(k + 2) % n])
    };
    let sides = faces.iter().enumerate();
    let sides: Vec<Side> = sides
        .flat_map(|(k, face)| sides_of(k, face, false))
        .collect();
    !faces.iter().any(turns_back) && check_faces(edges, &sides).is_ok()
}

/// Refuses edges that cannot do what they are meant to because they are sides of no face.
pub(super) fn check_faces(edges: &[FileCrease], sides: &[Side]) -> Result<(), DataError> {
    let of_faces: HashSet<[u32; 2]> = sides.iter().map(|side| side.ends).collect();
    let is_lost = |c: &FileCrease| {
        (c.has_sense() || c.assignment == EdgeAssignment::Cut)
            && !of_faces.contains(&sorted(c.ends))
    };
    match edges.iter().position(is_lost) {
        Some(edge) => {
            let message = format!(
                "edge {edge} is a crease or a cut, and no face of `faces_vertices` has it as a side"
            );
            let remedy = "divide the face along it, or remove the edge";
            Err(DataError::new(message, remedy).at(edge))
        }
        None => Ok(()),
    }
}

/// Turns the edges at faces that were reversed: mountains become valleys, and angles change their sign.
///
/// # Errors
/// [`DataError`] for a fold between a face that was reversed and one that was not, of which
/// the file does not say where it leads.
pub(super) fn turn(edges: &mut [FileCrease], sides: &[Side]) -> Result<(), DataError> {
    let mut beside: HashMap<[u32; 2], [Option<usize>; 2]> = HashMap::new();
    for side in sides {
        let faces = beside.entry(side.ends).or_default();
        faces[usize::from(side.is_reversed)].get_or_insert(side.face);
    }
    for (edge, crease) in edges.iter_mut().enumerate() {
        match beside.get(&sorted(crease.ends)) {
            Some(&[Some(kept), Some(reversed)]) if crease.has_sense() => {
                let message = format!(
                    "edge {edge} folds between face {kept} and face {reversed}, whose vertices are listed in opposite \
                     directions, so that it is a mountain as seen from one of them and a valley from the other"
                );
                let remedy =
                    "list the vertices of all faces counter-clockwise as seen from the same side";
                return Err(DataError::new(message, remedy).at(edge));
            }
            Some([None, Some(_)]) => *crease = crease.turned(),
            _ => {}
        }
    }
    Ok(())
}

impl FileCrease {
    /// Whether it folds to one side.
    fn has_sense(&self) -> bool {
        matches!(
            self.assignment,
            EdgeAssignment::Mountain | EdgeAssignment::Valley
        ) || self.angle.is_some_and(|angle| angle != 0.0)
    }

    /// The crease as it is seen from the other side of the sheet.
    fn turned(self) -> Self {
        Self {
            assignment: match self.assignment {
                EdgeAssignment::Mountain => EdgeAssignment::Valley,
                EdgeAssignment::Valley => EdgeAssignment::Mountain,
                other => other,
            },
            // No angle becomes a negative zero.
            angle: self.angle.map(|angle| 0.0 - angle),
            ..self
        }
    }
}

impl MeshFile {
    /// Turns the creases between faces that have been reversed.
    ///
    /// # Errors
    /// [`DataError`] for a fold between one of them and another face.
    pub(in crate::mesh_file) fn turn_creases(
        &mut self,
        reversed: &[FaceId],
    ) -> Result<(), DataError> {
        let reversed: HashSet<usize> = reversed.iter().map(|f| f.index()).collect();
        let faces = self.faces.iter().enumerate();
        let sides = faces.flat_map(|(k, face)| sides_of(k, face, reversed.contains(&k)));
        turn(&mut self.creases, &sides.collect::<Vec<_>>())
    }

    /// Turns the creases at faces that a topology of the same vertices has the other way round: their
    /// assignments and angles then belong to its edges.
    ///
    /// # Errors
    /// [`DataError`] for a fold between a face that is reversed and another one.
    pub fn orient_creases(&mut self, t: &isosheet_mesh::Topology) -> Result<(), DataError> {
        let of_topology = t.faces().iter().map(|f| first_least(f.map(|v| v.0)));
        let of_topology: HashSet<[u32; 3]> = of_topology.collect();
        let mut sides = Vec::new();
        for (k, face) in self.faces.iter().enumerate() {
            let [a, b, c] = *face;
            let is_reversed = of_topology.contains(&first_least([a, c, b]));
            if is_reversed || of_topology.contains(&first_least(*face)) {
                sides.extend(sides_of(k, face, is_reversed));
            }
        }
        turn(&mut self.creases, &sides)
    }
}

/// The corners in the same order, the smallest number first.
fn first_least(mut corners: [u32; 3]) -> [u32; 3] {
    let least = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
    corners.rotate_left(least);
    corners
}

/// The ends of an edge, the smaller number first.
pub(super) fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
