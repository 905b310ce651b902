//! Vector drawings, charts by plotters, and shaded pictures.
//!
//! A drawing is a display list in points (1/72 inch), y upwards. Drawings and charts are written as SVG.

mod axis;
mod chart;
mod colour;
mod drawing;
mod marker;
mod series;
mod shaded;
mod sheet;
pub(crate) mod spatial;
mod svg;
mod text;

pub(crate) use axis::{Axis, mesh_name};
pub(crate) use chart::{Chart, Charts, Legend};
pub(crate) use colour::{Colour, palette};
pub(crate) use drawing::{Anchor, Drawing, Stroke, Vertical, column, row};
pub(crate) use marker::Marker;
pub(crate) use series::Series;
pub(crate) use shaded::{Shot, Viewpoint};
pub(crate) use sheet::{flat_edges, flat_faces, plan};
pub(crate) use spatial::Projection;
pub(crate) use svg::Vector;
pub(crate) use text::{SMALL, TEXT};
