//! Squared distances between points, edges and triangles, with all derivatives.
//!
//! Every distance is that of a *stencil* of two to four points. Its minimum over the barycentric
//! weights is attained on one pair of features: two points, a point and a line, a point and a
//! plane, or two lines. On that pair
//!
//! ```text
//! r = sum_i w_i x_i,    D = |r|^2,    dD/dx_i = 2 w_i r,
//! d2D/dx_i dx_j = 2 w_i w_j I - 2 B_i^T (A^T A)^{-1} B_j,    B_i = A^T w_i + a_i r^T,
//! ```
//!
//! where the columns `A_m = dr/dlambda_m = sum_i a_mi x_i` belong to the free weights. The gradient
//! needs no derivative of the weights because they are stationary; the Hessian is the Schur
//! complement that eliminates them.
//!
//! No test compares with an absolute length: results do not depend on the unit.

use nalgebra::{Matrix3, Vector3};

#[cfg(test)]
mod tests;

/// Below this sine of the angle between two directions their cross product is mostly round-off, and
/// the common plane or normal is not used. The features left over are then wrong by less than
/// 1e-10 of the lengths involved.
const DEGENERATE_SINE: f64 = 1e-10;
/// Above this sine the weights of two crossing lines are exact enough to be trusted alone, and so is
/// the common normal; below it the ends are looked at as well.
const RELIABLE_SINE: f64 = 1e-6;

/// The pair of features on which a distance is attained. Numbers are positions in the stencil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Feature {
    /// Two points.
    PointPoint {
        /// The point of the first primitive.
        first: usize,
        /// The point of the second primitive.
        second: usize,
    },
    /// A point and the inside of an edge.
    PointEdge {
        /// The point.
        point: usize,
        /// The ends of the edge.
        edge: [usize; 2],
    },
    /// The point of a point-triangle stencil and the inside of its triangle.
    PointTriangle,
    /// The insides of both edges of an edge-edge stencil.
    EdgeEdge,
}

/// A scalar function of `N` points with its gradient and Hessian by their coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<const N: usize> {
    /// The value.
    pub value: f64,
    /// Derivatives by the points, `gradient[i] = df/dx_i`.
    pub gradient: [Vector3<f64>; N],
    /// Second derivatives, `hessian[i][j] = d2f / dx_i dx_j`, rows at `x_i`; the whole is symmetric.
    pub hessian: [[Matrix3<f64>; N]; N],
}

/// The closest points of two primitives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest<const N: usize> {
    /// Where the distance is attained.
    pub feature: Feature,
    /// Weights of the points in [`Closest::difference`]: positive and adding up to one on the first
    /// primitive, negative and adding up to minus one on the second. The relative velocity of the
    /// closest points is `sum_i w_i v_i`.
    pub weights: [f64; N],
    /// From the closest point of the second primitive to that of the first, `sum_i w_i x_i`, metres.
    pub difference: Vector3<f64>,
    /// Squared distance, square metres.
    pub distance2: f64,
}

impl<const N: usize> Closest<N> {
    /// The weights have to add up to zero.
    fn new(x: &[Vector3<f64>; N], feature: Feature, weights: [f64; N]) -> Self {
        // Relative to one of the points, so that coordinates far from the origin cost no digits.
        let mut difference = Vector3::zeros();
        for i in 1..N {
            difference += weights[i] * (x[i] - x[0]);
        }
        // It is perpendicular to the features, but its round-off is not, and turns a distance that
        // is small against the lengths away from the common normal.
        let (coefficients, count) = feature.tangents::<N>();
        let tangent = |m: usize| tangent(x, &coefficients[m]);
        if count == 1 {
            let e = tangent(0);
            difference -= difference.dot(&e) / e.norm_squared() * e;
        } else if count == 2 {
            let (a, b) = (tangent(0), tangent(1));
            let n = a.cross(&b);
            let nn = n.norm_squared();
            if nn > RELIABLE_SINE * RELIABLE_SINE * a.norm_squared() * b.norm_squared() {
                difference = difference.dot(&n) / nn * n;
            }
        }
        Self {
            feature,
            weights,
            difference,
            distance2: difference.norm_squared(),
        }
    }

    /// Distance, metres.
    pub fn distance(&self) -> f64 {
        self.distance2.sqrt()
    }

    /// Gradient of the squared distance by the points, `2 w_i r`, metres.
    pub fn gradient(&self) -> [Vector3<f64>; N] {
        self.weights.map(|w| 2.0 * w * self.difference)
    }

    /// Squared distance with gradient and Hessian by the points `x` of the stencil.
    ///
    /// The Hessian is that of the current [`Feature`]. It jumps where the feature changes, as the
    /// second derivatives of a distance do; value and gradient are continuous except, for the
    /// gradient of two edges, where they are parallel.
    pub fn jet(&self, x: &[Vector3<f64>; N]) -> Jet<N> {
        let (w, r) = (&self.weights, &self.difference);
        let mut hessian: [[Matrix3<f64>; N]; N] = std::array::from_fn(|i| {
            std::array::from_fn(|j| Matrix3::from_diagonal_element(2.0 * w[i] * w[j]))
        });
        let (coefficients, count) = self.feature.tangents::<N>();
        let tangent =
            |m: usize| -> Vector3<f64> { (1..N).map(|i| coefficients[m][i] * (x[i] - x[0])).sum() };
        // Rows of B: dr/dlambda_m differentiated against x_i.
        let row = |m: usize, a: &Vector3<f64>, i: usize| w[i] * a + coefficients[m][i] * r;
        match count {
            0 => {}
            1 => {
                let a = tangent(0);
                let scale = 2.0 / a.norm_squared();
                for i in 0..N {
                    let left = scale * row(0, &a, i);
                    for j in 0..N {
                        hessian[i][j] -= left * row(0, &a, j).transpose();
                    }
                }
            }
            _ => {
                let (a, b) = (tangent(0), tangent(1));
                let scale = 2.0 / a.cross(&b).norm_squared();
                let (aa, ab, bb) = (a.norm_squared(), a.dot(&b), b.norm_squared());
                for i in 0..N {
                    let (p, q) = (row(0, &a, i), row(1, &b, i));
                    let left = scale * (bb * p - ab * q);
                    let right = scale * (aa * q - ab * p);
                    for j in 0..N {
                        hessian[i][j] -=
                            left * row(0, &a, j).transpose() + right * row(1, &b, j).transpose();
                    }
                }
            }
        }
        Jet {
            value: self.distance2,
            gradient: self.gradient(),
            hessian,
        }
    }
}

impl Feature {
    /// Coefficients `a_mi` of the derivatives of the difference by the free weights, and their
    /// number.
    fn tangents<const N: usize>(self) -> ([[f64; N]; 2], usize) {
        let mut a = [[0.0; N]; 2];
        match self {
            Self::PointPoint { .. } => (a, 0),
            Self::PointEdge { edge, .. } => {
                a[0][edge[0]] = 1.0;
                a[0][edge[1]] = -1.0;
                (a, 1)
            }
            Self::PointTriangle => {
                a[0][1] = 1.0;
                a[0][2] = -1.0;
                a[1][1] = 1.0;
                a[1][3] = -1.0;
                (a, 2)
            }
            Self::EdgeEdge => {
                a[0][0] = -1.0;
                a[0][1] = 1.0;
                a[1][2] = 1.0;
                a[1][3] = -1.0;
                (a, 2)
            }
        }
    }
}

/// `sum_i a_i x_i` with coefficients that add up to zero.
fn tangent<const N: usize>(x: &[Vector3<f64>; N], a: &[f64; N]) -> Vector3<f64> {
    (1..N).map(|i| a[i] * (x[i] - x[0])).sum()
}

/// Distance of two points `[p, q]`.
pub fn point_point(x: &[Vector3<f64>; 2]) -> Closest<2> {
    let feature = Feature::PointPoint {
        first: 0,
        second: 1,
    };
    Closest::new(x, feature, [1.0, -1.0])
}

/// Distance of a point and an edge, stencil `[p, a, b]`. The edge may have no length.
pub fn point_edge(x: &[Vector3<f64>; 3]) -> Closest<3> {
    end_and_edge(x, 0, [1, 2], 1.0).closest(x)
}

/// Distance of a point and a triangle, stencil `[p, a, b, c]`. The triangle may have no area.
pub fn point_triangle(x: &[Vector3<f64>; 4]) -> Closest<4> {
    let (u, v, w) = (x[2] - x[1], x[3] - x[1], x[0] - x[1]);
    let n = u.cross(&v);
    let nn = n.norm_squared();
    if nn > DEGENERATE_SINE * DEGENERATE_SINE * u.norm_squared() * v.norm_squared() {
        let solve = |w: &Vector3<f64>| [w.cross(&v).dot(&n) / nn, u.cross(w).dot(&n) / nn];
        let [b, c] = solve(&w);
        // One refinement: slivers lose digits in the first solution.
        let [db, dc] = solve(&(w - b * u - c * v));
        let (b, c) = (b + db, c + dc);
        if b >= 0.0 && c >= 0.0 && b + c <= 1.0 {
            return Closest::new(x, Feature::PointTriangle, [1.0, -(1.0 - b - c), -b, -c]);
        }
    }
    let edges = [[1, 2], [2, 3], [3, 1]].map(|edge| end_and_edge(x, 0, edge, 1.0));
    nearest(edges).closest(x)
}

/// Distance of two edges, stencil `[a, b, c, d]` with the edges `ab` and `cd`. Either may have no
/// length; they may be parallel.
pub fn edge_edge(x: &[Vector3<f64>; 4]) -> Closest<4> {
    let (u, v, w) = (x[1] - x[0], x[3] - x[2], x[0] - x[2]);
    let n = u.cross(&v);
    let nn = n.norm_squared();
    let squares = u.norm_squared() * v.norm_squared();
    let mut crossing = None;
    if nn > DEGENERATE_SINE * DEGENERATE_SINE * squares {
        let solve = |w: &Vector3<f64>| [v.cross(w).dot(&n) / nn, u.cross(w).dot(&n) / nn];
        let [s, t] = solve(&w);
        let [ds, dt] = solve(&(w + s * u - t * v));
        let (s, t) = (s + ds, t + dt);
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            let closest = Closest::new(x, Feature::EdgeEdge, [1.0 - s, s, t - 1.0, -t]);
            if nn > RELIABLE_SINE * RELIABLE_SINE * squares {
                return closest;
            }
            crossing = Some(closest);
        }
    }
    let ends = nearest([
        end_and_edge(x, 0, [2, 3], 1.0),
        end_and_edge(x, 1, [2, 3], 1.0),
        end_and_edge(x, 2, [0, 1], -1.0),
        end_and_edge(x, 3, [0, 1], -1.0),
    ]);
    match crossing {
        Some(crossing) if crossing.distance2 <= ends.distance2 => crossing,
        _ => ends.closest(x),
    }
}

/// A pair of features, the weights of the closest points, and their squared distance but for round-off of
/// the lengths.
#[derive(Debug, Clone, Copy)]
struct Place<const N: usize> {
    feature: Feature,
    weights: [f64; N],
    distance2: f64,
}

impl<const N: usize> Place<N> {
    fn closest(&self, x: &[Vector3<f64>; N]) -> Closest<N> {
        Closest::new(x, self.feature, self.weights)
    }
}

/// The first of the places with the smallest distance.
fn nearest<const N: usize, const M: usize>(places: [Place<N>; M]) -> Place<N> {
    let mut best = places[0];
    for other in &places[1..] {
        if other.distance2 < best.distance2 {
            best = *other;
        }
    }
    best
}

/// Distance of one point of a stencil and an edge between two others; `sign` is that of the point's
/// weight.
fn end_and_edge<const N: usize>(
    x: &[Vector3<f64>; N],
    point: usize,
    edge: [usize; 2],
    sign: f64,
) -> Place<N> {
    let (e, from) = (x[edge[1]] - x[edge[0]], x[point] - x[edge[0]]);
    let (along, ee) = (from.dot(&e), e.norm_squared());
    let mut weights = [0.0; N];
    weights[point] = sign;
    let ends = |end: usize| {
        let (first, second) = if sign > 0.0 {
            (point, end)
        } else {
            (end, point)
        };
        Feature::PointPoint { first, second }
    };
    let (feature, t) = if along <= 0.0 {
        weights[edge[0]] = -sign;
        (ends(edge[0]), 0.0)
    } else if along >= ee {
        weights[edge[1]] = -sign;
        (ends(edge[1]), 1.0)
    } else {
        let t = along / ee;
        weights[edge[0]] = -sign * (1.0 - t);
        weights[edge[1]] = -sign * t;
        (Feature::PointEdge { point, edge }, t)
    };
    Place {
        feature,
        weights,
        distance2: (from - t * e).norm_squared(),
    }
}
