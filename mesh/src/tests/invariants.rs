//! Everything that must hold of a [`Topology`], checked from the definitions.

use std::collections::{BTreeMap, BTreeSet};

use crate::{EdgeId, FaceId, HalfEdgeId, Topology, VertexId};

impl Topology {
    /// Checks every invariant of the adjacency against the face list, by other means than the code that built
    /// it.
    ///
    /// # Panics
    /// With a description of the first invariant that does not hold.
    pub(crate) fn check_invariants(&self) {
        self.check_edges();
        self.check_face_edges();
        self.check_fans();
        self.check_counts();
    }

    fn check_edges(&self) {
        // Directed edge -> the face that runs along it.
        let mut directed: BTreeMap<(VertexId, VertexId), FaceId> = BTreeMap::new();
        for f in self.face_ids() {
            let c = self.faces[f.index()];
            for i in 0..3 {
                let before = directed.insert((c[i], c[(i + 1) % 3]), f);
                assert!(
                    before.is_none(),
                    "{f} and {before:?} run along one edge in the same direction"
                );
            }
        }
        let undirected: BTreeSet<_> = directed
            .keys()
            .map(|&(a, b)| (a.min(b), a.max(b)))
            .collect();
        let listed: Vec<_> = self
            .edges
            .iter()
            .map(|&[a, b]| (a.min(b), a.max(b)))
            .collect();
        assert_eq!(
            listed,
            undirected.into_iter().collect::<Vec<_>>(),
            "edges are sorted by their ends"
        );
        for e in self.edge_ids() {
            let [a, b] = self.edges[e.index()];
            let expected = [
                directed.get(&(a, b)).copied(),
                directed.get(&(b, a)).copied(),
            ];
            assert_eq!(self.edge_faces(e), expected, "faces of {e}");
            assert_eq!(Some(self.left_face(e)), expected[0], "{e} has a left face");
            assert_eq!(
                self.is_boundary_edge(e),
                expected[1].is_none(),
                "boundary flag of {e}"
            );
            assert!(
                expected[1].is_none() || a < b,
                "an interior edge runs upwards"
            );
            assert_eq!(self.find_edge(a, b), Some(e), "{e} is found by its ends");
            assert_eq!(
                self.find_edge(b, a),
                Some(e),
                "{e} is found by its ends in the other order"
            );
            for side in 0..2 {
                let h = HalfEdgeId::new(e, side);
                assert_eq!(
                    (self.tail(h), self.head(h.twin())),
                    ([a, b][side], [a, b][side]),
                    "ends of {h}"
                );
                assert_eq!(self.half_edge_face(h), expected[side], "face of {h}");
                if let Some(f) = expected[side] {
                    let opposite = self.opposite_vertex(e, f);
                    assert!(opposite != a && opposite != b, "{opposite} is opposite {e}");
                    assert!(
                        self.faces[f.index()].contains(&opposite),
                        "{opposite} is a corner of {f}"
                    );
                    assert_eq!(
                        self.opposite_vertices(e)[side],
                        Some(opposite),
                        "free corner of {h}"
                    );
                }
            }
        }
    }

    fn check_face_edges(&self) {
        for f in self.face_ids() {
            let (c, e) = (self.faces[f.index()], self.face_edges(f));
            for i in 0..3 {
                assert_eq!(
                    self.find_edge(c[i], c[(i + 1) % 3]),
                    Some(e[i]),
                    "edge {i} of {f}"
                );
            }
        }
    }

    fn check_fans(&self) {
        let mut corners = 0;
        for v in self.vertex_ids() {
            let (edges, faces) = (self.vertex_edges(v), self.vertex_faces(v));
            corners += faces.len();
            let around: BTreeSet<FaceId> = faces.iter().copied().collect();
            assert_eq!(around.len(), faces.len(), "the faces at {v} are distinct");
            assert!(
                faces.iter().all(|f| self.faces[f.index()].contains(&v)),
                "the faces at {v} have it"
            );
            let distinct: BTreeSet<EdgeId> = edges.iter().copied().collect();
            assert_eq!(distinct.len(), edges.len(), "the edges at {v} are distinct");
            let boundary = edges.iter().any(|&e| self.is_boundary_edge(e));
            assert_eq!(self.is_boundary_vertex(v), boundary, "boundary flag of {v}");
            assert_eq!(
                edges.len(),
                faces.len() + usize::from(boundary),
                "edges against faces at {v}"
            );
            assert_eq!(
                self.degree(v),
                self.neighbours(v).len(),
                "neighbours of {v}"
            );
            for (i, &f) in faces.iter().enumerate() {
                let ends = [edges[i], edges[(i + 1) % edges.len()]].map(|e| self.other_end(e, v));
                // Counter-clockwise: the face runs v -> first neighbour -> second neighbour.
                let c = self.faces[f.index()];
                let k = c.iter().position(|&w| w == v).expect("checked above");
                assert_eq!(
                    [c[(k + 1) % 3], c[(k + 2) % 3]],
                    ends,
                    "{f} lies between its edges at {v}"
                );
            }
            if boundary {
                assert!(
                    self.is_boundary_edge(edges[0]),
                    "the fan of {v} starts at the boundary"
                );
                assert!(
                    self.is_boundary_edge(edges[edges.len() - 1]),
                    "the fan of {v} ends at the boundary"
                );
            } else {
                assert_eq!(
                    faces.iter().min(),
                    Some(&faces[0]),
                    "the fan of {v} starts at its lowest face"
                );
            }
        }
        assert_eq!(corners, 3 * self.face_count(), "every corner is in one fan");
    }

    fn check_counts(&self) {
        let loops = self.boundary_loops();
        let on_loops: usize = loops.iter().map(Vec::len).sum();
        assert_eq!(
            on_loops,
            self.boundary_edge_count(),
            "the loops have all boundary edges"
        );
        assert_eq!(
            on_loops,
            self.boundary_vertex_count(),
            "a boundary vertex has two boundary edges"
        );
        assert_eq!(
            self.is_closed(),
            loops.is_empty(),
            "closed means without boundary"
        );
        for boundary in &loops {
            for (i, &v) in boundary.iter().enumerate() {
                let w = boundary[(i + 1) % boundary.len()];
                let e = self
                    .find_edge(v, w)
                    .expect("consecutive boundary vertices are joined");
                assert!(
                    self.is_boundary_edge(e) && self.edges[e.index()] == [v, w],
                    "{e} runs along the boundary"
                );
            }
        }
        assert_eq!(
            2 * self.edge_count(),
            3 * self.face_count() + self.boundary_edge_count(),
            "2E = 3F + B"
        );
        assert_eq!(
            self.interior_edge_count() + self.boundary_edge_count(),
            self.edge_count(),
            "edges add up"
        );
        // Components by merging, not by walking.
        let mut parent: Vec<usize> = (0..self.vertex_count()).collect();
        fn root(parent: &mut [usize], mut v: usize) -> usize {
            while parent[v] != v {
                parent[v] = parent[parent[v]];
                v = parent[v];
            }
            v
        }
        for &[a, b] in &self.edges {
            let (a, b) = (root(&mut parent, a.index()), root(&mut parent, b.index()));
            parent[a.max(b)] = a.min(b);
        }
        let mut roots = BTreeMap::new();
        for v in 0..self.vertex_count() {
            let next = roots.len();
            let label = *roots.entry(root(&mut parent, v)).or_insert(next);
            assert_eq!(
                self.vertex_component(VertexId::from_index(v)),
                label,
                "component of vertex {v}"
            );
        }
        assert_eq!(self.component_count(), roots.len(), "number of components");
        assert_eq!(
            self.components().iter().map(Vec::len).sum::<usize>(),
            self.vertex_count(),
            "components"
        );
    }
}
