#![doc = include_str!("../README.md")]

mod curve_file;
mod drawing;
mod events;
mod export;
mod history;
mod loads;
mod measures;
mod mesh_file;
mod motion_file;
mod trajectory;

pub use curve_file::{parse_curve, read_curve};
pub use drawing::{DrawingError, DrawnEdges, DrawnSheet, mesh_drawing};
pub use events::{EventChange, EventKind, EventRow, EventWriter, read_events};
pub use export::{
    BodyPose, ExportError, ExportMeshFormat, Exported, FieldSupport, MOST_KEY_FRAMES, Series,
    SeriesBody, SeriesField, SeriesFormat, SeriesOptions, frame_path, thickened, write_frame,
    write_mesh, write_obj, write_pattern, write_series,
};
pub use history::{HistoryRow, HistoryWriter, Row, RowWriter, Written, read_history};
pub use loads::{LoadKind, LoadRow, LoadWriter, read_loads};
pub use measures::{MeasureRow, MeasureWriter, read_measures};
pub use mesh_file::{
    EdgeAssignment, FaceGroups, FileCrease, FoldFrame, Location, MeshFile, MeshFileError,
    MeshFileProblem, MeshFormat, MeshOptions, Polygons, ReadingChanges, Repair, SeparateBuffers,
    parse_mesh, read_mesh, read_mesh_with, read_sheet,
};
pub use motion_file::{motion_archive, says_up, sources};
pub use trajectory::{
    Clock, FrameData, FrameQuantity, MeshCounts, MotionFrame, MotionFrames, MovingMesh, Trajectory,
    WriteMotionError,
};
