//! Textbook methods for the same equations, with which the methods of isosheet are compared. Vertices have
//! lumped masses, and forces depend on time and positions alone.

use crate::interrupt::{self, Interrupted};
use crate::report::LENGTHS;
use crate::runs::{Course, Ending};
use cpu_time::ThreadTime;
use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::LengthConstraints;
use nalgebra::{DMatrix, DVector};

/// A textbook method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Baseline {
    /// Accelerations with Lagrange multipliers and Baumgarte's feedback, `c'' + 2 g c' + g^2 c = 0` for every
    /// rod, by the classical Runge-Kutta method of fourth order. The gain `g` (1/s) is such that a violation
    /// decays critically damped.
    Baumgarte { gain: f64 },
    /// Position-based dynamics: rods are projected one after the other, and swept until all have their
    /// lengths to [`LENGTHS`].
    PositionBased,
}

/// Sweeps over all rods after which position-based dynamics has failed.
const SWEEPS: usize = 100_000;

/// Why a step cannot be taken.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("the rods are not independent")]
    Dependent,
    #[error("the lengths have not converged after {SWEEPS} sweeps")]
    NotConverged,
}

/// A sheet of point masses.
struct Masses<'a> {
    model: &'a SheetModel,
    rods: &'a LengthConstraints,
    /// One over the mass of each vertex, 0 of pinned ones, 1/kg.
    inverse: Vec<f64>,
    /// The rods that do not join two pinned vertices.
    free: Vec<usize>,
}

impl<'a> Masses<'a> {
    fn of(model: &'a SheetModel) -> Self {
        let rods = model.rods();
        let mut inverse: Vec<f64> = model.mass().vertex.iter().map(|m| 1.0 / m).collect();
        for pin in model.pins() {
            inverse[pin.index()] = 0.0;
        }
        let moves = |e: &usize| rods.edges()[*e].iter().any(|v| inverse[*v] > 0.0);
        let free = (0..rods.len()).filter(moves).collect();
        Self {
            model,
            rods,
            inverse,
            free,
        }
    }

    /// `v -> M^-1 v`, overwriting.
    fn divide(&self, v: &mut [f64]) {
        for (k, value) in v.iter_mut().enumerate() {
            *value *= self.inverse[k / 3];
        }
    }

    fn difference(&self, e: usize, x: &[f64]) -> [f64; 3] {
        let [a, b] = self.rods.edges()[e];
        [0, 1, 2].map(|k| x[3 * a + k] - x[3 * b + k])
    }

    /// The accelerations (3V, m/s2) with the feedback of a gain.
    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], gain: f64) -> Result<Vec<f64>, Failure> {
        let mut force = vec![0.0; x.len()];
        self.model.potential_force(t, x, &mut force);
        let mut acceleration = force;
        self.divide(&mut acceleration);
        let n = self.free.len();
        // Column e: the accelerations that a unit of the multiplier of rod e gives.
        let mut effects = DMatrix::zeros(x.len(), n);
        let mut unit = vec![0.0; self.rods.len()];
        for (column, &e) in self.free.iter().enumerate() {
            unit[e] = 1.0;
            let mut effect = effects.column_mut(column);
            self.rods
                .apply_transpose_add(x, &unit, effect.as_mut_slice());
            self.divide(effect.as_mut_slice());
            unit[e] = 0.0;
        }
        let row = |y: &[f64]| {
            let mut all = vec![0.0; self.rods.len()];
            self.rods.apply(x, y, &mut all);
            self.free.iter().map(|&e| all[e]).collect::<Vec<f64>>()
        };
        let columns = effects.column_iter().flat_map(|c| row(c.as_slice()));
        let matrix = DMatrix::from_iterator(n, n, columns);
        let (rates, drawn) = (row(v), row(&acceleration));
        let residual = self.rods.residual(x);
        let right = self.free.iter().enumerate().map(|(k, &e)| {
            let w = self.difference(e, v);
            let turning: f64 = w.iter().map(|c| c * c).sum();
            drawn[k] + turning + 2.0 * gain * rates[k] + gain * gain * residual[e]
        });
        let right = DVector::from_iterator(n, right);
        let solved = matrix.cholesky().ok_or(Failure::Dependent)?.solve(&right);
        let rods = effects * solved;
        let both = acceleration.iter().zip(rods.iter());
        Ok(both.map(|(a, r)| a - r).collect())
    }

    /// A step of the classical Runge-Kutta method.
    fn runge_kutta(&self, state: &mut State, h: f64, gain: f64) -> Result<(), Failure> {
        let (x0, v0) = (state.x.clone(), state.v.clone());
        let moved = |from: &[f64], by: &[f64], part: f64| -> Vec<f64> {
            from.iter().zip(by).map(|(a, b)| a + part * b).collect()
        };
        let (mut v, mut a) = (v0.clone(), self.accelerations(state.t, &x0, &v0, gain)?);
        for (weight, next) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)] {
            state.x = moved(&state.x, &v, weight * h / 6.0);
            state.v = moved(&state.v, &a, weight * h / 6.0);
            if next > 0.0 {
                let (x, stage) = (moved(&x0, &v, next * h), moved(&v0, &a, next * h));
                a = self.accelerations(state.t + next * h, &x, &stage, gain)?;
                v = stage;
            }
        }
        Ok(())
    }

    /// A step of position-based dynamics.
    fn project(&self, state: &mut State, h: f64) -> Result<(), Failure> {
        let mut push = vec![0.0; state.x.len()];
        self.model.potential_force(state.t, &state.x, &mut push);
        self.divide(&mut push);
        let mut y = state.x.clone();
        for (k, place) in y.iter_mut().enumerate() {
            *place += h * (state.v[k] + h * push[k]);
        }
        for _ in 0..SWEEPS {
            let worst = self.sweep(&mut y);
            if worst <= LENGTHS {
                let both = y.iter().zip(&state.x);
                state.v = both.map(|(now, before)| (now - before) / h).collect();
                state.x = y;
                return Ok(());
            }
        }
        Err(Failure::NotConverged)
    }

    /// Gives every rod its length, one after the other, and returns the largest relative error that one had.
    fn sweep(&self, y: &mut [f64]) -> f64 {
        let mut worst: f64 = 0.0;
        for &e in &self.free {
            let ([a, b], rest) = (self.rods.edges()[e], self.rods.lengths()[e]);
            let d = self.difference(e, y);
            let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
            worst = worst.max((length / rest - 1.0).abs());
            let (wa, wb) = (self.inverse[a], self.inverse[b]);
            let part = (length - rest) / (length * (wa + wb));
            for k in 0..3 {
                y[3 * a + k] -= wa * part * d[k];
                y[3 * b + k] += wb * part * d[k];
            }
        }
        worst
    }
}

impl Baseline {
    /// Runs so many steps of a length (seconds) from a state, which becomes that of the end.
    ///
    /// # Errors
    /// [`Interrupted`]; a failure of the method is an ending of the course.
    pub(super) fn run(
        self,
        model: &SheetModel,
        state: &mut State,
        (steps, h): (usize, f64),
    ) -> Result<Course, Interrupted> {
        let masses = Masses::of(model);
        let energy = |s: &State| model.kinetic_energy(&s.v) + model.potential_energy(s.t, &s.x);
        let (start, begun) = (energy(state), ThreadTime::now());
        let mut course = Course::default();
        let mut cpu = 0.0;
        for k in 1..=steps {
            interrupt::check()?;
            let before = begun.elapsed();
            let done = match self {
                Self::Baumgarte { gain } => masses.runge_kutta(state, h, gain),
                Self::PositionBased => masses.project(state, h),
            };
            cpu += (begun.elapsed() - before).as_secs_f64();
            if let Err(failure) = done {
                course.ending = Ending::of(&failure, &failure);
                break;
            }
            state.t = k as f64 * h;
            (course.time, course.cost.steps, course.cost.substeps) = (state.t, k, k);
            course.drift = course.drift.max((energy(state) - start).abs());
            course.most_kinetic = course.most_kinetic.max(model.kinetic_energy(&state.v));
            course.strain = course.strain.max(masses.rods.max_strain(&state.x));
        }
        course.cost.cpu = cpu;
        Ok(course)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_dynamics::Simulation;
    use isosheet_tests::{Pendulum, bent, implicit_euler, max_difference, orders, tumbling_from};

    /// The pendulum, whose errors fall with the order of the method.
    #[test]
    fn the_pendulum_swings_as_jacobi_functions_say() {
        let pendulum = Pendulum::default();
        let (model, end) = (pendulum.model(), 0.3 * pendulum.period());
        let exact = pendulum.exact(end);
        let methods = [
            (Baseline::Baumgarte { gain: 7.0 }, 4.0),
            (Baseline::PositionBased, 1.0),
        ];
        for (method, order) in methods {
            let error = |steps: usize| {
                let mut state = pendulum.start();
                let course = method.run(&model, &mut state, (steps, end / steps as f64));
                assert!(course.unwrap().is_good(), "{method:?}");
                max_difference(&state.x, &exact)
            };
            let found = orders(&[64, 128, 256].map(error));
            let is_of_order = |o: &f64| (o - order).abs() < 0.15;
            assert!(found.iter().all(is_of_order), "{method:?}: {found:?}");
        }
    }

    /// The two rods of the pendulum hold one vertex: converged position-based dynamics is implicit Euler.
    #[test]
    fn a_converged_projection_is_a_step_of_implicit_euler() {
        let pendulum = Pendulum::default();
        let (model, h) = (pendulum.model(), 0.01);
        let mut state = pendulum.start();
        let course = Baseline::PositionBased.run(&model, &mut state, (40, h));
        assert!(course.unwrap().is_good());
        let start = pendulum.start();
        let mut euler = Simulation::new(model, start, implicit_euler()).unwrap();
        euler.run(40.0 * h, h, &mut []).unwrap();
        let apart = max_difference(&state.x, &euler.state().x);
        assert!(apart < 1e-9, "{apart:e} m");
    }

    /// Position-based dynamics keeps the lengths to the tolerance, and Baumgarte's feedback the smaller a
    /// violation the larger its gain is; a violation that is there at the start decays as a critically damped
    /// one.
    #[test]
    fn lengths_are_kept_and_violations_decay() {
        let (sheet, x) = bent(0, 0.4);
        let (model, start) = tumbling_from(&sheet, x);
        let mut state = start.clone();
        let course = Baseline::PositionBased
            .run(&model, &mut state, (50, 2e-3))
            .unwrap();
        assert!(
            course.is_good() && course.strain < 2.0 * LENGTHS,
            "{course:?}"
        );
        let strain = |gain: f64| {
            let mut state = start.clone();
            state.x.iter_mut().for_each(|c| *c *= 1.0 + 1e-6);
            let method = Baseline::Baumgarte { gain };
            method.run(&model, &mut state, (100, 1e-3)).unwrap();
            model.rods().max_strain(&state.x)
        };
        // c = c0 (1 + g t) exp(-g t), and G v = 2 c0 (...) is small beside it: the velocities followed the
        // lengths.
        for gain in [10.0, 50.0] {
            let s: f64 = gain * 0.1;
            let ratio = strain(gain) / (1e-6 * (1.0 + s) * (-s).exp());
            assert!((ratio - 1.0).abs() < 0.2, "gain {gain}: {ratio}");
        }
    }
}
