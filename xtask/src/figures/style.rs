//! Line styles that several figures share.

use crate::draw::{Colour, Stroke, palette};

pub(super) const EDGE: Stroke = Stroke::new(palette::INK, 0.7);
pub(super) const GHOST: Stroke = Stroke::new(palette::GREY, 0.5);
/// Paper white with a hint of warmth, so that faces differ from the background.
pub(super) const FACE: Colour = Colour::new(246, 243, 236);
