//! Small balanced vertex separators of a graph.

use super::graph::{Graph, UNREACHED};

/// Where a separator puts a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SeparatorSide {
    /// One side.
    First,
    /// The other side, without a neighbour in the first.
    Second,
    /// Between them.
    Separator,
}

/// Share of the vertices that is given to either side beforehand. The rest, in the middle, is where the
/// separator may lie: more room gives shorter separators and less equal parts. For the isotropic square of
/// 16641 vertices the factorisation takes 7.7e8 operations with 0.4, 6.0e8 with 0.33 and 5.7e8 with 0.25, for
/// irregular meshes 2.7e8 with any of them; the time to find the order doubles from 0.4 to 0.25.
const GIVEN: f64 = 0.3;

/// A vertex separator of a connected graph: the smallest, in proportion to the parts, of four minimum cuts.
///
/// Each cut runs across one of the directions that four vertices far apart define: with the distances `d_a`
/// to `d_d` from them, vertices are sorted by `d_a - d_b`, `d_a + d_c - d_b - d_d` and so on, the first and
/// the last [`GIVEN`] are joined to a source and a sink, and a maximum flow with unit vertex capacities
/// between them finds the minimum vertex cut (Menger). `None` if a side would be empty.
pub(super) fn separate(graph: &Graph) -> Option<Vec<SeparatorSide>> {
    let [a, b, c, d] = landmarks(graph);
    let key = |plus: [&[u32]; 2], minus: [&[u32]; 2]| -> Vec<i64> {
        (0..graph.len())
            .map(|v| {
                let sum = |d: [&[u32]; 2]| i64::from(d[0][v]) + i64::from(d[1][v]);
                sum(plus) - sum(minus)
            })
            .collect()
    };
    let directions = [
        key([&a, &a], [&b, &b]),
        key([&a, &c], [&b, &d]),
        key([&a, &d], [&b, &c]),
        key([&a, &b], [&c, &d]),
    ];
    let mut best = None;
    let mut least = f64::INFINITY;
    for key in directions {
        let parts = MinimumCut::new(graph, &key).minimum();
        let count = |p| parts.iter().filter(|q| **q == p).count() as f64;
        let (first, second) = (count(SeparatorSide::First), count(SeparatorSide::Second));
        let cost = count(SeparatorSide::Separator) / (first * second);
        if first > 0.0 && second > 0.0 && cost < least {
            least = cost;
            best = Some(parts);
        }
    }
    best
}

/// Distances from four vertices that are far from each other.
fn landmarks(graph: &Graph) -> [Vec<u32>; 4] {
    // The first of several, so that the choice is unique.
    let farthest = |d: &[u32]| (0..d.len()).rev().max_by_key(|&v| d[v]).unwrap_or(0);
    let nearest_of = |lists: &[&Vec<u32>]| -> Vec<u32> {
        (0..graph.len())
            .map(|v| lists.iter().map(|d| d[v]).min().unwrap_or(UNREACHED))
            .collect()
    };
    let a = graph.distances(farthest(&graph.distances(0)));
    let b = graph.distances(farthest(&a));
    let c = graph.distances(farthest(&nearest_of(&[&a, &b])));
    let d = graph.distances(farthest(&nearest_of(&[&a, &b, &c])));
    [a, b, c, d]
}

/// Which vertices the flow comes from, goes to, and may pass.
#[derive(Clone, Copy, PartialEq, Eq)]
enum BandRole {
    Source,
    Band,
    Sink,
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// Maximum flow of unit vertex capacities from a source to a sink set, by Dinic's blocking flows.
///
/// Every vertex `v` of the band is a pair of nodes, `2 v` where flow enters and `2 v + 1` where it leaves.
struct MinimumCut<'a> {
    graph: &'a Graph,
    role: Vec<BandRole>,
    /// Whether a unit of flow passes the vertex.
    used: Vec<bool>,
    /// From where it comes; `NONE` is the source.
    previous: Vec<u32>,
    /// Breadth-first level of each node; `UNREACHED` also for a node that a blocking flow has done with.
    level: Vec<u32>,
    /// Next neighbour to try from each leaving node.
    tried: Vec<u32>,
    /// Vertices of the band beside the source.
    entries: Vec<u32>,
    beside_sink: Vec<bool>,
}

/// Whether flow enters its vertex at this node.
fn is_entering(node: u32) -> bool {
    node.is_multiple_of(2)
}

impl<'a> MinimumCut<'a> {
    fn new(graph: &'a Graph, key: &[i64]) -> Self {
        let n = graph.len();
        let mut sorted: Vec<u32> = (0..n as u32).collect();
        sorted.sort_unstable_by_key(|&v| (key[v as usize], v));
        let given = ((GIVEN * n as f64) as usize).clamp(1, n / 2);
        let mut role = vec![BandRole::Band; n];
        for &v in &sorted[n - given..] {
            role[v as usize] = BandRole::Sink;
        }
        let beside =
            |role: &[BandRole], v: u32, r| graph.of(v).iter().any(|&w| role[w as usize] == r);
        for &v in &sorted[..given] {
            // A vertex beside the sink has to be cut itself.
            if !beside(&role, v, BandRole::Sink) {
                role[v as usize] = BandRole::Source;
            }
        }
        let band = |v: &u32| role[*v as usize] == BandRole::Band;
        Self {
            entries: (0..n as u32)
                .filter(band)
                .filter(|&v| beside(&role, v, BandRole::Source))
                .collect(),
            beside_sink: (0..n as u32)
                .map(|v| band(&v) && beside(&role, v, BandRole::Sink))
                .collect(),
            graph,
            role,
            used: vec![false; n],
            previous: vec![NONE; n],
            level: vec![UNREACHED; 2 * n],
            tried: vec![0; n],
        }
    }

    /// The minimum cut nearest to the source.
    fn minimum(mut self) -> Vec<SeparatorSide> {
        while self.find_levels() {
            self.tried.fill(0);
            for k in 0..self.entries.len() {
                self.augment(self.entries[k]);
            }
        }
        // Levels are now what the source still reaches.
        (0..self.graph.len())
            .map(|v| {
                let reached = |node: usize| self.level[node] != UNREACHED;
                match self.role[v] {
                    BandRole::Source => SeparatorSide::First,
                    BandRole::Sink => SeparatorSide::Second,
                    BandRole::Band if reached(2 * v + 1) => SeparatorSide::First,
                    BandRole::Band if reached(2 * v) => SeparatorSide::Separator,
                    BandRole::Band => SeparatorSide::Second,
                }
            })
            .collect()
    }

    /// The node after an entering one: through the vertex or, where flow passes already, back along it.
    fn after_entering(&self, v: u32) -> Option<u32> {
        if !self.used[v as usize] {
            return Some(2 * v + 1);
        }
        let u = self.previous[v as usize];
        (u != NONE).then(|| 2 * u + 1)
    }

    /// Number of arcs from a leaving node: to the neighbours, and back through the vertex.
    fn arcs(&self, v: u32) -> u32 {
        self.graph.of(v).len() as u32 + 1
    }

    /// The node at the end of an arc from a leaving node, if the arc has capacity left.
    fn after_leaving(&self, v: u32, arc: u32) -> Option<u32> {
        match self.graph.of(v).get(arc as usize) {
            Some(&w) => (self.role[w as usize] == BandRole::Band).then_some(2 * w),
            // Flow through the vertex can be taken back.
            None => self.used[v as usize].then_some(2 * v),
        }
    }

    /// Breadth-first levels of the residual network; whether the sink was reached.
    fn find_levels(&mut self) -> bool {
        self.level.fill(UNREACHED);
        let mut queue: Vec<u32> = self.entries.iter().map(|v| 2 * v).collect();
        for &node in &queue {
            self.level[node as usize] = 0;
        }
        let mut sink = false;
        let mut head = 0;
        while head < queue.len() {
            let node = queue[head];
            head += 1;
            let v = node / 2;
            let next = self.level[node as usize] + 1;
            let mut reach = |level: &mut [u32], to: u32| {
                if level[to as usize] == UNREACHED {
                    level[to as usize] = next;
                    queue.push(to);
                }
            };
            if is_entering(node) {
                if let Some(to) = self.after_entering(v) {
                    reach(&mut self.level, to);
                }
                continue;
            }
            sink |= self.beside_sink[v as usize];
            for arc in 0..self.arcs(v) {
                if let Some(to) = self.after_leaving(v, arc) {
                    reach(&mut self.level, to);
                }
            }
        }
        sink
    }

    /// Depth-first search for one more unit of flow along increasing levels.
    fn augment(&mut self, entry: u32) {
        if self.level[2 * entry as usize] != 0 {
            return;
        }
        let mut path = vec![2 * entry];
        while let Some(&node) = path.last() {
            let v = node / 2;
            let next = self.level[node as usize] + 1;
            let step = if is_entering(node) {
                self.after_entering(v)
                    .filter(|to| self.level[*to as usize] == next)
            } else if self.beside_sink[v as usize] {
                self.push(&path);
                return;
            } else {
                let arc = (self.tried[v as usize]..self.arcs(v)).find(|&arc| {
                    self.after_leaving(v, arc)
                        .is_some_and(|to| self.level[to as usize] == next)
                });
                self.tried[v as usize] = arc.map_or(self.arcs(v), |a| a + 1);
                arc.and_then(|a| self.after_leaving(v, a))
            };
            match step {
                Some(to) => path.push(to),
                None => {
                    self.level[node as usize] = UNREACHED;
                    path.pop();
                }
            }
        }
    }

    /// Sends a unit of flow along a path of nodes, and closes them for this blocking flow.
    fn push(&mut self, path: &[u32]) {
        self.previous[path[0] as usize / 2] = NONE;
        for pair in path.windows(2) {
            let (from, to) = (pair[0] / 2, pair[1] / 2);
            match (is_entering(pair[0]), from == to) {
                (true, true) => self.used[from as usize] = true,
                (false, true) => self.used[from as usize] = false,
                (false, false) => self.previous[to as usize] = from,
                // Taken back: the vertex has another predecessor already.
                (true, false) => {}
            }
        }
        for &node in path {
            self.level[node as usize] = UNREACHED;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of `w x h` squares, each with one diagonal.
    fn grid(w: u32, h: u32) -> Graph {
        let at = |i, j| j * (w + 1) + i;
        let mut edges = Vec::new();
        for j in 0..=h {
            for i in 0..=w {
                if i < w {
                    edges.push((at(i + 1, j), at(i, j)));
                }
                if j < h {
                    edges.push((at(i, j + 1), at(i, j)));
                }
                if i < w && j < h {
                    edges.push((at(i + 1, j + 1), at(i, j)));
                }
            }
        }
        Graph::from_edges(((w + 1) * (h + 1)) as usize, &edges)
    }

    fn count(parts: &[SeparatorSide], p: SeparatorSide) -> usize {
        parts.iter().filter(|q| **q == p).count()
    }

    fn assert_separates(graph: &Graph, parts: &[SeparatorSide]) {
        for v in 0..graph.len() as u32 {
            for &w in graph.of(v) {
                let pair = (parts[v as usize], parts[w as usize]);
                assert_ne!(
                    pair,
                    (SeparatorSide::First, SeparatorSide::Second),
                    "{v} {w}"
                );
            }
        }
    }

    #[test]
    fn the_shortest_line_across_a_strip() {
        let graph = grid(60, 6);
        let parts = separate(&graph).expect("a strip can be separated");
        assert_separates(&graph, &parts);
        assert_eq!(count(&parts, SeparatorSide::Separator), 7);
        for side in [SeparatorSide::First, SeparatorSide::Second] {
            assert!(count(&parts, side) >= (GIVEN * graph.len() as f64) as usize);
        }
    }

    #[test]
    fn the_narrow_neck_of_two_rooms() {
        // Two rooms of 10 x 10 joined by a corridor of one vertex.
        let room = grid(9, 9);
        let mut edges = Vec::new();
        for shift in [0, 100] {
            for v in 0..100u32 {
                edges.extend(
                    room.of(v)
                        .iter()
                        .filter(|&&w| w < v)
                        .map(|&w| (v + shift, w + shift)),
                );
            }
        }
        edges.extend([(200, 55), (200, 155), (200, 56)]);
        let graph = Graph::from_edges(201, &edges);
        let parts = separate(&graph).expect("rooms can be separated");
        assert_separates(&graph, &parts);
        assert_eq!(count(&parts, SeparatorSide::Separator), 1);
    }

    #[test]
    fn a_cut_is_as_large_as_the_flow() {
        // Against brute force: the smallest vertex set whose removal parts source and sink, in small random
        // graphs.
        use rand::{RngExt, SeedableRng};
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for _ in 0..200 {
            let n = 12u32;
            let mut edges = Vec::new();
            for v in 0..n {
                for w in 0..v {
                    if rng.random_range(0..4) == 0 {
                        edges.push((v, w));
                    }
                }
            }
            let graph = Graph::from_edges(n as usize, &edges);
            let key: Vec<i64> = (0..i64::from(n)).collect();
            let cut = MinimumCut::new(&graph, &key);
            let role = cut.role.clone();
            let parts = cut.minimum();
            assert_separates(&graph, &parts);
            let band: Vec<usize> = (0..n as usize)
                .filter(|&v| role[v] == BandRole::Band)
                .collect();
            let separates = |set: u32| {
                let removed = |v: usize| {
                    band.iter()
                        .position(|&b| b == v)
                        .is_some_and(|k| set >> k & 1 == 1)
                };
                let mut seen: Vec<bool> = role.iter().map(|r| *r == BandRole::Source).collect();
                let mut stack: Vec<usize> = (0..n as usize).filter(|&v| seen[v]).collect();
                while let Some(v) = stack.pop() {
                    if role[v] == BandRole::Sink {
                        return false;
                    }
                    for &w in graph.of(v as u32) {
                        if !seen[w as usize] && !removed(w as usize) {
                            seen[w as usize] = true;
                            stack.push(w as usize);
                        }
                    }
                }
                true
            };
            let smallest = (0..1u32 << band.len())
                .filter(|&set| separates(set))
                .map(u32::count_ones)
                .min();
            assert_eq!(
                smallest,
                Some(count(&parts, SeparatorSide::Separator) as u32)
            );
        }
    }
}
