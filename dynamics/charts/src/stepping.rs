//! One step of each method.

use super::mobility::Mobility;
use super::{ChartDynamicsError, ChartMechanics, Equations};
use super::{ChartMethod, ChartOptions, PositionUpdate};
use isosheet_dynamics::engine::Balance;
use serde::{Deserialize, Serialize};

/// Power iterations after a rebase; later ones start from the last vector, one per step.
const POWER_STEPS: usize = 6;

/// A state in phase space, with the positions that belong to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct PhaseState {
    pub(super) x: Vec<f64>,
    pub(super) q: Vec<f64>,
    pub(super) p: Vec<f64>,
    pub(super) hamiltonian: f64,
}

/// The methods, over a mechanics.
pub(super) struct Stepper {
    pub(super) mechanics: ChartMechanics,
    method: ChartMethod,
    equations: Equations,
    position: PositionUpdate,
    pub(super) mobility: Mobility,
    /// Power iteration vector on C, and the eigenvalue found at the reference state of the chart.
    power: Vec<f64>,
    reference: f64,
}

impl Stepper {
    /// With the fixed pins where they are at `x`.
    pub(super) fn new(
        mechanics: ChartMechanics,
        options: &ChartOptions,
        x: &[f64],
    ) -> Result<Self, ChartDynamicsError> {
        let n = mechanics.dimension();
        Ok(Self {
            power: (0..n).map(|k| 1.0 + (1.3 * k as f64).sin()).collect(),
            reference: f64::NAN,
            mobility: Mobility::new(&mechanics, x)?,
            mechanics,
            method: options.method,
            equations: options.equations,
            position: options.position,
        })
    }

    pub(super) fn velocities(&mut self, s: &PhaseState) -> Result<Vec<f64>, ChartDynamicsError> {
        let mut qdot = vec![0.0; s.q.len()];
        let mut v = vec![0.0; s.x.len()];
        self.mechanics.at(&s.x)?;
        self.mechanics.velocity(&s.p, &mut qdot, &mut v)?;
        Ok(v)
    }

    /// Sets coordinates and momenta of `s`, the reference state, to those in a new chart, given the
    /// velocities.
    pub(super) fn enter(
        &mut self,
        s: &mut PhaseState,
        v: &[f64],
    ) -> Result<(), ChartDynamicsError> {
        self.mechanics.at(&s.x)?;
        self.mechanics.coordinates(&s.x, &mut s.q)?;
        self.mechanics.momenta(v, &mut s.p)?;
        self.set_reference()
    }

    /// Remember the largest eigenvalue of C at the current state, the chart's reference.
    pub(super) fn set_reference(&mut self) -> Result<(), ChartDynamicsError> {
        for _ in 0..POWER_STEPS {
            self.reference = self.mechanics.power_step(&mut self.power)?;
        }
        Ok(())
    }

    /// Largest eigenvalue of C at the state the mechanics is at, over its value at the reference state.
    /// It grows without bound where the chart becomes singular.
    pub(super) fn growth(&mut self) -> Result<f64, ChartDynamicsError> {
        Ok(self.mechanics.power_step(&mut self.power)? / self.reference)
    }

    /// The largest eigenvalue of C at the reference state, and the vector of the power iteration.
    pub(super) fn power(&self) -> (f64, &[f64]) {
        (self.reference, &self.power)
    }

    /// Sets what [`Stepper::power`] returns.
    pub(super) fn set_power(&mut self, eigenvalue: f64, vector: &[f64]) {
        self.reference = eigenvalue;
        self.power.clear();
        self.power.extend_from_slice(vector);
    }

    /// Factorise what the rates at a state need.
    fn open(&mut self, t: f64, x: &[f64]) -> Result<(), ChartDynamicsError> {
        self.mechanics.at(x)?;
        if self.mobility.is_closed() {
            self.mobility.at(&self.mechanics, t, x)?;
        }
        Ok(())
    }

    /// `pdot` with the multipliers of the closures, at the state given to [`Stepper::open`]. Motions of
    /// supports are differentiated over parts of the time `span`.
    fn momentum_rate(
        &mut self,
        time: (f64, f64),
        x: &[f64],
        v: &[f64],
        pdot: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        let m = &mut self.mechanics;
        m.momentum_rate(time.0, x, v, self.equations, pdot)?;
        if self.mobility.is_closed() {
            let force = self.mobility.closure_forces(m, time, x, v)?;
            let mut share = vec![0.0; pdot.len()];
            m.generalised_force(&force, &mut share)?;
            add(1.0, &share, pdot);
        }
        Ok(())
    }

    /// Brings positions onto closures and, where that is asked for, lengths, and leaves the mechanics there.
    fn land(&mut self, t: f64, x: &mut [f64]) -> Result<(), ChartDynamicsError> {
        if self.position == PositionUpdate::Projected || self.mobility.is_closed() {
            self.mobility
                .project(&self.mechanics, t, self.position, x)?;
        }
        self.mechanics.at(x)
    }

    /// Brings momenta onto the closures: the nearest velocities in the mass metric that keep them. The
    /// mechanics has to be at the state.
    pub(super) fn close_momenta(
        &mut self,
        time: (f64, f64),
        x: &[f64],
        p: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        if !self.mobility.is_closed() {
            return Ok(());
        }
        let mut qdot = vec![0.0; p.len()];
        let mut v = vec![0.0; x.len()];
        self.mechanics.velocity(p, &mut qdot, &mut v)?;
        self.mobility.at(&self.mechanics, time.0, x)?;
        let change = self.mobility.velocity_change(&self.mechanics, time, x, &v);
        self.mechanics.system().scatter(&change, &mut v);
        self.mechanics.momenta(&v, &mut qdot)?;
        add(1.0, &qdot, p);
        Ok(())
    }

    /// Forces of all supports at a state.
    pub(super) fn balance(
        &mut self,
        time: (f64, f64),
        s: &PhaseState,
        balance: &mut Balance,
    ) -> Result<(), ChartDynamicsError> {
        let v = self.velocities(s)?;
        self.mobility.at(&self.mechanics, time.0, &s.x)?;
        self.mobility
            .balance(&mut self.mechanics, time, &s.x, &v, balance)
    }

    /// Try a step of length h from time t.
    pub(super) fn attempt(
        &mut self,
        t: f64,
        s: &PhaseState,
        h: f64,
    ) -> Result<PhaseState, ChartDynamicsError> {
        let mut trial = match self.method {
            ChartMethod::ForwardEuler => self.forward_euler(t, s, h),
            ChartMethod::RungeKutta4 => self.runge_kutta(t, s, h),
        }?;
        let finite = |a: &[f64]| a.iter().all(|c| c.is_finite());
        if !(finite(&trial.x) && finite(&trial.p)) {
            return Err(ChartDynamicsError::NotFinite { t: t + h });
        }
        self.mechanics.coordinates(&trial.x, &mut trial.q)?;
        trial.hamiltonian = self.mechanics.hamiltonian(t + h, &trial.x, &trial.p)?;
        Ok(trial)
    }

    fn forward_euler(
        &mut self,
        t: f64,
        s: &PhaseState,
        h: f64,
    ) -> Result<PhaseState, ChartDynamicsError> {
        let (mut qdot, mut pdot) = (vec![0.0; s.q.len()], vec![0.0; s.q.len()]);
        let mut v = vec![0.0; s.x.len()];
        self.open(t, &s.x)?;
        self.mechanics.velocity(&s.p, &mut qdot, &mut v)?;
        self.momentum_rate((t, h), &s.x, &v, &mut pdot)?;
        let mut trial = s.clone();
        add(h, &pdot, &mut trial.p);
        self.finish((t, h), s, &qdot, &v, &mut trial)?;
        Ok(trial)
    }

    /// Positions of the Euler method, and the momenta formed anew where that is asked for. Leaves the
    /// mechanics at the new state.
    fn finish(
        &mut self,
        (t, h): (f64, f64),
        s: &PhaseState,
        qdot: &[f64],
        v: &[f64],
        trial: &mut PhaseState,
    ) -> Result<(), ChartDynamicsError> {
        let mut new_velocity = Vec::new();
        if self.equations == Equations::Reformed {
            // Velocities of the new momenta with the old Jacobian, which this scheme takes as constant.
            let mut rate = vec![0.0; qdot.len()];
            new_velocity = vec![0.0; v.len()];
            self.mechanics
                .velocity(&trial.p, &mut rate, &mut new_velocity)?;
        }
        trial.x.copy_from_slice(&s.x);
        add(h, v, &mut trial.x);
        if self.position == PositionUpdate::Exact {
            trial.q.copy_from_slice(&s.q);
            add(h, qdot, &mut trial.q);
            let near = trial.x.clone();
            self.mechanics.realise(&trial.q, &near, &mut trial.x)?;
        }
        self.land(t + h, &mut trial.x)?;
        if self.equations == Equations::Reformed {
            self.mechanics.momenta(&new_velocity, &mut trial.p)?;
        }
        self.close_momenta((t + h, h), &trial.x, &mut trial.p)
    }

    fn runge_kutta(
        &mut self,
        t: f64,
        s: &PhaseState,
        h: f64,
    ) -> Result<PhaseState, ChartDynamicsError> {
        let n = s.q.len();
        let mut stage = s.clone();
        let mut near = s.x.clone();
        let mut v = vec![0.0; s.x.len()];
        let (mut qdot, mut pdot) = (vec![0.0; n], vec![0.0; n]);
        let (mut dq, mut dp) = (vec![0.0; n], vec![0.0; n]);
        for (k, weight) in [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0]
            .into_iter()
            .enumerate()
        {
            let time = t + h * [0.0, 0.5, 0.5, 1.0][k];
            self.open(time, &stage.x)?;
            self.mechanics.velocity(&stage.p, &mut qdot, &mut v)?;
            self.momentum_rate((time, h), &stage.x, &v, &mut pdot)?;
            add(weight, &qdot, &mut dq);
            add(weight, &pdot, &mut dp);
            let ahead = h * [0.5, 0.5, 1.0, 0.0][k];
            if k == 3 {
                break;
            }
            for i in 0..n {
                stage.q[i] = s.q[i] + ahead * qdot[i];
                stage.p[i] = s.p[i] + ahead * pdot[i];
            }
            near.copy_from_slice(&s.x);
            add(ahead, &v, &mut near);
            self.mechanics.realise(&stage.q, &near, &mut stage.x)?;
        }
        let mut trial = s.clone();
        add(h, &dq, &mut trial.q);
        add(h, &dp, &mut trial.p);
        self.mechanics.realise(&trial.q, &stage.x, &mut trial.x)?;
        self.land(t + h, &mut trial.x)?;
        self.close_momenta((t + h, h), &trial.x, &mut trial.p)?;
        Ok(trial)
    }
}

/// `y += a x`.
fn add(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}
