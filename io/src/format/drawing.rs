//! Sheets of drawings.

mod edges;
mod sheet;

pub use edges::DrawnEdges;
pub use isosheet_drawings::*;
pub use sheet::{DrawingError, DrawnSheet, mesh_drawing};
