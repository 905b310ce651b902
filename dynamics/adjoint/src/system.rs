//! The linear system of a step, transposed.

use crate::blocks::Blocks;
use crate::error::AdjointError;
use crate::factor::{Factor, STIFFNESS, Space};
use crate::gradient::Effort;
use crate::krylov::{self, System};
use crate::memory::add_memory_products;
use crate::options::AdjointOptions;
use crate::rows::Rows;
use isosheet_dynamics::Simulation;
use isosheet_dynamics::sensitivity::{AcceptedStep, FrictionLag, ReachedPairs, StepEquations};
use isosheet_materials::NoDerivative;
use isosheet_model::{PINNED, SheetModel};
use std::sync::Arc;

/// Most iterations of a linear system with its own matrix factorised.
const MOST_ITERATIONS: usize = 400;

/// Change of the effective step by which another factorisation is of no use.
const STEP_CHANGE: f64 = 0.1;

/// Residual from which a system counts as unsolved.
const UNSOLVED: f64 = 1e-6;

/// What is asked for: `w` and `m` with
///
/// ```text
/// K^T w + G^T m = l on the free vertices,   G w = 0,
/// ```
///
/// the derivative `K` of the residual of a step by the positions at its end, and those `l` of a loss. A loss
/// of the forces `R / h^2` at pins and `-J^T L / h^2` of vertex constraints, with derivatives `f` by these,
/// gives `w = -f / h^2` at pins, and `G w` its derivatives by `L`.
pub(crate) struct Request<'a, 'o> {
    pub(crate) simulation: &'a mut Simulation,
    pub(crate) step: &'a AcceptedStep,
    pub(crate) x: &'a [f64],
    pub(crate) lag: FrictionLag<'a>,
    pub(crate) is_settled: bool,
    pub(crate) of_x: &'a [f64],
    /// `f`, `3V`; empty where the loss does not depend on forces.
    pub(crate) of_forces: &'a [f64],
    pub(crate) rows: &'a Rows<'a>,
    pub(crate) blocks: &'a mut Blocks,
    pub(crate) factor: &'a mut Option<Factor>,
    pub(crate) options: &'o AdjointOptions,
    pub(crate) effort: &'a mut Effort,
}

/// The solution.
pub(crate) struct Solution {
    /// `3V`.
    pub(crate) w: Vec<f64>,
    pub(crate) multipliers: Vec<f64>,
    /// `K^T w + G^T m` on all vertices.
    pub(crate) image: Vec<f64>,
    /// Derivatives of `w . R` by what potentials remember.
    pub(crate) memory: Vec<Vec<f64>>,
    /// The pairs of contact.
    pub(crate) pairs: ReachedPairs,
    /// What counted as constant.
    pub(crate) passed: Vec<NoDerivative>,
}

/// Solves.
///
/// # Errors
/// [`AdjointError::Unsolved`], [`AdjointError::Equations`] and [`AdjointError::Linalg`].
pub(crate) fn solve(request: Request<'_, '_>) -> Result<Solution, AdjointError> {
    let Request {
        simulation,
        step,
        x,
        lag,
        is_settled,
        of_x,
        of_forces,
        rows,
        blocks,
        factor,
        options,
        effort,
    } = request;
    let t = step.end.t;
    let failed = |source| AdjointError::Linalg { t, source };
    let model = Arc::clone(simulation.model());
    let mut equations = simulation
        .step_equations()
        .ok_or(AdjointError::Method { number: 0 })?;
    let begun = equations.begin(step, lag, x);
    begun.map_err(|source| AdjointError::Equations { t, source })?;
    blocks.clear();
    equations.add_hessian(step, x, blocks);
    let mut is_fresh = false;
    if !factor.as_ref().is_some_and(|own| own.has_room(blocks)) {
        let count = factor.as_ref().map_or(0, |own| own.count);
        let mut own = Factor::new(&model, blocks).map_err(failed)?;
        own.count = count;
        *factor = Some(own);
    }
    let own = factor.as_mut().expect("it has been made");
    let is_other = (own.h / step.h - 1.0).abs() > STEP_CHANGE;
    let is_other = is_other || own.penalties.len() != rows.len();
    let patience = own.patience(options.patience);
    if is_other || patience == 0 {
        own.factorize(&model, blocks, rows, step.h)
            .map_err(failed)?;
        is_fresh = true;
    }
    let free = 3 * model.free_count();
    let mut b = vec![0.0; free + rows.len()];
    let space = Space::new(&model, rows.len());
    let mut z = vec![0.0; b.len()];
    let mut operator = Operator {
        model: &model,
        equations: &mut equations,
        step,
        x,
        is_settled,
        rows,
        blocks,
        factor: own,
        space,
        out: vec![0.0; x.len()],
        passed: Vec::new(),
    };
    let at_pins = operator.at_pins(of_forces);
    let mut of_x = of_x.to_vec();
    if !of_forces.is_empty() {
        let of_multipliers = rows.pull_forces(step, of_forces, &mut of_x);
        b[free..].copy_from_slice(&of_multipliers);
        operator.image(&at_pins, &vec![0.0; rows.len()]);
        of_x.iter_mut()
            .zip(&operator.out)
            .for_each(|(o, i)| *o -= i);
        rows.apply(&at_pins, &mut operator.space.rows);
        for (row, (b, g)) in b[free..].iter_mut().zip(&operator.space.rows).enumerate() {
            if !rows.is_between_pins(row) {
                *b -= g;
            }
        }
    }
    operator.space.full.copy_from_slice(&of_x);
    operator.space.gather_add(&mut b[..free]);
    effort.systems += 1;
    let tolerance = options.tolerance;
    let mut solved;
    loop {
        let most = match is_fresh {
            true => MOST_ITERATIONS,
            false => patience,
        };
        let weights = operator.weights();
        solved = krylov::solve(&mut operator, &b, &weights, tolerance, most, &mut z);
        effort.iterations += solved.iterations;
        if solved.residual <= tolerance || is_fresh {
            break;
        }
        operator.factor.give_up();
        let own = &mut *operator.factor;
        own.factorize(&model, operator.blocks, rows, step.h)
            .map_err(failed)?;
        is_fresh = true;
    }
    if solved.residual.is_nan() || solved.residual > UNSOLVED {
        return Err(AdjointError::Unsolved {
            t,
            residual: solved.residual,
        });
    }
    effort.residual = effort.residual.max(solved.residual);
    let (w, multipliers) = z.split_at(free);
    operator.space.scatter(w);
    let mut w = at_pins;
    w.iter_mut()
        .zip(&operator.space.full)
        .for_each(|(w, own)| *w += own);
    operator.image(&w, multipliers);
    let mut passed = std::mem::take(&mut operator.passed);
    passed.dedup();
    let image = std::mem::take(&mut operator.out);
    let memory = operator.memory_of(&w);
    let pairs = operator.equations.pairs();
    Ok(Solution {
        w,
        multipliers: multipliers.to_vec(),
        image,
        memory,
        pairs,
        passed,
    })
}

/// The matrix of the system, preconditioned by a factorisation.
struct Operator<'a, 'e> {
    model: &'a Arc<SheetModel>,
    equations: &'a mut StepEquations<'e>,
    step: &'a AcceptedStep,
    x: &'a [f64],
    is_settled: bool,
    rows: &'a Rows<'a>,
    blocks: &'a Blocks,
    factor: &'a mut Factor,
    space: Space<'a>,
    /// `3V`.
    out: Vec<f64>,
    passed: Vec<NoDerivative>,
}

impl Operator<'_, '_> {
    /// In what units the unknowns are measured: the stiffness at their vertices,
    /// and the inverse of that of equations as stiff.
    fn weights(&self) -> Vec<f64> {
        let mut weights = vec![0.0; 3 * self.model.free_count()];
        for (v, i) in self.model.free_index().iter().enumerate() {
            if *i != PINNED {
                let size = self.blocks.at_vertices[v].diagonal().amax();
                weights[3 * *i as usize..3 * *i as usize + 3].fill(size);
            }
        }
        let rows = self.factor.penalties.iter();
        weights.extend(rows.map(|r| if *r > 0.0 { STIFFNESS / r } else { 0.0 }));
        weights
    }

    /// `w` at pins (`3V`, zero elsewhere) of a loss with derivatives by forces.
    fn at_pins(&self, of_forces: &[f64]) -> Vec<f64> {
        let mut w = vec![0.0; self.x.len()];
        let scale = -1.0 / (self.step.h * self.step.h);
        for (i, (w, of)) in w.iter_mut().zip(of_forces).enumerate() {
            if self.model.free_index()[i / 3] == PINNED {
                *w = scale * of;
            }
        }
        w
    }

    /// Derivatives of `w . R` by what potentials remember.
    fn memory_of(&self, w: &[f64]) -> Vec<Vec<f64>> {
        let forces = self.step.h * self.step.h;
        let scaled: Vec<f64> = w.iter().map(|w| forces * w).collect();
        let memories = &self.step.memories;
        let lists = memories.lists().iter();
        let mut of: Vec<Vec<f64>> = lists.map(|l| vec![0.0; l.len()]).collect();
        let at = (self.step.start.t + self.step.span, self.x);
        add_memory_products(self.model, at, memories, &scaled, &mut of);
        of
    }

    /// Sets `out` to `K^T w + G^T m`.
    fn image(&mut self, w: &[f64], multipliers: &[f64]) {
        self.out.fill(0.0);
        self.blocks.add_product(w, &mut self.out);
        if self.is_settled {
            self.equations
                .add_lag_products(self.step, self.x, w, &mut self.out);
        }
        let ends = self
            .equations
            .add_end_products(self.step, self.x, w, &mut self.out);
        if let Err(source) = ends {
            self.passed.push(source);
        }
        if self.rows.len() > 0 {
            self.rows.add_transpose(multipliers, &mut self.out);
        }
    }
}

impl System for Operator<'_, '_> {
    fn apply(&mut self, z: &[f64], out: &mut [f64]) {
        let (w, multipliers) = z.split_at(self.space.free());
        self.space.scatter(w);
        let w = std::mem::take(&mut self.space.full);
        self.image(&w, multipliers);
        let (a, b) = out.split_at_mut(self.space.free());
        if self.rows.len() > 0 {
            self.rows.apply(&w, b);
        }
        self.space.full = w;
        std::mem::swap(&mut self.space.full, &mut self.out);
        a.fill(0.0);
        self.space.gather_add(a);
        std::mem::swap(&mut self.space.full, &mut self.out);
    }

    fn precondition(&mut self, z: &mut [f64]) {
        self.factor.solve(self.rows, &mut self.space, z);
    }
}
