//! Where a surface is cut so that it is a disk without corners inside.

use super::paths::Paths;
use isosheet_mesh::{EdgeId, Topology, VertexId};

/// What a connected surface is cut by.
pub(super) struct CutGraph<'a> {
    pub(super) topology: &'a Topology,
    /// What a cut along each edge costs.
    pub(super) costs: &'a [f64],
    /// The vertices that cuts have to reach.
    pub(super) corners: &'a [bool],
    /// Edges inside that are cut in any case.
    pub(super) given: &'a [bool],
    /// The vertex where a sphere without corners is cut.
    pub(super) last_resort: VertexId,
}

impl CutGraph<'_> {
    /// The edges inside along which the surface is cut; none of a disk without corners inside.
    ///
    /// Handles are cut along the shortest loops through one vertex (tree and cotree: Erickson and Whittlesey,
    /// *Greedy optimal homotopy and homology generators*, SODA 2005). Then boundaries, loops, given edges and
    /// corners are joined by shortest paths. The nearest one comes next each time: the tree is at most twice
    /// as long as the shortest one (Takahashi and Matsuyama 1980).
    pub(super) fn cuts(&self) -> Vec<bool> {
        let t = self.topology;
        let mut cuts = self.given.to_vec();
        let loops = t.boundary_loops();
        let handles = 2 - t.euler_characteristic() - loops.len() as i64;
        if handles > 0 {
            self.cut_handles(&loops, &mut cuts);
        }
        let mut groups = Groups::new(t, &cuts);
        let corners = t.vertex_ids().filter(|v| self.corners[v.index()]);
        corners.for_each(|v| groups.add(v));
        if t.is_closed() && handles == 0 && groups.count() < 2 {
            // A surface that closes and has nothing to join is cut open at the vertex that needs it most.
            let mut paths = Paths::new(t, self.costs);
            paths.start(self.last_resort);
            groups.add(self.last_resort);
            if let Some(v) = paths.reach_all() {
                groups.add(v);
            }
        }
        self.join(&groups, &mut cuts);
        cuts
    }

    /// Marks the loops along which the surface has no handles any more.
    fn cut_handles(&self, loops: &[Vec<VertexId>], cuts: &mut [bool]) {
        let t = self.topology;
        // Along a boundary it is cut already.
        let free = |e: EdgeId| t.is_boundary_edge(e) || self.given[e.index()];
        let costs = t
            .edge_ids()
            .map(|e| if free(e) { 0.0 } else { self.costs[e.index()] });
        let costs: Vec<f64> = costs.collect();
        let corner = t.vertex_ids().find(|v| self.corners[v.index()]);
        let root = loops.first().and_then(|l| l.first().copied()).or(corner);
        let mut paths = Paths::new(t, &costs);
        paths.start(root.unwrap_or(self.last_resort));
        paths.reach_all();
        let mut is_tree = vec![false; t.edge_count()];
        paths
            .last
            .iter()
            .flatten()
            .for_each(|e| is_tree[e.index()] = true);
        // What the boundary loops bound counts as a face each.
        let mut hole = vec![0; t.vertex_count()];
        for (k, own) in loops.iter().enumerate() {
            own.iter()
                .for_each(|v| hole[v.index()] = t.face_count() + k);
        }
        let loop_cost = |e: EdgeId| {
            let [a, b] = t.edges()[e.index()].map(|v| paths.distances[v.index()]);
            a + b + costs[e.index()]
        };
        let mut order: Vec<EdgeId> = t.edge_ids().filter(|e| !is_tree[e.index()]).collect();
        order.sort_by(|a, b| loop_cost(*b).total_cmp(&loop_cost(*a)));
        let mut faces: Vec<usize> = (0..t.face_count() + loops.len()).collect();
        for e in order {
            let [left, right] = t.edge_faces(e);
            let beyond = right.map_or_else(|| hole[t.edges()[e.index()][0].index()], |f| f.index());
            let [a, b] =
                [left.map_or(beyond, |f| f.index()), beyond].map(|f| root_of(&mut faces, f));
            if a != b {
                faces[a] = b;
                continue;
            }
            let ends = t.edges()[e.index()];
            let ways = ends.into_iter().flat_map(|v| paths.back(v)).map(|(e, _)| e);
            for e in ways.chain([e]).filter(|e| !t.is_boundary_edge(*e)) {
                cuts[e.index()] = true;
            }
        }
        self.prune(cuts);
    }

    /// Takes back cuts that end inside of the surface at no corner.
    fn prune(&self, cuts: &mut [bool]) {
        let t = self.topology;
        let is_cut = |cuts: &[bool], v: VertexId| -> Vec<EdgeId> {
            let edges = t.vertex_edges(v).iter().copied();
            edges.filter(|e| cuts[e.index()]).collect()
        };
        let mut open: Vec<VertexId> = t.vertex_ids().collect();
        while let Some(v) = open.pop() {
            if t.is_boundary_vertex(v) || self.corners[v.index()] {
                continue;
            }
            if let [e] = is_cut(cuts, v)[..]
                && !self.given[e.index()]
            {
                cuts[e.index()] = false;
                open.push(t.other_end(e, v));
            }
        }
    }

    /// Joins what is to be joined by shortest paths.
    fn join(&self, groups: &Groups, cuts: &mut [bool]) {
        let mut paths = Paths::new(self.topology, self.costs);
        let Some(first) = groups.members.first() else {
            return;
        };
        let mut is_joined = vec![false; groups.members.len()];
        is_joined[0] = true;
        first.iter().for_each(|v| paths.start(*v));
        while let Some(v) = paths.next() {
            let Some(group) = groups.of_vertex[v.index()].filter(|g| !is_joined[*g]) else {
                continue;
            };
            is_joined[group] = true;
            let way = paths.back(v);
            for (e, w) in way {
                cuts[e.index()] = true;
                paths.start(w);
            }
            groups.members[group].iter().for_each(|w| paths.start(*w));
        }
    }
}

/// What cuts have to join: each group hangs together already.
struct Groups {
    of_vertex: Vec<Option<usize>>,
    members: Vec<Vec<VertexId>>,
}

impl Groups {
    /// The boundaries and the edges that are cut.
    fn new(t: &Topology, cuts: &[bool]) -> Self {
        let mut roots: Vec<usize> = (0..t.vertex_count()).collect();
        let mut is_met = vec![false; t.vertex_count()];
        for e in t
            .edge_ids()
            .filter(|e| t.is_boundary_edge(*e) || cuts[e.index()])
        {
            let [a, b] = t.edges()[e.index()].map(|v| v.index());
            (is_met[a], is_met[b]) = (true, true);
            let [a, b] = [a, b].map(|v| root_of(&mut roots, v));
            roots[a.max(b)] = a.min(b);
        }
        let mut groups = Self {
            of_vertex: vec![None; t.vertex_count()],
            members: Vec::new(),
        };
        for v in t.vertex_ids().filter(|v| is_met[v.index()]) {
            match groups.of_vertex[root_of(&mut roots, v.index())] {
                Some(group) => {
                    groups.of_vertex[v.index()] = Some(group);
                    groups.members[group].push(v);
                }
                None => groups.add(v),
            }
        }
        groups
    }

    /// A vertex of its own, if it is in no group.
    fn add(&mut self, v: VertexId) {
        if self.of_vertex[v.index()].is_none() {
            self.of_vertex[v.index()] = Some(self.members.len());
            self.members.push(vec![v]);
        }
    }

    fn count(&self) -> usize {
        self.members.len()
    }
}

/// The element that stands for a set.
fn root_of(sets: &mut [usize], mut k: usize) -> usize {
    while sets[k] != k {
        sets[k] = sets[sets[k]];
        k = sets[k];
    }
    k
}
