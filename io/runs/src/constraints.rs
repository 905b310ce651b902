//! Curves and surfaces that hold vertices, as bodies of the page.

use isosheet_dynamics::constraint;
use isosheet_dynamics::constraint::{Polyline, Spline};
use isosheet_page::{Body, BodyShape};
use isosheet_scenes::{CurveKey, Hold, Scene, SupportKey, SurfaceKey, frame_motion};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// Radius of the tube that is drawn for a curve, as a part of the half diagonal of the space that the sheet
/// needs: thin, and wider than a line of the drawing.
const TUBE: f64 = 0.006;
/// How far lines and cylinders without ends are drawn, in half diagonals.
const REACH: f64 = 1.5;
/// Sides of a tube, and of a cylinder that holds vertices.
const TUBE_SIDES: usize = 8;
const CYLINDER_SIDES: usize = 64;
/// Points of a circle, and of each part of a polyline or spline.
const CIRCLE_POINTS: usize = 96;
const PART_POINTS: usize = 24;

/// The curves and surfaces of a scene at the times of the frames, whose positions lie in the box between two
/// corners.
pub(super) fn bodies(scene: &Scene, times: &[f64], corners: [[f64; 3]; 2]) -> Vec<Body> {
    let held = HoldingBody::all(scene, corners);
    let body = |held: HoldingBody| {
        let HoldingBody { name, shape, .. } = &held;
        let (name, shape) = (name.as_str(), shape.clone());
        Body::moving(name, shape, times, |t| held.pose(scene, t))
    };
    held.into_iter().map(body).collect()
}

/// A curve or a surface that holds vertices, as it is drawn. Curves are thin tubes; lines, planes and
/// cylinders, which have no ends, are drawn as far as the sheet comes.
#[derive(Debug)]
pub struct HoldingBody {
    /// The key of the support.
    pub name: String,
    /// Its form.
    pub shape: BodyShape,
    /// Where it is while displacements and angle of its motion are zero.
    local: Isometry3<f64>,
    /// The number of the support.
    support: usize,
}

impl HoldingBody {
    /// The bodies that hold the sheet of a scene, which stays in the box between two corners.
    pub fn all(scene: &Scene, corners: [[f64; 3]; 2]) -> Vec<Self> {
        let space = Space::of(corners);
        let body = |(support, entry): (usize, &SupportKey)| {
            let (local, shape) = match &entry.hold {
                Hold::Pin
                | Hold::MovingPin(_)
                | Hold::Follow { .. }
                | Hold::Clamp
                | Hold::MovingClamp(_)
                | Hold::SlidingClamp { .. } => return None,
                Hold::Curve { shape, .. } => {
                    let tube = tube(&points(shape, &space), TUBE * space.radius, TUBE_SIDES);
                    (Isometry3::identity(), tube)
                }
                Hold::Surface { shape, .. } => surface(shape, &space),
            };
            let name = format!("support[{support}]");
            Some(Self {
                name,
                shape,
                local,
                support,
            })
        };
        let supports = scene.support.iter().enumerate();
        supports.filter_map(body).collect()
    }

    /// Where it is at time `t` (seconds) in its scene, in which its motion may have been changed since.
    pub fn pose(&self, scene: &Scene, t: f64) -> Isometry3<f64> {
        let hold = scene.support.get(self.support).map(|s| &s.hold);
        let motion = match hold {
            Some(Hold::Curve { motion, .. } | Hold::Surface { motion, .. }) => frame_motion(motion),
            _ => None,
        };
        match motion {
            None => self.local,
            Some(motion) => motion.pose(t) * self.local,
        }
    }
}

/// The ball that holds the sheet in all frames.
struct Space {
    centre: Vector3<f64>,
    radius: f64,
}

impl Space {
    fn of(corners: [[f64; 3]; 2]) -> Self {
        let [low, high] = corners.map(Vector3::from);
        Self {
            centre: 0.5 * (low + high),
            radius: 0.5 * (high - low).norm(),
        }
    }

    /// The part of a straight line that is drawn.
    fn part(&self, point: [f64; 3], direction: [f64; 3]) -> Vec<Vector3<f64>> {
        let (point, direction) = (
            Vector3::from(point),
            Vector3::from(direction).normalize() * REACH * self.radius,
        );
        let along = (self.centre - point).dot(&direction) / direction.norm_squared();
        let middle = point + along * direction;
        vec![middle - direction, middle + direction]
    }
}

/// Points of a curve, close enough to be joined by straight lines; the first is repeated at the end of a
/// closed curve.
fn points(curve: &CurveKey, space: &Space) -> Vec<Vector3<f64>> {
    match curve {
        CurveKey::Line { point, direction } => space.part(*point, *direction),
        CurveKey::Circle {
            centre,
            normal,
            radius,
        } => {
            let turn = along_z(*normal);
            let on_circle = |k: usize| {
                let (s, c) = (TAU * k as f64 / CIRCLE_POINTS as f64).sin_cos();
                Vector3::from(*centre) + turn * Vector3::new(radius * c, radius * s, 0.0)
            };
            (0..=CIRCLE_POINTS).map(on_circle).collect()
        }
        CurveKey::Polyline {
            points,
            corner_radius,
        } => match Polyline::new(points, *corner_radius) {
            Ok(curve) => projected(&curve, points),
            Err(_) => Vec::new(),
        },
        CurveKey::Spline { points } => match Spline::open(points) {
            Ok(curve) => projected(&curve, points),
            Err(_) => Vec::new(),
        },
        CurveKey::ClosedSpline { points } => match Spline::closed(points) {
            Ok(curve) => {
                let mut points = points.clone();
                points.extend(points.first().copied());
                projected(&curve, &points)
            }
            Err(_) => Vec::new(),
        },
    }
}

/// The points of a curve that are closest to points of the straight lines between its own points.
fn projected(curve: &dyn constraint::Curve, points: &[[f64; 3]]) -> Vec<Vector3<f64>> {
    let parts = points.windows(2).flat_map(|ends| {
        let [a, b] = [ends[0], ends[1]].map(Vector3::from);
        (0..=PART_POINTS).map(move |k| a.lerp(&b, k as f64 / PART_POINTS as f64))
    });
    let mut found: Vec<Vector3<f64>> = parts.map(|p| curve.closest(&p).position).collect();
    found.dedup();
    found
}

/// A surface in its own frame, and where this is.
fn surface(surface: &SurfaceKey, space: &Space) -> (Isometry3<f64>, BodyShape) {
    match *surface {
        SurfaceKey::Plane { point, normal } => {
            let pose = Isometry3::from_parts(Translation3::from(point), along_z(normal));
            (pose, BodyShape::HalfSpace)
        }
        SurfaceKey::Sphere { centre, radius } => (
            Isometry3::from(Translation3::from(centre)),
            BodyShape::Sphere { radius },
        ),
        SurfaceKey::Cylinder {
            point,
            axis,
            radius,
        } => {
            let tube = tube(&space.part(point, axis), radius, CYLINDER_SIDES);
            (Isometry3::identity(), tube)
        }
    }
}

/// A rotation that takes the z axis to a direction.
fn along_z(direction: [f64; 3]) -> UnitQuaternion<f64> {
    let direction = Vector3::from(direction);
    let half_turn = || UnitQuaternion::from_axis_angle(&Vector3::x_axis(), TAU / 2.0);
    UnitQuaternion::rotation_between(&Vector3::z(), &direction).unwrap_or_else(half_turn)
}

/// A tube around points, open at its ends.
fn tube(points: &[Vector3<f64>], radius: f64, sides: usize) -> BodyShape {
    let mut vertices = Vec::with_capacity(3 * sides * points.len());
    let mut across: Option<Vector3<f64>> = None;
    for (k, point) in points.iter().enumerate() {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(points.len() - 1));
        let tangent = (points[after] - points[before]).normalize();
        // The direction across is carried along, so that the tube is not twisted.
        let carried = across.unwrap_or_else(|| along_z(tangent.into()) * Vector3::x());
        let carried = Unit::new_normalize(carried - tangent * carried.dot(&tangent));
        across = Some(*carried);
        let other = tangent.cross(&carried);
        for side in 0..sides {
            let (s, c) = (TAU * side as f64 / sides as f64).sin_cos();
            let corner = point + radius * (c * *carried + s * other);
            vertices.extend(corner.iter());
        }
    }
    let corner = |ring: usize, side: usize| (ring * sides + side % sides) as u32;
    let rings = 0..points.len().saturating_sub(1);
    let faces = rings.flat_map(|ring| {
        (0..sides).flat_map(move |side| {
            let [a, b] = [corner(ring, side), corner(ring, side + 1)];
            let [c, d] = [corner(ring + 1, side), corner(ring + 1, side + 1)];
            [[a, b, d], [a, d, c]]
        })
    });
    BodyShape::Mesh {
        faces: faces.collect(),
        vertices,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances of the corners of a tube from the nearest of the points.
    fn corners(shape: &BodyShape) -> Vec<Vector3<f64>> {
        let BodyShape::Mesh { vertices, faces } = shape else {
            panic!("a tube is a mesh")
        };
        let count = vertices.len() / 3;
        assert!(faces.as_flattened().iter().all(|&v| (v as usize) < count));
        vertices
            .as_chunks::<3>()
            .0
            .iter()
            .map(|p| Vector3::from(*p))
            .collect()
    }

    const SPACE: Space = Space {
        centre: Vector3::new(0.3, 0.2, 0.1),
        radius: 2.0,
    };

    #[test]
    fn tubes_lie_around_their_curves() {
        let around =
            |curve: &CurveKey, closest: &dyn Fn(&Vector3<f64>) -> Vector3<f64>, error: f64| {
                let points = points(curve, &SPACE);
                assert!(points.len() >= 2);
                for corner in corners(&tube(&points, 0.01, 8)) {
                    let distance = (corner - closest(&corner)).norm();
                    assert!((distance - 0.01).abs() < error, "{distance} in {curve:?}");
                }
                points
            };
        let line = CurveKey::Line {
            point: [1.0, 0.0, 0.0],
            direction: [0.0, 0.0, -3.0],
        };
        let ends = around(&line, &|p| Vector3::new(1.0, 0.0, p.z), 1e-15);
        // As far as the sheet comes, about its middle.
        assert!((ends[0].z - 3.1).abs() < 1e-14 && (ends[1].z + 2.9).abs() < 1e-14);

        let circle = CurveKey::Circle {
            centre: [0.0, 1.0, 0.0],
            normal: [2.0, 0.0, 0.0],
            radius: 0.5,
        };
        let on_circle = |p: &Vector3<f64>| {
            let middle = Vector3::new(0.0, 1.0, 0.0);
            middle + 0.5 * (Vector3::new(0.0, p.y, p.z) - middle).normalize()
        };
        // At the ends the direction of the chord differs from the tangent.
        let points = around(&circle, &on_circle, 1e-5);
        assert!((points[0] - points[points.len() - 1]).norm() < 1e-15);

        let through = vec![[0.0; 3], [1.0, 0.5, 0.0], [1.0, 1.0, 1.0], [0.0, 0.5, 1.0]];
        let open = Spline::open(&through).unwrap();
        let closest = |p: &Vector3<f64>| constraint::Curve::closest(&open, p).position;
        let found = around(
            &CurveKey::Spline {
                points: through.clone(),
            },
            &closest,
            1e-4,
        );
        assert!((found[0] - Vector3::zeros()).norm() < 1e-12);
        let closed = Spline::closed(&through).unwrap();
        let closest = |p: &Vector3<f64>| constraint::Curve::closest(&closed, p).position;
        let found = around(&CurveKey::ClosedSpline { points: through }, &closest, 1e-4);
        assert!((found[0] - found[found.len() - 1]).norm() < 1e-12);
    }

    #[test]
    fn surfaces_are_where_they_hold_vertices() {
        let (pose, shape) = surface(
            &SurfaceKey::Plane {
                point: [1.0, 2.0, 3.0],
                normal: [0.0, 0.0, -2.0],
            },
            &SPACE,
        );
        assert_eq!(shape, BodyShape::HalfSpace);
        assert!((pose * Vector3::z() + Vector3::z()).norm() < 1e-15);
        assert_eq!(pose.translation.vector, Vector3::new(1.0, 2.0, 3.0));
        let axis = Vector3::new(1.0, 1.0, 0.0).normalize();
        let cylinder = SurfaceKey::Cylinder {
            point: [0.0, 0.0, 1.0],
            axis: [2.0, 2.0, 0.0],
            radius: 0.7,
        };
        let (pose, shape) = surface(&cylinder, &SPACE);
        assert_eq!(pose, Isometry3::identity());
        for corner in corners(&shape) {
            let d = corner - Vector3::z();
            assert!(((d - axis * d.dot(&axis)).norm() - 0.7).abs() < 1e-14);
        }
    }
}
