//! Shortest paths along the edges of a mesh, by Dijkstra's algorithm.

use isosheet_mesh::{EdgeId, Topology, VertexId};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// A distance that has an order.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Distance(f64);

impl Eq for Distance {}

impl PartialOrd for Distance {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Distance {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Shortest paths from a growing set of vertices.
pub(super) struct Paths<'a> {
    topology: &'a Topology,
    /// The cost of each edge.
    costs: &'a [f64],
    /// The distance of each vertex from the set, as far as it is known.
    pub(super) distances: Vec<f64>,
    /// The last edge on the way to each vertex.
    pub(super) last: Vec<Option<EdgeId>>,
    open: BinaryHeap<Reverse<(Distance, VertexId)>>,
}

impl<'a> Paths<'a> {
    /// Paths from no vertex yet.
    pub(super) fn new(topology: &'a Topology, costs: &'a [f64]) -> Self {
        let count = topology.vertex_count();
        Self {
            topology,
            costs,
            distances: vec![f64::INFINITY; count],
            last: vec![None; count],
            open: BinaryHeap::new(),
        }
    }

    /// Adds a vertex to the set.
    pub(super) fn start(&mut self, v: VertexId) {
        self.distances[v.index()] = 0.0;
        self.last[v.index()] = None;
        self.open.push(Reverse((Distance(0.0), v)));
    }

    /// The next vertex by distance; `None` where all are reached.
    pub(super) fn next(&mut self) -> Option<VertexId> {
        while let Some(Reverse((Distance(d), v))) = self.open.pop() {
            if d > self.distances[v.index()] {
                continue;
            }
            for &e in self.topology.vertex_edges(v) {
                let w = self.topology.other_end(e, v);
                let further = d + self.costs[e.index()];
                if further < self.distances[w.index()] {
                    self.distances[w.index()] = further;
                    self.last[w.index()] = Some(e);
                    self.open.push(Reverse((Distance(further), w)));
                }
            }
            return Some(v);
        }
        None
    }

    /// Reaches all vertices, and says which was the last.
    pub(super) fn reach_all(&mut self) -> Option<VertexId> {
        let mut furthest = None;
        while let Some(v) = self.next() {
            furthest = Some(v);
        }
        furthest
    }

    /// The edges from a vertex back to the set, with the vertices at which they end.
    pub(super) fn back(&self, mut v: VertexId) -> Vec<(EdgeId, VertexId)> {
        let mut way = Vec::new();
        while let Some(e) = self.last[v.index()] {
            v = self.topology.other_end(e, v);
            way.push((e, v));
        }
        way
    }
}
