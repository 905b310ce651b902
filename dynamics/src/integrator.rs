//! What all integrators have in common.

use crate::contact::{ContactState, StepContact};
use crate::reaction::Balance;
use crate::report::{Accepted, Effort, StepError};
use crate::{SheetModel, State};

/// What an integrator moves: a sheet, and what it may touch.
pub struct Scene<'a> {
    /// The sheet.
    pub model: &'a SheetModel,
    /// Contact, in scenes that name it; only methods that [`Integrator::takes_contact`] are given any.
    pub contact: Option<StepContact<'a>>,
}

/// A one-step method.
pub trait Integrator: Send {
    /// Advances `state` by `h`, or leaves it as it was and says why.
    ///
    /// `effort` is counted up whether the step is accepted or not.
    ///
    /// # Errors
    /// [`StepError`]
    fn step(
        &mut self,
        scene: Scene<'_>,
        state: &mut State,
        h: f64,
        effort: &mut Effort,
    ) -> Result<Accepted, StepError>;

    /// What the method asks of the rods.
    fn demand(&self) -> RodDemand;

    /// Forgets the steps before the last, for methods that look back further; whether there was anything
    /// to forget.
    fn restart(&mut self) -> bool {
        false
    }

    /// The forces of the supports in the last accepted step. Meaningless before.
    fn balance(&self) -> &Balance;

    /// The contacts at the end of the last accepted step; `None` in scenes without contact.
    fn contact_state(&self) -> Option<&ContactState> {
        None
    }

    /// Whether the method has a place for one-sided vertex constraints.
    fn takes_one_sided(&self) -> bool {
        self.demand() == RodDemand::Nothing
    }

    /// Whether the method has a place for contact.
    fn takes_contact(&self) -> bool {
        false
    }
}

/// What an integrator asks of the rods' rigidity matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RodDemand {
    /// Loaded rods have to be independent: the method solves for their impulses.
    Independent,
    /// Nothing: the method minimises, at any rank.
    Nothing,
}

/// An option that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("option {name} is {value}; give a value from {min} to {max}")]
pub struct OptionsError {
    /// Name of the option.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Smallest value that makes sense.
    pub min: f64,
    /// Largest value that makes sense.
    pub max: f64,
}

impl OptionsError {
    pub(crate) fn check_range(
        name: &'static str,
        value: f64,
        min: f64,
        max: f64,
    ) -> Result<(), Self> {
        if (min..=max).contains(&value) {
            Ok(())
        } else {
            Err(Self {
                name,
                value,
                min,
                max,
            })
        }
    }

    pub(crate) fn check_count(name: &'static str, value: usize) -> Result<(), Self> {
        Self::check_range(name, value as f64, 1.0, 1e6)
    }
}
