//! The pairs of the sheet and one body.

use super::features::Features;
use super::neighbours::Neighbours;
use super::path::{Course, PartOfStep};
use super::sheet::SheetMotion;
use crate::distance::{Closest, edge_edge, point_triangle};
use crate::narrow_phase::{gather, smaller};
use crate::{Obstacle, ObstacleError, Shape};
use isosheet_dynamics::contact::{BodyMotion, ContactKey, ContactKind, StepMotion, StepSpan};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// Directions of an axis closer than this are the same but for the round-off of a quaternion.
const SAME_AXIS: f64 = 1e-14;

/// A body of a scene.
#[derive(Debug, Clone)]
pub(super) struct Body {
    obstacle: Obstacle,
    number: u32,
    features: Option<Features>,
}

impl Body {
    pub(super) fn new(
        obstacle: Obstacle,
        number: u32,
        segments: usize,
    ) -> Result<Self, ObstacleError> {
        Ok(Self {
            features: Features::new(obstacle.shape(), segments)?,
            obstacle,
            number,
        })
    }

    pub(super) fn obstacle(&self) -> &Obstacle {
        &self.obstacle
    }

    /// Corners, edges and faces, if it has any.
    pub(super) fn features(&self) -> Option<&Features> {
        self.features.as_ref()
    }

    /// The same, to be moved.
    pub(super) fn features_mut(&mut self) -> Option<&mut Features> {
        self.features.as_mut()
    }

    /// The motion over a span of time.
    pub(super) fn motion_over(&self, span: StepSpan) -> BodyMotion {
        let motion = self.obstacle.motion();
        let (start, end) = (motion.pose(span.t0), motion.pose(span.t0 + span.h));
        BodyMotion {
            material: StepMotion::new(start, end),
            surface: StepMotion::new(self.without_spin(start), self.without_spin(end)),
        }
    }

    /// A pose with the same place of the surface: for a body that is round about its z axis the
    /// orientation that the shortest turn of the axis from the pose at time zero leads to, so that it
    /// stays while the body spins; for a ball none.
    fn without_spin(&self, pose: Isometry3<f64>) -> Isometry3<f64> {
        let rotation = match self.obstacle.shape() {
            Shape::Cuboid { .. } | Shape::Surface(_) => pose.rotation,
            Shape::Sphere { .. } => UnitQuaternion::identity(),
            Shape::HalfSpace | Shape::Cylinder { .. } | Shape::Capsule { .. } => {
                let first = self.obstacle.motion().pose(0.0).rotation;
                let (before, after) = (first * Vector3::z(), pose.rotation * Vector3::z());
                if (after - before).amax() <= SAME_AXIS {
                    first
                } else {
                    match UnitQuaternion::rotation_between(&before, &after) {
                        Some(swing) => swing * first,
                        // Upside down: any half turn leads there.
                        None => pose.rotation,
                    }
                }
            }
        };
        Isometry3::from_parts(pose.translation, rotation)
    }

    fn key(&self, kind: ContactKind, pair: [u32; 2]) -> ContactKey {
        ContactKey {
            body: Some(self.number),
            kind,
            pair,
        }
    }

    /// Appends the pairs within reach on the motion of the sheet and the given part of the body's,
    /// and returns the part of it, up to `limit`, that brings nothing into contact. `neighbours` are those of
    /// the motion.
    pub(super) fn query(
        &self,
        sheet: SheetMotion<'_>,
        neighbours: Option<&Neighbours>,
        part: &PartOfStep,
        limit: f64,
        pairs: &mut Vec<ContactKey>,
    ) -> f64 {
        let mut limit = self.query_vertices(sheet, part, limit, pairs);
        if let (Some(neighbours), Some(features)) = (neighbours, &self.features) {
            self.query_features(sheet, part, (neighbours, features), &mut limit, pairs);
        }
        limit
    }

    fn query_vertices(
        &self,
        sheet: SheetMotion<'_>,
        part: &PartOfStep,
        limit: f64,
        pairs: &mut Vec<ContactKey>,
    ) -> f64 {
        let shape = self.obstacle.shape();
        if matches!(shape, Shape::Surface(_)) {
            return limit;
        }
        let mut limit = limit;
        let places = sheet.x.as_chunks::<3>().0.iter();
        let steps = sheet.dx.as_chunks::<3>().0.iter();
        for (v, (x, dx)) in (0..).zip(places.zip(steps)) {
            let course = part.course(&Vector3::from(*x), &Vector3::from(*dx));
            let distance = shape.signed_distance(&part.now(&course)).value;
            let nearest = distance - course.reach(part);
            if nearest > sheet.reach {
                continue;
            }
            pairs.push(self.key(ContactKind::Vertex, [v, 0]));
            if nearest > sheet.trigger_distance() {
                continue;
            }
            limit = part.advance(sheet.ccd, &[course], limit, |[p]| {
                let d = shape.signed_distance(p);
                (d.normal, d.normal.dot(p) - d.value)
            });
        }
        limit
    }

    fn query_features(
        &self,
        sheet: SheetMotion<'_>,
        part: &PartOfStep,
        (neighbours, features): (&Neighbours, &Features),
        limit: &mut f64,
        pairs: &mut Vec<ContactKey>,
    ) {
        let candidates = neighbours.with_body(self.number as usize);
        let (own, others) = (neighbours.boxes(), features.phase());
        let radius = features.radius;
        let course = |v: u32| {
            let ([x], [dx]) = (gather(sheet.x, [v]), gather(sheet.dx, [v]));
            part.course(&x, &dx)
        };
        let mut check = Check { sheet, part, limit };
        for &[v, f] in &candidates.vertex_face {
            if !own.vertex_meets_face(others, [v, f]) {
                continue;
            }
            let corners = features.face(f);
            let is_near = check.is_near(&[course(v)], |[p]| {
                let [a, b, c] = corners;
                let closest = point_triangle(&[*p, a, b, c]);
                support(&closest, 1.0, &corners, radius)
            });
            if is_near {
                pairs.push(self.key(ContactKind::VertexFace, [v, f]));
            }
        }
        for &[f, v] in &candidates.face_vertex {
            if features.is_flat_vertex(v) || !others.vertex_meets_face(own, [v, f]) {
                continue;
            }
            let corner = features.vertex(v);
            let courses = sheet.mesh.faces()[f as usize].map(course);
            let is_near = check.is_near(&courses, |[p, q, r]| {
                let closest = point_triangle(&[corner, *p, *q, *r]);
                support(&closest, -1.0, &[corner], radius)
            });
            if is_near {
                pairs.push(self.key(ContactKind::FaceVertex, [f, v]));
            }
        }
        for &[e, g] in &candidates.edge_edge {
            if features.is_flat_edge(g) || !own.edge_meets_edge(others, [e, g]) {
                continue;
            }
            let ends = features.edge(g);
            let courses = sheet.mesh.edges()[e as usize].map(course);
            let is_near = check.is_near(&courses, |[p, q]| {
                let [c, d] = ends;
                let closest = edge_edge(&[*p, *q, c, d]);
                support(&closest, 1.0, &ends, radius)
            });
            if is_near {
                pairs.push(self.key(ContactKind::EdgeEdge, [e, g]));
            }
        }
    }
}

/// Direction from the body to the sheet and the height of the body along it. `sign` is that of the
/// sheet's weights.
fn support<const N: usize>(
    closest: &Closest<4>,
    sign: f64,
    corners: &[Vector3<f64>; N],
    radius: f64,
) -> (Vector3<f64>, f64) {
    let n = sign * closest.difference / closest.distance();
    let heights = corners.iter().map(|q| n.dot(q));
    (n, heights.fold(f64::NEG_INFINITY, f64::max) + radius)
}

/// The two questions about a pair.
struct Check<'a> {
    sheet: SheetMotion<'a>,
    part: &'a PartOfStep,
    limit: &'a mut f64,
}

impl Check<'_> {
    /// Whether the pair may come within reach. Shortens the motion to what is safe for it.
    fn is_near<const N: usize>(
        &mut self,
        courses: &[Course; N],
        support: impl Fn(&[Vector3<f64>; N]) -> (Vector3<f64>, f64),
    ) -> bool {
        let places = courses.each_ref().map(|c| self.part.now(c));
        let (n, height) = support(&places);
        // The distance from the separating plane is not more than that of the primitives.
        let clearances = places.iter().map(|p| n.dot(p) - height);
        // Not a number where the closest points coincide: a pair that touches.
        let distance = clearances.fold(f64::INFINITY, smaller);
        let moved = courses.iter().map(|c| c.reach(self.part));
        let nearest = distance - moved.fold(0.0, f64::max);
        if nearest > self.sheet.reach {
            return false;
        }
        if nearest <= self.sheet.trigger_distance() || nearest.is_nan() {
            let ccd = self.sheet.ccd;
            *self.limit = self.part.advance(ccd, courses, *self.limit, support);
        }
        true
    }
}
