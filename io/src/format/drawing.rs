//! Drawings of sheets: lines with colours, dashes and layers, from files of drawing programs.

mod class;
mod edges;
mod file;
mod options;
mod report;
mod rules;
mod selector;
mod sheet;

pub use super::vector::{Colour, Drawing, DrawingUnit, DrawnLine, Length, Pen};
pub use class::LineClass;
pub use edges::DrawnEdges;
#[cfg(feature = "scene")]
pub(crate) use edges::refuse_idle;
pub use file::{DrawingFormat, parse_drawing, read_drawing};
pub use options::DrawingOptions;
pub use report::{ClassCount, DrawingReport, Places};
pub use rules::LineRules;
pub use selector::Selector;
pub use sheet::{DrawingError, DrawnSheet, mesh_drawing};
