//! What potentials remember, on the way back.

use isosheet_materials::potential::{At, Memories, Reached};
use isosheet_materials::{Difference, NoDerivative};
use isosheet_model::{SheetModel, State};

fn reached(state: &State) -> Reached<'_> {
    Reached {
        t: state.t,
        x: &state.x,
        v: &state.v,
    }
}

/// Makes derivatives `of_memory` by what potentials remember after a state those by what they remembered
/// before, and adds those by its positions to `of_x`. What has no derivative is constant, and where it has
/// changed it is handed to `refuse`.
pub(crate) fn pull_settling(
    model: &SheetModel,
    state: &State,
    (found, choices): (&Memories, &[Vec<f64>]),
    of_memory: &mut [Vec<f64>],
    of_x: &mut [f64],
    mut refuse: impl FnMut(NoDerivative),
) {
    let all = model
        .potentials()
        .zip(found.lists())
        .zip(choices)
        .zip(of_memory);
    for (((potential, found), choices), of) in all {
        let Some(remembering) = potential.remembering() else {
            continue;
        };
        if of.iter().all(|m| *m == 0.0) && !remembering.can_yield() {
            continue;
        }
        let pulled = remembering.pull_back_settling(reached(state), (found, choices), of, of_x);
        if let Err(source) = pulled {
            let mut left = found.clone();
            remembering.settle(reached(state), &mut left);
            if left != *found {
                refuse(source);
            }
        }
    }
}

/// What potentials choose where their memories become those of the end of a step.
pub(crate) fn choices(model: &SheetModel, state: &State, found: &Memories) -> Vec<Vec<f64>> {
    let all = model.potentials().zip(found.lists());
    let own = all.map(|(potential, found)| match potential.remembering() {
        Some(remembering) => remembering.choices(reached(state), found),
        None => Vec::new(),
    });
    own.collect()
}

/// The sum of the products of `of` with what the potentials of a model remember at the end of a step, where
/// they choose as others did: of the parts that differ in models that are compared.
pub(crate) fn settled_products(
    model: &SheetModel,
    state: &State,
    (found, choices): (&Memories, &[Vec<f64>]),
    of: &[Vec<f64>],
    differences: &[Difference],
) -> f64 {
    let mut sum = 0.0;
    let all = model.potentials().zip(found.lists()).zip(choices).zip(of);
    for ((((potential, found), choices), of), difference) in all.zip(differences) {
        let parts = match difference {
            Difference::Nothing => continue,
            Difference::Parts(parts) => Some(&parts[..]),
            Difference::Everything => None,
        };
        if let Some(remembering) = potential.remembering()
            && of.iter().any(|o| *o != 0.0)
        {
            sum += remembering.settled_product(parts, reached(state), (found, choices), of);
        }
    }
    sum
}

/// Adds derivatives by the positions where a run starts to `of_x`, as far as potentials remember them.
pub(crate) fn start_memories(
    model: &SheetModel,
    state: &State,
    of_memory: &[Vec<f64>],
    of_x: &mut [f64],
    mut refuse: impl FnMut(NoDerivative),
) {
    for (potential, of) in model.potentials().zip(of_memory) {
        let Some(remembering) = potential.remembering() else {
            continue;
        };
        if of.iter().all(|m| *m == 0.0) {
            continue;
        }
        if let Err(source) = remembering.pull_back_start(reached(state), of, of_x) {
            refuse(source);
        }
    }
}

/// Adds to `of_memory` the derivatives of `w . dV/dx` by what potentials remember, of those that have any.
pub(crate) fn add_memory_products(
    model: &SheetModel,
    (t, x): (f64, &[f64]),
    memories: &Memories,
    w: &[f64],
    of_memory: &mut [Vec<f64>],
) {
    let all = model.potentials().zip(memories.lists()).zip(of_memory);
    for ((potential, memory), of) in all {
        if let Some(remembering) = potential.remembering() {
            let at = At::new(t, x).with_memory(memory);
            if remembering.add_memory_products(at, w, of).is_err() {
                // Where it changes it is refused.
                of.fill(0.0);
            }
        }
    }
}
