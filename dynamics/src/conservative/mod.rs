//! The methods that keep the energy: they solve for the impulses of the rods.

pub(crate) mod energy_momentum;
pub(crate) mod rattle;

use crate::{SheetModel, State};

/// Sets the mean velocities over a step of pins in prescribed motion; uses `x` for room.
fn mean_pin_velocities(model: &SheetModel, state: &State, h: f64, x: &mut [f64], w: &mut [f64]) {
    model.place_pins(state.t + h, x);
    for i in model.moving_pins().flat_map(|v| 3 * v..3 * v + 3) {
        w[i] = (x[i] - state.x[i]) / h;
    }
}
