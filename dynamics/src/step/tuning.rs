//! The constants of a step of the damped methods.

use serde::Serialize;

macro_rules! tuning {
    ($( $(#[doc = $doc:literal])+ $name:ident = $value:literal, )+) => {
        /// The constants of a step of the damped methods. Not an option: they are named in one place so that a report
        /// can change them one at a time (`cargo xtask tuning`), and written at the head of a trace.
        #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
        pub struct Tuning {
            $( $(#[doc = $doc])+ pub $name: f64, )+
        }

        impl Default for Tuning {
            fn default() -> Self {
                Self { $( $name: $value, )+ }
            }
        }

        impl Tuning {
            /// All constants.
            pub const TABLE: &'static [Constant] = &[ $(
                Constant {
                    name: stringify!($name),
                    value: $value,
                    reason: concat!($($doc),+),
                    place: |tuning| &mut tuning.$name,
                },
            )+ ];
        }
    };
}

/// A constant of [`Tuning`].
#[derive(Debug, Clone, Copy)]
pub struct Constant {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What it is, in which unit, and why it has this value.
    pub reason: &'static str,
    /// Where it is.
    pub place: fn(&mut Tuning) -> &mut f64,
}

tuning! {
    /// Part of `ImplicitOptions::max_iterations` that is the largest number of iterations of programming in
    /// contact, 20 by default: a draping sheet needs three to six, a sheet at rest two to six, an impact more
    /// where contact cuts them. (Otherwise all iterations may be used: a hanging sheet of 2000 triangles
    /// needs up to 50 at 60 steps a second.)
    contact_iteration_share = 4.0,
    /// Edge strain that iterates may have. Hanging sheets of 289 vertices need 9.2, 9.3, 10.0 and 9.7
    /// factorisations a step (means of 24 starts) with 0.01, 0.03, 0.1 and 0.3; of sheets of 2048 and 8192
    /// triangles some starts need several times as many with 0.03 and more.
    iterate_strain = 1e-2,
    /// The same in contact, which cuts the long first iterations that would go far: a disk of 688 vertices on
    /// a ball needs 18.3 factorisations a step, 19.5 with 0.03 and 21.4 with 0.01.
    iterate_strain_in_contact = 1e-1,
    /// Largest number of step halvings in contact; after these the next phase begins. Two, four and six make
    /// 13 000, 10 500 and 10 600 factorisations of eight tablecloths.
    halvings_in_contact = 4.0,
    /// Largest number of step halvings without contact, where the next phase takes longer. With two, a third
    /// of the steps of a hanging sheet of 2000 triangles uses it; with 30, a thousand steps a second need
    /// half as many factorisations more.
    halvings = 8.0,
    /// Halvings of the augmented Lagrangian, which is the last resort: a part of 1e-9.
    halvings_at_last = 30.0,
    /// Largest number of rounds of the method of multipliers in contact. A sheet that lies flat resists a
    /// restoration of its lengths: it would have to fold against the barrier, by the root of the length
    /// error. Multipliers take the load instead, and each round shrinks the error by the penalty.
    rounds_in_contact = 12.0,
    /// Tolerance of the rounds after the first where they are loose: they only shift load from the penalty to
    /// the multipliers.
    loose_tolerance = 1e-2,
    /// Edge strain from which the restoration at the end is a small displacement.
    small_strain = 1e-5,
    /// Largest number of iterations of the restoration that ends programming. Where they do not suffice,
    /// programming goes on from there. With 10, 20 and 40 hanging sheets of 2048 triangles need 16 600, 13
    /// 100 and 14 300 factorisations.
    last_restoration = 20.0,
    /// Relative change of friction's normal forces below which they count as settled in a round, and largest
    /// number of renewals in a round. With the tolerance of programming, 1e-3, and five renewals a disk of
    /// 688 vertices on a ball needs 16.7 factorisations a step, and 12.5 with these.
    friction_settled = 0.05,
    /// Largest number of renewals of friction in a round.
    friction_updates = 2.0,
    /// Altitude of a face, in parts of its longest side, from which rods 1e10 times as stiff as the masses
    /// hold the face: a length error `d` of the long sides moves the apex of a face of altitude `a l` by `d l
    /// / a`, so that slimmer faces need less than the 1e-10 that such rods let through for an error of 1e-4
    /// in the altitude.
    sliver = 1e-3,
    /// Stiffnesses of the rods in the linear systems that solve for their multipliers, in units of that of
    /// the masses. The systems are regularised saddle-point systems `[H G^T; G -1/r]` with penalties `r`,
    /// solved by elimination of the multipliers; `MultiplierSolver` takes the regularisation out again. With
    /// the first stiffness steps keep momentum and symmetries to round-off, with 1e11 no longer. Where the
    /// multipliers do not converge, the second is used from then on, in later steps, too: beyond it the
    /// masses drown in the round-off of the penalty. (Strips of rods on edge, at rest: 10 to 16
    /// factorisations a step, and 16 to 280 where every step begins with the first.)
    first_stiffness = 1e10,
    /// Stiffness of the rods from which on it is not raised any more: the masses drown in the round-off of
    /// the penalty.
    last_stiffness = 1e13,
    /// Length of an iteration for the multipliers beyond which rods count as dependent: the inverse of the
    /// smallest eigenvalue that is not taken to be zero. Multipliers of nearly dependent rods may grow
    /// without bound. Strips of rods that stand on edge take five times the factorisations at rest without
    /// this bound.
    longest_iteration = 3.0,
    /// Conjugate gradient iterations for the multipliers of a step: nearly dependent rods, as in a sheet that
    /// lies flat, have a few eigenvalues each of which takes an iteration. With none, clamped strips of
    /// nearly dependent rods need three to ten times the factorisations; 6 and 16 differ by less than a
    /// tenth.
    multiplier_iterations = 8.0,
    /// Change of the multipliers, relative to the largest, from which an iteration is not worth its solve.
    /// With 1e-3 a sheet at rest on a table needs three times as many steps.
    multipliers_settled = 1e-4,
    /// Passes in which the multipliers of vertex constraints follow those of the isometry.
    constraint_passes = 4.0,
    /// Number of iterations after which decreases of the size of length errors are noise. Where there are
    /// finite multipliers, Newton's method has converged by then, and small motions of taut sheets are below
    /// that size. Where there are none, the last decreases only fall as the inverse of the number of
    /// iterations.
    noise_patience = 10.0,
    /// Part of the energy that the tolerance of the lengths leaves open, `tolerance * sum |L| l^2`, that
    /// counts as noise then: length errors of different rods have different signs. Strips on edge at rest
    /// need 15 to 930 factorisations a step without this rule, and 11 to 100 with it.
    length_noise = 0.1,
    /// Largest number of iterations of a restoration of an iterate: more are a sign that the step is not a
    /// small one.
    iterate_restoration = 12.0,
    /// Part of the promised decrease that has to come true (Armijo's condition).
    armijo = 1e-4,
    /// Growth of the penalty from round to round. Ten keeps Newton's method close to its quadratic range:
    /// with thirty a sheet draping on a floor needs twice the iterations.
    penalty_growth = 10.0,
    /// Displacements along a direction of negative curvature, largest component in mean rod lengths, in the
    /// order in which they are tried. Strains grow with the square of a displacement, and an iterate that has
    /// been displaced too far returns slowly: with 1e-2 a sheet of 8192 triangles takes three times as many
    /// factorisations in steps of 0.25 ms, and with 1e-3 twice as many as with 1e-4; for sheets of up to 512
    /// triangles there is no difference.
    perturbation = 1e-4,
    /// Power iterations for a direction of negative curvature. Each takes one solve with the factorisation at
    /// hand.
    curvature_iterations = 6.0,
    /// Bound on the number of operations that a term of the value goes through, for its round-off.
    round_off_operations = 8.0,
    /// The same for the squares of length errors that are themselves round-off of the positions.
    position_operations = 64.0,
    /// Part of the slope that a corrected step has to keep, so that it still descends.
    kept_slope = 0.1,
    /// Part of the largest fold that the tolerance of the lengths allows by which contact at rest may move.
    fold_part = 0.1,
    /// Allowance for round-off, in units of its estimate, when two values of the incremental potential are
    /// compared.
    comparison_slack = 10.0,
    /// Penalty (relative to the masses) that a projection starts from. From 1e9 the projection is a
    /// Gauss-Newton step to round-off wherever the rods are independent.
    restoration_penalty = 1e9,
    /// Bounds of the penalty while it adapts. Above 1e13 the masses drown in the round-off of the penalty and
    /// the matrix loses its definiteness; below 1e3 steps are too timid to be useful.
    smallest_penalty = 1e3,
    /// Largest penalty of a restoration.
    largest_penalty = 1e13,
    /// Sufficient decrease of the length error per full step, the usual choice for Gauss-Newton.
    sufficient_decrease = 0.1,
    /// A line search that has halved its step this often has stalled.
    smallest_length = 1e-2,
    /// Part of the error that an iteration leaves from which it counts as slow, and number of slow iterations
    /// in a row that make an iterate stationary. Two to eight cost the same; without a limit hanging sheets
    /// of 81 vertices need up to 400 iterations in steps of 5 ms.
    slow = 0.9,
    /// Number of slow iterations in a row that make an iterate stationary.
    slow_iterations = 4.0,
    /// Tolerance from which iterates are restored that may be far from the manifold: a stationary one is left
    /// to the caller, who takes a shorter step.
    loose_restoration = 1e-3,
    /// Part of the tolerance that is the goal of corrections with contact, which cost no factorisation. It
    /// keeps what round-off adds in later steps below the tolerance, and so a sheet at rest from having to
    /// fold.
    reserve = 0.1,
    /// Passes of the method of multipliers: each contracts by the penalty, except along rods that are
    /// dependent.
    velocity_passes = 3.0,
    /// Growth of the displacement that opens a flat patch from one attempt to the next: the next one has to
    /// leave the basin that the last one fell back into.
    opening_growth = 4.0,
    /// Largest number of such displacements in contact, where they may be in vain; after these the caller
    /// minimises again. The first step of a sheet that lies flat on a table takes 490 factorisations without
    /// a limit (means of 24 starts), 350 with three to five, and 610 with two.
    openings_in_contact = 4.0,
    /// Largest such displacement, in rod lengths: beyond, faces could turn over.
    largest_opening = 0.05,
    /// Largest number of corrections. Hanging sheets of 512 triangles (eight starts) take 11.7 factorisations
    /// a step without corrections, 9.6 with at most four and 9.7 with at most eight; tablecloths a tenth less
    /// with four.
    corrections = 4.0,
    /// Part of the strain that a correction leaves from which the next one is not worth its solve. With 0.01,
    /// 0.1 and 0.5 the hanging sheets take 10.5, 9.6 and 9.7 factorisations a step.
    contraction = 0.1,
    /// Sub-steps accepted after a refusal before a longer one is tried: a singular state takes a few steps to
    /// pass, and trying too soon is what most refusals were.
    patience = 4.0,
    /// Share of the kinetic energy that a damped method may gain in one step. Compressed rods that snap
    /// through can feed implicit methods; shorter steps, and steps of implicit Euler, do not let them.
    gain = 0.1,
    /// Share of the largest kinetic energy so far that all steps together may gain: second-order methods err
    /// to either side by about that at the longest steps that resolve a motion.
    net_gain = 0.02,
    /// Relative displacement that the tolerance of the lengths leaves open: over a short step it looks like a
    /// velocity.
    position_noise = 1e-11,
    /// Round-off of the energies and of the work, relative to their sizes: the projections that end a step
    /// leave 1e-12 of the lengths, and forces of rods above the weight do work over that.
    energy_round_off = 1e-9,
    /// The work of bodies, pins and moving constraints is known to the accuracy of the trapezoidal rule only.
    drive_uncertainty = 5.0,
    /// Factor by which a restoration changes its penalty; its square where the masses hold the step back.
    penalty_step = 10.0,
}
