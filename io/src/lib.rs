//! Files that a run reads and writes.
//!
//! | file | read | written |
//! |---|---|---|
//! | Wavefront OBJ | [`read_obj`], [`read_sheet`] | [`write_obj`], one per frame |
//! | history CSV, see [`HistoryRow`] | [`read_history`] | [`HistoryWriter`], row by row |
//! | trajectory npz, see [`Trajectory`] | [`Trajectory::read`] | [`Trajectory::write`] |
//! | Matrix Market, coordinate format | | [`write_matrix_market`] |
//! | summary JSON | [`read_json`] | [`write_json`] |
//! | 3D page of a run (feature `view`) | | `view::Replay` |
//!
//! Two rules hold for everything that is written: no number that is not finite gets into a file (a typed
//! error says which one it was), and a file appears under its name only when it is complete
//! ([`write_atomically`]). The one exception is the history, which grows by whole rows, so that what an
//! interrupted run leaves behind can be read.

mod atomic;
mod finite;
mod history;
mod json;
mod matrix_market;
mod obj;
mod obj_error;
mod obj_write;
mod polygon;
mod trajectory;
#[cfg(feature = "view")]
pub mod view;

pub use atomic::{FileWriter, WriteError, write_atomically};
pub use history::{HistoryError, HistoryRow, HistoryWriter, read_history};
pub use json::{JsonError, read_json, write_json};
pub use matrix_market::{MatrixMarketError, MatrixSymmetry, write_matrix_market};
pub use obj::{ObjMesh, ObjOptions, Polygons, parse_obj, read_obj, read_sheet};
pub use obj_error::{ObjError, ObjProblem};
pub use obj_write::{ObjWriteError, frame_path, write_obj, write_obj_to};
pub use trajectory::{Trajectory, TrajectoryError};
