//! Files that a run reads and writes, one format a file. Needs the mesh alone.

pub mod drawing;
mod events;
mod export;
mod history;
mod loads;
mod measures;
mod mesh_file;
#[cfg(feature = "scene")]
mod motion_file;
mod trajectory;

pub use isosheet_drawings::DrawnLines;
pub use isosheet_files::{
    DataError, FileError, FileWriter, ReadError, WriteError, read_json, write_atomically,
    write_json,
};

pub use events::{EventChange, EventKind, EventRow, EventWriter, read_events};
pub use export::{
    BodyPose, ExportError, ExportMeshFormat, Exported, FieldSupport, MOST_KEY_FRAMES, Series,
    SeriesBody, SeriesField, SeriesFormat, SeriesOptions, frame_path, thickened, write_frame,
    write_mesh, write_obj, write_series,
};
pub use history::{HistoryRow, HistoryWriter, Row, RowWriter, Written, read_history};
pub use loads::{LoadKind, LoadRow, LoadWriter, read_loads};
pub use measures::{MeasureRow, MeasureWriter, read_measures};
pub use mesh_file::{
    EdgeAssignment, FaceGroups, FileCrease, FoldFrame, Location, MeshFile, MeshFileError,
    MeshFileProblem, MeshFormat, MeshOptions, Polygons, ReadingChanges, Repair, SeparateBuffers,
    parse_mesh, read_mesh, read_mesh_with, read_sheet,
};
#[cfg(feature = "run")]
pub(crate) use motion_file::sources;
#[cfg(feature = "scene")]
pub(crate) use motion_file::{motion_archive, says_up};
#[cfg(feature = "scene")]
pub(crate) use trajectory::{Clock, MovingMesh};
pub use trajectory::{FrameData, Trajectory};
#[cfg(feature = "run")]
pub(crate) use trajectory::{FrameQuantity, MeshCounts, MotionError};
#[cfg(feature = "view")]
pub(crate) use trajectory::{Motion, MotionFrame};
