//! The corners, edges and faces of a body, as edges and faces of a sheet meet them.

use super::displacements::Displacements;
use isosheet_geometry::{BroadPhase, ContactGeometry, ContactMesh, RigidPath, Shape, ShapeError};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::HashMap;

/// Sine of the angle between two faces below which the edge between them is none: a thousand times
/// the round-off of unit normals, and a ridge too low to matter.
const FLAT_SINE: f64 = 1e-12;

/// What of a body meets edges and faces of the sheet; of one that is not convex vertices as well.
#[derive(Debug, Clone)]
pub(super) struct Features {
    phase: BroadPhase,
    /// In the body's frame.
    points: Vec<Vector3<f64>>,
    pub(super) radius: f64,
    /// Largest distance of a point from the origin of the frame.
    pub(super) extent: f64,
    /// Vertices and edges that are no corner: inside a flat facet.
    flat_vertices: Vec<bool>,
    flat_edges: Vec<bool>,
    /// Places of the points in space at the start and at the end of a motion.
    start: Vec<f64>,
    end: Vec<f64>,
    /// What the boxes are enlarged by, metres.
    inflation: f64,
    /// The place and the inflation for which the boxes of a body at rest were made.
    resting: Option<(Isometry3<f64>, f64)>,
    /// Where, and with what inflation, the tree of the boxes is that of a body that does not move.
    resting_tree: Option<(Isometry3<f64>, f64)>,
    /// Start and end of the motion for which lists of neighbours were made, and what its boxes were enlarged
    /// by.
    listed: [Vec<f64>; 2],
    listed_inflation: f64,
    /// Beyond the boxes of that motion.
    displacements: Displacements,
}

/// Whether the centre of a ball and the ends of the axis of a capsule are edges without length besides: what
/// meets the axes of capsules that respond, which have neither faces nor other edges beside them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    /// They are points alone.
    Points,
    /// They are.
    Edges,
}

impl Features {
    pub(super) fn new(
        shape: &Shape,
        segments: usize,
        ends: Ends,
    ) -> Result<Option<Self>, ShapeError> {
        let Some(mut geometry) = shape.contact_geometry(segments)? else {
            return Ok(None);
        };
        if ends == Ends::Edges && geometry.radius > 0.0 {
            geometry.mesh = geometry.mesh.with_points_as_edges();
        }
        let ContactGeometry {
            mesh,
            positions,
            radius,
        } = geometry;
        let points = positions.as_chunks::<3>().0.iter();
        let points: Vec<Vector3<f64>> = points.map(|p| Vector3::from(*p)).collect();
        let flat_edges = flat_edges(&mesh, &points);
        let mut flat_vertices = vec![false; points.len()];
        for &v in mesh.faces().iter().flatten() {
            flat_vertices[v as usize] = true;
        }
        for (edge, _) in mesh.edges().iter().zip(&flat_edges).filter(|(_, f)| !**f) {
            for &v in edge {
                flat_vertices[v as usize] = false;
            }
        }
        // The faces of a convex body are looked after by its signed distance.
        let (mesh, flat_edges) = if shape.is_convex() {
            let mut flat = flat_edges.iter();
            let mesh = mesh.without_faces(|_| flat.next() == Some(&false));
            let kept = mesh.edges().len();
            (mesh, vec![false; kept])
        } else {
            (mesh, flat_edges)
        };
        Ok(Some(Self {
            phase: BroadPhase::new(mesh, &positions),
            extent: points.iter().map(|p| p.norm()).fold(0.0, f64::max),
            points,
            radius,
            flat_vertices,
            flat_edges,
            end: positions.clone(),
            listed: [positions.clone(), positions.clone()],
            displacements: Displacements::beyond([&positions; 2], &positions, &positions),
            start: positions,
            inflation: 0.0,
            listed_inflation: 0.0,
            resting: None,
            resting_tree: None,
        }))
    }

    /// Sets the boxes for a motion, for pairs with a sheet within `reach`, metres; boxes of a resting body
    /// stay.
    pub(super) fn place(&mut self, part: &RigidPath, reach: f64) {
        // Half of the reach, the radius, and the bulge of the paths of a turning body.
        let inflation = 0.5 * reach + self.radius + part.sagitta(self.extent);
        let pose = part.pose_at(0.0);
        let resting = (!part.moves()).then_some((pose, inflation));
        if resting.is_some() && resting == self.resting {
            return;
        }
        place_all(&self.points, &pose, &mut self.start);
        place_all(&self.points, &part.pose_at(1.0), &mut self.end);
        (self.inflation, self.resting) = (inflation, resting);
        self.phase.update_boxes(&self.start, &self.end, inflation);
        self.displacements = Displacements::beyond(
            self.listed.each_ref().map(Vec::as_slice),
            &self.start,
            &self.end,
        );
    }

    /// Displacements beyond the boxes of the motion that lists were made for.
    pub(super) fn displacements(&self) -> &Displacements {
        &self.displacements
    }

    /// How much more the boxes are enlarged than the boxes of the motion that lists were made for, metres.
    pub(super) fn growth(&self) -> f64 {
        (self.inflation - self.listed_inflation).max(0.0)
    }

    /// The boxes with their tree, for lists of the motion.
    pub(super) fn list(&mut self) -> &BroadPhase {
        let Self { start, end, .. } = self;
        for (listed, place) in self.listed.iter_mut().zip([&*start, &*end]) {
            listed.copy_from_slice(place);
        }
        self.listed_inflation = self.inflation;
        self.displacements = Displacements::beyond([start, end], start, end);
        if self.resting.is_none() || self.resting != self.resting_tree {
            self.phase.update(start, end, self.inflation);
            self.resting_tree = self.resting;
        }
        &self.phase
    }

    /// The boxes.
    pub(super) fn phase(&self) -> &BroadPhase {
        &self.phase
    }

    /// The corners of a face, in the body's frame.
    pub(super) fn face(&self, f: u32) -> [Vector3<f64>; 3] {
        self.corners(self.phase.mesh().faces()[f as usize])
    }

    /// The ends of an edge, in the body's frame.
    pub(super) fn edge(&self, e: u32) -> [Vector3<f64>; 2] {
        self.corners(self.phase.mesh().edges()[e as usize])
    }

    /// A corner, in the body's frame.
    pub(super) fn vertex(&self, v: u32) -> Vector3<f64> {
        self.points[v as usize]
    }

    /// Whether a vertex is inside a flat facet.
    pub(super) fn is_flat_vertex(&self, v: u32) -> bool {
        self.flat_vertices[v as usize]
    }

    /// Whether an edge is a point.
    pub(super) fn is_point(&self, e: u32) -> bool {
        let [a, b] = self.phase.mesh().edges()[e as usize];
        a == b
    }

    /// Whether an edge is inside a flat facet.
    pub(super) fn is_flat_edge(&self, e: u32) -> bool {
        self.flat_edges[e as usize]
    }

    fn corners<const N: usize>(&self, vertices: [u32; N]) -> [Vector3<f64>; N] {
        vertices.map(|v| self.points[v as usize])
    }
}

/// Edges between exactly two faces that lie in one plane on opposite sides of it.
fn flat_edges(mesh: &ContactMesh, points: &[Vector3<f64>]) -> Vec<bool> {
    let mut sides: HashMap<[u32; 2], Vec<Vector3<f64>>> = HashMap::new();
    for &[a, b, c] in mesh.faces() {
        let [p, q, r] = [a, b, c].map(|v| points[v as usize]);
        let normal = (q - p).cross(&(r - p)).normalize();
        for [i, j] in [[a, b], [b, c], [c, a]] {
            // Turned so that two faces on opposite sides of the edge agree.
            let sign = if i < j { 1.0 } else { -1.0 };
            sides
                .entry([i.min(j), i.max(j)])
                .or_default()
                .push(sign * normal);
        }
    }
    mesh.edges()
        .iter()
        .map(|&[a, b]| match sides.get(&[a.min(b), a.max(b)]) {
            // Run through in opposite directions, the two entries have opposite signs.
            Some(n) if n.len() == 2 => {
                n[0].dot(&n[1]) < 0.0 && n[0].cross(&n[1]).norm() < FLAT_SINE
            }
            _ => false,
        })
        .collect()
}

fn place_all(points: &[Vector3<f64>], pose: &Isometry3<f64>, out: &mut [f64]) {
    for (p, q) in points.iter().zip(out.as_chunks_mut::<3>().0) {
        *q = (pose * Point3::from(*p)).coords.into();
    }
}
