//! What the potentials of a model remember.

use crate::SheetModel;

impl SheetModel {
    /// Whether bends or creases can yield: whether a potential has a memory
    /// ([`Potential::memory`](crate::Potential::memory)).
    pub fn can_yield(&self) -> bool {
        self.potentials().any(|p| !p.memory().is_empty())
    }

    /// What each of the potentials remembers that have a memory, in the order in which they were added.
    pub(crate) fn memories(&self) -> Vec<Vec<f64>> {
        let memories = self.outer_potentials().map(|p| p.memory());
        let memories = memories.filter(|memory| !memory.is_empty());
        memories.map(<[f64]>::to_vec).collect()
    }

    /// Replaces what these potentials remember by memories of the same numbers of values.
    pub(crate) fn set_memories(&mut self, memories: &[Vec<f64>]) {
        let remembering = self.potentials.iter_mut();
        let remembering = remembering.filter(|p| !p.memory().is_empty());
        for (potential, memory) in remembering.zip(memories) {
            potential.set_memory(memory);
        }
    }

    /// Makes what the potentials remember that of the end of a step; the energy that has been dissipated, joules.
    pub(crate) fn settle(&mut self, t: f64, x: &[f64]) -> f64 {
        self.potentials.iter_mut().map(|p| p.settle(t, x)).sum()
    }
}
