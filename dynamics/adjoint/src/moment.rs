//! Moments of a run as a loss sees them: the state, forces of supports, energies.

use crate::error::AdjointError;
use crate::level::levels;
use crate::rows::Rows;
use isosheet_dynamics::Simulation;
use isosheet_dynamics::sensitivity::AcceptedStep;
use isosheet_materials::potential::Memories;
use isosheet_model::{PINNED, SheetModel, State};
use std::sync::Arc;

/// What a loss looks at after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// The state alone.
    State,
    /// Forces of supports and energies, too. They cost an evaluation of the equations of the step, and where
    /// [checkpoints](crate::Kept::Between) alone are kept the steps after one are made again.
    All,
}

/// The start of a run, or the end of a step of its plan.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// Time, positions and velocities.
    pub state: &'a State,
    /// The force of supports (pins and vertex constraints) on each vertex (`V`), newtons: at a pin
    /// `M a - f + G^T lambda` with the discrete acceleration `a`, all other forces `f` and the rods' force
    /// densities `lambda` (tension positive). Zero at the start; empty where a loss looks at
    /// the state alone.
    pub support_forces: &'a [[f64; 3]],
    /// The energies; empty where a loss looks at the state alone.
    pub energies: &'a Energies,
}

/// Energies without that of contact, joules; or derivatives of a number by them, per joule.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Energies {
    /// `v . M v / 2`.
    pub kinetic: f64,
    /// Of each potential of the model, in the order of [`SheetModel::potentials`].
    pub potentials: Vec<f64>,
}

impl Energies {
    /// Of a model at a state.
    fn of(model: &SheetModel, state: &State, memories: &Memories) -> Self {
        let potentials = model.potentials_at(state.t, &state.x, memories);
        Self {
            kinetic: model.kinetic_energy(&state.v),
            potentials: potentials.map(|(p, at)| p.energy(at)).collect(),
        }
    }
}

/// A moment with what it has.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    support_forces: Vec<[f64; 3]>,
    energies: Energies,
    /// What the potentials remember.
    pub(crate) memories: Option<Memories>,
}

impl Seen {
    /// What is to be seen at a state: the start, or the end of a step.
    ///
    /// # Errors
    /// [`AdjointError::Equations`].
    pub(crate) fn of(
        simulation: &mut Simulation,
        state: &State,
        step: Option<&AcceptedStep>,
    ) -> Result<Self, AdjointError> {
        let model = Arc::clone(simulation.model());
        let (memories, forces) = match step {
            None => (simulation.memories().clone(), vec![0.0; state.x.len()]),
            Some(step) => {
                let mut memories = step.memories.clone();
                model.settle(state, &mut memories);
                (memories, support_forces(simulation, step)?)
            }
        };
        Ok(Self {
            support_forces: forces.as_chunks::<3>().0.to_vec(),
            energies: Energies::of(&model, state, &memories),
            memories: Some(memories),
        })
    }

    pub(crate) fn moment<'a>(&'a self, state: &'a State) -> Moment<'a> {
        Moment {
            state,
            support_forces: &self.support_forces,
            energies: &self.energies,
        }
    }
}

/// The forces of supports at the end of a sub-step (`3V`, newtons): what its equations leave at pins, and
/// the forces of vertex constraints.
fn support_forces(
    simulation: &mut Simulation,
    step: &AcceptedStep,
) -> Result<Vec<f64>, AdjointError> {
    let t = step.end.t;
    let model = Arc::clone(simulation.model());
    let level = levels(&model, step)[0];
    let mut equations = simulation
        .step_equations()
        .ok_or(AdjointError::Method { number: 0 })?;
    let begun = equations.begin(step, level.lag, level.x);
    begun.map_err(|source| AdjointError::Equations { t, source })?;
    let mut residual = vec![0.0; level.x.len()];
    equations.residual(step, level.x, &mut residual);
    let mut forces = Rows::forces(&model, step, level.x);
    let scale = 1.0 / (step.h * step.h);
    for (v, i) in model.free_index().iter().enumerate() {
        if *i == PINNED {
            for k in 3 * v..3 * v + 3 {
                forces[k] += scale * residual[k];
            }
        }
    }
    Ok(forces)
}
