//! Repair of mesh files on request.

use super::{MeshFile, MeshFileProblem};
use isosheet_mesh::{MeshError, Sheet, orient_consistently};
use std::collections::{HashMap, HashSet};
use std::fmt;

/// What a repair changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Repair {
    /// Vertices that were merged with another one at exactly the same place.
    pub merged_vertices: usize,
    /// Faces that were removed because they have no area.
    pub degenerate_faces: usize,
    /// Faces that were removed because another one has the same corners.
    pub duplicate_faces: usize,
    /// Vertices that were removed because no face uses them.
    pub unused_vertices: usize,
    /// Faces whose winding was reversed, so that neighbours agree, with the mountains and valleys at them.
    pub reversed_faces: usize,
}

impl Repair {
    /// Whether nothing had to be changed.
    pub fn is_nothing(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            (
                self.merged_vertices,
                "coincident vertex",
                "coincident vertices",
                "merged",
            ),
            (
                self.degenerate_faces,
                "face without area",
                "faces without area",
                "removed",
            ),
            (
                self.duplicate_faces,
                "duplicate face",
                "duplicate faces",
                "removed",
            ),
            (
                self.unused_vertices,
                "unused vertex",
                "unused vertices",
                "removed",
            ),
            (self.reversed_faces, "face", "faces", "reversed"),
        ];
        let done: Vec<String> = parts
            .iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, one, more, done)| {
                format!("{count} {} {done}", if *count == 1 { one } else { more })
            })
            .collect();
        if done.is_empty() {
            return f.write_str("nothing to repair");
        }
        f.write_str(&done.join(", "))
    }
}

impl MeshFile {
    /// Repairs what can be repaired without a decision: merges vertices at exactly the same place, removes
    /// faces without area, faces that are there twice and vertices that no face uses, and reverses faces so
    /// that neighbours agree. The order of what stays is kept.
    ///
    /// Not repaired, because there is more than one way: edges with more than two faces, vertices at which a
    /// surface only touches itself, Moebius bands, holes, folds of FOLD files between faces in opposite
    /// directions.
    ///
    /// # Errors
    /// [`MeshFileProblem::Mesh`] if the faces cannot be oriented, [`MeshFileProblem::Data`] if a fold is
    /// between faces in opposite directions; everything else is then repaired.
    pub fn repair(&mut self) -> Result<Repair, MeshFileProblem> {
        let mut repair = Repair {
            merged_vertices: self.merge_vertices(),
            degenerate_faces: self.remove_degenerate(),
            duplicate_faces: self.remove_duplicates(),
            ..Repair::default()
        };
        // A vertex that was merged away is not counted twice.
        repair.unused_vertices = self.drop_unreferenced() - repair.merged_vertices;
        let count = self.vertex_count();
        let reversed = orient_consistently(count, &mut self.faces).map_err(MeshError::from)?;
        for face in &reversed {
            if let Some(Some(corners)) = self.texture.get_mut(face.index()) {
                corners.swap(1, 2);
            }
        }
        self.turn_creases(&reversed)?;
        repair.reversed_faces = reversed.len();
        Ok(repair)
    }

    /// Makes all faces use the first of the vertices at one place; returns how many others are used.
    fn merge_vertices(&mut self) -> usize {
        let mut first = HashMap::new();
        let places = self.positions.as_chunks::<3>().0.iter().zip(0_u32..);
        let label: Vec<u32> = places
            // Adding zero makes a negative zero positive.
            .map(|(p, v)| *first.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(v))
            .collect();
        let mut merged = HashSet::new();
        let moved = |v: &&u32| label[**v as usize] != **v;
        merged.extend(self.faces.iter().flatten().filter(moved).copied());
        self.relabel(&label);
        self.unite_creases();
        merged.len()
    }

    fn remove_degenerate(&mut self) -> usize {
        let positions = std::mem::take(&mut self.positions);
        let points = positions.as_chunks::<3>().0;
        let removed = self.retain_faces(|f| {
            let corners = f.map(|v| points[v as usize]);
            Sheet::new(corners.as_flattened().to_vec(), &[[0, 1, 2]]).is_ok()
        });
        self.positions = positions;
        removed
    }

    fn remove_duplicates(&mut self) -> usize {
        let mut seen = HashSet::new();
        self.retain_faces(|f| {
            let mut corners = *f;
            corners.sort_unstable();
            seen.insert(corners)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MeshFormat, MeshOptions, parse_mesh};
    use isosheet_mesh::TopologyError;
    use std::path::Path;

    fn mesh(text: &str) -> MeshFile {
        let options = MeshOptions::default();
        parse_mesh(
            text.as_bytes(),
            MeshFormat::Obj,
            Path::new("test.obj"),
            &options,
        )
        .unwrap()
    }

    #[test]
    fn everything_that_has_one_remedy_is_repaired() {
        // Two triangles with corners of their own, the second one reversed and there twice; a needle without
        // area; a vertex that no face uses.
        let mut broken = mesh(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 -0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nv 2 0 0\n\
             f 1 2 3\nf 4 6 5\nf 6 5 4\nf 1 2 8\n",
        );
        assert!(broken.clone().into_sheet().is_err());
        let repair = broken.repair().unwrap();
        let expected = Repair {
            merged_vertices: 2,
            degenerate_faces: 1,
            duplicate_faces: 1,
            unused_vertices: 2,
            reversed_faces: 1,
        };
        assert_eq!(repair, expected, "{repair}");
        let sheet = broken.clone().into_sheet().unwrap();
        assert_eq!((sheet.topology().vertex_count(), sheet.area()), (4, 1.0));
        assert!(broken.repair().unwrap().is_nothing());
    }

    #[test]
    fn what_needs_a_decision_is_refused() {
        let fan = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
        let error = mesh(fan).repair().unwrap_err();
        assert!(matches!(
            error,
            MeshFileProblem::Mesh(MeshError::Topology(TopologyError::NonManifoldEdge {
                count: 3,
                ..
            }))
        ));
    }
}
