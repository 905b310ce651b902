//! Why mechanics in a chart fails.

use isosheet_coords::ChartError;
use isosheet_dynamics::{CheckpointError, Support};
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, VertexId};
use thiserror::Error;

/// Why a step in a chart is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ChartDynamicsError {
    /// A checkpoint does not fit.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The chart is not usable at this state.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// An option is out of range.
    #[error("{option} is {value}", value = given(*value))]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What to give instead.
        remedy: &'static str,
    },
    /// The method and the other options do not go together.
    #[error("{method} needs {needs}")]
    Combination {
        /// The method.
        method: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// Too many coordinates for Cramer's rule.
    #[error(
        "{dimension} coordinates are too many for Cramer's rule, whose cost grows with the fifth \
         power (the limit is {limit})"
    )]
    TooManyCoordinates {
        /// Number of coordinates.
        dimension: usize,
        /// The limit.
        limit: usize,
    },
    /// The dense mass matrix is singular to working precision.
    #[error(
        "the {dimension} x {dimension} mass matrix of the chart is singular to working precision"
    )]
    SingularMass {
        /// Number of coordinates.
        dimension: usize,
    },
    /// The position given at the start has the wrong lengths.
    #[error(
        "the largest edge strain of the initial state is {strain}, above {limit}",
        strain = brief(*strain), limit = given(*limit)
    )]
    Strained {
        /// Largest strain.
        strain: f64,
        /// The limit.
        limit: f64,
    },
    /// A slice has the wrong length.
    #[error("{what} has {found} values, expected {expected}")]
    WrongLength {
        /// Which argument.
        what: &'static str,
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
    },
    /// The chart pins a vertex that the model leaves free.
    #[error(
        "the chart was built for other pins than the model's: {vertex} is pinned in the chart and \
         free in the model"
    )]
    OtherPins {
        /// The first such vertex.
        vertex: VertexId,
    },
    /// The chart pins a vertex that the model moves.
    #[error("the chart pins {vertex} where it is, and the model moves it")]
    MovingPin {
        /// The vertex.
        vertex: VertexId,
    },
    /// The sheet is elastic.
    #[error("the sheet has no rigid rods (it is elastic), and charts need them")]
    Elastic,
    /// The sheet yields.
    #[error(
        "the sheet yields (its bends or creases stay), and the equations in a chart have no place for that"
    )]
    Plastic,
    /// A force of the sheet acts in steps that minimise alone, such as that of attached flow.
    #[error("a force of the sheet acts in steps that minimise alone, and a chart has none")]
    NeedsMinimising,
    /// Sheets have different rates of the velocity damping, and momenta of a chart belong to all of them.
    #[error("a chart damps all sheets alike, and these have different rates of damping")]
    Damping,
    /// A one-sided constraint makes no closure equation.
    #[error("vertex constraint {index} is one-sided, and a chart takes two-sided constraints only")]
    OneSided {
        /// Place in the order in which the constraints were added.
        index: usize,
    },
    /// Closure equations cannot be met.
    #[error(
        "at t = {t} s {support} is {distance} m off: the {equations} closure equations, of rank \
         {rank}, cannot be met together with the edge lengths",
        t = brief(*t), distance = brief(*distance)
    )]
    Closure {
        /// Time, seconds.
        t: f64,
        /// The support that is furthest off, relative to the shortest rod at its vertex.
        support: Support,
        /// By how much, metres.
        distance: f64,
        /// Independent closure equations where the search ended.
        rank: usize,
        /// Closure equations.
        equations: usize,
    },
    /// One call of [`Simulation::step`](isosheet_dynamics::Simulation::step) takes too long.
    #[error(
        "{limit} steps, with those rejected, went no further than t = {t} s (near a singularity of \
         the chart a step control crawls)",
        t = brief(*t)
    )]
    TooManySteps {
        /// Time reached, seconds.
        t: f64,
        /// The limit.
        limit: usize,
    },
    /// The step control went below its smallest step.
    #[error(
        "at t = {t} s no step above {minimum} s keeps the change of the energy below {tolerance} J (it is {change} J): {cause}",
        t = brief(*t),
        minimum = brief(*minimum),
        tolerance = given(*tolerance),
        change = brief(*change)
    )]
    StepTooSmall {
        /// Time, seconds.
        t: f64,
        /// Smallest step allowed, seconds.
        minimum: f64,
        /// Bound on the change of the Hamiltonian, joules.
        tolerance: f64,
        /// Change at the last attempt, joules; NaN when the step itself failed.
        change: f64,
        /// What went wrong in the last attempt.
        cause: String,
    },
    /// The edge lengths have drifted too far.
    #[error(
        "at t = {t} s the largest edge strain is {strain}, above {limit}: the scheme has diverged",
        t = brief(*t), strain = brief(*strain), limit = given(*limit)
    )]
    Diverged {
        /// Time, seconds.
        t: f64,
        /// Largest strain.
        strain: f64,
        /// The limit.
        limit: f64,
    },
    /// A prescribed motion of a support is not finite.
    #[error(
        "the prescribed motion of {support} gives {value} at t = {t} s",
        value = brief(*value), t = brief(*t)
    )]
    Motion {
        /// What moves.
        support: Support,
        /// The component that is not finite.
        value: f64,
        /// Time, seconds.
        t: f64,
    },
    /// A state is not finite.
    #[error(
        "the state is not finite at t = {t} s: the step is too large for this scheme",
        t = brief(*t)
    )]
    NotFinite {
        /// Time, seconds.
        t: f64,
    },
}

impl Advice for ChartDynamicsError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Checkpoint(error) => error.advice(),
            Self::Chart(error) => error.advice(),
            Self::Option { remedy, .. } => Some(remedy),
            Self::TooManyCoordinates { .. } => Some("use another solver"),
            Self::SingularMass { .. } => Some("use the saddle-point solver or another chart"),
            Self::Strained { .. } => Some("start from a state with the rest lengths"),
            Self::OtherPins { .. } => {
                Some("build the chart with some or all of the pins of the model")
            }
            Self::MovingPin { .. } => Some("build the chart with that vertex free"),
            Self::Elastic | Self::Plastic | Self::NeedsMinimising => {
                Some("use BDF2 or implicit Euler without a chart")
            }
            Self::Damping => {
                Some("give all sheets the same rate, or use BDF2 or implicit Euler without a chart")
            }
            Self::OneSided { .. } => {
                Some("use contact with a body, or a damped method without a chart")
            }
            Self::Closure { .. } => {
                Some("start closer to them, remove or move one, or take a smaller step")
            }
            Self::NotFinite { .. } => Some("take smaller steps"),
            Self::TooManySteps { .. } => Some(
                "ask for less time at once, take longer steps, loosen the tolerance or use a method without \
                 a chart",
            ),
            Self::StepTooSmall { .. } => Some(
                "loosen the tolerance, stay away from singularities of the chart, or use a method without a \
                 chart",
            ),
            Self::Diverged { .. } => {
                Some("take smaller steps, exact positions or other equations of motion")
            }
            Self::Motion { .. } => Some("check the function"),
            Self::Combination { .. } | Self::WrongLength { .. } => None,
        }
    }
}

impl From<isosheet_coords::linalg::LinalgError> for ChartDynamicsError {
    fn from(error: isosheet_coords::linalg::LinalgError) -> Self {
        Self::Chart(error.into())
    }
}
