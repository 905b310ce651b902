//! What a checkpoint keeps of a motion in a chart, and how a simulation continues from it.

use super::simulation::{ChartSimulation, StepRange};
use super::stepping::{PhaseState, Stepper};
use super::{ChartDynamicsError, ChartMechanics, ChartOptions, ContactImpulse};
use crate::SheetModel;
use crate::reaction::{Balance, ForceTime};
use isosheet_coords::Chart;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Where a motion in a chart is: all that the next step depends on besides model, contact and options.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChartMotion {
    /// Time, seconds.
    pub(super) t: f64,
    pub(super) state: PhaseState,
    /// Energy after velocity damping, joules.
    pub(super) hamiltonian: f64,
    /// Planned length of the next step, seconds.
    pub(super) next_step: f64,
    /// Smallest and largest step so far; none before the first.
    pub(super) range: Option<StepRange>,
    /// Steps since the condition number was estimated.
    pub(super) since_check: u32,
    /// Growth of the largest eigenvalue of C since the reference state.
    pub(super) growth: f64,
    /// Whether the present state is the chart's reference state.
    pub(super) is_fresh: bool,
    /// Positions at which the chart was rebased last; none if it is as its user built it.
    pub(super) reference: Option<Vec<f64>>,
    /// Largest eigenvalue of C at the reference state, and the vector of the power iteration.
    pub(super) eigenvalue: f64,
    pub(super) eigenvector: Vec<f64>,
    /// Positions of the fixed pins that the chart does not eliminate.
    pub(super) pins: Vec<Vector3<f64>>,
    /// Forces of the supports now, in scenes where they move.
    pub(super) balance: Option<Balance>,
    /// Impulses of contacts at the end of the last step.
    pub(super) impulses: Vec<ContactImpulse>,
}

impl ChartMotion {
    /// The motion at time `t` before its first step, with the chart as its user built it.
    pub(super) fn start(
        t: f64,
        state: PhaseState,
        next_step: f64,
        pins: Vec<Vector3<f64>>,
    ) -> Self {
        Self {
            t,
            hamiltonian: state.hamiltonian,
            state,
            next_step,
            range: None,
            since_check: 0,
            growth: 1.0,
            is_fresh: true,
            reference: None,
            eigenvector: Vec::new(),
            eigenvalue: 0.0,
            pins,
            balance: None,
            impulses: Vec::new(),
        }
    }
}

impl ChartSimulation {
    /// What a checkpoint keeps.
    pub(crate) fn motion(&self) -> ChartMotion {
        let (eigenvalue, eigenvector) = self.stepper.power();
        ChartMotion {
            eigenvalue,
            eigenvector: eigenvector.to_vec(),
            balance: self.motion.balance.as_ref().map(Balance::compact),
            ..self.motion.clone()
        }
    }

    /// Back to a motion of the same chart.
    pub(super) fn restore(&mut self, motion: ChartMotion) {
        self.stepper
            .set_power(motion.eigenvalue, &motion.eigenvector);
        self.motion = motion;
    }

    /// Continues from a checkpoint, with the chart as its user built it at the start.
    pub(crate) fn resume(
        model: SheetModel,
        mut chart: Box<dyn Chart>,
        options: ChartOptions,
        motion: ChartMotion,
    ) -> Result<Self, ChartDynamicsError> {
        let n = model.coordinate_count();
        let reference = motion.reference.as_ref().unwrap_or(&motion.state.x);
        for (what, found, expected) in [
            ("x", motion.state.x.len(), n),
            ("the reference state", reference.len(), n),
        ] {
            if found != expected {
                return Err(ChartDynamicsError::WrongLength {
                    what,
                    found,
                    expected,
                });
            }
        }
        if let Some(reference) = &motion.reference {
            chart.rebase(reference)?;
        }
        let mechanics = ChartMechanics::new(model, chart, options.solver)?;
        let n = mechanics.dimension();
        for (what, found) in [
            ("q", motion.state.q.len()),
            ("p", motion.state.p.len()),
            ("the power iteration", motion.eigenvector.len()),
        ] {
            if found != n {
                return Err(ChartDynamicsError::WrongLength {
                    what,
                    found,
                    expected: n,
                });
            }
        }
        let mut stepper = Stepper::new(mechanics, &options, &motion.state.x)?;
        stepper.mobility.set_pin_positions(&motion.pins);
        stepper.set_power(motion.eigenvalue, &motion.eigenvector);
        let balance = motion.balance.as_ref().map(|kept| {
            let mut balance = Balance::new(stepper.mechanics.model(), ForceTime::End);
            balance.copy_from(kept);
            balance
        });
        Ok(Self {
            stepper,
            options,
            motion: ChartMotion { balance, ..motion },
            contact: None,
        })
    }
}
