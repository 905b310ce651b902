//! What a moment of a run contributes to a loss.

use super::Sweep;
use crate::error::AdjointError;
use crate::loss::Share;
use crate::moment::{Energies, Seen};
use crate::neighbours::Neighbours;
use isosheet_dynamics::sensitivity::AcceptedStep;
use isosheet_materials::Difference;
use isosheet_materials::potential::Memories;
use isosheet_model::State;
use std::sync::Arc;

impl Sweep<'_> {
    /// What a loss may look at, at a state: the start, or the end of a step.
    ///
    /// # Errors
    /// [`AdjointError::Equations`].
    pub(crate) fn see(
        &mut self,
        state: &State,
        step: Option<&AcceptedStep>,
    ) -> Result<Seen, AdjointError> {
        Seen::of(&mut self.base, state, step)
    }

    /// Adds what the state after `n` steps of the plan contributes to a loss.
    ///
    /// # Errors
    /// [`AdjointError::LossLength`], [`AdjointError::NoDerivative`].
    pub(crate) fn add_share(
        &mut self,
        share: &Share,
        n: usize,
        state: &State,
        seen: &Seen,
    ) -> Result<(), AdjointError> {
        let expected = state.x.len();
        let wrong = |found| AdjointError::LossLength {
            step: n,
            found,
            expected,
        };
        for (own, added) in [
            (&mut self.end.x, &share.of.x),
            (&mut self.end.v, &share.of.v),
        ] {
            if added.len() != expected {
                return Err(wrong(added.len()));
            }
            own.iter_mut().zip(added).for_each(|(o, a)| *o += a);
        }
        let of_forces = share.of_forces.as_flattened();
        if !of_forces.is_empty() && of_forces.len() != expected {
            return Err(wrong(of_forces.len()));
        }
        self.of_forces = match n {
            // There are none at the start.
            0 => Vec::new(),
            _ => of_forces.to_vec(),
        };
        match &seen.memories {
            Some(memories) => self.add_energies(&share.of_energies, state, memories),
            None => Ok(()),
        }
    }

    /// Adds derivatives by energies at a state.
    fn add_energies(
        &mut self,
        of: &Energies,
        state: &State,
        memories: &Memories,
    ) -> Result<(), AdjointError> {
        let model = Arc::clone(&self.model);
        let State { t, x, v } = state;
        if of.kinetic != 0.0 {
            let mut momentum = vec![0.0; v.len()];
            model.mass().apply(model.topology(), v, &mut momentum);
            for (own, p) in self.end.v.iter_mut().zip(&momentum) {
                *own += of.kinetic * p;
            }
            for neighbours in &self.neighbours {
                let [up, down] = neighbours
                    .simulations
                    .each_ref()
                    .map(|simulation| simulation.model().kinetic_energy(v));
                self.of_numbers[neighbours.number] +=
                    of.kinetic * (up - down) / neighbours.distance;
            }
        }
        let potentials = model.potentials_at(*t, x, memories).enumerate();
        for ((k, (potential, at)), weight) in potentials.zip(&of.potentials) {
            if *weight == 0.0 {
                continue;
            }
            let is_other = |n: &&Neighbours| n.differences[k] != Difference::Nothing;
            let mut slope = vec![0.0; x.len()];
            potential.add_gradient(at, &mut slope);
            for (own, s) in self.end.x.iter_mut().zip(&slope) {
                *own += weight * s;
            }
            for neighbours in self.neighbours.iter().filter(is_other) {
                let [up, down] = neighbours.simulations.each_ref().map(|simulation| {
                    let mut potentials = simulation.model().potentials();
                    potentials.nth(k).map_or(0.0, |p| p.energy(at))
                });
                self.of_numbers[neighbours.number] += weight * (up - down) / neighbours.distance;
            }
            if let Some(remembering) = potential.remembering() {
                let added = remembering.add_memory_slopes(at, *weight, &mut self.memory[k]);
                if let Err(source) = added {
                    self.refuse(*t, source)?;
                }
            }
        }
        Ok(())
    }
}
