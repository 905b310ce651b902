//! Sheets of drawings.

mod edges;
mod sheet;

pub use edges::DrawnEdges;
pub use sheet::{DrawingError, DrawnSheet, mesh_drawing};
