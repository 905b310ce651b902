//! Texts of scenes: how they are read, written and begun.

pub(crate) mod changed;
pub(crate) mod fold_scene;
pub(crate) mod form;
pub(crate) mod schema;
pub(crate) mod source;
pub(crate) mod starting_point;
