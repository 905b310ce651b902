//! Curves that meet in nodes alone.

use super::chords::{Chord, near_pairs};
use super::curve::PlaneCurve;
use super::error::PlaneError;
use super::vec2::{Point, cross, distance, sub};
use std::collections::{HashMap, HashSet};

/// A part of a curve between two nodes, where it meets others or ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The nodes at its ends; one and the same of a closed curve.
    pub nodes: [usize; 2],
    /// The curve that it is a part of.
    pub curve: PlaneCurve,
    /// The parameters of the curve at both ends.
    pub range: [f64; 2],
    /// The numbers of the curves that run here: several where lines were drawn twice.
    pub sources: Vec<usize>,
}

impl Piece {
    /// Its length, metres.
    pub fn length(&self) -> f64 {
        let t = self.curve.subdivide(self.range, f64::INFINITY, 0.02);
        let chord = |t: &[f64]| distance(self.curve.point(t[0]), self.curve.point(t[1]));
        t.windows(2).map(chord).sum()
    }

    /// The point in its middle, by the parameter.
    pub fn middle(&self) -> [f64; 2] {
        self.curve.point(0.5 * (self.range[0] + self.range[1]))
    }
}

/// An end of a curve that was moved to a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Join {
    /// The node, metres.
    pub at: [f64; 2],
    /// By how much the end was moved, metres.
    pub gap: f64,
}

/// Curves cut where they meet.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneGraph {
    /// The nodes, metres.
    pub nodes: Vec<[f64; 2]>,
    /// The parts of the curves.
    pub pieces: Vec<Piece>,
    /// The ends that were moved, by more than a thousandth of the tolerance.
    pub joins: Vec<Join>,
    /// Where two curves cross, or one crosses itself: their numbers and the place.
    pub crossings: Vec<([usize; 2], [f64; 2])>,
    /// Curves that are shorter than the tolerance, and were left out.
    pub dropped: Vec<usize>,
    pub(super) snap: f64,
}

/// A point of a curve where it is cut.
#[derive(Clone, Copy, Debug)]
struct Cut {
    curve: usize,
    t: f64,
    at: Point,
}

impl PlaneGraph {
    /// Cuts curves where they cross, touch, or end at each other. Ends that are at most `snap` (metres) apart
    /// become one node, and ends that are as near to another curve are moved onto it. Curves that run along
    /// each other as near as this become one.
    ///
    /// # Errors
    /// [`PlaneError::Size`] for a tolerance that is not positive, [`PlaneError::NotFinite`], and
    /// [`PlaneError::TooManyMeetings`].
    pub fn new(curves: &[PlaneCurve], snap: f64) -> Result<Self, PlaneError> {
        if !(snap > 0.0 && snap.is_finite()) {
            let name = "the tolerance for snapping";
            return Err(PlaneError::Size { name, value: snap });
        }
        if let Some(curve) = curves.iter().position(|c| !c.is_finite()) {
            return Err(PlaneError::NotFinite { curve });
        }
        let mut graph = Self {
            nodes: Vec::new(),
            pieces: Vec::new(),
            joins: Vec::new(),
            crossings: Vec::new(),
            dropped: Vec::new(),
            snap,
        };
        let chords = graph.chords(curves);
        let mut cuts = graph.cuts(curves, &chords)?;
        // Nodes lie on the curves that run on there, so that these keep their form.
        let inner = cuts.len();
        let dropped: HashSet<usize> = graph.dropped.iter().copied().collect();
        for (curve, c) in curves.iter().enumerate() {
            if !dropped.contains(&curve) {
                cuts.extend([0.0, 1.0].map(|t| Cut {
                    curve,
                    t,
                    at: c.point(t),
                }));
            }
        }
        let at: Vec<usize> = graph.place(&cuts);
        for (cut, node) in cuts.iter().zip(&at).skip(inner) {
            let at = graph.nodes[*node];
            let gap = distance(cut.at, at);
            if gap > 1e-3 * snap {
                graph.joins.push(Join { at, gap });
            }
        }
        graph.divide(curves, &cuts, &at);
        graph.unite();
        Ok(graph)
    }

    /// Chords that are nearer to the curves than a quarter of the tolerance.
    fn chords(&mut self, curves: &[PlaneCurve]) -> Vec<Chord> {
        let mut chords = Vec::new();
        for (number, curve) in curves.iter().enumerate() {
            let rough = curve.subdivide([0.0, 1.0], f64::INFINITY, 0.1);
            let part = |t: &[f64]| distance(curve.point(t[0]), curve.point(t[1]));
            let length: f64 = rough.windows(2).map(part).sum();
            if length <= self.snap {
                self.dropped.push(number);
                continue;
            }
            // An arc that turns by a over the length l is l a / 8 high.
            let bend = 0.1 * (rough.len() - 1) as f64;
            let turn = (2.0 * self.snap * bend / length).sqrt().clamp(1e-3, 0.1);
            let parameters = curve.subdivide([0.0, 1.0], f64::INFINITY, turn);
            let parts = parameters.windows(2);
            chords.extend(parts.map(|t| Chord::of(curve, number, [t[0], t[1]])));
        }
        chords
    }

    /// Where curves meet others between their ends.
    fn cuts(&mut self, curves: &[PlaneCurve], chords: &[Chord]) -> Result<Vec<Cut>, PlaneError> {
        let snap = self.snap;
        let mut cuts = Vec::new();
        let mut crossings: Vec<([usize; 2], Point)> = Vec::new();
        near_pairs(chords, snap, |i, j| {
            let (a, b) = (&chords[i], &chords[j]);
            if a.curve == b.curve {
                let is_cubic = matches!(curves[a.curve], PlaneCurve::Cubic(_));
                if !is_cubic || i.abs_diff(j) < 2 {
                    return;
                }
            } else {
                let is_line = |c: &Chord| matches!(curves[c.curve], PlaneCurve::Line(_));
                let [from, to] = b.ends;
                if [[from, to], [to, from]].contains(&a.ends) && is_line(a) && is_line(b) {
                    // A line that is drawn twice is cut at its ends alone.
                    return;
                }
                for (c, d) in [(a, b), (b, a)] {
                    let ends = [0, 1].into_iter().filter(|&k| c.range[k] == [0.0, 1.0][k]);
                    for end in ends.map(|k| c.ends[k]) {
                        if d.distance(end) <= snap + d.height() {
                            let curve = &curves[d.curve];
                            let t = curve.nearest(end);
                            let at = curve.point(t);
                            if distance(at, end) <= snap {
                                cuts.push(Cut {
                                    curve: d.curve,
                                    t,
                                    at,
                                });
                            }
                        }
                    }
                }
                if run_together(a, b, snap) {
                    return;
                }
            }
            let Some([t, u]) = crossing(a, b, curves, snap) else {
                return;
            };
            if a.curve == b.curve && (t - u).abs() < 1e-3 {
                return;
            }
            let at = curves[a.curve].point(t);
            cuts.push(Cut {
                curve: a.curve,
                t,
                at,
            });
            cuts.push(Cut {
                curve: b.curve,
                t: u,
                at,
            });
            let ends = [a, b].map(|c| curves[c.curve].ends());
            let is_at_end = ends
                .iter()
                .flatten()
                .any(|e| distance(*e, at) <= 2.0 * snap);
            if !is_at_end {
                crossings.push(([a.curve, b.curve], at));
            }
        })?;
        self.crossings = crossings;
        Ok(cuts)
    }

    /// The node of each cut; points that are as near as the tolerance have the same.
    fn place(&mut self, cuts: &[Cut]) -> Vec<usize> {
        let snap = self.snap;
        let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
        let mut at = Vec::with_capacity(cuts.len());
        for cut in cuts {
            let cell = cut.at.map(|c| (c / snap).floor() as i64);
            let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [i, j]));
            let known = around
                .filter_map(|[i, j]| {
                    cells.get(&[cell[0].saturating_add(i), cell[1].saturating_add(j)])
                })
                .flatten()
                .copied()
                .find(|node| distance(self.nodes[*node], cut.at) <= snap);
            at.push(known.unwrap_or_else(|| {
                self.nodes.push(cut.at);
                cells.entry(cell).or_default().push(self.nodes.len() - 1);
                self.nodes.len() - 1
            }));
        }
        at
    }

    /// Makes pieces of the curves between their cuts.
    fn divide(&mut self, curves: &[PlaneCurve], cuts: &[Cut], at: &[usize]) {
        let mut of_curve: Vec<Vec<(f64, usize)>> = vec![Vec::new(); curves.len()];
        for (cut, node) in cuts.iter().zip(at) {
            of_curve[cut.curve].push((cut.t, *node));
        }
        for (number, (mut cuts, curve)) in of_curve.into_iter().zip(curves).enumerate() {
            cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
            let Some(mut last) = cuts.first().copied() else {
                continue;
            };
            for &(t, node) in &cuts[1..] {
                let middle = curve.point(0.5 * (last.0 + t));
                let is_loop = distance(middle, self.nodes[node]) > 2.0 * self.snap;
                if node == last.1 && (matches!(curve, PlaneCurve::Line(_)) || !is_loop) {
                    continue;
                }
                let nodes = [last.1, node];
                let (curve, range) = match curve {
                    PlaneCurve::Line(_) => {
                        let line = PlaneCurve::Line(nodes.map(|n| self.nodes[n]));
                        (line, [0.0, 1.0])
                    }
                    curve => (*curve, [last.0, t]),
                };
                self.pieces.push(Piece {
                    nodes,
                    curve,
                    range,
                    sources: vec![number],
                });
                last = (t, node);
            }
        }
    }

    /// Makes one of pieces that run along each other.
    fn unite(&mut self) {
        let snap = self.snap;
        let mut between: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
        let mut united: Vec<Piece> = Vec::new();
        for piece in std::mem::take(&mut self.pieces) {
            let [a, b] = piece.nodes;
            let others = between.entry([a.min(b), a.max(b)]).or_default();
            let runs_along = |other: &Piece| {
                [0.25, 0.5, 0.75].iter().all(|w| {
                    let t = (1.0 - w) * piece.range[0] + w * piece.range[1];
                    let p = piece.curve.point(t);
                    distance(p, other.curve.point(other.curve.nearest(p))) <= 2.0 * snap
                })
            };
            match others.iter().copied().find(|&k| runs_along(&united[k])) {
                Some(other) => united[other].sources.extend(piece.sources),
                None => {
                    others.push(united.len());
                    united.push(piece);
                }
            }
        }
        self.pieces = united;
    }
}

/// Whether two chords are nowhere further apart than the tolerance, where both of them are: lines that were
/// drawn twice.
fn run_together(a: &Chord, b: &Chord, snap: f64) -> bool {
    let [u, v] = [a, b].map(|c| sub(c.ends[1], c.ends[0]));
    let lengths = [u, v].map(|w| w[0].hypot(w[1]));
    let off = |p: Point, c: &Chord, d: Point, length: f64| {
        cross(d, sub(p, c.ends[0])).abs() <= snap * length
    };
    cross(u, v).abs() <= 0.1 * lengths[0] * lengths[1]
        && b.ends.iter().all(|p| off(*p, a, u, lengths[0]))
        && a.ends.iter().all(|p| off(*p, b, v, lengths[1]))
}

/// The parameters of two curves where their chords cross, found by Newton's method.
fn crossing(a: &Chord, b: &Chord, curves: &[PlaneCurve], snap: f64) -> Option<[f64; 2]> {
    let parts = a.crossing(b)?;
    let on = |c: &Chord, w: f64| (1.0 - w) * c.range[0] + w * c.range[1];
    let (f, g) = (&curves[a.curve], &curves[b.curve]);
    let first = [on(a, parts[0]), on(b, parts[1])].map(|t| t.clamp(0.0, 1.0));
    let apart = |[t, u]: [f64; 2]| distance(f.point(t), g.point(u));
    let mut best = first;
    for _ in 0..8 {
        let [t, u] = best;
        let (d, e, w) = (
            f.derivative(t),
            g.derivative(u),
            sub(g.point(u), f.point(t)),
        );
        let turn = cross(d, e);
        let next = [t + cross(w, e) / turn, u + cross(w, d) / turn].map(|t| t.clamp(0.0, 1.0));
        let is_nearer = apart(next) < apart(best);
        if !is_nearer {
            break;
        }
        best = next;
    }
    (apart(best) <= snap).then_some(best)
}
