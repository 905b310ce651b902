//! Meshes: where they come from, and parts of them.

pub(crate) mod direction;
pub(crate) mod drawing;
pub(crate) mod foreign;
pub(crate) mod mesh;
pub(crate) mod mesh_file;
pub(crate) mod outline;
pub(crate) mod pattern;
pub(crate) mod selection;
pub(crate) mod sequence;
pub(crate) mod up_axis;
