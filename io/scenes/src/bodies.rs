//! What a sheet meets: obstacles, and bodies that respond.

pub(crate) mod body;
pub(crate) mod carried;
pub(crate) mod friction;
pub(crate) mod guides;
pub(crate) mod obstacle_names;
pub(crate) mod obstacles;
pub(crate) mod round_bodies;
