use proptest::prelude::*;

use super::*;
use crate::generate;

/// Two triangles on the edge from (0, 0, 0) to (0, l, 0), the left one to the left (-x) of it, folded by
/// `fold`.
fn hinge(l: f64, left: [f64; 2], right: [f64; 2], fold: f64) -> (Sheet, Vec<f64>) {
    // left, right: distance from the edge's line, coordinate along it.
    let flat = vec![
        0.0, 0.0, 0.0, 0.0, l, 0.0, -left[0], left[1], 0.0, right[0], right[1], 0.0,
    ];
    let sheet = Sheet::new(flat.clone(), &[[0, 1, 2], [1, 0, 3]]).unwrap();
    let mut x = flat;
    (x[9], x[11]) = (right[0] * fold.cos(), right[0] * fold.sin());
    (sheet, x)
}

fn hinge_edge(s: &Sheet) -> EdgeId {
    s.topology().find_edge(VertexId(0), VertexId(1)).unwrap()
}

#[test]
fn valleys_are_positive() {
    for fold in [-3.1, -1.0, -1e-9, 0.0, 1e-9, 0.5, 2.0, 3.1] {
        let (s, x) = hinge(1.0, [0.7, 0.3], [0.5, 0.6], fold);
        let found = fold_angle(s.topology(), &x, hinge_edge(&s)).unwrap();
        assert!((found - fold).abs() < 1e-15, "{found} against {fold}");
    }
    // Both wings raised towards +z, the side from which faces are counter-clockwise: a valley.
    let (s, _) = hinge(1.0, [0.7, 0.3], [0.5, 0.6], 0.0);
    let raised = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -0.6, 0.3, 0.2, 0.4, 0.6, 0.2];
    assert!(fold_angle(s.topology(), &raised, hinge_edge(&s)).unwrap() > 0.0);
    assert_eq!(
        fold_angle(
            s.topology(),
            s.positions(),
            s.topology().find_edge(VertexId(0), VertexId(2)).unwrap()
        ),
        None
    );
}

#[test]
fn angles_from_lengths_keep_their_digits() {
    assert!((angle_from_lengths(3.0, 4.0, 5.0) - PI / 2.0).abs() < 1e-15);
    assert!((angle_from_lengths(1.0, 1.0, 1.0) - PI / 3.0).abs() < 1e-15);
    // Nearly zero: chord of a small angle.
    let small = 1e-7;
    let chord = 2.0 * (0.5f64 * small).sin();
    assert!((angle_from_lengths(1.0, 1.0, chord) / small - 1.0).abs() < 1e-12);
    assert_eq!(angle_from_lengths(1.0, 1.0, 0.0), 0.0);
    assert_eq!(angle_from_lengths(1.0, 2.0, 3.0), PI);
    assert_eq!(angle_from_lengths(1.0, 2.0, 4.0), PI);
    assert_eq!(angle_from_lengths(1.0, 2.0, 0.5), 0.0);
}

#[test]
fn the_paper_bound_is_not_enough_beyond_a_straight_angle() {
    // At the first end alpha + beta > pi: gamma <= pi < alpha + beta always holds, but the flat gamma is 2 pi
    // - sum.
    let (s, x) = hinge(1.0, [0.6, -0.4], [0.6, -0.4], 0.0);
    let a = EdgeAngles::at(&s, &x, hinge_edge(&s)).unwrap();
    assert!(a.ends[0].alpha + a.ends[0].beta > PI);
    assert!((a.ends[0].gamma - (TAU - a.ends[0].alpha - a.ends[0].beta)).abs() < 1e-12);
    let pulled = EdgeAngles::with_distance(&s, a.edge, 1.1 * a.distance).unwrap();
    assert!(
        pulled.ends[0].gamma <= a.ends[0].alpha + a.ends[0].beta,
        "Eq. 10 does not notice"
    );
    assert!(
        pulled.ends[0].margin() < 0.0 && pulled.ends[1].margin() < 0.0 && pulled.margin() < 0.0
    );
}

#[test]
fn a_strained_state_is_refused_by_name() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    check_compatibility(&sheet, sheet.positions(), COMPATIBILITY_TOLERANCE).unwrap();
    let mut x = sheet.positions().to_vec();
    x[0] -= 0.2; // a corner pulled out in the plane
    let error = check_compatibility(&sheet, &x, COMPATIBILITY_TOLERANCE).unwrap_err();
    let AngleError::Incompatible {
        edge,
        ends,
        triples,
        worse,
        distance,
        range,
    } = error;
    let t = sheet.topology();
    assert!(t.opposite_vertices(edge).contains(&Some(VertexId(0))));
    assert_eq!(ends, t.edges()[edge.index()]);
    assert!(triples[worse].margin() < 0.0 && distance > range[1]);
    let text = error.to_string();
    for word in [
        edge.to_string(),
        ends[worse].to_string(),
        "alpha".into(),
        "Eq. 10".into(),
    ] {
        assert!(text.contains(&word), "{text}");
    }
    // A nearly flat tent over the same edges is compatible only to its strain.
    x[0] += 0.2;
    x[3 * 12 + 2] = 1e-3;
    assert!(check_compatibility(&sheet, &x, 1e-9).is_err());
    check_compatibility(&sheet, &x, 1e-3).unwrap();
    x[3 * 12 + 2] = f64::NAN;
    assert!(check_compatibility(&sheet, &x, 1e-3).is_err());
}

#[test]
fn flatness_from_lengths() {
    let bent = generate::isotropic_square(1, 1.0).unwrap();
    assert!(bent.flatness_defect().unwrap().1.abs() < 1e-13);
    bent.check_developable(1e-9).unwrap();
    assert!(
        generate::strip(3, 1.0, 0.2, generate::Diagonals::Rising)
            .unwrap()
            .flatness_defect()
            .is_none()
    );
    // A corner of a cube: three right angles.
    let corner = Sheet::new(
        vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        &[[0, 1, 2], [0, 2, 3], [0, 3, 1]],
    )
    .unwrap();
    let (v, defect) = corner.flatness_defect().unwrap();
    assert_eq!(v, VertexId(0));
    assert!((defect - PI / 2.0).abs() < 1e-15);
    assert!(matches!(
        corner.check_developable(1e-6),
        Err(MeshError::NotDevelopable {
            vertex: VertexId(0),
            ..
        })
    ));
    // Gauss-Bonnet on a closed surface: the defects add up to 2 pi chi.
    let (n, faces) = crate::tests::surfaces::octahedron();
    let x = (0..3 * n).map(|k| (7.3 * (k * k) as f64).sin()).collect();
    let s = Sheet::new(x, &faces).unwrap();
    let total: f64 = s
        .topology()
        .vertex_ids()
        .map(|v| TAU - s.angle_sum(v))
        .sum();
    assert!((total - 2.0 * TAU).abs() < 1e-12);
}

fn wing() -> impl Strategy<Value = [f64; 2]> {
    [0.05..2.0f64, -1.5..2.5f64]
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    /// In any folded state the triples are compatible, measured gamma is theirs, and the fold angle comes
    /// back.
    #[test]
    fn folds_are_compatible(l in 0.2..2.0f64, left in wing(), right in wing(), fold in -PI..PI) {
        let (s, x) = hinge(l, left, right, fold);
        let e = hinge_edge(&s);
        let a = EdgeAngles::at(&s, &x, e).unwrap();
        prop_assert!(a.margin() > -1e-12);
        check_compatibility(&s, &x, 1e-12).unwrap();
        for (k, triple) in a.ends.iter().enumerate() {
            let v = s.topology().edges()[e.index()][k];
            let (p, q) = (sub(at(&x, VertexId(2)), at(&x, v)), sub(at(&x, VertexId(3)), at(&x, v)));
            let measured = norm(cross(p, q)).atan2(dot(p, q));
            prop_assert!((triple.gamma - measured).abs() < 1e-6, "{} against {measured}", triple.gamma);
            // Near flat and shut the fold angle depends on gamma like a square root.
            prop_assert!((triple.fold() - fold.abs()).abs() < 1e-5, "{} against {fold}", triple.fold());
        }
    }

    /// The two triples of an edge are equivalent: both are compatible, or neither is, whatever the distance.
    #[test]
    fn triples_of_an_edge_are_equivalent(
        l in 0.2..2.0f64,
        left in wing(),
        right in wing(),
        factor in 0.0..1.6f64,
    ) {
        let (s, _) = hinge(l, left, right, 0.0);
        let e = hinge_edge(&s);
        let most = EdgeAngles::with_distance(&s, e, 1.0).unwrap().range[1];
        let a = EdgeAngles::with_distance(&s, e, factor * most).unwrap();
        // At a bound rounding decides.
        prop_assume!(a.margin().abs() > 1e-9);
        prop_assert_eq!(a.ends[0].margin() > 0.0, a.margin() > 0.0, "{:?}", a);
        prop_assert_eq!(a.ends[1].margin() > 0.0, a.margin() > 0.0, "{:?}", a);
    }

    /// The fold angle of any hinge agrees in size with the spherical triangles at both ends.
    #[test]
    fn corner_angles_close(l in 0.2..2.0f64, left in wing(), right in wing()) {
        let (s, _) = hinge(l, left, right, 0.0);
        for f in s.topology().face_ids() {
            prop_assert!((s.corner_angles(f).iter().sum::<f64>() - PI).abs() < 1e-13);
        }
        // Against the angles measured in the plane.
        let c = s.corner_angles(FaceId(0));
        prop_assert!((c[0] - left[0].atan2(left[1])).abs() < 1e-12);
    }
}

#[test]
fn angles_are_followed_beyond_half_a_turn() {
    for (angle, near, expected) in [
        (3.0, 3.1, 3.0),
        (-3.0, 3.1, TAU - 3.0),
        (3.0, -3.1, 3.0 - TAU),
        (0.5, 9.0 * TAU, 9.0 * TAU + 0.5),
    ] {
        assert!((angle_near(angle, near) - expected).abs() < 1e-14 * 9.0 * TAU);
    }
}
