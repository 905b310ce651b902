//! Bodies with round shapes: their mass, and the surface by which they touch.

use super::obstacles::Shape;
use super::pose::Pose;
use isosheet_collide::RoundBody;
use isosheet_dynamics::{RigidBody, RigidBodyError};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// A ball, a cylinder or a capsule about the z axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RoundShape {
    radius: f64,
    /// The length of the axis of a cylinder or a capsule, metres; zero of a ball.
    length: f64,
    /// Whether there are half balls at the ends of the axis, as those of a ball are.
    has_balls: bool,
}

impl RoundShape {
    /// That of a shape which is round.
    pub(super) fn of(shape: &Shape) -> Option<Self> {
        let of = |radius: &f64, length: &f64, has_balls| {
            Some(Self {
                radius: *radius,
                length: *length,
                has_balls,
            })
        };
        match shape {
            Shape::Sphere { radius } => of(radius, &0.0, true),
            Shape::Capsule { radius, length } => of(radius, length, true),
            Shape::Cylinder { radius, height } => of(radius, height, false),
            _ => None,
        }
    }

    /// The volumes of the cylinder and of both half balls, cubic metres.
    fn volumes(&self) -> [f64; 2] {
        let disk = PI * self.radius * self.radius;
        let balls = match self.has_balls {
            true => 4.0 / 3.0 * disk * self.radius,
            false => 0.0,
        };
        [disk * self.length, balls]
    }

    /// Volume, cubic metres.
    pub(super) fn volume(&self) -> f64 {
        self.volumes().iter().sum()
    }

    /// Second moments of the volume about the centre, across the axis and along it:
    ///
    /// ```text
    /// across:  V_c r^2 / 4 + V_b r^2 / 5
    /// along:   V_c l^2 / 12 + V_b (r^2 / 5 + l^2 / 4 + 3 l r / 8)
    /// ```
    ///
    /// with the volumes of the cylinder and of the half balls, whose centres are `3 r / 8` beyond the ends of the axis.
    fn moments(&self) -> [f64; 2] {
        let ([cylinder, balls], r, l) = (self.volumes(), self.radius, self.length);
        [
            cylinder * r * r / 4.0 + balls * r * r / 5.0,
            cylinder * l * l / 12.0 + balls * (r * r / 5.0 + l * l / 4.0 + 3.0 * l * r / 8.0),
        ]
    }

    /// The body of a mass (kilograms) that is spread evenly, in a pose.
    pub(super) fn body(&self, mass: f64, pose: &Pose) -> Result<RigidBody, RigidBodyError> {
        let density = mass / self.volume();
        let [across, along] = self.moments().map(|s| density * s);
        let turn = pose.isometry().rotation.to_rotation_matrix().into_inner();
        let own = Matrix3::from_diagonal(&Vector3::new(across, across, along));
        let moments = turn * own * turn.transpose();
        let moments = 0.5 * (moments + moments.transpose());
        RigidBody::new(mass, pose.place([0.0; 3]), moments.into())
    }

    /// The surface by which it touches, in a pose; nothing of a cylinder, which touches as a polyhedron.
    pub(super) fn surface(&self, pose: &Pose) -> Option<RoundBody> {
        let half = 0.5 * self.length;
        self.has_balls.then(|| RoundBody {
            axis: [-half, half].map(|z| pose.place([0.0, 0.0, z])),
            radius: self.radius,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The moments of a polyhedron with many sides, which are integrals over its faces.
    #[test]
    fn moments_are_those_of_a_polyhedron_with_many_sides() {
        use isosheet_collide::BodyMesh;
        use isosheet_dynamics::Solid;
        use isosheet_mesh::Sheet;
        let shapes = [
            (
                Shape::Sphere { radius: 0.3 },
                isosheet_collide::Shape::Sphere { radius: 0.3 },
            ),
            (
                Shape::Cylinder {
                    radius: 0.2,
                    height: 0.7,
                },
                isosheet_collide::Shape::Cylinder {
                    radius: 0.2,
                    half_height: 0.35,
                },
            ),
            (
                Shape::Capsule {
                    radius: 0.2,
                    length: 0.5,
                },
                isosheet_collide::Shape::Capsule {
                    radius: 0.2,
                    half_length: 0.25,
                },
            ),
        ];
        for (shape, solid) in shapes {
            let round = RoundShape::of(&shape).unwrap();
            let mesh = BodyMesh::of(&solid, 256).unwrap().unwrap();
            let surface = Sheet::new(mesh.points.concat(), &mesh.faces).unwrap();
            let polyhedron = Solid::new(surface).unwrap();
            // Corners are on the shape, and sides `r (1 - cos(pi / 256))` inside of it.
            let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-3;
            assert!(close(polyhedron.volume(), round.volume()), "{shape:?}");
            let moments = polyhedron.second_moments();
            let [across, along] = round.moments();
            assert!(
                close(moments[0][0], across) && close(moments[1][1], across),
                "{shape:?}"
            );
            assert!(close(moments[2][2], along), "{shape:?}");
        }
        assert!(RoundShape::of(&Shape::HalfSpace).is_none());
    }
}
