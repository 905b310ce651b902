//! Glue that carries a load, and seams that close.

use isosheet_dynamics::nalgebra::Vector3;
use isosheet_dynamics::{
    CreaseSprings, Glue, Method, Profile, SheetModel, Simulation, State, leave_flat,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};

fn point(x: &[f64], v: VertexId) -> Vector3<f64> {
    Vector3::from(x.as_chunks::<3>().0[v.index()])
}

fn two_triangles() -> Sheet {
    let (first, second) = ([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], 1.5);
    let moved = first.iter().enumerate().map(|(i, c)| match i % 3 {
        0 => c + second,
        _ => *c,
    });
    let positions = first.iter().copied().chain(moved).collect();
    Sheet::new(positions, &[[0, 1, 2], [3, 4, 5]]).unwrap()
}

/// Smooth from 0 to 1 between the times 0 and 1.
fn closing() -> Profile {
    Profile::SmoothStep {
        from: 0.0,
        to: 1.0,
        begin: 0.0,
        end: 1.0,
    }
}

/// A triangle that hangs by glue on a pinned one: each pair carries its share of the weight, `k d = m g /
/// pairs`.
#[test]
fn glue_gives_way_by_its_load_over_its_stiffness() {
    let sheet = two_triangles();
    let x: Vec<f64> = sheet.positions().to_vec();
    // The second triangle is put onto the first.
    let on: Vec<f64> = x[..9].iter().chain(&x[..9]).copied().collect();
    let pairs = [[0, 3], [1, 4], [2, 5]].map(|pair| pair.map(VertexId));
    let (mass, stiffness) = (0.6, 50.0);
    let glue = Glue::new(sheet.topology(), &pairs, stiffness, 1.0, &on).unwrap();
    let model = SheetModel::new(&sheet, mass, MassKind::Lumped)
        .unwrap()
        .with_pins(&[0, 1, 2].map(VertexId))
        .unwrap()
        .with_gravity()
        .with_damping(20.0)
        .unwrap()
        .with_potential(glue);
    let mut simulation = Simulation::new(model, State::at_rest(on), Method::default()).unwrap();
    for _ in 0..300 {
        simulation.step(0.02).unwrap();
    }
    let expected = 0.5 * mass * 9.8 / 3.0 / stiffness;
    for v in 3..6 {
        let depth = -simulation.state().x[3 * v + 2];
        assert!((depth / expected - 1.0).abs() < 1e-6, "{depth} {expected}");
    }
}

/// A strip whose ends are glued by a driven closing, with and without half a turn, by rods and elastic: the
/// seam closes, and the sheet does what a band does.
#[test]
fn strips_close_to_bands() {
    let (columns, length, width) = (32, 0.3, 0.02);
    let strip = generate::grid(columns, 1, length, width, generate::Diagonals::Falling).unwrap();
    let row = columns as u32 + 1;
    let straight = [[0, row - 1], [row, 2 * row - 1]].map(|pair| pair.map(VertexId));
    let twisted = [[0, 2 * row - 1], [row, row - 1]].map(|pair| pair.map(VertexId));
    for pairs in [straight, twisted] {
        let mut x = strip.positions().to_vec();
        let stiffness = 1e3;
        let glue = Glue::new(strip.topology(), &pairs, stiffness, closing(), &x).unwrap();
        let bending = CreaseSprings::bending(&strip, 1e-4).unwrap();
        let model = SheetModel::new(&strip, 5e-4, MassKind::Lumped)
            .unwrap()
            .with_damping(5.0)
            .unwrap()
            .with_potential(bending)
            .with_potential(glue);
        leave_flat(&model, &mut x, 0.05, 1).unwrap();
        let mut simulation = Simulation::new(model, State::at_rest(x), Method::default()).unwrap();
        let mut worst = 0.0_f64;
        for _ in 0..90 {
            worst = worst.max(simulation.step(1.0 / 60.0).unwrap().strain);
        }
        assert!(worst < 1e-12, "{worst}");
        let x = &simulation.state().x;
        for [a, b] in pairs {
            let gap = (point(x, a) - point(x, b)).norm();
            // The moment of the bent strip over its width, as a force on the glue.
            assert!(gap < 1e-4 * length, "{gap}");
        }
        // The strip has left its plane, and its middle is about as far from the seam as a circle of its
        // length.
        let middle = point(x, VertexId(row / 2));
        let far = (middle - point(x, pairs[0][0])).norm();
        assert!(far > 0.2 * length, "{far}");
    }
}
