//! What of a mesh can touch: its vertices, edges and faces.

mod glued;
mod parts;
mod passing;
mod round;

use glued::Glued;
use isosheet_mesh::{Advice, Topology};
use parts::Parts;
use passing::Passing;
use round::Rounds;
use std::collections::HashMap;
use std::ops::Range;
use thiserror::Error;

/// Vertices, edges and faces that take part in contact, without coordinates.
///
/// Unlike [`Topology`] it needs no manifold: the surface of an obstacle may be any set of triangles,
/// also a single segment or point (the axis of a capsule, the centre of a ball).
#[derive(Debug, Clone, PartialEq)]
pub struct ContactMesh {
    vertex_count: usize,
    edges: Vec<[u32; 2]>,
    faces: Vec<[u32; 3]>,
    elements: Vec<Element>,
    glued: Option<Glued>,
    parts: Option<Parts>,
    passing: Passing,
    rounds: Rounds,
}

/// A face, a free edge or a free vertex together with the vertices and edges that it represents.
///
/// Every edge and vertex belongs to exactly one element that contains it. Two primitives whose boxes
/// overlap have elements whose boxes overlap, so a tree over the elements finds each pair of
/// primitives once (Curtis, Tamstorf and Manocha 2008, representative triangles).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Element {
    pub(crate) face: Option<u32>,
    pub(crate) edges: Owned,
    pub(crate) vertices: Owned,
}

/// Up to three indices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Owned {
    items: [u32; 3],
    len: u8,
}

impl Owned {
    fn push(&mut self, item: u32) {
        self.items[usize::from(self.len)] = item;
        self.len += 1;
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        self.items[..usize::from(self.len)].iter().copied()
    }
}

/// A primitive that makes no sense.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ContactMeshError {
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex} of {vertex_count}")]
    FaceVertex {
        /// The face.
        face: usize,
        /// The vertex named.
        vertex: u32,
        /// How many there are.
        vertex_count: usize,
    },
    /// A face names a vertex twice.
    #[error("face {face} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: u32,
    },
    /// More vertices, edges or faces than 32-bit indices can number.
    #[error("{count} primitives are more than the limit of 2^32 - 1")]
    TooMany {
        /// How many.
        count: usize,
    },
}

impl Advice for ContactMeshError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::FaceVertex { .. } => Some("number vertices from 0"),
            Self::RepeatedVertex { .. } => Some("remove the face"),
            Self::TooMany { .. } => Some("use a coarser mesh"),
        }
    }
}

impl ContactMesh {
    /// All primitives of a sheet, with the same numbering.
    pub fn from_topology(topology: &Topology) -> Self {
        let edges = topology.edges().iter().map(|e| e.map(|v| v.0)).collect();
        let faces = topology.faces().iter().map(|f| f.map(|v| v.0)).collect();
        let face_edges: Vec<[u32; 3]> = topology
            .face_ids()
            .map(|f| topology.face_edges(f).map(|e| e.0))
            .collect();
        Self::with_elements(topology.vertex_count(), edges, faces, &face_edges)
    }

    /// Triangles with vertices `0 .. vertex_count`. Edges are numbered in the order in which the
    /// faces name them; vertices without a face still take part as points.
    ///
    /// # Errors
    /// [`ContactMeshError`] naming the first face that makes no sense.
    pub fn from_triangles(
        vertex_count: usize,
        faces: &[[u32; 3]],
    ) -> Result<Self, ContactMeshError> {
        let count = vertex_count.max(3 * faces.len());
        if u32::try_from(count).is_err() {
            return Err(ContactMeshError::TooMany { count });
        }
        let mut edges = Vec::new();
        let mut numbers = HashMap::new();
        let mut face_edges = Vec::with_capacity(faces.len());
        for (face, corners) in faces.iter().enumerate() {
            for (k, &vertex) in corners.iter().enumerate() {
                if vertex as usize >= vertex_count {
                    return Err(ContactMeshError::FaceVertex {
                        face,
                        vertex,
                        vertex_count,
                    });
                }
                if corners[..k].contains(&vertex) {
                    return Err(ContactMeshError::RepeatedVertex { face, vertex });
                }
            }
            face_edges.push(std::array::from_fn(|k| {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                *numbers.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    edges.push([a, b]);
                    index(edges.len() - 1)
                })
            }));
        }
        Ok(Self::with_elements(
            vertex_count,
            edges,
            faces.to_vec(),
            &face_edges,
        ))
    }

    /// A single point.
    pub fn point() -> Self {
        Self::with_elements(1, Vec::new(), Vec::new(), &[])
    }

    /// A single segment between the vertices 0 and 1.
    pub fn segment() -> Self {
        Self::with_elements(2, vec![[0, 1]], Vec::new(), &[])
    }

    /// A mesh of these vertices without faces, with these edges and one at each vertex besides, both ends of
    /// which the vertex is.
    #[must_use]
    pub fn with_points_as_edges(mut self) -> Self {
        self.edges
            .extend((0..index(self.vertex_count)).map(|v| [v, v]));
        Self::with_elements(self.vertex_count, self.edges, Vec::new(), &[])
    }

    /// A mesh of these vertices without faces, and with the edges that are to be kept.
    #[must_use]
    pub fn without_faces(mut self, keep: impl FnMut(&[u32; 2]) -> bool) -> Self {
        self.edges.retain(keep);
        Self::with_elements(self.vertex_count, self.edges, Vec::new(), &[])
    }

    fn with_elements(
        vertex_count: usize,
        edges: Vec<[u32; 2]>,
        faces: Vec<[u32; 3]>,
        face_edges: &[[u32; 3]],
    ) -> Self {
        let mut edge_taken = vec![false; edges.len()];
        let mut vertex_taken = vec![false; vertex_count];
        let mut elements = Vec::with_capacity(faces.len());
        let take = |taken: &mut [bool], candidates: &[u32]| {
            let mut owned = Owned::default();
            for &c in candidates {
                if !std::mem::replace(&mut taken[c as usize], true) {
                    owned.push(c);
                }
            }
            owned
        };
        for (f, (corners, sides)) in faces.iter().zip(face_edges).enumerate() {
            elements.push(Element {
                face: Some(index(f)),
                edges: take(&mut edge_taken, sides),
                vertices: take(&mut vertex_taken, corners),
            });
        }
        for e in 0..edges.len() {
            if !edge_taken[e] {
                elements.push(Element {
                    face: None,
                    edges: take(&mut edge_taken, &[index(e)]),
                    vertices: take(&mut vertex_taken, &edges[e]),
                });
            }
        }
        for v in 0..vertex_count {
            if !vertex_taken[v] {
                elements.push(Element {
                    face: None,
                    edges: Owned::default(),
                    vertices: take(&mut vertex_taken, &[index(v)]),
                });
            }
        }
        Self {
            vertex_count,
            edges,
            faces,
            elements,
            glued: None,
            parts: None,
            passing: Passing::default(),
            rounds: Rounds::default(),
        }
    }

    /// Counts the vertices of each pair as one, because they are glued to each other, so that primitives that
    /// have them do not repel each other. Replaces pairs named before.
    ///
    /// # Panics
    /// If a vertex does not exist.
    #[must_use]
    pub fn with_glue(mut self, pairs: &[[u32; 2]]) -> Self {
        let glued = || Glued::new(self.vertex_count, &self.edges, pairs);
        self.glued = (!pairs.is_empty()).then(glued);
        self
    }

    /// Names parts, by ranges of vertices, that do not repel themselves, and vertices outside of a part that
    /// do not repel it, each with the number of the part. Replaces what was named before.
    ///
    /// # Panics
    /// If a vertex does not exist.
    #[must_use]
    pub fn with_parts(
        mut self,
        parts: &[Range<usize>],
        attached: impl IntoIterator<Item = (u32, u32)>,
    ) -> Self {
        let named = || Parts::new(self.vertex_count, parts, attached);
        self.parts = (!parts.is_empty()).then(named);
        self
    }

    /// Lets what has its vertices in one range pass through what has them in the other.
    #[must_use]
    pub fn with_passing(mut self, vertices: [Range<usize>; 2]) -> Self {
        self.passing.add(vertices);
        self
    }

    /// Puts a round body in the place of vertices and of all edges and faces at them, which take no part any
    /// more. The body has new vertices, which come after all others; the marked ones take part as vertices.
    /// It also has new edges, by their numbers among the new vertices; an edge may have both ends in one
    /// place. Its surface is `radius` (metres) about these. It belongs to a [part](Self::with_parts), by its
    /// number, if there are any.
    ///
    /// # Panics
    /// If the primitives are more than 32-bit indices can number.
    #[must_use]
    pub fn with_round(
        mut self,
        replaced: Range<usize>,
        part: usize,
        vertices: &[bool],
        edges: &[[u32; 2]],
        radius: f64,
    ) -> Self {
        let first = index(self.vertex_count);
        let is_replaced = |v: &u32| replaced.contains(&(*v as usize));
        let (mesh_edges, mesh_faces) = (&self.edges, &self.faces);
        self.elements.retain(|element| {
            let of_face = element.face.map(|f| mesh_faces[f as usize][0]);
            let of_edge = || {
                element
                    .edges
                    .iter()
                    .next()
                    .map(|e| mesh_edges[e as usize][0])
            };
            let of_vertex = || element.vertices.iter().next();
            !of_face
                .or_else(of_edge)
                .or_else(of_vertex)
                .is_some_and(|v| is_replaced(&v))
        });
        self.vertex_count += vertices.len();
        let _ = index(self.vertex_count);
        for (own, v) in vertices.iter().zip(first..) {
            let mut element = Element {
                face: None,
                edges: Owned::default(),
                vertices: Owned::default(),
            };
            if *own {
                element.vertices.push(v);
                self.elements.push(element);
            }
        }
        for edge in edges {
            let mut element = Element {
                face: None,
                edges: Owned::default(),
                vertices: Owned::default(),
            };
            element.edges.push(index(self.edges.len()));
            self.edges.push(edge.map(|v| first + v));
            self.elements.push(element);
        }
        self.rounds.add(first, replaced, vertices, radius);
        if let Some(glued) = &mut self.glued {
            glued.extend(self.vertex_count);
        }
        if let Some(parts) = &mut self.parts {
            parts.extend(vertices.len(), part);
        }
        self
    }

    /// Whether a vertex is one of a round body.
    #[inline]
    pub fn is_round(&self, vertex: u32) -> bool {
        self.rounds.radius(vertex).is_some()
    }

    /// Whether an edge is a point of a round body.
    #[inline]
    pub fn is_point(&self, edge: u32) -> bool {
        let [a, b] = self.edges[edge as usize];
        self.rounds.is_point([a, b])
    }

    /// Whether an edge is the axis of a round body.
    #[inline]
    pub fn is_axis(&self, edge: u32) -> bool {
        let [a, _] = self.edges[edge as usize];
        self.is_round(a) && !self.is_point(edge)
    }

    /// How far the surface is from a vertex, metres: the radius of a round body, and otherwise zero.
    #[inline]
    pub fn radius(&self, vertex: u32) -> f64 {
        self.rounds.radius(vertex).unwrap_or(0.0)
    }

    /// Whether a vertex takes part: of a round body some do, and what it is in the place of does not.
    #[inline]
    pub fn takes_part(&self, vertex: u32) -> bool {
        self.rounds.takes_part(vertex)
    }

    /// Whether two primitives, by their vertices, have one of them in common, are glued to each other, belong
    /// together or pass through each other: no pair of the mesh with itself.
    pub fn are_joined(&self, first: &[u32], second: &[u32]) -> bool {
        let parts = self.parts.as_ref();
        self.passing.pass(first, second)
            || parts.is_some_and(|parts| parts.are_joined(first, second))
            || match &self.glued {
                None => first.iter().any(|v| second.contains(v)),
                Some(glued) => glued.are_joined(first, second),
            }
    }

    /// Number of vertices.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Ends of the edges.
    #[inline]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// Corners of the faces.
    #[inline]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The vertices of the pair of a vertex and a face, in this order.
    #[inline]
    pub fn vertex_face(&self, [v, f]: [u32; 2]) -> [u32; 4] {
        let [a, b, c] = self.faces[f as usize];
        [v, a, b, c]
    }

    /// The vertices of a pair of two edges, the first edge first.
    #[inline]
    pub fn edge_edge(&self, [e, g]: [u32; 2]) -> [u32; 4] {
        let ([a, b], [c, d]) = (self.edges[e as usize], self.edges[g as usize]);
        [a, b, c, d]
    }

    pub(crate) fn elements(&self) -> &[Element] {
        &self.elements
    }
}

/// Counts were checked to fit, or come from a [`Topology`], which checked them.
fn index(i: usize) -> u32 {
    u32::try_from(i).expect("primitives are numbered with 32 bits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate;

    fn check_ownership(mesh: &ContactMesh) {
        let mut edges: Vec<u32> = mesh.elements.iter().flat_map(|e| e.edges.iter()).collect();
        let mut vertices: Vec<u32> = mesh
            .elements
            .iter()
            .flat_map(|e| e.vertices.iter())
            .collect();
        edges.sort_unstable();
        vertices.sort_unstable();
        assert!(edges.iter().copied().eq(0..mesh.edges.len() as u32));
        assert!(vertices.iter().copied().eq(0..mesh.vertex_count as u32));
        for element in &mesh.elements {
            if let Some(f) = element.face {
                let corners = mesh.faces[f as usize];
                assert!(element.vertices.iter().all(|v| corners.contains(&v)));
                for e in element.edges.iter() {
                    assert!(mesh.edges[e as usize].iter().all(|v| corners.contains(v)));
                }
            }
        }
    }

    #[test]
    fn every_primitive_has_one_owner() {
        let sheet = generate::isotropic_square(2, 1.0).unwrap();
        let mesh = ContactMesh::from_topology(sheet.topology());
        assert_eq!(mesh.faces().len(), sheet.topology().face_count());
        assert_eq!(mesh.edges().len(), sheet.topology().edge_count());
        check_ownership(&mesh);
        let faces: Vec<[u32; 3]> = mesh.faces().to_vec();
        let again = ContactMesh::from_triangles(mesh.vertex_count() + 2, &faces).unwrap();
        assert_eq!(again.edges().len(), mesh.edges().len());
        check_ownership(&again);
        check_ownership(&ContactMesh::point());
        check_ownership(&ContactMesh::segment());
        // Three triangles at one edge: no manifold.
        check_ownership(
            &ContactMesh::from_triangles(5, &[[0, 1, 2], [0, 1, 3], [1, 0, 4]]).unwrap(),
        );
    }

    #[test]
    fn bad_faces_are_named() {
        assert_eq!(
            ContactMesh::from_triangles(3, &[[0, 1, 2], [0, 1, 3]]),
            Err(ContactMeshError::FaceVertex {
                face: 1,
                vertex: 3,
                vertex_count: 3
            })
        );
        assert_eq!(
            ContactMesh::from_triangles(3, &[[0, 1, 0]]),
            Err(ContactMeshError::RepeatedVertex { face: 0, vertex: 0 })
        );
    }
}
