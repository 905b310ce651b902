//! The pairs of the sheet and one body.

use super::body::ContactBody;
use super::features::Features;
use super::limit::{Limit, for_each_near};
use super::motion::SheetMotion;
use super::neighbours::Neighbours;
use isosheet_dynamics::contact::{ContactKey, ContactKind};
use isosheet_geometry::distance::{Closest, edge_edge, point_triangle};
use isosheet_geometry::vectors::{gather, smaller};
use isosheet_geometry::{PointCourse, RigidPath};
use nalgebra::Vector3;

impl ContactBody {
    /// Appends the pairs within reach on the motion of the sheet and the given part of the body's, and
    /// shortens the part of it that brings nothing into contact. `neighbours` belong to the motion; `near` is
    /// room.
    pub(super) fn query(
        &self,
        sheet: SheetMotion<'_>,
        neighbours: Option<&Neighbours>,
        part: &RigidPath,
        limit: &Limit,
        near: &mut Vec<bool>,
        pairs: &mut Vec<ContactKey>,
    ) {
        self.query_vertices(sheet, part, limit, pairs);
        if let (Some(neighbours), Some(features)) = (neighbours, self.features()) {
            let check = Check { sheet, part, limit };
            self.query_features(check, (neighbours, features), near, pairs);
        }
    }

    fn query_vertices(
        &self,
        sheet: SheetMotion<'_>,
        part: &RigidPath,
        limit: &Limit,
        pairs: &mut Vec<ContactKey>,
    ) {
        let shape = self.obstacle().shape();
        if !shape.is_convex() {
            return;
        }
        let places = sheet.x.as_chunks::<3>().0.iter();
        let steps = sheet.dx.as_chunks::<3>().0.iter();
        let vertices = (0..).zip(places.zip(steps));
        for (v, (x, dx)) in vertices.filter(|(v, _)| sheet.meets_bodies(*v)) {
            let course = part.course(&Vector3::from(*x), &Vector3::from(*dx));
            let clearance = sheet.of_obstacle(v);
            let distance = shape.signed_distance(&part.now(&course)).value;
            let nearest = distance - course.reach(part);
            if nearest > clearance.reach {
                continue;
            }
            pairs.push(self.key(ContactKind::Vertex, [v, 0]));
            if nearest > clearance.trigger_distance() {
                continue;
            }
            let support = |[p]: &[Vector3<f64>; 1]| {
                let d = shape.signed_distance(p);
                (d.normal, d.normal.dot(p) - d.value)
            };
            let ccd = clearance.ccd(sheet.ccd);
            limit.shorten(|limit| part.advance(&ccd, &[course], limit, support));
        }
    }

    fn query_features(
        &self,
        check: Check<'_>,
        (neighbours, features): (&Neighbours, &Features),
        near: &mut Vec<bool>,
        pairs: &mut Vec<ContactKey>,
    ) {
        let candidates = neighbours.with_body(self.number() as usize);
        let (own, others) = (neighbours.boxes(), features.phase());
        let radius = features.radius;
        let Check { sheet, part, .. } = check;
        let course = |v: u32| {
            let ([x], [dx]) = (gather(sheet.x, [v]), gather(sheet.dx, [v]));
            part.course(&x, &dx)
        };
        let mut take = |kind, pair| pairs.push(self.key(kind, pair));
        let is_near = |[v, f]: [u32; 2]| {
            if !sheet.meets_bodies(v) || !own.vertex_meets_face(others, [v, f]) {
                return false;
            }
            let corners = features.face(f);
            check.is_near(v, &[course(v)], |[p]| {
                let [a, b, c] = corners;
                let closest = point_triangle(&[*p, a, b, c]);
                support(&closest, 1.0, &corners, radius)
            })
        };
        for_each_near(&candidates.vertex_face, near, is_near, |pair| {
            take(ContactKind::VertexFace, pair);
        });
        let is_near = |[f, v]: [u32; 2]| {
            let corners = sheet.mesh.faces()[f as usize];
            if features.is_flat_vertex(v)
                || !sheet.meets_bodies(corners[0])
                || !others.vertex_meets_face(own, [v, f])
            {
                return false;
            }
            let corner = features.vertex(v);
            let courses = corners.map(course);
            check.is_near(corners[0], &courses, |[p, q, r]| {
                let closest = point_triangle(&[corner, *p, *q, *r]);
                support(&closest, -1.0, &[corner], radius)
            })
        };
        for_each_near(&candidates.face_vertex, near, is_near, |pair| {
            take(ContactKind::FaceVertex, pair);
        });
        let is_near = |[e, g]: [u32; 2]| {
            let own_ends = sheet.mesh.edges()[e as usize];
            if features.is_flat_edge(g)
                || sheet.mesh.is_point(e)
                || features.is_point(g) && !sheet.mesh.is_axis(e)
                || !sheet.meets_bodies(own_ends[0])
                || !own.edge_meets_edge(others, [e, g])
            {
                return false;
            }
            let ends = features.edge(g);
            let courses = own_ends.map(course);
            check.is_near(own_ends[0], &courses, |[p, q]| {
                let [c, d] = ends;
                let closest = edge_edge(&[*p, *q, c, d]);
                support(&closest, 1.0, &ends, radius)
            })
        };
        for_each_near(&candidates.edge_edge, near, is_near, |pair| {
            take(ContactKind::EdgeEdge, pair);
        });
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
#[derive(Clone, Copy)]
struct Check<'a> {
    sheet: SheetMotion<'a>,
    part: &'a RigidPath,
    limit: &'a Limit,
}

impl Check<'_> {
    /// Whether the pair of a primitive with this vertex may come within reach. Shortens the motion to what is
    /// safe for it.
    fn is_near<const N: usize>(
        &self,
        vertex: u32,
        courses: &[PointCourse; N],
        support: impl Fn(&[Vector3<f64>; N]) -> (Vector3<f64>, f64),
    ) -> bool {
        let clearance = self.sheet.of_obstacle(vertex);
        let places = courses.each_ref().map(|c| self.part.now(c));
        let (n, height) = support(&places);
        // The distance from the separating plane is not more than that of the primitives.
        let clearances = places.iter().map(|p| n.dot(p) - height);
        // Not a number where the closest points coincide: a pair that touches.
        let distance = clearances.fold(f64::INFINITY, smaller);
        let moved = courses.iter().map(|c| c.reach(self.part));
        let nearest = distance - moved.fold(0.0, f64::max);
        if nearest > clearance.reach {
            return false;
        }
        if nearest <= clearance.trigger_distance() || nearest.is_nan() {
            let ccd = clearance.ccd(self.sheet.ccd);
            let advance = |limit| self.part.advance(&ccd, courses, limit, support);
            self.limit.shorten(advance);
        }
        true
    }
}
