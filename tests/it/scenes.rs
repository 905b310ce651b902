//! Sheets that several tests use.

use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use std::f64::consts::PI;

/// The union-jack square `M^level` of side 1 m with a bump of the given height in metres.
pub(crate) fn bumped(level: u32, bump: f64) -> Sheet {
    let flat = generate::isotropic_square(level, 1.0).expect("valid");
    let mut x = flat.positions().to_vec();
    for p in x.chunks_mut(3) {
        p[2] = bump * (PI * p[0]).sin() * (PI * p[1]).sin();
    }
    Sheet::new(x, &flat.face_indices()).expect("valid")
}

/// The corner (0, 1) of `M^level`.
pub(crate) fn corner(level: u32) -> VertexId {
    let n = (1 << (level + 1)) + 1;
    VertexId(n * (n - 1))
}

/// A sheet of 0.1 kg under gravity, pinned at the corner (0, 1).
pub(crate) fn pinned(level: u32, bump: f64) -> SheetModel {
    SheetModel::new(&bumped(level, bump), 0.1, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_pins(&[corner(level)])
        .expect("the corner exists")
}

/// That sheet at rest.
pub(crate) fn hanging(level: u32, bump: f64, method: Method) -> Simulation {
    let start = State::at_rest(bumped(level, bump).positions().to_vec());
    Simulation::new(pinned(level, bump), start, method).expect("valid")
}

/// The chart-free integrators, the three damped ones first.
pub(crate) fn methods() -> [(&'static str, Method); 6] {
    [
        ("implicit Euler", Method::ImplicitEuler(Default::default())),
        ("BDF2", Method::Bdf2(Default::default())),
        ("projection", Method::Projection(Default::default())),
        (
            "energy-momentum",
            Method::EnergyMomentum(Default::default()),
        ),
        ("RATTLE", Method::Rattle(Default::default())),
        (
            "RATTLE composition",
            Method::RattleComposition(Default::default()),
        ),
    ]
}

/// Largest absolute difference of two vectors.
pub(crate) fn gap(a: &[f64], b: &[f64]) -> f64 {
    isosheet_tests::max_difference(a, b)
}
