//! A sheet in motion: state, integrator, step control and energy balance.

use crate::chart::{ChartDynamicsError, ChartOptions, ChartSimulation};
use crate::contact::{ActiveContacts, BodyLoad, Contact, ContactError, RunContact};
use crate::integrator::OptionsError;
use crate::reaction::Reaction;
use crate::report::{Path, StepError, StepReport};
use crate::start::{check_finite, check_motions, check_state};
use crate::subdivide::{Subdivided, Tally};
use crate::taut::held_by_lines;
use crate::{Method, SheetModel, State, StepControl};
use isosheet_coords::Chart;
use isosheet_coords::linalg::LinalgError;
use isosheet_mesh::VertexId;

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
    /// The chart cannot be used.
    #[error(transparent)]
    Chart(#[from] ChartDynamicsError),
    /// Contact cannot start here.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A one-sided constraint is in a scene of a conservative method.
    #[error(
        "vertex constraint {index} is one-sided, which the conservative methods have no place for: an \
         impact loses energy. Use BDF2, implicit Euler or projection"
    )]
    OneSided {
        /// Place in the order in which the constraints were added.
        index: usize,
    },
    /// Step control by subdivision was asked for a chart, which has its own.
    #[error(
        "a simulation in a chart controls its steps by `ChartOptions::control`; leave `StepControl` out"
    )]
    ChartControl,
}

/// A sheet in motion. Owns the model, the state and the integrator.
///
/// ```
/// use isosheet_dynamics::{Method, SheetModel, Simulation, State};
/// use isosheet_mesh::{MassKind, VertexId, generate};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(1, 0.21)?;
/// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
///     .with_gravity()
///     .with_pins(&[VertexId(20)])?;
/// let start = State::at_rest(sheet.positions().to_vec());
/// let mut simulation = Simulation::new(model, start, Method::default())?;
/// let report = simulation.step(1.0 / 60.0)?;
/// assert!(report.strain < 1e-12);
/// # Ok(())
/// # }
/// ```
pub struct Simulation {
    engine: Engine,
    state: State,
    force: Vec<f64>,
    start_energy: f64,
    work: f64,
    dissipated: f64,
    friction: f64,
}

enum Engine {
    Subdivided(Box<Subdivided>),
    Chart(Box<ChartEngine>),
}

struct ChartEngine {
    simulation: ChartSimulation,
    /// At the end of the last step.
    reactions: Vec<Reaction>,
}

impl Simulation {
    /// A simulation of `model` from `state` by one of the chart-free methods.
    ///
    /// Velocities of pinned vertices are set to zero, or to those of their motion. Vertices on a straight line of rods between two pins at
    /// rest cannot move either, and become pins: the upper edge of a banner that hangs by its corners. (The tension that would hold them against a
    /// force across the line is infinite; as pins they have a share of the reactions.)
    ///
    /// # Errors
    /// [`SimulationError`] if the options or the state make no sense, or the state does not
    /// have the rest lengths to 1e-8 (see [`project_positions`](crate::project_positions)).
    pub fn new(
        mut model: SheetModel,
        mut state: State,
        method: Method,
    ) -> Result<Self, SimulationError> {
        check_length(&model, &state)?;
        check_motions(&model, &state)?;
        model.clear_pinned(&mut state.v);
        model.set_pin_velocities(state.t, MOTION_SPAN, &mut state.v);
        check_state(&model, &state)?;
        let held = held_by_lines(&model, &state.x);
        model.hold(&held);
        held.iter()
            .for_each(|v| state.v[3 * v.index()..3 * v.index() + 3].fill(0.0));
        let engine = Engine::Subdivided(Box::new(Subdivided::new(model, method)?));
        Ok(Self::start(engine, state))
    }

    /// A simulation of `model` from `state` in system coordinates: the paper's scheme and its
    /// relatives (see [`chart`](crate::chart)).
    ///
    /// Of the velocities only the part that keeps the lengths is used. Supports that the chart does not eliminate are held by
    /// closure equations, see [`ChartSimulation::from_state`].
    ///
    /// # Errors
    /// [`SimulationError`] if the options or the state make no sense, or the chart is singular or
    /// too ill-conditioned at the state.
    pub fn in_chart(
        model: SheetModel,
        mut state: State,
        chart: Box<dyn Chart>,
        options: ChartOptions,
    ) -> Result<Self, SimulationError> {
        check_length(&model, &state)?;
        check_motions(&model, &state)?;
        check_state(&model, &state)?;
        let mut simulation = ChartSimulation::from_state(model, chart, options, &state)?;
        state.v = simulation.velocities()?;
        let reactions = Vec::new();
        let engine = Engine::Chart(Box::new(ChartEngine {
            simulation,
            reactions,
        }));
        Ok(Self::start(engine, state))
    }

    fn start(engine: Engine, state: State) -> Self {
        let mut simulation = Self {
            engine,
            force: vec![0.0; state.x.len()],
            state,
            start_energy: 0.0,
            work: 0.0,
            dissipated: 0.0,
            friction: 0.0,
        };
        simulation.start_energy = simulation.energy();
        simulation
    }

    /// Replaces the step control of a chart-free method.
    ///
    /// # Errors
    /// [`SimulationError`] if it makes no sense.
    pub fn with_control(mut self, control: StepControl) -> Result<Self, SimulationError> {
        match &mut self.engine {
            Engine::Subdivided(engine) => engine.set_control(control)?,
            Engine::Chart(_) => return Err(SimulationError::ChartControl),
        }
        Ok(self)
    }

    /// Adds contact with bodies and of the sheet with itself: a barrier that keeps every gap positive at every
    /// accepted step; in a chart impulses, see [`ChartSimulation::with_contact`].
    ///
    /// # Errors
    /// [`SimulationError::Contact`] if the method has no place for contact or something touches already.
    pub fn with_contact(
        mut self,
        contact: impl Contact + 'static,
    ) -> Result<Self, SimulationError> {
        match &mut self.engine {
            Engine::Subdivided(engine) => engine.set_contact(Box::new(contact), &self.state)?,
            Engine::Chart(chart) => chart.simulation.set_contact(Box::new(contact))?,
        }
        self.start_energy = self.energy();
        Ok(self)
    }

    /// The contacts at the present state; `None` in scenes without contact.
    pub fn contacts(&self) -> Option<&ActiveContacts> {
        match &self.engine {
            Engine::Subdivided(engine) => engine.contact.as_ref().map(|c| &c.state.active),
            Engine::Chart(chart) => chart.simulation.contacts(),
        }
    }

    /// What the sheet does to the bodies, in the order in which they were added; empty without contact, and in charts, where
    /// impulses act ([`ChartSimulation::impulses`]).
    pub fn body_loads(&self) -> Vec<BodyLoad> {
        self.barrier()
            .map_or_else(Vec::new, |c| c.loads(&self.state.x))
    }

    /// Contact that acts by its barrier.
    fn barrier(&self) -> Option<&RunContact> {
        match &self.engine {
            Engine::Subdivided(engine) => engine.contact.as_ref(),
            Engine::Chart(_) => None,
        }
    }

    /// Forces of the pins and vertex constraints on the sheet in the last accepted sub-step, pins first; empty before the first
    /// step. In charts those at the end of the step. See [`Balance`](crate::Balance) for when in the step they act and what they
    /// balance.
    ///
    /// For the damped methods this factorises a matrix of the size of a step's for every iteration of the last projection: ask only
    /// when the forces are wanted.
    pub fn reactions(&self) -> Vec<Reaction> {
        match &self.engine {
            Engine::Subdivided(engine) => {
                let balance = engine.balance.as_ref();
                balance.map_or_else(Vec::new, |b| b.reactions(&engine.model, self.state.t))
            }
            Engine::Chart(chart) => chart.reactions.clone(),
        }
    }

    /// The model.
    pub fn model(&self) -> &SheetModel {
        match &self.engine {
            Engine::Subdivided(engine) => &engine.model,
            Engine::Chart(chart) => chart.simulation.mechanics().model(),
        }
    }

    /// The simulation in system coordinates, if this is one: coordinates, momenta, step range.
    pub fn chart(&self) -> Option<&ChartSimulation> {
        match &self.engine {
            Engine::Subdivided(_) => None,
            Engine::Chart(chart) => Some(&chart.simulation),
        }
    }

    /// Time, positions and velocities.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Total energy `T + V`, contact included, joules.
    pub fn energy(&self) -> f64 {
        self.model().kinetic_energy(&self.state.v) + self.potential_energy()
    }

    fn potential_energy(&self) -> f64 {
        let State { t, x, .. } = &self.state;
        let potential = self.model().potential_energy(*t, x);
        match self.barrier() {
            None => potential,
            Some(contact) => potential + contact.barrier_energy(),
        }
    }

    /// Advances by exactly `h` seconds, in sub-steps where the integrator rejects the whole or,
    /// in a chart, where its own step control asks for them.
    ///
    /// # Errors
    /// [`StepError`]; the state is then that of the last accepted sub-step.
    pub fn step(&mut self, h: f64) -> Result<StepReport, StepError> {
        let start = self.state.t;
        check_finite(&self.state)?;
        if !(h.is_finite() && h > 0.0) || start + h <= start {
            return Err(StepError::StepSize { h, t: start });
        }
        self.check_forces()?;
        let end = start + h;
        let mut tally = Tally::default();
        let done = match &mut self.engine {
            Engine::Subdivided(engine) => engine.advance(&mut self.state, h, &mut tally),
            Engine::Chart(chart) => advance_chart(chart, &mut self.state, end, &mut tally),
        };
        self.work += tally.work;
        self.dissipated += tally.dissipated;
        self.friction += tally.friction;
        done?;
        if tally.taut.is_none() {
            self.state.t = end;
        }
        let end = self.state.t;
        let model = self.model();
        let kinetic = model.kinetic_energy(&self.state.v);
        let potential = self.potential_energy();
        for (quantity, value) in [
            ("the potential energy", potential),
            ("the kinetic energy", kinetic),
            ("the work of the applied forces", self.work),
        ] {
            if !value.is_finite() {
                return Err(StepError::NonFiniteEnergy {
                    quantity,
                    value,
                    t: end,
                });
            }
        }
        Ok(StepReport {
            t: end,
            h,
            substeps: tally.substeps,
            rejected: tally.rejected,
            iterations: tally.effort.iterations,
            factorisations: tally.effort.factorisations,
            residual: tally.residual,
            kinetic,
            potential,
            work: self.work,
            dissipated: self.dissipated,
            friction: self.friction,
            energy_drift: kinetic + potential - self.work + self.dissipated + self.friction
                - self.start_energy,
            strain: model.rods().max_strain(&self.state.x),
            taut: tally.taut,
            violation: model.largest_violation(self.state.t, &self.state.x),
            gap: self.contacts().map(ActiveContacts::gap),
            path: tally.path,
        })
    }

    /// Refuses potentials and forces that are not finite at the state.
    fn check_forces(&mut self) -> Result<(), StepError> {
        let mut sum = std::mem::take(&mut self.force);
        let State { t, x, v } = &self.state;
        let model = self.model();
        model.potential_force(*t, x, &mut sum);
        for force in model.forces() {
            force.add_force(*t, x, v, &mut sum);
        }
        let bad = sum.iter().position(|f| !f.is_finite());
        let result = match bad {
            None => Ok(()),
            Some(i) => Err(StepError::NonFiniteForce {
                vertex: VertexId((i / 3) as u32),
                value: sum[i],
                t: *t,
            }),
        };
        self.force = sum;
        result
    }
}

/// Over parts of this time (seconds) the velocities of moving pins at the start are taken by differences.
const MOTION_SPAN: f64 = 1e-2;

/// Sub-steps shorter than this fraction of the time reached are round-off, not time.
const TIME_ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Advances a simulation in a chart to `end`.
fn advance_chart(
    engine: &mut ChartEngine,
    state: &mut State,
    end: f64,
    tally: &mut Tally,
) -> Result<(), StepError> {
    let chart = &mut engine.simulation;
    tally.path = Path::Chart;
    let failed = |t: f64, source: ChartDynamicsError| StepError::Chart {
        t,
        source: Box::new(source),
    };
    let has_forces = !chart.mechanics().model().forces().is_empty();
    let mut applied = vec![0.0; if has_forces { state.x.len() } else { 0 }];
    let limit = chart.options().max_steps;
    let outcome = loop {
        let left = end - chart.time();
        if left <= TIME_ROUND_OFF * end.abs() {
            break Ok(());
        }
        if tally.substeps + tally.rejected >= limit {
            let t = chart.time();
            break Err(failed(t, ChartDynamicsError::TooManySteps { t, limit }));
        }
        if has_forces {
            let v = match chart.velocities() {
                Ok(v) => v,
                Err(error) => break Err(failed(chart.time(), error)),
            };
            let model = chart.mechanics().model();
            model.applied_force(chart.time(), chart.positions(), &v, &mut applied);
            state.x.copy_from_slice(chart.positions());
        }
        let report = match chart.step_within(left) {
            Ok(report) => report,
            Err(error) => break Err(failed(chart.time(), error)),
        };
        tally.substeps += 1;
        tally.rejected += report.rejected as usize;
        tally.work += report.driven;
        tally.dissipated += report.damped;
        tally.friction += report.impact;
        tally.path = tally.path.max(if report.rebased {
            Path::Rebased
        } else {
            Path::Chart
        });
        if has_forces {
            tally.work += applied
                .iter()
                .zip(chart.positions().iter().zip(&state.x))
                .map(|(f, (new, old))| f * (new - old))
                .sum::<f64>();
        }
    };
    state.t = chart.time();
    state.x.copy_from_slice(chart.positions());
    state.v = chart.velocities().map_err(|e| failed(state.t, e))?;
    if chart.mechanics().model().has_supports() {
        engine.reactions = chart.reactions().map_err(|e| failed(state.t, e))?;
    }
    outcome
}

fn check_length(model: &SheetModel, state: &State) -> Result<(), SimulationError> {
    let expected = model.coordinate_count();
    if state.x.len() == expected && state.v.len() == expected {
        Ok(())
    } else {
        Err(SimulationError::StateLength {
            positions: state.x.len(),
            velocities: state.v.len(),
            expected,
        })
    }
}
