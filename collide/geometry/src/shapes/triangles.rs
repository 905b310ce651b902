//! Shapes as triangles.

use std::f64::consts::{FRAC_PI_2, TAU};

/// Triangles in the frame of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangles {
    /// Corners, metres.
    pub points: Vec<[f64; 3]>,
    /// Faces by their corners, counter-clockwise as seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl Triangles {
    /// A square about the origin in the plane z = 0, seen from above, with this half side (metres): what is
    /// shown of a half-space.
    pub fn square(half: f64) -> Self {
        let corner = |[x, y]: [f64; 2]| [half * x, half * y, 0.0];
        Self {
            points: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(corner)
                .to_vec(),
            faces: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// Two half balls about the ends of a segment on the z axis, and the tube between them. All corners are
    /// on the surface. A ball has no tube.
    pub(super) fn about_segment(radius: f64, half_length: f64, sides: usize) -> Self {
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
        Self { points, faces }
    }
}
