//! A free sheet that flies and tumbles.

use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet};

/// A sheet of 0.1 kg about the square `[0, 1]^2` (metres) without gravity and supports, and a start at which
/// it flies, turns and bends: smooth velocities, made compatible with the lengths by a step of 1 microsecond
/// of the projection method.
pub fn tumbling(sheet: &Sheet) -> (SheetModel, State) {
    let model = || SheetModel::new(sheet, 0.1, MassKind::Lumped).expect("valid");
    let x = sheet.positions().to_vec();
    let v = x
        .chunks(3)
        .flat_map(|p| {
            [
                0.3 - 2.0 * p[1] + p[2],
                0.1 + 2.0 * p[0],
                1.0 - p[0] + 0.8 * (p[0] - 0.5) * (p[1] - 0.3),
            ]
        })
        .collect();
    let projection = Method::Projection(Default::default());
    let mut settle = Simulation::new(model(), State::moving(x, v), projection).expect("valid");
    settle.step(1e-6).expect("accepted");
    let State { x, v, .. } = settle.state().clone();
    (model(), State::moving(x, v))
}
