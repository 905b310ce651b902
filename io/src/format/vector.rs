//! Files of drawing programs, as curves with colours, dashes and layers.

mod colour;
pub(super) mod dxf;
mod lines;
pub(super) mod svg;
mod unit;

pub use colour::Colour;
pub use lines::{Drawing, DrawnLine, Pen};
pub use unit::{DrawingUnit, Length};
