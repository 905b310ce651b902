//! Tests by closed forms.

mod closed;
mod curved;
mod d_form;
mod shapes;

use super::overlap::overlapping;
use super::{UnrollError, UnrollOptions, Unrolled, unroll};
use isosheet_mesh::generate::{Diagonals, disk, grid};
use isosheet_mesh::{EdgeId, Opened, Sheet, VertexId};
use shapes::{cone, cylinder, strip};
use std::f64::consts::{PI, TAU};

/// What holds of every result: faces keep their areas as edges keep their lengths, none is turned over, and
/// no two lie on each other.
fn check(sheet: &Sheet, unrolled: &Unrolled, strain: f64) {
    let (own, flat) = (sheet.topology(), &unrolled.flat);
    let t = flat.topology();
    assert_eq!(t.face_count(), own.face_count());
    for e in t.edge_ids() {
        let given = unrolled.given_edge(own, e).unwrap();
        let error = flat.lengths()[e.index()] / sheet.lengths()[given.index()] - 1.0;
        assert!(error.abs() <= strain, "{given}: {error}");
    }
    assert!(unrolled.strain().abs() <= strain);
    let corners = |f: &[VertexId; 3]| f.map(|v| [0, 1].map(|k| flat.position(v)[k]));
    let triangles: Vec<_> = t.faces().iter().map(corners).collect();
    assert!(triangles.iter().all(|t| super::vec2::twice_area(*t) > 0.0));
    let size = unrolled
        .pieces
        .iter()
        .fold(0.0_f64, |m, p| m.max(p.sides[0]));
    assert_eq!(overlapping(&triangles, (1e-9 + strain) * size), None);
    // Sides of cuts belong to the same edge, and all other sides stay together.
    let cut = t.boundary_edge_count() - own.boundary_edge_count();
    assert_eq!(cut, 2 * unrolled.cuts.len());
    assert_eq!(t.component_count(), unrolled.pieces.len());
    for (f, given) in t.faces().iter().zip(&unrolled.faces) {
        let given = own.faces()[given.index()];
        assert_eq!(f.map(|v| unrolled.vertices[v.index()]), given);
    }
}

fn unrolled(sheet: &Sheet) -> Unrolled {
    let unrolled = unroll(sheet, &UnrollOptions::default()).unwrap();
    check(sheet, &unrolled, 1e-12);
    unrolled
}

/// A closed band of the circumference `2 n R sin(pi / n)`, the perimeter of the inscribed polygon, is cut
/// once and becomes a rectangle.
#[test]
fn a_cylinder_is_a_rectangle() {
    for (sides, rings, unit) in [(3, 1, 1.0), (16, 5, 1e-3), (200, 30, 1e3)] {
        let (radius, height) = (0.7 * unit, 1.3 * unit);
        let sheet = cylinder(sides, rings, radius, height);
        let unrolled = unrolled(&sheet);
        assert_eq!(unrolled.pieces.len(), 1);
        assert_eq!(unrolled.cuts.len(), rings);
        let perimeter = 2.0 * sides as f64 * radius * (PI / sides as f64).sin();
        let piece = &unrolled.pieces[0];
        let expected = [perimeter.max(height), perimeter.min(height)];
        for (found, expected) in piece.sides.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
        assert!((unrolled.flat.area() / (perimeter * height) - 1.0).abs() < 1e-12);
    }
}

/// A pyramid of `n` sides with the half angle `a` of its edges against the axis is a sector of the angle
/// `2 n asin(sin(a) sin(pi / n))`, the polygon inscribed in that of the cone, `2 pi sin(a)`.
#[test]
fn a_cone_is_a_sector() {
    for (sides, rings, half_angle) in [(3, 2, 0.5_f64), (12, 4, 0.3), (150, 10, 1.1)] {
        let sheet = cone(sides, rings, half_angle, 2.0);
        let unrolled = unrolled(&sheet);
        let angle = 2.0 * sides as f64 * (half_angle.sin() * (PI / sides as f64).sin()).asin();
        assert!((unrolled.deficits[0] - (TAU - angle)).abs() < 1e-12);
        assert!(angle < TAU * half_angle.sin());
        assert_eq!(unrolled.cuts.len(), rings);
        // The apex is on the boundary now: the angles of its faces are the sector.
        let flat = &unrolled.flat;
        let apex: Vec<VertexId> = (0..unrolled.vertices.len())
            .filter(|v| unrolled.vertices[*v] == VertexId(0))
            .map(VertexId::from_index)
            .collect();
        assert_eq!(apex.len(), 1);
        assert!((flat.angle_sum(apex[0]) - angle).abs() < 1e-12);
        let centre = flat.position(apex[0]);
        for v in flat.topology().vertex_ids() {
            let given = sheet.position(unrolled.vertices[v.index()]);
            let out = given.iter().map(|c| c * c).sum::<f64>().sqrt();
            let p = flat.position(v);
            let found = (p[0] - centre[0]).hypot(p[1] - centre[1]);
            assert!((found - out).abs() < 1e-12, "{v}");
        }
    }
}

/// What is flat stays as it is, holes included; sheets with several parts become several pieces, apart.
#[test]
fn flat_sheets_are_not_cut() {
    let plate = grid(9, 7, 0.9, 0.7, Diagonals::UnionJack).unwrap();
    let is_kept = |f: &[u32; 3]| {
        let corners = f.map(|v| plate.position(VertexId(v)));
        let [x, y] = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
        !(0.2..0.4).contains(&x) && !(0.6..0.7).contains(&x) || !(0.2..0.5).contains(&y)
    };
    let faces: Vec<[u32; 3]> = plate.face_indices().into_iter().filter(is_kept).collect();
    let left = Opened::along(&faces, |_| false);
    let place = |v: &u32| plate.position(VertexId(*v));
    let holed = Sheet::new(left.origins.iter().flat_map(place).collect(), &left.faces).unwrap();
    assert_eq!(holed.topology().euler_characteristic(), -1);
    let bent = holed
        .map_positions(|[x, y, z]| [0.3 * (x / 0.3).sin(), y, z - 0.3 * (x / 0.3).cos()])
        .unwrap();
    for sheet in [plate, holed, bent, disk(6, 0.2).unwrap()] {
        let unrolled = unrolled(&sheet);
        assert_eq!((unrolled.pieces.len(), unrolled.cuts.len()), (1, 0));
        let parts = [&sheet, &sheet, &cylinder(8, 2, 0.1, 0.3)];
        let several = Sheet::union(&parts).unwrap();
        assert_eq!(self::unrolled(&several).pieces.len(), 3);
    }
}

/// Edges that are named are cut; a slit in a flat sheet stays closed in the plane.
#[test]
fn named_edges_are_cut() {
    let sheet = grid(6, 4, 0.6, 0.4, Diagonals::Rising).unwrap();
    let t = sheet.topology();
    let on_line = |e: &EdgeId| {
        let ends = t.edges()[e.index()].map(|v| sheet.position(v));
        ends.iter().all(|p| (p[0] - 0.3).abs() < 1e-9)
    };
    let all: Vec<EdgeId> = t.edge_ids().filter(on_line).collect();
    let cut = |cuts: &[EdgeId]| {
        let options = UnrollOptions {
            cuts: cuts.to_vec(),
            ..UnrollOptions::default()
        };
        let unrolled = unroll(&sheet, &options).unwrap();
        check(&sheet, &unrolled, 1e-12);
        (unrolled.pieces.len(), unrolled.cuts.len())
    };
    assert_eq!(all.len(), 4);
    assert_eq!(cut(&all), (2, 4));
    assert_eq!(cut(&all[..2]), (1, 2));
    assert_eq!(cut(&all[1..3]), (1, 2));
    // One edge inside has no second side without another one.
    let (pieces, cuts) = cut(&all[1..2]);
    assert!(pieces == 1 && cuts >= 1, "{cuts}");
    let missing = UnrollOptions {
        cuts: vec![EdgeId(1000)],
        ..UnrollOptions::default()
    };
    let error = unroll(&sheet, &missing).unwrap_err();
    assert!(matches!(error, UnrollError::NoEdge { count, .. } if count == t.edge_count()));
}

/// A band of one row with half a turn has no vertices inside, so that it is developable: cut where its two
/// orientations meet it is a strip with the areas and lengths of its faces.
#[test]
fn a_moebius_band_is_a_strip() {
    let n = 24;
    let mut x = Vec::new();
    for k in 0..n {
        let turn = TAU * f64::from(k) / f64::from(n);
        for side in [-0.2, 0.2] {
            let out = 1.0 + side * (0.5 * turn).cos();
            x.extend([
                out * turn.cos(),
                out * turn.sin(),
                side * (0.5 * turn).sin(),
            ]);
        }
    }
    let corner = |k: u32, side: u32| match k < n as u32 {
        true => 2 * k + side,
        false => 1 - side,
    };
    let faces: Vec<[u32; 3]> = (0..n as u32)
        .flat_map(|k| {
            let [a, b, c, d] = [
                corner(k, 0),
                corner(k + 1, 0),
                corner(k + 1, 1),
                corner(k, 1),
            ];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    assert!(Sheet::new(x.clone(), &faces).is_err());
    let opened = Opened::surface(&faces);
    assert_eq!(opened.seams.len(), 1);
    let place = |v: &u32| x[3 * *v as usize..3 * *v as usize + 3].to_vec();
    let sheet = Sheet::new(
        opened.origins.iter().flat_map(place).collect(),
        &opened.faces,
    );
    let unrolled = unrolled(&sheet.unwrap());
    assert_eq!((unrolled.pieces.len(), unrolled.cuts.len()), (1, 0));
}

/// A strip of rings that winds round several times lies on itself in the plane, and is divided.
#[test]
fn what_winds_round_is_divided() {
    // A spiral staircase of the inner radius 1 in the plane, of three turns.
    let at = |k: f64, side: f64| {
        let (s, c) = (0.1 * k).sin_cos();
        [(1.0 + side) * c, (1.0 + side) * s, 0.0]
    };
    let sheet = strip(190, 2, at, 0.4).unwrap();
    let unrolled = unrolled(&sheet);
    assert!(
        (3..=6).contains(&unrolled.pieces.len()),
        "{}",
        unrolled.pieces.len()
    );
}

/// A mesh that is moved, turned and of another size has the same pattern, up to its place.
#[test]
fn patterns_move_with_their_meshes() {
    let sheet = cone(9, 3, 0.6, 1.5);
    let own = unrolled(&sheet);
    for (size, angle) in [(1.0, 0.7), (1e-3, 2.0), (1e4, -1.1)] {
        let (s, c) = f64::sin_cos(angle);
        let moved =
            |[x, y, z]: [f64; 3]| [c * x - s * z, y, s * x + c * z].map(|c| size * (c + 3.0));
        let other = unrolled(&sheet.map_positions(moved).unwrap());
        assert_eq!(own.vertices, other.vertices);
        for (a, b) in own.flat.positions().iter().zip(other.flat.positions()) {
            assert!((size * a - b).abs() < 1e-12 * size, "{a} {b}");
        }
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let sheet = grid(2, 2, 1.0, 1.0, Diagonals::Rising).unwrap();
    let default = UnrollOptions::default();
    for (options, expected) in [
        (
            UnrollOptions {
                strain: 0.0,
                ..default.clone()
            },
            "the strain",
        ),
        (
            UnrollOptions {
                strain: f64::NAN,
                ..default.clone()
            },
            "the strain",
        ),
        (
            UnrollOptions {
                crease: -0.1,
                ..default.clone()
            },
            "the angle of creases",
        ),
        (
            UnrollOptions {
                gap: Some(-1.0),
                ..default.clone()
            },
            "the gap",
        ),
        (
            UnrollOptions {
                gap: Some(f64::INFINITY),
                ..default
            },
            "the gap",
        ),
    ] {
        let error = unroll(&sheet, &options).unwrap_err();
        assert!(
            matches!(error, UnrollError::Option { name, .. } if name == expected),
            "{error}"
        );
    }
}
