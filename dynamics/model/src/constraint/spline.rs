//! Interpolating cubic splines.

use super::{ConstraintError, Curve, CurvePoint};
use nalgebra::Vector3;

/// A cubic spline through points, twice continuously differentiable, with the distance of the points as the
/// parameter: open with natural ends (it continues straight beyond them, without a jump in curvature), or
/// closed.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    points: Vec<Vector3<f64>>,
    /// Second derivatives at the points.
    second: Vec<Vector3<f64>>,
    /// Parameters of the points; for a closed spline also that of the first at the end.
    knots: Vec<f64>,
    ends: Ends,
}

/// What a spline does at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ends {
    /// The second derivative is zero there.
    Natural,
    /// The last point is followed by the first.
    Joined,
}

/// Places per span that the closest point is sought from.
const SAMPLES: usize = 8;
/// Most Newton iterations for the closest point; a handful is usual.
const MAX_ITERATIONS: usize = 60;

impl Spline {
    /// Through at least two points, metres.
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is not finite, there are too few points, or neighbours coincide.
    pub fn open(points: &[[f64; 3]]) -> Result<Self, ConstraintError> {
        Self::new(points, Ends::Natural)
    }

    /// Through at least three points and back to the first, metres.
    ///
    /// # Errors
    /// As [`Spline::open`].
    pub fn closed(points: &[[f64; 3]]) -> Result<Self, ConstraintError> {
        Self::new(points, Ends::Joined)
    }

    fn new(points: &[[f64; 3]], ends: Ends) -> Result<Self, ConstraintError> {
        let needed = match ends {
            Ends::Joined => 3,
            Ends::Natural => 2,
        };
        let n = points.len();
        if n < needed {
            return Err(ConstraintError::TooFewPoints {
                what: "spline",
                found: n,
                needed,
            });
        }
        let points = points
            .iter()
            .map(|p| ConstraintError::check_vector("a point of the spline", p))
            .collect::<Result<Vec<_>, _>>()?;
        let spans = match ends {
            Ends::Joined => n,
            Ends::Natural => n - 1,
        };
        let mut knots = vec![0.0];
        for i in 0..spans {
            let length = (points[(i + 1) % n] - points[i]).norm();
            if length == 0.0 {
                return Err(ConstraintError::Coincident {
                    first: i,
                    second: (i + 1) % n,
                });
            }
            knots.push(knots[i] + length);
        }
        let second = second_derivatives(&points, &knots, ends);
        Ok(Self {
            points,
            second,
            knots,
            ends,
        })
    }

    fn length(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    fn at(&self, s: f64) -> CurvePoint {
        let spans = self.knots.len() - 1;
        let s = if self.ends == Ends::Joined {
            s.rem_euclid(self.length())
        } else {
            s
        };
        let inside = s.clamp(0.0, self.length());
        let i = (self.knots.partition_point(|k| *k <= inside).max(1) - 1).min(spans - 1);
        let j = (i + 1) % self.points.len();
        let h = self.knots[i + 1] - self.knots[i];
        let (u, w) = (inside - self.knots[i], self.knots[i + 1] - inside);
        let (p, q, a, b) = (
            self.points[i],
            self.points[j],
            self.second[i],
            self.second[j],
        );
        let first =
            (q - p) / h + a * (h / 6.0 - w * w / (2.0 * h)) + b * (u * u / (2.0 * h) - h / 6.0);
        let beyond = s - inside;
        CurvePoint {
            position: (w * p + u * q) / h
                + a * (w * w * w / (6.0 * h) - h * w / 6.0)
                + b * (u * u * u / (6.0 * h) - h * u / 6.0)
                + beyond * first,
            first,
            second: if beyond == 0.0 {
                (w * a + u * b) / h
            } else {
                Vector3::zeros()
            },
            third: if beyond == 0.0 {
                (b - a) / h
            } else {
                Vector3::zeros()
            },
        }
    }
}

/// Second derivatives `m` at the points from `h_- m_- + 2 (h_- + h_+) m + h_+ m_+ = 6 (slope_+ - slope_-)`,
/// `m = 0` at open ends; by Gauss-Seidel, as the matrix is diagonally dominant by a factor of two: each sweep
/// halves the error at least.
fn second_derivatives(points: &[Vector3<f64>], knots: &[f64], ends: Ends) -> Vec<Vector3<f64>> {
    const SWEEPS: usize = 60;
    let n = points.len();
    let mut m = vec![Vector3::zeros(); n];
    let span = |i: usize| knots[i + 1] - knots[i];
    let range = match ends {
        Ends::Joined => 0..n,
        Ends::Natural => 1..n - 1,
    };
    for _ in 0..SWEEPS {
        for i in range.clone() {
            let (before, after) = ((i + n - 1) % n, (i + 1) % n);
            let (hb, ha) = (span(before), span(i));
            let slopes = (points[after] - points[i]) / ha - (points[i] - points[before]) / hb;
            m[i] = (6.0 * slopes - hb * m[before] - ha * m[after]) / (2.0 * (hb + ha));
        }
    }
    m
}

impl Curve for Spline {
    fn closest(&self, p: &Vector3<f64>) -> CurvePoint {
        let spans = self.knots.len() - 1;
        let distance = |s: f64| (p - self.at(s).position).norm_squared();
        let mut s = 0.0;
        let mut best = f64::INFINITY;
        for i in 0..=spans * SAMPLES {
            let (span, k) = ((i / SAMPLES).min(spans - 1), i % SAMPLES);
            let part = if i == spans * SAMPLES { SAMPLES } else { k };
            let h = self.knots[span + 1] - self.knots[span];
            let here = self.knots[span] + h * part as f64 / SAMPLES as f64;
            let d = distance(here);
            if d < best {
                (best, s) = (d, here);
            }
        }
        let mut at = self.at(s);
        for _ in 0..MAX_ITERATIONS {
            let r = p - at.position;
            let size = at.first.norm_squared();
            // Gauss-Newton where Newton's method would not go downhill.
            let mut slope = size - at.second.dot(&r);
            if slope < 0.1 * size {
                slope = size;
            }
            let mut ds = at.first.dot(&r) / slope;
            // Shorter steps change the distance by round-off only.
            while ds.abs() > 1e-6 * self.length() && distance(s + ds) > best {
                ds *= 0.5;
            }
            s += ds;
            at = self.at(s);
            best = (p - at.position).norm_squared();
            if ds.abs() <= 4.0 * f64::EPSILON * self.length() {
                break;
            }
        }
        at
    }
}
