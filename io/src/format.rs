//! Files that a run reads and writes, one format a file. Needs the mesh alone.

pub(crate) mod atomic;
mod finite;
mod history;
mod json;
mod matrix_market;
mod obj;
mod obj_error;
mod obj_write;
mod polygon;
mod repair;
mod trajectory;

pub use atomic::{FileWriter, WriteError, write_atomically};
pub use history::{HistoryError, HistoryRow, HistoryWriter, read_history};
pub use json::{JsonError, read_json, write_json};
pub use matrix_market::{MatrixMarketError, MatrixSymmetry, write_matrix_market};
pub use obj::{ObjMesh, ObjOptions, Polygons, parse_obj, read_obj, read_sheet};
pub use obj_error::{ObjError, ObjProblem};
pub use obj_write::{ObjWriteError, frame_path, write_obj, write_obj_to};
pub use repair::Repair;
pub use trajectory::{Trajectory, TrajectoryError};
