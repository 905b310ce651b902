//! What round-off of the coordinates allows to ask for.

use crate::{SheetModel, State};
use isosheet_linalg::norm_inf;

/// Smallest edge strain that round-off in the coordinates allows to ask for.
pub fn strain_floor(model: &SheetModel, state: &State) -> f64 {
    let size = norm_inf(&state.x);
    let shortest = model
        .edges()
        .lengths()
        .iter()
        .fold(f64::INFINITY, |m, l| m.min(*l));
    4.0 * f64::EPSILON * (size / shortest + 1.0)
}

/// Velocities below this are round-off: of the speed, and of positions over a step.
pub fn velocity_round_off(state: &State, h: f64) -> f64 {
    16.0 * f64::EPSILON * (norm_inf(&state.x) / h.abs() + norm_inf(&state.v))
}
