//! Vector drawings: a display list in points (1/72 inch), y upwards, written as SVG.

mod axes;
mod colour;
mod drawing;
mod layout;
mod png;
mod sheet;
pub(crate) mod spatial;
mod svg;
mod text;

pub(crate) use axes::{Axis, Legend, Line, Marker, Plot, Series};
pub(crate) use colour::{Colour, palette};
pub(crate) use drawing::{Anchor, Drawing, Stroke, Vertical};
pub(crate) use layout::{column, row};
pub(crate) use sheet::{flat_edges, flat_faces, plan};
pub(crate) use spatial::View;

/// Size of ordinary text in drawings, points.
pub(crate) const TEXT: f64 = 9.0;

/// Size of text inside crowded drawings, points.
pub(crate) const SMALL: f64 = 7.5;
