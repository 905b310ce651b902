//! How a face depends on its bend and on its length errors.

use super::super::bend::Bend;
use super::super::law;
use super::{ARC, Face, SLACK_WIDTH, Strained};
use crate::potential::At;
use nalgebra::{Matrix3, Vector3};

/// Part of a squared bend over which derivatives by it are central differences.
const DIFFERENCE: f64 = 1e-5;

/// Derivatives of a number by what makes the slack of a face, see [`Face::with_slack`].
#[derive(Debug, Default)]
pub(in super::super) struct OfSlack {
    /// By the squared bend that was wanted.
    pub(in super::super) wanted: f64,
    /// By that of before.
    pub(in super::super) squared: f64,
    /// By the length errors beyond those of the chords.
    pub(in super::super) beyond: Vector3<f64>,
}

impl Face {
    /// Derivatives of `w . dE/dx` with the energy `E` of the face: by the chords of its bend, by the squared
    /// bend, and by the stiffness of the barrier.
    pub(in super::super) fn products(
        &self,
        here: At<'_>,
        bend: &Bend,
        barrier: f64,
        w: &[f64],
    ) -> (Vector3<f64>, f64, f64) {
        let at = self.at(here, bend);
        let changes = self.edge_vectors(w);
        let along = Vector3::from_fn(|i, _| at.vectors[i].dot(&changes[i]));
        let law = self.area * self.law_at(&at).curvature();
        let of_barrier = self.densities(&at, barrier + 1.0) - self.densities(&at, barrier);
        let squared = self.area * self.slope_by_bend(&at, bend.squared).dot(&along);
        (-(law * along), squared, of_barrier.dot(&along))
    }

    /// Derivatives of the energy: by the chords of the bend, by the squared bend, and by the stiffness of
    /// the barrier.
    pub(in super::super) fn slopes(
        &self,
        here: At<'_>,
        bend: &Bend,
        barrier: f64,
    ) -> (Vector3<f64>, f64, f64) {
        let at = self.at(here, bend);
        let of_chords = -self.area * self.law_at(&at).slope();
        // (The energy is linear in the stiffness.)
        let of_barrier = self.energy(&at, barrier + 1.0) - self.energy(&at, barrier);
        (
            of_chords,
            self.energy_by_bend(&at, bend.squared),
            of_barrier,
        )
    }

    /// The law at the length errors of a state, with another squared bend.
    fn law_with<T>(&self, at: &Strained, squared: f64, take: impl FnOnce(law::At<'_>) -> T) -> T {
        let bend = Bend {
            squared,
            ..Bend::FLAT
        };
        let slack = self.slack(&bend);
        take(law::At {
            law: &self.law,
            strain: &at.beyond,
            slack: &slack,
            pull: self.law.pull(&at.beyond, &slack),
        })
    }

    /// The derivative of the slope of the law by the squared bend; zero where there is none.
    fn slope_by_bend(&self, at: &Strained, squared: f64) -> Vector3<f64> {
        let step = DIFFERENCE * squared;
        if step == 0.0 || self.rigidity == 0.0 {
            return Vector3::zeros();
        }
        let slope = |squared: f64| self.law_with(at, squared, |law| law.slope());
        (slope(squared + step) - slope(squared - step)) / (2.0 * step)
    }

    /// The derivative of the energy by the squared bend, joules.
    fn energy_by_bend(&self, at: &Strained, squared: f64) -> f64 {
        let step = DIFFERENCE * squared;
        if step == 0.0 || self.rigidity == 0.0 {
            return 0.0;
        }
        let energy = |squared: f64| self.area * self.law_with(at, squared, |law| law.energy());
        (energy(squared + step) - energy(squared - step)) / (2.0 * step)
    }

    /// Of [`Face::stress`] with derivatives of a number by the stress: those by the length errors beyond the
    /// chords, and by the squared bend.
    pub(in super::super) fn pull_stress(
        &self,
        here: At<'_>,
        bend: &Bend,
        of_stress: &Vector3<f64>,
    ) -> (Vector3<f64>, f64) {
        let at = self.at(here, bend);
        let of_slope = self.edge_squares * of_stress;
        let of_squared = self.slope_by_bend(&at, bend.squared).dot(&of_slope);
        (self.law_at(&at).curvature() * of_slope, of_squared)
    }

    /// Of [`Face::with_slack`] with derivatives of a number by the squared bend and the credit that it
    /// gives. Where the slack that is wanted cannot be paid for, the part of the way from it to what there
    /// was, which bisection has found, counts as constant.
    pub(in super::super) fn pull_slack(
        &self,
        here: At<'_>,
        bend: Bend,
        (wanted, part): (f64, f64),
        [of_squared, of_credit]: [f64; 2],
    ) -> OfSlack {
        let given = wanted + part * (bend.squared - wanted);
        if wanted == bend.squared {
            return OfSlack {
                squared: of_squared,
                ..OfSlack::default()
            };
        }
        let at = self.at(here, &bend);
        let of_given = of_squared - of_credit * self.energy_by_bend(&at, given);
        let slope = |squared: f64| self.area * self.law_with(&at, squared, |law| law.slope());
        OfSlack {
            wanted: (1.0 - part) * of_given,
            squared: part * of_given + of_credit * self.energy_by_bend(&at, bend.squared),
            beyond: -of_credit * (slope(given) - slope(bend.squared)),
        }
    }

    /// The bend with a slack on a part of the way from a squared bend of `wanted` to its own.
    pub(in super::super) fn with_part(
        &self,
        here: At<'_>,
        bend: Bend,
        wanted: f64,
        part: f64,
    ) -> Bend {
        let at = self.at(here, &bend);
        let squared = wanted + part * (bend.squared - wanted);
        let energy = |squared: f64| self.area * self.law_with(&at, squared, |law| law.energy());
        Bend {
            squared,
            credit: bend.credit - (energy(squared) - energy(bend.squared)),
            ..bend
        }
    }

    /// Adds the derivatives of a number by the positions (`3V`) with those by the length errors.
    pub(in super::super) fn pull_errors(
        &self,
        here: At<'_>,
        of_errors: &Vector3<f64>,
        of_x: &mut [f64],
    ) {
        let at = self.at(here, &Bend::FLAT);
        self.add_forces(&at, of_errors, of_x);
    }

    /// Of a bend by the second derivatives of positions: with derivatives of a number by its chords and its
    /// square those by the second derivatives.
    pub(in super::super) fn pull_bend(
        &self,
        second: &Matrix3<f64>,
        of_chords: &Vector3<f64>,
        of_own: f64,
    ) -> Matrix3<f64> {
        let mut along = second * self.edge_squares.transpose();
        for i in 0..3 {
            let mut column = along.column_mut(i);
            column *= -2.0 * ARC * of_chords[i];
        }
        along * self.edge_squares + 2.0 * of_own * self.mean_squared_length() * second
    }
}

const _: () = assert!(DIFFERENCE < SLACK_WIDTH);
