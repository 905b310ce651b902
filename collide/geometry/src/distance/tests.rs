use super::*;
use crate::testing::{check_jet, place, points, sizes};
use num_dual::{DualNum, HyperDual64};
use proptest::prelude::*;

type Stencil = [Vector3<f64>; 4];
type Pose = [f64; 6];

/// Random stencils and the degenerate ones that break distance routines.
fn stencils() -> impl Strategy<Value = (Stencil, f64, Pose)> {
    let shape = (points::<4>(), 0..9_u8, -14.0..0.0_f64).prop_map(|(mut x, kind, power)| {
        let small = 10.0_f64.powf(power);
        match kind {
            // Coplanar.
            1 => x.iter_mut().for_each(|p| p.z = 0.0),
            // Nearly coplanar.
            2 => x.iter_mut().for_each(|p| p.z *= small),
            // Parallel edges.
            3 => x[3] = x[2] + 0.7 * (x[1] - x[0]),
            // Nearly parallel edges.
            4 => x[3] = x[2] + 0.7 * (x[1] - x[0]) + small * x[3],
            // On one line.
            5 => x.iter_mut().for_each(|p| *p = p.x * Vector3::x()),
            // An edge without length.
            6 => x[3] = x[2],
            // Nearly touching along an edge.
            7 => x[0] = x[1] + 0.4 * (x[2] - x[1]) + small * x[0],
            // A common end.
            8 => x[2] = x[0],
            _ => {}
        }
        x
    });
    (shape, sizes(), proptest::array::uniform6(-1.0..1.0_f64))
}

/// Smallest squared distance over the unit square of weights of two edges, or over the weights of a
/// triangle, by projected coordinate descent from a grid: shares nothing with the closed forms.
fn minimise(x: &Stencil, triangle: bool) -> f64 {
    let value = |s: f64, t: f64| {
        if triangle {
            // The unit square mapped on the triangle, (s, t) -> s (b - a) + (1 - s) t (c - a).
            (x[0] - x[1] - s * (x[2] - x[1]) - (1.0 - s) * t * (x[3] - x[1])).norm_squared()
        } else {
            (x[0] - x[2] + s * (x[1] - x[0]) - t * (x[3] - x[2])).norm_squared()
        }
    };
    let mut best = f64::INFINITY;
    let (mut low, mut width) = ([0.0, 0.0], 1.0_f64);
    // Zooming grid. Each round keeps a window of three cells about the best node; the function is
    // convex in its own weights, so the minimum stays inside up to the anisotropy that the wide
    // window allows for.
    for _ in 0..60 {
        const CELLS: usize = 12;
        let mut at = [0.0, 0.0];
        let mut local = f64::INFINITY;
        for i in 0..=CELLS {
            for j in 0..=CELLS {
                let s = (low[0] + width * i as f64 / CELLS as f64).clamp(0.0, 1.0);
                let t = (low[1] + width * j as f64 / CELLS as f64).clamp(0.0, 1.0);
                let d = value(s, t);
                if d < local {
                    local = d;
                    at = [s, t];
                }
            }
        }
        best = best.min(local);
        width *= 0.6;
        low = at.map(|c| c - 0.5 * width);
    }
    best
}

/// Round-off that the coordinates themselves carry: a few units in the last place of the largest.
fn round_off(x: &Stencil) -> f64 {
    let far = x.iter().map(|p| p.norm()).fold(0.0, f64::max);
    8.0 * f64::EPSILON * far
}

fn check_distance(x: &Stencil, closest: &Closest<4>, triangle: bool) {
    let found = closest.distance();
    let reference = minimise(x, triangle).sqrt();
    let size = x.iter().map(|p| (p - x[0]).norm()).fold(0.0, f64::max);
    assert!(
        found <= reference + 1e-9 * size + round_off(x),
        "{found} above the minimum {reference}, size {size}"
    );
    // The weights are feasible and reproduce the distance, so it cannot be too small.
    let (first, second) = if triangle {
        (&closest.weights[..1], &closest.weights[1..])
    } else {
        (&closest.weights[..2], &closest.weights[2..])
    };
    assert!(first.iter().all(|w| (0.0..=1.0).contains(w)));
    assert!(second.iter().all(|w| (-1.0 - 1e-15..=1e-15).contains(w)));
    assert!((first.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    assert!((second.iter().sum::<f64>() + 1.0).abs() < 1e-15);
    let attained: Vector3<f64> = (0..4).map(|i| closest.weights[i] * x[i]).sum();
    assert!((attained.norm() - found).abs() <= round_off(x));
}

proptest! {
    #![proptest_config(isosheet_random::cases(600))]

    #[test]
    fn distances_are_the_minimum_over_the_weights((x, size, pose) in stencils()) {
        let x = place(&x, size, &pose);
        check_distance(&x, &point_triangle(&x), true);
        check_distance(&x, &edge_edge(&x), false);
        // The lower dimensional ones, as collapsed stencils.
        let three = [x[0], x[1], x[2]];
        let d = point_edge(&three).distance();
        let collapsed = minimise(&[x[0], x[1], x[2], x[2]], true).sqrt();
        prop_assert!((d - collapsed).abs() <= 1e-9 * size + round_off(&x));
        let pair = point_point(&[x[0], x[1]]).distance();
        prop_assert!((pair - (x[0] - x[1]).norm()).abs() <= round_off(&x));
    }

    #[test]
    fn distances_do_not_depend_on_unit_or_order((x, size, _) in stencils()) {
        // Powers of two scale without rounding, so nothing at all may change.
        let unit = size.log2().round().exp2();
        let y = x.map(|p| unit * p);
        for f in [point_triangle, edge_edge] {
            let (a, b) = (f(&x), f(&y));
            prop_assert_eq!(a.feature, b.feature);
            prop_assert_eq!(a.weights, b.weights);
            prop_assert_eq!(a.distance2 * unit * unit, b.distance2);
        }
        let base = edge_edge(&x).distance();
        for y in [[x[2], x[3], x[0], x[1]], [x[1], x[0], x[2], x[3]], [x[0], x[1], x[3], x[2]]] {
            prop_assert!((edge_edge(&y).distance() - base).abs() < 1e-9);
        }
        let base = point_triangle(&x).distance();
        for y in [[x[0], x[2], x[3], x[1]], [x[0], x[2], x[1], x[3]]] {
            prop_assert!((point_triangle(&y).distance() - base).abs() < 1e-9);
        }
    }
}

/// Closed forms of the squared distance on a feature, for automatic differentiation.
mod closed {
    use super::*;
    pub(super) type V<T> = [T; 3];

    pub(super) fn sub<T: DualNum + Copy>(a: V<T>, b: V<T>) -> V<T> {
        std::array::from_fn(|k| a[k] - b[k])
    }
    pub(super) fn dot<T: DualNum + Copy>(a: V<T>, b: V<T>) -> T {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }
    pub(super) fn cross<T: DualNum + Copy>(a: V<T>, b: V<T>) -> V<T> {
        std::array::from_fn(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            a[i] * b[j] - a[j] * b[i]
        })
    }

    pub(super) fn distance2<T: DualNum + Copy>(x: &[V<T>; 4], feature: Feature) -> T {
        match feature {
            Feature::PointPoint { first, second } => {
                let r = sub(x[first], x[second]);
                dot(r, r)
            }
            Feature::PointEdge { point, edge } => {
                let e = sub(x[edge[1]], x[edge[0]]);
                let c = cross(sub(x[point], x[edge[0]]), e);
                dot(c, c) / dot(e, e)
            }
            Feature::PointTriangle => {
                let n = cross(sub(x[2], x[1]), sub(x[3], x[1]));
                let h = dot(sub(x[0], x[1]), n);
                h * h / dot(n, n)
            }
            Feature::EdgeEdge => {
                let n = cross(sub(x[1], x[0]), sub(x[3], x[2]));
                let h = dot(sub(x[0], x[2]), n);
                h * h / dot(n, n)
            }
        }
    }
}

/// Gradient and Hessian along two directions by hyper-dual numbers: exact derivatives of the closed
/// forms.
fn check_derivatives(x: &Stencil, closest: &Closest<4>, directions: &[Stencil; 2]) {
    let jet = closest.jet(x);
    let dual: [closed::V<HyperDual64>; 4] = std::array::from_fn(|i| {
        std::array::from_fn(|k| {
            HyperDual64::new(x[i][k], directions[0][i][k], directions[1][i][k], 0.0)
        })
    });
    let exact = closed::distance2(&dual, closest.feature);
    let slope: f64 = (0..4).map(|i| jet.gradient[i].dot(&directions[0][i])).sum();
    let mut curvature = 0.0;
    let mut largest = 0.0_f64;
    for i in 0..4 {
        for j in 0..4 {
            curvature += directions[0][i].dot(&(jet.hessian[i][j] * directions[1][j]));
            largest = largest.max(jet.hessian[i][j].norm());
            assert!((jet.hessian[i][j] - jet.hessian[j][i].transpose()).norm() <= 1e-9 * largest);
        }
    }
    let size = x.iter().map(|p| (p - x[0]).norm()).fold(0.0, f64::max);
    assert!(
        (slope - exact.eps1).abs() < 1e-8 * size,
        "slope {slope} against {} on {:?}",
        exact.eps1,
        closest.feature
    );
    assert!(
        (curvature - exact.eps1eps2).abs() < 1e-7 * largest.max(1.0),
        "curvature {curvature} against {} on {:?}",
        exact.eps1eps2,
        closest.feature
    );
}

/// Smallest sine of the angles that the Hessian divides by.
fn condition(x: &Stencil, feature: Feature) -> f64 {
    let sine = |a: Vector3<f64>, b: Vector3<f64>| a.cross(&b).norm() / (a.norm() * b.norm());
    match feature {
        Feature::PointTriangle => sine(x[2] - x[1], x[3] - x[1]),
        Feature::EdgeEdge => sine(x[1] - x[0], x[3] - x[2]),
        _ => 1.0,
    }
}

proptest! {
    #![proptest_config(isosheet_random::cases(2000))]

    #[test]
    fn derivatives_match_dual_numbers(
        (x, size, pose) in stencils(),
        a in points::<4>(),
        b in points::<4>(),
    ) {
        let x = place(&x, size, &pose);
        for closest in [point_triangle(&x), edge_edge(&x)] {
            // Hyper-dual quotients lose the digits that nearly parallel directions cost.
            if condition(&x, closest.feature) > 1e-2 {
                check_derivatives(&x, &closest, &[a, b]);
            }
        }
    }

    #[test]
    fn derivatives_match_differences(x in points::<4>(), (size, pose) in (sizes(), proptest::array::uniform6(-1.0..1.0_f64))) {
        let x = place(&x, size, &pose);
        for f in [point_triangle, edge_edge] {
            let closest = f(&x);
            // Away from a change of feature: all weights clear of zero, shapes not thin.
            let clear = closest.weights.iter().all(|w| *w == 0.0 || w.abs() > 1e-3);
            let flips = {
                let y = x.map(|p| p * (1.0 + 1e-13));
                f(&y).feature != closest.feature
            };
            if clear && !flips && condition(&x, closest.feature) > 0.1 && well_inside(&x, f) {
                check_jet(&x, 0.1 * size, &|y| f(y).jet(y));
            }
        }
    }

    #[test]
    fn lower_stencils_match_differences(x in points::<3>(), size in sizes()) {
        let x = x.map(|p| size * p);
        let feature = point_edge(&x).feature;
        let e = x[2] - x[1];
        let t = (x[0] - x[1]).dot(&e) / e.norm_squared();
        if t.abs() > 1e-2 && (t - 1.0).abs() > 1e-2 && e.norm() > 0.2 * size {
            check_jet(&x, 0.1 * size, &|y| {
                let closest = point_edge(y);
                assert_eq!(closest.feature, feature);
                closest.jet(y)
            });
        }
        check_jet(&[x[0], x[1]], size, &|y| point_point(y).jet(y));
    }
}

/// The feature stays the same when every coordinate moves by 1e-4 of the size.
fn well_inside(x: &Stencil, f: fn(&Stencil) -> Closest<4>) -> bool {
    let size = x.iter().map(|p| (p - x[0]).norm()).fold(0.0, f64::max);
    let feature = f(x).feature;
    (0..12).all(|k| {
        [-1e-4, 1e-4].iter().all(|d| {
            let mut y = *x;
            y[k / 3][k % 3] += d * size;
            f(&y).feature == feature
        })
    })
}

#[test]
fn every_feature_is_found() {
    let v = Vector3::new;
    let triangle = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
    let at = |p: Vector3<f64>| point_triangle(&[p, triangle[0], triangle[1], triangle[2]]);
    assert_eq!(at(v(0.2, 0.2, 0.5)).feature, Feature::PointTriangle);
    assert_eq!(at(v(0.2, 0.2, 0.5)).distance2, 0.25);
    for (p, end) in [
        (v(-1.0, -1.0, 0.0), 1),
        (v(3.0, 0.5, 0.0), 2),
        (v(0.5, 3.0, 0.0), 3),
    ] {
        let feature = Feature::PointPoint {
            first: 0,
            second: end,
        };
        assert_eq!(at(p).feature, feature);
    }
    for (p, edge) in [
        (v(0.5, -1.0, 0.0), [1, 2]),
        (v(1.0, 1.0, 0.0), [2, 3]),
        (v(-1.0, 0.5, 0.0), [3, 1]),
    ] {
        assert_eq!(at(p).feature, Feature::PointEdge { point: 0, edge });
    }
    let edge = [v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)];
    let pair = |c, d| edge_edge(&[edge[0], edge[1], c, d]);
    let crossing = pair(v(0.5, -1.0, 0.3), v(0.5, 1.0, 0.3));
    assert_eq!(crossing.feature, Feature::EdgeEdge);
    assert!((crossing.distance() - 0.3).abs() < 1e-15);
    assert_eq!(crossing.weights, [0.25, 0.75, -0.5, -0.5]);
    assert_eq!(
        pair(v(0.5, 1.0, 0.0), v(0.5, 2.0, 0.0)).feature,
        Feature::PointEdge {
            point: 2,
            edge: [0, 1]
        }
    );
    assert_eq!(
        pair(v(2.0, 1.0, 0.0), v(3.0, 2.0, 0.0)).feature,
        Feature::PointPoint {
            first: 1,
            second: 2
        }
    );
    assert_eq!(
        pair(v(1.5, -1.0, 0.0), v(1.5, 1.0, 0.0)).feature,
        Feature::PointEdge {
            point: 1,
            edge: [2, 3]
        }
    );
    // Parallel edges one above the other.
    assert_eq!(pair(v(-3.0, 0.0, 2.0), v(3.0, 0.0, 2.0)).distance(), 2.0);
}

/// Edges of a tenth of a millimetre, where a comparison of a fourth power of the length with the
/// machine precision goes wrong.
#[test]
fn short_edges_keep_their_distance() {
    let v = Vector3::new;
    let h = 1e-4;
    let x = [
        v(0.0, 0.0, 0.0),
        v(h, 0.0, 0.0),
        v(0.5 * h, -h, 0.1 * h),
        v(0.5 * h, h, 0.1 * h),
    ];
    assert!((edge_edge(&x).distance() / h - 0.1).abs() < 1e-14);
}
