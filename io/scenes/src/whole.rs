//! What is found and checked in the scene as a whole.

pub(crate) mod functions;
pub(crate) mod named_file;
pub(crate) mod names;
pub(crate) mod periods;
pub(crate) mod selections;
pub(crate) mod step_path;
pub(crate) mod switches;
pub(crate) mod turning_back;
