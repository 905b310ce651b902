//! Vector drawings: a display list in points (1/72 inch), y upwards, written as SVG.

mod axes;
mod chart;
mod colour;
mod drawing;
mod layout;
mod series;
mod shaded;
mod sheet;
pub(crate) mod spatial;
mod svg;
mod text;

pub(crate) use axes::Axis;
pub(crate) use chart::{Chart, Legend, Missing};
pub(crate) use colour::{Colour, palette};
pub(crate) use drawing::{Anchor, Drawing, Stroke, Vertical};
pub(crate) use layout::{column, row};
pub(crate) use series::{Line, Marker, Series};
pub(crate) use shaded::{Shot, Viewpoint};
pub(crate) use sheet::{flat_edges, flat_faces, plan};
pub(crate) use spatial::View;
pub(crate) use text::{SMALL, TEXT};
