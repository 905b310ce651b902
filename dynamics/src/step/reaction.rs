//! Forces of supports on the sheet.

use crate::linear::constraint_rows::VertexRows;
use crate::report::checkpoint_error::{CheckpointError, check_finite, check_length};
use crate::step::residual_momentum::ResidualMomentum;
use crate::{SheetModel, State};
use isosheet_materials::potential::Memories;
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::VertexId;
use isosheet_model::Support;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The force of a support on the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reaction {
    /// The support.
    pub support: Support,
    /// Force on the sheet, newtons.
    pub force: Vector3<f64>,
}

/// What the forces of supports leave of the balance of forces and torques of a sub-step: reactions, contact,
/// weight and all other forces, less the rate of the momentum
/// ([`Simulation::reactions`](crate::Simulation::reactions)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Imbalance {
    /// Sum of all forces, newtons; zero where they balance.
    pub force: Vector3<f64>,
    /// Sum of their torques about the mean of the vertices, newton metres.
    pub torque: Vector3<f64>,
    /// Sum of the magnitudes of the forces of the supports, newtons, to compare the force with.
    pub forces: f64,
    /// Sum of the magnitudes of their torques about the mean of the vertices, newton metres.
    pub torques: f64,
}

/// The supports of a model in the order of their reactions: pins, then vertex constraints.
pub fn supports(model: &SheetModel) -> impl Iterator<Item = Support> + '_ {
    let constraints = model.constraints().iter().enumerate();
    let constraints = constraints.map(|(index, c)| Support::Constraint {
        index,
        vertex: c.vertex(),
    });
    model
        .pins()
        .into_iter()
        .map(Support::Pin)
        .chain(constraints)
}

/// Time at which forces are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ForceTime {
    /// The end of the step.
    End,
    /// The mean over the step.
    Mean,
}

/// Forces of all supports in the last accepted sub-step: at a pin `R = M a - f + G^T lambda`, with the
/// discrete acceleration `a` and the multipliers `lambda` (tension positive), at a vertex constraint
/// `R = -J^T mu`; see [`Simulation::reactions`](crate::Simulation::reactions).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Forces of pins, zero at other vertices; `3V`, newtons.
    pub(crate) pins: Vec<f64>,
    /// Multipliers of the vertex constraints, newtons. In the damped methods no field contains the share of
    /// projections.
    pub(crate) multipliers: Vec<Vector3<f64>>,
    /// Forces of the vertex constraints, newtons.
    pub(crate) constraints: Vec<Vector3<f64>>,
    /// Time of the forces.
    pub(crate) time: ForceTime,
    /// Newtons not yet distributed to the supports.
    pub(crate) residual_momentum: ResidualMomentum,
    /// Scratch, `3V`.
    #[serde(skip)]
    work: Vec<f64>,
}

impl Balance {
    /// No forces.
    pub fn new(model: &SheetModel, time: ForceTime) -> Self {
        let n = if model.has_supports() {
            model.coordinate_count()
        } else {
            0
        };
        let m = model.constraints().len();
        Self {
            pins: vec![0.0; n],
            multipliers: vec![Vector3::zeros(); m],
            constraints: vec![Vector3::zeros(); m],
            time,
            residual_momentum: ResidualMomentum::default(),
            work: vec![0.0; n],
        }
    }

    /// With a residual momentum.
    pub(crate) fn with_residual(model: &SheetModel, time: ForceTime) -> Self {
        Self {
            residual_momentum: ResidualMomentum::new(model),
            ..Self::new(model, time)
        }
    }

    /// Sets the inertia `M a`; false if there are no supports.
    pub fn begin(&mut self, model: &SheetModel, a: impl Fn(usize) -> f64) -> bool {
        for (i, w) in self.work.iter_mut().enumerate() {
            *w = a(i);
        }
        if self.pins.is_empty() {
            return false;
        }
        model
            .mass()
            .apply(model.topology(), &self.work, &mut self.pins);
        self.multipliers.fill(Vector3::zeros());
        self.constraints.fill(Vector3::zeros());
        self.residual_momentum.clear();
        true
    }

    /// Sets the forces at all vertices to zero and lets `add` add to them; false if there are no supports.
    pub(crate) fn begin_with(&mut self, add: impl FnOnce(&mut [f64])) -> bool {
        if self.pins.is_empty() {
            return false;
        }
        self.pins.fill(0.0);
        add(&mut self.pins);
        self.multipliers.fill(Vector3::zeros());
        self.constraints.fill(Vector3::zeros());
        self.residual_momentum.clear();
        true
    }

    /// Adds more inertia.
    pub(crate) fn add_inertia(&mut self, model: &SheetModel, a: impl Fn(usize) -> f64) {
        for (i, w) in self.work.iter_mut().enumerate() {
            *w = a(i);
        }
        if !self.pins.is_empty() {
            let mut inertia = vec![0.0; self.work.len()];
            model
                .mass()
                .apply(model.topology(), &self.work, &mut inertia);
            self.work = inertia;
            self.add_work(1.0);
        }
    }

    /// Takes over the forces of another balance, in place.
    pub fn copy_from(&mut self, other: &Self) {
        self.pins.clone_from(&other.pins);
        self.multipliers.clone_from(&other.multipliers);
        self.constraints.clone_from(&other.constraints);
        self.time = other.time;
        self.residual_momentum.copy_from(&other.residual_momentum);
    }

    /// Refuses arrays of the wrong length and numbers that are not finite.
    pub(crate) fn check(&self, model: &SheetModel) -> Result<(), CheckpointError> {
        let (n, m) = (model.coordinate_count(), model.constraints().len());
        let pins = if model.has_supports() { n } else { 0 };
        check_length("forces of pins", self.pins.len(), pins)?;
        check_finite("forces of pins", &self.pins)?;
        for forces in [&self.multipliers, &self.constraints] {
            check_length("forces of vertex constraints", forces.len(), m)?;
            for force in forces {
                check_finite("forces of vertex constraints", force.as_slice())?;
            }
        }
        self.residual_momentum.check(n, m)
    }

    /// The forces without scratch.
    pub fn compact(&self) -> Self {
        Self {
            pins: self.pins.clone(),
            multipliers: self.multipliers.clone(),
            constraints: self.constraints.clone(),
            time: self.time,
            residual_momentum: self.residual_momentum.compact(),
            work: Vec::new(),
        }
    }

    /// Sets all forces to zero.
    pub(crate) fn clear(&mut self) {
        self.pins.fill(0.0);
        self.multipliers.fill(Vector3::zeros());
        self.constraints.fill(Vector3::zeros());
    }

    /// Adds a share of other forces.
    pub(crate) fn add_share(&mut self, other: &Balance, share: f64) {
        for (p, q) in self.pins.iter_mut().zip(&other.pins) {
            *p += share * q;
        }
        for (p, q) in self.multipliers.iter_mut().zip(&other.multipliers) {
            *p += share * q;
        }
        for (p, q) in self.constraints.iter_mut().zip(&other.constraints) {
            *p += share * q;
        }
    }

    /// Subtracts `share` of the potential forces.
    pub fn add_potentials(
        &mut self,
        model: &SheetModel,
        memories: &Memories,
        (t, x): (f64, &[f64]),
        share: f64,
    ) {
        self.work.fill(0.0);
        for (p, at) in model.potentials_at(t, x, memories) {
            p.add_gradient(at, &mut self.work);
        }
        self.add_work(share);
    }

    /// Subtracts `share` of the non-conservative forces.
    pub fn add_applied(&mut self, model: &SheetModel, t: f64, x: &[f64], v: &[f64], share: f64) {
        self.work.fill(0.0);
        model.add_applied_force(t, x, v, &mut self.work);
        self.add_work(-share);
    }

    /// Subtracts the rod forces `-share G(x)^T multipliers`.
    pub fn add_rods(&mut self, model: &SheetModel, x: &[f64], multipliers: &[f64], share: f64) {
        self.work.fill(0.0);
        model
            .rods()
            .apply_transpose_add(x, multipliers, &mut self.work);
        self.add_work(share);
    }

    /// Adds a share of the multipliers of vertex constraints.
    pub(crate) fn add_constraints(
        &mut self,
        rows: &VertexRows,
        multipliers: &[Vector3<f64>],
        share: f64,
    ) {
        for (i, m) in multipliers.iter().enumerate() {
            self.multipliers[i] += share * m;
            self.constraints[i] -= rows.local(i).jacobian.tr_mul(&(share * m));
        }
    }

    /// Adds multipliers and forces of vertex constraints, a pair (newtons) for each.
    pub fn add_loads(&mut self, loads: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>) {
        for (i, (multiplier, force)) in loads.enumerate() {
            self.multipliers[i] += multiplier;
            self.constraints[i] += force;
        }
    }

    fn add_work(&mut self, share: f64) {
        for (p, w) in self.pins.iter_mut().zip(&self.work) {
            *p += share * w;
        }
    }

    /// Keeps the forces at pins; those at free vertices at positions `x` become residual momentum, for the
    /// rods and the `active` vertex constraints.
    pub(crate) fn leave(&mut self, model: &SheetModel, x: &[f64], active: &[bool]) {
        self.work.copy_from_slice(&self.pins);
        for (c, f) in model.constraints().iter().zip(&self.constraints) {
            add(&mut self.work, c.vertex(), &-f);
        }
        model.clear_pinned(&mut self.work);
        self.residual_momentum
            .push(x, active, self.work.iter().copied());
        self.finish(model);
    }

    /// Keeps the forces at pins.
    pub fn finish(&mut self, model: &SheetModel) {
        for v in model
            .topology()
            .vertex_ids()
            .filter(|&v| !model.is_pinned(v))
        {
            self.pins[3 * v.index()..3 * v.index() + 3].fill(0.0);
        }
    }

    /// The reactions, with the distributed residual momentum of a step that ended at time `t`.
    pub fn reactions(&self, model: &SheetModel, t: f64) -> Vec<Reaction> {
        let shares = self.residual_momentum.shares(model, t);
        let pins = model.pins().into_iter().map(|v| Reaction {
            support: Support::Pin(v),
            force: point(&self.pins, v) + shares.pin(v),
        });
        let forces = self.constraints.iter().zip(&shares.constraints);
        let constraints = model.constraints().iter().zip(forces).enumerate();
        let constraints = constraints.map(|(index, (c, (own, share)))| Reaction {
            support: Support::Constraint {
                index,
                vertex: c.vertex(),
            },
            force: own + share,
        });
        pins.chain(constraints).collect()
    }

    /// What the [reactions](Self::reactions) leave of the balance at the end of a step: the forces at free
    /// vertices, less the part of them that rods and supports take. Known for forces at the end of a step
    /// alone.
    pub(crate) fn imbalance(&self, model: &SheetModel, state: &State) -> Option<Imbalance> {
        if self.time != ForceTime::End || self.pins.is_empty() {
            return None;
        }
        let rows = state.x.as_chunks::<3>().0;
        let mean = rows.iter().map(|p| Vector3::from(*p)).sum::<Vector3<f64>>() / rows.len() as f64;
        let shares = self.residual_momentum.shares(model, state.t);
        let [mut force, mut torque] = self.residual_momentum.sums(&mean);
        let (mut forces, mut torques) = (0.0, 0.0);
        let mut add = |v: VertexId, own: Vector3<f64>, share: Vector3<f64>| {
            let arm = point(&state.x, v) - mean;
            force -= share;
            torque -= arm.cross(&share);
            forces += (own + share).norm();
            torques += arm.cross(&(own + share)).norm();
        };
        for v in model.pins() {
            add(v, point(&self.pins, v), shares.pin(v));
        }
        let own = self.constraints.iter().zip(&shares.constraints);
        for (c, (own, share)) in model.constraints().iter().zip(own) {
            add(c.vertex(), *own, *share);
        }
        Some(Imbalance {
            force,
            torque,
            forces,
            torques,
        })
    }

    /// Work of moving pins and vertex constraints in a step from `x0` at `t0` to `x1` at `t1`, joules: with
    /// mean forces or, for forces at the end, by the trapezoidal rule with the forces of the step before.
    pub fn drive_work(
        &self,
        model: &SheetModel,
        before: Option<&Balance>,
        (t0, x0): (f64, &[f64]),
        (t1, x1): (f64, &[f64]),
    ) -> f64 {
        let before = before.filter(|_| self.time == ForceTime::End);
        let mut work = 0.0;
        for v in model.moving_pins() {
            for i in 3 * v..3 * v + 3 {
                let force = before.map_or(self.pins[i], |b| 0.5 * (self.pins[i] + b.pins[i]));
                work += force * (x1[i] - x0[i]);
            }
        }
        for (i, c) in model.constraints().iter().enumerate() {
            if c.moves() {
                let p = 0.5 * (point(x0, c.vertex()) + point(x1, c.vertex()));
                let change = c.at(t1, &p).value - c.at(t0, &p).value;
                let own = self.multipliers[i];
                let load = before.map_or(own, |b| 0.5 * (own + b.multipliers[i]));
                work += load.dot(&change);
            }
        }
        work
    }
}
