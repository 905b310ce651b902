//! The forces of supports that balance given forces at free vertices.

use crate::SheetModel;
use crate::linear::constrained::{ConstrainedSolver, ConstrainedSystem, SupportRows};
use crate::linear::constraint_rows::VertexRows;
use crate::linear::free::penalties;
use crate::linear::primal::PrimalMatrix;
use isosheet_linalg::norm_inf;
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// Penalty relative to the masses: beyond, the masses drown in round-off.
const ROD_PENALTY: f64 = 1e9;
/// Passes of the method of multipliers: each contracts what is left by the penalty, except along rods that
/// are nearly dependent.
const MAX_PASSES: usize = 30;
/// Part of the forces that may be left: the sum of the supports' forces is as good.
const BALANCED_PART: f64 = 1e-12;

/// Forces of supports, newtons.
pub(crate) struct Shares {
    /// At pinned vertices; `3V`.
    pins: Vec<f64>,
    /// Of each vertex constraint.
    pub(crate) constraints: Vec<Vector3<f64>>,
}

impl Shares {
    /// No forces.
    pub(crate) fn none(model: &SheetModel) -> Self {
        Self {
            pins: vec![0.0; model.coordinate_count()],
            constraints: vec![Vector3::zeros(); model.constraints().len()],
        }
    }

    /// Adds others.
    pub(crate) fn add(&mut self, other: &Self) {
        for (a, b) in self.pins.iter_mut().zip(&other.pins) {
            *a += b;
        }
        for (a, b) in self.constraints.iter_mut().zip(&other.constraints) {
            *a += b;
        }
    }

    /// At a pin.
    pub(crate) fn pin(&self, v: VertexId) -> Vector3<f64> {
        point(&self.pins, v)
    }
}

/// Where there are no rods: of the force at each vertex the part along the normals of its constraints.
fn local(model: &SheetModel, (t, x): (f64, &[f64]), left: &[f64], active: &[bool]) -> Shares {
    let mut sum = Shares::none(model);
    let constraints = model.constraints();
    // Constraints of one vertex take what those before them have left; of normals at right angles that is
    // all.
    let mut rest = left.to_vec();
    for (i, c) in constraints.iter().enumerate() {
        let v = c.vertex();
        if active[i] && !model.is_pinned(v) {
            let j = c.at(t, &point(x, v)).jacobian;
            let f = point(&rest, v);
            let pseudo = j.pseudo_inverse(f64::EPSILON).unwrap_or_default();
            let taken = pseudo * (j * f);
            sum.constraints[i] += taken;
            add(&mut rest, v, &-taken);
        }
    }
    for v in model.pins() {
        for k in 3 * v.index()..3 * v.index() + 3 {
            sum.pins[k] += left[k];
        }
    }
    sum
}

/// Forces of the supports that, with tensions of the rods, balance the forces `left` (`3V`, newtons) at time
/// `t` and positions `x`: `left = -G(x)^T m - J(x, t)^T n` at free vertices, in the sense of least squares in
/// the inverse of the mass matrix, with the vertex constraints that are `active`, and what is missing at
/// pinned ones.
///
/// For one factorisation. Nothing where there is nothing to balance, or the linear algebra fails.
pub(crate) fn shares(
    model: &SheetModel,
    (t, x): (f64, &[f64]),
    left: &[f64],
    active: &[bool],
) -> Option<Shares> {
    if left.iter().all(|f| *f == 0.0) {
        return None;
    }
    if model.rods().is_empty() && model.mass().edge.is_none() {
        return Some(local(model, (t, x), left, active));
    }
    let mut matrix = PrimalMatrix::of_rods(model).ok()?;
    let mut rows = VertexRows::new(model.constraints(), model.constrained_vertices(), 1.0);
    rows.evaluate(model.constraints(), t, x);
    rows.equality.copy_from_slice(active);
    let axial = penalties(model, ROD_PENALTY);
    matrix.assemble(model, x, &axial, &vec![0.0; axial.len()]);
    rows.add_equalities(ROD_PENALTY, &mut matrix.sink(model));
    matrix.factorize().ok()?;
    let mut solver = ConstrainedSolver::new(model);
    let supports = SupportRows::Equalities {
        rows: &rows,
        penalty: ROD_PENALTY,
    };
    let system = ConstrainedSystem {
        model,
        matrix: &mut matrix,
        supports,
    };
    let (mut rest, mut y) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    let mut goal = None;
    for _ in 0..=MAX_PASSES {
        rest.copy_from_slice(left);
        system.apply_transpose_add(&solver.multipliers, &mut rest);
        let mut free = rest.clone();
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
    let loads = solver.multipliers.supports.iter().enumerate();
    Some(Shares {
        pins: rest,
        constraints: loads
            .map(|(i, m)| -rows.local(i).jacobian.tr_mul(m))
            .collect(),
    })
}
