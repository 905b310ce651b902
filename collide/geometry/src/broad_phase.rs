//! Which primitives may meet during a motion: a bounding-volume hierarchy over swept boxes.

use crate::candidates::{Candidates, CrossCandidates};
use crate::contact_mesh::{ContactMesh, Element};
use crate::crossings::pierces;
use crate::vectors::gather;
use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

#[cfg(test)]
mod tests;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl Bounds {
    fn merged(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].min(other.min[k])),
            max: std::array::from_fn(|k| self.max[k].max(other.max[k])),
        }
    }

    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }
}

/// A dynamic bounding-volume hierarchy of a mesh in motion.
///
/// The tree is over the faces (and free edges and vertices); it is built once and refitted to new positions
/// by [`BroadPhase::update`]. After the first few calls nothing is allocated unless there are more pairs than
/// ever before. The boxes enclose the whole straight motion from one set of positions to another; a pair that
/// comes within twice the inflation of each other at any time between is reported, and each pair once.
#[derive(Clone)]
pub struct BroadPhase {
    mesh: ContactMesh,
    tree: Bvh,
    workspace: BvhWorkspace,
    vertices: Vec<Bounds>,
    edges: Vec<Bounds>,
    faces: Vec<Bounds>,
}

impl std::fmt::Debug for BroadPhase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BroadPhase")
            .field("vertices", &self.mesh.vertex_count())
            .field("edges", &self.mesh.edges().len())
            .field("faces", &self.mesh.faces().len())
            .finish_non_exhaustive()
    }
}

impl BroadPhase {
    /// Builds the tree at positions `x` (`3V`, metres). The quality of the tree comes from these
    /// positions: give a state without degenerate overlaps, such as the flat one.
    ///
    /// # Panics
    /// If the length of `x` is not three times the number of vertices.
    pub fn new(mesh: ContactMesh, x: &[f64]) -> Self {
        let empty = Bounds {
            min: [0.0; 3],
            max: [0.0; 3],
        };
        let mut phase = Self {
            vertices: vec![empty; mesh.vertex_count()],
            edges: vec![empty; mesh.edges().len()],
            faces: vec![empty; mesh.faces().len()],
            tree: Bvh::new(),
            workspace: BvhWorkspace::default(),
            mesh,
        };
        phase.update_boxes(x, x, 0.0);
        let leaves: Vec<Aabb> = (0..phase.mesh.elements().len())
            .map(|i| phase.element_box(i))
            .collect();
        phase.tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
        phase
    }

    /// The primitives.
    #[inline]
    pub fn mesh(&self) -> &ContactMesh {
        &self.mesh
    }

    /// Refits the tree to the motion from `x0` to `x1` (`3V`, metres), every box enlarged by `inflation`
    /// (metres) on all sides, and boxes of round bodies also by their radius. For pairs within a distance `d`
    /// give both meshes `d / 2`, or one of them `d`.
    ///
    /// # Panics
    /// If the lengths of `x0` and `x1` are not three times the number of vertices.
    pub fn update(&mut self, x0: &[f64], x1: &[f64], inflation: f64) {
        self.update_boxes(x0, x1, inflation);
        for i in 0..self.mesh.elements().len() {
            let leaf = self.element_box(i);
            // A zero margin overwrites the box.
            let number = u32::try_from(i).expect("elements are numbered with 32 bits");
            let _ = self.tree.insert_or_update_partially(leaf, number, 0.0);
        }
        self.tree.refit_without_opt();
    }

    /// Sets the boxes alone, as [`BroadPhase::update`] does, for questions about single pairs. Searches for
    /// pairs need the tree too.
    ///
    /// # Panics
    /// If the lengths of `x0` and `x1` are not three times the number of vertices.
    pub fn update_boxes(&mut self, x0: &[f64], x1: &[f64], inflation: f64) {
        let n = 3 * self.mesh.vertex_count();
        assert!(
            x0.len() == n && x1.len() == n,
            "positions have lengths {} and {}, expected {n}",
            x0.len(),
            x1.len()
        );
        let chunks = x0.as_chunks::<3>().0.iter().zip(x1.as_chunks::<3>().0);
        let (mesh, vertices) = (&self.mesh, &mut self.vertices);
        for (v, (bounds, (p, q))) in (0..).zip(vertices.iter_mut().zip(chunks)) {
            let inflation = inflation + mesh.radius(v);
            // Sums are rounded by at most half of EPSILON, relative; the box is enlarged by twice that.
            *bounds = Bounds {
                min: std::array::from_fn(|k| {
                    let low = p[k].min(q[k]) - inflation;
                    low - f64::EPSILON * low.abs()
                }),
                max: std::array::from_fn(|k| {
                    let high = p[k].max(q[k]) + inflation;
                    high + f64::EPSILON * high.abs()
                }),
            };
        }
        let vertex = |v: u32| &self.vertices[v as usize];
        for (bounds, &[a, b]) in self.edges.iter_mut().zip(self.mesh.edges()) {
            *bounds = vertex(a).merged(vertex(b));
        }
        for (bounds, &[a, b, c]) in self.faces.iter_mut().zip(self.mesh.faces()) {
            *bounds = vertex(a).merged(vertex(b)).merged(vertex(c));
        }
    }

    /// Whether the boxes of a vertex of this mesh and of a face of another one overlap.
    #[inline]
    pub fn vertex_meets_face(&self, other: &Self, [v, f]: [u32; 2]) -> bool {
        self.vertices[v as usize].overlaps(&other.faces[f as usize])
    }

    /// Whether the boxes of an edge of this mesh and of an edge of another one overlap.
    #[inline]
    pub fn edge_meets_edge(&self, other: &Self, [e, g]: [u32; 2]) -> bool {
        self.edges[e as usize].overlaps(&other.edges[g as usize])
    }

    fn element_box(&self, i: usize) -> Aabb {
        let element = &self.mesh.elements()[i];
        let bounds = match element.face {
            Some(f) => self.faces[f as usize],
            None => match element.edges.iter().next() {
                Some(e) => self.edges[e as usize],
                None => {
                    let v = element.vertices.iter().next();
                    self.vertices[v.expect("an element has a primitive") as usize]
                }
            },
        };
        Aabb::new(Vector::from(bounds.min), Vector::from(bounds.max))
    }

    /// Pairs of the mesh with itself since the last update; `out` is overwritten.
    pub fn self_candidates(&mut self, out: &mut Candidates) {
        out.vertex_face.clear();
        out.edge_edge.clear();
        let Self {
            mesh,
            tree,
            workspace,
            vertices,
            edges,
            faces,
        } = self;
        let mut vertex_face = |a: &Element, b: &Element| {
            let Some(f) = b.face else { return };
            let bounds = &faces[f as usize];
            let corners = &mesh.faces()[f as usize];
            for v in a.vertices.iter() {
                if vertices[v as usize].overlaps(bounds) && !mesh.are_joined(&[v], corners) {
                    out.vertex_face.push([v, f]);
                }
            }
        };
        tree.traverse_bvtt_single_tree::<false>(workspace, &mut |i, j| {
            let (a, b) = (&mesh.elements()[i as usize], &mesh.elements()[j as usize]);
            vertex_face(a, b);
            vertex_face(b, a);
            for e in a.edges.iter() {
                let bounds = &edges[e as usize];
                let ends = &mesh.edges()[e as usize];
                for g in b.edges.iter() {
                    let others = &mesh.edges()[g as usize];
                    if bounds.overlaps(&edges[g as usize]) && !mesh.are_joined(ends, others) {
                        out.edge_edge.push([e.min(g), e.max(g)]);
                    }
                }
            }
        });
    }

    /// An edge and a face of the mesh that are not joined, where the edge passes through the face at the
    /// positions `x` (`3V`) of the last update. Both ends of the edge are further than `depth` (metres) from
    /// the plane of the face. With 0 every crossing counts. A larger depth leaves out faces that lie on each
    /// other up to round-off.
    pub fn self_crossing(&mut self, x: &[f64], depth: f64) -> Option<[u32; 2]> {
        let mut pairs = Vec::new();
        self.self_edge_faces(&mut pairs);
        let mesh = self.mesh();
        pairs.into_iter().find(|&[e, f]| {
            let (edge, face) = (mesh.edges()[e as usize], mesh.faces()[f as usize]);
            let ([p, q], [a, b, c]) = (gather(x, edge), gather(x, face));
            let normal = (b - a).cross(&(c - a)).normalize();
            let is_deep = |p: &Vector3<f64>| normal.dot(&(p - a)).abs() > depth;
            pierces([p, q], [a, b, c]) && (depth == 0.0 || [p, q].iter().all(is_deep))
        })
    }

    /// Pairs of an edge and a face of the mesh without a common vertex since the last update; `out` is
    /// overwritten.
    pub fn self_edge_faces(&mut self, out: &mut Vec<[u32; 2]>) {
        out.clear();
        let Self {
            mesh,
            tree,
            workspace,
            edges,
            faces,
            ..
        } = self;
        let mut edge_face = |a: &Element, b: &Element| {
            let Some(f) = b.face else { return };
            let corners = &mesh.faces()[f as usize];
            for e in a.edges.iter() {
                let ends = &mesh.edges()[e as usize];
                if edges[e as usize].overlaps(&faces[f as usize]) && !mesh.are_joined(ends, corners)
                {
                    out.push([e, f]);
                }
            }
        };
        tree.traverse_bvtt_single_tree::<false>(workspace, &mut |i, j| {
            let (a, b) = (&mesh.elements()[i as usize], &mesh.elements()[j as usize]);
            edge_face(a, b);
            edge_face(b, a);
        });
    }

    /// Pairs of an edge of this mesh and a face of another since the last updates of both; `out` is
    /// overwritten.
    pub fn edge_faces_with(&self, other: &Self, out: &mut Vec<[u32; 2]>) {
        out.clear();
        for (i, j) in self.tree.leaf_pairs(&other.tree, |a, b| a.intersects(b)) {
            let Some(f) = other.mesh.elements()[j as usize].face else {
                continue;
            };
            for e in self.mesh.elements()[i as usize].edges.iter() {
                if self.edges[e as usize].overlaps(&other.faces[f as usize]) {
                    out.push([e, f]);
                }
            }
        }
    }

    /// Pairs of this mesh with another whose boxes overlap since the last updates of both; `out` is
    /// overwritten.
    pub fn candidates_with(&self, other: &Self, out: &mut CrossCandidates) {
        out.vertex_face.clear();
        out.face_vertex.clear();
        out.edge_edge.clear();
        let pairs = self.tree.leaf_pairs(&other.tree, |a, b| a.intersects(b));
        for (i, j) in pairs {
            let a = &self.mesh.elements()[i as usize];
            let b = &other.mesh.elements()[j as usize];
            if let Some(f) = b.face {
                for v in a.vertices.iter() {
                    if self.vertices[v as usize].overlaps(&other.faces[f as usize]) {
                        out.vertex_face.push([v, f]);
                    }
                }
            }
            if let Some(f) = a.face {
                for v in b.vertices.iter() {
                    if self.faces[f as usize].overlaps(&other.vertices[v as usize]) {
                        out.face_vertex.push([f, v]);
                    }
                }
            }
            for e in a.edges.iter() {
                for g in b.edges.iter() {
                    if self.edges[e as usize].overlaps(&other.edges[g as usize]) {
                        out.edge_edge.push([e, g]);
                    }
                }
            }
        }
    }
}
