//! Losses of a run: numbers that depend on its states.

use isosheet_dynamics::sensitivity::OfState;
use isosheet_model::State;

/// What a state contributes to a loss, and the derivatives of that.
#[derive(Debug, Clone, PartialEq)]
pub struct Share {
    /// The contribution.
    pub value: f64,
    /// Its derivatives by the positions (per metre) and velocities (seconds per metre) of the state.
    pub of: OfState,
}

/// A loss `L = sum_n l_n(x_n, v_n)` over the states at the start of a run (`n = 0`) and after each step of
/// its plan.
///
/// A closure is one; [`coordinate`] and [`squared_distances`] are others.
pub trait Loss {
    /// What the state after `n` steps of the plan contributes; nothing for most.
    fn share(&self, n: usize, state: &State) -> Option<Share>;
}

impl<F: Fn(usize, &State) -> Option<Share>> Loss for F {
    fn share(&self, n: usize, state: &State) -> Option<Share> {
        self(n, state)
    }
}

/// The coordinate `axis` of a vertex after `step` steps of the plan, metres.
pub fn coordinate(vertex: usize, axis: usize, step: usize) -> impl Loss {
    move |n: usize, state: &State| {
        (n == step).then(|| {
            let i = 3 * vertex + axis;
            let mut of = OfState::zeros(state.x.len());
            of.x[i] = 1.0;
            let value = state.x[i];
            Share { value, of }
        })
    }
}

/// Half the sum of the squared distances of some vertices from their targets after `step` steps of the plan,
/// square metres.
pub fn squared_distances(targets: Vec<(usize, [f64; 3])>, step: usize) -> impl Loss {
    move |n: usize, state: &State| {
        (n == step).then(|| {
            let mut of = OfState::zeros(state.x.len());
            let mut value = 0.0;
            for (vertex, target) in &targets {
                for axis in 0..3 {
                    let i = 3 * vertex + axis;
                    let error = state.x[i] - target[axis];
                    value += 0.5 * error * error;
                    of.x[i] += error;
                }
            }
            Share { value, of }
        })
    }
}
