//! What a checkpoint keeps of a motion in a chart, and how a simulation continues from it.

use super::simulation::ChartSimulation;
use super::state::ChartState;
use super::stepping::Stepper;
use super::{ChartDynamicsError, ChartMechanics, ChartOptions};
use isosheet_coords::Chart;
use isosheet_dynamics::engine::{Balance, ForceTime};
use isosheet_dynamics::{CheckpointError, SheetModel};

impl ChartSimulation {
    /// What a checkpoint keeps.
    pub(crate) fn motion(&self) -> ChartState {
        let (eigenvalue, eigenvector) = self.stepper.power();
        ChartState {
            eigenvalue,
            eigenvector: eigenvector.to_vec(),
            memories: self.memories().clone(),
            balance: self.motion.balance.as_ref().map(Balance::compact),
            ..self.motion.clone()
        }
    }

    /// Back to the motion before a step, and to its chart if the step has replaced that.
    pub(super) fn restore(&mut self, motion: ChartState) {
        if let Some(chart) = self.replaced.take() {
            self.stepper.mechanics.exchange(chart);
        }
        self.stepper
            .set_power(motion.eigenvalue, &motion.eigenvector);
        self.motion = motion;
    }

    /// Continues from a checkpoint, with the chart as its user built it at the start.
    pub(crate) fn resume(
        model: SheetModel,
        mut chart: Box<dyn Chart>,
        options: ChartOptions,
        motion: ChartState,
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
            chart = chart.rebased(reference)?;
        }
        let mut mechanics = ChartMechanics::new(model, chart, options.solver)?;
        let taken = mechanics.memories_mut().take_over(&motion.memories);
        taken.map_err(CheckpointError::from)?;
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
            motion: ChartState { balance, ..motion },
            replaced: None,
        })
    }
}
