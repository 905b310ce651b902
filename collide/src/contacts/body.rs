//! Contact of the sheet with one body.

use super::options::Coefficients;
use super::path::{Course, RestOfStep, StepMotion};
use super::touch::{Key, Kind, Parallel, Touch};
use crate::distance::{Closest, edge_edge, point_triangle};
use crate::narrow_phase::smaller;
use crate::{
    BroadPhase, CcdOptions, ContactGeometry, ContactMesh, CrossCandidates, Obstacle, ObstacleError,
    ParallelMollifier, Shape,
};
use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};

/// Sine of the angle between two faces below which the edge between them is none: a thousand times
/// the round-off of unit normals, and a ridge too low to matter.
const FLAT_SINE: f64 = 1e-12;

/// Directions of an axis closer than this are the same but for the round-off of a quaternion.
const SAME_AXIS: f64 = 1e-14;

/// A body and the pairs of it and the sheet that are within reach on the present motion.
#[derive(Debug, Clone)]
pub(super) struct Body {
    obstacle: Obstacle,
    number: u32,
    pub(super) coefficients: Coefficients,
    /// Motion of the material.
    motion: StepMotion,
    /// Motion of the form: the same but for the spin of a round body about its own axis.
    form: StepMotion,
    /// Pose of the material now.
    material: Isometry3<f64>,
    /// Pose of the form now.
    origin: Vector3<f64>,
    frame: Matrix3<f64>,
    features: Option<Features>,
    /// Vertices of the sheet near a convex body, which they meet by its signed distance.
    vertices: Vec<u32>,
    pairs: CrossCandidates,
}

/// What of a body meets edges and faces of the sheet; of a triangle surface vertices as well.
#[derive(Debug, Clone)]
struct Features {
    phase: BroadPhase,
    /// In the body's frame.
    points: Vec<Vector3<f64>>,
    radius: f64,
    /// Largest distance of a point from the origin of the frame.
    extent: f64,
    /// Vertices and edges that are no corner: inside a flat facet.
    flat_vertices: Vec<bool>,
    flat_edges: Vec<bool>,
    /// Places of the points in space now and at the end.
    now: Vec<f64>,
    end: Vec<f64>,
    /// Where and with what inflation the boxes are those of a body that does not move.
    boxed: Option<(Isometry3<f64>, f64)>,
}

/// What the search for pairs needs to know about the sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct SheetMotion<'a> {
    pub(super) mesh: &'a ContactMesh,
    pub(super) x: &'a [f64],
    pub(super) dx: &'a [f64],
    /// Distance below which the barrier acts, metres.
    pub(super) reach: f64,
    pub(super) ccd: &'a CcdOptions,
    /// Squared rest lengths of the edges.
    pub(super) lengths2: &'a [f64],
}

/// The vertex with a number.
pub(super) fn point(x: &[f64], v: u32) -> Vector3<f64> {
    let i = 3 * v as usize;
    Vector3::new(x[i], x[i + 1], x[i + 2])
}

impl Features {
    fn new(shape: &Shape, segments: usize) -> Result<Option<Self>, ObstacleError> {
        let Some(geometry) = shape.contact_geometry(segments)? else {
            return Ok(None);
        };
        let ContactGeometry {
            mesh,
            positions,
            radius,
        } = geometry;
        let points: Vec<Vector3<f64>> = positions
            .as_chunks::<3>()
            .0
            .iter()
            .map(|p| Vector3::from(*p))
            .collect();
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
        let (mesh, flat_edges) = if matches!(shape, Shape::Surface(_)) {
            (mesh, flat_edges)
        } else {
            let mut flat = flat_edges.iter();
            let mesh = mesh.without_faces(|_| flat.next() == Some(&false));
            let kept = mesh.edges().len();
            (mesh, vec![false; kept])
        };
        Ok(Some(Self {
            phase: BroadPhase::new(mesh, &positions),
            extent: points.iter().map(|p| p.norm()).fold(0.0, f64::max),
            points,
            radius,
            flat_vertices,
            flat_edges,
            end: positions.clone(),
            now: positions,
            boxed: None,
        }))
    }

    /// Boxes of the motion; those of a resting body stay.
    fn set_boxes(&mut self, rest: &RestOfStep, inflation: f64) {
        let pose = rest.pose_at(0.0);
        let boxed = (!rest.moves()).then_some((pose, inflation));
        if boxed.is_some() && boxed == self.boxed {
            return;
        }
        place_all(&self.points, &pose, &mut self.now);
        place_all(&self.points, &rest.pose_at(1.0), &mut self.end);
        self.phase.update(&self.now, &self.end, inflation);
        self.boxed = boxed;
    }

    fn corners<const N: usize>(&self, vertices: [u32; N]) -> [Vector3<f64>; N] {
        vertices.map(|v| self.points[v as usize])
    }
}

/// Edges between exactly two faces that lie in one plane on opposite sides of it.
fn flat_edges(mesh: &ContactMesh, points: &[Vector3<f64>]) -> Vec<bool> {
    let mut sides: std::collections::HashMap<[u32; 2], Vec<Vector3<f64>>> =
        std::collections::HashMap::new();
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

impl Body {
    pub(super) fn new(
        obstacle: Obstacle,
        number: u32,
        coefficients: Coefficients,
        segments: usize,
    ) -> Result<Self, ObstacleError> {
        let pose = obstacle.motion().pose(0.0);
        let mut body = Self {
            features: Features::new(obstacle.shape(), segments)?,
            obstacle,
            number,
            coefficients,
            motion: StepMotion::new(pose, pose),
            form: StepMotion::new(pose, pose),
            material: pose,
            origin: Vector3::zeros(),
            frame: Matrix3::identity(),
            vertices: Vec::new(),
            pairs: CrossCandidates::default(),
        };
        body.begin(0.0, 0.0);
        body.place(1.0);
        Ok(body)
    }

    pub(super) fn obstacle(&self) -> &Obstacle {
        &self.obstacle
    }

    /// Whether the search for pairs needs the boxes of the sheet.
    pub(super) fn has_features(&self) -> bool {
        self.features.is_some()
    }

    /// The motion of the step from `t0` to `t1`.
    pub(super) fn begin(&mut self, t0: f64, t1: f64) {
        let motion = self.obstacle.motion();
        let (start, end) = (motion.pose(t0), motion.pose(t1));
        self.motion = StepMotion::new(start, end);
        self.form = StepMotion::new(self.without_spin(start), self.without_spin(end));
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

    /// Whether the body moves in this step, if only by spinning.
    pub(super) fn moves(&self) -> bool {
        self.motion.moves()
    }

    /// The rest of the step after progress `s`, as far as the place of the surface is concerned.
    pub(super) fn rest(&self, s: f64) -> RestOfStep {
        self.form.rest(s)
    }

    /// Moves the body to progress `s` of the step.
    pub(super) fn place(&mut self, s: f64) {
        self.material = self.motion.pose(s);
        let pose = self.form.pose(s);
        self.origin = pose.translation.vector;
        self.frame = pose.rotation.to_rotation_matrix().into_inner();
    }

    /// Origin of the body's frame now, metres.
    pub(super) fn origin(&self) -> &Vector3<f64> {
        &self.origin
    }

    /// Velocity of the surface now at a place in space times the duration of the step, metres.
    pub(super) fn step_velocity(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.form.velocity(&(place - self.origin))
    }

    /// Rotation vector of the step, radians.
    pub(super) fn step_turn(&self) -> Vector3<f64> {
        self.form.turn()
    }

    /// A point of the form in its own frame, from its place now.
    pub(super) fn local(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.frame.tr_mul(&(place - self.origin))
    }

    /// The place now of a point of the form.
    pub(super) fn in_space(&self, local: &Vector3<f64>) -> Vector3<f64> {
        self.frame * local + self.origin
    }

    /// The material point that is at a place now, in the frame of the material.
    pub(super) fn material_point(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.material
            .inverse_transform_point(&Point3::from(*place))
            .coords
    }

    /// The place now of a material point.
    pub(super) fn material_place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        moved(&self.material, point)
    }

    /// Displacement of a material point from the start of the step to the end.
    pub(super) fn displacement(&self, point: &Vector3<f64>) -> Vector3<f64> {
        moved(self.motion.end(), point) - moved(self.motion.start(), point)
    }

    /// Displacement of a material point since the start of the step.
    pub(super) fn displacement_so_far(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.material_place(point) - moved(self.motion.start(), point)
    }

    /// Collects the pairs within reach on the motion of the sheet and the given rest of the body's,
    /// and returns the part of it, up to `limit`, that brings nothing into contact. `sheet_boxes` are
    /// those of the whole motion, enlarged by half the reach.
    pub(super) fn search(
        &mut self,
        sheet: SheetMotion<'_>,
        sheet_boxes: Option<&BroadPhase>,
        rest: &RestOfStep,
        limit: f64,
    ) -> f64 {
        let mut limit = self.search_vertices(sheet, rest, limit);
        if let Some(boxes) = sheet_boxes {
            self.search_features(sheet, boxes, rest, &mut limit);
        }
        limit
    }

    fn search_vertices(&mut self, sheet: SheetMotion<'_>, rest: &RestOfStep, limit: f64) -> f64 {
        self.vertices.clear();
        let shape = self.obstacle.shape();
        if matches!(shape, Shape::Surface(_)) {
            return limit;
        }
        let mut limit = limit;
        let places = sheet.x.as_chunks::<3>().0.iter();
        let steps = sheet.dx.as_chunks::<3>().0.iter();
        for (v, (x, dx)) in (0..).zip(places.zip(steps)) {
            let course = rest.course(&Vector3::from(*x), &Vector3::from(*dx));
            let distance = shape.signed_distance(&rest.now(&course)).value;
            let nearest = distance - course.reach(rest);
            if nearest > sheet.reach {
                continue;
            }
            self.vertices.push(v);
            // Half-way is far more than round-off can be.
            if nearest > sheet.ccd.separation + 0.5 * (sheet.reach - sheet.ccd.separation) {
                continue;
            }
            limit = rest.advance(sheet.ccd, &[course], limit, |[p]| {
                let d = shape.signed_distance(p);
                (d.normal, d.normal.dot(p) - d.value)
            });
        }
        limit
    }

    fn search_features(
        &mut self,
        sheet: SheetMotion<'_>,
        sheet_boxes: &BroadPhase,
        rest: &RestOfStep,
        limit: &mut f64,
    ) {
        let Some(features) = &mut self.features else {
            return;
        };
        // Half of the reach, the radius, and the bulge of the paths of a turning body.
        let inflation = 0.5 * sheet.reach + features.radius + rest.sagitta(features.extent);
        features.set_boxes(rest, inflation);
        sheet_boxes.candidates_with(&features.phase, &mut self.pairs);
        let features: &Features = features;
        let body_mesh = features.phase.mesh();
        let (x, dx, radius) = (sheet.x, sheet.dx, features.radius);
        let course = |v: u32| rest.course(&point(x, v), &point(dx, v));
        // Keeps a pair that may come within reach, and shortens the motion if it may touch.
        let mut check = Check { sheet, rest, limit };
        self.pairs.vertex_face.retain(|&[v, f]| {
            let corners = features.corners(body_mesh.faces()[f as usize]);
            check.keep(&[course(v)], |[p]| {
                let [a, b, c] = corners;
                let closest = point_triangle(&[*p, a, b, c]);
                support(&closest, 1.0, &corners, radius)
            })
        });
        self.pairs.face_vertex.retain(|&[f, v]| {
            if features.flat_vertices[v as usize] {
                return false;
            }
            let corners = features.corners([v]);
            check.keep(&sheet.mesh.faces()[f as usize].map(course), |[p, q, r]| {
                let closest = point_triangle(&[corners[0], *p, *q, *r]);
                support(&closest, -1.0, &corners, radius)
            })
        });
        self.pairs.edge_edge.retain(|&[e, g]| {
            if features.flat_edges[g as usize] {
                return false;
            }
            let corners = features.corners(body_mesh.edges()[g as usize]);
            check.keep(&sheet.mesh.edges()[e as usize].map(course), |[p, q]| {
                let [c, d] = corners;
                let closest = edge_edge(&[*p, *q, c, d]);
                support(&closest, 1.0, &corners, radius)
            })
        });
    }

    /// The pairs, for tests that look at them one by one.
    #[cfg(test)]
    pub(super) fn pairs_mut(&mut self) -> (&mut Vec<u32>, &mut CrossCandidates) {
        (&mut self.vertices, &mut self.pairs)
    }

    /// Adds the contacts within reach at `x` with the body where it is now.
    pub(super) fn touches(&self, sheet: SheetMotion<'_>, out: &mut Vec<Touch>) {
        let x = sheet.x;
        let thickness = sheet.ccd.separation;
        let activation = sheet.reach - thickness;
        let shape = self.obstacle.shape();
        let key = |kind, pair| Key {
            body: Some(self.number),
            kind,
            pair,
        };
        for &v in &self.vertices {
            let p = self.local(&point(x, v));
            let d = shape.signed_distance(&p);
            let gap = d.value - thickness;
            if gap >= activation {
                continue;
            }
            out.push(Touch {
                key: key(Kind::Vertex, [v, 0]),
                vertices: [v; 4],
                weights: [1.0, 0.0, 0.0, 0.0],
                normal: self.frame * d.normal,
                gap,
                foot: self.in_space(&d.closest(&p)),
                parallel: None,
            });
        }
        let Some(features) = &self.features else {
            return;
        };
        let body_mesh = features.phase.mesh();
        let near = |distance: f64| {
            let gap = distance - features.radius - thickness;
            (gap < activation || gap.is_nan()).then_some(gap)
        };
        let local = |v: u32| self.local(&point(x, v));
        // From the difference of the closest points, body to sheet, to the contact.
        let make =
            |key, vertices, weights: [f64; 4], n: Vector3<f64>, foot: Vector3<f64>, gap| Touch {
                key,
                vertices,
                weights,
                normal: self.frame * n,
                gap,
                foot: self.in_space(&(foot + features.radius * n)),
                parallel: None,
            };
        for &[v, f] in &self.pairs.vertex_face {
            let p = local(v);
            let [a, b, c] = features.corners(body_mesh.faces()[f as usize]);
            let closest = point_triangle(&[p, a, b, c]);
            let distance = closest.distance();
            if let Some(gap) = near(distance) {
                let foot = p - closest.difference;
                let n = closest.difference / distance;
                let weights = [1.0, 0.0, 0.0, 0.0];
                let key = key(Kind::VertexFace, [v, f]);
                out.push(make(key, [v; 4], weights, n, foot, gap));
            }
        }
        for &[f, v] in &self.pairs.face_vertex {
            let face = sheet.mesh.faces()[f as usize];
            let ([p, q, r], [b]) = (face.map(local), features.corners([v]));
            let closest = point_triangle(&[b, p, q, r]);
            let distance = closest.distance();
            if let Some(gap) = near(distance) {
                let n = -closest.difference / distance;
                let [_, wp, wq, wr] = closest.weights;
                let vertices = [face[0], face[1], face[2], face[0]];
                let key = key(Kind::FaceVertex, [f, v]);
                out.push(make(key, vertices, [-wp, -wq, -wr, 0.0], n, b, gap));
            }
        }
        for &[e, g] in &self.pairs.edge_edge {
            let edge = sheet.mesh.edges()[e as usize];
            let ([p, q], [c, d]) = (
                edge.map(local),
                features.corners(body_mesh.edges()[g as usize]),
            );
            let closest = edge_edge(&[p, q, c, d]);
            let distance = closest.distance();
            if let Some(gap) = near(distance) {
                let n = closest.difference / distance;
                let [wp, wq, wc, wd] = closest.weights;
                let foot = -wc * c - wd * d;
                let vertices = [edge[0], edge[1], edge[0], edge[0]];
                let key = key(Kind::EdgeEdge, [e, g]);
                let touch = make(key, vertices, [wp, wq, 0.0, 0.0], n, foot, gap);
                let (u, v) = (self.frame * (q - p), self.frame * (d - c));
                let length2 = sheet.lengths2[e as usize];
                let mollifier = ParallelMollifier::new(length2, v.norm_squared());
                let parallel = Parallel::new(u, v, &mollifier);
                out.push(Touch { parallel, ..touch });
            }
        }
    }
}

fn moved(pose: &Isometry3<f64>, local: &Vector3<f64>) -> Vector3<f64> {
    (pose * Point3::from(*local)).coords
}

fn place_all(points: &[Vector3<f64>], pose: &Isometry3<f64>, out: &mut [f64]) {
    for (p, q) in points.iter().zip(out.as_chunks_mut::<3>().0) {
        *q = moved(pose, p).into();
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
    rest: &'a RestOfStep,
    limit: &'a mut f64,
}

impl Check<'_> {
    /// Whether the pair may come within reach. Shortens the motion to what is safe for it.
    fn keep<const N: usize>(
        &mut self,
        courses: &[Course; N],
        support: impl Fn(&[Vector3<f64>; N]) -> (Vector3<f64>, f64),
    ) -> bool {
        let places = courses.each_ref().map(|c| self.rest.now(c));
        let (n, height) = support(&places);
        // The distance from the separating plane is not more than that of the primitives.
        let lowest = places.iter().map(|p| n.dot(p) - height);
        // Not a number where the closest points coincide: a pair that touches.
        let distance = lowest.fold(f64::INFINITY, smaller);
        let moved = courses.iter().map(|c| c.reach(self.rest));
        let nearest = distance - moved.fold(0.0, f64::max);
        if nearest > self.sheet.reach {
            return false;
        }
        let separation = self.sheet.ccd.separation;
        if nearest <= separation + 0.5 * (self.sheet.reach - separation) || nearest.is_nan() {
            let advanced = self
                .rest
                .advance(self.sheet.ccd, courses, *self.limit, support);
            *self.limit = advanced;
        }
        true
    }
}
