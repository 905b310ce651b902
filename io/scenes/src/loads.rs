//! Loads: forces, pressures and the air.

pub(crate) mod air;
pub(crate) mod attached_flow;
pub(crate) mod enclosed;
pub(crate) mod follower_loads;
pub(crate) mod forces;
