//! Runs that remember their accepted steps.

use crate::error::AdjointError;
use crate::family::{Family, Plan, Scene};
use crate::gradient::Gradient;
use crate::loss::Loss;
use crate::moment::{Seen, View};
use crate::neighbours::Neighbours;
use crate::options::{AdjointOptions, Kept};
use crate::sweep::Sweep;
use isosheet_dynamics::contact::Contact;
use isosheet_dynamics::sensitivity::AcceptedStep;
use isosheet_dynamics::{Checkpoint, Simulation};
use isosheet_model::{State, StepError};
use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

/// The accepted sub-steps of each step of a part of a plan.
type Steps = Vec<Vec<AcceptedStep>>;

/// The difference of lengths at rest, as a part, over which equations of elastic sheets are compared.
///
/// Sheets resist tension and pressure differently while they bend, so that the strains of the run, some 1e-7
/// in paper under its weight, have to be larger than those that the difference makes. The round-off of
/// strains is 1e-15. Errors of the derivative of a height by a coordinate of the mesh, 8 x 4 squares of 25 mm
/// that hang from an edge for ten steps, as parts of the largest of these derivatives:
///
/// | difference | paper, vertex 44 x | vertex 20 x | vertex 20 y | a tenth of the stiffness |
/// |---|---|---|---|---|
/// | 8e-4 | 10 | 37 | 30 | 0.2 |
/// | 8e-6 | 3e-2 | 0.2 | 5e-2 | 4e-4 |
/// | 8e-7 | 3e-4 | 3e-3 | 1e-2 | 4e-6 |
/// | 8e-8 | 1e-6 | 3e-5 | 1e-4 | 2e-7 |
/// | **8e-9** | 2e-6 | 2e-6 | 3e-7 | 2e-6 |
/// | 8e-10 | 4e-5 | 5e-5 | 8e-5 | 9e-6 |
const REST_DIFFERENCE: f64 = 1e-8;

/// A run of a scene with some numbers, recorded so that losses of it can be differentiated.
pub struct Run<'f> {
    family: &'f dyn Family,
    numbers: Vec<f64>,
    plan: Plan,
    options: AdjointOptions,
    states: Vec<State>,
    parts: Vec<Part>,
}

/// A part of a plan.
struct Part {
    /// Its first step.
    first: usize,
    /// How many steps it has.
    count: usize,
    content: Content,
}

/// What is kept of a part.
enum Content {
    Steps(Steps),
    /// The checkpoint at its start.
    Checkpoint(Box<Checkpoint>),
}

impl<'f> Run<'f> {
    /// Runs a scene.
    ///
    /// # Errors
    /// [`AdjointError`] if the scene cannot be built, or a step fails.
    pub fn record(
        family: &'f dyn Family,
        numbers: &[f64],
        plan: Plan,
        options: AdjointOptions,
    ) -> Result<Self, AdjointError> {
        Self::record_watched(family, numbers, plan, options, &mut || {
            ControlFlow::Continue(())
        })
    }

    /// As [`Run::record`]. `watch` is asked before each factorisation, and may end the run.
    ///
    /// # Errors
    /// As [`Run::record`]; [`AdjointError::Interrupted`].
    pub fn record_watched(
        family: &'f dyn Family,
        numbers: &[f64],
        plan: Plan,
        options: AdjointOptions,
        watch: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Self, AdjointError> {
        let mut simulation = simulation(family, numbers, &plan)?;
        let count = plan.steps.len();
        let mut states = vec![simulation.state().clone()];
        let mut parts = Vec::new();
        let each = match options.kept {
            Kept::All => count.max(1),
            Kept::Between { checkpoints } => checkpoints.max(1),
        };
        let mut first = 0;
        while first < count {
            let own = each.min(count - first);
            let checkpoint = match options.kept {
                Kept::All => None,
                Kept::Between { .. } => Some(simulation.checkpoint()),
            };
            let content = match checkpoint {
                None => Content::Steps(take(
                    (&mut simulation, watch),
                    &plan,
                    first,
                    own,
                    |state| states.push(state.clone()),
                )?),
                Some(checkpoint) => {
                    for number in first..first + own {
                        step(&mut simulation, plan.steps[number], number, watch)?;
                        states.push(simulation.state().clone());
                    }
                    Content::Checkpoint(Box::new(checkpoint))
                }
            };
            parts.push(Part {
                first,
                count: own,
                content,
            });
            first += own;
        }
        Ok(Self {
            family,
            numbers: numbers.to_vec(),
            plan,
            options,
            states,
            parts,
        })
    }

    /// The states at the start and after each step of the plan.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// The value of a loss, without its gradient.
    ///
    /// # Errors
    /// [`AdjointError`] if what it [looks at](Loss::view) cannot be evaluated.
    pub fn value(&self, loss: &dyn Loss) -> Result<f64, AdjointError> {
        let last = self.plan.steps.len();
        let mut base = match (0..=last).any(|n| loss.view(n) == View::All) {
            true => Some(equations(self.family, &self.numbers, &self.plan, None)?),
            false => None,
        };
        let mut see = |n: usize, step: Option<&AcceptedStep>| match (loss.view(n), &mut base) {
            (View::All, Some(base)) => Seen::of(base, &self.states[n], step),
            _ => Ok(Seen::default()),
        };
        let value = |n: usize, seen: &Seen| {
            let share = loss.share(n, &seen.moment(&self.states[n]));
            share.map_or(0.0, |share| share.value)
        };
        let mut sum = value(0, &see(0, None)?);
        for part in &self.parts {
            let numbers = part.first + 1..=part.first + part.count;
            let is_seen = numbers.clone().any(|n| loss.view(n) == View::All);
            let steps = match is_seen {
                true => Some(self.steps_of(part, &mut || ControlFlow::Continue(()))?),
                false => None,
            };
            for (k, n) in numbers.enumerate() {
                let last = steps.as_ref().and_then(|steps| steps[k].last());
                sum += value(n, &see(n, last)?);
            }
        }
        Ok(sum)
    }

    /// The gradient of a loss by the numbers of the scene and by the state at its start.
    ///
    /// # Errors
    /// [`AdjointError`] naming what has no derivative, with the time.
    pub fn gradient(&self, loss: &dyn Loss) -> Result<Gradient, AdjointError> {
        self.gradient_watched(loss, &mut || ControlFlow::Continue(()))
    }

    /// As [`Run::gradient`]. `watch` is asked for each number and each sub-step, and may end the way back.
    ///
    /// # Errors
    /// As [`Run::gradient`]; [`AdjointError::Interrupted`].
    pub fn gradient_watched(
        &self,
        loss: &dyn Loss,
        watch: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Gradient, AdjointError> {
        let base = equations(self.family, &self.numbers, &self.plan, None)?;
        let mut sweep = Sweep::new(base, &self.options);
        for number in 0..self.numbers.len() {
            ask(watch)?;
            sweep.add_number(self.neighbours(number)?)?;
        }
        let mut value = 0.0;
        let mut add = |sweep: &mut Sweep<'_>, n: usize, step: Option<&AcceptedStep>| {
            let state = &self.states[n];
            let seen = match loss.view(n) {
                View::All => sweep.see(state, step)?,
                View::State => Seen::default(),
            };
            let Some(share) = loss.share(n, &seen.moment(state)) else {
                return Ok(());
            };
            if !share.value.is_finite() {
                let value = share.value;
                return Err(AdjointError::LossValue { step: n, value });
            }
            value += share.value;
            sweep.add_share(&share, n, state, &seen)
        };
        for part in self.parts.iter().rev() {
            let steps = self.steps_of(part, watch)?;
            for (k, sub_steps) in steps.iter().enumerate().rev() {
                add(&mut sweep, part.first + k + 1, sub_steps.last())?;
                for step in sub_steps.iter().rev() {
                    ask(watch)?;
                    sweep.step_back(step)?;
                }
            }
        }
        add(&mut sweep, 0, None)?;
        sweep.finish(&self.states[0], value)
    }

    /// The accepted sub-steps of a part: those that are kept, or made again.
    fn steps_of<'a>(
        &self,
        part: &'a Part,
        watch: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Cow<'a, Steps>, AdjointError> {
        match &part.content {
            Content::Steps(steps) => Ok(Cow::Borrowed(steps)),
            Content::Checkpoint(checkpoint) => {
                self.take_again(part, checkpoint, watch).map(Cow::Owned)
            }
        }
    }

    /// The simulations with a number that is larger and smaller, and the distance of these: so small that the
    /// lengths of elastic sheets at rest differ by [`REST_DIFFERENCE`] at most.
    fn neighbours(&self, number: usize) -> Result<Neighbours, AdjointError> {
        let size = self.options.size(number, self.numbers[number]);
        let step = self.options.difference * size;
        let found = self.neighbours_at(number, step)?;
        let times = self.states.iter().map(|state| state.t);
        let difference = times.map(|t| found.rest_difference(t)).fold(0.0, f64::max);
        match difference > REST_DIFFERENCE {
            true => self.neighbours_at(number, step * REST_DIFFERENCE / difference),
            false => Ok(found),
        }
    }

    fn neighbours_at(&self, number: usize, step: f64) -> Result<Neighbours, AdjointError> {
        let value = self.numbers[number];
        let ends = [value + step, value - step];
        let distance = ends[0] - ends[1];
        if !(distance.is_finite() && distance > 0.0) {
            return Err(AdjointError::Number { number, value });
        }
        let mut numbers = self.numbers.clone();
        let mut at = |value: f64| {
            numbers[number] = value;
            equations(self.family, &numbers, &self.plan, Some(number))
        };
        let simulations = [at(ends[0])?, at(ends[1])?];
        Ok(Neighbours::new(number, simulations, distance))
    }

    /// Makes a part of the run again.
    fn take_again(
        &self,
        part: &Part,
        checkpoint: &Checkpoint,
        watch: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Steps, AdjointError> {
        let Scene { model, contact, .. } = scene(self.family, &self.numbers, None)?;
        let mut simulation = Simulation::resume(model, contact, checkpoint.clone())?;
        let stepped = (&mut simulation, watch);
        let steps = take(stepped, &self.plan, part.first, part.count, |_| {})?;
        match simulation.state() == &self.states[part.first + part.count] {
            true => Ok(steps),
            false => Err(AdjointError::NotRepeated { number: part.first }),
        }
    }
}

fn ask(watch: &mut dyn FnMut() -> ControlFlow<()>) -> Result<(), AdjointError> {
    match watch() {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(AdjointError::Interrupted),
    }
}

fn scene(
    family: &dyn Family,
    numbers: &[f64],
    number: Option<usize>,
) -> Result<Scene, AdjointError> {
    let scene = family.scene(numbers);
    scene.map_err(|source| AdjointError::Scene { number, source })
}

fn simulation(
    family: &dyn Family,
    numbers: &[f64],
    plan: &Plan,
) -> Result<Simulation, AdjointError> {
    let Scene {
        model,
        start,
        contact,
    } = scene(family, numbers, None)?;
    let simulation = Simulation::new(model, start, plan.method.clone())?;
    in_contact(simulation.with_control(plan.control.clone())?, contact)
}

/// A simulation that knows its equations, and takes no steps.
fn equations(
    family: &dyn Family,
    numbers: &[f64],
    plan: &Plan,
    number: Option<usize>,
) -> Result<Simulation, AdjointError> {
    let Scene {
        model,
        start,
        contact,
    } = scene(family, numbers, number)?;
    let simulation = Simulation::of_equations(model, start, plan.method.clone())?;
    in_contact(simulation, contact)
}

fn in_contact(
    simulation: Simulation,
    contact: Option<Box<dyn Contact>>,
) -> Result<Simulation, AdjointError> {
    Ok(match contact {
        Some(contact) => simulation.with_boxed_contact(contact)?,
        None => simulation,
    })
}

/// Takes a step.
fn step(
    simulation: &mut Simulation,
    h: f64,
    number: usize,
    watch: &mut dyn FnMut() -> ControlFlow<()>,
) -> Result<(), AdjointError> {
    match simulation.step_watched(h, &mut |_| watch()) {
        Ok(_) => Ok(()),
        Err(StepError::Interrupted { .. }) => Err(AdjointError::Interrupted),
        Err(source) => Err(AdjointError::Step { number, source }),
    }
}

/// Takes some steps of a plan, and hands each state to `see`.
fn take(
    (simulation, watch): (&mut Simulation, &mut dyn FnMut() -> ControlFlow<()>),
    plan: &Plan,
    first: usize,
    count: usize,
    mut see: impl FnMut(&State),
) -> Result<Steps, AdjointError> {
    let taken: Arc<Mutex<Vec<AcceptedStep>>> = Arc::default();
    let sink = Arc::clone(&taken);
    let list = |taken: &Mutex<Vec<AcceptedStep>>| {
        std::mem::take(&mut *taken.lock().unwrap_or_else(PoisonError::into_inner))
    };
    simulation.set_recorder(move |step| {
        sink.lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(step);
    });
    let mut steps = Vec::with_capacity(count);
    for number in first..first + count {
        step(simulation, plan.steps[number], number, watch)?;
        let own = list(&taken);
        if own.is_empty() {
            return Err(AdjointError::Method { number });
        }
        steps.push(own);
        see(simulation.state());
    }
    Ok(steps)
}
