//! How stiff the barrier at the limit of the strain has to be.

use crate::potential::Reached;
use crate::vectors::{diameter, largest_norm};

/// Stiffness of the barrier in parts of the energy of the motion to come, see [`strain_barrier`]. From 0.01
/// to 3 all runs end; factorisations a step with 0.003, 0.01, 0.03, 0.1, 0.3, 1 and 3: 40 clamped sheets 5.6,
/// 4.7, 4.8, 5.3, 5.9, 6.7, 7.2; 24 sheets that fall on bodies 40, 17, 15, 16, 17, 19, 21; a banner of 289
/// vertices on two corners 8.8, 8.1, 9.1, 10, 11, 13, 15.
const BARRIER_PART: f64 = 0.03;

/// The stiffness `kappa` of the barrier that an elastic sheet needs at a state, joules per square metre: 3 %
/// of `rho (a L + v^2)`, with the mass per area `rho` (kg/m2), the largest acceleration `a` by constant
/// forces (m/s2; 9.8 if there are none), the diameter `L` of the sheet and its largest speed `v`. What is in
/// parentheses is about the square of the speed with which the sheet meets an obstacle.
pub(super) fn strain_barrier(density: f64, acceleration: f64, state: Reached<'_>) -> f64 {
    let speed = largest_norm(state.v);
    BARRIER_PART * density * (acceleration * diameter(state.x) + speed * speed)
}
