//! The constants of a step of the damped methods.

use serde::Serialize;

/// The constants of a step of the damped methods. Not an option: they are named in one place, and written at
/// the head of a trace. The factorisations that other values cost are means over fifteen kinds of scene with
/// eight starts each.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tuning {
    /// `max_iterations` over this is the largest number of iterations of SQP in contact and of a restoration
    /// in SQP, 20 by default: a draping sheet needs three to six, an impact more where contact cuts them.
    /// With 2 and 8 a stamped sheet needs 1.2 and 2.3 times the factorisations; with whole restorations heavy
    /// parts need 1.1 times.
    pub iteration_share: f64,
    /// Edge strain that iterates of SQP may have, and largest displacement, in rod lengths, that opens a flat
    /// patch in a restoration. With 0.1 and 0.2 hanging sheets need 1.1 and 1.2 times the factorisations.
    pub iterate_strain: f64,
    /// Growth of the penalty from round to round of the augmented Lagrangian, and from iteration to iteration
    /// of a restoration that contracts by less than that. Ten keeps the iteration close to its quadratic
    /// range: with thirty a sheet draping on a floor needs twice the iterations.
    pub penalty_growth: f64,
    /// Edge strain from which the restoration at the end of a phase is a small displacement. With twice the
    /// value a sheet that is fed into a corner needs 2.5 times the factorisations.
    pub small_strain: f64,
    /// Stiffness of the rods, over that of the masses, in systems that are solved for their multipliers.
    /// These are regularised saddle-point systems `[H G^T; G -1/r]` with penalties `r`; `ConstrainedSolver`
    /// takes the regularisation out again. With 1e9 needles a million times longer than wide lock, with 1e11
    /// steps keep momentum and symmetries no longer to round-off. Restorations, which crumpled sheets need
    /// softer, start from a penalty of one growth less.
    pub first_stiffness: f64,
    /// Stiffness of the rods, over that of the masses, in systems that are solved for their multipliers, once
    /// these have not converged with the first stiffness, and in contact; also the largest penalty of a
    /// restoration. Beyond it the masses drown in the round-off of the penalty. Strips of rods on edge, at
    /// rest, need 10 to 16 factorisations a step, and 16 to 280 where every step begins with the first
    /// stiffness.
    pub last_stiffness: f64,
    /// Length of a conjugate gradient iteration for the multipliers beyond which rods count as dependent: the
    /// inverse of the smallest eigenvalue that is not taken to be zero. Multipliers of nearly dependent rods
    /// may grow without bound: with 8 sheets flat on a table need 1.5 times the factorisations, and strips of
    /// rods on edge at rest five times without this bound.
    pub longest_iteration: f64,
    /// How often one factorisation is used again for the same purpose: halvings of a search direction,
    /// conjugate gradients for the multipliers, passes over vertex constraints, power iterations for negative
    /// curvature. With none of these clamped strips need three to ten times the factorisations.
    pub repetitions: f64,
    /// Part of the length error that an iteration of a restoration leaves from which it counts towards a
    /// stationary iterate. With half the value sheets flat on a table need three times the factorisations,
    /// with 0.99 slivers 1.3 times.
    pub slow: f64,
    /// How often something may be in vain before it is given up: such iterations in a row, which make an
    /// iterate stationary (with 2 and 8 a sheet that is fed into a corner needs 1.3 times the factorisations,
    /// and one flat on a table 1.6 times), and displacements that open a flat patch in contact (with 2 one
    /// flat on a table needs 2.4 times). So many sub-steps are accepted after a refusal before a longer one
    /// is tried.
    pub patience: f64,
    /// Growth of the displacement that opens a flat patch in a restoration from one attempt to the next: the
    /// next one has to leave the basin that the last one fell back into. With half the value a sheet flat on
    /// a table needs 2.8 times the factorisations.
    pub opening_growth: f64,
    /// Displacement that leaves a saddle, largest component in mean rod lengths; along negative curvature a
    /// tenth of it is tried as well. Strains grow with its square: with 1e-2 a sheet of 8192 triangles takes
    /// three times as many factorisations in steps of 0.25 ms; up to 512 triangles there is no difference.
    pub perturbation: f64,
    /// Relative change of normal forces below which friction counts as settled in the augmented Lagrangian.
    /// With 1e-3 sheets that are stamped or fed into a corner need 1.2 times the factorisations.
    pub friction_settled: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            iteration_share: 4.0,
            iterate_strain: 0.03,
            penalty_growth: 10.0,
            small_strain: 1e-5,
            first_stiffness: 1e10,
            last_stiffness: 1e13,
            longest_iteration: 3.0,
            repetitions: 8.0,
            slow: 0.9,
            patience: 4.0,
            opening_growth: 4.0,
            perturbation: 1e-4,
            friction_settled: 0.05,
        }
    }
}

impl Tuning {
    /// The shortest part of a step that a line search tries: one that has been halved to it has stalled, and
    /// contact that leaves less is in the way.
    pub(crate) fn shortest_part(&self) -> f64 {
        0.5_f64.powi(self.repetitions as i32)
    }

    /// Altitude of a face, in parts `a` of its longest side, from which rods of the first stiffness `r` hold
    /// the face. These let a length error of `l / r` through; one of the long sides moves the apex by `l / (r
    /// a)`, which is to be less than `1e-4` of the altitude `a l`.
    pub(crate) fn sliver(&self) -> f64 {
        (1e4 / self.first_stiffness).sqrt()
    }

    /// Penalty, over the masses, that a restoration starts from.
    pub(crate) fn restoration_penalty(&self) -> f64 {
        self.first_stiffness / self.penalty_growth
    }

    /// Part of the length error that an iteration leaves above which it is slow, and part of the tolerance of
    /// the lengths that is the goal where a correction costs no factorisation: what a penalty that has grown
    /// would leave.
    pub(crate) fn contraction(&self) -> f64 {
        1.0 / self.penalty_growth
    }
}
