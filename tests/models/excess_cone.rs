//! The cone of a disk with an inserted wedge.

use nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The state of least energy of an inextensible disk with a wedge of the angle `phi` inserted: a cone with
/// two folds up and two down.
///
/// A cone meets the unit sphere about its tip in a closed curve of the length `2 pi + phi`. A plate with the
/// flexural rigidity `D` bends about the rays with the curvature `kappa / r`, where `kappa` is the geodesic
/// curvature of that curve, so that the ring between the radii `a` and `b` has the energy
///
/// ```text
/// E = D ln(b / a) integral kappa^2 / 2 ds.
/// ```
///
/// Curves of least energy are elastic curves of the sphere, `kappa'' + kappa^3 / 2 + c kappa = 0` with a
/// multiplier `c` for the length. For small `phi` the energy is `3 D phi ln(b / a)` (M. M. Mueller, M. Ben
/// Amar and J. Guven, "Conical defects in growing sheets", Phys. Rev. Lett. 101, 156104, 2008).
#[derive(Clone, Copy, Debug)]
pub struct ExcessCone {
    excess: f64,
    start: Start,
}

/// The curve at a highest point: geodesic curvature (its derivative is zero there), the multiplier `c`, and
/// the elevation above the equator, radians.
type Start = Vector3<f64>;

/// A point on the curve.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Place on the unit sphere, and the unit tangent.
    place: Vector3<f64>,
    tangent: Vector3<f64>,
    /// Geodesic curvature and its derivative.
    curvature: [f64; 2],
    /// Integral of half the square of the curvature.
    energy: f64,
}

impl ExcessCone {
    /// The cone of a wedge of `excess` radians, from above 0 to 1.
    ///
    /// # Panics
    /// For another angle.
    pub fn new(excess: f64) -> Self {
        assert!(excess > 0.0 && excess <= 1.0, "an angle up to 1");
        // For small angles the elevation is `a cos 2 theta` with `phi = 3 pi a^2 / 2`.
        let height = (2.0 * excess / (3.0 * PI)).sqrt();
        let mut cone = Self {
            excess,
            start: Start::new(-3.0 * height, 4.0, height),
        };
        for _ in 0..ITERATIONS {
            let miss = cone.miss();
            let column = |k: usize| {
                let mut other = cone;
                other.start[k] += DIFFERENCE;
                (other.miss() - miss) / DIFFERENCE
            };
            let slopes = Matrix3::from_columns(&[0, 1, 2].map(column));
            cone.start -= slopes.lu().solve(&miss).expect("conditions of full rank");
        }
        cone
    }

    /// The length of the curve on the unit sphere: the sum of the angles at the tip, radians.
    pub fn length(&self) -> f64 {
        TAU + self.excess
    }

    /// The energy of a ring of the disk over `D ln(b / a)`, with its radii `a` and `b`.
    pub fn energy(&self) -> f64 {
        8.0 * self.point(self.length() / 8.0).energy
    }

    /// The largest elevation of a ray above the equator, radians.
    pub fn height(&self) -> f64 {
        self.start[2]
    }

    /// The direction of the ray at the angle `s` (radians, in the disk) from one of the two highest ones,
    /// which is in the plane of x and z.
    pub fn ray(&self, s: f64) -> Vector3<f64> {
        // A quarter of the disk further, the curve is turned by a right angle and upside down.
        let quarter = self.length() / 4.0;
        let turns = (s / quarter).round();
        let within = s - turns * quarter;
        let place = self.point(within.abs()).place;
        let sign = if turns.rem_euclid(2.0) == 0.0 {
            1.0
        } else {
            -1.0
        };
        let place = Vector3::new(place.x, within.signum() * place.y, sign * place.z);
        Rotation3::from_axis_angle(&Vector3::z_axis(), turns * FRAC_PI_2) * place
    }

    /// What is zero an eighth of the curve from a highest point, by symmetry: curvature, height, and the
    /// distance from the vertical plane at 45 degrees.
    fn miss(&self) -> Vector3<f64> {
        let Point {
            place, curvature, ..
        } = self.point(self.length() / 8.0);
        Vector3::new(curvature[0], place.z, place.x - place.y)
    }

    /// The point at a distance from the highest one, by the classical Runge-Kutta method.
    fn point(&self, distance: f64) -> Point {
        let [curvature, _, height] = self.start.into();
        let (sin, cos) = height.sin_cos();
        let mut point = Point {
            place: Vector3::new(cos, 0.0, sin),
            tangent: Vector3::y(),
            curvature: [curvature, 0.0],
            energy: 0.0,
        };
        let h = distance / f64::from(STEPS);
        for _ in 0..STEPS {
            let k1 = self.rate(&point);
            let k2 = self.rate(&point.moved(&k1, 0.5 * h));
            let k3 = self.rate(&point.moved(&k2, 0.5 * h));
            let k4 = self.rate(&point.moved(&k3, h));
            for (k, part) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
                point = point.moved(&k, part * h / 6.0);
            }
        }
        point
    }

    fn rate(&self, p: &Point) -> Point {
        let [curvature, slope] = p.curvature;
        let multiplier = self.start[1];
        Point {
            place: p.tangent,
            tangent: curvature * p.place.cross(&p.tangent) - p.place,
            curvature: [
                slope,
                -(0.5 * curvature * curvature + multiplier) * curvature,
            ],
            energy: 0.5 * curvature * curvature,
        }
    }
}

impl Point {
    fn moved(&self, rate: &Self, h: f64) -> Self {
        Self {
            place: self.place + h * rate.place,
            tangent: self.tangent + h * rate.tangent,
            curvature: [0, 1].map(|i| self.curvature[i] + h * rate.curvature[i]),
            energy: self.energy + h * rate.energy,
        }
    }
}

/// Steps from a highest point: errors of 1e-10 over an eighth of the curve.
const STEPS: u32 = 64;

/// Iterations of Newton's method, from the solution for small angles to round-off.
const ITERATIONS: usize = 12;

/// Differences of the start, by which slopes are found.
const DIFFERENCE: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_wedges_have_the_published_energy() {
        for excess in [1e-4, 1e-3] {
            let cone = ExcessCone::new(excess);
            assert!((cone.energy() / (3.0 * excess) - 1.0).abs() < 2.0 * excess);
        }
    }

    /// The curve is closed and smooth, has unit speed, and ends where it began.
    #[test]
    fn curves_are_closed_and_have_their_length() {
        let cone = ExcessCone::new(0.3);
        assert!(cone.miss().norm() < 1e-9, "{}", cone.miss());
        let n = 4000;
        let ray = |k: i32| cone.ray(cone.length() * f64::from(k) / f64::from(n));
        let parts = (0..n).map(|k| ray(k).angle(&ray(k + 1)));
        assert!((parts.sum::<f64>() - cone.length()).abs() < 1e-5);
        assert!((ray(0) - ray(n)).norm() < 1e-9);
        assert!((ray(0).z - cone.height().sin()).abs() < 1e-12);
        assert!(ray(n / 8).z.abs() < 1e-9 && ray(n / 4).z < 0.0 && ray(-7).y < 0.0);
    }

    /// Curves of the same length with elevations `a cos 2 theta + b cos 6 theta` have no less energy, and the
    /// best of them nearly the same.
    #[test]
    fn no_other_curve_has_less_energy() {
        let cone = ExcessCone::new(0.3);
        let of = |b: f64| {
            let (mut low, mut high) = (0.0, 0.5);
            for _ in 0..60 {
                let a = 0.5 * (low + high);
                if trial([a, b])[0] < cone.length() {
                    low = a;
                } else {
                    high = a;
                }
            }
            trial([low, b])[1]
        };
        let all = (-10..=10).map(|k| of(2e-3 * f64::from(k)));
        let best = all.fold(f64::INFINITY, f64::min);
        let part = best / cone.energy() - 1.0;
        assert!((0.0..1e-3).contains(&part), "{part}");
    }

    /// Length and energy of a curve with the elevation `a cos 2 theta + b cos 6 theta`, by differences.
    fn trial([a, b]: [f64; 2]) -> [f64; 2] {
        let n = 2000;
        let place = |k: i32| {
            let theta = TAU * f64::from(k) / f64::from(n);
            let (sin, cos) = (a * (2.0 * theta).cos() + b * (6.0 * theta).cos()).sin_cos();
            Vector3::new(cos * theta.cos(), cos * theta.sin(), sin)
        };
        let mut sums = [0.0; 2];
        for k in 0..n {
            let [before, here, after] = [k - 1, k, k + 1].map(place);
            let lengths = [before.angle(&here), here.angle(&after)];
            let length = 0.5 * (lengths[0] + lengths[1]);
            // The change of the tangent in the tangential plane.
            let ahead = |to: Vector3<f64>| (to - here * here.dot(&to)).normalize();
            let turn = ahead(after).angle(&-ahead(before));
            sums[0] += lengths[1];
            sums[1] += 0.5 * turn * turn / length;
        }
        sums
    }
}
