//! The phases of a minimisation, as a table.

use super::problem::StepProblem;
use crate::step::integrator::Phases;
use crate::step::tuning::Tuning;
use crate::{ImplicitOptions, SheetModel};
use isosheet_mesh::area_from_lengths;
use isosheet_model::term::Lagging;

/// What the slimmest face of a sheet allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Faces {
    /// Any phase first.
    Compact,
    /// The phase that is exact in the altitudes of slivers first. (With SQP first a triangle a million times
    /// longer than wide errs by 4 % of its swing.)
    Slivers,
}

impl Faces {
    pub(super) fn of(model: &SheetModel, tuning: &Tuning) -> Self {
        let lengths = model.edges().lengths();
        let is_sliver = |f| {
            let sides = model.topology().face_edges(f).map(|e| lengths[e.index()]);
            let longest = sides.iter().fold(0.0, |longest, side| side.max(longest));
            // (Rounded lengths of a sliver may make no triangle; its area is zero.)
            2.0 * area_from_lengths(sides) < tuning.sliver() * longest * longest
        };
        match model.topology().face_ids().any(is_sliver) {
            true => Self::Slivers,
            false => Self::Compact,
        }
    }
}

/// Where a phase starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StartingPoint {
    /// At the positions at the start of the step; without contact, where supports have moved on, at the
    /// prediction if its merit is lower.
    Lower,
    /// Where inertia alone would take the sheet, unless contact or the limit of the strain is in the way.
    Prediction,
}

/// Where the multipliers of the rods come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MultiplierUpdate {
    /// Each iteration solves for them together with the search direction (sequential quadratic programming).
    Solved,
    /// Each round adds the penalty times the length errors (augmented Lagrangian).
    Rounds,
}

/// How an iteration leaves a saddle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Saddle {
    /// Along a direction of negative curvature, if that lowers the merit function.
    Curvature,
    /// By a random displacement: for sheets that may be exactly flat, where one direction is not enough.
    Perturbation,
    /// Not at all.
    Ignored,
}

/// A phase: a row of the table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Phase {
    /// Its name in a trace.
    pub(super) name: &'static str,
    pub(super) start: StartingPoint,
    pub(super) multipliers: MultiplierUpdate,
    /// Whether it begins with the multipliers of the step before.
    pub(super) remembers: bool,
    /// Largest strain of iterates, above which their lengths are restored; infinite where they are left.
    pub(super) iterate_strain: f64,
    /// Penalty of the rods in the merit function, relative to the masses; of the first round.
    pub(super) merit_penalty: f64,
    /// Iterations until the next round, continuation or failure.
    pub(super) iterations: usize,
    /// Largest number of iterations in all.
    pub(super) all_iterations: usize,
    /// Largest number of halvings of a search direction; the last phases end at round-off.
    pub(super) halvings: usize,
    /// Rounds of the method of multipliers.
    pub(super) rounds: usize,
    /// Whether the Hessian stays semidefinite once it was indefinite, instead of being tried whole in every
    /// iteration. (What makes it indefinite rarely ends within a step, but in rounds the multipliers of rods
    /// do change it: with this, strips that jam and blanks that are stamped take 1.3 and 1.7 times the
    /// factorisations.)
    pub(super) stays_semidefinite: bool,
    /// Strain from which the restoration at the end is a small displacement.
    pub(super) small_strain: f64,
    /// Largest number of iterations of a restoration.
    pub(super) restorations: usize,
    /// When friction and loads have settled.
    pub(super) lagging: Lagging,
    pub(super) friction_updates: usize,
    pub(super) saddle: Saddle,
}

/// Most iterations of a phase in a step of a search for an equilibrium.
const SEARCH_ITERATIONS: usize = 30;

impl Phase {
    /// The phases of a problem, in the order in which they are tried until one ends at a minimum.
    ///
    /// | phase | start | multipliers | iterates | rounds |
    /// |---|---|---|---|---|
    /// | SQP | start of the step | of the step before (in contact none); solved for | near the lengths | 1 |
    /// | augmented Lagrangian | prediction | none; by rounds | free | many loose ones in contact |
    ///
    /// Elastic sheets alone have no rods to solve for, and pins that move in contact stall SQP: both have the
    /// second row alone. Without rods the multipliers of curves and surfaces are solved for there too, as in
    /// the first one. Slivers begin with it without contact, with its own multipliers of the step before.
    ///
    /// A whole step of rods among bodies and supports at rest is divided early where both fail: sheets that
    /// buckle, or touch while they are exactly flat, take fewer iterations in its parts. In contact the
    /// second row has the iterations of the first one (sheets of 289 vertices that fall onto a table take
    /// 2000 to 3000 factorisations in half a second, and 3000 to 12 000 where whole steps go on); without
    /// contact it has the restorations of the first one (a sheet of 4225 vertices that hangs for a second
    /// takes 1535 factorisations instead of 2375).
    pub(super) fn table(
        problem: &StepProblem<'_>,
        faces: Faces,
        options: &ImplicitOptions,
        tuning: &Tuning,
    ) -> [Option<Self>; 2] {
        let model = problem.model;
        let has_contact = problem.has_contact();
        let search = ImplicitOptions {
            max_iterations: options.max_iterations.min(SEARCH_ITERATIONS),
            ..options.clone()
        };
        let options = match problem.phases {
            Phases::Search => &search,
            Phases::Brief | Phases::All => options,
        };
        let sqp = Self::sqp(problem, options, tuning);
        let rounds = Self::rounds(problem, options, tuning);
        if model.rods().is_empty() {
            // What remains are the forces of supports, which each iteration solves for.
            let multipliers = match model.constraints().is_empty() {
                true => MultiplierUpdate::Rounds,
                false => MultiplierUpdate::Solved,
            };
            [
                None,
                Some(Self {
                    multipliers,
                    ..rounds
                }),
            ]
        } else if problem.is_bounded() && model.has_drives() {
            [None, Some(rounds)]
        } else if faces == Faces::Slivers && !has_contact {
            // The multipliers of rounds are a start for rounds; the phase that comes first looks for saddles.
            let remembers = true;
            let saddle = Saddle::Ignored;
            [
                Some(Self {
                    remembers,
                    ..rounds
                }),
                Some(Self { saddle, ..sqp }),
            ]
        } else if problem.phases == Phases::Brief {
            let brief = match has_contact {
                true => Self {
                    all_iterations: sqp.iterations,
                    ..rounds
                },
                false => Self {
                    restorations: sqp.restorations,
                    ..rounds
                },
            };
            [Some(sqp), Some(brief)]
        } else {
            [Some(sqp), Some(rounds)]
        }
    }

    fn sqp(problem: &StepProblem<'_>, options: &ImplicitOptions, tuning: &Tuning) -> Self {
        let has_contact = problem.has_contact();
        let share = (options.max_iterations / tuning.iteration_share as usize).max(1);
        // In contact the Lagrangian alone is the merit function: augmented it may grow along a step that
        // mends lengths against the barrier. And the multipliers of nearly dependent rods are arbitrary from
        // step to step.
        Self {
            name: "SQP",
            start: StartingPoint::Lower,
            multipliers: MultiplierUpdate::Solved,
            remembers: !has_contact,
            iterate_strain: tuning.iterate_strain,
            merit_penalty: match has_contact {
                true => 0.0,
                false => options.stiffness,
            },
            iterations: match has_contact {
                true => share,
                false => options.max_iterations,
            },
            restorations: share,
            all_iterations: usize::MAX,
            halvings: tuning.repetitions as usize,
            rounds: 1,
            stays_semidefinite: true,
            small_strain: match has_contact {
                // Iterates are exact enough.
                true => f64::INFINITY,
                false => tuning.small_strain,
            },
            lagging: Lagging {
                friction: options.friction_tolerance,
                loads: options.friction_tolerance,
            },
            friction_updates: options.max_friction_updates,
            saddle: match has_contact {
                true => Saddle::Ignored,
                false => Saddle::Curvature,
            },
        }
    }

    fn rounds(problem: &StepProblem<'_>, options: &ImplicitOptions, tuning: &Tuning) -> Self {
        let has_contact = problem.has_contact();
        // The multipliers of SQP grow without bound where rods are nearly dependent, and are no start here.
        Self {
            name: "augmented Lagrangian",
            start: StartingPoint::Prediction,
            multipliers: MultiplierUpdate::Rounds,
            remembers: false,
            iterate_strain: f64::INFINITY,
            merit_penalty: options.stiffness,
            iterations: options.max_iterations,
            restorations: options.max_projections,
            all_iterations: usize::MAX,
            halvings: f64::MANTISSA_DIGITS as usize,
            rounds: match has_contact {
                true => options.max_iterations,
                false => 1,
            },
            stays_semidefinite: problem.model.elastic_sheet().is_some(),
            small_strain: match has_contact {
                true => tuning.small_strain,
                false => f64::INFINITY,
            },
            lagging: Lagging {
                friction: options.friction_tolerance.max(tuning.friction_settled),
                loads: options.friction_tolerance,
            },
            friction_updates: options.max_friction_updates,
            saddle: Saddle::Perturbation,
        }
    }
}
