//! A mesh whose faces are divided.

use crate::meshes::pattern::EdgeRoles;
use crate::sheets::size;
use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_mesh::generate::{FoldAssignment, refine_isotropic};
use isosheet_mesh::{EdgeId, Sheet, VertexId};

/// A mesh and its refinement by [`refine_isotropic`], as often as `sheet.refine` says. Vertices of the mesh
/// keep their numbers, and an edge of it becomes a row of edges.
#[derive(Debug)]
pub(crate) struct Refined {
    /// The mesh, and what each division of all faces makes of it.
    levels: Vec<Sheet>,
}

impl Refined {
    pub(crate) fn new(mesh: Sheet, times: usize, key: &Key) -> Result<Self, Problem> {
        let faces = mesh.topology().face_count() as f64 * size::refined(times);
        size::check_memory(faces, key.clone())?;
        let mut levels = vec![mesh];
        for _ in 0..times {
            let finer = refine_isotropic(&levels[levels.len() - 1]);
            levels.push(finer.map_err(|e| Problem::from_error(key.clone(), &e))?);
        }
        Ok(Self { levels })
    }

    /// The mesh that the scene names.
    pub(crate) fn mesh(&self) -> &Sheet {
        &self.levels[0]
    }

    /// The mesh that is simulated.
    pub(crate) fn sheet(&self) -> &Sheet {
        &self.levels[self.levels.len() - 1]
    }

    /// Of each face of the refined mesh the face of the mesh that it is a part of.
    pub(crate) fn faces_of_mesh(&self) -> Vec<u32> {
        // Each division makes four of a face, one after the other.
        let parts = 4_u32.pow(self.levels.len() as u32 - 1);
        let faces = self.sheet().topology().face_count() as u32;
        (0..faces).map(|face| face / parts).collect()
    }

    /// The edges that an edge of the mesh consists of, from its first end to its second.
    pub(crate) fn parts(&self, edge: EdgeId) -> Vec<EdgeId> {
        let mut parts = vec![self.mesh().topology().edges()[edge.index()]];
        for level in &self.levels[..self.levels.len() - 1] {
            let t = level.topology();
            let halves = |[a, b]: [VertexId; 2]| {
                let edge = t.find_edge(a, b).expect("a part of an edge is an edge");
                let middle = VertexId::from_index(t.vertex_count() + edge.index());
                [[a, middle], [middle, b]]
            };
            parts = parts.into_iter().flat_map(halves).collect();
        }
        let t = self.sheet().topology();
        let edge = |[a, b]: [VertexId; 2]| t.find_edge(a, b).expect("a part of an edge is an edge");
        parts.into_iter().map(edge).collect()
    }

    /// The edges that are no part of an edge of the mesh: those inside its faces.
    pub(crate) fn inside_faces(&self) -> Vec<EdgeId> {
        let mut is_part = vec![false; self.sheet().topology().edge_count()];
        let of_mesh = self.mesh().topology().edge_ids();
        for edge in of_mesh.flat_map(|e| self.parts(e)) {
            is_part[edge.index()] = true;
        }
        let inside = self.sheet().topology().edge_ids();
        inside.filter(|e| !is_part[e.index()]).collect()
    }

    /// The vertices of the refined mesh at positions `x` (`3V`) of the mesh: new ones in the middle of edges.
    pub(crate) fn positions(&self, mut x: Vec<f64>) -> Vec<f64> {
        for level in &self.levels[..self.levels.len() - 1] {
            for ends in level.topology().edges() {
                let [p, q] = ends.map(|v| [0, 1, 2].map(|k| x[3 * v.index() + k]));
                x.extend([0, 1, 2].map(|k| 0.5 * p[k] + 0.5 * q[k]));
            }
        }
        x
    }

    /// What the edges of the refined mesh are meant to do. A part of an edge does what the edge does; edges
    /// inside the faces stay flat.
    pub(crate) fn roles(&self, roles: EdgeRoles) -> EdgeRoles {
        let mut assignments = vec![None; self.sheet().topology().edge_count()];
        for edge in self.inside_faces() {
            assignments[edge.index()] = Some(FoldAssignment::Flat);
        }
        for edge in self.mesh().topology().edge_ids() {
            for part in self.parts(edge) {
                assignments[part.index()] = roles.assignments[edge.index()];
            }
        }
        let zigzags = roles.zigzags.iter().flat_map(|&e| self.parts(e));
        EdgeRoles {
            assignments,
            zigzags: zigzags.collect(),
            drawn: roles.drawn,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate::{Diagonals, grid};

    fn refined(times: usize) -> Refined {
        let mesh = grid(3, 2, 0.3, 0.2, Diagonals::UnionJack).unwrap();
        Refined::new(mesh, times, &Key::root()).unwrap()
    }

    #[test]
    fn parts_of_an_edge_lie_on_it_in_a_row() {
        let refined = refined(2);
        let (mesh, fine) = (refined.mesh(), refined.sheet());
        for edge in mesh.topology().edge_ids() {
            let [a, b] = mesh.topology().edges()[edge.index()].map(|v| mesh.position(v));
            let parts = refined.parts(edge);
            assert_eq!(parts.len(), 4);
            for (k, part) in parts.iter().enumerate() {
                let [p, q] = fine.topology().edges()[part.index()].map(|v| fine.position(v));
                for c in 0..3 {
                    let expected = a[c] + (k as f64 + 0.5) / 4.0 * (b[c] - a[c]);
                    assert!((0.5 * (p[c] + q[c]) - expected).abs() < 1e-15);
                }
            }
            let sum: f64 = parts.iter().map(|e| fine.lengths()[e.index()]).sum();
            assert!((sum - mesh.lengths()[edge.index()]).abs() < 1e-15);
        }
        let inside = refined.inside_faces();
        let count = 4 * mesh.topology().edge_count();
        assert_eq!(inside.len() + count, fine.topology().edge_count());
    }

    #[test]
    fn parts_of_a_face_lie_in_it() {
        let refined = refined(2);
        let middle = |sheet: &Sheet, face: usize| {
            let corners = sheet.topology().faces()[face].map(|v| sheet.position(v));
            [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0)
        };
        let mut parts = vec![0; refined.mesh().topology().face_count()];
        for (part, face) in refined.faces_of_mesh().into_iter().enumerate() {
            let p = middle(refined.sheet(), part);
            let [a, b, c] = refined.mesh().topology().faces()[face as usize]
                .map(|v| refined.mesh().position(v));
            for [a, b] in [[a, b], [b, c], [c, a]] {
                let side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                assert!(side > 0.0, "part {part} of face {face}");
            }
            parts[face as usize] += 1;
        }
        assert!(parts.iter().all(|count| *count == 16));
    }

    #[test]
    fn positions_of_the_rest_shape_are_those_of_the_refined_mesh() {
        let refined = refined(2);
        let x = refined.positions(refined.mesh().positions().to_vec());
        assert_eq!(x, refined.sheet().positions());
    }

    #[test]
    fn parts_of_a_crease_fold_as_it_does_and_faces_stay_flat() {
        let refined = refined(1);
        let count = refined.mesh().topology().edge_count();
        let mut assignments = vec![None; count];
        assignments[3] = Some(FoldAssignment::Mountain);
        let roles = refined.roles(EdgeRoles {
            assignments,
            zigzags: vec![EdgeId::from_index(3)],
            drawn: None,
        });
        assert_eq!(roles.zigzags, refined.parts(EdgeId::from_index(3)));
        let count = |wanted: Option<FoldAssignment>| {
            let found = roles.assignments.iter().filter(|&&a| a == wanted);
            found.count()
        };
        assert_eq!(count(Some(FoldAssignment::Mountain)), 2);
        let inside = 3 * refined.mesh().topology().face_count();
        assert_eq!(count(Some(FoldAssignment::Flat)), inside);
    }
}
