//! Sheets that are damped.

use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Part, Sheet, generate};

/// Of two sheets that coast freely each loses its velocity at its own rate, and the account of the energy has
/// what both lose.
#[test]
fn each_of_two_sheets_has_its_own_rate() {
    let sheet = generate::isotropic_square(1, 0.1).expect("a square");
    let other = sheet.map_positions(|[x, y, z]| [x, y, z + 1.0]);
    let other = other.expect("it stays a square");
    let both = Sheet::union(&[&sheet, &other]).expect("a union");
    let parts = Part::of_union(&[&sheet, &other]);
    let rates = [0.5, 3.0];
    let model = SheetModel::new(&both, 0.2, MassKind::Lumped).expect("a model");
    let model = model
        .with_dampings(parts.iter().map(|p| p.vertices.clone()).zip(rates))
        .expect("rates");
    assert_eq!(model.damping(), None);
    let velocities = [1.0, 0.0, 0.0].repeat(both.topology().vertex_count());
    let start = State::moving(both.positions().to_vec(), velocities);
    let mut run = Simulation::new(model, start, Method::default()).expect("a simulation");
    let (steps, h) = (20, 0.01);
    let mut dissipated = 0.0;
    for _ in 0..steps {
        dissipated = run.step(h).expect("a step").dissipated;
    }
    let mut left = 0.0;
    for (part, rate) in parts.iter().zip(rates) {
        let expected = (-rate * f64::from(steps) * h).exp();
        for v in run.state().v[part.coordinates()].as_chunks::<3>().0 {
            assert!((v[0] - expected).abs() < 1e-9, "{} {expected}", v[0]);
        }
        left += 0.5 * 0.1 * expected * expected;
    }
    assert!((dissipated - (0.1 - left)).abs() < 1e-9, "{dissipated}");
}
