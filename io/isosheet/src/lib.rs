#![doc = include_str!("../README.md")]
//!
//! # More than these lines
//!
//! - Meshes of one's own triangles: [`mesh::Sheet::new`]; of files, with the feature `files`:
//!   `io::read_sheet`.
//! - Materials of one's own: [`dynamics::Material`]. Rods in place of an elastic sheet, creases, and bends
//!   that stay: [`dynamics::SheetOfMaterial`].
//! - Supports that move, vertices on curves and surfaces: [`dynamics::SheetModel::with_moving_pin`],
//!   [`dynamics::SheetModel::with_constraint`].
//! - Obstacles that are turned or move: [`dynamics::RigidDisplacement`], [`collide::Obstacle::new`].
//! - Distances, continuous collision detection, shapes of one's own: [`geometry`], [`geometry::Form`].
//! - Friction of each obstacle, thickness of the sheet: [`collide::Contacts::new`],
//!   [`collide::ContactOptions`].
//! - Loads, air, potentials and forces of one's own: [`dynamics::SheetModel`], [`dynamics::Potential`],
//!   [`dynamics::Force`].
//! - Lift and a wake: [`attached_flow::AttachedFlow`].
//! - Energies, strain and gap of each step, frames: [`dynamics::StepReport`], [`dynamics::History`],
//!   [`dynamics::Frames`].
//! - Torques on obstacles, forces of contact at vertices: [`dynamics::Simulation::body_loads`],
//!   [`dynamics::Simulation::contact_forces`].
//! - Gradients of runs by what a scene says: [`adjoint::Run`].
//! - Other methods, and the paper's coordinates: [`dynamics::Method`], [`coords`], [`charts`].
//! - Meshes and series of frames as files, with the feature `files`: `io::write_mesh`, `io::write_series`.
//! - Scene files, runs and the command: the features `scene`, `run` and `cli`, with `io::scene`, `io::run`
//!   and `io::command`.
//!
//! All numbers are in SI units. Beside functions of arrays there are functions of vectors of `nalgebra`; its
//! version is re-exported as [`nalgebra`].

pub mod io;

pub use isosheet_adjoint as adjoint;
pub use isosheet_attached_flow as attached_flow;
pub use isosheet_charts as charts;
pub use isosheet_collide as collide;
pub use isosheet_coords as coords;
pub use isosheet_dynamics as dynamics;
pub use isosheet_dynamics::nalgebra;
pub use isosheet_geometry as geometry;
pub use isosheet_linalg as linalg;
pub use isosheet_mesh as mesh;

/// What most programs name: `use isosheet::prelude::*;`.
pub mod prelude {
    pub use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
    pub use isosheet_dynamics::{
        Air, At, Checkpoint, CreaseSprings, Force, Frames, HessianSink, History, Isotropic,
        Material, Method, Observer, PointProfile, Potential, Profile, RigidDisplacement,
        SheetModel, Simulation, State, StepError, StepReport, Support, VertexConstraint,
        VertexLoad,
    };
    #[cfg(feature = "files")]
    pub use isosheet_formats::{read_sheet, write_mesh, write_series};
    pub use isosheet_mesh::{Advice, EdgeId, FaceId, MassKind, Sheet, VertexId, generate};
}
