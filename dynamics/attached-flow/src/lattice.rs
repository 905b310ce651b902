//! The lattice of vortex rings on the faces of a sheet.

use super::error::AttachedFlowError;
use isosheet_materials::vectors::point;
use isosheet_mesh::{EdgeId, FaceId, Topology, VertexId};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Part of the height of a face at the boundary by which its ring ends inside of the boundary; at trailing
/// edges it ends there, and its centre is that of a ring that ends outside.
///
/// Vortices at a quarter and no flow at three quarters of a panel make a plate of panels in a row exact
/// (James, Comput. Methods Appl. Mech. Eng. 1, 1972); at the tips of a wing a quarter is best too (Hough, J.
/// Aircraft 10, 1973).
const INSET: f64 = 0.25;
/// Sine of the angle between two boundary edges below which they count as one line, or as a needle.
const STRAIGHT: f64 = 0.5;

/// A point that moves with some vertices: the sum of their positions with weights whose sum is one.
#[derive(Debug, Clone)]
struct Node(Vec<(usize, f64)>);

/// An edge of the rings: they run along it, that of the face `left` from its first end to the second one.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingEdge {
    pub(super) ends: [usize; 2],
    pub(super) left: usize,
    pub(super) right: Option<usize>,
    pub(super) is_trailing: bool,
}

/// A ring edge at which a wake begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trailing {
    pub(super) face: usize,
    /// The numbers of its ends among the points at which wakes begin, in the direction of the ring.
    pub(super) points: [usize; 2],
}

/// A vortex ring for each of some faces, with the corners of the face. At the boundary, except at trailing
/// edges, corners are a quarter of a face inside. (See [`INSET`].)
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    /// The vertices of the sheet that the nodes move with.
    pub(super) vertices: Vec<VertexId>,
    nodes: Vec<Node>,
    /// Nodes at the corners of rings that end outside of the boundary at trailing edges, and elsewhere at
    /// `nodes`: their means are the centres of faces.
    probes: Vec<Node>,
    /// Nodes of the corners.
    pub(super) faces: Vec<[usize; 3]>,
    pub(super) edges: Vec<RingEdge>,
    pub(super) trailing: Vec<Trailing>,
    /// The nodes at which wakes begin.
    pub(super) shedding: Vec<usize>,
    /// Length of the shortest edge, metres.
    pub(super) size: f64,
}

/// A lattice in space.
#[derive(Debug, Clone, Default)]
pub(super) struct LatticeShape {
    /// Of the nodes, metres.
    pub(super) nodes: Vec<Vector3<f64>>,
    /// Of the faces.
    pub(super) centres: Vec<Vector3<f64>>,
    pub(super) normals: Vec<Vector3<f64>>,
    /// Square metres.
    pub(super) areas: Vec<f64>,
}

impl Lattice {
    /// Of some faces of a mesh with edges of these rest lengths (metres).
    ///
    /// # Errors
    /// [`AttachedFlowError`] if a face or an edge is none of them, or there are no trailing edges.
    pub(super) fn new(
        topology: &Topology,
        lengths: &[f64],
        of: &[FaceId],
        trailing: &[EdgeId],
    ) -> Result<Self, AttachedFlowError> {
        let face_count = topology.face_count();
        let mut numbers: BTreeMap<FaceId, usize> = BTreeMap::new();
        for face in of {
            if face.index() >= face_count {
                return Err(AttachedFlowError::NoSuchFace {
                    face: *face,
                    face_count,
                });
            }
            let next = numbers.len();
            numbers.entry(*face).or_insert(next);
        }
        if trailing.is_empty() {
            return Err(AttachedFlowError::NoTrailingEdge);
        }
        let mesh = Mesh {
            topology,
            lengths,
            numbers,
        };
        for edge in trailing {
            if !mesh.is_rim(*edge) {
                return Err(AttachedFlowError::NotAtRim { edge: *edge });
            }
        }
        let is_trailing = |e: EdgeId| trailing.contains(&e);
        let mut order: Vec<(usize, FaceId)> = mesh.numbers.iter().map(|(f, k)| (*k, *f)).collect();
        order.sort_unstable();
        let corners = order.iter().flat_map(|(_, f)| topology.faces()[f.index()]);
        let mut vertices: Vec<VertexId> = corners.collect();
        vertices.sort_unstable();
        vertices.dedup();
        let local = |v: &VertexId| vertices.binary_search(v).expect("it is a corner");
        let nodes = |outside: f64| -> Vec<Node> {
            let outward = |e: EdgeId| if is_trailing(e) { outside } else { -INSET };
            vertices
                .iter()
                .map(|v| mesh.node(*v, outward, local))
                .collect()
        };
        let (nodes, probes) = (nodes(0.0), nodes(INSET));
        let faces: Vec<[usize; 3]> = order
            .iter()
            .map(|(_, f)| topology.faces()[f.index()].each_ref().map(local))
            .collect();
        let mut edges = Vec::new();
        let mut shed: Vec<(usize, [usize; 2])> = Vec::new();
        let mut size = f64::INFINITY;
        for e in topology.edge_ids() {
            let ends = topology.edges()[e.index()]
                .each_ref()
                .map(|v| vertices.binary_search(v));
            let sides = mesh.sides(e);
            let ([Ok(a), Ok(b)], [Some(_), _] | [_, Some(_)]) = (ends, sides) else {
                continue;
            };
            size = lengths[e.index()].min(size);
            let runs =
                |face: usize| (0..3).any(|k| faces[face][k] == a && faces[face][(k + 1) % 3] == b);
            let mut both = sides.into_iter().flatten();
            let (first, second) = (both.next().expect("it has a side"), both.next());
            let ends = if runs(first) { [a, b] } else { [b, a] };
            let is_trailing = is_trailing(e);
            if is_trailing {
                shed.push((first, ends));
            }
            edges.push(RingEdge {
                ends,
                left: first,
                right: second,
                is_trailing,
            });
        }
        let mut shedding: Vec<usize> = shed.iter().flat_map(|(_, ends)| *ends).collect();
        shedding.sort_unstable();
        shedding.dedup();
        let number = |node: usize| shedding.binary_search(&node).expect("it sheds");
        let trailing = shed.iter().map(|(face, ends)| Trailing {
            face: *face,
            points: ends.map(number),
        });
        Ok(Self {
            trailing: trailing.collect(),
            size,
            nodes,
            probes,
            faces,
            edges,
            shedding,
            vertices,
        })
    }

    /// Values of the vertices (`3V` of the sheet) at the nodes.
    pub(super) fn at_nodes(&self, values: &[f64]) -> Vec<Vector3<f64>> {
        self.at(&self.nodes, values)
    }

    /// Values of the vertices (`3V` of the sheet) at the probes.
    pub(super) fn at_probes(&self, values: &[f64]) -> Vec<Vector3<f64>> {
        self.at(&self.probes, values)
    }

    fn at(&self, nodes: &[Node], values: &[f64]) -> Vec<Vector3<f64>> {
        let at = |node: &Node| {
            let parts = node
                .0
                .iter()
                .map(|(v, w)| *w * point(values, self.vertices[*v]));
            parts.sum()
        };
        nodes.iter().map(at).collect()
    }

    /// What acts on the nodes, on the vertices: for each vertex of the lattice.
    pub(super) fn to_vertices(&self, of_nodes: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut of_vertices = vec![Vector3::zeros(); self.vertices.len()];
        for (node, value) in self.nodes.iter().zip(of_nodes) {
            for (v, w) in &node.0 {
                of_vertices[*v] += *w * value;
            }
        }
        of_vertices
    }

    /// The vertices that a node moves with, by their numbers in the lattice, and their weights.
    pub(super) fn weights(&self, node: usize) -> &[(usize, f64)] {
        &self.nodes[node].0
    }

    /// The vertices that a probe moves with, by their numbers in the lattice, and their weights.
    pub(super) fn probe_weights(&self, node: usize) -> &[(usize, f64)] {
        &self.probes[node].0
    }

    /// Points of the trailing edges, metres.
    pub(super) fn edge(&self, shape: &LatticeShape) -> Vec<Vector3<f64>> {
        let nodes = self.shedding.iter();
        nodes.map(|node| shape.nodes[*node]).collect()
    }

    /// The lattice at positions `x` (`3V`, metres).
    pub(super) fn shape(&self, x: &[f64]) -> LatticeShape {
        let nodes = self.at_nodes(x);
        let probes = self.at_probes(x);
        let mut shape = LatticeShape::default();
        for (face, corners) in self.faces.iter().enumerate() {
            let [a, b, c] = corners.map(|k| nodes[k]);
            let across = (b - a).cross(&(c - a));
            shape.centres.push(self.at_centre(face, &probes));
            shape
                .normals
                .push(across.try_normalize(0.0).unwrap_or_default());
            shape.areas.push(0.5 * across.norm());
        }
        LatticeShape { nodes, ..shape }
    }

    /// Values of the probes at the centre of a face.
    pub(super) fn at_centre(&self, face: usize, of_probes: &[Vector3<f64>]) -> Vector3<f64> {
        let [a, b, c] = self.faces[face].map(|k| of_probes[k]);
        (a + b + c) / 3.0
    }
}

/// The faces of the lattice in their mesh.
struct Mesh<'a> {
    topology: &'a Topology,
    lengths: &'a [f64],
    numbers: BTreeMap<FaceId, usize>,
}

impl Mesh<'_> {
    /// The faces of the lattice at an edge.
    fn sides(&self, e: EdgeId) -> [Option<usize>; 2] {
        let faces = self.topology.edge_faces(e);
        faces.map(|f| f.and_then(|f| self.numbers.get(&f).copied()))
    }

    /// Whether an edge of the mesh has one face of the lattice.
    fn is_rim(&self, e: EdgeId) -> bool {
        e.index() < self.topology.edge_count() && self.sides(e).iter().flatten().count() == 1
    }

    fn length(&self, a: VertexId, b: VertexId) -> f64 {
        let edge = self.topology.find_edge(a, b).expect("corners of a face");
        self.lengths[edge.index()]
    }

    /// The faces of the lattice around a vertex at its rim, in the order of their orientation from one rim
    /// edge to the other one, each by its corners after the vertex; empty within the lattice.
    fn fan(&self, v: VertexId) -> Vec<[VertexId; 2]> {
        let own = |f: &&FaceId| self.numbers.contains_key(*f);
        let around = self.topology.vertex_faces(v).iter().filter(own);
        let after = |f: &FaceId| {
            let corners = self.topology.faces()[f.index()];
            let k = corners.iter().position(|c| *c == v).expect("a corner");
            [corners[(k + 1) % 3], corners[(k + 2) % 3]]
        };
        let all: Vec<[VertexId; 2]> = around.map(after).collect();
        let is_first = |pair: &&[VertexId; 2]| all.iter().all(|other| other[1] != pair[0]);
        let Some(first) = all.iter().find(is_first) else {
            return Vec::new();
        };
        let mut fan = vec![*first];
        while let Some(next) = all.iter().find(|pair| pair[0] == fan[fan.len() - 1][1]) {
            fan.push(*next);
        }
        fan
    }

    /// The node of a vertex: the vertex, or a point near it if it is at the rim.
    fn node(
        &self,
        v: VertexId,
        outward: impl Fn(EdgeId) -> f64,
        local: impl Fn(&VertexId) -> usize,
    ) -> Node {
        let fan = self.fan(v);
        let mut weights = BTreeMap::from([(local(&v), 1.0)]);
        let (Some([first, _]), Some([_, last])) = (fan.first(), fan.last()) else {
            return Node(weights.into_iter().collect());
        };
        // The faces in one plane around the vertex, the first edge along the first axis.
        let mut rays = vec![0.0];
        for [a, b] in &fan {
            let (to_a, to_b, across) =
                (self.length(v, *a), self.length(v, *b), self.length(*a, *b));
            let cos = (to_a * to_a + to_b * to_b - across * across) / (2.0 * to_a * to_b);
            rays.push(rays[rays.len() - 1] + cos.clamp(-1.0, 1.0).acos());
        }
        let angle = rays[fan.len()];
        let shift = |rim: VertexId, [a, b]: [VertexId; 2], between: f64| {
            let opposite = if rim == a { b } else { a };
            let height = self.length(v, opposite) * between.sin();
            let edge = self.topology.find_edge(v, rim).expect("an edge of the rim");
            outward(edge) * height
        };
        let ends = [
            shift(*first, fan[0], rays[1]),
            shift(*last, fan[fan.len() - 1], angle - rays[fan.len() - 1]),
        ];
        let [x, y] = moved(ends, angle);
        let count = fan.len() as f64;
        for (k, [a, b]) in fan.iter().enumerate() {
            let (sin_a, cos_a) = rays[k].sin_cos();
            let (sin_b, cos_b) = rays[k + 1].sin_cos();
            let area = cos_a * sin_b - sin_a * cos_b;
            if area <= 0.0 {
                continue;
            }
            let along_a = (x * sin_b - y * cos_b) / (area * self.length(v, *a) * count);
            let along_b = (y * cos_a - x * sin_a) / (area * self.length(v, *b) * count);
            *weights.entry(local(a)).or_default() += along_a;
            *weights.entry(local(b)).or_default() += along_b;
            *weights.entry(local(&v)).or_default() -= along_a + along_b;
        }
        Node(weights.into_iter().collect())
    }
}

/// The displacement of a corner of a plane part whose two sides move outward by some lengths: the first side
/// runs along the first axis, the other one at an angle to it.
fn moved([first, last]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    if sin.abs() >= STRAIGHT {
        // Outward are (0, -1) and (-sin, cos).
        return [-(last + first * cos) / sin, -first];
    }
    if cos > 0.0 {
        // A needle, or all around the vertex.
        return [0.0; 2];
    }
    let (sin, cos) = (0.5 * angle).sin_cos();
    let mean = 0.5 * (first + last);
    [-mean * cos, -mean * sin]
}
