//! Explicit integration in a chart, with the published step control.

use super::mechanics::ReplacedChart;
use super::state::{ChartState, StepRange};
use super::stepping::{PhaseState, Stepper};
use super::{ChartDynamicsError, ChartMechanics, ChartOptions, ChartStepControl, Rebase};
use isosheet_coords::{Chart, ChartError, mass_condition_estimate};
use isosheet_dynamics::Memories;
use isosheet_dynamics::Reaction;
use isosheet_dynamics::engine::{Balance, ForceTime};
use isosheet_dynamics::{SheetModel, State};

/// What one step did.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ChartStepReport {
    /// Time after the step, seconds.
    pub t: f64,
    /// Step taken, seconds.
    pub h: f64,
    /// Attempts rejected before it.
    pub rejected: u32,
    /// Kinetic energy after the step, joules.
    pub kinetic: f64,
    /// Potential energy after the step, joules.
    pub potential: f64,
    /// Change of the Hamiltonian over the step, before velocity damping, joules.
    pub energy_change: f64,
    /// Energy taken out by velocity damping, joules.
    pub damped: f64,
    /// Largest edge strain after the step.
    pub strain: f64,
    /// Work done over the step by moving pins and vertex constraints, joules.
    pub driven: f64,
    /// Whether the chart was rebased before the step.
    pub rebased: bool,
}

/// A sheet moving in a chart.
pub struct ChartSimulation {
    pub(super) stepper: Stepper,
    pub(super) options: ChartOptions,
    pub(super) motion: ChartState,
    /// The chart at the start of the present step, if the step has replaced it.
    pub(super) replaced: Option<ReplacedChart>,
}

impl ChartSimulation {
    /// Start at time zero at positions x with velocities v, three values per vertex. See
    /// [`ChartSimulation::from_state`].
    ///
    /// # Errors
    /// As [`ChartSimulation::from_state`].
    pub fn new(
        model: SheetModel,
        chart: Box<dyn Chart>,
        options: ChartOptions,
        x: &[f64],
        v: &[f64],
    ) -> Result<Self, ChartDynamicsError> {
        let start = State::moving(x.to_vec(), v.to_vec());
        Self::from_state(model, chart, options, &start)
    }

    /// Start from a state. Only the part of the velocities that keeps edge lengths and closures is used.
    ///
    /// The chart eliminates all fixed pins of the model or some of them. The others, moving pins and vertices
    /// on curves and surfaces are closure equations `Phi(x(q), t) = 0`: multipliers in the equations
    /// of motion from their second derivative in time, and after every step positions and momenta are brought
    /// back onto them, the nearest ones in the mass metric. Equations that depend on others, as for two pins
    /// at the ends of one rod, are met by least squares.
    ///
    /// # Errors
    /// Invalid options; a state with the wrong edge lengths or off its supports;
    /// [`ChartDynamicsError::Chart`] for states where the chart is singular (flat sheets) or too
    /// ill-conditioned; [`ChartDynamicsError::OneSided`], [`ChartDynamicsError::Elastic`],
    /// [`ChartDynamicsError::Plastic`], [`ChartDynamicsError::Damping`].
    pub fn from_state(
        model: SheetModel,
        chart: Box<dyn Chart>,
        options: ChartOptions,
        start: &State,
    ) -> Result<Self, ChartDynamicsError> {
        options.validate()?;
        check_start(&model, start)?;
        let State { t, x, v } = start;
        let t = *t;
        let mut mechanics = ChartMechanics::new(model, chart, options.solver)?;
        let strain = mechanics.system().max_strain(x);
        if strain > options.strain_limit {
            return Err(ChartDynamicsError::Strained {
                strain,
                limit: options.strain_limit,
            });
        }
        let n = mechanics.dimension();
        let (mut q, mut p) = (vec![0.0; n], vec![0.0; n]);
        mechanics.at(x)?;
        mechanics.coordinates(x, &mut q)?;
        let mut tangent = v.to_vec();
        mechanics.model().clear_pinned(&mut tangent);
        mechanics.momenta(&tangent, &mut p)?;
        let mut stepper = Stepper::new(mechanics, &options, x)?;
        if stepper.mobility.is_closed() {
            stepper
                .mobility
                .check(&stepper.mechanics, t, x, options.strain_limit)?;
        }
        let step = match options.control {
            ChartStepControl::Fixed(h) => h,
            ChartStepControl::Adaptive { max, .. } => max,
        };
        stepper.close_momenta((t, step), x, &mut p)?;
        let hamiltonian = stepper.mechanics.hamiltonian(t, x, &p)?;
        let x = x.clone();
        let state = PhaseState {
            x,
            q,
            p,
            hamiltonian,
        };
        let pins = stepper.mobility.pin_positions();
        let mut simulation = Self {
            motion: ChartState::start(t, state, step, pins),
            stepper,
            options,
            replaced: None,
        };
        simulation.check_condition()?;
        simulation.stepper.set_reference()?;
        if simulation.mechanics().model().has_drives() {
            simulation.motion.balance = Some(simulation.new_balance(step)?);
        }
        Ok(simulation)
    }

    /// Forces of the supports at the present state, motions differentiated over parts of the time `span`.
    fn new_balance(&mut self, span: f64) -> Result<Balance, ChartDynamicsError> {
        let mut balance = Balance::new(self.stepper.mechanics.model(), ForceTime::End);
        self.stepper
            .balance((self.motion.t, span), &self.motion.state, &mut balance)?;
        Ok(balance)
    }

    /// Forces of the pins and vertex constraints on the sheet at the present state, pins first, from
    /// Hamilton's equations with all multipliers. Where closures depend on each other how they share a force
    /// is arbitrary (the shortest multipliers in the mass metric); the sums are not.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] where the chart is singular.
    pub fn reactions(&mut self) -> Result<Vec<Reaction>, ChartDynamicsError> {
        let balance = match &self.motion.balance {
            Some(balance) => balance.clone(),
            None => self.new_balance(self.motion.next_step)?,
        };
        Ok(balance.reactions(self.stepper.mechanics.model(), self.motion.t))
    }

    /// Time, seconds.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.motion.t
    }

    /// Positions, three per vertex.
    #[must_use]
    pub fn positions(&self) -> &[f64] {
        &self.motion.state.x
    }

    /// Coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &[f64] {
        &self.motion.state.q
    }

    /// Momenta.
    #[must_use]
    pub fn momenta(&self) -> &[f64] {
        &self.motion.state.p
    }

    /// The Hamiltonian, joules.
    #[must_use]
    pub fn hamiltonian(&self) -> f64 {
        self.motion.hamiltonian
    }

    /// Smallest and largest step so far.
    #[must_use]
    pub fn step_range(&self) -> StepRange {
        self.motion.range.unwrap_or(StepRange {
            min: f64::INFINITY,
            max: 0.0,
            steps: 0,
        })
    }

    /// The options.
    #[must_use]
    pub fn options(&self) -> &ChartOptions {
        &self.options
    }

    /// The mechanics.
    #[must_use]
    pub fn mechanics(&self) -> &ChartMechanics {
        &self.stepper.mechanics
    }

    /// Velocities of the vertices.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] where the chart is singular.
    pub fn velocities(&mut self) -> Result<Vec<f64>, ChartDynamicsError> {
        self.stepper.velocities(&self.motion.state)
    }

    /// Estimate the condition number of C; above the limit rebase once, then refuse.
    pub(super) fn check_condition(&mut self) -> Result<(), ChartDynamicsError> {
        self.motion.since_check = 0;
        loop {
            let m = &self.stepper.mechanics;
            let condition = mass_condition_estimate(
                m.system(),
                m.chart(),
                m.model().mass(),
                &self.motion.state.x,
            )?;
            // NaN counts as too large.
            if condition <= self.options.condition_limit {
                return Ok(());
            }
            if self.motion.is_fresh || self.options.rebase == Rebase::Never {
                return Err(ChartError::IllConditioned {
                    condition,
                    limit: self.options.condition_limit,
                }
                .into());
            }
            self.rebase()?;
        }
    }

    pub(super) fn rebase(&mut self) -> Result<(), ChartDynamicsError> {
        let v = self.stepper.velocities(&self.motion.state)?;
        let before = self.stepper.mechanics.rebase(&self.motion.state.x)?;
        self.replaced.get_or_insert(before);
        self.stepper.enter(&mut self.motion.state, &v)?;
        self.motion.reference = Some(self.motion.state.x.clone());
        self.motion.growth = 1.0;
        self.motion.is_fresh = true;
        Ok(())
    }

    /// What the potentials remember.
    pub(crate) fn memories(&self) -> &Memories {
        self.stepper.mechanics.memories()
    }

    /// What the potentials remember.
    pub(crate) fn memories_mut(&mut self) -> &mut Memories {
        self.stepper.mechanics.memories_mut()
    }

    /// Velocity damping over `h`; returns the potential energy.
    pub(super) fn damp(&mut self, h: f64) -> Result<f64, ChartDynamicsError> {
        let (model, memories) = (self.stepper.mechanics.model(), self.memories());
        let rate = model.damping().ok_or(ChartDynamicsError::Damping)?;
        let damping = (-rate * h).exp();
        let potential = model.energy_with(memories, self.motion.t, &self.motion.state.x);
        let kinetic = self.motion.state.hamiltonian - potential;
        let driven = model.has_drives();
        self.motion.state.p.iter_mut().for_each(|p| *p *= damping);
        self.motion.hamiltonian = potential + kinetic * damping * damping;
        if driven && damping < 1.0 {
            // Moving supports keep their velocities.
            let PhaseState { x, p, .. } = &mut self.motion.state;
            self.stepper.close_momenta((self.motion.t, h), x, p)?;
            self.motion.hamiltonian = self.stepper.mechanics.hamiltonian(self.motion.t, x, p)?;
        }
        self.motion.state.hamiltonian = self.motion.hamiltonian;
        Ok(potential)
    }

    /// Work of moving supports over the step that ends now.
    pub(super) fn drive_work(
        &mut self,
        start: (f64, &[f64]),
        h: f64,
    ) -> Result<f64, ChartDynamicsError> {
        if self.motion.balance.is_none() {
            return Ok(0.0);
        }
        let after = self.new_balance(h)?;
        let model = self.stepper.mechanics.model();
        let end = (self.motion.t, &*self.motion.state.x);
        let work = after.drive_work(model, self.motion.balance.as_ref(), start, end);
        self.motion.balance = Some(after);
        Ok(work)
    }
}

/// Refuses a state of the wrong length or with values that are not finite, and supports that a chart cannot
/// have.
fn check_start(model: &SheetModel, start: &State) -> Result<(), ChartDynamicsError> {
    if model.has_limit() {
        return Err(ChartDynamicsError::Elastic);
    }
    if model.can_yield() {
        return Err(ChartDynamicsError::Plastic);
    }
    if model.needs_minimising() {
        return Err(ChartDynamicsError::NeedsMinimising);
    }
    if model.damping().is_none() {
        return Err(ChartDynamicsError::Damping);
    }
    let State { t, x, v } = start;
    for (what, slice) in [("x", x), ("v", v)] {
        if slice.len() != model.coordinate_count() {
            return Err(ChartDynamicsError::WrongLength {
                what,
                found: slice.len(),
                expected: model.coordinate_count(),
            });
        }
    }
    if !(t.is_finite() && x.iter().chain(v).all(|c| c.is_finite())) {
        return Err(ChartDynamicsError::NotFinite { t: *t });
    }
    match model.constraints().iter().position(|c| c.is_one_sided()) {
        Some(index) => Err(ChartDynamicsError::OneSided { index }),
        None => Ok(()),
    }
}
