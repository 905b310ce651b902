use super::*;
use crate::distance::Jet;
use crate::testing::{check_jet, points};
use proptest::prelude::*;

/// A closed surface with sharp convex and concave edges: a cube whose corners are pushed in and out.
fn star(radii: &[f64; 8]) -> (Vec<f64>, Vec<[u32; 3]>) {
    let mut x = Vec::new();
    for (i, r) in radii.iter().enumerate() {
        for k in 0..3 {
            x.push(r * if i >> k & 1 == 1 { 1.0 } else { -1.0 });
        }
    }
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let faces = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    (x, faces)
}

/// Solid angle of the surface seen from `p` over 4 pi, Van Oosterom and Strackee 1983: 1 inside.
fn winding(s: &TriangleSurface, p: &Vector3<f64>) -> f64 {
    let mut sum = 0.0;
    for f in s.mesh().faces() {
        let [a, b, c] = f.map(|v| s.positions()[v as usize] - p);
        let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
        let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        sum += 2.0 * a.dot(&b.cross(&c)).atan2(below);
    }
    sum / (4.0 * std::f64::consts::PI)
}

proptest! {
    #![proptest_config(isosheet_random::cases(1000))]

    #[test]
    fn distances_are_signed_and_smallest(radii in proptest::array::uniform8(0.2..1.0_f64), p in points::<1>()) {
        let (x, faces) = star(&radii);
        let s = TriangleSurface::new(&x, &faces).unwrap();
        prop_assert!(s.is_closed());
        let p = 1.2 * p[0];
        let found = s.signed_distance(&p);
        let brute = (0..faces.len() as u32)
            .map(|f| point_triangle(&s.stencil(&p, f)).distance())
            .fold(f64::INFINITY, f64::min);
        prop_assert!((found.value.abs() - brute).abs() < 1e-15);
        if brute > 1e-9 {
            let inside = winding(&s, &p) > 0.5;
            prop_assert_eq!(found.value < 0.0, inside);
        }
        prop_assert!((found.normal.norm() - 1.0).abs() < 1e-12);
        // The closest point is on the surface.
        prop_assert!(s.signed_distance(&found.closest(&p)).value.abs() < 1e-12);
    }

    #[test]
    fn derivatives_match_differences(radii in proptest::array::uniform8(0.2..1.0_f64), p in points::<1>(), open in 0..2_usize) {
        let (x, faces) = star(&radii);
        let s = TriangleSurface::new(&x, &faces[open..]).unwrap();
        prop_assert_eq!(s.is_closed(), open == 0);
        let p = 1.5 * p[0];
        let base = s.signed_distance(&p);
        let steady = (0..6).all(|k| {
            let mut q = p;
            q[k / 2] += if k % 2 == 0 { 1e-3 } else { -1e-3 };
            let d = s.signed_distance(&q);
            (d.hessian - base.hessian).norm() < 0.3 && (d.normal - base.normal).norm() < 0.1
        });
        if steady && base.value.abs() > 0.08 {
            check_jet(&[p], 0.03, &|q| {
                let d = s.signed_distance(&q[0]);
                Jet { value: d.value, gradient: [d.normal], hessian: [[d.hessian]] }
            });
        }
    }
}

#[test]
fn a_ball_of_triangles_is_nearly_a_ball() {
    // Latitudes and longitudes.
    let (n, m) = (40_u32, 80_u32);
    let mut x = vec![0.0, 0.0, 1.0, 0.0, 0.0, -1.0];
    for i in 1..n {
        for j in 0..m {
            let (a, b) = (
                std::f64::consts::PI * f64::from(i) / f64::from(n),
                std::f64::consts::TAU * f64::from(j) / f64::from(m),
            );
            x.extend([a.sin() * b.cos(), a.sin() * b.sin(), a.cos()]);
        }
    }
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == n => 1,
        i => 2 + (i - 1) * m + j % m,
    };
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if i + 1 < n {
                faces.push([a, b, c]);
            }
            if i > 0 {
                faces.push([a, c, d]);
            }
        }
    }
    let s = TriangleSurface::new(&x, &faces).unwrap();
    assert!(s.is_closed());
    // The sag of the longest side.
    let sag = 1.0 - (std::f64::consts::PI / f64::from(n)).cos();
    for p in [
        [0.3, -0.2, 0.1],
        [1.0, 2.0, -0.5],
        [0.0, 0.9, 0.4],
        [0.01, 0.0, 3.0],
    ] {
        let p = Vector3::from(p);
        let error = s.signed_distance(&p).value - (p.norm() - 1.0);
        assert!((-1e-12..=sag).contains(&error), "{error}");
    }
}

/// The tip of a spike of which one side is split into many faces: weighted by their number instead of
/// their angles, the normals would call a point beside it inside.
#[test]
fn slivers_at_a_corner_do_not_turn_its_sign() {
    let n = 20_u32;
    let mut x = vec![0.0, 0.0, 1.0, -0.1, 0.1, 0.0, -0.1, -0.1, 0.0];
    for i in 0..=n {
        x.extend([0.1, -0.1 + 0.2 * f64::from(i) / f64::from(n), 0.0]);
    }
    let (low, high) = (3, 3 + n);
    let mut faces = vec![[0, 1, 2], [0, 2, low], [0, high, 1]];
    for i in low..high {
        faces.push([0, i, i + 1]);
        faces.push([2, i + 1, i]);
    }
    faces.push([2, 1, high]);
    let s = TriangleSurface::new(&x, &faces).unwrap();
    assert!(s.is_closed());
    let p = Vector3::new(-0.5, 0.0, 1.08);
    assert!(winding(&s, &p).abs() < 1e-12);
    let expected = (p - Vector3::z()).norm();
    assert!((s.signed_distance(&p).value - expected).abs() < 1e-15);
}

/// Inside a body with a re-entrant edge that edge is the closest feature: the distance is negative
/// and curved.
#[test]
fn distance_inside_a_reentrant_edge_is_curved() {
    let outline = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let x: Vec<f64> = [-2.0, 2.0]
        .iter()
        .flat_map(|z| outline.iter().flat_map(move |&[x, y]| [x, y, *z]))
        .collect();
    let mut faces = Vec::new();
    for i in 0..6 {
        let j = (i + 1) % 6;
        faces.extend([[i, j, 6 + j], [i, 6 + j, 6 + i]]);
    }
    for i in 1..5 {
        faces.extend([[0, i + 1, i], [6, 6 + i, 7 + i]]);
    }
    let s = TriangleSurface::new(&x, &faces).unwrap();
    assert!(s.is_closed());
    let p = Vector3::new(0.8, 0.7, 0.3);
    let d = s.signed_distance(&p);
    assert!((d.value + 0.13_f64.sqrt()).abs() < 1e-15);
    assert!(d.hessian.norm() > 1.0);
    check_jet(&[p], 0.1, &|q| {
        let d = s.signed_distance(&q[0]);
        Jet {
            value: d.value,
            gradient: [d.normal],
            hessian: [[d.hessian]],
        }
    });
}

#[test]
fn bad_surfaces_are_refused() {
    let (x, faces) = star(&[1.0; 8]);
    assert!(matches!(
        TriangleSurface::new(&x, &[]),
        Err(SurfaceError::Empty)
    ));
    assert!(matches!(
        TriangleSurface::new(&x[1..], &faces),
        Err(SurfaceError::Coordinates(23))
    ));
    let mut bad = x.clone();
    bad[7] = f64::INFINITY;
    assert!(matches!(
        TriangleSurface::new(&bad, &faces),
        Err(SurfaceError::NotFinite {
            vertex: 2,
            axis: 1,
            ..
        })
    ));
    let reversed: Vec<_> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(
        matches!(TriangleSurface::new(&x, &reversed), Err(SurfaceError::Inward { volume }) if (volume + 8.0).abs() < 1e-12)
    );
    bad = x.clone();
    bad.copy_within(0..3, 3);
    assert!(matches!(
        TriangleSurface::new(&bad, &faces),
        Err(SurfaceError::NoArea { .. })
    ));
    assert!(matches!(
        TriangleSurface::new(&x, &[[0, 1, 8]]),
        Err(SurfaceError::Faces(_))
    ));
    let s = TriangleSurface::new(&x, &faces).unwrap();
    assert!(s.signed_distance(&Vector3::repeat(f64::NAN)).value.is_nan());
    // On a face, on an edge, at a corner.
    for p in [[0.3, 0.1, 1.0], [1.0, 1.0, 0.2], [1.0, -1.0, 1.0]] {
        let d = s.signed_distance(&Vector3::from(p));
        assert_eq!(d.value, 0.0);
        assert!(d.normal.dot(&Vector3::from(p)) > 0.5);
    }
}
