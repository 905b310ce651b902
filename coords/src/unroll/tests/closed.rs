//! Closed surfaces.

use super::shapes::{hull, ring};
use super::{check, unrolled};
use crate::{UnrollOptions, unroll};
use isosheet_mesh::{Sheet, fold_angle};
use std::f64::consts::{PI, TAU};

fn cube(side: f64) -> Sheet {
    let x = (0..8).flat_map(|k| [0, 1, 2].map(|axis| side * f64::from(k >> axis & 1)));
    let faces = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    Sheet::new(x.collect(), &faces).unwrap()
}

/// The net of a cube: seven of its edges are cut, a tree through its eight corners, and the diagonals of its
/// faces are not.
#[test]
fn a_cube_has_a_net_of_six_squares() {
    let sheet = cube(0.1);
    let unrolled = unrolled(&sheet);
    assert!(
        unrolled
            .deficits
            .iter()
            .all(|d| (d - PI / 2.0).abs() < 1e-14)
    );
    assert_eq!((unrolled.pieces.len(), unrolled.cuts.len()), (1, 7));
    let lengths = unrolled.cuts.iter().map(|e| sheet.lengths()[e.index()]);
    lengths.for_each(|l| assert!((l - 0.1).abs() < 1e-15));
    assert!((unrolled.flat.area() - 0.06).abs() < 1e-15);
}

/// Two regular polygons on each other, joined along their rims: each corner has the deficit `4 pi / n`, twice
/// the angle by which a polygon turns there. They are cut apart but for one edge.
#[test]
fn a_pillow_is_two_polygons() {
    for n in [3, 12, 100] {
        let angle = |k: u32| TAU * f64::from(k) / f64::from(n);
        let mut x: Vec<f64> = (0..n)
            .flat_map(|k| [angle(k).cos(), angle(k).sin(), 0.0])
            .collect();
        x.extend([0.0; 6]);
        let top = (0..n).map(|k| [n, k, (k + 1) % n]);
        let bottom = (0..n).map(|k| [n + 1, (k + 1) % n, k]);
        let sheet = Sheet::new(x, &top.chain(bottom).collect::<Vec<_>>()).unwrap();
        let unrolled = unrolled(&sheet);
        let rim = &unrolled.deficits[..n as usize];
        assert!(
            rim.iter()
                .all(|d| (d - 4.0 * PI / f64::from(n)).abs() < 1e-12)
        );
        assert_eq!(unrolled.pieces.len(), 1);
        assert_eq!(unrolled.cuts.len(), n as usize - 1);
        let area = f64::from(n) * angle(1).sin();
        assert!((unrolled.flat.area() / area - 1.0).abs() < 1e-12);
    }
}

/// The oloid, the hull of two circles in planes across each other of which each goes through the centre of
/// the other: a developable surface with two edges, whose area is that of the unit sphere (Dirnboeck and
/// Stachel 1997). The chords of its circles lack the square of their length.
#[test]
fn an_oloid_is_developable() {
    let errors = [20, 40].map(|n| {
        let mut points = Vec::new();
        for k in 0..n {
            let angle = |shift: f64| TAU * (f64::from(k) + shift) / f64::from(n);
            let (s, c) = angle(0.237).sin_cos();
            points.push([c, s, 0.0]);
            let (s, c) = angle(0.618).sin_cos();
            points.push([1.0 - c, 0.0, s]);
        }
        let sheet = hull(&points);
        assert_eq!(sheet.topology().euler_characteristic(), 2);
        // Near the ends of its edges the deficits are small, and the net is cut to them or has some strain.
        for (strain, crease) in [(1e-3, PI / 6.0), (1e-12, 0.0)] {
            let options = UnrollOptions {
                strain,
                crease,
                ..UnrollOptions::default()
            };
            let unrolled = unroll(&sheet, &options).unwrap();
            check(&sheet, &unrolled, strain);
            let total: f64 = unrolled.deficits.iter().sum();
            assert!(
                (total - 4.0 * PI).abs() < 1e-11,
                "Gauss and Bonnet: {total}"
            );
            assert!(unrolled.pieces.len() <= 2, "{}", unrolled.pieces.len());
            let area = unrolled.flat.area() / sheet.area();
            assert!((area - 1.0).abs() <= 4.0 * strain, "{area}");
        }
        1.0 - sheet.area() / (4.0 * PI)
    });
    assert!(errors[1] > 0.0 && errors[0] / errors[1] > 3.0, "{errors:?}");
}

/// Of a prism over a polygon with notches only edges of the prism are cut, though its corners at the notches
/// have angles of more than a whole turn: its plane faces stay whole.
#[test]
fn plane_faces_with_notches_stay_whole() {
    // An angle, and a cross, counter-clockwise; the notches are cut into triangles from vertex 0.
    let angle = [[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6]];
    let angle_faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    let stairs = [
        [0, 0],
        [6, 0],
        [6, 2],
        [4, 2],
        [4, 4],
        [2, 4],
        [2, 6],
        [0, 6],
    ];
    let stairs_faces = [
        [0, 1, 3],
        [1, 2, 3],
        [0, 3, 5],
        [3, 4, 5],
        [0, 5, 7],
        [5, 6, 7],
    ];
    for (outline, faces) in [(&angle[..], &angle_faces[..]), (&stairs, &stairs_faces)] {
        let n = outline.len() as u32;
        let levels = [0.0, 1.5].into_iter();
        let x = levels.flat_map(|z| {
            outline
                .iter()
                .flat_map(move |[x, y]| [f64::from(*x), f64::from(*y), z])
        });
        let caps = faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, c, b], [n + a, n + b, n + c]]);
        let sides = (0..n).flat_map(|k| {
            let [a, b] = [k, (k + 1) % n];
            [[a, b, n + b], [a, n + b, n + a]]
        });
        let sheet = Sheet::new(x.collect(), &caps.chain(sides).collect::<Vec<_>>()).unwrap();
        let unrolled = unrolled(&sheet);
        for e in &unrolled.cuts {
            let fold = fold_angle(sheet.topology(), sheet.positions(), *e).unwrap();
            assert!((fold.abs() - PI / 2.0).abs() < 1e-12, "{e}: {fold}");
        }
        assert!(unrolled.pieces.len() <= 3, "{}", unrolled.pieces.len());
    }
}

/// A square frame of a square section has a handle: it is cut to its sixteen corners and along both ways
/// round, seventeen edges, but for one where its flat top or bottom stays a ring.
#[test]
fn a_frame_with_a_hole_is_cut_to_pieces_without_strain() {
    let sheet = ring(4, 4, |i, j| {
        let out = [2.0, 2.0, 3.0, 3.0][j];
        let z = [0.0, 1.0, 1.0, 0.0][j];
        let (s, c) = (TAU * (i as f64 + 0.5) / 4.0).sin_cos();
        [out * c, out * s, z]
    });
    assert_eq!(sheet.topology().euler_characteristic(), 0);
    let unrolled = unrolled(&sheet);
    assert!(
        (16..=17).contains(&unrolled.cuts.len()),
        "{}",
        unrolled.cuts.len()
    );
    assert!((unrolled.flat.area() / sheet.area() - 1.0).abs() < 1e-12);
}

/// Handles of curved surfaces are cut, and all vertices are corners where every fold is a crease.
#[test]
fn a_torus_of_creases_has_nets() {
    let sheet = ring(9, 6, |i, j| {
        let [u, v] = [TAU * i as f64 / 9.0, TAU * j as f64 / 6.0];
        let out = 2.0 + 0.8 * v.cos();
        [out * u.cos(), out * u.sin(), 0.8 * v.sin()]
    });
    let options = UnrollOptions {
        crease: 0.0,
        ..UnrollOptions::default()
    };
    let unrolled = unroll(&sheet, &options).unwrap();
    check(&sheet, &unrolled, 1e-12);
    assert!((unrolled.flat.area() / sheet.area() - 1.0).abs() < 1e-12);
}
