//! Which contact holds a crease open.

use isosheet_geometry::distance::{edge_edge, point_triangle};
use isosheet_geometry::{BroadPhase, Candidates, ContactMesh};
use isosheet_mesh::wording::brief;
use isosheet_mesh::{EdgeId, FaceId, Sheet, Topology, VertexId};
use nalgebra::Vector3;
use std::fmt;

/// Two faces that touch, one of them of a panel beside a crease.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchingFaces {
    /// Their numbers, that of the panel beside the crease first.
    pub faces: [u32; 2],
    /// How far they are from each other, metres.
    pub gap: f64,
    /// Where they touch, on the first of them in the rest shape, metres.
    pub at: [f64; 2],
}

impl TouchingFaces {
    /// The nearest at positions `x` (`3V`, metres) that are within reach (metres) of each other, of panels
    /// that are given by their number for each face; none if nothing touches the two panels `beside` a
    /// crease.
    pub(super) fn find(
        sheet: &Sheet,
        x: &[f64],
        panels: &[usize],
        beside: [usize; 2],
        reach: f64,
    ) -> Option<Self> {
        let topology = sheet.topology();
        let mut boxes = BroadPhase::new(ContactMesh::from_topology(topology), x);
        boxes.update(x, x, reach);
        let mut candidates = Candidates::default();
        boxes.self_candidates(&mut candidates);
        let place = |v: VertexId| Vector3::from(x.as_chunks::<3>().0[v.index()]);
        let rest = |v: VertexId| Vector3::from(sheet.position(v));
        // Of two primitives the faces that they are of, and the corners with their weights in the distance.
        let vertex_face = candidates.vertex_face.iter().map(|&[v, f]| {
            let (v, f) = (VertexId(v), FaceId(f));
            let [a, b, c] = topology.faces()[f.index()];
            let corners = [v, a, b, c];
            let closest = point_triangle(&corners.map(place));
            let first = topology.vertex_faces(v).to_vec();
            (
                closest.distance(),
                first,
                vec![f],
                (corners, closest.weights),
            )
        });
        let edge_edge = candidates.edge_edge.iter().map(|&[e, g]| {
            let [first, second] = [e, g].map(|e| topology.edges()[e as usize]);
            let corners = [first[0], first[1], second[0], second[1]];
            let closest = edge_edge(&corners.map(place));
            let [first, second] = [e, g].map(|e| faces_beside(topology, EdgeId(e)));
            (
                closest.distance(),
                first,
                second,
                (corners, closest.weights),
            )
        });
        let touching =
            vertex_face
                .chain(edge_edge)
                .filter_map(|(gap, first, second, (corners, weights))| {
                    let is_beside = |f: &&FaceId| beside.contains(&panels[f.index()]);
                    let turned = !first.iter().any(|f| is_beside(&f));
                    let (near, far) = if turned {
                        (second, first)
                    } else {
                        (first, second)
                    };
                    let near = *near.iter().find(is_beside)?;
                    let far = *far
                        .iter()
                        .find(|f| panels[f.index()] != panels[near.index()])?;
                    // The weights of the first primitive are positive, the weights of the second negative.
                    let side = if turned { -1.0 } else { 1.0 };
                    let at = corners.iter().zip(weights).filter(|(_, w)| side * w > 0.0);
                    let at: Vector3<f64> = at.map(|(v, w)| side * w * rest(*v)).sum();
                    (gap <= reach).then_some(Self {
                        faces: [near.0, far.0],
                        gap,
                        at: [at.x, at.y],
                    })
                });
        touching.min_by(|a, b| a.gap.total_cmp(&b.gap))
    }
}

fn faces_beside(topology: &Topology, e: EdgeId) -> Vec<FaceId> {
    topology.edge_faces(e).into_iter().flatten().collect()
}

/// The faces, the gap and the place.
impl fmt::Display for TouchingFaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([a, b], [x, y]) = (self.faces, self.at);
        let gap = brief(1e3 * self.gap);
        write!(
            f,
            "face {a} beside it is {gap} mm from face {b} at ({x:.3}, {y:.3}) m"
        )
    }
}
