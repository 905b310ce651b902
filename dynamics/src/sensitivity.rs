//! What a run tells to whoever differentiates it: its accepted sub-steps, and their equations at any place.

mod equations;

pub use crate::contact::ReachedPairs;
pub use crate::step::accepted::{AcceptedStep, OfState, StepEvent, StepKind};
pub use equations::{FrictionLag, StepEquations};
