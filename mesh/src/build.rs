//! Building and validating a [`Topology`] from a face list.

use crate::{EdgeId, FaceId, Topology, TopologyError, VertexId};

/// Half-edge ids and fan offsets are 32-bit; 3 F of them must fit twice.
const MAX_ELEMENTS: usize = (u32::MAX / 6) as usize;

/// One side of a face: the edge it lies on, by sorted ends, and where it comes from.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FaceSide {
    pub(crate) low: u32,
    pub(crate) high: u32,
    pub(crate) face: u32,
    pub(crate) corner: u8,
    /// The face runs from `high` to `low`.
    pub(crate) reversed: bool,
}

impl Topology {
    /// Builds the adjacency of the triangles `faces`, each a triple of vertex indices below `vertex_count`.
    ///
    /// # Errors
    /// A [`TopologyError`] when the faces are not an oriented surface that uses every vertex. Faces that are
    /// wound inconsistently can be repaired first with [`orient_consistently`](crate::orient_consistently).
    pub fn from_faces(vertex_count: usize, faces: &[[u32; 3]]) -> Result<Self, TopologyError> {
        build(vertex_count, faces)
    }
}

fn build(vertex_count: usize, faces: &[[u32; 3]]) -> Result<Topology, TopologyError> {
    check_faces(vertex_count, faces)?;
    let sides = sorted_sides(faces);

    let mut edges = Vec::with_capacity(sides.len() / 2 + 1);
    let mut edge_faces = Vec::with_capacity(sides.len() / 2 + 1);
    let mut face_edges = vec![[EdgeId(0); 3]; faces.len()];
    let mut boundary_edge_count = 0;
    for group in sides.chunk_by(|s, t| (s.low, s.high) == (t.low, t.high)) {
        let (low, high) = (VertexId(group[0].low), VertexId(group[0].high));
        let edge = EdgeId::from_index(edges.len());
        for s in group {
            face_edges[s.face as usize][s.corner as usize] = edge;
        }
        let ids = |k: usize| FaceId(group[k].face);
        match group {
            [s] => {
                boundary_edge_count += 1;
                edges.push(if s.reversed { [high, low] } else { [low, high] });
                edge_faces.push([Some(ids(0)), None]);
            }
            [s, t] if s.reversed != t.reversed => {
                edges.push([low, high]);
                let (left, right) = if s.reversed { (1, 0) } else { (0, 1) };
                edge_faces.push([Some(ids(left)), Some(ids(right))]);
            }
            [s, _] => {
                let (a, b) = if s.reversed { (high, low) } else { (low, high) };
                return Err(TopologyError::InconsistentWinding {
                    a,
                    b,
                    first: ids(0),
                    second: ids(1),
                });
            }
            _ => {
                return Err(TopologyError::NonManifoldEdge {
                    a: low,
                    b: high,
                    count: group.len(),
                    faces: [ids(0), ids(1), ids(2)],
                });
            }
        }
    }

    let faces: Vec<[VertexId; 3]> = faces.iter().map(|f| f.map(VertexId)).collect();
    let mut topology = Topology {
        faces,
        edges,
        edge_faces,
        face_edges,
        vertex_edge_start: Vec::new(),
        vertex_edges: Vec::new(),
        vertex_face_start: Vec::new(),
        vertex_faces: Vec::new(),
        vertex_component: vec![u32::MAX; vertex_count],
        component_count: 0,
        boundary_edge_count,
        boundary_vertex_count: 0,
    };
    build_fans(&mut topology)?;
    label_components(&mut topology);
    Ok(topology)
}

/// Counts, index range, repeated corners and duplicates: all that needs no adjacency.
pub(crate) fn check_faces(vertex_count: usize, faces: &[[u32; 3]]) -> Result<(), TopologyError> {
    if faces.is_empty() {
        return Err(TopologyError::NoFaces);
    }
    for (what, count) in [("vertices", vertex_count), ("faces", faces.len())] {
        if count > MAX_ELEMENTS {
            return Err(TopologyError::TooLarge {
                what,
                count,
                limit: MAX_ELEMENTS,
            });
        }
    }
    for (k, f) in faces.iter().enumerate() {
        let face = FaceId::from_index(k);
        if let Some(&vertex) = f.iter().find(|&&v| v as usize >= vertex_count) {
            return Err(TopologyError::IndexOutOfRange {
                face,
                vertex,
                vertex_count,
            });
        }
        let [a, b, c] = *f;
        if a == b || a == c {
            return Err(TopologyError::RepeatedVertex {
                face,
                vertex: VertexId(a),
            });
        }
        if b == c {
            return Err(TopologyError::RepeatedVertex {
                face,
                vertex: VertexId(b),
            });
        }
    }
    let mut keys: Vec<([u32; 3], u32)> = faces
        .iter()
        .enumerate()
        .map(|(k, f)| {
            let mut corners = *f;
            corners.sort_unstable();
            (corners, k as u32)
        })
        .collect();
    keys.sort_unstable();
    // Of several duplicates the one met first in the file is reported.
    let duplicate = keys
        .windows(2)
        .filter(|w| w[0].0 == w[1].0)
        .min_by_key(|w| w[1].1);
    match duplicate {
        Some(w) => Err(TopologyError::DuplicateFace {
            first: FaceId(w[0].1),
            second: FaceId(w[1].1),
            corners: w[0].0,
        }),
        None => Ok(()),
    }
}

/// All sides of all faces, sorted by their edge, so that the sides of one edge are neighbours.
pub(crate) fn sorted_sides(faces: &[[u32; 3]]) -> Vec<FaceSide> {
    let mut sides = Vec::with_capacity(3 * faces.len());
    for (k, f) in faces.iter().enumerate() {
        for corner in 0..3 {
            let (a, b) = (f[corner], f[(corner + 1) % 3]);
            sides.push(FaceSide {
                low: a.min(b),
                high: a.max(b),
                face: k as u32,
                corner: corner as u8,
                reversed: a > b,
            });
        }
    }
    sides.sort_unstable();
    sides
}

/// A face and which of its corners, 0 to 2.
type Corner = (FaceId, u8);

/// The corners at every vertex in face order, as row pointers and entries.
fn corners_at_vertices(
    faces: &[[VertexId; 3]],
    vertex_count: usize,
) -> Result<(Vec<u32>, Vec<Corner>), TopologyError> {
    let mut start = vec![0u32; vertex_count + 1];
    for f in faces {
        for v in f {
            start[v.index() + 1] += 1;
        }
    }
    for v in 0..vertex_count {
        if start[v + 1] == 0 {
            return Err(TopologyError::UnreferencedVertex {
                vertex: VertexId::from_index(v),
            });
        }
        start[v + 1] += start[v];
    }
    let mut fill = start.clone();
    let mut corners = vec![(FaceId(0), 0u8); 3 * faces.len()];
    for (k, f) in faces.iter().enumerate() {
        for (corner, v) in f.iter().enumerate() {
            corners[fill[v.index()] as usize] = (FaceId::from_index(k), corner as u8);
            fill[v.index()] += 1;
        }
    }
    Ok((start, corners))
}

/// Lists the edges and faces at every vertex in counter-clockwise order.
fn build_fans(t: &mut Topology) -> Result<(), TopologyError> {
    let n = t.vertex_count();
    let (start, corners) = corners_at_vertices(&t.faces, n)?;
    let mut vertex_faces = Vec::with_capacity(3 * t.faces.len());
    let mut vertex_edges = Vec::with_capacity(2 * t.edges.len());
    let mut edge_start = Vec::with_capacity(n + 1);
    edge_start.push(0u32);
    for v in 0..n {
        let here = &corners[start[v] as usize..start[v + 1] as usize];
        // Face (v, p, q) lies between the edges v-p and v-q, in counter-clockwise order.
        let first = here
            .iter()
            .find(|&&(f, c)| t.is_boundary_edge(t.face_edges[f.index()][c as usize]));
        if first.is_some() {
            t.boundary_vertex_count += 1;
        }
        let first = *first.unwrap_or(&here[0]);
        let before = vertex_faces.len();
        collect_fan(t, v, first, &mut vertex_faces, &mut vertex_edges);
        let reached = vertex_faces.len() - before;
        if reached != here.len() {
            let vertex = VertexId::from_index(v);
            return Err(TopologyError::BowTieVertex {
                vertex,
                degree: here.len(),
                reached,
            });
        }
        edge_start.push(vertex_edges.len() as u32);
    }
    t.vertex_face_start = start;
    t.vertex_faces = vertex_faces;
    t.vertex_edge_start = edge_start;
    t.vertex_edges = vertex_edges;
    Ok(())
}

/// Goes round the vertex `v` from face to face across their common edges, from the corner `first` to
/// the boundary or back to it, and appends the faces and edges met.
///
/// Two faces share at most one edge here (duplicate faces are refused before), so the fan never branches.
fn collect_fan(
    t: &Topology,
    v: usize,
    first: Corner,
    faces: &mut Vec<FaceId>,
    edges: &mut Vec<EdgeId>,
) {
    let (mut face, mut corner) = (first.0, first.1 as usize);
    loop {
        faces.push(face);
        edges.push(t.face_edges[face.index()][corner]);
        let leave = t.face_edges[face.index()][(corner + 2) % 3];
        let [l, r] = t.edge_faces[leave.index()];
        match if l == Some(face) { r } else { l } {
            None => {
                edges.push(leave);
                return;
            }
            Some(f) if f == first.0 => return,
            Some(f) => {
                face = f;
                corner = match t.faces[f.index()].iter().position(|w| w.index() == v) {
                    Some(c) => c,
                    None => unreachable!("a face across an edge at a vertex has that vertex"),
                };
            }
        }
    }
}

fn label_components(t: &mut Topology) {
    let mut label = std::mem::take(&mut t.vertex_component);
    let mut stack = Vec::new();
    let mut count = 0;
    // `vertex_component` gives the vertex count, so it is put back before any query that needs it.
    for v in 0..label.len() {
        if label[v] != u32::MAX {
            continue;
        }
        label[v] = count;
        stack.push(VertexId::from_index(v));
        while let Some(w) = stack.pop() {
            for u in t.neighbours(w) {
                if label[u.index()] == u32::MAX {
                    label[u.index()] = count;
                    stack.push(u);
                }
            }
        }
        count += 1;
    }
    t.vertex_component = label;
    t.component_count = count as usize;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Advice;

    fn error(vertex_count: usize, faces: &[[u32; 3]]) -> TopologyError {
        build(vertex_count, faces).unwrap_err()
    }

    #[test]
    fn every_defect_has_its_error() {
        let (v, f) = (VertexId, FaceId);
        assert_eq!(error(3, &[]), TopologyError::NoFaces);
        assert_eq!(
            error(3, &[[0, 1, 2], [0, 2, 3]]),
            TopologyError::IndexOutOfRange {
                face: f(1),
                vertex: 3,
                vertex_count: 3
            }
        );
        assert_eq!(
            error(3, &[[0, 1, 0]]),
            TopologyError::RepeatedVertex {
                face: f(0),
                vertex: v(0)
            }
        );
        assert_eq!(
            error(3, &[[0, 1, 1]]),
            TopologyError::RepeatedVertex {
                face: f(0),
                vertex: v(1)
            }
        );
        assert_eq!(
            error(3, &[[2, 2, 0]]),
            TopologyError::RepeatedVertex {
                face: f(0),
                vertex: v(2)
            }
        );
        for copy in [[0, 1, 2], [1, 2, 0], [2, 1, 0]] {
            assert_eq!(
                error(4, &[[0, 1, 2], [0, 2, 3], copy]),
                TopologyError::DuplicateFace {
                    first: f(0),
                    second: f(2),
                    corners: [0, 1, 2]
                }
            );
        }
        assert_eq!(
            error(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]),
            TopologyError::NonManifoldEdge {
                a: v(0),
                b: v(1),
                count: 3,
                faces: [f(0), f(1), f(2)]
            }
        );
        assert_eq!(
            error(4, &[[0, 1, 2], [0, 3, 2]]),
            TopologyError::InconsistentWinding {
                a: v(2),
                b: v(0),
                first: f(0),
                second: f(1)
            }
        );
        assert_eq!(
            error(5, &[[0, 1, 2], [0, 3, 4]]),
            TopologyError::BowTieVertex {
                vertex: v(0),
                degree: 2,
                reached: 1
            }
        );
        assert_eq!(
            error(4, &[[0, 1, 2]]),
            TopologyError::UnreferencedVertex { vertex: v(3) }
        );
        assert!(matches!(
            error(usize::MAX, &[[0, 1, 2]]),
            TopologyError::TooLarge {
                what: "vertices",
                ..
            }
        ));
    }

    #[test]
    fn two_closed_fans_at_a_vertex_are_a_bow_tie() {
        // Two tetrahedra that share vertex 0.
        let faces = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 1],
            [1, 3, 2],
            [0, 4, 5],
            [0, 5, 6],
            [0, 6, 4],
            [4, 6, 5],
        ];
        assert_eq!(
            error(7, &faces),
            TopologyError::BowTieVertex {
                vertex: VertexId(0),
                degree: 6,
                reached: 3
            }
        );
        // A closed fan and an open one.
        let faces = [[0, 4, 5], [0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        assert_eq!(
            error(6, &faces),
            TopologyError::BowTieVertex {
                vertex: VertexId(0),
                degree: 4,
                reached: 1
            }
        );
    }

    #[test]
    fn messages_name_element_value_and_remedy() {
        let text = error(3, &[[0, 1, 2], [0, 2, 7]]).to_string();
        assert!(
            text.contains("face 1") && text.contains("vertex 7") && text.contains("3 vertices"),
            "{text}"
        );
        let text = error(4, &[[0, 1, 2], [0, 3, 2]]).with_advice();
        assert!(
            text.contains("face 0")
                && text.contains("face 1")
                && text.contains("orient_consistently"),
            "{text}"
        );
    }
}
