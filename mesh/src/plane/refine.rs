//! Delaunay refinement (Ruppert 1995) with segments that follow curves.
//!
//! A segment is halved where a vertex lies within the circle over it; a triangle that is too large or too
//! thin gets a vertex in the centre of its circumscribed circle, unless that lies in the circle over a
//! segment, which is halved instead. Where lines meet at small angles, segments are cut at distances from the
//! corner that are powers of two, and thin triangles between two such cuts stay (Miller, Pav and Walkington
//! 2003).

use super::error::PlaneError;
use super::graph::PlaneGraph;
use super::net::{Edge, Key, Net, Place, Segment, handle, key};
use super::vec2::{Point, cross, distance, dot, sub};
use spade::Triangulation;
use std::collections::VecDeque;

/// The largest ratio of the radius of the circumscribed circle to the shortest side: 1 / (2 sin 25 degrees),
/// where 25 degrees are the smallest angle. Ruppert's algorithm is proven to end for 20.7 degrees and does so
/// in practice up to 33.
const THINNEST: f64 = 1.1831;

/// The largest radius of the circumscribed circle as a part of the spacing. That of an equilateral triangle
/// whose sides are as long as the spacing is 0.58.
const LARGEST: f64 = 0.9;

/// Lines that meet at smaller angles are cut at powers of two: cosine of 60 degrees.
const SMALL_ANGLE: f64 = 0.5;

pub(super) struct Refiner<'a> {
    net: &'a mut Net,
    graph: &'a PlaneGraph,
    spacing: f64,
    /// Nothing that is shorter than this is divided, metres.
    floor: f64,
    most_vertices: usize,
    /// Of each node whether lines meet there at a small angle.
    is_acute: Vec<bool>,
    segments: VecDeque<Key>,
    triangles: VecDeque<[u32; 3]>,
}

impl<'a> Refiner<'a> {
    pub(super) fn new(
        net: &'a mut Net,
        graph: &'a PlaneGraph,
        spacing: f64,
        most_vertices: usize,
    ) -> Self {
        let is_acute = acute_nodes(net, graph);
        Self {
            net,
            graph,
            spacing,
            floor: 0.1 * graph.snap.min(spacing),
            most_vertices,
            is_acute,
            segments: VecDeque::new(),
            triangles: VecDeque::new(),
        }
    }

    /// Refines all; `inside` says of each face, by its number, whether it belongs to the sheet.
    pub(super) fn refine(mut self, inside: &[bool]) -> Result<(), PlaneError> {
        self.segments = self.net.segments.keys().copied().collect();
        let faces = self.net.triangles.inner_faces();
        self.triangles = faces
            .filter(|f| inside[f.fix().index()])
            .map(|f| f.vertices().map(|v| v.index() as u32))
            .collect();
        loop {
            if let Some(key) = self.segments.pop_front() {
                if self.is_encroached(key) {
                    self.split(key)?;
                }
            } else if let Some(corners) = self.triangles.pop_front() {
                self.improve(corners)?;
            } else {
                return Ok(());
            }
            let vertices = self.net.places.len();
            if vertices > self.most_vertices {
                let [faces, limit] = [vertices, self.most_vertices].map(|n| 2 * n);
                let faces = faces as f64;
                return Err(PlaneError::TooManyFaces { faces, limit });
            }
        }
    }

    /// Whether a vertex of the sheet lies within the circle over a segment.
    fn is_encroached(&self, key: Key) -> bool {
        let Some(segment) = self.net.segments.get(&key) else {
            return false;
        };
        let [a, b] = segment.ends;
        [([a, b], segment.inside[0]), ([b, a], segment.inside[1])]
            .into_iter()
            .filter(|(_, inside)| *inside)
            .filter_map(|(ends, _)| self.net.edge(ends).and_then(Net::opposite))
            .any(|v| self.sees_wide(self.net.point(v), segment))
    }

    /// Whether a point sees a segment at more than a right angle.
    fn sees_wide(&self, p: Point, segment: &Segment) -> bool {
        let [a, b] = segment.ends.map(|v| sub(self.net.point(v), p));
        dot(a, b) < 0.0
    }

    /// Cuts a segment in two; false where it is too short for that.
    fn split(&mut self, at: Key) -> Result<bool, PlaneError> {
        let Some(segment) = self.net.segments.get(&at).copied() else {
            return Ok(false);
        };
        let [p, q] = segment.ends.map(|v| self.net.point(v));
        if distance(p, q) < 2.0 * self.floor {
            return Ok(false);
        }
        let t = self.cut(&segment);
        let point = self.graph.pieces[segment.piece].curve.point(t);
        self.net.segments.remove(&at);
        if let Some(edge) = self.net.edge(segment.ends).map(|e| e.as_undirected().fix()) {
            self.net.triangles.remove_constraint_edge(edge);
        }
        let vertex = self.net.add(point, Place::Piece(segment.piece))?;
        let [a, b] = segment.ends;
        for (ends, range) in [
            ([a, vertex], [segment.range[0], t]),
            ([vertex, b], [t, segment.range[1]]),
        ] {
            self.net.connect(Segment {
                ends,
                range,
                ..segment
            })?;
            self.segments.push_back(key(ends));
        }
        // Those on its left lie between the edges to b and to a, counter-clockwise.
        for (from, to, inside) in [(b, a, segment.inside[0]), (a, b, segment.inside[1])] {
            if inside {
                self.look_around(vertex, from, Some(to));
            }
        }
        Ok(true)
    }

    /// Queues the triangles at a vertex from the edge to one neighbour counter-clockwise to that to another,
    /// or all around, with the segments opposite of it.
    fn look_around(&mut self, vertex: u32, from: u32, to: Option<u32>) {
        let Some(first) = self.net.edge([vertex, from]) else {
            return;
        };
        let mut edge = first;
        loop {
            if edge.face().is_outer() {
                return;
            }
            let corners = [
                vertex,
                edge.to().index() as u32,
                edge.ccw().to().index() as u32,
            ];
            self.triangles.push_back(corners);
            let opposite = key([corners[1], corners[2]]);
            if self.net.segments.contains_key(&opposite) {
                self.segments.push_back(opposite);
            }
            edge = edge.ccw();
            let reached = edge.to().index() as u32;
            if reached == to.unwrap_or(from) {
                return;
            }
        }
    }

    /// The parameter at which a segment is cut: in the middle, or at a distance from the end with small
    /// angles that is a power of two of the spacing.
    fn cut(&self, segment: &Segment) -> f64 {
        let curve = &self.graph.pieces[segment.piece].curve;
        let [t, u] = segment.range;
        let is_acute = segment.ends.map(|v| match self.net.places[v as usize] {
            Place::Node(node) => self.is_acute[node],
            _ => false,
        });
        let end = match is_acute {
            [true, false] => 0,
            [false, true] => 1,
            _ => return 0.5 * (t + u),
        };
        let corner = self.net.point(segment.ends[end]);
        let length = distance(corner, self.net.point(segment.ends[1 - end]));
        // Between a third and two thirds of the length.
        let shell = self.spacing * (2.0 * length / (3.0 * self.spacing)).log2().floor().exp2();
        let [mut near, mut far] = [segment.range[end], segment.range[1 - end]];
        for _ in 0..60 {
            let middle = 0.5 * (near + far);
            match distance(curve.point(middle), corner) < shell {
                true => near = middle,
                false => far = middle,
            }
        }
        far
    }

    /// Whether there still is such a triangle.
    fn face(&self, [a, b, c]: [u32; 3]) -> Option<Edge<'_>> {
        let edge = self.net.edge([a, b])?;
        (Net::opposite(edge) == Some(c)).then_some(edge)
    }

    /// Adds a vertex to a triangle that is too large or too thin.
    fn improve(&mut self, corners: [u32; 3]) -> Result<(), PlaneError> {
        if self.face(corners).is_none() {
            return Ok(());
        }
        let [a, b, c] = corners.map(|v| self.net.point(v));
        let (centre, radius) = circle(a, b, c);
        let sides = [[0, 1], [1, 2], [2, 0]].map(|k: [usize; 2]| k.map(|k| corners[k]));
        let lengths = sides.map(|s| distance(self.net.point(s[0]), self.net.point(s[1])));
        let short = (0..3).min_by(|&i, &j| lengths[i].total_cmp(&lengths[j]));
        let short = short.unwrap_or(0);
        let is_thin = radius > THINNEST * lengths[short]
            && lengths[short] > 2.0 * self.floor
            && !self.is_between_lines(sides[short]);
        if !(radius > LARGEST * self.spacing || is_thin) || !radius.is_finite() {
            return Ok(());
        }
        let near = self.segments_around(corners, centre);
        if near.is_empty() {
            let vertex = self.net.add(centre, Place::Free)?;
            let neighbour = self.net.triangles.vertex(handle(vertex)).out_edge();
            let neighbour = neighbour.map(|e| e.to().index() as u32);
            if let Some(neighbour) = neighbour {
                self.look_around(vertex, neighbour, None);
            }
            return Ok(());
        }
        let mut is_split = false;
        for segment in near {
            is_split |= self.split(segment)?;
        }
        if is_split {
            self.triangles.push_back(corners);
        }
        Ok(())
    }

    /// Whether the ends of a side lie on two lines at the same distance from the corner with a small angle
    /// where they meet: no vertex makes the triangle at it thicker.
    fn is_between_lines(&self, side: [u32; 2]) -> bool {
        let [Place::Piece(i), Place::Piece(j)] = side.map(|v| self.net.places[v as usize]) else {
            return false;
        };
        let [p, q] = side.map(|v| self.net.point(v));
        let nodes = self.graph.pieces[i].nodes.into_iter();
        let mut common = nodes.filter(|n| self.graph.pieces[j].nodes.contains(n));
        i != j
            && common.any(|node| {
                let corner = self.graph.nodes[node];
                let [r, s] = [distance(corner, p), distance(corner, q)];
                self.is_acute[node] && (r - s).abs() < 1e-6 * r
            })
    }

    /// The segments that bound the part of the sheet whose triangles a new vertex would replace, and in whose
    /// circle it would lie or beyond which it lies.
    fn segments_around(&self, corners: [u32; 3], centre: Point) -> Vec<Key> {
        let mut near = Vec::new();
        let mut known = vec![key3(corners)];
        let mut stack = vec![corners];
        while let Some([a, b, c]) = stack.pop() {
            for side in [[a, b], [b, c], [c, a]] {
                if let Some(segment) = self.net.segments.get(&key(side)) {
                    let [p, q] = side.map(|v| sub(self.net.point(v), centre));
                    let is_beyond = cross(p, q) <= 0.0;
                    if is_beyond || self.sees_wide(centre, segment) {
                        near.push(key(side));
                    }
                    continue;
                }
                let [p, q] = side;
                let Some(r) = self.net.edge([q, p]).and_then(Net::opposite) else {
                    continue;
                };
                let next = [q, p, r];
                if known.contains(&key3(next)) {
                    continue;
                }
                let [x, y, z] = next.map(|v| self.net.point(v));
                let (middle, radius) = circle(x, y, z);
                if distance(middle, centre) < radius {
                    known.push(key3(next));
                    stack.push(next);
                }
            }
        }
        near
    }
}

fn key3(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

/// Centre and radius of the circumscribed circle.
fn circle(a: Point, b: Point, c: Point) -> (Point, f64) {
    let (u, v) = (sub(b, a), sub(c, a));
    let twice = 2.0 * cross(u, v);
    let (uu, vv) = (dot(u, u), dot(v, v));
    let d = [
        (vv * -u[1] + uu * v[1]) / twice,
        (uu * -v[0] + vv * u[0]) / twice,
    ];
    ([a[0] + d[0], a[1] + d[1]], d[0].hypot(d[1]))
}

/// Of each node whether two of its segments meet there at a small angle.
fn acute_nodes(net: &Net, graph: &PlaneGraph) -> Vec<bool> {
    let mut directions: Vec<Vec<Point>> = vec![Vec::new(); graph.nodes.len()];
    for segment in net.segments.values() {
        let [a, b] = segment.ends;
        for [from, to] in [[a, b], [b, a]] {
            if let Place::Node(node) = net.places[from as usize] {
                let d = sub(net.point(to), net.point(from));
                let length = d[0].hypot(d[1]);
                directions[node].push(d.map(|c| c / length));
            }
        }
    }
    let is_acute = |around: &Vec<Point>| {
        let pairs = (0..around.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
        let mut pairs = pairs.map(|pair| pair.map(|k| around[k]));
        pairs.any(|[u, v]| dot(u, v) > SMALL_ANGLE + 1e-9)
    };
    directions.iter().map(is_acute).collect()
}
