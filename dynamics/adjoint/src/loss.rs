//! Losses of a run: numbers that depend on its states, on the forces of supports and on energies.

use crate::moment::{Energies, Moment, View};
use isosheet_dynamics::sensitivity::OfState;
use isosheet_model::State;

/// What a moment of a run contributes to a loss, and the derivatives of that.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Share {
    /// The contribution.
    pub value: f64,
    /// Its derivatives by the positions (per metre) and velocities (seconds per metre) of the state.
    pub of: OfState,
    /// Its derivatives by the force of supports on each vertex, per newton; none if the list is empty.
    pub of_forces: Vec<[f64; 3]>,
    /// Its derivatives by energies, per joule; none where the list of potentials is shorter.
    pub of_energies: Energies,
}

impl Share {
    /// Of a state alone.
    pub fn of_state(value: f64, of: OfState) -> Self {
        Self {
            value,
            of,
            ..Self::default()
        }
    }
}

/// A loss `L = sum_n l_n(x_n, v_n)` over the states at the start of a run (`n = 0`) and after each step of
/// its plan; it may depend on [forces of supports and energies](Moment) there, too.
///
/// A closure of a state is one, and [`OfMoments`] with a closure of a moment. [`coordinate`],
/// [`squared_distances`], [`support_force`] and [`energy`] are others.
pub trait Loss {
    /// What the moment after `n` steps of the plan contributes; nothing for most.
    fn share(&self, n: usize, moment: &Moment<'_>) -> Option<Share>;

    /// What it looks at there. The default is the state alone.
    fn view(&self, _n: usize) -> View {
        View::State
    }
}

impl<F: Fn(usize, &State) -> Option<Share>> Loss for F {
    fn share(&self, n: usize, moment: &Moment<'_>) -> Option<Share> {
        self(n, moment.state)
    }
}

/// A loss of moments, by a closure that is asked after each step of the plan.
#[derive(Debug, Clone, Copy)]
pub struct OfMoments<F>(pub F);

impl<F: Fn(usize, &Moment<'_>) -> Option<Share>> Loss for OfMoments<F> {
    fn share(&self, n: usize, moment: &Moment<'_>) -> Option<Share> {
        (self.0)(n, moment)
    }

    fn view(&self, _n: usize) -> View {
        View::All
    }
}

/// The coordinate `axis` of a vertex after `step` steps of the plan, metres.
pub fn coordinate(vertex: usize, axis: usize, step: usize) -> impl Loss {
    move |n: usize, state: &State| {
        (n == step).then(|| {
            let i = 3 * vertex + axis;
            let mut of = OfState::zeros(state.x.len());
            of.x[i] = 1.0;
            Share::of_state(state.x[i], of)
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
            Share::of_state(value, of)
        })
    }
}

/// A loss of one moment of a run.
struct At<F> {
    step: usize,
    share: F,
}

impl<F: Fn(&Moment<'_>) -> Share> Loss for At<F> {
    fn share(&self, n: usize, moment: &Moment<'_>) -> Option<Share> {
        (n == self.step).then(|| (self.share)(moment))
    }

    fn view(&self, n: usize) -> View {
        match n == self.step {
            true => View::All,
            false => View::State,
        }
    }
}

/// The component `axis` of the force of supports on some vertices after `step` steps of the plan, newtons.
pub fn support_force(vertices: Vec<usize>, axis: usize, step: usize) -> impl Loss {
    let share = move |moment: &Moment<'_>| {
        let mut of_forces = vec![[0.0; 3]; moment.support_forces.len()];
        let mut value = 0.0;
        for v in &vertices {
            value += moment.support_forces[*v][axis];
            of_forces[*v][axis] += 1.0;
        }
        Share {
            value,
            of: OfState::zeros(moment.state.x.len()),
            of_forces,
            ..Share::default()
        }
    };
    At { step, share }
}

/// The energy after `step` steps of the plan without contact, joules: kinetic, elastic, of gravity and of
/// all other potentials of the model.
pub fn energy(step: usize) -> impl Loss {
    let share = |moment: &Moment<'_>| {
        let Energies {
            kinetic,
            potentials,
        } = moment.energies;
        Share {
            value: kinetic + potentials.iter().sum::<f64>(),
            of: OfState::zeros(moment.state.x.len()),
            of_energies: Energies {
                kinetic: 1.0,
                potentials: vec![1.0; potentials.len()],
            },
            ..Share::default()
        }
    };
    At { step, share }
}
