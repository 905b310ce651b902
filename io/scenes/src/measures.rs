//! What is read off: measures, and how far targets are reached.

pub(crate) mod measure;
pub(crate) mod targets;
