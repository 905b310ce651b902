//! Drawings of sheets: lines with colours, dashes and layers, from files of drawing programs.

mod class;
mod colour;
mod dxf;
mod file;
mod lines;
mod options;
mod report;
mod rules;
mod selector;
mod sheet;
pub(in crate::format) mod svg;
mod unit;

pub use class::LineClass;
pub use colour::Colour;
pub use file::{DrawingFormat, parse_drawing, read_drawing};
pub use lines::{Drawing, DrawnLine, Pen};
pub use options::DrawingOptions;
pub use report::{ClassCount, DrawingReport, Places};
pub use rules::LineRules;
pub use selector::Selector;
pub use sheet::{DrawingError, DrawnSheet, mesh_drawing};
pub use unit::{DrawingUnit, Length};
