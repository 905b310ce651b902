//! A sheet in motion: state, integrator, step control and energy balance.

use crate::energy_momentum::{EnergyMomentum, EnergyMomentumOptions};
use crate::implicit_euler::{ImplicitEuler, ImplicitEulerOptions};
use crate::integrator::{Integrator, OptionsError};
use crate::primal::PrimalMatrix;
use crate::project::Projector;
use crate::projection_step::{ProjectionStep, ProjectionStepOptions};
use crate::rank::rod_rank;
use crate::rattle::{Rattle, RattleComposition, RattleOptions};
use crate::report::{Effort, Path, StepError, StepReport};
use crate::{SheetModel, State};
use isosheet_coords::linalg::LinalgError;
use isosheet_mesh::{EdgeId, VertexId};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Which integrator moves the sheet.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// Implicit Euler with the constraints in the step: first order, damped, takes any state.
    ImplicitEuler(ImplicitEulerOptions),
    /// Predict and project: first order, damped, cheapest, takes any state.
    Projection(ProjectionStepOptions),
    /// Energy-momentum: second order, conserves energy and momenta.
    EnergyMomentum(EnergyMomentumOptions),
    /// RATTLE: second order, symplectic.
    Rattle(RattleOptions),
    /// Suzuki's fourth-order composition of RATTLE.
    RattleComposition(RattleOptions),
}

impl Default for Method {
    fn default() -> Self {
        Self::ImplicitEuler(ImplicitEulerOptions::default())
    }
}

/// How a simulation subdivides steps that its integrator rejects.
#[derive(Debug, Clone, PartialEq)]
pub struct StepControl {
    /// Smallest sub-step, as a fraction of the step asked for. Default 2^-14 (6e-5).
    pub min_fraction: f64,
    /// What to do when even that is rejected. Default [`Fallback::Refuse`].
    pub fallback: Fallback,
}

/// What to do when an integrator rejects even the smallest sub-step.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Fallback {
    /// Return the error.
    #[default]
    Refuse,
    /// Take the step with implicit Euler, which accepts any state, and carry on with the
    /// integrator asked for. Reported as [`Path::Fallback`]; costs the energy that implicit
    /// Euler loses in that step.
    ImplicitEuler(ImplicitEulerOptions),
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            min_fraction: 2.0_f64.powi(-14),
            fallback: Fallback::Refuse,
        }
    }
}

impl StepControl {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("min_fraction", self.min_fraction, 1e-12, 1.0)?;
        match &self.fallback {
            Fallback::Refuse => Ok(()),
            Fallback::ImplicitEuler(options) => options.validate(),
        }
    }
}

/// Why a simulation cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// An option makes no sense.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The state does not fit the model.
    #[error(
        "the state has {positions} position and {velocities} velocity values, the sheet needs \
         {expected} of each"
    )]
    StateLength {
        /// Number of position values.
        positions: usize,
        /// Number of velocity values.
        velocities: usize,
        /// Three for each vertex.
        expected: usize,
    },
    /// The start state is not one that a step could start from.
    #[error(transparent)]
    Start(#[from] StepError),
    /// The linear algebra could not be set up.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

/// Largest relative length error of a start state. Files keep six to eight digits and are
/// projected first; anything within this bound is closed by the first step unnoticed.
const START_STRAIN: f64 = 1e-8;

/// A sheet in motion. Owns the model, the state and the integrator.
pub struct Simulation {
    model: SheetModel,
    state: State,
    integrator: Box<dyn Integrator>,
    control: StepControl,
    fallback: Option<ImplicitEuler>,
    force: Vec<f64>,
    start_energy: f64,
    work: f64,
    dissipated: f64,
}

impl Simulation {
    /// A simulation of `model` from `state`.
    ///
    /// Velocities of pinned vertices are set to zero.
    ///
    /// # Errors
    /// [`SimulationError`] if the options or the state make no sense, or the state does not
    /// have the rest lengths to 1e-8 (see [`project_positions`]).
    pub fn new(
        model: SheetModel,
        mut state: State,
        method: Method,
    ) -> Result<Self, SimulationError> {
        let expected = model.coordinate_count();
        if state.x.len() != expected || state.v.len() != expected {
            return Err(SimulationError::StateLength {
                positions: state.x.len(),
                velocities: state.v.len(),
                expected,
            });
        }
        model.clear_pinned(&mut state.v);
        check_state(&model, &state)?;
        let integrator: Box<dyn Integrator> = match method {
            Method::ImplicitEuler(o) => {
                o.validate()?;
                Box::new(ImplicitEuler::new(&model, o)?)
            }
            Method::Projection(o) => {
                o.validate()?;
                Box::new(ProjectionStep::new(&model, o)?)
            }
            Method::EnergyMomentum(o) => {
                o.validate()?;
                Box::new(EnergyMomentum::new(&model, o)?)
            }
            Method::Rattle(o) => {
                o.validate()?;
                Box::new(Rattle::new(&model, o)?)
            }
            Method::RattleComposition(o) => {
                o.validate()?;
                Box::new(RattleComposition::new(&model, o)?)
            }
        };
        let start_energy = energy(&model, &state);
        Ok(Self {
            model,
            state,
            integrator,
            control: StepControl::default(),
            fallback: None,
            force: vec![0.0; expected],
            start_energy,
            work: 0.0,
            dissipated: 0.0,
        })
    }

    /// Replaces the step control.
    ///
    /// # Errors
    /// [`SimulationError`] if it makes no sense.
    pub fn with_control(mut self, control: StepControl) -> Result<Self, SimulationError> {
        control.validate()?;
        self.fallback = match &control.fallback {
            Fallback::Refuse => None,
            Fallback::ImplicitEuler(o) => Some(ImplicitEuler::new(&self.model, o.clone())?),
        };
        self.control = control;
        Ok(self)
    }

    /// The model.
    pub fn model(&self) -> &SheetModel {
        &self.model
    }

    /// Ends the simulation and returns its model.
    pub fn into_model(self) -> SheetModel {
        self.model
    }

    /// Time, positions and velocities.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Displaces a sheet off a flat or otherwise singular state: every free vertex by at most
    /// `amplitude` mean edge lengths in a random direction, then back onto the rest lengths.
    /// Velocities are kept, the energy balance starts anew.
    ///
    /// Which way the sheet will fold is decided by `seed`, so runs can be repeated.
    ///
    /// # Errors
    /// [`SimulationError`] if the amplitude makes no sense or the projection fails; the state
    /// is then unchanged.
    pub fn leave_flat(&mut self, amplitude: f64, seed: u64) -> Result<(), SimulationError> {
        OptionsError::check_range("amplitude", amplitude, 0.0, 1.0)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let size = amplitude * self.model.mean_length();
        let mut displacement: Vec<f64> = (0..self.state.x.len())
            .map(|_| rng.random_range(-size..=size))
            .collect();
        self.model.clear_pinned(&mut displacement);
        let mut x = self.state.x.clone();
        for (x, d) in x.iter_mut().zip(&displacement) {
            *x += d;
        }
        project_positions(&self.model, &mut x, 1e-12)?;
        self.state.x = x;
        self.start_energy = energy(&self.model, &self.state);
        self.work = 0.0;
        self.dissipated = 0.0;
        Ok(())
    }

    /// Advances by exactly `h` seconds, in sub-steps where the integrator rejects the whole.
    ///
    /// # Errors
    /// [`StepError`]; the state is then that of the last accepted sub-step.
    pub fn step(&mut self, h: f64) -> Result<StepReport, StepError> {
        let start = self.state.t;
        if !(h.is_finite() && h > 0.0) || start + h <= start {
            return Err(StepError::StepSize { h, t: start });
        }
        check_finite(&self.state)?;
        self.check_forces()?;
        let end = start + h;
        let min_step = self.control.min_fraction * h;
        let mut effort = Effort::default();
        let (mut substeps, mut rejected) = (0, 0);
        let (mut residual, mut path) = (0.0_f64, Path::Newton);
        // Sub-steps are h / 2^level on a binary grid, so that they end at h exactly.
        let (mut fraction, mut done) = (1.0, 0.0);
        while done < 1.0 {
            let mut tried =
                self.integrator
                    .step(&self.model, &mut self.state, fraction * h, &mut effort);
            if let Err(cause) = tried {
                if matches!(cause, StepError::NonFiniteForce { .. }) {
                    return Err(cause);
                }
                rejected += 1;
                if 0.5 * fraction * h >= min_step {
                    fraction *= 0.5;
                    continue;
                }
                let Some(fallback) = &mut self.fallback else {
                    return Err(diagnose(&self.model, &self.state, min_step, cause));
                };
                fraction = largest_fraction(done);
                tried = fallback.step(&self.model, &mut self.state, fraction * h, &mut effort);
                path = Path::Fallback;
            }
            let accepted =
                tried.map_err(|cause| diagnose(&self.model, &self.state, min_step, cause))?;
            substeps += 1;
            done += fraction;
            self.state.t = if done < 1.0 { start + done * h } else { end };
            residual = residual.max(accepted.residual);
            path = path.max(accepted.path);
            self.work += accepted.work;
            self.damp(fraction * h);
            fraction = largest_fraction(done).min(2.0 * fraction);
        }
        let kinetic = self.model.kinetic_energy(&self.state.v);
        let potential = self.model.potential_energy(end, &self.state.x);
        Ok(StepReport {
            t: end,
            h,
            substeps,
            rejected,
            iterations: effort.iterations,
            factorisations: effort.factorisations,
            residual,
            kinetic,
            potential,
            work: self.work,
            dissipated: self.dissipated,
            energy_drift: kinetic + potential - self.work + self.dissipated - self.start_energy,
            strain: self.model.rods().max_strain(&self.state.x),
            gap: None,
            path,
        })
    }

    /// Refuses potentials and forces that are not finite at the state.
    fn check_forces(&mut self) -> Result<(), StepError> {
        let State { t, x, v } = &self.state;
        self.model.potential_force(*t, x, &mut self.force);
        for force in self.model.forces() {
            force.add_force(*t, x, v, &mut self.force);
        }
        match self.force.iter().position(|f| !f.is_finite()) {
            None => Ok(()),
            Some(i) => Err(StepError::NonFiniteForce {
                vertex: VertexId((i / 3) as u32),
                value: self.force[i],
                t: *t,
            }),
        }
    }

    fn damp(&mut self, h: f64) {
        if self.model.damping() > 0.0 {
            let before = self.model.kinetic_energy(&self.state.v);
            let factor = (-self.model.damping() * h).exp();
            self.state.v.iter_mut().for_each(|v| *v *= factor);
            self.dissipated += before * (1.0 - factor * factor);
        }
    }
}

/// Moves positions (`3V`, in place) to nearby ones with the rest lengths, pinned vertices kept.
///
/// # Errors
/// [`StepError::NotConverged`] if no positions with a relative length error below `tolerance`
/// were found; `x` then holds the best ones.
pub fn project_positions(
    model: &SheetModel,
    x: &mut [f64],
    tolerance: f64,
) -> Result<f64, StepError> {
    let linalg = |source| StepError::Linalg { t: 0.0, source };
    let mut matrix = PrimalMatrix::new(model).map_err(linalg)?;
    let mut effort = Effort::default();
    let strain =
        Projector::new(model).positions(model, &mut matrix, x, tolerance, 1000, &mut effort);
    if strain <= tolerance {
        Ok(strain)
    } else {
        Err(StepError::NotConverged {
            t: 0.0,
            h: 0.0,
            iterations: effort.iterations,
            residual: 0.0,
            strain,
        })
    }
}

/// The largest sub-step `2^-k` that may start after the fraction `done` of a step.
fn largest_fraction(done: f64) -> f64 {
    let mut fraction = 1.0;
    while (done / fraction).fract() != 0.0 {
        fraction *= 0.5;
    }
    fraction
}

/// Says why no step was accepted: dependent rods, if that is what they are.
fn diagnose(model: &SheetModel, state: &State, min_step: f64, cause: StepError) -> StepError {
    match rod_rank(model, &state.x) {
        Some(rank) if rank.smallest < DEPENDENT_RODS => StepError::RankDeficient {
            t: state.t,
            rank_deficiency: rank.deficiency,
            smallest_singular_value: rank.smallest,
        },
        _ => StepError::StepTooSmall {
            t: state.t,
            min_step,
            cause: Box::new(cause),
        },
    }
}

/// Smallest singular value (of the rigidity matrix with unit rods) below which dependence of
/// the rods is named as the reason of a failure: the referee integrations of the smoothest
/// known runs pass values down to 1e-6 only with steps of a microsecond.
const DEPENDENT_RODS: f64 = 1e-5;

fn energy(model: &SheetModel, state: &State) -> f64 {
    model.kinetic_energy(&state.v) + model.potential_energy(state.t, &state.x)
}

fn check_finite(state: &State) -> Result<(), StepError> {
    for values in [&state.x, &state.v] {
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return Err(StepError::NonFiniteState {
                vertex: VertexId((i / 3) as u32),
                value: values[i],
                t: state.t,
            });
        }
    }
    Ok(())
}

fn check_state(model: &SheetModel, state: &State) -> Result<(), StepError> {
    check_finite(state)?;
    let rods = model.rods();
    if rods.max_strain(&state.x) <= START_STRAIN {
        return Ok(());
    }
    let length = |e: usize| {
        let [a, b] = rods.edges()[e];
        (0..3)
            .map(|k| (state.x[3 * a + k] - state.x[3 * b + k]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let strain = |e: usize| (length(e) / rods.lengths()[e] - 1.0).abs();
    let worst = (0..rods.len())
        .max_by(|&a, &b| strain(a).total_cmp(&strain(b)))
        .unwrap_or(0);
    Err(StepError::OffConstraints {
        edge: EdgeId(worst as u32),
        length: length(worst),
        rest: rods.lengths()[worst],
        t: state.t,
    })
}
