//! Explicit integration in a chart, with the published step control.

use super::contact::ChartContact;
use super::stepping::{Stepper, Trial};
use super::{
    ChartDynamicsError, ChartMechanics, ChartOptions, ChartStepControl, ContactImpulse, Rebase,
};
use crate::contact::{ActiveContacts, Contact, ContactError, StepSpan};
use crate::reaction::{Balance, ForceTime, Reaction};
use crate::{SheetModel, State};
use isosheet_coords::{Chart, ChartError, mass_condition_estimate};

/// What one step did.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Change of the Hamiltonian over the step, before impacts and velocity damping, joules.
    pub energy_change: f64,
    /// Energy taken out by velocity damping, joules.
    pub damped: f64,
    /// Energy lost in the impacts at the end of the step, joules; not negative.
    pub impact: f64,
    /// Smallest gap after the step, metres; `None` without contact.
    pub gap: Option<f64>,
    /// Largest edge strain after the step.
    pub strain: f64,
    /// Work done over the step by moving pins and vertex constraints, and by moving bodies in impacts, joules.
    pub driven: f64,
    /// Whether the chart was rebased before the step.
    pub rebased: bool,
}

/// Smallest and largest step of a run: the column "Step size min/max" of Fig. 10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRange {
    /// Smallest, seconds.
    pub min: f64,
    /// Largest, seconds.
    pub max: f64,
    /// Number of steps.
    pub steps: u64,
}

/// A sheet moving in a chart.
pub struct ChartSimulation {
    stepper: Stepper,
    options: ChartOptions,
    t: f64,
    state: Trial,
    hamiltonian: f64,
    next_step: f64,
    range: StepRange,
    since_check: u32,
    growth: f64,
    fresh: bool,
    /// Forces of the supports now, in scenes where they move.
    balance: Option<Balance>,
    contact: Option<ChartContact>,
    impulses: Vec<ContactImpulse>,
}

/// Gaps below this part of the activation distance are opened to it: the curvature of the path brings a sheet that lies or
/// slides closer by the squared step each step, which no impulse sees.
const LEAST_GAP: f64 = 0.1;

/// Part of the planned step below which contact does not shorten a step, and how often it may.
const SHORTEST_CUT: f64 = 1e-10;
const MOST_CUTS: u32 = 100;

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
    /// The chart eliminates all fixed pins of the model or some of them. The others, moving pins and vertices on curves and
    /// surfaces are held by closure equations `Phi(x(q), t) = 0`: multipliers in the equations of motion from their second
    /// derivative in time, and after every step positions and momenta are brought back onto them, the nearest ones in the mass metric.
    /// Equations that depend on others, as for two pins at the ends of one rod, are met by least squares.
    ///
    /// # Errors
    /// Invalid options; a state with the wrong edge lengths or off its supports; [`ChartDynamicsError::Chart`] for states
    /// where the chart is singular (flat sheets) or too ill-conditioned; [`ChartDynamicsError::OneSided`].
    pub fn from_state(
        model: SheetModel,
        chart: Box<dyn Chart>,
        options: ChartOptions,
        start: &State,
    ) -> Result<Self, ChartDynamicsError> {
        let State { t, x, v } = start;
        let t = *t;
        options.validate()?;
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
            return Err(ChartDynamicsError::NotFinite { t });
        }
        if let Some(index) = model.constraints().iter().position(|c| c.is_one_sided()) {
            return Err(ChartDynamicsError::OneSided { index });
        }
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
        let mut simulation = Self {
            stepper,
            options,
            t,
            state: Trial {
                x: x.to_vec(),
                q,
                p,
                hamiltonian,
            },
            hamiltonian,
            next_step: step,
            range: StepRange {
                min: f64::INFINITY,
                max: 0.0,
                steps: 0,
            },
            since_check: 0,
            growth: 1.0,
            fresh: true,
            balance: None,
            contact: None,
            impulses: Vec::new(),
        };
        simulation.check_condition()?;
        simulation.stepper.set_reference()?;
        if simulation.mechanics().model().has_drives() {
            simulation.balance = Some(simulation.new_balance(step)?);
        }
        Ok(simulation)
    }

    /// Adds contact with bodies and of the sheet with itself, by impulses on the momenta.
    ///
    /// The paper applies collision forces to momenta and does not say how; this is our choice. A step whose
    /// displacement is not proven free of contact ([`crate::contact::ContactSet::safe_fraction`]) is taken anew as short as that
    /// allows, so that every gap stays positive. At the end of each step all contacts within the activation distance that approach
    /// get impulses together, `p += J^T R^T l`, with [`ChartOptions::restitution`] and Coulomb friction with the kinetic
    /// coefficient, of which the energy never grows. The barrier of the contact is not used; a sheet rebounds at gaps
    /// below its activation distance: choose that small. Gaps that the curvature of the path has closed to a tenth of it are
    /// opened to that again.
    ///
    /// A sheet that lies on a body keeps still in forward Euler, the paper's method, which moves with the momenta that the impulses
    /// left. The other methods move with what forces make of them in the step, and creep by the acceleration along the body
    /// times the squared step, each step, against friction too.
    ///
    /// Reactions do not contain the impulses that supports answer impacts with, nor does the work of moving pins.
    ///
    /// # Errors
    /// [`ContactError`] if something touches already or the contact belongs to another sheet.
    pub fn with_contact(mut self, contact: impl Contact + 'static) -> Result<Self, ContactError> {
        self.set_contact(Box::new(contact))?;
        Ok(self)
    }

    pub(crate) fn set_contact(&mut self, contact: Box<dyn Contact>) -> Result<(), ContactError> {
        let mut state = State::at_rest(self.state.x.clone());
        state.t = self.t;
        let model = self.stepper.mechanics.model();
        self.contact = Some(ChartContact::new(contact, model, &state)?);
        Ok(())
    }

    /// The contacts at the present state; `None` in scenes without contact.
    #[must_use]
    pub fn contacts(&self) -> Option<&ActiveContacts> {
        self.contact.as_ref().map(ChartContact::active)
    }

    /// The impulses of contacts at the end of the last step, zero ones of contacts that do not press included; empty if nothing
    /// approached.
    #[must_use]
    pub fn impulses(&self) -> &[ContactImpulse] {
        &self.impulses
    }

    /// Forces of the supports at the present state, motions differentiated over parts of the time `span`.
    fn new_balance(&mut self, span: f64) -> Result<Balance, ChartDynamicsError> {
        let mut balance = Balance::new(self.stepper.mechanics.model(), ForceTime::End);
        self.stepper
            .balance((self.t, span), &self.state, &mut balance)?;
        Ok(balance)
    }

    /// Forces of the pins and vertex constraints on the sheet at the present state, pins first, from Hamilton's equations with all
    /// multipliers. Where closures depend on each other how they share a force is arbitrary (the shortest multipliers in
    /// the mass metric); the sums are not.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] where the chart is singular.
    pub fn reactions(&mut self) -> Result<Vec<Reaction>, ChartDynamicsError> {
        let balance = match &self.balance {
            Some(balance) => balance.clone(),
            None => self.new_balance(self.next_step)?,
        };
        Ok(balance.reactions(self.stepper.mechanics.model(), self.t))
    }

    /// Time, seconds.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.t
    }

    /// Positions, three per vertex.
    #[must_use]
    pub fn positions(&self) -> &[f64] {
        &self.state.x
    }

    /// Coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &[f64] {
        &self.state.q
    }

    /// Momenta.
    #[must_use]
    pub fn momenta(&self) -> &[f64] {
        &self.state.p
    }

    /// The Hamiltonian, joules.
    #[must_use]
    pub fn hamiltonian(&self) -> f64 {
        self.hamiltonian
    }

    /// Smallest and largest step so far.
    #[must_use]
    pub fn step_range(&self) -> StepRange {
        self.range
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
        self.stepper.velocities(&self.state)
    }

    /// Estimate the condition number of C; above the limit rebase once, then refuse.
    fn check_condition(&mut self) -> Result<(), ChartDynamicsError> {
        self.since_check = 0;
        loop {
            let m = &self.stepper.mechanics;
            let condition =
                mass_condition_estimate(m.system(), m.chart(), m.model().mass(), &self.state.x)?;
            // NaN counts as too large.
            if condition <= self.options.condition_limit {
                return Ok(());
            }
            if self.fresh || self.options.rebase == Rebase::Never {
                return Err(ChartError::IllConditioned {
                    condition,
                    limit: self.options.condition_limit,
                }
                .into());
            }
            self.rebase()?;
        }
    }

    fn rebase(&mut self) -> Result<(), ChartDynamicsError> {
        self.stepper.rebase(&mut self.state)?;
        self.growth = 1.0;
        self.fresh = true;
        Ok(())
    }

    /// Take one step.
    ///
    /// # Errors
    /// [`ChartDynamicsError::StepTooSmall`] of the step control; with a fixed step the error of the step
    /// itself. The state is that before the step then.
    pub fn step(&mut self) -> Result<ChartStepReport, ChartDynamicsError> {
        self.step_within(f64::INFINITY)
    }

    /// As [`ChartSimulation::step`], of at most `limit` seconds. A step cut short by the limit does not
    /// enter [`ChartSimulation::step_range`] and leaves the step control where it was.
    ///
    /// # Errors
    /// As [`ChartSimulation::step`].
    pub fn step_within(&mut self, limit: f64) -> Result<ChartStepReport, ChartDynamicsError> {
        let mut rebased = false;
        let rebasing = self.options.rebase == Rebase::WhenNeeded;
        if rebasing && !self.fresh {
            let margin = self.stepper.mechanics.chart().margin(&self.state.x)?;
            if margin < self.options.margin_limit || self.growth > self.options.growth_limit {
                self.rebase()?;
                rebased = true;
            }
        }
        if self.since_check >= self.options.condition_interval {
            self.check_condition()?;
        }
        let mut rejected = 0;
        let planned = self.next_step;
        let mut h = planned.min(limit);
        let cut_short = h < planned;
        let mut cuts = 0;
        let trial = loop {
            let outcome = self.stepper.attempt(self.t, &self.state, h);
            if let (Ok(trial), Some(contact)) = (&outcome, &mut self.contact) {
                let span = StepSpan { t0: self.t, h };
                let part = contact.safe_fraction(span, &self.state.x, &trial.x);
                if part < 1.0 {
                    cuts += 1;
                    h *= part;
                    if h < SHORTEST_CUT * planned || cuts > MOST_CUTS {
                        return Err(ChartDynamicsError::Contact { t: self.t, h });
                    }
                    continue;
                }
            }
            let change = match &outcome {
                Ok(trial) => (trial.hamiltonian - self.hamiltonian).abs(),
                Err(_) => f64::NAN,
            };
            match (self.options.control, outcome) {
                (ChartStepControl::Fixed(_), Ok(trial)) => break trial,
                (ChartStepControl::Adaptive { tolerance, max, .. }, Ok(trial))
                    if change < tolerance =>
                {
                    let growth = (0.9 * (tolerance / change).sqrt()).clamp(1.0, 2.0);
                    self.next_step = if cuts > 0 || cut_short && rejected == 0 {
                        planned
                    } else {
                        (h * growth).min(max)
                    };
                    break trial;
                }
                (_, Err(ChartDynamicsError::Chart(_))) if rebasing && !self.fresh => {
                    self.rebase()?;
                    rebased = true;
                }
                (ChartStepControl::Fixed(_), Err(e)) => return Err(e),
                (ChartStepControl::Adaptive { tolerance, min, .. }, outcome) => {
                    if h <= min {
                        return Err(ChartDynamicsError::StepTooSmall {
                            t: self.t,
                            minimum: min,
                            tolerance,
                            change,
                            cause: match outcome {
                                Ok(_) => "the change is too large".to_owned(),
                                Err(e) => e.to_string(),
                            },
                        });
                    }
                    let factor = 0.9 * (tolerance / change).sqrt();
                    let factor = if factor.is_nan() { 0.25 } else { factor };
                    h = (h * factor.clamp(0.1, 0.9)).max(min);
                    rejected += 1;
                }
            }
        };
        let strain = self.stepper.mechanics.system().max_strain(&trial.x);
        if strain > self.options.failure_strain {
            return Err(ChartDynamicsError::Diverged {
                t: self.t + h,
                strain,
                limit: self.options.failure_strain,
            });
        }
        self.growth = self.stepper.growth()?;
        let energy_change = trial.hamiltonian - self.hamiltonian;
        let start = (self.t, std::mem::replace(&mut self.state, trial));
        self.t += h;
        self.fresh = false;
        self.since_check += 1;
        let mut driven = self.drive_work((start.0, &start.1.x), h)?;
        let mut impact = 0.0;
        if let Some(mut contact) = self.contact.take() {
            let outcome = self.impact(&mut contact, h);
            self.contact = Some(contact);
            let [loss, work] = outcome?;
            impact = loss;
            driven += work;
        }
        let before_damping = self.state.hamiltonian;
        let potential = self.damp(h)?;
        if cuts == 0 && (!cut_short || rejected > 0) {
            self.range.min = self.range.min.min(h);
            self.range.max = self.range.max.max(h);
            self.range.steps += 1;
        }
        Ok(ChartStepReport {
            t: self.t,
            h,
            rejected,
            kinetic: self.hamiltonian - potential,
            potential,
            energy_change,
            damped: before_damping - self.hamiltonian,
            impact,
            gap: self.contacts().map(ActiveContacts::gap),
            strain: self.stepper.mechanics.system().max_strain(&self.state.x),
            driven,
            rebased,
        })
    }

    /// Impacts at the end of a step: energy lost and work of the bodies.
    fn impact(
        &mut self,
        contact: &mut ChartContact,
        h: f64,
    ) -> Result<[f64; 2], ChartDynamicsError> {
        self.impulses.clear();
        contact.evaluate(&self.state.x);
        let least = LEAST_GAP * contact.activation();
        if contact.points().iter().any(|p| p.gap < least) {
            let points = contact.points();
            let opened = self.stepper.opened(self.t, &self.state, points, least);
            let span = StepSpan { t0: self.t, h: 0.0 };
            // Where this is not possible the collision detection still holds.
            if let Ok(opened) = opened
                && contact.safe_fraction(span, &self.state.x, &opened.x) >= 1.0
            {
                self.state = opened;
                contact.evaluate(&self.state.x);
            }
            self.stepper.mechanics.at(&self.state.x)?;
        }
        let mut done = [0.0; 2];
        if !contact.points().is_empty() {
            let (time, e) = ((self.t, h), self.options.restitution);
            let points = contact.points();
            if let Some(impact) = self.stepper.impact(time, &mut self.state, points, e)? {
                self.impulses = impact.impulses;
                done = [impact.loss, impact.driven];
            }
        }
        Ok(done)
    }

    /// Velocity damping over `h`; returns the potential energy.
    fn damp(&mut self, h: f64) -> Result<f64, ChartDynamicsError> {
        let model = self.stepper.mechanics.model();
        let damping = (-model.damping() * h).exp();
        let potential = model.potential_energy(self.t, &self.state.x);
        let kinetic = self.state.hamiltonian - potential;
        let driven = model.has_drives();
        self.state.p.iter_mut().for_each(|p| *p *= damping);
        self.hamiltonian = potential + kinetic * damping * damping;
        if driven && damping < 1.0 {
            // Moving supports keep their velocities.
            let Trial { x, p, .. } = &mut self.state;
            self.stepper.close_momenta((self.t, h), x, p)?;
            self.hamiltonian = self.stepper.mechanics.hamiltonian(self.t, x, p)?;
        }
        self.state.hamiltonian = self.hamiltonian;
        Ok(potential)
    }

    /// Work of moving supports over the step that ends now.
    fn drive_work(&mut self, start: (f64, &[f64]), h: f64) -> Result<f64, ChartDynamicsError> {
        if self.balance.is_none() {
            return Ok(0.0);
        }
        let after = self.new_balance(h)?;
        let model = self.stepper.mechanics.model();
        let end = (self.t, &*self.state.x);
        let work = after.drive_work(model, self.balance.as_ref(), start, end);
        self.balance = Some(after);
        Ok(work)
    }
}
