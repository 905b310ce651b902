#![doc = include_str!("../README.md")]

mod class;
mod colour;
mod drawn;
mod dxf;
mod file;
mod lines;
mod options;
mod report;
mod rules;
mod selector;
mod stroke;
pub mod svg;
mod unit;
mod written;

pub use class::LineClass;
pub use colour::Colour;
pub use drawn::DrawnLines;
pub use file::{DrawingFormat, parse_drawing, read_drawing};
pub use lines::{Drawing, DrawnLine, Pen};
pub use options::DrawingOptions;
pub use report::{ClassCount, DrawingReport, Places};
pub use rules::LineRules;
pub use selector::{Selector, listed, refuse_idle};
pub use stroke::Stroke;
pub use unit::{DrawingUnit, Length};
pub use written::write_drawing;
