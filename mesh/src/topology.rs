//! Adjacency of vertices, edges and faces, without coordinates.

use crate::{EdgeId, FaceId, HalfEdgeId, VertexId};

/// The connectivity of an oriented triangulated surface, with or without boundary, of any number of
/// components.
///
/// Everything is kept in flat arrays (compressed rows for the fans of the vertices), so that memory is O(V +
/// E + F); building takes O(F log F).
///
/// Order and direction are fixed by the faces:
/// * edges are sorted by their (smaller, larger) vertex index;
/// * an interior edge runs from its smaller to its larger vertex, a boundary edge runs as its only face does,
///   so that the left face always exists;
/// * the faces and edges at a vertex are listed counter-clockwise as seen from the side from which the faces
///   are counter-clockwise. At a boundary vertex the list runs from one boundary edge to the other; at an
///   interior vertex it starts at the face of lowest index.
///
/// ```
/// use isosheet_mesh::{EdgeId, FaceId, Topology, VertexId};
/// // Two triangles on the edge between vertices 0 and 2.
/// let t = Topology::from_faces(4, &[[0, 1, 2], [0, 2, 3]])?;
/// let hinge = t.find_edge(VertexId(2), VertexId(0)).expect("the diagonal");
/// assert_eq!(t.edge_faces(hinge), [Some(FaceId(1)), Some(FaceId(0))]);
/// assert_eq!(t.opposite_vertex(hinge, FaceId(0)), VertexId(1));
/// assert_eq!(t.euler_characteristic(), 1);
/// # Ok::<(), isosheet_mesh::TopologyError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology {
    pub(crate) faces: Vec<[VertexId; 3]>,
    pub(crate) edges: Vec<[VertexId; 2]>,
    /// Faces left of half-edge 2e and left of 2e + 1.
    pub(crate) edge_faces: Vec<[Option<FaceId>; 2]>,
    pub(crate) face_edges: Vec<[EdgeId; 3]>,
    /// Row pointers and entries of the edges at each vertex.
    pub(crate) vertex_edge_start: Vec<u32>,
    pub(crate) vertex_edges: Vec<EdgeId>,
    /// Row pointers and entries of the faces at each vertex.
    pub(crate) vertex_face_start: Vec<u32>,
    pub(crate) vertex_faces: Vec<FaceId>,
    /// Component of each vertex, numbered by their smallest vertex.
    pub(crate) vertex_component: Vec<u32>,
    pub(crate) component_count: usize,
    pub(crate) boundary_edge_count: usize,
    pub(crate) boundary_vertex_count: usize,
}

impl Topology {
    /// The number of vertices V.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.vertex_component.len()
    }

    /// The number of edges E.
    #[inline]
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// The number of faces F.
    #[inline]
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The number B of edges with one face.
    #[inline]
    pub fn boundary_edge_count(&self) -> usize {
        self.boundary_edge_count
    }

    /// The number of vertices on the boundary (equal to the number of boundary edges).
    #[inline]
    pub fn boundary_vertex_count(&self) -> usize {
        self.boundary_vertex_count
    }

    /// The number `V_i` of vertices that are not on the boundary.
    #[inline]
    pub fn interior_vertex_count(&self) -> usize {
        self.vertex_count() - self.boundary_vertex_count
    }

    /// The number of edges with two faces.
    #[inline]
    pub fn interior_edge_count(&self) -> usize {
        self.edge_count() - self.boundary_edge_count
    }

    /// chi = V - E + F (Liu, Tang and Joneja 2007, Eq. 9): 1 for a disk, 0 for an annulus, 2 for a sphere,
    /// the sum over the components of several.
    #[inline]
    pub fn euler_characteristic(&self) -> i64 {
        self.vertex_count() as i64 - self.edge_count() as i64 + self.face_count() as i64
    }

    /// All vertices.
    pub fn vertex_ids(&self) -> impl ExactSizeIterator<Item = VertexId> + use<> {
        (0..self.vertex_count() as u32).map(VertexId)
    }

    /// All edges.
    pub fn edge_ids(&self) -> impl ExactSizeIterator<Item = EdgeId> + use<> {
        (0..self.edge_count() as u32).map(EdgeId)
    }

    /// All faces.
    pub fn face_ids(&self) -> impl ExactSizeIterator<Item = FaceId> + use<> {
        (0..self.face_count() as u32).map(FaceId)
    }

    /// The two ends of every edge; the edge runs from the first to the second.
    #[inline]
    pub fn edges(&self) -> &[[VertexId; 2]] {
        &self.edges
    }

    /// The corners of every face, counter-clockwise, as given.
    #[inline]
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// The faces to the left and to the right of an edge. The left one always exists.
    #[inline]
    pub fn edge_faces(&self, e: EdgeId) -> [Option<FaceId>; 2] {
        self.edge_faces[e.index()]
    }

    /// The face to the left of the edge, which always exists.
    #[inline]
    pub fn left_face(&self, e: EdgeId) -> FaceId {
        match self.edge_faces[e.index()][0] {
            Some(f) => f,
            None => unreachable!("every edge is directed so that its left face exists"),
        }
    }

    /// The edges of a face: edge `i` joins corners `i` and `i + 1`.
    #[inline]
    pub fn face_edges(&self, f: FaceId) -> [EdgeId; 3] {
        self.face_edges[f.index()]
    }

    /// The edges at a vertex, counter-clockwise; at a boundary vertex from boundary edge to boundary edge.
    ///
    /// Edge `i` and the next one (cyclically at an interior vertex) bound face `i` of [`Self::vertex_faces`].
    #[inline]
    pub fn vertex_edges(&self, v: VertexId) -> &[EdgeId] {
        let (a, b) = (
            self.vertex_edge_start[v.index()],
            self.vertex_edge_start[v.index() + 1],
        );
        &self.vertex_edges[a as usize..b as usize]
    }

    /// The faces at a vertex, counter-clockwise; one less than its edges at a boundary vertex, else as many.
    #[inline]
    pub fn vertex_faces(&self, v: VertexId) -> &[FaceId] {
        let (a, b) = (
            self.vertex_face_start[v.index()],
            self.vertex_face_start[v.index() + 1],
        );
        &self.vertex_faces[a as usize..b as usize]
    }

    /// The number of edges at a vertex.
    #[inline]
    pub fn degree(&self, v: VertexId) -> usize {
        self.vertex_edges(v).len()
    }

    /// The vertices that share an edge with `v`, in the order of [`Self::vertex_edges`].
    pub fn neighbours(&self, v: VertexId) -> impl ExactSizeIterator<Item = VertexId> + '_ {
        self.vertex_edges(v)
            .iter()
            .map(move |&e| self.other_end(e, v))
    }

    /// The end of `e` that is not `v`; `v` must be an end of `e`.
    #[inline]
    pub fn other_end(&self, e: EdgeId, v: VertexId) -> VertexId {
        let [a, b] = self.edges[e.index()];
        debug_assert!(a == v || b == v, "{v} is not an end of {e}");
        if a == v { b } else { a }
    }

    /// The edge between two vertices, in either order; `None` where there is none, or no such
    /// vertex. It looks through the edges of the vertex that has fewer.
    pub fn find_edge(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        if a == b || a.max(b).index() >= self.vertex_count() {
            return None;
        }
        let [of_a, of_b] = [a, b].map(|v| self.vertex_edges(v));
        let (own, other) = match of_a.len() <= of_b.len() {
            true => (of_a, b),
            false => (of_b, a),
        };
        let meets = |e: &&EdgeId| self.edges[e.index()].contains(&other);
        own.iter().find(meets).copied()
    }

    /// The corner of `f` that is not an end of its edge `e`; `f` must have the edge `e`.
    pub fn opposite_vertex(&self, e: EdgeId, f: FaceId) -> VertexId {
        let edges = self.face_edges[f.index()];
        debug_assert!(edges.contains(&e), "{f} does not have {e}");
        let side = if edges[0] == e {
            0
        } else if edges[1] == e {
            1
        } else {
            2
        };
        self.faces[f.index()][(side + 2) % 3]
    }

    /// The vertices opposite an edge in its left and right face: the two free corners of a hinge.
    pub fn opposite_vertices(&self, e: EdgeId) -> [Option<VertexId>; 2] {
        self.edge_faces(e)
            .map(|f| f.map(|f| self.opposite_vertex(e, f)))
    }

    /// The vertex that a half-edge starts from.
    #[inline]
    pub fn tail(&self, h: HalfEdgeId) -> VertexId {
        self.edges[h.edge().index()][h.side()]
    }

    /// The vertex that a half-edge runs to.
    #[inline]
    pub fn head(&self, h: HalfEdgeId) -> VertexId {
        self.edges[h.edge().index()][1 - h.side()]
    }

    /// The face to the left of a half-edge.
    #[inline]
    pub fn half_edge_face(&self, h: HalfEdgeId) -> Option<FaceId> {
        self.edge_faces[h.edge().index()][h.side()]
    }

    /// Whether the edge has only one face.
    #[inline]
    pub fn is_boundary_edge(&self, e: EdgeId) -> bool {
        self.edge_faces[e.index()][1].is_none()
    }

    /// Whether the vertex lies on the boundary.
    #[inline]
    pub fn is_boundary_vertex(&self, v: VertexId) -> bool {
        self.vertex_edges(v).len() != self.vertex_faces(v).len()
    }

    /// Whether there is no boundary at all.
    #[inline]
    pub fn is_closed(&self) -> bool {
        self.boundary_edge_count == 0
    }

    /// The boundary as closed loops of vertices with the surface on the left, each starting at its lowest
    /// vertex.
    ///
    /// The outer boundary of a flat sheet is counter-clockwise, the boundaries of its holes clockwise.
    pub fn boundary_loops(&self) -> Vec<Vec<VertexId>> {
        let mut seen = vec![false; self.vertex_count()];
        let mut loops = Vec::new();
        for start in self.vertex_ids() {
            if seen[start.index()] || !self.is_boundary_vertex(start) {
                continue;
            }
            let mut boundary = Vec::new();
            let mut v = start;
            while !seen[v.index()] {
                seen[v.index()] = true;
                boundary.push(v);
                // The first edge of a boundary fan leaves the vertex with the surface on its left.
                v = self.other_end(self.vertex_edges(v)[0], v);
            }
            loops.push(boundary);
        }
        loops
    }

    /// The number of connected components.
    #[inline]
    pub fn component_count(&self) -> usize {
        self.component_count
    }

    /// The component of a vertex, below [`Self::component_count`]; components are numbered by their lowest
    /// vertex.
    #[inline]
    pub fn vertex_component(&self, v: VertexId) -> usize {
        self.vertex_component[v.index()] as usize
    }

    /// The vertices of each component, ascending.
    pub fn components(&self) -> Vec<Vec<VertexId>> {
        let mut out = vec![Vec::new(); self.component_count];
        for v in self.vertex_ids() {
            out[self.vertex_component(v)].push(v);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::tests::surfaces::{disks, octahedron, surfaces, torus};

    #[test]
    fn closed_surfaces() {
        for ((n, faces), chi) in [(octahedron(), 2), (torus(3, 3), 0), (torus(5, 4), 0)] {
            let t = Topology::from_faces(n, &faces).unwrap();
            t.check_invariants();
            assert!(t.is_closed());
            assert_eq!(t.euler_characteristic(), chi);
            assert!(t.boundary_loops().is_empty());
        }
    }

    #[test]
    fn fan_of_a_boundary_vertex_is_counter_clockwise() {
        // Three triangles about vertex 0, given in another order.
        let t = Topology::from_faces(5, &[[0, 2, 3], [0, 3, 4], [0, 1, 2]]).unwrap();
        t.check_invariants();
        let around: Vec<u32> = t.neighbours(VertexId(0)).map(|v| v.0).collect();
        assert_eq!(around, [1, 2, 3, 4]);
        assert_eq!(
            t.vertex_faces(VertexId(0)),
            [FaceId(2), FaceId(0), FaceId(1)]
        );
        let boundary: Vec<u32> = t.boundary_loops()[0].iter().map(|v| v.0).collect();
        assert_eq!(boundary, [0, 1, 2, 3, 4]);
    }

    /// This takes 30 ms; an algorithm of quadratic cost would take minutes.
    #[test]
    fn a_large_mesh_is_built() {
        let s = crate::generate::isotropic_square(7, 1.0).unwrap();
        let t = s.topology();
        assert_eq!((t.face_count(), t.vertex_count()), (131_072, 66_049));
    }

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        #[test]
        fn adjacency_of_any_surface_is_right((n, faces) in surfaces()) {
            Topology::from_faces(n, &faces).unwrap().check_invariants();
        }

        #[test]
        fn disks_are_disks((n, faces) in disks()) {
            let t = Topology::from_faces(n, &faces).unwrap();
            t.check_invariants();
            prop_assert_eq!(t.euler_characteristic(), 1);
            prop_assert_eq!((t.component_count(), t.boundary_loops().len()), (1, 1));
        }

        /// Renumbering vertices and reordering faces changes names only.
        #[test]
        fn numbering_does_not_matter((n, faces) in surfaces(), seed in any::<u64>()) {
            use rand::{RngExt, SeedableRng};
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let mut name: Vec<u32> = (0..n as u32).collect();
            for k in (1..n).rev() {
                name.swap(k, rng.random_range(0..=k));
            }
            let mut other: Vec<[u32; 3]> = faces.iter().map(|f| f.map(|v| name[v as usize])).collect();
            for k in (1..other.len()).rev() {
                other.swap(k, rng.random_range(0..=k));
                other[k].rotate_left(rng.random_range(0..3));
            }
            let (s, t) = (Topology::from_faces(n, &faces).unwrap(), Topology::from_faces(n, &other).unwrap());
            t.check_invariants();
            prop_assert_eq!(s.edge_count(), t.edge_count());
            prop_assert_eq!(s.boundary_loops().len(), t.boundary_loops().len());
            prop_assert_eq!(s.component_count(), t.component_count());
            for v in s.vertex_ids() {
                let w = VertexId(name[v.index()]);
                prop_assert_eq!(s.is_boundary_vertex(v), t.is_boundary_vertex(w));
                let mut around: Vec<u32> = s.neighbours(v).map(|u| name[u.index()]).collect();
                let other: Vec<u32> = t.neighbours(w).map(|u| u.0).collect();
                // The same cyclic order; the same order where the fan has an end.
                if !s.is_boundary_vertex(v) {
                    let turn = around.iter().position(|u| *u == other[0]).unwrap();
                    around.rotate_left(turn);
                }
                prop_assert_eq!(around, other);
            }
        }
    }
}
