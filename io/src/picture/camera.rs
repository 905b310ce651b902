//! Where the viewer is.

use super::vector::{cross, dot, sub, unit};

/// A camera that looks at a target from a distance; z of the scene points upwards in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    target: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    toward: [f64; 3],
    /// From the viewer to the target, metres.
    distance: f64,
    /// Half the height of the picture in the plane of the target, metres.
    half_height: f64,
}

/// A point of the picture: x and y from -1 to 1 (y upwards, x in units of half the height), and a depth that
/// is linear in the picture, larger for what is nearer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) nearness: f64,
}

impl Camera {
    /// A camera that looks at `target` (metres) from `distance` metres, in the direction of the given azimuth
    /// (degrees, counter-clockwise from the x axis) and elevation (degrees above the horizon); the picture
    /// shows `height` metres at the target.
    pub fn new(target: [f64; 3], azimuth: f64, elevation: f64, height: f64, distance: f64) -> Self {
        let (sa, ca) = azimuth.to_radians().sin_cos();
        let (se, ce) = elevation.to_radians().sin_cos();
        Self {
            target,
            right: [-sa, ca, 0.0],
            up: [-se * ca, -se * sa, ce],
            toward: [ce * ca, ce * sa, se],
            distance,
            half_height: 0.5 * height,
        }
    }

    /// Width over height of what is seen of the points, from a third to three.
    pub fn aspect(&self, points: impl Iterator<Item = [f64; 3]> + Clone) -> f64 {
        let mut size = [0.0; 2];
        let framed = self.framing(points.clone(), 1.0, 0.0);
        for p in points {
            let q = framed.project(&p);
            size = [f64::max(size[0], q.x.abs()), f64::max(size[1], q.y.abs())];
        }
        (size[0] / size[1].max(1e-9)).clamp(1.0 / 3.0, 3.0)
    }

    /// The same camera, framed so that all points are inside the picture with a margin (part of its height),
    /// which has the given width over height.
    pub fn framing(
        &self,
        points: impl Iterator<Item = [f64; 3]> + Clone,
        aspect: f64,
        margin: f64,
    ) -> Self {
        let mut camera = *self;
        // With perspective the framing shifts what is seen a little: it settles in a few rounds.
        for _ in 0..16 {
            let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            for p in points.clone() {
                let q = camera.project(&p);
                for (k, c) in [q.x, q.y].into_iter().enumerate() {
                    low[k] = low[k].min(c);
                    high[k] = high[k].max(c);
                }
            }
            if !(low[0].is_finite() && high[0].is_finite()) {
                return camera;
            }
            let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]) * camera.half_height);
            for k in 0..3 {
                camera.target[k] += middle[0] * camera.right[k] + middle[1] * camera.up[k];
            }
            let half = (0.5 * (high[1] - low[1]))
                .max(0.5 * (high[0] - low[0]) / aspect)
                .max(1e-9);
            camera.half_height *= half * (1.0 + 2.0 * margin);
        }
        camera
    }

    /// Places a point in the picture.
    pub(super) fn project(&self, p: &[f64; 3]) -> Projected {
        let d = sub(p, &self.target);
        let (x, y, z) = (
            dot(&d, &self.right),
            dot(&d, &self.up),
            dot(&d, &self.toward),
        );
        let away = (self.distance - z).max(1e-6 * self.distance);
        let scale = self.distance / away;
        let s = scale / self.half_height;
        Projected {
            x: x * s,
            y: y * s,
            nearness: self.distance * scale,
        }
    }

    /// The direction from a point to the viewer.
    pub(super) fn viewer(&self, p: &[f64; 3]) -> [f64; 3] {
        let eye = [0, 1, 2].map(|k| self.target[k] + self.distance * self.toward[k]);
        unit(&sub(&eye, p))
    }

    /// A direction given in the picture: rightwards, upwards and towards the viewer.
    pub(super) fn direction(&self, d: [f64; 3]) -> [f64; 3] {
        unit(&[0, 1, 2].map(|k| d[0] * self.right[k] + d[1] * self.up[k] + d[2] * self.toward[k]))
    }
}

/// Unit normal of a triangle.
pub(super) fn normal(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    unit(&cross(
        &sub(&corners[1], &corners[0]),
        &sub(&corners[2], &corners[0]),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn framing_holds_all_points() {
        let points = [
            [0.0, 0.0, 0.0],
            [0.3, -0.2, 0.5],
            [1.0, 2.0, -0.7],
            [-0.4, 0.1, 0.2],
        ];
        for distance in [6.0, 600.0] {
            let camera = Camera::new([5.0, 1.0, 0.0], -50.0, 20.0, 0.1, distance).framing(
                points.into_iter(),
                1.5,
                0.05,
            );
            let inside = points.iter().map(|p| camera.project(p));
            assert!(inside.clone().all(|p| p.x.abs() < 1.5 && p.y.abs() < 1.0));
            let tightest = inside
                .map(|p| (p.x.abs() / 1.5).max(p.y.abs()))
                .fold(0.0, f64::max);
            assert!((tightest - 1.0 / 1.1).abs() < 0.02, "{tightest}");
        }
    }

    #[test]
    fn nearer_points_have_larger_nearness() {
        let camera = Camera::new([0.0; 3], 0.0, 0.0, 1.0, 3.0);
        let near = camera.project(&[1.0, 0.2, 0.0]);
        let far = camera.project(&[0.0, 0.2, 0.0]);
        assert!(near.nearness > far.nearness && near.x.abs() > far.x.abs());
    }
}
