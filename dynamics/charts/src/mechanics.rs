//! Momenta, Hamiltonian and its derivatives at a state.

use super::{ChartDynamicsError, MassSolver, MassSolverKind};
use isosheet_coords::{Chart, Linearised, RodSystem};
use isosheet_dynamics::Memories;
use isosheet_dynamics::SheetModel;
use isosheet_mesh::VertexId;
use std::sync::Arc;

/// Which terms of the equations of motion are kept, and what happens to the momenta.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Equations {
    /// Sec. 4.1 as published: `dH/dq = dV/dq`, the Jacobian taken as constant, momenta carried over
    /// from step to step. Not a consistent approximation of Eq. 19: it does not converge to the
    /// motion as the step goes to zero.
    Published,
    /// Sec. 4.1 with momenta that are formed anew after every step, `p = J^T M v`, from the velocities of the
    /// vertices at the new state; the right-hand side is that of [`Equations::Published`]. Converges with
    /// first order.
    Reformed,
    /// Hamilton's equations with the velocity-squared terms, `dH/dq = dV/dq + dT/dq`.
    #[default]
    Full,
}

/// A model in a chart: everything that Hamilton's equations (19) need at a state.
///
/// Call [`ChartMechanics::at`] first; the other methods refer to the state given there.
pub struct ChartMechanics {
    model: Arc<SheetModel>,
    /// What the potentials remember.
    memories: Memories,
    system: RodSystem,
    chart: Box<dyn Chart>,
    linear: Linearised,
    solver: Box<dyn MassSolver>,
    kind: MassSolverKind,
    work: Work,
}

/// A chart that a mechanics no longer uses, with the memory of its pattern.
pub(super) struct ReplacedChart {
    chart: Box<dyn Chart>,
    linear: Linearised,
    solver: Box<dyn MassSolver>,
}

struct Work {
    full: Vec<f64>,
    reduced: Vec<f64>,
    mu: Vec<f64>,
    p: Vec<f64>,
    rates: Vec<f64>,
}

impl ChartMechanics {
    /// The mechanics of a model in a chart.
    ///
    /// Pins that the chart eliminates have to be fixed pins of the model. The model's other pins are free in
    /// the chart; [`ChartSimulation`](super::ChartSimulation) imposes them by closure equations.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`], [`ChartDynamicsError::TooManyCoordinates`]; and
    /// [`ChartDynamicsError::WrongLength`], [`ChartDynamicsError::OtherPins`] or
    /// [`ChartDynamicsError::MovingPin`] when the chart belongs to another sheet or to other pins.
    pub fn new(
        model: SheetModel,
        chart: Box<dyn Chart>,
        kind: MassSolverKind,
    ) -> Result<Self, ChartDynamicsError> {
        let vertices = model.topology().vertex_count();
        if chart.system().vertex_count() != vertices {
            return Err(ChartDynamicsError::WrongLength {
                what: "the vertices of the chart's sheet",
                found: chart.system().vertex_count(),
                expected: vertices,
            });
        }
        let pinned = |v: &VertexId| chart.system().unknown(*v).is_none();
        let pins: Vec<VertexId> = model.topology().vertex_ids().filter(pinned).collect();
        if let Some(&vertex) = pins.iter().find(|v| !model.is_pinned(**v)) {
            return Err(ChartDynamicsError::OtherPins { vertex });
        }
        if let Some(&vertex) = pins.iter().find(|v| model.pin_motion(**v).is_some()) {
            return Err(ChartDynamicsError::MovingPin { vertex });
        }
        let system = RodSystem::from_parts(model.topology(), model.rods().lengths(), &pins)
            .map_err(isosheet_coords::ChartError::from)?;
        if chart.dimension() != system.dof() {
            return Err(ChartDynamicsError::WrongLength {
                what: "the chart (built for this sheet and these pins)",
                found: chart.dimension(),
                expected: system.dof(),
            });
        }
        let linear = Linearised::new(&system, chart.pattern())?;
        let solver = kind.build(&system, model.mass())?;
        let work = Work {
            full: vec![0.0; model.coordinate_count()],
            reduced: vec![0.0; system.unknowns()],
            mu: vec![0.0; system.equations()],
            p: vec![0.0; system.dof()],
            rates: Vec::new(),
        };
        Ok(Self {
            memories: model.memories(),
            model: Arc::new(model),
            system,
            chart,
            linear,
            solver,
            kind,
            work,
        })
    }

    /// What the potentials remember.
    pub(crate) fn memories(&self) -> &Memories {
        &self.memories
    }

    /// What the potentials remember, to be changed between two steps.
    pub(super) fn memories_mut(&mut self) -> &mut Memories {
        &mut self.memories
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<SheetModel> {
        &self.model
    }

    /// The rods and unknowns.
    #[must_use]
    pub fn system(&self) -> &RodSystem {
        &self.system
    }

    /// The chart.
    #[must_use]
    pub fn chart(&self) -> &dyn Chart {
        self.chart.as_ref()
    }

    /// Number of coordinates n.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.chart.dimension()
    }

    /// Takes the state x as the reference state of the chart; coordinates and momenta change. Returns the
    /// chart before.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`]; the chart stays as it was.
    pub(super) fn rebase(&mut self, x: &[f64]) -> Result<ReplacedChart, ChartDynamicsError> {
        let chart = self.chart.rebased(x)?;
        let linear = Linearised::new(&self.system, chart.pattern())?;
        let solver = self.kind.build(&self.system, self.model.mass())?;
        Ok(self.exchange(ReplacedChart {
            chart,
            linear,
            solver,
        }))
    }

    /// Takes another chart of the same system; returns the chart before.
    pub(super) fn exchange(&mut self, other: ReplacedChart) -> ReplacedChart {
        let ReplacedChart {
            chart,
            linear,
            solver,
        } = other;
        ReplacedChart {
            chart: std::mem::replace(&mut self.chart, chart),
            linear: std::mem::replace(&mut self.linear, linear),
            solver: std::mem::replace(&mut self.solver, solver),
        }
    }

    /// Factorise everything at the state x.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] where the chart is singular, as in flat states of sheets with
    /// inner vertices; [`ChartDynamicsError::SingularMass`].
    pub fn at(&mut self, x: &[f64]) -> Result<(), ChartDynamicsError> {
        self.chart.linearise(&self.system, &mut self.linear, x)?;
        self.solver.prepare(
            &self.system,
            self.chart.as_ref(),
            self.model.mass(),
            &mut self.linear,
            x,
        )
    }

    /// Momenta `p = J^T M v` (Eqs. 16 and 21) of velocities v (three per vertex).
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] where the chart is singular.
    pub fn momenta(&mut self, v: &[f64], p: &mut [f64]) -> Result<(), ChartDynamicsError> {
        let w = &mut self.work;
        let mass = self.model.mass();
        mass.apply(self.model.topology(), v, &mut w.full);
        self.system.gather(&w.full, &mut w.reduced);
        self.linear.pull(&w.reduced, &mut w.mu, p)?;
        Ok(())
    }

    /// Generalised force `J^T f` of forces f on the vertices (Sec. 5).
    ///
    /// # Errors
    /// As [`ChartMechanics::momenta`].
    pub fn generalised_force(
        &mut self,
        f: &[f64],
        generalised: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        let w = &mut self.work;
        self.system.gather(f, &mut w.reduced);
        self.linear.pull(&w.reduced, &mut w.mu, generalised)?;
        Ok(())
    }

    /// Velocities of the coordinates, `qdot = dH/dp = C^-1 p` (Eq. 18), and of the vertices, `v = J qdot`
    /// (Eq. 5).
    ///
    /// # Errors
    /// [`ChartDynamicsError::SingularMass`], [`ChartDynamicsError::Chart`].
    pub fn velocity(
        &mut self,
        p: &[f64],
        qdot: &mut [f64],
        v: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        self.solver.momentum_gradient(p, qdot)?;
        self.linear.push(qdot, &mut self.work.reduced)?;
        self.system.scatter(&self.work.reduced, v);
        Ok(())
    }

    /// The solver, for `dH/dp` as published.
    pub fn solver(&mut self) -> &mut dyn MassSolver {
        self.solver.as_mut()
    }

    /// `H = T + V` (Eq. 17) in joules, at the state x given to [`ChartMechanics::at`].
    ///
    /// # Errors
    /// As [`ChartMechanics::velocity`].
    pub fn hamiltonian(&mut self, t: f64, x: &[f64], p: &[f64]) -> Result<f64, ChartDynamicsError> {
        let mut qdot = std::mem::take(&mut self.work.p);
        let solved = self.solver.velocity(p, &mut qdot);
        let twice: f64 = p.iter().zip(&qdot).map(|(p, q)| p * q).sum();
        self.work.p = qdot;
        solved?;
        Ok(0.5 * twice + self.model.energy_with(&self.memories, t, x))
    }

    /// `pdot = -dH/dq + Q` (Eqs. 19 and 22) at (x, p), with v the velocities of the vertices that belong to
    /// p.
    ///
    /// With `A^T [mu; p] = M v` the velocity-squared term is
    ///
    /// ```text
    /// dT/dq at fixed qdot = -J^T ( G(v)^T mu + sum_k p_k (rate of s_k along v) ),
    /// ```
    ///
    /// from differentiating `A v = [0; qdot]`: a change dx of the state changes v by
    /// `-A^-1 (dA) v`, `G(dx) v = G(v) dx` because the lengths are quadratic, and the Hessian of each
    /// coordinate is symmetric. At fixed p the derivative of T has the opposite sign. One more transposed
    /// solve, no second derivatives formed.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] where the chart is singular.
    pub fn momentum_rate(
        &mut self,
        t: f64,
        x: &[f64],
        v: &[f64],
        equations: Equations,
        pdot: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        let w = &mut self.work;
        let mut force = vec![0.0; self.system.unknowns()];
        if equations == Equations::Full {
            let mass = self.model.mass();
            mass.apply(self.model.topology(), v, &mut w.full);
            self.system.gather(&w.full, &mut w.reduced);
            self.linear.pull(&w.reduced, &mut w.mu, &mut w.p)?;
            self.system.add_transpose(v, &w.mu, &mut force);
            w.rates.resize(self.chart.pattern().len(), 0.0);
            self.chart.rows_rate(x, v, &mut w.rates)?;
            self.chart
                .pattern()
                .add_transpose(&w.rates, &w.p, &mut force);
            force.iter_mut().for_each(|f| *f = -*f);
        }
        self.add_forces(t, x, v, &mut force);
        self.linear.pull(&force, &mut self.work.mu, pdot)?;
        Ok(())
    }

    /// Adds potential and applied forces on the unknowns.
    pub(super) fn add_forces(&mut self, t: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        let w = &mut self.work;
        let memories = &self.memories;
        self.model.force_with(memories, t, x, &mut w.full);
        self.system.gather(&w.full, &mut w.reduced);
        for (f, r) in force.iter_mut().zip(&w.reduced) {
            *f += r;
        }
        if self.model.has_applied_forces() {
            w.full.fill(0.0);
            self.model.add_applied_force(t, x, v, &mut w.full);
            self.system.gather(&w.full, &mut w.reduced);
            for (f, r) in force.iter_mut().zip(&w.reduced) {
                *f += r;
            }
        }
    }

    /// One power iteration on C at the state given to [`ChartMechanics::at`]: replaces `w` by `C w / |w|`
    /// and returns the length of that, an estimate of the largest eigenvalue of C from below.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] where the chart is singular.
    pub(super) fn power_step(&mut self, w: &mut [f64]) -> Result<f64, ChartDynamicsError> {
        let length = |a: &[f64]| a.iter().map(|c| c * c).sum::<f64>().sqrt();
        let size = length(w);
        w.iter_mut().for_each(|c| *c /= size);
        let mut v = vec![0.0; self.model.coordinate_count()];
        self.linear.push(w, &mut self.work.reduced)?;
        self.system.scatter(&self.work.reduced, &mut v);
        self.momenta(&v, w)?;
        Ok(length(w))
    }

    /// Coordinates of x.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`].
    pub fn coordinates(&self, x: &[f64], q: &mut [f64]) -> Result<(), ChartDynamicsError> {
        Ok(self.chart.coordinates(x, q)?)
    }

    /// Positions with exact lengths and coordinates q near a state. Afterwards call
    /// [`ChartMechanics::at`] again.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`].
    pub fn realise(
        &mut self,
        q: &[f64],
        near: &[f64],
        x: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        Ok(self.chart.realise(&mut self.linear, q, near, x)?)
    }
}
