//! Contact of sheets with obstacles and with themselves.
//!
//! * [`Contacts`]: all of it together, as a step of [`isosheet_dynamics::contact`] asks for it, where barrier
//!   and friction are functions of distances.
//! * [`Obstacle`]: a [`Shape`], such as a half-space, box, ball, cylinder, capsule or [`TriangleSurface`], at
//!   rest or in a prescribed [`RigidMotion`]; [`Obstacle::constraint`] constrains a vertex to one.
//!
//! Distances, continuous collision detection, the broad phase and all else that shapes are is in
//! [`isosheet_geometry`], which needs no mechanics.
//!
//! A sheet falls on a table and rests with every gap open:
//!
//! ```
//! use isosheet_collide::{Coefficients, Contacts, Obstacle, Shape};
//! use isosheet_dynamics::{Method, SheetModel, Simulation, State};
//! use isosheet_mesh::{MassKind, generate};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let sheet = generate::isotropic_square(1, 1.0)?;
//! let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?.with_gravity();
//! let table = Obstacle::at(Shape::Cuboid { half: [0.25, 0.25, 0.1] }, [0.5, 0.5, -0.101])?;
//! let contacts = Contacts::for_sheet(&model, [table], Coefficients::equal(0.3))?;
//! let start = State::at_rest(sheet.positions().to_vec());
//! let mut simulation = Simulation::new(model, start, Method::default())?.with_contact(contacts)?;
//! for _ in 0..30 {
//!     let report = simulation.step(1.0 / 60.0)?;
//!     assert!(report.gap.is_some_and(|gap| gap > 0.0));
//! }
//! // It hangs over the edges; the table carries part of its weight.
//! assert!(simulation.obstacle_forces()[0][2] < 0.0);
//! # Ok(())
//! # }
//! ```
//!
//! Everything is free of absolute tolerances: a sheet of a micrometre and one of a kilometre are
//! treated alike. SI units and `f64` throughout.

mod constraint;
mod contacts;
mod obstacle;

pub use contacts::{ContactOptions, Contacts, ContactsError, RoundBody};
pub use isosheet_dynamics::contact::{
    Coefficients, Friction, FrictionError, FrictionLaw, Stiffness,
};
pub use nalgebra;
pub use obstacle::{Obstacle, ObstacleError};

#[doc(no_inline)]
pub use isosheet_dynamics::{Keyframe, MotionError, RigidMotion};
#[doc(no_inline)]
pub use isosheet_geometry::{
    CcdOptionsError, Shape, ShapeError, SignedDistance, SurfaceError, TriangleSurface,
};

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
