//! What the solver makes of an implementation of [`Contact`](super::Contact), for tests, benchmarks and
//! reports of the workspace. It is no part of the public interface and may change in any version.

pub use super::barrier::BarrierPotential;
pub use super::course::Course;
pub use super::lagged::{FrictionContact, LaggedFriction};
pub use super::set::ContactSet;
pub use super::stencil::Stencil;
pub use super::terms::{ContactState, ContactTerms};
pub use isosheet_materials::hessian::CouplingSink;
