//! Supports that ask for more than the rods allow.

use crate::constraint::rows::{HessianPart, VertexRows};
use crate::linear::primal::PrimalMatrix;
use crate::model::support::Support;
use crate::vectors::{add, point};
use crate::{SheetModel, State};
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// A demand that cannot be met.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Infeasibility {
    /// The support, of those that move, that pulls most against the taut rods.
    pub support: Support,
    /// How far it would have to give way for the rods to have their lengths, to first order; metres.
    pub distance: f64,
    /// When it asks for this, seconds.
    pub t: f64,
}

/// Stiffness of the rods relative to the masses over a squared second: what is left of inertia is round-off.
const ROD_STIFFNESS: f64 = 1e9;
/// Most Newton iterations; taut rods converge in about ten.
const MAX_ITERATIONS: usize = 100;
/// Forces on free vertices, relative to those at the supports, up to which the stretched sheet is in
/// equilibrium.
const BALANCED_PART: f64 = 1e-6;
/// Strain below which lengths that were not met are a matter of convergence.
const MET_STRAIN: f64 = 1e-7;
/// Line searches that halve this often have stalled.
const MAX_HALVINGS: usize = 30;

/// Looks for positions with the rest lengths and the supports where they are at time `t`, and says by how
/// much they fail to exist.
///
/// The least squares of the lengths, `E = sum_e p_e c_e^2 / 2`, are minimised by Newton's method from the
/// state. Where the minimum is not zero the tensions `w_e = p_e c_e` are in equilibrium at all free vertices:
/// by Farkas' lemma for the linearised lengths no small motion meets them, and the support that bears the
/// force `F` has to give way by `sum_e w_e c_e / |F|`.
pub(crate) fn infeasibility(model: &SheetModel, state: &State, t: f64) -> Option<Infeasibility> {
    let mut fit = Fit::new(model, state, t)?;
    let mut energy = fit.energy();
    for _ in 0..MAX_ITERATIONS {
        if fit.force() <= BALANCED_PART * fit.largest_support().1 {
            break;
        }
        energy = fit.descend(energy)?;
    }
    if fit.force() > BALANCED_PART.sqrt() * fit.largest_support().1 || fit.strain() < MET_STRAIN {
        return None;
    }
    let (support, force) = fit.largest_support();
    (force > 0.0).then(|| Infeasibility {
        support,
        // Twice the energy is the sum of tension times elongation.
        distance: 2.0 * energy / force,
        t,
    })
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

struct Fit<'a> {
    model: &'a SheetModel,
    matrix: PrimalMatrix,
    rows: VertexRows,
    penalty: Vec<f64>,
    c: Vec<f64>,
    tension: Vec<f64>,
    gradient: Vec<f64>,
    dx: Vec<f64>,
    x: Vec<f64>,
    t: f64,
}

impl<'a> Fit<'a> {
    fn new(model: &'a SheetModel, state: &State, t: f64) -> Option<Self> {
        let n = model.coordinate_count();
        let mut x = state.x.clone();
        model.place_pins(t, &mut x);
        let m = model.rods().len();
        let mut fit = Self {
            model,
            matrix: PrimalMatrix::of_rods(model).ok()?,
            rows: VertexRows::new(
                model.constraints(),
                model.constrained_vertices(),
                ROD_STIFFNESS,
            ),
            penalty: penalties(model),
            c: vec![0.0; m],
            tension: vec![0.0; m],
            gradient: vec![0.0; n],
            dx: vec![0.0; n],
            x,
            t,
        };
        fit.evaluate();
        Some(fit)
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
        self.rows
            .evaluate(self.model.constraints(), self.t, &self.x);
        self.rows.add_gradient(&mut self.gradient);
    }

    fn energy(&self) -> f64 {
        let rods: f64 = self.tension.iter().zip(&self.c).map(|(w, c)| w * c).sum();
        0.5 * rods + self.rows.value()
    }

    fn strain(&self) -> f64 {
        let strain = self.model.rods().max_strain(&self.x);
        strain.max(self.rows.largest_violation())
    }

    /// Largest force on a free vertex.
    fn force(&self) -> f64 {
        self.model
            .topology()
            .vertex_ids()
            .filter(|&v| !self.model.is_pinned(v))
            .fold(0.0, |m: f64, v| m.max(point(&self.gradient, v).norm()))
    }

    /// The support that bears the largest force, of those that move.
    fn largest_support(&self) -> (Support, f64) {
        let pins = self.model.moving_pins().map(|v| {
            let v = VertexId(v as u32);
            (Support::Pin(v), point(&self.gradient, v).norm())
        });
        let constraints = self.model.constraints().iter().enumerate();
        let constraints = constraints.filter(|(_, c)| c.moves()).map(|(index, c)| {
            let load = self.rows.multiplier_estimate(index);
            let force: Vector3<f64> = self.rows.local(index).jacobian.tr_mul(&load);
            let vertex = c.vertex();
            (Support::Constraint { index, vertex }, force.norm())
        });
        pins.chain(constraints)
            .fold((Support::Pin(VertexId(0)), 0.0), |best, next| {
                if next.1 > best.1 { next } else { best }
            })
    }

    /// One step of Newton's method with the transverse stiffness of the stretched rods; the new energy.
    fn descend(&mut self, energy: f64) -> Option<f64> {
        let transverse: Vec<f64> = self.tension.iter().map(|w| w.max(0.0)).collect();
        self.matrix
            .assemble(self.model, &self.x, &self.penalty, &transverse);
        self.rows.add_hessian(
            HessianPart::PositiveSemidefinite,
            &mut self.matrix.sink(self.model),
        );
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
