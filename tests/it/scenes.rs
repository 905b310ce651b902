//! Sheets that several tests use.

pub(crate) use isosheet_tests::{bumped, corner, methods};

use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::MassKind;

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

/// Largest absolute difference of two vectors.
pub(crate) fn gap(a: &[f64], b: &[f64]) -> f64 {
    isosheet_tests::max_difference(a, b)
}
