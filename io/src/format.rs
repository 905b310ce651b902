//! Files that a run reads and writes, one format a file. Needs the mesh alone.

pub(crate) mod allowance;
pub(crate) mod atomic;
#[cfg(feature = "run")]
mod cell;
mod data_error;
pub mod drawing;
mod events;
mod export;
mod file_error;
mod finite;
mod history;
pub(crate) mod input;
mod json;
mod loads;
mod measures;
pub(crate) mod memory;
mod mesh_file;
#[cfg(feature = "scene")]
mod motion_file;
mod numbered;
mod trajectory;
mod vector;
pub(crate) mod xml;

#[cfg(all(feature = "run", feature = "picture"))]
pub(crate) use atomic::prepare_folder;
pub use atomic::{FileWriter, write_atomically};
#[cfg(feature = "run")]
pub(crate) use cell::cell;
pub use data_error::DataError;
#[cfg(feature = "run")]
pub(crate) use finite::check_finite;

pub use events::{EventChange, EventKind, EventRow, EventWriter, read_events};
pub use export::{
    BodyPose, ExportError, ExportMeshFormat, Exported, FieldSupport, MOST_KEY_FRAMES, Series,
    SeriesBody, SeriesField, SeriesFormat, SeriesOptions, frame_path, thickened, write_frame,
    write_mesh, write_obj, write_series,
};
pub use file_error::{FileError, ReadError, WriteError};
pub use history::{HistoryRow, HistoryWriter, Row, RowWriter, Written, read_history};
pub use json::{read_json, write_json};
pub use loads::{LoadKind, LoadRow, LoadWriter, read_loads};
pub use measures::{MeasureRow, MeasureWriter, read_measures};
pub use mesh_file::{
    DrawnLines, EdgeAssignment, FaceGroups, FileCrease, FoldFrame, Location, MeshFile,
    MeshFileError, MeshFileProblem, MeshFormat, MeshOptions, Polygons, ReadingChanges, Repair,
    SeparateBuffers, parse_mesh, read_mesh, read_mesh_with, read_sheet,
};
#[cfg(feature = "run")]
pub(crate) use motion_file::sources;
#[cfg(feature = "scene")]
pub(crate) use motion_file::{motion_archive, says_up};
#[cfg(feature = "run")]
pub(crate) use numbered::NumberedFiles;
#[cfg(feature = "scene")]
pub(crate) use trajectory::{Clock, MovingMesh};
pub use trajectory::{FrameData, Trajectory};
#[cfg(feature = "run")]
pub(crate) use trajectory::{FrameQuantity, MeshCounts, MotionError};
#[cfg(feature = "view")]
pub(crate) use trajectory::{Motion, MotionFrame};
