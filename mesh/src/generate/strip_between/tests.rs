use super::*;
use crate::{Advice, angle_deficits};
use std::f64::consts::TAU;

/// The largest distance of the diagonals of a cell, as a part of their lengths, over all cells of one row.
fn warp(strip: &RuledStrip) -> f64 {
    let pairs = strip.rulings.windows(2);
    let of = |pair: &[[Vec3; 2]]| {
        let [[a, d], [b, c]] = [pair[0], pair[1]];
        let [p, q] = [sub(c, a), sub(d, b)];
        let across = cross(p, q);
        dot(sub(b, a), unit(across)).abs() / norm(p).min(norm(q))
    };
    pairs.map(of).fold(0.0, f64::max)
}

fn circle(n: u32, radius: f64, centre: Vec3, tilt: f64) -> Vec<Vec3> {
    let angle = |k: u32| TAU * f64::from(k % n) / f64::from(n);
    let place = |k: u32| {
        let (s, c) = angle(k).sin_cos();
        let [x, y] = [radius * c, radius * s];
        [
            centre[0] + x * tilt.cos(),
            centre[1] + y,
            centre[2] + x * tilt.sin(),
        ]
    };
    (0..=n).map(place).collect()
}

/// Circles about one axis: rulings join points of the same angle, so that the strip is a regular prism or
/// pyramid frustum with plane faces.
#[test]
fn circles_about_an_axis_are_joined_by_a_cone() {
    for (top, start) in [(0.1, 0), (0.05, 0), (0.05, 7)] {
        let first = circle(96, 0.1, [0.0; 3], 0.0);
        let mut second = circle(96, top, [0.0, 0.0, 0.2], 0.0);
        // Where the second curve starts does not matter, nor which way round it runs.
        second.pop();
        second.rotate_left(start);
        second.push(second[0]);
        if start > 0 {
            second.reverse();
        }
        let strip = strip_between(&first, &second, 48, 1).unwrap();
        assert!(strip.twist < 1e-6, "{}", strip.twist);
        assert_eq!(strip.rulings.len(), 48);
        for [p, q] in &strip.rulings {
            let turned = p[1].atan2(p[0]) - q[1].atan2(q[0]);
            assert!(turned.sin().abs() < 1e-6 && turned.cos() > 0.0, "{turned}");
        }
        assert!(warp(&strip) < 1e-6);
        let t = strip.sheet.topology();
        assert_eq!(t.euler_characteristic(), 0);
    }
}

/// Circles in planes that are tilted against each other are joined by a developable surface, whose rulings
/// have parallel tangent planes at both ends: cells become plane with the square of their width.
#[test]
fn tilted_circles_are_joined_by_plane_cells() {
    let warps = [24, 48, 96].map(|columns| {
        let first = circle(2000, 0.1, [0.0; 3], 0.0);
        let second = circle(2000, 0.07, [0.03, 0.0, 0.2], 0.5);
        let strip = strip_between(&first, &second, columns, 1).unwrap();
        assert!(strip.twist < 1e-4, "{}", strip.twist);
        warp(&strip)
    });
    for pair in warps.windows(2) {
        assert!(pair[0] / pair[1] > 3.4, "{warps:?}");
    }
}

/// A helix and a curve along its tangents at another distance: rulings are the tangents, to the error of
/// curves through points. With rows inside, angle deficits add up to less than a multiple of the square of
/// the width of cells.
#[test]
fn a_pair_of_helices_is_joined_by_tangents() {
    let (r, c) = (0.1_f64, 0.04_f64);
    let speed = r.hypot(c);
    let at = |u: f64, l: f64| {
        let (s, co) = u.sin_cos();
        [
            r * co - l * r * s / speed,
            r * s + l * r * co / speed,
            c * u + l * c / speed,
        ]
    };
    let helix = |l: f64| -> Vec<Vec3> { (0..=300).map(|k| at(0.01 * f64::from(k), l)).collect() };
    let sums = [20, 40, 80].map(|columns| {
        let strip = strip_between(&helix(0.05), &helix(0.12), columns, 4).unwrap();
        assert!(strip.twist < 2e-3, "{}", strip.twist);
        for [p, q] in &strip.rulings {
            assert!((norm(sub(*p, *q)) - 0.07).abs() < 1e-4);
        }
        let deficits = angle_deficits(strip.sheet.topology(), strip.sheet.positions());
        deficits.iter().map(|d| d.abs()).sum::<f64>()
    });
    for pair in sums.windows(2) {
        assert!(pair[0] / pair[1] > 3.0, "{sums:?}");
    }
}

/// Lines that are no edges of a developable surface but of a hyperbolic paraboloid: the best strip keeps the
/// twist, which says so.
#[test]
fn skew_lines_keep_their_twist() {
    let first = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let second = [[0.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
    let strip = strip_between(&first, &second, 10, 1).unwrap();
    // Where the ruling is across the first line the planes have the angle of the lines, 45 degrees, at most.
    assert!(
        (0.3..=TAU / 8.0 + 1e-9).contains(&strip.twist),
        "{}",
        strip.twist
    );
    let reversed: Vec<Vec3> = second.iter().rev().copied().collect();
    assert_eq!(strip_between(&first, &reversed, 10, 1).unwrap(), strip);
}

#[test]
fn what_makes_no_strip_is_refused() {
    let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let ring = circle(8, 1.0, [0.0, 0.0, 1.0], 0.0);
    let refused = |first: &[Vec3], second: &[Vec3], columns, rows| {
        strip_between(first, second, columns, rows).unwrap_err()
    };
    let open = refused(&line, &ring, 8, 1);
    assert!(
        matches!(open, GenerateError::Curve { name: "first", .. }),
        "{open}"
    );
    assert!(open.advice().is_some());
    assert!(matches!(
        refused(&line, &line[..1], 8, 1),
        GenerateError::Curve { name: "second", .. }
    ));
    assert!(matches!(
        refused(&ring, &ring, 2, 1),
        GenerateError::Count {
            name: "columns",
            ..
        }
    ));
    assert!(matches!(
        refused(&line, &line, 8, 0),
        GenerateError::Count { name: "rows", .. }
    ));
    // A curve and itself have no area between them, nor have two that begin in one point.
    let corner = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    for other in [line, corner] {
        let met = refused(&line, &other, 8, 1);
        assert!(
            matches!(met, GenerateError::CurvesMeet { ruling: 0, .. }),
            "{met}"
        );
        assert!(met.advice().is_some());
    }
}
