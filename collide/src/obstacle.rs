//! Bodies that a sheet meets.

use crate::contact_mesh::ContactMesh;
use crate::signed_distance::{self, SignedDistance};
use crate::surface::TriangleSurface;
use isosheet_dynamics::{MotionError, RigidDisplacement, RigidMotion, RigidProfile};
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use nalgebra::{Isometry3, Point3, Vector3};
use std::f64::consts::TAU;
use std::sync::Arc;
use thiserror::Error;

#[cfg(test)]
mod tests;

/// The form of an obstacle in its own frame. Lengths in metres.
#[derive(Debug, Clone)]
pub enum Shape {
    /// Everything with `z <= 0`: a floor.
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
    /// Triangles.
    Surface(Arc<TriangleSurface>),
}

/// Why a shape cannot be an obstacle.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ObstacleError {
    /// A length is not positive.
    #[error("{shape}: {name} is {value} m", value = given(*value))]
    Length {
        /// The shape.
        shape: &'static str,
        /// The length.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The motion cannot be used.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Too few sides for a solid.
    #[error("a round body cannot have {0} segments")]
    Segments(usize),
}

impl Advice for ObstacleError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Length { .. } => Some("give a positive length"),
            Self::Motion(error) => error.advice(),
            Self::Segments(..) => Some("give at least 3"),
        }
    }
}

/// Primitives whose distance, less a radius, is the distance from a body.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactGeometry {
    /// Vertices, edges and faces.
    pub mesh: ContactMesh,
    /// Positions of the vertices in the body's frame, `3V`, metres.
    pub positions: Vec<f64>,
    /// Thickness about the primitives, metres: the separation that contact has to add.
    pub radius: f64,
}

impl Shape {
    /// # Errors
    /// [`ObstacleError::Length`] naming the first length that is not positive.
    pub fn validate(&self) -> Result<(), ObstacleError> {
        let (shape, lengths): (_, &[(&'static str, f64)]) = match *self {
            Self::HalfSpace | Self::Surface(_) => ("", &[]),
            Self::Cuboid { half: [x, y, z] } => {
                ("cuboid", &[("half[0]", x), ("half[1]", y), ("half[2]", z)])
            }
            Self::Sphere { radius } => ("sphere", &[("radius", radius)]),
            Self::Cylinder {
                radius,
                half_height,
            } => (
                "cylinder",
                &[("radius", radius), ("half_height", half_height)],
            ),
            Self::Capsule {
                radius,
                half_length,
            } => (
                "capsule",
                &[("radius", radius), ("half_length", half_length)],
            ),
        };
        match lengths.iter().find(|(_, l)| !(*l > 0.0 && l.is_finite())) {
            Some(&(name, value)) => Err(ObstacleError::Length { shape, name, value }),
            None => Ok(()),
        }
    }

    /// Distance of `p` (body frame, metres) with derivatives.
    pub fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        match self {
            Self::HalfSpace => signed_distance::half_space(p),
            Self::Cuboid { half } => signed_distance::cuboid(p, half),
            Self::Sphere { radius } => signed_distance::sphere(p, *radius),
            Self::Cylinder {
                radius,
                half_height,
            } => signed_distance::cylinder(p, *radius, *half_height),
            Self::Capsule {
                radius,
                half_length,
            } => signed_distance::capsule(p, *radius, *half_length),
            Self::Surface(surface) => surface.signed_distance(p),
        }
    }

    /// The primitives by which faces and edges of a sheet, not only its vertices, are kept away:
    /// a point for a ball, a segment for a capsule, both exact; the faces of a box; a prism with
    /// `segments` sides and the same rim points for a cylinder, smaller by up to
    /// `radius (1 - cos(pi / segments))`. `None` for a half-space, from which a flat face is away
    /// if its corners are.
    ///
    /// # Errors
    /// [`ObstacleError::Segments`] for a cylinder with fewer than three.
    pub fn contact_geometry(
        &self,
        segments: usize,
    ) -> Result<Option<ContactGeometry>, ObstacleError> {
        let solid = |positions: Vec<f64>, faces: &[[u32; 3]], radius| {
            let mesh = ContactMesh::from_triangles(positions.len() / 3, faces);
            ContactGeometry {
                mesh: mesh.expect("the faces of a solid name its vertices"),
                positions,
                radius,
            }
        };
        Ok(Some(match self {
            Self::HalfSpace => return Ok(None),
            Self::Cuboid { half } => solid(cuboid_corners(half), &CUBOID_FACES, 0.0),
            Self::Sphere { radius } => ContactGeometry {
                mesh: ContactMesh::point(),
                positions: vec![0.0; 3],
                radius: *radius,
            },
            Self::Capsule {
                radius,
                half_length,
            } => ContactGeometry {
                mesh: ContactMesh::segment(),
                positions: vec![0.0, 0.0, -half_length, 0.0, 0.0, *half_length],
                radius: *radius,
            },
            Self::Cylinder {
                radius,
                half_height,
            } => {
                let sides = u32::try_from(segments).unwrap_or(u32::MAX);
                if !(3..=MOST_SEGMENTS).contains(&sides) {
                    return Err(ObstacleError::Segments(segments));
                }
                let (positions, faces) = prism(*radius, *half_height, sides);
                solid(positions, &faces, 0.0)
            }
            Self::Surface(surface) => ContactGeometry {
                mesh: surface.mesh().clone(),
                positions: surface.positions().iter().flatten().copied().collect(),
                radius: 0.0,
            },
        }))
    }
}

/// A prism with more sides has slivers for faces and millions of candidates; its sag is 5e-12 of the
/// radius.
const MOST_SEGMENTS: u32 = 1_000_000;

/// Corner `i` is on the positive side of axis `k` if bit `k` of `i` is set.
fn cuboid_corners(half: &[f64; 3]) -> Vec<f64> {
    (0..8)
        .flat_map(|i| (0..3).map(move |k| if i >> k & 1 == 1 { half[k] } else { -half[k] }))
        .collect()
}

const CUBOID_FACES: [[u32; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// Rims first, bottom then top, then the centres of bottom and top.
fn prism(radius: f64, half_height: f64, sides: u32) -> (Vec<f64>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    for z in [-half_height, half_height] {
        for i in 0..sides {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(sides)).sin_cos();
            positions.extend([radius * cos, radius * sin, z]);
        }
    }
    positions.extend([0.0, 0.0, -half_height, 0.0, 0.0, half_height]);
    let (bottom, top) = (2 * sides, 2 * sides + 1);
    let mut faces = Vec::new();
    for i in 0..sides {
        let j = (i + 1) % sides;
        faces.extend([
            [i, j, sides + j],
            [i, sides + j, sides + i],
            [bottom, j, i],
            [top, sides + i, sides + j],
        ]);
    }
    (positions, faces)
}

/// A body at rest or in prescribed rigid motion.
#[derive(Debug, Clone)]
pub struct Obstacle {
    shape: Shape,
    motion: RigidMotion,
}

/// Velocities of bodies that move by a function of time are taken by differences over parts of this time,
/// seconds: they are good to 1e-8 of the change of velocity in a hundredth of a second.
const MOTION_SPAN: f64 = 1e-2;

impl Obstacle {
    /// A body that moves: by profiles, through keyframes, or as a function of time (seconds) that returns its
    /// pose.
    ///
    /// # Errors
    /// [`ObstacleError`] naming the length that is not positive, or what is wrong with the motion.
    pub fn new(shape: Shape, motion: impl Into<RigidMotion>) -> Result<Self, ObstacleError> {
        let motion = motion.into();
        shape.validate()?;
        motion.validate()?;
        Ok(Self { shape, motion })
    }

    /// A body that rests in a pose.
    ///
    /// # Errors
    /// [`ObstacleError`] naming the length that is not positive, or the number of the pose that is not
    /// finite.
    pub fn fixed(shape: Shape, pose: Isometry3<f64>) -> Result<Self, ObstacleError> {
        Self::new(shape, RigidProfile::fixed(pose))
    }

    /// A body that rests with the origin of its frame at a place (metres), its axes along those of space. For
    /// one that is turned or moves by profiles, see [`RigidDisplacement`].
    ///
    /// # Errors
    /// [`ObstacleError`] naming the length that is not positive, or the coordinate that is not finite.
    pub fn at(shape: Shape, place: [f64; 3]) -> Result<Self, ObstacleError> {
        Self::new(shape, RigidDisplacement::at(place))
    }

    /// Its form.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Its motion.
    pub fn motion(&self) -> &RigidMotion {
        &self.motion
    }

    /// Velocity (metres per second) of the body's point that is at `p` (metres, in space) at time `t`
    /// (seconds).
    pub fn velocity(&self, t: f64, p: &Vector3<f64>) -> Vector3<f64> {
        self.motion.kinematics(t, MOTION_SPAN).velocity_at(p)
    }

    /// Distance of `p` (metres, in space) at time `t` (seconds) with derivatives by `p`.
    pub fn signed_distance(&self, t: f64, p: &Vector3<f64>) -> SignedDistance {
        let pose = self.motion.pose(t);
        let local = self
            .shape
            .signed_distance(&pose.inverse_transform_point(&Point3::from(*p)).coords);
        let turn = pose.rotation.to_rotation_matrix().into_inner();
        SignedDistance {
            value: local.value,
            normal: turn * local.normal,
            hessian: turn * local.hessian * turn.transpose(),
        }
    }

    /// Writes body positions (`3V`) as positions in space at time `t` to `out`.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn place(&self, t: f64, positions: &[f64], out: &mut [f64]) {
        assert_eq!(positions.len(), out.len(), "one place per position");
        let pose = self.motion.pose(t);
        let chunks = positions.as_chunks::<3>().0;
        for (p, q) in chunks.iter().zip(out.as_chunks_mut::<3>().0) {
            *q = (pose * Point3::from(*p)).coords.into();
        }
    }
}
