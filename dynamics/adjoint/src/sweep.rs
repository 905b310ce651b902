//! From the end of a run back to its start.

mod shares;

use crate::blocks::Blocks;
use crate::error::AdjointError;
use crate::factor::Factor;
use crate::gradient::{Effort, Gradient, PassedBy};
use crate::level::{Level, levels};
use crate::memory::{choices, pull_settling, settled_products, start_memories};
use crate::neighbours::Neighbours;
use crate::options::{AdjointOptions, Branches};
use crate::rows::Rows;
use crate::system::{Request, Solution, solve};
use isosheet_dynamics::Simulation;
use isosheet_dynamics::sensitivity::{AcceptedStep, FrictionLag, OfState, ReachedPairs, StepKind};
use isosheet_materials::NoDerivative;
use isosheet_materials::potential::Memories;
use isosheet_materials::vectors::dot;
use isosheet_model::{PINNED, SheetModel, State};
use std::sync::Arc;

/// Derivatives of a loss by the state of a run, on the way back.
pub(crate) struct Sweep<'o> {
    options: &'o AdjointOptions,
    base: Simulation,
    model: Arc<SheetModel>,
    neighbours: Vec<Neighbours>,
    /// By the state where the sweep has come to.
    end: OfState,
    /// By the state before, as far as later steps look back to it.
    earlier: OfState,
    /// By what the potentials remember there.
    memory: Vec<Vec<f64>>,
    /// By the forces of supports in the step that ends there, `3V`; empty for most.
    of_forces: Vec<f64>,
    of_numbers: Vec<f64>,
    blocks: Blocks,
    factor: Option<Factor>,
    passed_by: Vec<PassedBy>,
    effort: Effort,
}

impl<'o> Sweep<'o> {
    pub(crate) fn new(base: Simulation, options: &'o AdjointOptions) -> Self {
        let model = Arc::clone(base.model());
        let n = model.coordinate_count();
        Self {
            options,
            end: OfState::zeros(n),
            earlier: OfState::zeros(n),
            memory: zeros_like(base.memories()),
            base,
            of_forces: Vec::new(),
            neighbours: Vec::new(),
            of_numbers: Vec::new(),
            blocks: Blocks::of(&model),
            factor: None,
            passed_by: Vec::new(),
            effort: Effort::default(),
            model,
        }
    }

    /// Adds a number, the next one.
    ///
    /// # Errors
    /// [`AdjointError::OtherSheet`].
    pub(crate) fn add_number(&mut self, neighbours: Neighbours) -> Result<(), AdjointError> {
        let number = neighbours.number;
        for simulation in &neighbours.simulations {
            let (own, other) = (&self.model, simulation.model());
            let what = if own.topology().faces() != other.topology().faces() {
                "another mesh"
            } else if own.free_index() != other.free_index() {
                "other pinned vertices"
            } else if own.rod_edges() != other.rod_edges()
                || own.constraints().len() != other.constraints().len()
            {
                "other rods or supports"
            } else if lengths(self.base.memories()) != lengths(simulation.memories()) {
                "other memories of potentials"
            } else {
                continue;
            };
            return Err(AdjointError::OtherSheet { number, what });
        }
        self.neighbours.push(neighbours);
        self.of_numbers.push(0.0);
        Ok(())
    }

    /// Goes back over an accepted sub-step.
    ///
    /// # Errors
    /// [`AdjointError`] naming what has no derivative.
    pub(crate) fn step_back(&mut self, step: &AcceptedStep) -> Result<(), AdjointError> {
        let n = step.end.x.len();
        let t = step.end.t;
        for event in &step.events {
            let event = AdjointError::Event { t, event: *event };
            self.refuse_or_pass(t, event)?;
        }
        self.effort.substeps += 1;
        let mut of_x = std::mem::take(&mut self.end.x);
        let mut of_v = std::mem::take(&mut self.end.v);
        self.settle_back(step, &mut of_x)?;
        match step.kind {
            StepKind::Motion => of_x
                .iter_mut()
                .zip(&of_v)
                .for_each(|(x, v)| *x += v / step.h),
            // It is at rest.
            StepKind::Search => of_v.fill(0.0),
        }
        let mut of_start = OfState::zeros(n);
        let mut of_before = OfState::zeros(n);
        let mut pinned = vec![0.0; n];
        let model = Arc::clone(&self.model);
        let mut at_level = of_x;
        let mut of_forces = std::mem::take(&mut self.of_forces);
        let is_zero = |of: &[f64]| of.iter().all(|x| *x == 0.0);
        for level in levels(&model, step) {
            if is_zero(&at_level) && is_zero(&of_v) && is_zero(&of_forces) {
                at_level.fill(0.0);
                break;
            }
            at_level = self.level_back(
                step,
                level,
                (&at_level, &of_v, &of_forces),
                (&mut of_start, &mut of_before),
                &mut pinned,
            )?;
            of_v.fill(0.0);
            of_forces.clear();
        }
        self.pins_back(step, &pinned, &mut of_start);
        if of_start.x.iter().chain(&of_start.v).any(|d| !d.is_finite()) {
            return Err(AdjointError::NotFinite { t: step.start.t });
        }
        let earlier = std::mem::replace(&mut self.earlier, of_before);
        for (own, earlier) in [(&mut of_start.x, &earlier.x), (&mut of_start.v, &earlier.v)] {
            own.iter_mut().zip(earlier).for_each(|(o, e)| *o += e);
        }
        self.end = of_start;
        Ok(())
    }

    /// Hands derivatives by what potentials remember at the end of a step on to the state there, to what they
    /// remembered in the step, and to the numbers.
    fn settle_back(&mut self, step: &AcceptedStep, of_x: &mut [f64]) -> Result<(), AdjointError> {
        let choices = choices(&self.model, &step.end, &step.memories);
        let has_any = self.memory.iter().flatten().any(|m| *m != 0.0);
        for neighbours in self.neighbours.iter().filter(|_| has_any) {
            let [up, down] = neighbours.simulations.each_ref().map(|simulation| {
                let model = simulation.model();
                let found = (&step.memories, &choices[..]);
                let differences = &neighbours.of_memories;
                settled_products(model, &step.end, found, &self.memory, differences)
            });
            self.of_numbers[neighbours.number] += (up - down) / neighbours.distance;
        }
        let model = Arc::clone(&self.model);
        let mut passed = Vec::new();
        pull_settling(
            &model,
            &step.end,
            (&step.memories, &choices),
            &mut self.memory,
            of_x,
            |none| passed.push(none),
        );
        for source in passed {
            self.refuse(step.end.t, source)?;
        }
        Ok(())
    }

    /// Goes back over the solution of the equations of a step at a place. Returns the derivatives by the
    /// place before it, where friction was lagged.
    fn level_back(
        &mut self,
        step: &AcceptedStep,
        level: Level<'_>,
        (of_x, of_v, of_forces): (&[f64], &[f64], &[f64]),
        (of_start, of_before): (&mut OfState, &mut OfState),
        pinned: &mut [f64],
    ) -> Result<Vec<f64>, AdjointError> {
        let t = step.end.t;
        let n = of_x.len();
        let model = Arc::clone(&self.model);
        let rows = Rows::at(&model, step, level.x);
        let Solution {
            w,
            multipliers,
            image,
            memory,
            pairs,
            passed,
        } = solve(Request {
            simulation: &mut self.base,
            step,
            x: level.x,
            lag: level.lag,
            is_settled: level.is_settled,
            of_x,
            of_forces,
            rows: &rows,
            blocks: &mut self.blocks,
            factor: &mut self.factor,
            options: self.options,
            effort: &mut self.effort,
        })?;
        for source in passed {
            self.refuse(t, source)?;
        }
        // Of pinned vertices what they pull at others by.
        for (v, i) in model.free_index().iter().enumerate() {
            if *i == PINNED {
                for k in 3 * v..3 * v + 3 {
                    pinned[k] += of_x[k] - image[k];
                }
            }
        }
        self.numbers_back(step, level, (&w, &multipliers, of_forces), &pairs)?;
        let mut next = vec![0.0; n];
        let mut equations = self
            .base
            .step_equations()
            .ok_or(AdjointError::Method { number: 0 })?;
        equations.go_on(step);
        if !level.is_settled {
            let mut products = vec![0.0; n];
            equations.add_lag_products(step, level.x, &w, &mut products);
            match level.lag {
                FrictionLag::Start => {
                    of_start
                        .x
                        .iter_mut()
                        .zip(&products)
                        .for_each(|(o, p)| *o -= p);
                }
                FrictionLag::Places(_) => {
                    next.iter_mut().zip(&products).for_each(|(o, p)| *o -= p);
                }
            }
        }
        let pulled = equations.pull_back(step, level.x, &w, of_v, of_start, of_before);
        if let Err(source) = pulled {
            self.refuse(t, source)?;
        }
        for (own, of) in self.memory.iter_mut().zip(&memory) {
            own.iter_mut().zip(of).for_each(|(o, m)| *o -= m);
        }
        Ok(next)
    }

    /// Adds `-w . dR/dp` and `-m . dc/dp` of a place to the derivatives by the numbers, and what these do to
    /// the forces of vertex constraints.
    fn numbers_back(
        &mut self,
        step: &AcceptedStep,
        level: Level<'_>,
        (w, multipliers, of_forces): (&[f64], &[f64], &[f64]),
        pairs: &ReachedPairs,
    ) -> Result<(), AdjointError> {
        let t = step.end.t;
        for neighbours in &mut self.neighbours {
            let mut ends = [0.0; 2];
            for (end, simulation) in ends.iter_mut().zip(&mut neighbours.simulations) {
                let model = Arc::clone(simulation.model());
                let mut equations = simulation
                    .step_equations()
                    .ok_or(AdjointError::Method { number: 0 })?;
                let begun = equations.begin_like(step, level.lag, level.x, pairs);
                begun.map_err(|source| AdjointError::Equations { t, source })?;
                let mut residual = vec![0.0; level.x.len()];
                let differences = &neighbours.differences;
                equations.residual_of(differences, step, level.x, &mut residual);
                *end = dot(w, &residual);
                if !multipliers.is_empty() {
                    let values = Rows::values(&model, step, level.x);
                    *end += dot(multipliers, &values);
                }
                if !of_forces.is_empty() {
                    *end -= dot(of_forces, &Rows::forces(&model, step, level.x));
                }
            }
            let slope = (ends[0] - ends[1]) / neighbours.distance;
            self.of_numbers[neighbours.number] -= slope;
        }
        Ok(())
    }

    /// Hands derivatives by the positions of pins at the end of a step on: pins at rest have those of the
    /// start, and others those of their motions.
    fn pins_back(&mut self, step: &AcceptedStep, pinned: &[f64], of_start: &mut OfState) {
        let mut rests = vec![true; pinned.len() / 3];
        for v in self.model.moving_pins() {
            rests[v] = false;
        }
        for (v, rests) in rests.iter().enumerate() {
            if *rests {
                for k in 3 * v..3 * v + 3 {
                    of_start.x[k] += pinned[k];
                }
            }
        }
        for neighbours in &self.neighbours {
            let [up, down] = neighbours.simulations.each_ref().map(|simulation| {
                let mut x = step.end.x.clone();
                simulation.model().place_pins(step.end.t, &mut x);
                dot(pinned, &x)
            });
            self.of_numbers[neighbours.number] += (up - down) / neighbours.distance;
        }
    }

    /// The gradient, at the state where the run started.
    ///
    /// # Errors
    /// [`AdjointError::NoDerivative`].
    pub(crate) fn finish(mut self, start: &State, value: f64) -> Result<Gradient, AdjointError> {
        let pins = self.model.free_index().iter().enumerate();
        let pins = pins.filter(|(_, i)| **i == PINNED);
        let moving: Vec<usize> = self.model.moving_pins().collect();
        for neighbours in &self.neighbours {
            let [up, down] = neighbours.simulations.each_ref().map(|simulation| {
                let state = simulation.state();
                let memories = simulation.memories().lists();
                let remembered = self.memory.iter().zip(memories).map(|(of, m)| dot(of, m));
                dot(&self.end.x, &state.x) + dot(&self.end.v, &state.v) + remembered.sum::<f64>()
            });
            self.of_numbers[neighbours.number] += (up - down) / neighbours.distance;
        }
        for (v, _) in pins {
            if moving.contains(&v) {
                self.end.v[3 * v..3 * v + 3].fill(0.0);
            }
        }
        let mut passed = Vec::new();
        let mut of_x = std::mem::take(&mut self.end.x);
        start_memories(&self.model, start, &self.memory, &mut of_x, |none| {
            passed.push(none);
        });
        self.end.x = of_x;
        for source in passed {
            self.refuse(start.t, source)?;
        }
        self.effort.factorisations = self.factor.as_ref().map_or(0, |factor| factor.count);
        Ok(Gradient {
            value,
            of_numbers: self.of_numbers,
            of_start: self.end,
            passed_by: self.passed_by,
            effort: self.effort,
        })
    }

    fn refuse(&mut self, t: f64, source: NoDerivative) -> Result<(), AdjointError> {
        self.refuse_or_pass(t, AdjointError::NoDerivative { t, source })
    }

    fn refuse_or_pass(&mut self, t: f64, error: AdjointError) -> Result<(), AdjointError> {
        match self.options.branches {
            Branches::Refuse => Err(error),
            Branches::PassBy => {
                let what = error.to_string();
                let known = self.passed_by.last();
                if known.is_none_or(|known| known.t != t || known.what != what) {
                    self.passed_by.push(PassedBy { t, what });
                }
                Ok(())
            }
        }
    }
}

fn zeros_like(memories: &Memories) -> Vec<Vec<f64>> {
    let lists = memories.lists().iter();
    lists.map(|list| vec![0.0; list.len()]).collect()
}

fn lengths(memories: &Memories) -> Vec<usize> {
    memories.lists().iter().map(Vec::len).collect()
}
