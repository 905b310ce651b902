//! Rigid displacements, and the forces of supports that balance a sheet as a rigid body.

use crate::SheetModel;
use crate::constraint::rows::{add, point};
use crate::reaction::Balance;
use isosheet_mesh::VertexId;
use nalgebra::{
    Const, Matrix3, Matrix6, Matrix6x3, Rotation3, SVector, SymmetricEigen, Vector3, Vector6,
};

/// Largest number of iterations of a fit. The residual of displacements that are rigid falls quadratically:
/// turns by a tenth of a radian take three iterations.
const MAX_ITERATIONS: usize = 10;
/// Eigenvalue relative to the largest one, below which a direction counts as absent: points on a line leave
/// the rotation about it open, and supports on a line take no moment about it.
const ABSENT: f64 = 1e-9;
/// Gap of a one-sided constraint in mean rod lengths, below which the constraint can carry a load.
const TOUCHING: f64 = 1e-9;

/// A rotation about a point, followed by a translation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidFit {
    centre: Vector3<f64>,
    rotation: Rotation3<f64>,
    target: Vector3<f64>,
}

impl RigidFit {
    /// The displacement that takes the first of each pair of points to the second in the sense of least
    /// squares, with the smallest rotation (Gauss-Newton iterations on the rotation). There has to be a pair.
    pub(crate) fn of(pairs: &[[Vector3<f64>; 2]]) -> Self {
        let mean = |k: usize| pairs.iter().map(|p| p[k]).sum::<Vector3<f64>>() / pairs.len() as f64;
        let (centre, target) = (mean(0), mean(1));
        let mut rotation = Rotation3::identity();
        for _ in 0..MAX_ITERATIONS {
            let (mut inertia, mut moment) = (Matrix3::zeros(), Vector3::zeros());
            for [from, to] in pairs {
                let arm = rotation * (from - centre);
                inertia +=
                    Matrix3::from_diagonal_element(arm.norm_squared()) - arm * arm.transpose();
                moment += arm.cross(&(to - target));
            }
            let turn = least_norm(&SymmetricEigen::new(inertia), &moment);
            rotation = Rotation3::new(turn) * rotation;
            if turn.norm() <= f64::EPSILON {
                break;
            }
        }
        Self {
            centre,
            rotation,
            target,
        }
    }

    /// Where a point goes.
    pub(crate) fn apply(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * (p - self.centre) + self.target
    }
}

/// A support as it acts on the sheet as a whole.
struct Handle {
    of: Held,
    /// Resultant (rows 0 to 2, newtons) and moment (newtons times the length scale) for each multiplier.
    wrench: Matrix6x3<f64>,
    multipliers: Vector3<f64>,
}

/// What a support holds.
enum Held {
    Pin(VertexId),
    Constraint(usize),
}

/// Has the supports balance the sheet at positions `x` (`3V`, metres) and time `t` (seconds) as a rigid body:
/// instead of the forces that `balance` has at free vertices they take forces with the same resultant and
/// moment, those with the smallest sum of squares. One-sided constraints do not pull. Moments that no support
/// can take, as those about a line on which all of them are, stay unbalanced.
pub(crate) fn balance_as_rigid(balance: &mut Balance, model: &SheetModel, t: f64, x: &[f64]) {
    let length = model.mean_length();
    let origin = point(x, VertexId(0));
    let wrench = |v: VertexId, forces: Matrix3<f64>| {
        let moments = ((point(x, v) - origin) / length).cross_matrix() * forces;
        let mut wrench = Matrix6x3::zeros();
        wrench.fixed_rows_mut::<3>(0).copy_from(&forces);
        wrench.fixed_rows_mut::<3>(3).copy_from(&moments);
        wrench
    };
    let vertices = model.topology().vertex_ids();
    let wanted: Vector6<f64> = vertices
        .filter(|v| !model.is_pinned(*v))
        .map(|v| wrench(v, Matrix3::identity()) * point(&balance.pins, v))
        .sum();
    balance.finish(model);
    let pins = model.pins().into_iter().map(|v| Handle {
        of: Held::Pin(v),
        wrench: wrench(v, Matrix3::identity()),
        multipliers: Vector3::zeros(),
    });
    let locals = model.constraints().iter().enumerate().map(|(index, c)| {
        let local = c.at(t, &point(x, c.vertex()));
        (index, c, local)
    });
    let constraints = locals
        .filter(|(_, c, local)| !c.is_one_sided() || local.value.x <= TOUCHING * length)
        .map(|(index, c, local)| Handle {
            of: Held::Constraint(index),
            wrench: wrench(c.vertex(), -local.jacobian.transpose()),
            multipliers: Vector3::zeros(),
        });
    let mut handles: Vec<Handle> = pins.chain(constraints).collect();
    loop {
        share(&mut handles, &wanted);
        let before = handles.len();
        handles.retain(|handle| match handle.of {
            Held::Pin(_) => true,
            Held::Constraint(index) => {
                !model.constraints()[index].is_one_sided() || handle.multipliers.x <= 0.0
            }
        });
        if handles.len() == before {
            break;
        }
    }
    for Handle {
        of,
        wrench,
        multipliers,
    } in handles
    {
        let force: Vector3<f64> = wrench.fixed_rows::<3>(0) * multipliers;
        match of {
            Held::Pin(v) => add(&mut balance.pins, v, &force),
            Held::Constraint(index) => {
                balance.multipliers[index] += multipliers;
                balance.constraints[index] += force;
            }
        }
    }
}

/// The multipliers with the smallest sum of squares whose wrenches come closest to a given one.
fn share(handles: &mut [Handle], wanted: &Vector6<f64>) {
    let gram: Matrix6<f64> = handles
        .iter()
        .map(|h| h.wrench * h.wrench.transpose())
        .sum();
    let answer = least_norm(&SymmetricEigen::new(gram), wanted);
    for handle in handles {
        handle.multipliers = handle.wrench.tr_mul(&answer);
    }
}

/// The solution of least norm of a symmetric positive semidefinite system, without its [`ABSENT`] directions.
fn least_norm<const N: usize>(
    eigen: &SymmetricEigen<f64, Const<N>>,
    right: &SVector<f64, N>,
) -> SVector<f64, N> {
    let smallest = ABSENT * eigen.eigenvalues.max();
    let directions = eigen.eigenvectors.column_iter();
    let mut answer = SVector::zeros();
    for (value, direction) in eigen.eigenvalues.iter().zip(directions) {
        if *value > smallest {
            answer += direction * (direction.dot(right) / value);
        }
    }
    answer
}

#[cfg(test)]
mod tests;
