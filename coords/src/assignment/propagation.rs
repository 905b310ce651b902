//! The front, the marks and the choice of rules.

use super::options::{AssignmentOptions, Degenerate};
use super::rules::{Assignment, Closure, Placing, Rule};
use crate::placement::{COLLINEAR, collinearity};
use crate::vec3::{Vec3, at, cross, dot, norm, scale, sub};
use isosheet_mesh::{EdgeId, Sheet, Topology, VertexId};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The propagation: marks, counts of known neighbours, and what has been assigned.
pub(super) struct Propagation<'a> {
    topology: &'a Topology,
    rest: &'a [f64],
    state: &'a [f64],
    degenerate: Degenerate,
    volume: f64,
    pub(super) known: Vec<bool>,
    known_neighbours: Vec<u32>,
    /// Front in which a vertex was found; `u32::MAX` before that.
    front_of: Vec<u32>,
    pub(super) done: Assignment,
}

impl<'a> Propagation<'a> {
    pub(super) fn new(sheet: &'a Sheet, state: &'a [f64], options: &AssignmentOptions) -> Self {
        let count = sheet.topology().vertex_count();
        Self {
            topology: sheet.topology(),
            rest: sheet.positions(),
            state,
            degenerate: options.degenerate,
            volume: options.volume,
            known: vec![false; count],
            known_neighbours: vec![0; count],
            front_of: vec![u32::MAX; count],
            done: Assignment {
                order: Vec::with_capacity(count),
                position: vec![u32::MAX; count],
                closures: Vec::new(),
                coordinates: 0,
                fronts: 0,
            },
        }
    }

    pub(super) fn start(&mut self, v: VertexId) {
        let q = self.done.coordinates;
        self.mark(v, 0, Rule::Start { q });
        self.run(&[v]);
    }

    pub(super) fn mark(&mut self, vertex: VertexId, front: u32, rule: Rule) {
        self.known[vertex.index()] = true;
        self.front_of[vertex.index()] = front;
        self.done.position[vertex.index()] = self.done.order.len() as u32;
        self.done.coordinates += rule.coordinates();
        self.done.fronts = self.done.fronts.max(front);
        self.done.order.push(Placing {
            vertex,
            front,
            rule,
        });
        let topology = self.topology;
        for w in topology.neighbours(vertex) {
            self.known_neighbours[w.index()] += 1;
        }
    }

    /// Steps 3 to 3.3 of the published algorithm. The inner search for `max_cstr` is a heap of
    /// (known neighbours, place in the front); an entry is stale when the count has grown since.
    pub(super) fn run(&mut self, seeds: &[VertexId]) {
        let topology = self.topology;
        let mut number = 0;
        let mut layer: Vec<VertexId> = seeds.to_vec();
        let mut heap: BinaryHeap<(u32, Reverse<u32>)> = BinaryHeap::new();
        let mut place_in_front = vec![0u32; self.known.len()];
        loop {
            number += 1;
            let mut front = Vec::new();
            for &v in &layer {
                for w in topology.neighbours(v) {
                    if self.front_of[w.index()] == u32::MAX {
                        self.front_of[w.index()] = number;
                        place_in_front[w.index()] = front.len() as u32;
                        front.push(w);
                    }
                }
            }
            if front.is_empty() {
                return;
            }
            for (i, v) in front.iter().enumerate() {
                heap.push((self.known_neighbours[v.index()], Reverse(i as u32)));
            }
            while let Some((constraints, Reverse(i))) = heap.pop() {
                let v = front[i as usize];
                if self.known[v.index()] || constraints < self.known_neighbours[v.index()] {
                    continue;
                }
                let rule = self.rule_for(v);
                self.mark(v, number, rule);
                for w in topology.neighbours(v) {
                    if !self.known[w.index()] && self.front_of[w.index()] == number {
                        let place = place_in_front[w.index()];
                        heap.push((self.known_neighbours[w.index()], Reverse(place)));
                    }
                }
            }
            layer = front;
        }
    }

    fn rule_for(&mut self, v: VertexId) -> Rule {
        let topology = self.topology;
        // Known neighbours with their edges in ring order, which is the order of `vertex_edges`.
        let mut known: Vec<(usize, VertexId, EdgeId)> = topology
            .vertex_edges(v)
            .iter()
            .enumerate()
            .map(|(i, &e)| (i, topology.other_end(e, v), e))
            .filter(|(_, w, _)| self.known[w.index()])
            .collect();
        let q = self.done.coordinates;
        match known.as_slice() {
            [] => unreachable!("a vertex enters the front through a known neighbour"),
            [(_, w, e)] => Rule::H {
                known: *w,
                edge: *e,
                q,
            },
            [_, _] => {
                known.sort_by_key(|(_, w, _)| self.done.position[w.index()]);
                Rule::G {
                    known: [known[0].1, known[1].1],
                    edges: [known[0].2, known[1].2],
                    q,
                }
            }
            _ => {
                let ring = topology.vertex_edges(v).len();
                let closed = !topology.is_boundary_vertex(v);
                let (triple, hub) = self.best_triple(v, &known, ring, closed);
                for (i, (_, _, e)) in known.iter().enumerate() {
                    if !triple.contains(&i) {
                        self.done.closures.push(Closure {
                            vertex: v,
                            edge: *e,
                        });
                    }
                }
                let chosen = triple.map(|i| known[i].1);
                let edges = triple.map(|i| known[i].2);
                if self.degenerate == Degenerate::Assign {
                    let d = self.directions(v, &chosen);
                    if volume(&d) <= self.volume {
                        let [a, b, c] = widest_first(&d);
                        self.done.closures.push(Closure {
                            vertex: v,
                            edge: edges[c],
                        });
                        return Rule::Turn {
                            known: [chosen[a], chosen[b], chosen[c]],
                            edges: [edges[a], edges[b], edges[c]],
                            q,
                        };
                    }
                }
                Rule::F {
                    known: chosen,
                    edges,
                    hub: hub.then_some(edges[1]),
                }
            }
        }
    }

    /// Unit vectors from known vertices to `v`.
    fn directions(&self, v: VertexId, known: &[VertexId; 3]) -> [Vec3<f64>; 3] {
        known.map(|w| {
            let d = sub(&at(self.state, v), &at(self.state, w));
            scale(&d, 1.0 / norm(&d))
        })
    }

    /// Which three of the known neighbours to use: consecutive ones around the vertex (Fig. 6c) if
    /// they are not on a line, and among the candidates the triple with the largest angles.
    fn best_triple(
        &self,
        vertex: VertexId,
        known: &[(usize, VertexId, EdgeId)],
        ring: usize,
        closed: bool,
    ) -> ([usize; 3], bool) {
        let k = known.len();
        let follows = |a: usize, b: usize| {
            let (i, j) = (known[a].0, known[b].0);
            j == i + 1 || (closed && i + 1 == ring && j == 0)
        };
        let mut best = ([0, 1, 2], false);
        let mut best_score = (false, -1.0);
        let mut consider = |triple: [usize; 3], hub: bool| {
            let chosen = triple.map(|i| known[i].1);
            let sine = |x: &[f64]| {
                let p = chosen.map(|w| at(x, w));
                collinearity([&p[0], &p[1], &p[2]])
            };
            // A consecutive triple wins unless it is degenerate.
            let (quality, limit) = match self.degenerate {
                Degenerate::Carry => (sine(self.rest).min(sine(self.state)), COLLINEAR),
                Degenerate::Assign => (volume(&self.directions(vertex, &chosen)), self.volume),
            };
            let score = (hub && quality > limit, quality);
            if score.0 && !best_score.0 || (score.0 == best_score.0 && score.1 > best_score.1) {
                best_score = score;
                best = (triple, hub);
            }
        };
        for b in 0..k {
            let (a, c) = ((b + k - 1) % k, (b + 1) % k);
            if follows(a, b) && follows(b, c) {
                consider([a, b, c], true);
            }
        }
        if k <= 8 {
            for a in 0..k {
                for b in a + 1..k {
                    for c in b + 1..k {
                        consider([a, b, c], false);
                    }
                }
            }
        } else {
            // Spread triples are enough for the rare vertex with nine or more known neighbours.
            for a in 0..k {
                consider([a, (a + k / 3) % k, (a + 2 * k / 3) % k], false);
            }
        }
        best
    }
}

/// Volume spanned by three vectors.
fn volume(d: &[Vec3<f64>; 3]) -> f64 {
    dot(&d[0], &cross(&d[1], &d[2])).abs()
}

/// Indices of three unit vectors, the two with the largest cross product first.
fn widest_first(d: &[Vec3<f64>; 3]) -> [usize; 3] {
    let pairs = [[0, 1, 2], [0, 2, 1], [1, 2, 0]];
    let width = |o: &[usize; 3]| norm(&cross(&d[o[0]], &d[o[1]]));
    let mut best = pairs[0];
    for o in &pairs[1..] {
        // A later pair has to be better by more than rounding: the choice is reproducible.
        if width(o) > width(&best) + 1e-9 {
            best = *o;
        }
    }
    best
}
