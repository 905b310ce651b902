//! Simple bodies in their own frames.

use crate::contact_mesh::ContactMesh;
use crate::signed_distance::{self, SignedDistance};
use crate::surface::TriangleSurface;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use nalgebra::Vector3;
use std::f64::consts::TAU;
use std::sync::Arc;
use thiserror::Error;

#[cfg(test)]
mod tests;

/// The form of a body in its own frame. Lengths in metres.
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

/// Why a shape cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length is not positive.
    #[error("{shape}: {name} is {value} m", value = given(*value))]
    Length {
        /// The shape.
        shape: &'static str,
        /// The length.
        name: &'static str,
        /// Its value, metres.
        value: f64,
    },
    /// Too few sides for a solid.
    #[error("a round body cannot have {0} segments")]
    Segments(usize),
}

impl Advice for ShapeError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Length { .. } => Some("give a positive length"),
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
    /// [`ShapeError::Length`] naming the first length that is not positive.
    pub fn validate(&self) -> Result<(), ShapeError> {
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
            Some(&(name, value)) => Err(ShapeError::Length { shape, name, value }),
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

    /// Distance of `p` (body frame, metres) with derivatives, which has a sign on both sides of an open
    /// surface too: there it is [`TriangleSurface::oriented_distance`]. The zero level that a point can be
    /// constrained to.
    pub fn oriented_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        match self {
            Self::Surface(surface) => surface.oriented_distance(p),
            _ => self.signed_distance(p),
        }
    }

    /// The primitives by which faces and edges of a sheet, not only its vertices, are kept away:
    /// a point for a ball, a segment for a capsule, both exact; the faces of a box; a prism with
    /// `segments` sides and the same rim points for a cylinder, smaller by up to
    /// `radius (1 - cos(pi / segments))`. `None` for a half-space, from which a flat face is away
    /// if its corners are.
    ///
    /// # Errors
    /// [`ShapeError::Segments`] for a cylinder with fewer than three.
    pub fn contact_geometry(&self, segments: usize) -> Result<Option<ContactGeometry>, ShapeError> {
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
                    return Err(ShapeError::Segments(segments));
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
