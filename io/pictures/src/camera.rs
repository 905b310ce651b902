//! Where the viewer is.

use isosheet_mesh::vec3::{cross, dot, sub, unit};

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

/// Nearest distance from the viewer at which anything is drawn, as a part of the distance of the target.
const NEAR: f64 = 1e-3;

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

    /// This camera, framed so that all points are inside the picture with a margin (part of its height),
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
        let d = sub(p, self.target);
        let (x, y, z) = (dot(d, self.right), dot(d, self.up), dot(d, self.toward));
        let away = (self.distance - z).max(self.nearest());
        let scale = self.distance / away;
        let s = scale / self.half_height;
        Projected {
            x: x * s,
            y: y * s,
            nearness: self.distance * scale,
        }
    }

    /// The larger side of what a picture with this width over height shows at the target, metres.
    pub(super) fn scale(&self, aspect: f64) -> f64 {
        2.0 * self.half_height * aspect.max(1.0)
    }

    /// The point that is looked at, metres.
    pub(super) fn target(&self) -> [f64; 3] {
        self.target
    }

    /// Whether a point is so near to the viewer, or behind, that it has no place in the picture.
    pub(super) fn is_behind(&self, p: &[f64; 3]) -> bool {
        self.away(p) < self.nearest()
    }

    /// Whether all points that are at most `margin` metres from a triangle are outside of the picture with
    /// this width over height. The answer may be no for a triangle that passes by a corner of the picture.
    pub(super) fn is_outside(&self, corners: &[[f64; 3]; 3], margin: f64, aspect: f64) -> bool {
        let slope = self.half_height / self.distance;
        let beyond = |direction: &[f64; 3], slope: f64| {
            let limit = margin * (1.0 + slope);
            let beyond = |p: &[f64; 3], side: f64| {
                side * dot(sub(p, self.target), direction) - slope * self.away(p) > limit
            };
            let all = |side: f64| corners.iter().all(|p| beyond(p, side));
            all(1.0) || all(-1.0)
        };
        let near = self.nearest() - margin;
        beyond(&self.right, slope * aspect)
            || beyond(&self.up, slope)
            || corners.iter().all(|p| self.away(p) < near)
    }

    /// Where the viewer is, metres.
    pub(super) fn eye(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.target[k] + self.distance * self.toward[k])
    }

    /// The size of a pixel, metres, at a distance from the viewer in a picture of so many pixels of height.
    pub(super) fn pixel(&self, away: f64, height: f64) -> f64 {
        2.0 * self.half_height * away / (self.distance * height)
    }

    /// The part of an edge, from `a`, that ends where the picture shows its middle.
    pub(super) fn middle(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        let [p, q] = [a, b].map(|p| self.away(p).max(self.nearest()));
        p / (p + q)
    }

    /// The nearest distance at which anything is drawn, metres.
    pub(super) fn nearest(&self) -> f64 {
        NEAR * self.distance
    }

    /// How far a point is from the viewer in the direction of view, metres.
    fn away(&self, p: &[f64; 3]) -> f64 {
        self.distance - dot(sub(p, self.target), self.toward)
    }

    /// The direction from a point to the viewer.
    pub(super) fn viewer(&self, p: &[f64; 3]) -> [f64; 3] {
        unit(sub(self.eye(), p))
    }

    /// A direction given in the picture: rightwards, upwards and towards the viewer.
    pub(super) fn direction(&self, d: [f64; 3]) -> [f64; 3] {
        unit([0, 1, 2].map(|k| d[0] * self.right[k] + d[1] * self.up[k] + d[2] * self.toward[k]))
    }
}

/// The centre of gravity of a triangle.
pub(super) fn centre(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0)
}

/// Unit normal of a triangle.
pub(super) fn normal(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    unit(cross(
        sub(corners[1], corners[0]),
        sub(corners[2], corners[0]),
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
