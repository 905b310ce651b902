//! Files, scenes and runs of isosheet: the crate on top of all others.
//!
//! Without features the crate has the formats of files and needs the mesh alone. The feature `scene` adds
//! scene files, `run` runs that survive being killed, and `cli` the command `isosheet`; each implies the ones
//! before it. With them the crate re-exports all others, so that a program needs to name this one alone. The
//! feature `picture`, which implies `scene`, draws shaded pictures, and `labels` puts many with labels into one.
//!
//! # Formats
//!
//! | file | read | written |
//! |---|---|---|
//! | meshes: OBJ, OFF, STL, PLY, FOLD, glTF, VTK | [`read_mesh`], [`read_sheet`] | [`write_mesh`], [`write_obj`] |
//! | series: FOLD, glTF, USD, PC2, VTK, OBJ, CSV | | [`write_series`] |
//! | history CSV, see [`HistoryRow`] | [`read_history`] | [`HistoryWriter`], row by row |
//! | trajectory npz, see [`Trajectory`] | [`Trajectory::read`] | [`Trajectory::write`] |
//! | summary JSON | [`read_json`] | [`write_json`] |
//! | 3D page of a run (feature `view`) | | `view::Replay` |
//! | shaded PNG pictures (feature `picture`) | | `picture::render`, `run::Film` |
//!
//! Two rules hold for everything that is written: no number that is not finite gets into a file (a typed
//! error says which one it was), and a file appears under its name only when it is complete
//! ([`write_atomically`]). The one exception is the history, which grows by whole rows, so that what an
//! interrupted run leaves behind can be read.

pub use isosheet_drawings::DrawnLines;
pub use isosheet_files::{
    DataError, FileError, FileWriter, ReadError, WriteError, read_json, write_atomically,
    write_json,
};
pub use isosheet_formats::*;
pub use isosheet_mesh as mesh;
pub use isosheet_mesh::Advice;

/// Sheets of drawings.
pub mod drawing {
    pub use isosheet_drawings::*;
    pub use isosheet_formats::{DrawingError, DrawnEdges, DrawnSheet, mesh_drawing};
}

#[cfg(feature = "scene")]
pub use isosheet_scenes as scene;

#[cfg(feature = "scene")]
pub use {isosheet_collide as collide, isosheet_coords as coords, isosheet_dynamics as dynamics};

#[cfg(feature = "cli")]
pub mod command;

#[cfg(feature = "picture")]
pub use isosheet_pictures as picture;

/// Runs, films and galleries.
#[cfg(feature = "run")]
pub mod run {
    #[cfg(feature = "picture")]
    pub use isosheet_films::*;
    pub use isosheet_runs::*;
}

#[cfg(feature = "view")]
pub use isosheet_page as view;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
