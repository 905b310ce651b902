//! Accepted sub-steps of the damped methods, as whoever differentiates a run sees them.

use crate::State;
use isosheet_materials::potential::Memories;
use nalgebra::Vector3;

/// An accepted sub-step of BDF2 or implicit Euler, or a step of a search for an equilibrium: what it started
/// from, and what it found.
///
/// With `y = x0 + b (x0 - x_)` and the prediction `x^` of inertia it solves
///
/// ```text
/// M (x1 - x^) + h^2 sum_k dT_k/dx (x1) + G(x1)^T L = 0,   c(x1) = 0,   v1 = (x1 - y) / h;
/// ```
///
/// a step of a search starts and ends at rest, with `x^ = x0`.
#[derive(Debug, Clone)]
pub struct AcceptedStep {
    /// Whether it is a part of a motion.
    pub kind: StepKind,
    /// The state at its start.
    pub start: State,
    /// The state before that, to which the formula reaches back, with the velocities that it took.
    pub before: Option<State>,
    /// The state at its end.
    pub end: State,
    /// Its length, seconds.
    pub span: f64,
    /// Time in which surfaces slide as far as they do in it, seconds.
    pub sliding_time: f64,
    /// Its effective length `h`, seconds.
    pub h: f64,
    /// `b`.
    pub back: f64,
    /// What the potentials remembered in it.
    pub memories: Memories,
    /// `L` of the rods: `h^2` times force densities, tension positive.
    pub rods: Vec<f64>,
    /// `L` of the vertex constraints, kilogram metres.
    pub constraints: Vec<Vector3<f64>>,
    /// The positions of all vertices (`3V`, metres) at which friction was lagged anew, in order; none where
    /// it was lagged at the start alone.
    pub lags: Vec<Vec<f64>>,
    /// What happened that has no derivative.
    pub events: Vec<StepEvent>,
}

/// What an accepted sub-step belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepKind {
    /// A motion.
    Motion,
    /// A search for an equilibrium, whose steps all end at the time of the equilibrium.
    Search,
}

/// What happened in a sub-step that has no derivative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum StepEvent {
    /// The fallback of the step control took it.
    Fallback,
    /// The velocities of rigid bodies were corrected so that their contact makes no energy.
    Restitution,
}

/// What a sub-step was solved from, besides what the motions at its ends say.
#[derive(Debug, Clone)]
pub(crate) struct Taken {
    pub(crate) before: Option<State>,
    pub(crate) span: f64,
    pub(crate) h: f64,
    pub(crate) back: f64,
    pub(crate) lags: Vec<Vec<f64>>,
    pub(crate) events: Vec<StepEvent>,
}

/// Whether accepted sub-steps are handed out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Recording {
    On,
    Off,
}

/// Derivatives of a number by the places that a step starts from: `y`, `x^`, and where the velocities at the
/// start lead; `3V` each.
#[derive(Debug, Clone, Default)]
pub(crate) struct OfPlaces {
    pub(crate) rest: Vec<f64>,
    pub(crate) prediction: Vec<f64>,
    pub(crate) ahead: Vec<f64>,
}

/// Derivatives of a number by positions and velocities of a state, `3V` each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OfState {
    /// By the positions, per metre.
    pub x: Vec<f64>,
    /// By the velocities, seconds per metre.
    pub v: Vec<f64>,
}

impl OfState {
    /// Zeros for so many coordinates.
    pub fn zeros(n: usize) -> Self {
        Self {
            x: vec![0.0; n],
            v: vec![0.0; n],
        }
    }
}
