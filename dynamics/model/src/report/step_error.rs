//! Errors of steps.

use crate::report::contact_error::{BodyMotionError, FrictionError};
use crate::report::engine_error::EngineError;
use crate::report::infeasibility::Infeasibility;
use crate::report::no_equilibrium::NoEquilibrium;
use crate::report::potential_fault::BadPotential;
use crate::report::pressing::Pressing;
use crate::report::reason::Reason;
use crate::report::support::Support;
use isosheet_linalg::LinalgError;
use isosheet_materials::{LimitError, Refused};
use isosheet_mesh::wording::{brief, counted, given, listed};
use isosheet_mesh::{Advice, EdgeId, FaceId, VertexId};

/// Errors of a step; the state is that of the last accepted sub-step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The step size is not positive and finite.
    #[error("the step size is {h} s at t = {t} s", h = brief(*h), t = brief(*t))]
    StepSize {
        /// The step size given, seconds.
        h: f64,
        /// Time, seconds.
        t: f64,
    },
    /// The time of the state is not finite.
    #[error("the time of the state is {t} s", t = brief(*t))]
    Time {
        /// The time given, seconds.
        t: f64,
    },
    /// An energy or work is not finite.
    #[error("{quantity} is {value} J at t = {t} s", value = brief(*value), t = brief(*t))]
    NonFiniteEnergy {
        /// Which one.
        quantity: &'static str,
        /// Its value, joules.
        value: f64,
        /// Time, seconds.
        t: f64,
    },
    /// The projection onto the rest lengths did not converge.
    #[error(
        "no positions with the rest lengths were found near the ones given: the best have edge \
         strain {strain} after {iterations} iterations, {tolerance} was asked for",
        strain = brief(*strain), tolerance = given(*tolerance)
    )]
    Projection {
        /// Relative edge length error reached.
        strain: f64,
        /// The tolerance.
        tolerance: f64,
        /// Iterations done.
        iterations: usize,
    },
    /// A position or velocity is not finite.
    #[error(
        "{vertex} has position or velocity {value} at t = {t} s",
        value = brief(*value), t = brief(*t)
    )]
    NonFiniteState {
        /// The vertex.
        vertex: VertexId,
        /// The value found.
        value: f64,
        /// Time, seconds.
        t: f64,
    },
    /// A prescribed motion is not finite.
    #[error(
        "the prescribed motion of {support} gives {value} at t = {t} s",
        value = brief(*value), t = brief(*t)
    )]
    NonFiniteMotion {
        /// What moves.
        support: Support,
        /// A coordinate, metres.
        value: f64,
        /// Time, seconds.
        t: f64,
    },
    /// The prescribed motion of a body is not finite.
    #[error(transparent)]
    Body(#[from] BodyMotionError),
    /// A vertex of the start state is off its support.
    #[error(
        "{support} is {distance} m away from its vertex at t = {t} s",
        distance = brief(*distance), t = brief(*t)
    )]
    OffSupport {
        /// The support.
        support: Support,
        /// The distance, metres.
        distance: f64,
        /// Time, seconds.
        t: f64,
    },
    /// A potential or force is not finite.
    #[error(
        "a potential or force is {value} at {vertex}, t = {t} s",
        value = brief(*value), t = brief(*t)
    )]
    NonFiniteForce {
        /// The vertex.
        vertex: VertexId,
        /// The value found.
        value: f64,
        /// Time, seconds.
        t: f64,
    },
    /// An edge of the start state is off its rest length.
    #[error(
        "{edge} of {rest} m is {} at t = {t} s",
        off_by(length - rest), rest = brief(*rest), t = brief(*t)
    )]
    OffConstraints {
        /// The worst edge.
        edge: EdgeId,
        /// Its length, metres.
        length: f64,
        /// Its rest length, metres.
        rest: f64,
        /// Time, seconds.
        t: f64,
    },
    /// The start state exceeds the strain limit of the elastic sheet.
    #[error(
        "{face} has the strain {strain} at t = {t} s, and the limit of the elastic sheet is {limit}",
        strain = brief(*strain), limit = given(*limit), t = brief(*t)
    )]
    BeyondStrainLimit {
        /// The face with the largest strain.
        face: FaceId,
        /// The norm of its strain (`ElasticSheet`).
        strain: f64,
        /// The limit.
        limit: f64,
        /// Time, seconds.
        t: f64,
    },
    /// An elastic sheet is stretched to the limit of its strain, where the arithmetic ends.
    #[error(
        "no step was found at t = {t} s, where {face} of the elastic sheet has the strain {strain} of at most {limit}",
        strain = brief(*strain), limit = given(*limit), t = brief(*t)
    )]
    AtStrainLimit {
        /// The face with the largest strain.
        face: FaceId,
        /// The norm of its strain (`ElasticSheet`).
        strain: f64,
        /// The limit.
        limit: f64,
        /// Time, seconds.
        t: f64,
    },
    /// What is prescribed leaves no place within the limit of a potential.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// Newton's method did not converge.
    #[error(
        "Newton's method stopped at residual {residual}, edge strain {strain} after {iterations} \
         iterations at t = {t} s, h = {h} s: {reason}",
        residual = brief(*residual), strain = brief(*strain), t = brief(*t), h = brief(*h)
    )]
    NotConverged {
        /// Time at the start of the step, seconds.
        t: f64,
        /// Step size, seconds.
        h: f64,
        /// Iterations done.
        iterations: usize,
        /// Relative residual of the momentum balance.
        residual: f64,
        /// Relative edge length error reached.
        strain: f64,
        /// Why.
        reason: Reason,
    },
    /// Loads that follow the sheet do not come to rest in a step.
    #[error(
        "loads that follow the sheet have not settled in a step of {h} s at t = {t} s: they differ from those at its end \
         by the part {error} of the largest",
        h = brief(*h), t = brief(*t), error = brief(*error)
    )]
    UnsettledLoads {
        /// Time at the start of the step, seconds.
        t: f64,
        /// Step size, seconds.
        h: f64,
        /// The difference, as a part of the largest load.
        error: f64,
    },
    /// The search for an equilibrium cannot end, see [`NoEquilibrium`].
    #[error("there is no equilibrium at t = {t} s: {why}", t = brief(*t))]
    NoEquilibrium {
        /// Time, seconds.
        t: f64,
        /// Why.
        why: NoEquilibrium,
    },
    /// A [term](crate::term::Term) refuses a step for a reason of its own.
    #[error("{} refuses a step at t = {t} s: {}", .refused.by, .refused.why, t = brief(*t))]
    Refused {
        /// Time at the start of the step, seconds.
        t: f64,
        /// What refuses, and why.
        refused: Box<Refused>,
    },
    /// A force of velocities or positions is too stiff to be taken as it is expected at the end of a step.
    #[error(
        "a force of the sheet is too stiff for a step of {h} s at t = {t} s: its work in it is {misjudged} J off, and the \
         kinetic energy is {kinetic} J",
        h = brief(*h), t = brief(*t), misjudged = brief(*misjudged), kinetic = brief(*kinetic)
    )]
    StiffForce {
        /// Time at the start of the step, seconds.
        t: f64,
        /// Step size, seconds.
        h: f64,
        /// Work by which the forces that were expected of the end differ from those there, joules.
        misjudged: f64,
        /// Kinetic energy, joules.
        kinetic: f64,
    },
    /// A potential cannot be used.
    #[error("at t = {t} s {bad}", t = brief(*t))]
    Potential {
        /// Time, seconds.
        t: f64,
        /// Which one, and why.
        bad: Box<BadPotential>,
    },
    /// A law of friction from outside cannot be used.
    #[error("at t = {t} s {error}", t = brief(*t))]
    FrictionLaw {
        /// Time, seconds.
        t: f64,
        /// Which one, and why.
        error: Box<FrictionError>,
    },
    /// A step of a damped method gains energy.
    #[error(
        "a step of {h} s at t = {t} s would create {gain} J (kinetic energy {kinetic} J): rods in \
         compression snap through faster than the step resolves",
        h = brief(*h), t = brief(*t), gain = brief(*gain), kinetic = brief(*kinetic)
    )]
    EnergyGain {
        /// Time at the start of the step, seconds.
        t: f64,
        /// Step size, seconds.
        h: f64,
        /// Energy created, joules.
        gain: f64,
        /// Kinetic energy at the end of the step, joules.
        kinetic: f64,
    },
    /// The estimated error of a step is above the accuracy that was asked for. Shorter steps follow.
    #[error(
        "a step of {h} s at t = {t} s adds an estimated error of {error} m to the positions, {accuracy} m was \
         asked for",
        h = brief(*h), t = brief(*t), error = brief(*error), accuracy = given(*accuracy)
    )]
    Inaccurate {
        /// Time at the start of the step, seconds.
        t: f64,
        /// Step size, seconds.
        h: f64,
        /// The estimate, metres.
        error: f64,
        /// `StepControl::accuracy`, metres.
        accuracy: f64,
    },
    /// Friction in a step belongs to other normal forces than those at its end.
    #[error(
        "friction takes {lost} J in a step of {h} s at t = {t} s, and {settled} J by the normal forces at its \
         end: the two do not settle, as in a jam",
        h = brief(*h), t = brief(*t), lost = brief(*lost), settled = brief(*settled)
    )]
    Friction {
        /// Time at the start of the step, seconds.
        t: f64,
        /// Step size, seconds.
        h: f64,
        /// Energy lost to friction, joules.
        lost: f64,
        /// Energy that would be lost to friction by the normal forces at the end of the step, joules.
        settled: f64,
    },
    /// A step ends in contact.
    #[error(
        "a step of {h} s at t = {t} s would close the smallest gap to {gap} m",
        h = brief(*h), t = brief(*t), gap = brief(*gap)
    )]
    Contact {
        /// Time at the start of the step, seconds.
        t: f64,
        /// Step size, seconds.
        h: f64,
        /// The gap, metres.
        gap: f64,
    },
    /// The length constraints are linearly dependent, or nearly so.
    #[error(
        "the length constraints are dependent or nearly so at t = {t} s ({rank_deficiency} \
         redundant, smallest singular value of the rigidity matrix with unit rods \
         {smallest_singular_value}): this integrator has no unique rod forces there",
        t = brief(*t), smallest_singular_value = brief(*smallest_singular_value)
    )]
    RankDeficient {
        /// Time, seconds.
        t: f64,
        /// Number of dependent constraints.
        rank_deficiency: usize,
        /// Smallest singular value of the rigidity matrix of unit rods; zero if it has more rows than
        /// columns.
        smallest_singular_value: f64,
    },
    /// Moving supports or bodies ask for more than the lengths or the limit of the strain allow.
    #[error("{infeasibility} (the state at t = {t} s is kept)", t = brief(*t))]
    Unsatisfiable {
        /// Time of the last state, seconds.
        t: f64,
        /// What asks, for how much and when.
        infeasibility: Box<Infeasibility>,
    },
    /// The smallest sub-step was rejected.
    #[error(
        "no step of at least {min_step} s was accepted at t = {t} s{}; last reason: {cause}",
        pressing.as_ref().map(|pressing| format!(", where {pressing}")).unwrap_or_default(),
        min_step = brief(*min_step), t = brief(*t)
    )]
    StepTooSmall {
        /// Time, seconds.
        t: f64,
        /// Smallest step allowed, seconds.
        min_step: f64,
        /// The body that presses the sheet there, if one does.
        pressing: Option<Box<Pressing>>,
        /// Why the last step was rejected.
        cause: Box<StepError>,
    },
    /// The rods block the motion, or are dependent while supports and bodies rest.
    #[error(
        "the sheet locks at t = {t} s: no motion was found with {}, and the rods at {} depend on each other \
         (a sheet of rods folds along lines of edges only)",
        counted(*.factorisations, "factorisation", "factorisations"), listed(.vertices),
        t = brief(*t)
    )]
    Locked {
        /// Time of the last accepted sub-step, seconds.
        t: f64,
        /// Factorisations since then.
        factorisations: usize,
        /// Free vertices at the dependent rods.
        vertices: Vec<VertexId>,
    },
    /// The watch of `Simulation::step_watched` ended the step.
    #[error("the step was interrupted after t = {t} s", t = brief(*t))]
    Interrupted {
        /// Time of the last accepted sub-step, seconds.
        t: f64,
    },
    /// An engine from outside failed.
    #[error("at t = {t} s: {source}", t = brief(*t))]
    Engine {
        /// Time, seconds.
        t: f64,
        /// The reason.
        source: EngineError,
    },
    /// The linear algebra failed.
    #[error("linear solve failed at t = {t} s: {source}", t = brief(*t))]
    Linalg {
        /// Time, seconds.
        t: f64,
        /// The reason.
        source: LinalgError,
    },
}

impl Advice for StepError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::StepSize { .. } => Some("give a positive finite step"),
            Self::Time { .. } => Some("start at a finite time"),
            Self::NonFiniteEnergy { .. } => Some("check the user-supplied potentials and forces"),
            Self::Projection { .. } => {
                Some("start closer to the rest lengths or raise the tolerance")
            }
            Self::NonFiniteState { .. } => Some("set finite positions and velocities"),
            Self::NonFiniteMotion { .. } => Some("check the function"),
            Self::Body(error) => error.advice(),
            Self::OffSupport { .. } => Some("start with the vertex in place"),
            Self::NonFiniteForce { .. } => Some("check the user-supplied functions"),
            Self::OffConstraints { .. } => {
                Some("start from a state on the constraints (see `project_positions`)")
            }
            Self::BeyondStrainLimit { .. } => {
                Some("start from a shape that is stretched less, or raise the limit of the strain")
            }
            Self::AtStrainLimit { .. } => Some(
                "pull less, hold more than a vertex where it is pulled, or raise the limit of the strain",
            ),
            Self::Limit(error) => error.advice(),
            Self::NotConverged { .. }
            | Self::UnsettledLoads { .. }
            | Self::EnergyGain { .. }
            | Self::Inaccurate { .. }
            | Self::Friction { .. }
            | Self::Contact { .. } => Some("take a smaller step"),
            Self::NoEquilibrium { why, .. } => Some(why.advice()),
            Self::Refused { refused, .. } => refused.remedy,
            Self::Potential { bad, .. } => bad.advice(),
            Self::FrictionLaw { error, .. } => error.advice(),
            Self::StiffForce { .. } => Some(
                "take a smaller step, or make it an `ImplicitForce`, which is part of the search",
            ),
            Self::RankDeficient { .. } => Some(
                "start from a folded state, displace the sheet with `leave_flat`, allow a `Fallback`, or use \
                 BDF2",
            ),
            Self::Unsatisfiable { .. } => {
                Some("stop the motion before that, or allow `Unsatisfiable::StopTaut`")
            }
            Self::StepTooSmall { cause, .. } => cause.advice(),
            Self::Locked { .. } => Some(
                "give the sheet the stiffness of its material (`SheetModel::with_elastic_sheet`), make a mesh \
                 with a line of edges along each clamp, or allow more \
                 `StepControl::max_factorisations`",
            ),
            Self::Interrupted { .. } => {
                Some("the last accepted part of the step is kept: step on from there")
            }
            Self::Engine { source, .. } => source.advice(),
            Self::Linalg { .. } => None,
        }
    }
}

/// By how much a length is off, in words.
fn off_by(by: f64) -> String {
    let side = if by < 0.0 { "short" } else { "long" };
    format!("{} m too {side}", brief(by.abs()))
}
