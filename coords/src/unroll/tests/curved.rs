//! Surfaces that are developable in the limit, or not.

use super::check;
use super::shapes::strip;
use crate::{UnrollError, UnrollOptions, unroll};
use isosheet_mesh::{Advice, Sheet, generate};
use std::f64::consts::TAU;

/// A part of a sphere over a grid of a square.
fn cap(cells: usize, part: f64) -> Sheet {
    let plate = generate::grid(cells, cells, 1.0, 1.0, generate::Diagonals::UnionJack).unwrap();
    let bulged = plate.map_positions(|[x, y, _]| {
        let [x, y] = [x - 0.5, y - 0.5].map(|c| part * c);
        [x, y, (1.0 - x * x - y * y).sqrt()]
    });
    bulged.unwrap()
}

/// A cap is refused with its largest deficit, and accepted with a strain. Its deficits add up to the area of
/// its inner vertices on the unit sphere, whose order is the square of its size: so is the strain.
#[test]
fn a_sphere_is_refused_with_its_deficits() {
    let error = unroll(&cap(12, 0.6), &UnrollOptions::default()).unwrap_err();
    let UnrollError::Curved {
        strain,
        limit,
        count,
        deficit,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert!(strain.abs() > limit && limit == 1e-3);
    assert_eq!(count, 11 * 11);
    // A vertex stands for a cell of 0.05 by 0.05, which is at most 1.3 times as large on the sphere.
    assert!((0.8 * 0.0025..2.6 * 0.0025).contains(&deficit), "{deficit}");
    assert!(error.advice().unwrap().contains("cut"));
    let strains = [0.3, 0.15].map(|part| {
        let sheet = cap(12, part);
        let options = UnrollOptions {
            strain: 0.05,
            ..UnrollOptions::default()
        };
        let unrolled = unroll(&sheet, &options).unwrap();
        check(&sheet, &unrolled, 0.05);
        assert!(unrolled.cuts.is_empty());
        unrolled.strain().abs()
    });
    // A cap of the radius r needs strains of about r^2 / 16.
    let r = 0.3 * 0.5_f64.sqrt();
    assert!(
        strains[0] < r * r / 4.0 && strains[0] > r * r / 64.0,
        "{strains:?}"
    );
    assert!(
        (3.0..5.0).contains(&(strains[0] / strains[1])),
        "{strains:?}"
    );
}

/// The tangents of a helix of the radius `r` and the slope `c` are a developable surface, whose edge has the
/// curvature `r / (r^2 + c^2)` of the helix in the plane too. Deficits of a mesh of `n` columns add up to
/// less than a multiple of `n^-2`, and so do strain and error of the curvature.
#[test]
fn tangents_of_a_helix_have_its_curvature_in_the_plane() {
    let (r, c) = (1.0_f64, 0.4);
    let speed = r.hypot(c);
    let curvature = r / (speed * speed);
    let found = [16_u32, 32, 64].map(|n| {
        let step = 1.6 / f64::from(n);
        let at = |k: f64, along: f64| {
            let (s, co) = (step * k).sin_cos();
            // From the distance 0.5 of the edge on, where the rulings are well apart.
            let l = 0.5 + along;
            [
                r * co - l * r * s / speed,
                r * s + l * r * co / speed,
                c * step * k + l * c / speed,
            ]
        };
        let sheet = strip(n as usize, 4, at, 0.6).unwrap();
        let unrolled = unroll(
            &sheet,
            &UnrollOptions {
                strain: 0.01,
                ..Default::default()
            },
        )
        .unwrap();
        assert!(unrolled.cuts.is_empty() && unrolled.pieces.len() == 1);
        let deficits: f64 = unrolled.deficits.iter().map(|d| d.abs()).sum();
        // The edge of regression is an involute away: rulings are tangents of a circle of the radius of
        // curvature R, at the distance l from its points, so that vertices are hypot(R, l) from its centre.
        let radius = (1.0 / curvature).hypot(0.5);
        let flat = &unrolled.flat;
        let place = |k: u32| {
            let v = unrolled.vertices.iter().position(|v| v.0 == k).unwrap();
            flat.position(isosheet_mesh::VertexId::from_index(v))
        };
        let [p, q, s] = [place(0), place(n / 2), place(n)];
        let [a, b, d] = [[p, q], [q, s], [s, p]].map(|[p, q]| (p[0] - q[0]).hypot(p[1] - q[1]));
        let twice = ((q[0] - p[0]) * (s[1] - p[1]) - (q[1] - p[1]) * (s[0] - p[0])).abs();
        [
            deficits,
            unrolled.strain().abs(),
            (a * b * d / (2.0 * twice) / radius - 1.0).abs(),
        ]
    });
    for k in 0..3 {
        let order = (found[1][k] / found[2][k]).log2();
        assert!(order > 1.8, "{k}: {found:?}");
    }
    assert!(found[2][2] < 1e-3, "{found:?}");
}

/// A whole sphere has no corners, and is not cut to pieces.
#[test]
fn a_whole_sphere_is_refused() {
    let (columns, rows) = (24, 12);
    let mut x = vec![0.0, 0.0, 1.0];
    for j in 1..rows {
        let (sin, cos) = (0.5 * TAU * f64::from(j) / f64::from(rows)).sin_cos();
        for i in 0..columns {
            let (s, c) = (TAU * f64::from(i) / f64::from(columns)).sin_cos();
            x.extend([sin * c, sin * s, cos]);
        }
    }
    x.extend([0.0, 0.0, -1.0]);
    let (n, m) = (columns as u32, rows as u32);
    let number = |i: u32, j: u32| 1 + (j - 1) * n + i % n;
    let mut faces = Vec::new();
    for i in 0..n {
        faces.push([0, number(i, 1), number(i + 1, 1)]);
        for j in 1..m - 1 {
            let [a, b, c, d] = [
                number(i, j),
                number(i, j + 1),
                number(i + 1, j + 1),
                number(i + 1, j),
            ];
            faces.extend([[a, b, c], [a, c, d]]);
        }
        faces.push([number(i, m - 1), 1 + (m - 1) * n, number(i + 1, m - 1)]);
    }
    let sheet = Sheet::new(x, &faces).unwrap();
    let error = unroll(&sheet, &UnrollOptions::default()).unwrap_err();
    assert!(matches!(error, UnrollError::Curved { .. }), "{error}");
}

/// A strip of tangents of a helix of several rows that winds round more than twice lies on itself, and is
/// divided. Its layout keeps the digits of its lengths along hundreds of columns: the deficits of `n` columns
/// are about `n^-3`, less than `1e-8` here, and strain of that order is left.
#[test]
fn a_long_strip_of_tangents_is_divided() {
    let (r, c, turn) = (1.0_f64, 1.0 / 3.0, 14.0_f64);
    let speed = r.hypot(c);
    let at = |k: f64, along: f64| {
        let (u, l) = (turn * k / 200.0, 1.0 / 3.0 + along);
        let (s, co) = u.sin_cos();
        [
            r * co - l * r * s / speed,
            r * s + l * r * co / speed,
            c * u + l * c / speed,
        ]
    };
    let sheet = strip(200, 3, at, 0.4).unwrap();
    let unrolled = unroll(&sheet, &UnrollOptions::default()).unwrap();
    assert!(unrolled.deficits.iter().all(|d| d.abs() < 1e-8));
    check(&sheet, &unrolled, 1e-7);
    // In the plane the strip turns by the curvature of the helix times its length.
    let turns = turn * r / speed / TAU;
    assert!((2.0..3.0).contains(&turns));
    assert!(
        (3..=4).contains(&unrolled.pieces.len()),
        "{}",
        unrolled.pieces.len()
    );
}
