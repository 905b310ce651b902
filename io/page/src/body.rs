//! Bodies beside the sheet.

use super::check;
use super::pack::{packed_doubles, packed_triangles};
use isosheet_collide::Obstacle;
use isosheet_files::DataError;
use isosheet_formats::BodyPose;
use isosheet_geometry::{Shape, Skin};
use isosheet_mesh::wording::{brief, given};
use nalgebra::Isometry3;
use serde::Serialize;

/// The form of a body in its own frame. Lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum BodyShape {
    /// Everything with `z <= 0`. The page shows a finite patch of the plane with a grid.
    HalfSpace,
    /// A box about the origin with edges along the axes.
    Cuboid {
        /// Half the edge lengths.
        half: [f64; 3],
    },
    /// A ball about the origin.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A solid cylinder about the z axis, flat at both ends.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Half its height.
        half_height: f64,
    },
    /// A cylinder about the z axis with half balls at both ends.
    Capsule {
        /// Its radius.
        radius: f64,
        /// Half the length between the centres of the balls.
        half_length: f64,
    },
    /// Triangles, shown from both sides.
    Mesh {
        /// Positions of the N corners (length 3N).
        #[serde(serialize_with = "packed_doubles")]
        vertices: Vec<f64>,
        /// Corners of the triangles, counted from 0.
        #[serde(serialize_with = "packed_triangles")]
        faces: Vec<[u32; 3]>,
    },
}

/// A rigid body beside the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Its form.
    pub shape: BodyShape,
    /// Its pose in each frame (length T), or a single one when it does not move.
    pub poses: Vec<BodyPose>,
}

/// By how much the length of a quaternion may differ from 1: quaternions that were integrated or rounded to
/// single precision (6e-8) pass, and what is no rotation does not. The page normalises them.
const QUATERNION_TOLERANCE: f64 = 1e-3;

impl Body {
    pub(super) fn validate(&self, index: usize, frames: usize) -> Result<(), DataError> {
        let what = format!("body {index} (`{}`)", self.name);
        self.check_shape(&what)?;
        if self.poses.len() != 1 {
            check::length(&format!("{what}: the poses"), self.poses.len(), frames)?;
        }
        for (index, pose) in self.poses.iter().enumerate() {
            check::finite_of(&pose.rotation, || {
                format!("{what}: the rotation of pose {index}")
            })?;
            check::finite_of(&pose.translation, || {
                format!("{what}: the translation of pose {index}")
            })?;
            let norm = pose.rotation.iter().map(|c| c * c).sum::<f64>().sqrt();
            if (norm - 1.0).abs() > QUATERNION_TOLERANCE {
                let length = brief(norm);
                let message =
                    format!("{what}: the quaternion of pose {index} has the length {length}");
                let error = DataError::new(message, "give a quaternion of length 1");
                return Err(error.at(index).value(norm));
            }
        }
        Ok(())
    }

    fn check_shape(&self, what: &str) -> Result<(), DataError> {
        let positive = |lengths: &[(&'static str, f64)]| {
            for &(name, value) in lengths {
                if !value.is_finite() || value <= 0.0 {
                    let message = format!("{what}: {name} is {} m", given(value));
                    return Err(DataError::new(message, "give a positive length").value(value));
                }
            }
            Ok(())
        };
        match &self.shape {
            BodyShape::HalfSpace => Ok(()),
            BodyShape::Cuboid { half: [x, y, z] } => positive(&[
                ("half the edge along x", *x),
                ("half the edge along y", *y),
                ("half the edge along z", *z),
            ]),
            BodyShape::Sphere { radius } => positive(&[("the radius", *radius)]),
            BodyShape::Cylinder {
                radius,
                half_height,
            } => positive(&[("the radius", *radius), ("half the height", *half_height)]),
            BodyShape::Capsule {
                radius,
                half_length,
            } => positive(&[("the radius", *radius), ("half the length", *half_length)]),
            BodyShape::Mesh { vertices, faces } => {
                let count = vertices.len() / 3;
                let name = format!("{what}: the corners");
                check::length(&name, vertices.len(), 3 * count)?;
                check::finite(&name, vertices)?;
                if faces.is_empty() {
                    let message = format!("{what}: the mesh has no triangles");
                    return Err(DataError::new(message, "give at least one"));
                }
                let corners = faces.as_flattened();
                check::vertices(&format!("{what}: the triangles"), corners, count)
            }
        }
    }
}

/// Sides of the circles of round bodies of which the page knows no form of its own.
const SIDES: usize = 64;

/// The page draws boxes, balls, capsules, cylinders and planes itself, and of all other shapes the triangles.
impl From<&Shape> for BodyShape {
    fn from(shape: &Shape) -> Self {
        match shape.skin() {
            Skin::Plane => Self::HalfSpace,
            Skin::Round {
                half_length: 0.0,
                radius,
            } => Self::Sphere { radius },
            Skin::Round {
                half_length,
                radius,
            } => Self::Capsule {
                radius,
                half_length,
            },
            Skin::Tube {
                half_length,
                radius,
            } => Self::Cylinder {
                radius,
                half_height: half_length,
            },
            Skin::Flat => match (shape, shape.triangles(SIDES).ok().flatten()) {
                (Shape::Cuboid { half }, _) => Self::Cuboid { half: *half },
                (_, Some(mesh)) => Self::Mesh {
                    vertices: mesh.points.concat(),
                    faces: mesh.faces,
                },
                (_, None) => Self::HalfSpace,
            },
        }
    }
}

impl Body {
    /// A body that is at `pose(t)` at the times `t` (seconds) of the frames. One that does not move has a
    /// single pose.
    pub fn moving(
        name: &str,
        shape: BodyShape,
        times: &[f64],
        pose: impl Fn(f64) -> Isometry3<f64>,
    ) -> Self {
        let mut poses: Vec<BodyPose> = times.iter().map(|&t| pose(t).into()).collect();
        if poses.windows(2).all(|pair| pair[0] == pair[1]) {
            poses.truncate(1);
        }
        Self {
            name: name.into(),
            shape,
            poses,
        }
    }

    /// An obstacle at the times (seconds) of the frames.
    pub fn of_obstacle(name: &str, obstacle: &Obstacle, times: &[f64]) -> Self {
        Self::moving(name, obstacle.shape().into(), times, |t| {
            obstacle.motion().pose(t)
        })
    }
}
