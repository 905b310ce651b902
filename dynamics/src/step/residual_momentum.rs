//! Momentum that projections have given to the sheet and that is not yet assigned to the supports.

use crate::SheetModel;
use crate::constraint::rows::VertexRows;
use crate::linear::constrained::{ConstrainedSolver, ConstrainedSystem, SupportRows};
use crate::linear::free::penalties;
use crate::linear::primal::PrimalMatrix;
use crate::step::checkpoint_error::{CheckpointError, check_finite, check_length};
use isosheet_coords::linalg::norm_inf;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Largest number of entries, one for each iteration of a projection; projections need three to six. The
/// momentum of later iterations is added to the last entry.
const MAX_ENTRIES: usize = 16;
/// Penalty relative to the masses: beyond, the masses drown in round-off.
const ROD_PENALTY: f64 = 1e9;
/// Passes of the method of multipliers: each contracts what is left by the penalty, except along rods that
/// are nearly dependent.
const MAX_PASSES: usize = 30;
/// Part of the momentum that may be left: the sum of the supports' forces is as good.
const BALANCED_PART: f64 = 1e-12;

/// The parts of a step's change of momentum that no multiplier is known for, each with the positions whose
/// rods and vertex constraints gave it: iterations of a projection, and what a minimisation left.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ResidualMomentum {
    entries: Vec<Entry>,
    len: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Entry {
    /// `3V`, metres.
    x: Vec<f64>,
    /// Vertex constraints that took part.
    active: Vec<bool>,
    /// `3V`.
    momentum: Vec<f64>,
}

/// Forces of the supports that a residual momentum asks for.
pub(crate) struct Shares {
    /// At pinned vertices; `3V`.
    pub(crate) pins: Vec<f64>,
    /// Of each vertex constraint the multipliers and the force on its vertex.
    pub(crate) loads: Vec<(Vector3<f64>, Vector3<f64>)>,
}

impl ResidualMomentum {
    /// With room, except where nothing holds the sheet. (The default has none.)
    pub(crate) fn new(model: &SheetModel) -> Self {
        let n = model.coordinate_count();
        let entry = Entry {
            x: vec![0.0; n],
            active: vec![false; model.constraints().len()],
            momentum: vec![0.0; n],
        };
        let room = if model.has_supports() { MAX_ENTRIES } else { 0 };
        Self {
            entries: vec![entry; room],
            len: 0,
        }
    }

    pub(crate) fn has_room(&self) -> bool {
        !self.entries.is_empty()
    }

    /// The entries alone, without room for further ones.
    pub(crate) fn compact(&self) -> Self {
        Self {
            entries: self.entries[..self.len].to_vec(),
            len: self.len,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds momentum given at positions `x` by the rods and the vertex constraints `active`, and returns
    /// where more of it may be added.
    pub(crate) fn push(
        &mut self,
        x: &[f64],
        active: &[bool],
        momentum: impl Iterator<Item = f64>,
    ) -> &mut [f64] {
        if self.len < MAX_ENTRIES {
            let entry = &mut self.entries[self.len];
            self.len += 1;
            entry.x.copy_from_slice(x);
            entry.active.copy_from_slice(active);
            entry.momentum.fill(0.0);
        }
        let entry = &mut self.entries[self.len - 1];
        for (sum, m) in entry.momentum.iter_mut().zip(momentum) {
            *sum += m;
        }
        &mut entry.momentum
    }

    /// Takes over another one, in place.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        if self.entries.len() < other.len {
            self.clone_from(other);
        } else {
            self.clear();
            self.append(other, 1.0);
        }
    }

    /// Refuses arrays of the wrong length and numbers that are not finite, for `n` coordinates and `m` vertex
    /// constraints.
    pub(crate) fn check(&self, n: usize, m: usize) -> Result<(), CheckpointError> {
        const WHAT: &str = "momenta that are not shared out";
        if self.len > self.entries.len() {
            check_length(WHAT, self.entries.len(), self.len)?;
        }
        for entry in &self.entries {
            check_length(WHAT, entry.momentum.len(), n)?;
            check_length("positions of these", entry.x.len(), n)?;
            check_length("constraints of these", entry.active.len(), m)?;
            check_finite(WHAT, &entry.momentum)?;
            check_finite("positions of these", &entry.x)?;
        }
        Ok(())
    }

    /// Adds a multiple of another one.
    pub(crate) fn append(&mut self, other: &Self, factor: f64) {
        for entry in &other.entries[..other.len] {
            let momentum = entry.momentum.iter().map(|m| factor * m);
            self.push(&entry.x, &entry.active, momentum);
        }
    }

    /// Forces of the supports that, with tensions of the rods, give every entry's momentum `f`:
    /// `f = -G(x)^T m - J(x, t)^T n` at free vertices, in the sense of least squares in the inverse of the
    /// mass matrix, and what is missing at pinned ones.
    ///
    /// A factorisation for each entry. Where the linear algebra fails the entry is left out.
    pub(crate) fn shares(&self, model: &SheetModel, t: f64) -> Shares {
        let (n, edges) = (model.coordinate_count(), model.rods().len());
        let mut shares = Shares {
            pins: vec![0.0; n],
            loads: vec![(Vector3::zeros(), Vector3::zeros()); model.constraints().len()],
        };
        if self.len == 0 {
            return shares;
        }
        let Ok(mut matrix) = PrimalMatrix::of_rods(model) else {
            return shares;
        };
        let mut rows = VertexRows::new(model.constraints(), model.constrained_vertices(), 1.0);
        let (along, transverse) = (penalties(model, ROD_PENALTY), vec![0.0; edges]);
        let mut solver = ConstrainedSolver::new(model);
        let (mut left, mut y) = (vec![0.0; n], vec![0.0; n]);
        for Entry {
            x,
            active,
            momentum,
        } in &self.entries[..self.len]
        {
            rows.evaluate(model.constraints(), t, x);
            rows.equality.copy_from_slice(active);
            matrix.assemble(model, x, &along, &transverse);
            rows.add_equalities(ROD_PENALTY, &mut matrix.sink(model));
            if matrix.factorize().is_err() {
                continue;
            }
            let system = ConstrainedSystem {
                model,
                matrix: &mut matrix,
                supports: SupportRows::Equalities {
                    rows: &rows,
                    penalty: ROD_PENALTY,
                },
            };
            solver.multipliers.clear();
            let mut goal = None;
            for _ in 0..=MAX_PASSES {
                left.copy_from_slice(momentum);
                system.apply_transpose_add(&solver.multipliers, &mut left);
                let mut free = left.clone();
                model.clear_pinned(&mut free);
                let size = norm_inf(&free);
                if size <= *goal.get_or_insert(BALANCED_PART * size) {
                    break;
                }
                system.matrix.solve(model, &free, &mut y);
                solver.residual.clear();
                solver.subtract(&system, &y);
                solver.update(&system);
            }
            for (p, f) in shares.pins.iter_mut().zip(&left) {
                *p += f;
            }
            for (i, (multiplier, force)) in shares.loads.iter_mut().enumerate() {
                let own = solver.multipliers.supports[i];
                *multiplier += own;
                *force -= rows.local(i).jacobian.tr_mul(&own);
            }
        }
        shares
    }
}
