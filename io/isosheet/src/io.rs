//! With features: files, scenes, runs, pictures and the command.

#[cfg(feature = "files")]
pub use isosheet_drawings::DrawnLines;
#[cfg(feature = "files")]
pub use isosheet_files::{
    DataError, FileError, FileWriter, ReadError, WriteError, read_json, write_atomically,
    write_json,
};
#[cfg(feature = "files")]
pub use isosheet_formats::{
    BodyPose, EdgeAssignment, EventChange, EventKind, EventRow, EventWriter, ExportError,
    ExportMeshFormat, Exported, FaceGroups, FieldSupport, FileCrease, FoldFrame, FrameData,
    HistoryRow, HistoryWriter, LoadKind, LoadRow, LoadWriter, Location, MOST_KEY_FRAMES,
    MeasureRow, MeasureWriter, MeshFile, MeshFileError, MeshFileProblem, MeshFormat, MeshOptions,
    Polygons, ReadingChanges, Repair, Row, RowWriter, SeparateBuffers, Series, SeriesBody,
    SeriesField, SeriesFormat, SeriesOptions, Trajectory, Written, frame_path, parse_mesh,
    read_events, read_history, read_loads, read_measures, read_mesh, read_mesh_with, read_sheet,
    thickened, write_frame, write_mesh, write_obj, write_series,
};
pub use isosheet_mesh::Advice;

/// Drawings of sheets: lines with colours, dashes and layers, and the meshes that follow them.
#[cfg(feature = "files")]
pub mod drawing {
    pub use isosheet_drawings::{
        ClassCount, Colour, Drawing, DrawingFormat, DrawingOptions, DrawingReport, DrawingUnit,
        DrawnLine, Length, LineClass, LineRules, Pen, Places, Selector, parse_drawing,
        read_drawing,
    };
    pub use isosheet_formats::{DrawingError, DrawnEdges, DrawnSheet, mesh_drawing};
}

#[cfg(feature = "cli")]
pub use isosheet_io as command;

#[cfg(feature = "view")]
pub use isosheet_page as view;

#[cfg(feature = "picture")]
pub use isosheet_pictures as picture;

#[cfg(feature = "scene")]
pub use isosheet_scenes as scene;

/// Runs of scenes in folders, and with the feature `film` films and galleries of them.
#[cfg(feature = "run")]
pub mod run {
    #[cfg(feature = "film")]
    pub use isosheet_films::*;
    pub use isosheet_runs::*;
}
