//! Parallel projection of spatial scenes onto the drawing plane.

use super::colour::{Colour, palette};
use isosheet_mesh::vec3::{axpy, cross, dot, sub, unit};

/// A parallel projection; z of the scene points upwards in the drawing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    right: [f64; 3],
    up: [f64; 3],
    toward: [f64; 3],
    scale: f64,
}

impl Projection {
    /// Seen from the given azimuth (degrees, counter-clockwise from the x axis) and elevation (degrees above
    /// the horizon); `scale` points per metre.
    pub(crate) fn from(azimuth: f64, elevation: f64, scale: f64) -> Self {
        let (sa, ca) = azimuth.to_radians().sin_cos();
        let (se, ce) = elevation.to_radians().sin_cos();
        Self {
            right: [-sa, ca, 0.0],
            up: [-se * ca, -se * sa, ce],
            toward: [ce * ca, ce * sa, se],
            scale,
        }
    }

    /// Place in the drawing, points.
    pub(crate) fn project(&self, p: &[f64; 3]) -> [f64; 2] {
        [
            self.scale * dot(self.right, p),
            self.scale * dot(self.up, p),
        ]
    }

    /// Places of several points.
    pub(crate) fn project_all(&self, points: &[[f64; 3]]) -> Vec<[f64; 2]> {
        points.iter().map(|p| self.project(p)).collect()
    }

    /// How near to the viewer a point is, metres.
    pub(crate) fn nearness(&self, p: &[f64; 3]) -> f64 {
        dot(self.toward, p)
    }

    /// A colour shaded for a face with the given corners, alike from both sides.
    pub(crate) fn shade(&self, colour: Colour, corners: &[[f64; 3]; 3]) -> Colour {
        let n = unit(cross(
            sub(corners[1], corners[0]),
            sub(corners[2], corners[0]),
        ));
        // Light from the upper left behind the viewer.
        let light =
            unit([0, 1, 2].map(|k| self.toward[k] + 0.5 * self.up[k] - 0.4 * self.right[k]));
        let lit = dot(n, light).abs();
        colour
            .mix(palette::BLACK, 0.17 * (1.0 - lit))
            .mix(palette::WHITE, 0.12 * lit)
    }
}

/// Points on the circular arc about `centre` that starts at the radius `u` and turns towards `w` (both
/// perpendicular to the axis, of equal length) by `angle` radians.
pub(crate) fn arc(centre: &[f64; 3], u: &[f64; 3], w: &[f64; 3], angle: f64) -> Vec<[f64; 3]> {
    let n = 2 + (angle.abs() / 0.06) as usize;
    (0..=n)
        .map(|k| {
            let (s, c) = (angle * k as f64 / n as f64).sin_cos();
            axpy(axpy(centre, c, u), s, w)
        })
        .collect()
}

/// The arc of the given radius about `apex` from the direction of `a` to that of `b`, by the smaller angle.
pub(crate) fn angle_arc(apex: &[f64; 3], a: &[f64; 3], b: &[f64; 3], radius: f64) -> Vec<[f64; 3]> {
    let u = unit(sub(a, apex));
    let d = sub(b, apex);
    let w = unit(axpy(d, -dot(d, u), u));
    let angle = dot(d, w).atan2(dot(d, u));
    arc(apex, &u.map(|c| c * radius), &w.map(|c| c * radius), angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_orthonormal_with_z_upwards() {
        let v = Projection::from(-60.0, 25.0, 1.0);
        for (a, b) in [(&v.right, &v.up), (&v.up, &v.toward), (&v.toward, &v.right)] {
            assert!(dot(a, b).abs() < 1e-15);
        }
        assert!(dot(cross(v.right, v.up), v.toward) > 0.999_999);
        let foot = v.project(&[0.0; 3]);
        let top = v.project(&[0.0, 0.0, 1.0]);
        assert!((top[0] - foot[0]).abs() < 1e-15 && top[1] > foot[1]);
    }

    #[test]
    fn angle_arcs_join_both_legs() {
        let (apex, a, b) = ([1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 1.0, 1.0]);
        let points = angle_arc(&apex, &a, &b, 0.5);
        let (first, last) = (points[0], points[points.len() - 1]);
        assert!((first[0] - 1.5).abs() < 1e-12 && first[1].abs() < 1e-12);
        let leg = unit(sub(b, apex));
        let end = sub(last, axpy(apex, 0.5, leg));
        assert!(dot(end, end) < 1e-24);
    }
}
