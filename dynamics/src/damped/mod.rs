//! The damped methods: a step is a minimum over the positions with the rest lengths.
pub(crate) mod equilibrium;
pub(crate) mod formula;
pub(crate) mod implicit;
pub(crate) mod minimiser;
pub(crate) mod options;
pub(crate) mod restitution;
pub(crate) mod restoration;
pub(crate) mod start;
pub(crate) mod turning;

/// Part of a promised decrease that has to come true in a line search, the usual value of Armijo's condition
/// (Nocedal and Wright, "Numerical Optimization", 2006, Sec. 3.1).
const ARMIJO: f64 = 1e-4;
