//! The phases of a minimisation, as a table.

use super::problem::StepProblem;
use crate::{ImplicitOptions, Isometry, SheetModel};
use isosheet_mesh::area_from_lengths;

/// Part of [`ImplicitOptions::max_iterations`] that is the largest number of iterations of programming in
/// contact, 20 by default: a draping sheet needs three to six, a sheet at rest two to six, an impact more where
/// contact cuts them. (Otherwise all iterations may be used: a hanging sheet of 2000 triangles needs up to 50 at
/// 60 steps a second.)
const PART_IN_CONTACT: usize = 4;
/// Edge strain that iterates may have. Hanging sheets of 289 vertices need 9.2, 9.3, 10.0 and 9.7
/// factorisations a step (means of 24 starts) with 0.01, 0.03, 0.1 and 0.3; of sheets of 2048 and 8192
/// triangles some starts need several times as many with 0.03 and more.
const ITERATE_STRAIN: f64 = 1e-2;
/// The same in contact, which cuts the long first iterations that would go far: a disk of 688 vertices on a
/// ball needs 18.3 factorisations a step, 19.5 with 0.03 and 21.4 with 0.01.
const ITERATE_STRAIN_IN_CONTACT: f64 = 1e-1;
/// Largest number of step halvings in contact; after these the next phase begins. Two, four and six make
/// 13 000, 10 500 and 10 600 factorisations of eight tablecloths.
const MAX_HALVINGS_IN_CONTACT: usize = 4;
/// Largest number of step halvings without contact, where the next phase takes longer. With two, a third of the
/// steps of a hanging sheet of 2000 triangles uses it; with 30, a thousand steps a second need half as many
/// factorisations more.
const MAX_HALVINGS: usize = 8;
/// Halvings of the augmented Lagrangian, which is the last resort: a part of 1e-9.
const MAX_HALVINGS_AT_LAST: usize = 30;
/// Largest number of rounds of the method of multipliers in contact. A sheet that lies flat resists a
/// restoration of its lengths: it would have to fold against the barrier, by the root of the length error.
/// Multipliers take the load instead, and each round shrinks the error by the penalty.
const MAX_ROUNDS_IN_CONTACT: usize = 12;
/// Tolerance of the rounds after the first where they are loose: they only shift load from the penalty to the
/// multipliers.
const LOOSE_TOLERANCE: f64 = 1e-2;
/// Edge strain from which the restoration at the end is a small displacement.
const SMALL_STRAIN: f64 = 1e-5;
/// Largest number of iterations of the restoration that ends programming. Where they do not suffice, programming
/// goes on from there. With 10, 20 and 40 hanging sheets of 2048 triangles need 16 600, 13 100 and 14 300
/// factorisations.
const MAX_LAST_RESTORATION: usize = 20;
/// Relative change of friction's normal forces below which they count as settled in a round, and largest number
/// of renewals in a round. With the tolerance of programming, 1e-3, and five renewals a disk of 688 vertices on a
/// ball needs 16.7 factorisations a step, and 12.5 with these.
const FRICTION_SETTLED: f64 = 0.05;
const MAX_FRICTION_UPDATES: usize = 2;
/// Altitude of a face, in parts of its longest side, from which rods 1e10 times as stiff as the masses hold
/// the face: a length error `d` of the long sides moves the apex of a face of altitude `a l` by `d l / a`, so
/// that slimmer faces need less than the 1e-10 that such rods let through for an error of 1e-4 in the
/// altitude.
const SLIVER: f64 = 1e-3;

/// What the slimmest face of a sheet allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Faces {
    /// Any phase first.
    Compact,
    /// Phases that are exact in the altitudes of slivers first.
    Slivers,
}

impl Faces {
    pub(super) fn of(model: &SheetModel) -> Self {
        let lengths = model.rods().lengths();
        let is_sliver = |f| {
            let sides = model.topology().face_edges(f).map(|e| lengths[e.index()]);
            let longest = sides.iter().fold(0.0, |longest, side| side.max(longest));
            // (Rounded lengths of a sliver may make no triangle; its area is zero.)
            2.0 * area_from_lengths(sides) < SLIVER * longest * longest
        };
        if model.topology().face_ids().any(is_sliver) {
            Self::Slivers
        } else {
            Self::Compact
        }
    }
}

/// Where a phase starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// At the positions at the start of the step; without contact, where supports have moved on, at the prediction
    /// if its merit is lower.
    Lower,
    /// Where inertia alone would take the sheet, unless contact or the limit of the strain is in the way.
    Prediction,
    /// At the positions at the start of the step.
    Beginning,
}

/// Where the multipliers of the rods come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Multipliers {
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
    pub(super) start: Start,
    pub(super) multipliers: Multipliers,
    /// Whether it begins with the multipliers of the step before.
    pub(super) remembers: bool,
    /// Largest strain of iterates, above which their lengths are restored; infinite where they are left.
    pub(super) iterate_strain: f64,
    /// Penalty of the rods in the merit function, relative to the masses; of the first round.
    pub(super) merit_penalty: f64,
    /// Iterations until the next round, continuation or failure.
    pub(super) iterations: usize,
    pub(super) halvings: usize,
    /// Rounds of the method of multipliers.
    pub(super) rounds: usize,
    /// Tolerance of the rounds after the first.
    pub(super) round_tolerance: f64,
    /// Strain from which the restoration at the end is a small displacement.
    pub(super) small_strain: f64,
    /// Largest number of iterations of this restoration.
    pub(super) last_restoration: usize,
    pub(super) friction_tolerance: f64,
    pub(super) friction_updates: usize,
    pub(super) saddle: Saddle,
}

impl Phase {
    /// The phases of a problem, in the order in which they are tried until one ends at a minimum.
    ///
    /// | phase | start | multipliers | iterates | rounds |
    /// |---|---|---|---|---|
    /// | programming | start of the step | of the step before (in contact none); solved for | near the lengths | 1 |
    /// | prediction | prediction | none; by rounds | free | 12 loose ones in contact |
    /// | exact rounds | start of the step | none; by rounds | free | 12 exact ones in contact |
    ///
    /// Elastic sheets have no rods to solve for, and pins that move in contact stall programming: both begin with the
    /// second row. Slivers begin with it without contact, with its own multipliers of the step before. At rest and
    /// without contact the last row would repeat the second one.
    pub(super) fn table(
        problem: &StepProblem<'_>,
        faces: Faces,
        options: &ImplicitOptions,
    ) -> [Option<Self>; 3] {
        let model = problem.model;
        let has_slivers = faces == Faces::Slivers;
        let is_rods = model.isometry() == Isometry::Rods;
        let has_contact = problem.has_contact();
        let programming = Self::programming(problem, options);
        let prediction = Self::rounds(problem, faces, options);
        let exact = prediction.exact(options);
        let repeats = !has_slivers && !has_contact && problem.prediction == problem.state.x;
        let last = (!repeats).then_some(exact);
        if !is_rods || has_contact && model.has_drives() {
            [None, Some(prediction), last]
        } else if has_slivers && !has_contact {
            // The phase that comes first looks for saddles: others start off them.
            let saddle = Saddle::Ignored;
            let programming = Self {
                saddle,
                ..programming
            };
            [Some(prediction), Some(programming), last]
        } else {
            [Some(programming), Some(prediction), last]
        }
    }

    fn programming(problem: &StepProblem<'_>, options: &ImplicitOptions) -> Self {
        let has_contact = problem.has_contact();
        // In contact the Lagrangian alone is the merit function: augmented it may grow along a step that mends
        // lengths against the barrier. And the multipliers of nearly dependent rods are arbitrary from step to
        // step.
        Self {
            name: "programming",
            start: Start::Lower,
            multipliers: Multipliers::Solved,
            remembers: !has_contact,
            iterate_strain: match has_contact {
                true => ITERATE_STRAIN_IN_CONTACT,
                false => ITERATE_STRAIN,
            },
            merit_penalty: match has_contact {
                true => 0.0,
                false => options.stiffness,
            },
            iterations: match has_contact {
                true => (options.max_iterations / PART_IN_CONTACT).max(1),
                false => options.max_iterations,
            },
            halvings: match has_contact {
                true => MAX_HALVINGS_IN_CONTACT,
                false => MAX_HALVINGS,
            },
            rounds: 1,
            round_tolerance: options.tolerance,
            small_strain: match has_contact {
                // Iterates are exact enough.
                true => f64::INFINITY,
                false => SMALL_STRAIN,
            },
            last_restoration: MAX_LAST_RESTORATION,
            friction_tolerance: options.friction_tolerance,
            friction_updates: options.max_friction_updates,
            saddle: match has_contact {
                true => Saddle::Ignored,
                false => Saddle::Curvature,
            },
        }
    }

    fn rounds(problem: &StepProblem<'_>, faces: Faces, options: &ImplicitOptions) -> Self {
        let has_contact = problem.has_contact();
        // The multipliers of programming grow without bound where rods are nearly dependent, and are no start
        // here; those of this phase, which slivers begin with, are.
        Self {
            name: "prediction",
            start: Start::Prediction,
            multipliers: Multipliers::Rounds,
            remembers: faces == Faces::Slivers,
            iterate_strain: f64::INFINITY,
            merit_penalty: options.stiffness,
            iterations: options.max_iterations,
            halvings: MAX_HALVINGS_AT_LAST,
            rounds: match has_contact {
                true => MAX_ROUNDS_IN_CONTACT,
                false => 1,
            },
            round_tolerance: options.tolerance.max(LOOSE_TOLERANCE),
            small_strain: match has_contact {
                true => SMALL_STRAIN,
                false => f64::INFINITY,
            },
            last_restoration: options.max_projections,
            friction_tolerance: options.friction_tolerance.max(FRICTION_SETTLED),
            friction_updates: options.max_friction_updates.min(MAX_FRICTION_UPDATES),
            saddle: Saddle::Perturbation,
        }
    }

    /// All rounds solved exactly, leaving nothing to the restoration: for nearly flat sheets, which fold by the root
    /// of their length error.
    fn exact(self, options: &ImplicitOptions) -> Self {
        Self {
            name: "exact rounds",
            start: Start::Beginning,
            remembers: false,
            round_tolerance: options.tolerance,
            small_strain: self.small_strain.min(options.strain_tolerance),
            ..self
        }
    }
}
