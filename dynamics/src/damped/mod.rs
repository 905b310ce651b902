//! The damped methods: a step is a minimum over the positions with the rest lengths, or a projection onto
//! them.

pub(crate) mod implicit;

pub(crate) mod minimiser;
pub(crate) mod options;
pub(crate) mod restoration;
pub(crate) mod start;
