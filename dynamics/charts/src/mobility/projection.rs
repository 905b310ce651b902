//! Projection of positions onto lengths and closure equations, and the check whether a state meets them.

use super::Mobility;
use crate::{ChartDynamicsError, ChartMechanics, PositionUpdate};
use isosheet_coords::ChartError;
use isosheet_coords::linalg::norm_inf;

/// Strain and relative violation at which a projection onto lengths and closures has converged.
const TOLERANCE: f64 = 1e-13;

/// Strain and relative violation that are accepted where it goes no further: ten times that, and the
/// round-off of coordinates that are large against the rods.
const ACCEPTED: f64 = 1e-12;
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Most Newton iterations of a projection; three or four are usual.
const ITERATIONS: usize = 20;

impl Mobility {
    /// The row furthest off, by its place, and its relative violation; infinite if it is not a number.
    fn worst(&self) -> Option<(usize, f64)> {
        let mut worst: Option<(usize, f64)> = None;
        for (i, row) in self.rows.iter().enumerate() {
            let off = row.value.abs() / row.length;
            let off = if off.is_nan() { f64::INFINITY } else { off };
            if worst.is_none_or(|(_, w)| off > w) {
                worst = Some((i, off));
            }
        }
        worst
    }

    /// Refuses a state whose closures are off by more than `limit`, relative to the shortest rod at the
    /// vertex.
    pub(crate) fn check(
        &mut self,
        mechanics: &ChartMechanics,
        t: f64,
        x: &[f64],
        limit: f64,
    ) -> Result<(), ChartDynamicsError> {
        self.at(mechanics, t, x)?;
        match self.worst() {
            Some((row, off)) if off > limit => Err(self.not_met(t, row)),
            _ => Ok(()),
        }
    }

    fn not_met(&self, t: f64, row: usize) -> ChartDynamicsError {
        let support = self.rows[row].support;
        let squares = self.rows.iter().filter(|r| r.support == support);
        ChartDynamicsError::Closure {
            t,
            support,
            distance: squares.map(|r| r.value * r.value).sum::<f64>().sqrt(),
            rank: self.rank,
            equations: self.rows.len(),
        }
    }

    /// Newton's method for the nearest positions in the mass metric that meet the closures at time `t` and,
    /// unless positions are updated linearly, have the right lengths. Pins end where they belong to the last
    /// bit.
    pub(crate) fn project(
        &mut self,
        mechanics: &ChartMechanics,
        t: f64,
        position: PositionUpdate,
        x: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        let system = mechanics.system();
        let mut lack = vec![0.0; system.equations()];
        let idle = vec![0.0; system.unknowns()];
        let mut step = idle.clone();
        let size = norm_inf(x) / mechanics.model().mean_length();
        let accepted = ACCEPTED.max(ROUND_OFF * size);
        let mut before = f64::INFINITY;
        for _ in 0..ITERATIONS {
            self.place(mechanics, t, x);
            let strain = match position {
                PositionUpdate::Linear => 0.0,
                PositionUpdate::Exact | PositionUpdate::Projected => system.max_strain(x),
            };
            let error = strain.max(self.worst().map_or(0.0, |(_, off)| off));
            let stalled = error > 0.5 * before && error <= accepted;
            if error <= TOLERANCE || stalled {
                for &(vertex, start) in &self.pins {
                    let target = mechanics.model().pin_motion(vertex);
                    let target = target.map_or(start, |m| m.position(t).into());
                    let i = 3 * vertex.index();
                    x[i..i + 3].copy_from_slice(target.as_slice());
                }
                return Ok(());
            }
            if !error.is_finite() {
                return Err(ChartDynamicsError::NotFinite { t });
            }
            before = error;
            self.factorize(mechanics, x)?;
            if position != PositionUpdate::Linear {
                system.residual(x, &mut lack);
                lack.iter_mut().for_each(|c| *c = -*c);
            }
            self.saddle.solve(&idle, &lack, &mut step, &mut self.mu)?;
            let lambda = self.multipliers(self.rows.iter().map(|row| row.apply(&step) + row.value));
            self.give_way(&lambda, &mut step);
            system.add_scaled(1.0, &step, x);
        }
        self.place(mechanics, t, x);
        let strain = system.max_strain(x);
        match self.worst() {
            Some((row, off)) if off > TOLERANCE => Err(self.not_met(t, row)),
            _ => Err(ChartError::NotConverged {
                iterations: ITERATIONS,
                residual: strain,
                tolerance: TOLERANCE,
            }
            .into()),
        }
    }
}
