//! Gradients of runs: how a number that depends on positions, velocities, forces of supports and energies at
//! chosen times, a *loss*, changes with whatever a scene says, by the discrete adjoint. A gradient costs less
//! than the run, and for each parameter two scenes that are built, and evaluations of what the parameter
//! changes.
//!
//! | | |
//! |---|---|
//! | [`Family`], [`Scene`] | the scene as a function of numbers; a closure is one |
//! | [`Plan`] | method and steps: BDF2, implicit Euler, searches for equilibria |
//! | [`Run`] | the run with its accepted steps |
//! | [`Loss`] | the number; a closure is one, and [`coordinate`], [`squared_distances`], [`support_force`] and [`energy`] are others |
//! | [`Moment`] | what a loss may look at |
//! | [`Gradient`] | its derivatives by the numbers and by the state at the start |
//! | [`AdjointError`] | what has no derivative, with the time and what to do |
//!
//! The rigidity of a strip of film by its sag: three gradients of the height of its tip at rest.
//!
//! ```
//! use isosheet_adjoint::{AdjointOptions, Plan, Run, Scene, SceneError, coordinate};
//! use isosheet_dynamics::{ImplicitOptions, Material, Method, SheetModel, State};
//! use isosheet_mesh::generate;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
//! // The scene by its numbers: here the rigidity alone, newton metres.
//! let strip = |numbers: &[f64]| -> Result<Scene, SceneError> {
//!     let sheet = generate::anisotropic_grid(10, 2, 0.2, 0.04)?;
//!     let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
//!     let mut film = Material::office_paper();
//!     film.rigidity = numbers[0];
//!     let model = SheetModel::of_material(&sheet, &film).clamped(&clamp).build()?.with_gravity();
//!     Ok(Scene::new(model, State::at_rest(sheet.positions().to_vec())))
//! };
//! let plan = Plan::steps(Method::Equilibrium(ImplicitOptions::default()), 1.0, 1);
//! let height = coordinate(10, 2, 1); // of vertex 10, a corner of the free end, after the first step
//!
//! let measured = -0.04;
//! let mut rigidity = 5e-4;
//! for _ in 0..6 {
//!     let run = Run::record(&strip, &[rigidity], plan.clone(), AdjointOptions::default())?;
//!     let gradient = run.gradient(&height)?;
//!     rigidity -= (gradient.value - measured) / gradient.of_numbers[0]; // Newton's method
//! }
//! let run = Run::record(&strip, &[rigidity], plan, AdjointOptions::default())?;
//! assert!((run.value(&height)? - measured).abs() < 1e-6);
//! # Ok(())
//! # }
//! ```
//!
//! # What is differentiated
//!
//! What each accepted step really solved: the minimum of its incremental potential under the equations of
//! rods and supports, with contact as a barrier, with friction as it was lagged, with what an elastic sheet
//! remembers of its bends. See the page *Gradients* of the book for the derivation, and for when a gradient
//! is true and useless.
//!
//! The derivatives of a step by a number are central differences of its *equations* at the states of the run,
//! between two models that differ by a part 1e-5 of the number ([`AdjointOptions::difference`]): no other run
//! is made, and whatever a closure can build has a derivative. By the states before they are those that
//! terms, forces and potentials give.
//!
//! # What has no derivative
//!
//! A fallback, bodies whose velocities are corrected after an impact, a material that yields, a force from
//! outside that does not say how it depends on the state: each is an error with its time, or counts as
//! constant and is named in [`Gradient::passed_by`] ([`Branches`]).

mod blocks;
mod error;
mod factor;
mod family;
mod gradient;
mod krylov;
mod level;
mod loss;
mod memory;
mod moment;
mod neighbours;
mod options;
mod rows;
mod run;
mod sweep;
mod system;

pub use error::{AdjointError, SceneError};
pub use family::{Family, Plan, Scene};
pub use gradient::{Effort, Gradient, PassedBy};
pub use isosheet_dynamics::sensitivity::{OfState, StepEvent};
pub use loss::{Loss, OfMoments, Share, coordinate, energy, squared_distances, support_force};
pub use moment::{Energies, Moment, View};
pub use options::{AdjointOptions, Branches, Kept};
pub use run::Run;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
