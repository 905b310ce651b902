//! The constants of a step of the damped methods.

use serde::Serialize;

macro_rules! tuning {
    ($( $(#[doc = $doc:literal])+ $name:ident = $value:literal, )+) => {
        /// The constants of a step of the damped methods. Not an option: they are named in one place so that
        /// a report can change them one at a time (`cargo xtask tuning`), and written at the head of a trace.
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
    /// `max_iterations` over this is the largest number of iterations of the first phase in contact, 20 by
    /// default: a draping sheet needs three to six, an impact more where contact cuts them. With 1 a stamped
    /// sheet needs 1.4 times the factorisations.
    contact_iteration_share = 4.0,
    /// Edge strain that iterates of the first phase may have, and largest displacement, in rod lengths, that
    /// opens a flat patch in a restoration. From 0.005 to 0.2 hanging sheets and sheets on tables and balls
    /// cost the same to a tenth.
    iterate_strain = 0.03,
    /// Largest number of halvings of a search direction in the first phase and in restorations; after these
    /// the next phase begins, which takes longer. Four in contact cost 6 % more over drapes and a stamp.
    halvings = 8.0,
    /// Growth of the penalty from round to round. Ten keeps the iteration close to its quadratic range: with
    /// thirty a sheet draping on a floor needs twice the iterations.
    penalty_growth = 10.0,
    /// Edge strain from which the restoration at the end of a phase is a small displacement.
    small_strain = 1e-5,
    /// Largest number of iterations of a restoration in the first phase. Where they do not suffice, the phase
    /// goes on from there. With 10, 20 and 40 hanging sheets of 2048 triangles need 16 600, 13 100 and 14 300
    /// factorisations.
    restorations = 20.0,
    /// Relative change of normal forces below which friction counts as settled in rounds. With 1e-3 drapes
    /// need a tenth more factorisations.
    friction_settled = 0.05,
    /// Stiffness of the rods, over that of the masses, in systems that are solved for their multipliers.
    /// These are regularised saddle-point systems `[H G^T; G -1/r]` with penalties `r`; `ConstrainedSolver`
    /// takes the regularisation out again. With 1e10 steps keep momentum and symmetries to round-off, with
    /// 1e11 no longer.
    first_stiffness = 1e10,
    /// The same from then on where the multipliers do not converge, and in contact; also the largest penalty
    /// of a restoration. Beyond it the masses drown in the round-off of the penalty. Strips of rods on edge,
    /// at rest, need 10 to 16 factorisations a step, and 16 to 280 where every step begins with the first
    /// stiffness.
    last_stiffness = 1e13,
    /// Length of a conjugate gradient iteration for the multipliers beyond which rods count as dependent: the
    /// inverse of the smallest eigenvalue that is not taken to be zero. Multipliers of nearly dependent rods
    /// may grow without bound. Strips of rods on edge need five times the factorisations at rest without this
    /// bound.
    longest_iteration = 3.0,
    /// Largest number of solves with one factorisation: conjugate gradients for the multipliers, passes over
    /// vertex constraints, power iterations for negative curvature. Nearly dependent rods have a few
    /// eigenvalues each of which takes a solve: with none, clamped strips need three to ten times the
    /// factorisations; 6 and 16 differ by less than a tenth.
    inner_iterations = 8.0,
    /// Number of iterations after which decreases of the size of length errors are noise. Where there are
    /// finite multipliers the iteration has converged by then, and small motions of taut sheets are below
    /// that size. Where there are none, the last decreases only fall as the inverse of the number of
    /// iterations.
    noise_patience = 10.0,
    /// Part of the energy that the tolerance of the lengths leaves open, `tolerance * sum |L| l^2`, that
    /// counts as noise then: length errors of different rods have different signs. Strips on edge at rest
    /// need 15 to 930 factorisations a step without this rule, and 11 to 100 with it.
    length_noise = 0.1,
    /// Part of a promised decrease that has to come true (the usual value of Armijo's condition), in line
    /// searches of the merit function and of the length error.
    armijo = 1e-4,
    /// Displacement that leaves a saddle, largest component in mean rod lengths; along negative curvature a
    /// tenth of it is tried as well. Strains grow with its square: with 1e-2 a sheet of 8192 triangles takes
    /// three times as many factorisations in steps of 0.25 ms; up to 512 triangles there is no difference.
    perturbation = 1e-4,
    /// Bound on the number of operations that a term of the merit function goes through, for its round-off;
    /// its square for the squares of length errors that are themselves round-off of the positions. A minimum
    /// may be above the start of its step by so many times the round-off of both.
    round_off_operations = 8.0,
    /// Penalty, over the masses, that a restoration starts from: a Gauss-Newton step to round-off wherever
    /// the rods are independent.
    restoration_penalty = 1e9,
    /// Factor by which a restoration changes its penalty; its square where the masses hold the step back.
    penalty_step = 10.0,
    /// Part of the length error that an iteration leaves above which it is slow: a correction with the matrix
    /// at hand is not repeated, the penalty of a restoration is raised. With 0.01, 0.1 and 0.5 hanging sheets
    /// of 512 triangles take 10.5, 9.6 and 9.7 factorisations a step.
    contraction = 0.1,
    /// Part of the tolerance of the lengths that is the goal of corrections with contact, which cost no
    /// factorisation. It keeps what round-off adds in later steps below the tolerance, and so a sheet at rest
    /// from having to fold.
    reserve = 0.1,
    /// Part of the length error that an iteration of a restoration leaves from which it counts towards a
    /// stationary iterate. With 0.5 sheets of 2048 triangles need twice the factorisations.
    slow = 0.9,
    /// Number of such iterations in a row that make an iterate stationary. Two to eight cost the same;
    /// without a limit hanging sheets of 81 vertices need up to 400 iterations in steps of 5 ms.
    slow_iterations = 4.0,
    /// Growth of the displacement that opens a flat patch in a restoration from one attempt to the next: the
    /// next one has to leave the basin that the last one fell back into.
    opening_growth = 4.0,
    /// Largest number of such displacements in contact, where they may be in vain; after these the caller
    /// minimises again. The first step of a sheet that lies flat on a table takes 490 factorisations without
    /// a limit (means of 24 starts), 350 with three to five, and 610 with two.
    openings_in_contact = 4.0,
    /// Sub-steps accepted after a refusal before a longer one is tried: a singular state takes a few steps to
    /// pass, and trying too soon is what most refusals were.
    patience = 4.0,
    /// Part of the kinetic energy that a damped method may gain in one step. Compressed rods that snap
    /// through can feed implicit methods; shorter steps do not let them.
    gain = 0.1,
    /// Part of the largest kinetic energy so far that all steps together may gain: second-order methods err
    /// to either side by about that at the longest steps that resolve a motion.
    net_gain = 0.02,
    /// Relative displacement that the tolerance of the lengths leaves open: over a short step it looks like a
    /// velocity.
    position_noise = 1e-11,
    /// Round-off of the energies and of the work, relative to their sizes: the restorations that end a step
    /// leave 1e-12 of the lengths, and forces of rods above the weight do work over that.
    energy_round_off = 1e-9,
    /// The work of bodies, pins, moving constraints and air is known to the accuracy of the trapezoidal rule
    /// only: this many times the gain that kinetic energy allows.
    drive_uncertainty = 5.0,
}

impl Tuning {
    /// The shortest part of a step that a line search tries: one that has been halved to it has stalled, and
    /// contact that leaves less is in the way.
    pub(crate) fn shortest_part(&self) -> f64 {
        0.5_f64.powi(self.halvings as i32)
    }
}
