//! What stands in the way of a gradient.

use isosheet_dynamics::SimulationError;
use isosheet_dynamics::sensitivity::StepEvent;
use isosheet_linalg::LinalgError;
use isosheet_materials::NoDerivative;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::{brief, given};
use isosheet_model::StepError;
use std::error::Error;

/// Why a scene cannot be built.
pub type SceneError = Box<dyn Error + Send + Sync>;

/// Why a run cannot be recorded, or has no gradient.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AdjointError {
    /// A scene cannot be built of numbers.
    #[error("the scene cannot be built{}: {source}", .number.map_or_else(String::new, |n| {
        format!(" with another value of number {n}")
    }))]
    Scene {
        /// The number that was changed, if it is not the scene of the run.
        number: Option<usize>,
        /// Why.
        source: SceneError,
    },
    /// A simulation does not start.
    #[error(transparent)]
    Start(#[from] SimulationError),
    /// A step fails.
    #[error("step {number} fails: {source}")]
    Step {
        /// Of the plan, from 0.
        number: usize,
        /// Why.
        source: StepError,
    },
    /// The method hands out no sub-steps: it is neither BDF2 nor implicit Euler nor a search for equilibria.
    #[error("step {number} of the run hands out no accepted sub-steps")]
    Method {
        /// Of the plan, from 0.
        number: usize,
    },
    /// The equations of a step cannot be evaluated.
    #[error("the equations of the step that ends at t = {t} s cannot be evaluated: {source}", t = brief(*t))]
    Equations {
        /// Time, seconds.
        t: f64,
        /// Why.
        source: StepError,
    },
    /// Something has no derivative.
    #[error("in the step that ends at t = {t} s {source}", t = brief(*t))]
    NoDerivative {
        /// Time, seconds.
        t: f64,
        /// What.
        source: NoDerivative,
    },
    /// Something happened in a step that has no derivative.
    #[error("in the step that ends at t = {t} s {}", what_happened(*.event), t = brief(*t))]
    Event {
        /// Time, seconds.
        t: f64,
        /// What.
        event: StepEvent,
    },
    /// A linear system has no solution of the accuracy that was asked for.
    #[error("the linear system of the step that ends at t = {t} s is solved to {residual} only",
        t = brief(*t), residual = brief(*residual))]
    Unsolved {
        /// Time, seconds.
        t: f64,
        /// What is left, relative to the right-hand side.
        residual: f64,
    },
    /// A matrix cannot be factorised.
    #[error("the matrix of the step that ends at t = {t} s: {source}", t = brief(*t))]
    Linalg {
        /// Time, seconds.
        t: f64,
        /// Why.
        source: LinalgError,
    },
    /// Other numbers make another sheet: another mesh, other pinned vertices, or other memories.
    #[error("another value of number {number} makes a scene with {what}")]
    OtherSheet {
        /// The number.
        number: usize,
        /// What is different.
        what: &'static str,
    },
    /// A number is not finite, or has no step for differences.
    #[error("number {number} is {value}, and cannot be changed")]
    Number {
        /// The number.
        number: usize,
        /// Its value.
        value: f64,
    },
    /// A loss has derivatives of another length than the state.
    #[error(
        "the loss has {found} derivatives after step {step}, and the state {expected} coordinates"
    )]
    LossLength {
        /// Of the plan, 0 at the start.
        step: usize,
        /// How many there are.
        found: usize,
        /// Three for each vertex.
        expected: usize,
    },
    /// A part of a run that was made again from its checkpoint is another one.
    #[error(
        "the part of the run from step {number} on, made again from its checkpoint, is another one"
    )]
    NotRepeated {
        /// Of the plan, from 0.
        number: usize,
    },
    /// Whoever watches has ended the run or the way back.
    #[error("interrupted")]
    Interrupted,
    /// The value of a loss is not finite.
    #[error("the loss is {value} after step {step}", value = given(*value))]
    LossValue {
        /// Of the plan, 0 at the start.
        step: usize,
        /// The value.
        value: f64,
    },
    /// A derivative is not finite.
    #[error("a derivative by the state at t = {t} s is not finite", t = brief(*t))]
    NotFinite {
        /// Time, seconds.
        t: f64,
    },
}

impl Advice for AdjointError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Scene { .. } | Self::Number { .. } => {
                Some("give numbers near which scenes can be built")
            }
            Self::Start(error) => error.advice(),
            Self::Step { source, .. } | Self::Equations { source, .. } => source.advice(),
            Self::Method { .. } => Some("use BDF2, implicit Euler or a search for equilibria"),
            Self::NoDerivative { source, .. } => source.advice(),
            Self::Event { .. } => Some("take shorter steps, or pass it by (`Branches::PassBy`)"),
            Self::Unsolved { .. } | Self::Linalg { .. } => {
                Some("the state is near a branch, as flat rods are: end the run before it")
            }
            Self::OtherSheet { .. } => {
                Some("keep mesh and pinned vertices the same for all numbers")
            }
            Self::Interrupted => None,
            Self::LossValue { .. } => Some("look at the loss"),
            Self::LossLength { .. } => Some("give three derivatives for each vertex"),
            Self::NotRepeated { .. } => Some("build the same scene each time it is asked for"),
            Self::NotFinite { .. } => Some("look at the loss, and end the run before that time"),
        }
    }
}

/// As a clause that follows a time.
fn what_happened(event: StepEvent) -> &'static str {
    match event {
        StepEvent::Fallback => "the fallback of the step control took over, which is a branch",
        StepEvent::Restitution => {
            "bodies met, and their velocities were corrected, which is a branch"
        }
        _ => "something happened that has no derivative",
    }
}
