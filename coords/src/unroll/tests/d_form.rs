//! A D-form: two flat pieces with rims of one length, joined along them (Sharp, *D-Forms*, 2009).

use super::check;
use crate::{UnrollOptions, unroll};
use isosheet_mesh::{Sheet, VertexId};
use std::f64::consts::{PI, TAU};

/// The half axes of the seam in the plane, and how far it rises and falls, metres.
const AXES: [f64; 2] = [0.1, 0.07];
const RISE: f64 = 0.02;

/// A point of the seam `(a cos t, b sin t, h cos 2t)`.
fn seam(t: f64) -> [f64; 3] {
    [AXES[0] * t.cos(), AXES[1] * t.sin(), RISE * (2.0 * t).cos()]
}

/// The convex hull of the seam, whose two sides are parabolic cylinders: below `z = h (2 (x/a)^2 - 1)`, with
/// rulings from `t` to `-t`, and above `z = h (1 - 2 (y/b)^2)`, with rulings from `t` to `pi - t`. Each
/// ruling has a vertex in its middle. The seam has the vertices from 0 to `4 m - 1`.
fn d_form(m: u32) -> Sheet {
    let n = 4 * m;
    let mut x: Vec<[f64; 3]> = (0..n)
        .map(|k| seam(TAU * f64::from(k) / f64::from(n)))
        .collect();
    let mut faces = Vec::new();
    for (first, turned) in [(0, false), (m, true)] {
        // The ends of ruling `k` lie `k` vertices before and behind the first one.
        let ends = |k: u32| [(first + k) % n, (first + n - k) % n];
        let middle = |k: u32| x.len() as u32 + k - 1;
        let mut own = Vec::new();
        for k in 0..2 * m {
            let ([a, b], [c, d]) = (ends(k), ends(k + 1));
            if k == 0 {
                own.extend([[a, c, middle(1)], [a, middle(1), d]]);
            } else if k + 1 == 2 * m {
                own.extend([[a, c, middle(k)], [middle(k), c, b]]);
            } else {
                let [p, q] = [k, k + 1].map(middle);
                own.extend([[a, c, q], [a, q, p], [p, q, d], [p, d, b]]);
            }
        }
        let centres = (1..2 * m).map(|k| {
            let [a, b] = ends(k).map(|v| x[v as usize]);
            [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]))
        });
        x.extend(centres.collect::<Vec<_>>());
        if turned {
            // Seen from outside, both sides run the same way along the seam: one of them is wound back.
            own.iter_mut().for_each(|f| f.swap(1, 2));
        }
        faces.extend(own);
    }
    Sheet::new(x.concat(), &faces).unwrap()
}

/// The area, square metres, of the pattern of one side: the width of a ruling is `2 b sin t`, and between
/// rulings lies the arc of the parabola, `sqrt(a^2 sin^2 t + 4 h^2 sin^2 2t) dt`. The sum over a period is
/// exact to round-off.
fn area([a, b]: [f64; 2]) -> f64 {
    let steps = 2000;
    let part = |k: i32| {
        let t = PI * (f64::from(k) + 0.5) / f64::from(steps);
        2.0 * b * t.sin() * (a * t.sin()).hypot(2.0 * RISE * (2.0 * t).sin())
    };
    PI / f64::from(steps) * (0..steps).map(part).sum::<f64>()
}

/// The two sides hang together at one edge of the seam. Cut there too, they are two pieces with the areas of
/// the closed form, to the square of the step, and with outlines of the same lengths.
#[test]
fn a_d_form_is_two_pieces_with_one_rim() {
    let errors = [8, 16, 32].map(|m| {
        let sheet = d_form(m);
        assert!(sheet.topology().is_closed());
        let n = 4 * m as usize;
        let whole = unroll(&sheet, &UnrollOptions::default()).unwrap();
        check(&sheet, &whole, 1e-12);
        assert_eq!((whole.pieces.len(), whole.cuts.len()), (1, n - 1));
        let all = (0..n as u32).map(|k| [k, (k + 1) % n as u32].map(VertexId));
        let cuts = all.map(|[a, b]| sheet.topology().find_edge(a, b).unwrap());
        let options = UnrollOptions {
            cuts: cuts.collect(),
            ..UnrollOptions::default()
        };
        let parts = unroll(&sheet, &options).unwrap();
        check(&sheet, &parts, 1e-12);
        assert_eq!((parts.pieces.len(), parts.cuts.len()), (2, n));
        let t = parts.flat.topology();
        let rims = t.boundary_loops().into_iter().map(|rim| {
            let own = rim.iter().zip(rim.iter().cycle().skip(1));
            let edges = own.map(|(a, b)| t.find_edge(*a, *b).unwrap());
            edges.map(|e| parts.flat.lengths()[e.index()]).sum::<f64>()
        });
        let rims: Vec<f64> = rims.collect();
        assert_eq!(rims.len(), 2);
        assert!((rims[0] / rims[1] - 1.0).abs() < 1e-12);
        // Of the two sides the axes change places.
        let found = parts.pieces.iter().map(|piece| {
            let faces = piece.part.faces.clone();
            faces.map(|f| parts.flat.face_areas()[f]).sum::<f64>()
        });
        let found: Vec<f64> = found.collect();
        let expected = [area(AXES), area([AXES[1], AXES[0]])];
        [0, 1].map(|k| (found[k] / expected[k] - 1.0).abs())
    });
    for k in 0..2 {
        for pair in errors.windows(2) {
            let order = (pair[0][k] / pair[1][k]).log2();
            assert!((1.9..2.1).contains(&order), "{errors:?}");
        }
    }
}
