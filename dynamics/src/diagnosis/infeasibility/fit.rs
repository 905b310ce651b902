//! The least squares of lengths, strains and gaps with supports and bodies where they will be.

use super::driver::Drive;
use super::gaps::Gaps;
use crate::linear::constraint_rows::{RowLoad, VertexRows};
use crate::linear::primal::PrimalMatrix;
use crate::{Potential, SheetModel, State};
use isosheet_materials::hessian::HessianPart;
use isosheet_materials::potential::At;
use isosheet_materials::vectors::{add, point};
use isosheet_materials::{ElasticSheet, StrainOfFace};
use isosheet_mesh::VertexId;
use isosheet_model::Driver;
use isosheet_model::Support;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Stiffness of the rods relative to the masses over a squared second: what is left of inertia is round-off.
pub(super) const ROD_STIFFNESS: f64 = 1e9;
/// Most Newton iterations; taut rods converge in about ten.
const MAX_ITERATIONS: usize = 100;
/// Forces on free vertices, relative to those at the supports, up to which the stretched sheet is in
/// equilibrium.
const BALANCED_PART: f64 = 1e-6;
/// Strain below which lengths that were not met are a matter of convergence.
const MET_STRAIN: f64 = 1e-7;
/// Line searches that halve this often have stalled.
const MAX_HALVINGS: usize = 30;
/// Displacement, in mean lengths, that lets a sheet buckle which is compressed in its plane.
const PERTURBATION: f64 = 1e-3;

pub(super) struct Fit<'a> {
    model: &'a SheetModel,
    matrix: PrimalMatrix,
    rows: VertexRows,
    gaps: Gaps,
    /// What is beyond the limit of the strain, for elastic sheets.
    excess: Option<ElasticSheet>,
    penalty: Vec<f64>,
    c: Vec<f64>,
    tension: Vec<f64>,
    gradient: Vec<f64>,
    dx: Vec<f64>,
    x: Vec<f64>,
    start: &'a State,
    t: f64,
}

/// As stiff for rods between two pins as for a rod of the mean mass.
fn penalties(model: &SheetModel) -> Vec<f64> {
    let mut penalty = crate::linear::free::penalties(model, ROD_STIFFNESS);
    for (p, l) in penalty.iter_mut().zip(model.rods().lengths()) {
        if *p == 0.0 {
            *p = ROD_STIFFNESS * model.mean_mass() / (l * l);
        }
    }
    penalty
}

impl<'a> Fit<'a> {
    /// At the state, with the supports in their places at time `t`.
    pub(super) fn new(model: &'a SheetModel, state: &'a State, t: f64, gaps: Gaps) -> Option<Self> {
        let n = model.coordinate_count();
        let mut x = state.x.clone();
        model.place_pins(t, &mut x);
        let m = model.rods().len();
        let length = model.mean_length();
        let excess = model.elastic_sheet().map(|sheet| {
            let density = model.mass().total() / sheet.area();
            sheet.excess(ROD_STIFFNESS * density * length * length)
        });
        let mut fit = Self {
            model,
            matrix: PrimalMatrix::of_rods(model).ok()?,
            rows: VertexRows::new(
                model.constraints(),
                model.constrained_vertices(),
                ROD_STIFFNESS,
            ),
            gaps,
            excess,
            penalty: penalties(model),
            c: vec![0.0; m],
            tension: vec![0.0; m],
            gradient: vec![0.0; n],
            dx: vec![0.0; n],
            x,
            start: state,
            t,
        };
        fit.evaluate();
        Some(fit)
    }

    /// At the minimum; nothing where that is zero, or is not found.
    pub(super) fn minimised(mut self) -> Option<Self> {
        self.minimise()?;
        if self.is_met() {
            return None;
        }
        let minimum = self.x.clone();
        // Compressed in its plane a flat sheet is in equilibrium, but buckles.
        self.perturb();
        self.minimise()?;
        if self.is_met() {
            return None;
        }
        self.x = minimum;
        self.evaluate();
        let is_balanced = self.force() <= BALANCED_PART.sqrt() * self.largest_force();
        is_balanced.then_some(self)
    }

    fn minimise(&mut self) -> Option<()> {
        let mut energy = self.energy();
        for _ in 0..MAX_ITERATIONS {
            if self.force() <= BALANCED_PART * self.largest_force() {
                break;
            }
            energy = self.descend(energy)?;
        }
        Some(())
    }

    fn perturb(&mut self) {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let size = PERTURBATION * self.model.mean_length();
        for v in self.model.topology().vertex_ids() {
            let d = Vector3::from_fn(|_, _| rng.random_range(-size..size));
            if !self.model.is_pinned(v) {
                add(&mut self.x, v, &d);
            }
        }
        self.evaluate();
    }

    /// Tensions and their forces on all vertices, pinned ones included.
    fn evaluate(&mut self) {
        self.model.rods().residual_into(&self.x, &mut self.c);
        for e in 0..self.c.len() {
            self.tension[e] = self.penalty[e] * self.c[e];
        }
        self.gradient.fill(0.0);
        self.model
            .rods()
            .apply_transpose_add(&self.x, &self.tension, &mut self.gradient);
        if let Some(excess) = &self.excess {
            excess.add_gradient(At::new(self.t, &self.x), &mut self.gradient);
        }
        self.gaps.add_gradient(&self.x, &mut self.gradient);
        self.rows
            .evaluate(self.model.constraints(), self.t, &self.x);
        self.rows.add_gradient(&mut self.gradient);
    }

    /// The penalty energy of the rods.
    fn rod_energy(&self) -> f64 {
        let rods: f64 = self.tension.iter().zip(&self.c).map(|(w, c)| w * c).sum();
        0.5 * rods
    }

    /// The energy of the strains beyond the limit.
    fn excess_energy(&self) -> f64 {
        let excess = self.excess.as_ref();
        excess.map_or(0.0, |excess| excess.energy(At::new(self.t, &self.x)))
    }

    /// The sum of the squares.
    pub(super) fn energy(&self) -> f64 {
        self.rod_energy() + self.excess_energy() + self.gaps.energy(&self.x) + self.rows.value()
    }

    /// The face that is strained most.
    fn worst(&self) -> Option<StrainOfFace> {
        let excess = self.excess.as_ref()?;
        excess.worst(At::new(self.t, &self.x))
    }

    /// The limit of the strain that is exceeded most, if that is what does not allow the motion, and not the
    /// rods of a sheet.
    pub(super) fn strain_limit(&self) -> Option<f64> {
        let worst = self.worst()?;
        let is_of_rods =
            self.model.has_rods_in_sheets() && self.rod_energy() > self.excess_energy();
        (!is_of_rods).then_some(worst.limit)
    }

    /// Whether lengths or strains, gaps and supports are met but for what convergence leaves.
    fn is_met(&self) -> bool {
        let worst = self.worst();
        let beyond = worst.map_or(0.0, |worst| worst.strain - worst.limit);
        let strain = self.model.rods().max_strain(&self.x).max(beyond);
        let closed = self.gaps.largest_violation(&self.x) / self.model.mean_length();
        strain.max(closed).max(self.rows.largest_violation()) < MET_STRAIN
    }

    /// Largest force on a free vertex.
    fn force(&self) -> f64 {
        self.model
            .topology()
            .vertex_ids()
            .filter(|&v| !self.model.is_pinned(v))
            .fold(0.0, |m: f64, v| m.max(point(&self.gradient, v).norm()))
    }

    /// What everything does that moves.
    fn drives(&self) -> impl Iterator<Item = Drive> {
        let pins = self.model.moving_pins().map(|v| {
            let v = VertexId(v as u32);
            let (force, moved) = (
                point(&self.gradient, v),
                point(&self.x, v) - point(&self.start.x, v),
            );
            Drive {
                by: Driver::Support(Support::Pin(v)),
                force: force.norm(),
                work: force.dot(&moved),
                displacement: moved.norm(),
            }
        });
        let constraints = self.model.constraints().iter().enumerate();
        let constraints = constraints.filter(|(_, c)| c.moves()).map(|(index, c)| {
            let (load, local) = (self.rows.multiplier_estimate(index), self.rows.local(index));
            let vertex = c.vertex();
            let before = c.at(self.start.t, &point(&self.x, vertex)).value;
            let moved = local.value - before;
            Drive {
                by: Driver::Support(Support::Constraint { index, vertex }),
                force: local.jacobian.tr_mul(&load).norm(),
                work: load.dot(&moved),
                displacement: moved.norm(),
            }
        });
        pins.chain(constraints).chain(self.gaps.drives(&self.x))
    }

    /// The largest force of what moves.
    fn largest_force(&self) -> f64 {
        self.drives().fold(0.0, |most, drive| most.max(drive.force))
    }

    /// What does most of the work, and how far it would have to stay back for nothing to be violated, metres:
    /// all forces together do the work `2 E` over the part of the motions that is too much.
    pub(super) fn demand(&self) -> Option<(Driver, f64)> {
        let work: f64 = self.drives().map(|drive| drive.work).sum();
        let most = |a: &Drive, b: &Drive| a.work.total_cmp(&b.work);
        let largest = self.drives().max_by(most)?;
        let part = 2.0 * self.energy() / work;
        (largest.work > 0.0 && work > 0.0)
            .then(|| (largest.by, part.min(1.0) * largest.displacement))
    }

    /// The vertices that are pressed, by the driver if that is a body, and the other bodies that press.
    pub(super) fn pressed(&self, by: Driver) -> (Vec<VertexId>, Vec<usize>) {
        let body = match by {
            Driver::Body(body) => Some(body),
            Driver::Support(_) => None,
        };
        let (vertices, mut bodies) = self.gaps.pressed(&self.x, body);
        bodies.retain(|other| Some(*other) != body);
        (vertices, bodies)
    }

    /// One step of Newton's method with the transverse stiffness of the stretched rods; the new energy.
    fn descend(&mut self, energy: f64) -> Option<f64> {
        let transverse: Vec<f64> = self.tension.iter().map(|w| w.max(0.0)).collect();
        self.matrix
            .assemble(self.model, &self.x, &self.penalty, &transverse);
        let mut sink = self.matrix.sink(self.model);
        if let Some(excess) = &self.excess {
            excess.add_semidefinite_hessian(At::new(self.t, &self.x), &mut sink);
        }
        self.gaps.add_hessian(&self.x, &mut sink);
        self.rows.add_hessian(
            HessianPart::PositiveSemidefinite,
            RowLoad::Estimates,
            &mut sink,
        );
        drop(sink);
        self.matrix.factorize().ok()?;
        self.matrix.solve(self.model, &self.gradient, &mut self.dx);
        let start = self.x.clone();
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            self.x.copy_from_slice(&start);
            for v in self.model.topology().vertex_ids() {
                let d = point(&self.dx, v);
                add(&mut self.x, v, &(-length * d));
            }
            self.evaluate();
            let now = self.energy();
            if now <= energy {
                return Some(now);
            }
            length *= 0.5;
        }
        self.x.copy_from_slice(&start);
        self.evaluate();
        Some(energy)
    }
}
