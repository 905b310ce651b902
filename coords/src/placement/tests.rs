//! Placement functions and coordinate frames against finite differences, dual numbers and closed forms.

use super::*;
use crate::frames::EulerParameters;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

const TOL: f64 = 1e-13;

fn point() -> impl Strategy<Value = [f64; 3]> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0f64]
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    norm(&sub(a, b))
}

fn close(a: &[f64; 3], b: &[f64; 3], tolerance: f64) -> bool {
    distance(a, b) <= tolerance
}

/// Fourth-order central difference of a vector function along one input component.
fn difference(f: impl Fn(f64) -> [f64; 3], h: f64) -> [f64; 3] {
    let mut d = [0.0; 3];
    let (a, b, c, e) = (f(-2.0 * h), f(-h), f(h), f(2.0 * h));
    for i in 0..3 {
        d[i] = (a[i] - 8.0 * b[i] + 8.0 * c[i] - e[i]) / (12.0 * h);
    }
    d
}

fn moved(x: &[f64; 3], j: usize, t: f64) -> [f64; 3] {
    let mut y = *x;
    y[j] += t;
    y
}

fn block_column(b: &PositionDerivative, j: usize) -> [f64; 3] {
    [b[0][j], b[1][j], b[2][j]]
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    #[test]
    fn h_places_and_inverts(k in point(), axis in point(), r in 0.1..3.0f64, l in -3.0..3.0f64, p in -1.4..1.4f64) {
        prop_assume!(norm(&axis) > 0.1);
        let frame = SphericalFrame::along(&axis).unwrap();
        let x = place_h(&k, r, &frame, [l, p]);
        prop_assert!((distance(&x, &k) - r).abs() < 1e-14 * 4.0 * (1.0 + r));
        let q = frame.coordinates(&k, &x);
        prop_assert!((q[0] - l).abs() < 1e-13 && (q[1] - p).abs() < 1e-13);
        let jac = jacobian_h(&k, &frame, &x).unwrap();
        for j in 0..3 {
            let d = difference(|t| place_h(&moved(&k, j, t), r, &frame, [l, p]), 1e-3);
            prop_assert!(close(&d, &block_column(&jac.known, j), 1e-9));
        }
        let d = difference(|t| place_h(&k, r, &frame, [l + t, p]), 1e-3);
        prop_assert!(close(&d, &jac.q[0], 1e-9 * (1.0 + r)));
        let d = difference(|t| place_h(&k, r, &frame, [l, p + t]), 1e-3);
        prop_assert!(close(&d, &jac.q[1], 1e-9 * (1.0 + r)));
        // The rows are the inverse of the derivatives: s_i . dx/dq_j = delta_ij.
        let rows = frame.gradient(&k, &x).unwrap();
        for i in 0..2 {
            for j in 0..2 {
                let delta = f64::from(u8::from(i == j));
                prop_assert!((dot(&rows[i], &jac.q[j]) - delta).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn g_places_and_inverts(a in point(), b in point(), rest in [point(), point(), point()], q in -3.1..3.1f64, shape in [0.3..0.9f64, 0.3..1.2f64]) {
        let frame = match EdgeFrame::from_triangle([&rest[0], &rest[1], &rest[2]]) { Ok(f) => f, Err(_) => return Ok(()) };
        prop_assume!(distance(&a, &b) > 0.2);
        let frame = frame.at_edge(&a, &b);
        let span = distance(&a, &b);
        let r = [span * shape[0].hypot(shape[1]), span * (1.0 - shape[0]).hypot(shape[1])];
        let x = place_g([&a, &b], r, &frame, q, TOL).unwrap().position;
        prop_assert!((distance(&x, &a) / r[0] - 1.0).abs() < 1e-13);
        prop_assert!((distance(&x, &b) / r[1] - 1.0).abs() < 1e-13);
        prop_assert!((frame.coordinate([&a, &b, &x]).unwrap() - q).abs() < 1e-12);
        let jac = jacobian_g([&a, &b], &frame, &x).unwrap();
        let place = |a: [f64; 3], b: [f64; 3], q: f64| place_g([&a, &b], r, &frame, q, TOL).unwrap().position;
        for j in 0..3 {
            let d = difference(|t| place(moved(&a, j, t), b, q), 1e-4);
            prop_assert!(close(&d, &block_column(&jac.known[0], j), 1e-8), "{d:?} {:?}", jac.known[0]);
            let d = difference(|t| place(a, moved(&b, j, t), q), 1e-4);
            prop_assert!(close(&d, &block_column(&jac.known[1], j), 1e-8));
        }
        let d = difference(|t| place(a, b, q + t), 1e-3);
        prop_assert!(close(&d, &jac.q, 1e-9));
    }

    #[test]
    fn f_places_both_branches(known in [point(), point(), point()], x in point()) {
        let k = [&known[0], &known[1], &known[2]];
        let n = cross(&sub(k[1], k[0]), &sub(k[2], k[0]));
        let height = dot(&n, &sub(&x, k[0])) / norm(&n);
        prop_assume!(collinearity(k) > 0.2 && height.abs() > 0.2);
        let r = k.map(|a| distance(&x, a));
        let (branch, other) =
            if height > 0.0 { (Branch::Above, Branch::Below) } else { (Branch::Below, Branch::Above) };
        prop_assert!(close(&place_f(k, r, branch, TOL).unwrap().position, &x, 1e-12));
        let mirror = axpy(&x, -2.0 * height / norm(&n), &n);
        prop_assert!(close(&place_f(k, r, other, TOL).unwrap().position, &mirror, 1e-12));
        prop_assert!(close(&place_f(k, r, Branch::Near(x), TOL).unwrap().position, &x, 1e-12));
        prop_assert!(close(&place_f(k, r, Branch::Near(mirror), TOL).unwrap().position, &mirror, 1e-12));
        let jac = jacobian_f(k, &x).unwrap();
        for m in 0..3 {
            for j in 0..3 {
                let d = difference(|t| {
                    let mut k = known;
                    k[m] = moved(&k[m], j, t);
                    place_f([&k[0], &k[1], &k[2]], r, Branch::Near(x), TOL).unwrap().position
                }, 1e-4);
                let size = 1.0 + jac[m].iter().map(norm).sum::<f64>();
                prop_assert!(close(&d, &block_column(&jac[m], j), 1e-6 * size * size));
            }
        }
    }

    #[test]
    fn gradients_and_rates(v in [point(), point(), point()], u in [point(), point(), point()], rest in [point(), point(), point()]) {
        let frame = match EdgeFrame::from_triangle([&rest[0], &rest[1], &rest[2]]) { Ok(f) => f, Err(_) => return Ok(()) };
        prop_assume!(distance(&v[0], &v[1]) > 0.2);
        let frame = frame.at_edge(&v[0], &v[1]);
        let along = |t: f64| {
            let mut w = v;
            for i in 0..3 { w[i] = axpy(&v[i], t, &u[i]); }
            w
        };
        let b = scale(&sub(&v[1], &v[0]), 1.0 / distance(&v[0], &v[1]));
        prop_assume!(norm(&cross(&b, &sub(&v[2], &v[0]))) > 0.2);
        let s = frame.gradient([&v[0], &v[1], &v[2]]).unwrap();
        // The directional derivative of the angle, without its jump at pi.
        let angle = |t: f64| { let w = along(t); frame.coordinate([&w[0], &w[1], &w[2]]).unwrap() };
        let q0 = angle(0.0);
        let d = difference(|t| { let q = angle(t) - q0; [q.sin().atan2(q.cos()), 0.0, 0.0] }, 1e-4)[0];
        let exact: f64 = (0..3).map(|i| dot(&s[i], &u[i])).sum();
        prop_assert!((d - exact).abs() < 1e-6 * (1.0 + exact.abs()), "{d} {exact}");
        let rate = frame.gradient_rate([&v[0], &v[1], &v[2]], [&u[0], &u[1], &u[2]]).unwrap();
        for i in 0..3 {
            let d = difference(|t| { let w = along(t); frame.gradient([&w[0], &w[1], &w[2]]).unwrap()[i] }, 1e-4);
            prop_assert!(close(&d, &rate[i], 1e-5 * (1.0 + norm(&rate[i]))), "{d:?} {:?}", rate[i]);
        }
        let ball = SphericalFrame::along(&sub(&rest[1], &rest[0])).unwrap();
        let e = sub(&v[1], &v[0]);
        let c = ball.axes().map(|a| dot(&a, &e));
        prop_assume!(c[0].hypot(c[1]) > 0.1);
        let rate = ball.gradient_rate([&v[0], &v[1]], [&u[0], &u[1]]).unwrap();
        for i in 0..2 {
            let d = difference(|t| { let w = along(t); ball.gradient(&w[0], &w[1]).unwrap()[i] }, 1e-4);
            prop_assert!(close(&d, &rate[i], 1e-5 * (1.0 + norm(&rate[i]))));
        }
    }

    #[test]
    fn g_is_the_published_construction(rest in [point(), point(), point()], turn in point(), shift in point(), q in -3.1..3.1f64) {
        // v_III = A(q) A(theta) (v_III^0 - v_I^0) + v_I (Sec. 3.5), literally, away from its 0/0 cases.
        let e0 = sub(&rest[1], &rest[0]);
        let span = norm(&e0);
        prop_assume!(span > 0.2 && norm(&turn) > 0.2);
        let b = scale(&turn, 1.0 / norm(&turn));
        let a = scale(&e0, 1.0 / span);
        prop_assume!(norm(&cross(&a, &b)) > 0.05);
        let r = cross(&a, &b);
        let theta = norm(&r).atan2(dot(&a, &b));
        let align = EulerParameters::about(&scale(&r, 1.0 / norm(&r)), theta);
        let d = EulerParameters::about(&b, q).rotate(&align.rotate(&sub(&rest[2], &rest[0])));
        let literal = add(&d, &shift);
        let second = axpy(&shift, span, &b);
        let frame = EdgeFrame::from_triangle([&rest[0], &rest[1], &rest[2]]).unwrap();
        let lengths = [distance(&rest[2], &rest[0]), distance(&rest[2], &rest[1])];
        prop_assume!(norm(&cross(&a, &sub(&rest[2], &rest[0]))) > 0.05);
        let mine = place_g([&shift, &second], lengths, &frame, q, TOL).unwrap().position;
        prop_assert!(close(&mine, &literal, 1e-12), "{mine:?} {literal:?}");
        let smooth = EulerParameters::aligning(&a, &b, &[0.0, 0.0, 1.0]);
        prop_assert!((smooth.scalar - align.scalar).abs() < 1e-13 && close(&smooth.vector, &align.vector, 1e-12));
    }
}

#[test]
fn aligned_and_antiparallel_edges() {
    let rest = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.8, 0.0]];
    let frame = EdgeFrame::from_triangle([&rest[0], &rest[1], &rest[2]]).unwrap();
    // Not turned at all: identity, coordinate zero.
    assert_eq!(
        EulerParameters::aligning(&[1.0, 0.0, 0.0], &[1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]).matrix(),
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    );
    assert!(
        frame
            .coordinate([&rest[0], &rest[1], &rest[2]])
            .unwrap()
            .abs()
            < 1e-15
    );
    // Reversed: refused by the frame itself, smooth after turning it about the rest normal.
    let back = [[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [-0.3, -0.8, 0.0]];
    assert!(matches!(
        frame.coordinate([&back[0], &back[1], &back[2]]),
        Err(PlacementError::Antiparallel { .. })
    ));
    let turned = frame.at_edge(&back[0], &back[1]);
    assert!(
        turned
            .coordinate([&back[0], &back[1], &back[2]])
            .unwrap()
            .abs()
            < 1e-15
    );
    let about_normal =
        EulerParameters::aligning(&[1.0, 0.0, 0.0], &[-1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]);
    assert!(close(&about_normal.rotate(&rest[2]), &back[2], 1e-15));
    for y in [-1e-9, 0.0, 1e-9] {
        let second = [-1.0, y, 0.0];
        let q = turned.coordinate([&back[0], &second, &back[2]]).unwrap();
        assert!(q.abs() < 1e-8);
    }
}

#[test]
fn the_case_of_figure_7() {
    let (a, b, c) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
    let x = [1.0, 0.6, 0.8];
    let r = [a, b, c].map(|k| distance(&k, &x));
    assert!(matches!(
        place_f([&a, &b, &c], r, Branch::Near(x), TOL),
        Err(PlacementError::Collinear { .. })
    ));
    // The angle about the line is the previous one, whatever the previous distance was.
    let near = [1.1, 1.2, 1.6];
    let p = place_on_line([&a, &c], [r[0], r[2]], &near, TOL).unwrap();
    assert!(close(&p.position, &x, 1e-14));
    assert!(matches!(
        place_on_line([&a, &c], [r[0], r[2]], &[0.5, 0.0, 0.0], TOL),
        Err(PlacementError::OnAxis { .. })
    ));
    // The criterion is relative.
    let small = [a, b, [2.0, 1e-3, 0.0]].map(|k| scale(&k, 1e-9));
    let s = collinearity([&small[0], &small[1], &small[2]]);
    assert!((s - 2.5e-4).abs() < 3e-4 && s > COLLINEAR);
}

#[test]
fn refusals() {
    let (a, b, c) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    assert!(matches!(
        place_f([&a, &b, &c], [0.4, 0.4, 0.4], Branch::Above, TOL),
        Err(PlacementError::OutOfReach { height_squared }) if height_squared < -1.0
    ));
    let frame = EdgeFrame::from_triangle([&a, &b, &c]).unwrap();
    assert!(place_g([&a, &b], [0.4, 0.4], &frame, 0.0, TOL).is_err());
    assert!(
        place_f(
            [&a, &b, &[f64::NAN, 0.0, 0.0]],
            [1.0; 3],
            Branch::Above,
            TOL
        )
        .is_err()
    );
    assert!(SphericalFrame::along(&[0.0; 3]).is_err());
    // Coplanar: placed, but without a derivative.
    let x = [0.3, 0.4, 0.0];
    let r = [a, b, c].map(|k| distance(&k, &x));
    let p = place_f([&a, &b, &c], r, Branch::Above, TOL).unwrap();
    assert!(close(&p.position, &x, 1e-15));
    assert_eq!(
        jacobian_f([&a, &b, &c], &x).unwrap_err(),
        PlacementError::Flat
    );
    // The poles of a horizontal edge are horizontal: it can fall all the way without meeting one.
    let fall = SphericalFrame::along(&[0.6, 0.8, 0.0]).unwrap();
    for t in [0.3f64, 1.2, 1.57, 2.5] {
        let q = fall.coordinates(&a, &[0.6 * t.cos(), 0.8 * t.cos(), -t.sin()]);
        assert!(
            (q[0].abs() - t).abs() < 1e-15 && q[1].abs() < 1e-15,
            "{q:?}"
        );
    }
    // At a pole the latitude is a right angle and the longitude has no gradient.
    let ball = SphericalFrame::along(&[1.0, 0.0, 0.0]).unwrap();
    let pole = ball.axes()[2];
    assert!((ball.coordinates(&a, &pole)[1] - FRAC_PI_2).abs() < 1e-15);
    assert!(matches!(
        ball.gradient(&a, &pole),
        Err(PlacementError::Pole { .. })
    ));
    assert!((EulerParameters::about(&[0.0, 0.0, 1.0], PI).rotate(&b)[0] + 1.0).abs() < 1e-15);
}
