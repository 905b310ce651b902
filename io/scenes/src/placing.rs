//! Sheets, bodies and obstacles in their places.

pub(crate) mod driven;
pub(crate) mod driven_surface;
pub(crate) mod in_words;
pub(crate) mod placed;
pub(crate) mod placed_bodies;
pub(crate) mod slots;
