//! A constrained Delaunay triangulation whose constraints are parts of curves.

use super::chords::{Chord, near_pairs};
use super::error::PlaneError;
use super::graph::PlaneGraph;
use super::vec2::{Point, distance};
use spade::handles::{DirectedEdgeHandle, FixedVertexHandle, VertexHandle};
use spade::{CdtEdge, ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::PI;

pub(super) type Triangles = ConstrainedDelaunayTriangulation<Point2<f64>>;
pub(super) type Edge<'a> = DirectedEdgeHandle<'a, Point2<f64>, (), CdtEdge<()>, ()>;

/// No chord turns by more than this, so that the angle between two chords of a curve is 150 degrees or more,
/// and no chord is further from its curve than a fifteenth of its length.
const TURN: f64 = PI / 6.0;

/// Chords that cross although their curves do not are halved at most so often.
const HALVINGS: usize = 12;

/// What a vertex lies on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// A node of the graph.
    Node(usize),
    /// A piece, between its ends.
    Piece(usize),
    /// No line.
    Free,
}

/// An edge that is a part of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// The number of the piece.
    pub(super) piece: usize,
    /// Its vertices, in the direction of the piece.
    pub(super) ends: [u32; 2],
    /// The parameters of the curve there.
    pub(super) range: [f64; 2],
    /// Whether there is sheet on its left and on its right.
    pub(super) inside: [bool; 2],
}

pub(super) type Key = [u32; 2];

pub(super) fn key([a, b]: [u32; 2]) -> Key {
    [a.min(b), a.max(b)]
}

/// The triangulation with its segments.
pub(super) struct Net {
    pub(super) triangles: Triangles,
    pub(super) places: Vec<Place>,
    pub(super) segments: BTreeMap<Key, Segment>,
}

impl Net {
    /// The triangulation of the pieces of a graph that `keep` names, in chords of at most a length.
    pub(super) fn new(graph: &PlaneGraph, keep: &[bool], longest: f64) -> Result<Self, PlaneError> {
        let mut net = Self {
            triangles: Triangles::new(),
            places: Vec::new(),
            segments: BTreeMap::new(),
        };
        let mut of_node = vec![None; graph.nodes.len()];
        for chord in chords(graph, keep, longest)? {
            let piece = &graph.pieces[chord.curve];
            let mut ends = [0; 2];
            for k in 0..2 {
                let node = (chord.range[k] == piece.range[k]).then_some(piece.nodes[k]);
                let known = match node {
                    Some(node) => of_node[node],
                    // The end of a chord is the beginning of the next.
                    None => (k == 0).then(|| net.places.len() as u32 - 1),
                };
                ends[k] = match known {
                    Some(vertex) => vertex,
                    None => {
                        let place = node.map_or(Place::Piece(chord.curve), Place::Node);
                        net.add(chord.ends[k], place)?
                    }
                };
                if let Some(node) = node {
                    of_node[node] = Some(ends[k]);
                }
            }
            net.connect(Segment {
                piece: chord.curve,
                ends,
                range: chord.range,
                inside: [false; 2],
            })?;
        }
        Ok(net)
    }

    pub(super) fn point(&self, vertex: u32) -> Point {
        let p = self.triangles.vertex(handle(vertex)).position();
        [p.x, p.y]
    }

    /// Adds a vertex.
    pub(super) fn add(&mut self, at: Point, place: Place) -> Result<u32, PlaneError> {
        let added = self.triangles.insert(Point2::new(at[0], at[1]));
        match added {
            Ok(vertex) if vertex.index() == self.places.len() => {
                self.places.push(place);
                Ok(vertex.index() as u32)
            }
            _ => Err(PlaneError::Touching { at }),
        }
    }

    /// Makes an edge of two vertices a segment.
    pub(super) fn connect(&mut self, segment: Segment) -> Result<(), PlaneError> {
        let [a, b] = segment.ends.map(handle);
        if segment.ends[0] == segment.ends[1] || !self.triangles.can_add_constraint(a, b) {
            let at = self.point(segment.ends[0]);
            return Err(PlaneError::Touching { at });
        }
        let is_new = self.triangles.add_constraint(a, b);
        // A vertex on the way would make it two edges.
        if !is_new || self.edge(segment.ends).is_none() {
            let at = self.point(segment.ends[1]);
            return Err(PlaneError::Touching { at });
        }
        self.segments.insert(key(segment.ends), segment);
        Ok(())
    }

    /// The edge from one vertex to another.
    pub(super) fn edge(&self, [a, b]: [u32; 2]) -> Option<Edge<'_>> {
        self.triangles.get_edge_from_neighbors(handle(a), handle(b))
    }

    /// The vertex on the left of an edge; none beyond the convex hull.
    pub(super) fn opposite(edge: Edge<'_>) -> Option<u32> {
        edge.opposite_vertex()
            .map(|v: VertexHandle<'_, _, _, _, _>| v.index() as u32)
    }

    /// How many of the segments that `separates` names lie at least between each face and the outside, by the
    /// number of the face.
    pub(super) fn depths(&self, separates: impl Fn(&Segment) -> bool) -> Vec<u32> {
        let t = &self.triangles;
        let mut depths = vec![u32::MAX; t.num_all_faces()];
        let outer = t.outer_face().fix().index();
        depths[outer] = 0;
        let mut neighbours: Vec<Vec<(usize, u32)>> = vec![Vec::new(); t.num_all_faces()];
        for edge in t.undirected_edges() {
            let [a, b] = edge.vertices().map(|v| v.index() as u32);
            let wall = self.segments.get(&key([a, b])).is_some_and(&separates);
            let edge = edge.as_directed();
            let [f, g] = [edge, edge.rev()].map(|e| e.face().fix().index());
            neighbours[f].push((g, u32::from(wall)));
            neighbours[g].push((f, u32::from(wall)));
        }
        let mut queue = VecDeque::from([outer]);
        while let Some(face) = queue.pop_front() {
            for &(next, wall) in &neighbours[face] {
                let depth = depths[face] + wall;
                if depth < depths[next] {
                    depths[next] = depth;
                    match wall {
                        0 => queue.push_front(next),
                        _ => queue.push_back(next),
                    }
                }
            }
        }
        depths
    }

    /// The faces on the left and on the right of a segment, by their numbers.
    pub(super) fn faces_at(&self, segment: &Segment) -> [usize; 2] {
        let outer = self.triangles.outer_face().fix().index();
        let [a, b] = segment.ends;
        [[a, b], [b, a]].map(|ends| self.edge(ends).map_or(outer, |e| e.face().fix().index()))
    }

    /// Tells segments on which of their sides the sheet is.
    pub(super) fn mark_sides(&mut self, inside: &[bool]) {
        let sides = |segment: &Segment| self.faces_at(segment).map(|f| inside[f]);
        let marked: Vec<[bool; 2]> = self.segments.values().map(sides).collect();
        for (segment, inside) in self.segments.values_mut().zip(marked) {
            segment.inside = inside;
        }
    }
}

pub(super) fn handle(vertex: u32) -> FixedVertexHandle {
    FixedVertexHandle::from_index(vertex as usize)
}

/// The chords of the pieces, one after the other, which meet in their common ends alone.
fn chords(graph: &PlaneGraph, keep: &[bool], longest: f64) -> Result<Vec<Chord>, PlaneError> {
    let mut chords = Vec::new();
    for (number, piece) in graph.pieces.iter().enumerate().filter(|(k, _)| keep[*k]) {
        let parameters = piece.curve.subdivide(piece.range, longest, TURN);
        for t in parameters.windows(2) {
            chords.push(chord(graph, number, [t[0], t[1]]));
        }
    }
    for _ in 0..HALVINGS {
        let mut halve = vec![false; chords.len()];
        let is_curved = |k: usize| {
            let [a, b] = chords[k].ends;
            chords[k].height() > 1e-9 * distance(a, b)
        };
        near_pairs(&chords, 0.0, |i, j| {
            let curved = [i, j].map(is_curved);
            if curved.contains(&true) && chords[i].overlaps(&chords[j]) {
                halve[i] |= curved[0];
                halve[j] |= curved[1];
            }
        })?;
        if !halve.contains(&true) {
            break;
        }
        let halves = chords.iter().zip(&halve).flat_map(|(c, halve)| {
            let [a, b] = c.range;
            let middle = 0.5 * (a + b);
            let ranges = match halve {
                true => vec![[a, middle], [middle, b]],
                false => vec![[a, b]],
            };
            ranges.into_iter().map(|range| chord(graph, c.curve, range))
        });
        chords = halves.collect();
    }
    Ok(chords)
}

/// A part of a piece, which ends in the nodes exactly.
fn chord(graph: &PlaneGraph, number: usize, range: [f64; 2]) -> Chord {
    let piece = &graph.pieces[number];
    let ends = [0, 1].map(|k| match range[k] == piece.range[k] {
        true => graph.nodes[piece.nodes[k]],
        false => piece.curve.point(range[k]),
    });
    Chord::with_ends(&piece.curve, number, range, ends)
}
