//! Loads of vertices.

use isosheet_dynamics::{
    AccelerationField, Force, Method, Profile, SheetModel, Simulation, State, VertexLoad,
};
use isosheet_mesh::{MassKind, Sheet, VertexId};

fn triangle() -> Sheet {
    let x = vec![0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.2, 0.0];
    Sheet::new(x, &[[0, 1, 2]]).expect("a triangle")
}

/// Momentum of a free triangle after half a second under a load.
fn momentum(load: impl Force + 'static) -> [f64; 3] {
    let sheet = triangle();
    let model = SheetModel::new(&sheet, 0.1, MassKind::Consistent).expect("valid");
    let start = State::at_rest(sheet.positions().to_vec());
    let model = model.with_force(load);
    let method = Method::EnergyMomentum(Default::default());
    let mut run = Simulation::new(model, start, method).expect("valid");
    for _ in 0..500 {
        run.step(1e-3).expect("accepted");
    }
    run.model().linear_momentum(&run.state().v)
}

/// The integral of the profile over that time.
fn impulse() -> f64 {
    let (omega, end) = (std::f64::consts::TAU * 1.5, 0.5);
    0.3 * end - 0.2 / omega * ((omega * end + 0.4).cos() - 0.4_f64.cos())
}

#[test]
fn the_momentum_is_the_integral_of_the_load() {
    let sheet = triangle();
    let t = sheet.topology();
    let pushed = [VertexId(0), VertexId(1)];
    let load = VertexLoad::new(t, &pushed, [3.0, 4.0, 0.0], STROKE).expect("valid");
    let p = momentum(load);
    for (found, share) in p.iter().zip([0.6, 0.8, 0.0]) {
        let want = 2.0 * share * impulse();
        assert!((found - want).abs() < 1e-5, "{p:?}: {want} N s");
    }
    let mass = MassKind::Consistent;
    let model = SheetModel::new(&sheet, 0.1, mass).expect("valid");
    let weights = model.mass().row_sums(t);
    let field = AccelerationField::new(weights, [0.0, -2.0, 0.0], STROKE).expect("valid");
    let p = momentum(field);
    for (found, share) in p.iter().zip([0.0, -1.0, 0.0]) {
        let want = 0.1 * share * impulse();
        assert!((found - want).abs() < 1e-6, "{p:?}: {want} N s");
    }
}

const STROKE: Profile = Profile::Sine {
    mean: 0.3,
    amplitude: 0.2,
    frequency: 1.5,
    phase: 0.4,
};
