//! Bodies as triangles.

use crate::obstacle::{ObstacleError, Shape};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Triangles in the frame of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMesh {
    /// Corners, metres.
    pub points: Vec<[f64; 3]>,
    /// Faces, counter-clockwise as seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl BodyMesh {
    /// A shape whose circles have so many sides; none for a half-space, which has no end.
    ///
    /// # Errors
    /// [`ObstacleError::Segments`] for fewer than four sides.
    pub fn of(shape: &Shape, sides: usize) -> Result<Option<Self>, ObstacleError> {
        if sides < 4 {
            return Err(ObstacleError::Segments(sides));
        }
        Ok(match *shape {
            Shape::Sphere { radius } => Some(capsule(radius, 0.0, sides)),
            Shape::Capsule {
                radius,
                half_length,
            } => Some(capsule(radius, half_length, sides)),
            Shape::HalfSpace
            | Shape::Cuboid { .. }
            | Shape::Cylinder { .. }
            | Shape::Surface(_) => shape.contact_geometry(sides)?.map(|geometry| Self {
                points: geometry.positions.as_chunks::<3>().0.to_vec(),
                faces: geometry.mesh.faces().to_vec(),
            }),
        })
    }

    /// A square about the origin in the plane z = 0, seen from above.
    pub fn square(half: f64) -> Self {
        let corner = |[x, y]: [f64; 2]| [half * x, half * y, 0.0];
        Self {
            points: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(corner)
                .to_vec(),
            faces: vec![[0, 1, 2], [0, 2, 3]],
        }
    }
}

/// Two half balls about the ends of a segment on the z axis, and the tube between them. All corners are on
/// the surface. A ball has no tube.
fn capsule(radius: f64, half_length: f64, sides: usize) -> BodyMesh {
    let quarter = sides.div_ceil(4);
    // Circles from below to above, each with its height above the middle of its half ball.
    let latitudes = (1..=quarter).map(|k| FRAC_PI_2 * (k as f64 / quarter as f64 - 1.0));
    let lower: Vec<(f64, f64)> = latitudes.map(|angle| (angle, -half_length)).collect();
    let upper = lower.iter().rev().map(|(angle, z)| (-angle, -z));
    let mut circles = lower.clone();
    circles.extend(upper.skip(usize::from(half_length == 0.0)));
    let mut points = vec![[0.0, 0.0, -half_length - radius]];
    for (angle, z) in &circles {
        for k in 0..sides {
            let (sin, cos) = (TAU * k as f64 / sides as f64).sin_cos();
            let (height, out) = angle.sin_cos();
            points.push([radius * out * cos, radius * out * sin, z + radius * height]);
        }
    }
    points.push([0.0, 0.0, half_length + radius]);
    let at = |circle: usize, k: usize| (1 + circle * sides + k % sides) as u32;
    let (top, last) = ((points.len() - 1) as u32, circles.len() - 1);
    let mut faces = Vec::new();
    for k in 0..sides {
        faces.push([0, at(0, k + 1), at(0, k)]);
        faces.push([top, at(last, k), at(last, k + 1)]);
        for c in 0..last {
            let [a, b] = [k, k + 1].map(|k| [at(c, k), at(c + 1, k)]);
            faces.extend([[a[0], b[0], b[1]], [a[0], b[1], a[1]]]);
        }
    }
    BodyMesh { points, faces }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Six times the volume that the faces enclose; positive where they are counter-clockwise from outside.
    fn volume(mesh: &BodyMesh) -> f64 {
        let six = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|v| mesh.points[v as usize]);
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        mesh.faces.iter().map(six).sum::<f64>() / 6.0
    }

    /// Round bodies are closed, wound outwards, and have the volume of their shapes.
    #[test]
    fn round_bodies_have_their_volumes() {
        let (radius, half_length) = (0.5, 0.75);
        let ball = TAU / 1.5 * radius * radius * radius;
        let tube = TAU * radius * radius * half_length;
        let shapes = [
            (Shape::Sphere { radius }, ball),
            (
                Shape::Capsule {
                    radius,
                    half_length,
                },
                ball + tube,
            ),
            (
                Shape::Cylinder {
                    radius,
                    half_height: half_length,
                },
                tube,
            ),
        ];
        for (shape, expected) in shapes {
            let mesh = BodyMesh::of(&shape, 128).unwrap().unwrap();
            let found = volume(&mesh);
            assert!(
                found < expected && found > 0.998 * expected,
                "{shape:?}: {found}"
            );
            let sides: BTreeSet<[u32; 2]> = mesh
                .faces
                .iter()
                .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
                .collect();
            assert_eq!(sides.len(), 3 * mesh.faces.len());
            assert!(sides.iter().all(|[a, b]| sides.contains(&[*b, *a])));
        }
        assert_eq!(BodyMesh::of(&Shape::HalfSpace, 8).unwrap(), None);
        assert!(BodyMesh::of(&Shape::Sphere { radius }, 3).is_err());
    }
}
