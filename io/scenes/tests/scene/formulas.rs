//! Meshes, crease patterns and bodies by formula agree with the crates that make them.

use crate::{parse, simulation};
use isosheet_geometry::{Shape, TriangleSurface};
use isosheet_mesh::generate::{
    FoldAssignment, FoldPattern, GenerateError, degree_four, delaunay, fan, hypar, kresling, miura,
    miura_zigzags, octagon_244, polygon_rings, regular_outline, square_twist, waterbomb, yoshimura,
};
use isosheet_mesh::origami::{DegreeFour, FoldingMode};
use isosheet_mesh::{Sheet, fold_angle};
use isosheet_scenes::Setup;
use std::f64::consts::PI;

/// What is made of a scene with a mesh and more.
fn setup(mesh: &str, more: &str) -> Setup {
    let text = format!("version = 1\n[sheet]\nmesh = {{ {mesh} }}\n{more}");
    let scene = parse(&text).unwrap_or_else(|e| panic!("{e}"));
    scene.build().unwrap_or_else(|e| panic!("{e}"))
}

fn same(found: &Sheet, expected: &Sheet) {
    assert_eq!(found.positions(), expected.positions());
    assert_eq!(found.face_indices(), expected.face_indices());
}

#[test]
fn meshes_are_those_of_their_generators() {
    let outline = regular_outline(6, 0.3).unwrap();
    let hexagon = "outline = { regular = { sides = 6, radius = 0.3 } }";
    let rings = setup(&format!("polygon_rings = {{ {hexagon}, rings = 3 }}"), "");
    same(&rings.sheet, &polygon_rings(&outline, 3).unwrap());
    let irregular = setup(
        &format!("polygon = {{ {hexagon}, spacing = 0.1, seed = 2 }}"),
        "",
    );
    same(&irregular.sheet, &delaunay(&outline, 0.1, 2).unwrap());
    let octagon = setup("octagon = { radius = 0.6 }", "");
    same(&octagon.sheet, &octagon_244(0.6).unwrap());
    let sector = setup("fan = { radius = 0.2, opening = 270, triangles = 9 }", "");
    same(&sector.sheet, &fan(9, 0.2, 1.5 * PI).unwrap());
    let vertex = DegreeFour {
        sectors: [60_f64, 80.0].map(f64::to_radians),
    };
    for (alike, mode) in [
        ("odd", FoldingMode::OddAlike),
        ("even", FoldingMode::EvenAlike),
    ] {
        let mesh =
            format!("degree_four = {{ sectors = [60, 80], radius = 0.1, alike = \"{alike}\" }}");
        let pattern = degree_four(vertex.sectors, 0.1, vertex.assignment(mode)).unwrap();
        same(&setup(&mesh, "").sheet, &pattern.sheet);
    }
}

/// Crease patterns by formula, as scenes have them and as the generators make them.
fn patterns() -> [(&'static str, Result<FoldPattern, GenerateError>); 5] {
    let angle = 60_f64.to_radians();
    [
        (
            "waterbomb = { columns = 3, rows = 2, side = 0.03 }",
            waterbomb(3, 2, 0.03),
        ),
        (
            "yoshimura = { columns = 4, rows = 3, base = 0.04, height = 0.03 }",
            yoshimura(4, 3, 0.04, 0.03),
        ),
        (
            "kresling = { columns = 4, rows = 3, base = 0.03, side = 0.02, angle = 60 }",
            kresling(4, 3, 0.03, 0.02, angle),
        ),
        ("hypar = { rings = 4, side = 0.2 }", hypar(4, 0.2)),
        (
            "square_twist = { side = 0.2, square = 0.05, angle = 60 }",
            square_twist(0.2, 0.05, angle),
        ),
    ]
}

/// Scenes have the sheets and the assignments of the generators, and springs that drive the creases fold each
/// of them to its own side.
#[test]
fn crease_patterns_fold_to_their_sides() {
    for (mesh, pattern) in patterns() {
        let pattern = pattern.unwrap();
        let text = format!(
            "version = 1
            [sheet]
            mesh = {{ {mesh} }}
            damping = 5
            [[crease]]
            at = {{ pattern = \"assigned\" }}
            stiffness = 0.01
            angle = {{ smooth_step = {{ to = 40, end = 1.0 }} }}"
        );
        let scene = parse(&text).unwrap_or_else(|e| panic!("{e}"));
        let expected: Vec<_> = pattern.assignments.iter().copied().map(Some).collect();
        let setup = scene.build().unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(setup.fold_assignments, Some(expected), "{mesh}");
        same(&setup.sheet, &pattern.sheet);
        let mut run = simulation(&text);
        for _ in 0..90 {
            run.step(1.0 / 60.0).unwrap();
        }
        let t = pattern.sheet.topology();
        for e in t.edge_ids() {
            let assignment = pattern.assignment(e);
            if matches!(
                assignment,
                FoldAssignment::Mountain | FoldAssignment::Valley
            ) {
                let fold = fold_angle(t, &run.state().x, e).unwrap().to_degrees();
                let fold = assignment.sign() * fold;
                assert!((3.0..90.0).contains(&fold), "{mesh}: {e} folds by {fold}");
            }
        }
    }
}

/// The mass of the sheet is what is given, or what the density makes of its area.
#[test]
fn the_whole_mass_goes_before_the_density() {
    let total = |more: &str| {
        let made = setup("square = { side = 0.5, level = 1 }", more);
        made.model.mass().vertex.iter().sum::<f64>()
    };
    assert!((total("density = 0.2") - 0.05).abs() < 1e-16);
    assert!((total("density = 0.2\nmass = 0.07") - 0.07).abs() < 1e-16);
}

#[test]
fn bodies_are_the_surfaces_of_their_formulas() {
    let bodies = "[[obstacle]]
        shape = { prism = { outline = { regular = { sides = 5, radius = 0.3 } }, height = 0.2 } }
        pose = { position = [0, 0, -1] }
        [[obstacle]]
        shape = { frame = { outer = 0.5, opening = 0.2, bottom = -1, top = -0.9 } }
        [[obstacle]]
        shape = { wall = { line = [[0, -2], [1, -2], [1, -3]], corner_radius = 0.25, width = 0.4 } }";
    let made = setup("square = { side = 0.2, level = 0 }", bodies);
    let line = isosheet_geometry::rounded_line(&[[0.0, -2.0], [1.0, -2.0], [1.0, -3.0]], 0.25);
    let expected = [
        TriangleSurface::prism(&regular_outline(5, 0.3).unwrap(), 0.2),
        TriangleSurface::frame(0.5, 0.2, [-1.0, -0.9]),
        TriangleSurface::wall(&line.unwrap(), 0.4),
    ];
    for (body, surface) in made.obstacles.iter().zip(expected) {
        let Shape::Surface(found) = body.shape() else {
            panic!("a surface, not {:?}", body.shape());
        };
        let surface = surface.unwrap();
        assert_eq!(found.positions(), surface.positions());
        assert_eq!(found.mesh().faces(), surface.mesh().faces());
    }
}

/// Mean fold of some creases towards their sides, radians.
fn mean_fold(pattern: &FoldPattern, x: &[f64], zigzags: bool) -> f64 {
    let (t, driven) = (pattern.sheet.topology(), miura_zigzags(pattern));
    let creases = t
        .edge_ids()
        .filter(|e| pattern.assignment(*e).sign() != 0.0);
    let chosen: Vec<_> = creases.filter(|e| driven.contains(e) == zigzags).collect();
    let fold = |e| pattern.assignment(e).sign() * fold_angle(t, x, e).unwrap();
    chosen.iter().map(|e| fold(*e)).sum::<f64>() / chosen.len() as f64
}

/// Springs at the zigzags alone fold the straight creases too, by the angle of rigid panels.
#[test]
fn zigzags_are_driven_by_name() {
    let mut run = simulation(
        "version = 1
        [sheet]
        mesh = { miura = { columns = 4, rows = 4, straight = 0.02, zigzag = 0.02, angle = 60 } }
        damping = 5
        [[crease]]
        at = { pattern = \"zigzags\" }
        stiffness = 0.005
        angle = { smooth_step = { to = 90, end = 1.0 } }
        [[crease]]
        at = { pattern = \"flat\" }
        stiffness = 0.05",
    );
    for _ in 0..90 {
        run.step(1.0 / 60.0).unwrap();
    }
    let pattern = miura(4, 4, 0.02, 0.02, 60_f64.to_radians()).unwrap();
    let fold = |zigzags| mean_fold(&pattern, &run.state().x, zigzags);
    assert!(
        (fold(true).to_degrees() - 90.0).abs() < 0.01,
        "{}",
        fold(true)
    );
    // tan(straight / 2) = cos 60 tan(zigzag / 2)
    let exact = 2.0 * (0.5 * (0.5 * fold(true)).tan()).atan();
    assert!(
        (fold(false) - exact).abs() < 1e-3,
        "{} {exact}",
        fold(false)
    );
}
