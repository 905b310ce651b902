//! The points of a plate where it is evaluated, and their forces, on the threads of rayon's current pool.

use super::stencil::Stencils;
use crate::evaluation::Evaluation;
use crate::potential::At;
use isosheet_linalg::parallel::{Work, pieces};
use isosheet_mesh::VertexId;
use nalgebra::{Matrix3, Vector3};

/// Nanoseconds for the second derivatives at a point, as for its forces, by a profile of a drape of 2437
/// vertices on one core at 2.4 GHz. It decides what is shared among threads, and no result.
const POINT_TIME: f64 = 35.0;

/// The points of a plate that is flat without stress, where it was evaluated last: the second derivatives of
/// positions as their stencils have them, and the energy, joules.
#[derive(Debug, Default)]
pub(super) struct FlatPoints(Evaluation<(Matrix3<f64>, f64)>);

impl FlatPoints {
    /// Hands the points at a place to `take`.
    pub(super) fn at<R>(
        &self,
        stencils: &Stencils,
        at: At<'_>,
        take: impl FnOnce(&[(Matrix3<f64>, f64)]) -> R,
    ) -> R {
        let point = |k| {
            let second = stencils.of(k).apply(at);
            (second, 0.5 * second.norm_squared())
        };
        self.0.at(at, work(stencils), point, take)
    }
}

/// What it takes to evaluate all points.
pub(super) fn work(stencils: &Stencils) -> Work {
    Work {
        count: stencils.count(),
        each: POINT_TIME,
    }
}

/// Adds the forces of all points to the rows of `gradient`: by the second derivatives, and what turning the
/// normal of a point makes at its corners.
pub(super) fn add_forces<'a, const N: usize>(
    stencils: &Stencils,
    second: impl Fn(usize) -> &'a Matrix3<f64> + Sync,
    turning: impl Fn(usize) -> [(VertexId, Vector3<f64>); N] + Sync,
    gradient: &mut [f64],
) {
    let rows = gradient.as_chunks_mut().0;
    let each = POINT_TIME * stencils.count() as f64 / rows.len().max(1) as f64;
    pieces(rows, each, |first, rows| {
        let mut add = |v: usize, force: &dyn Fn() -> Vector3<f64>| {
            let row: Option<&mut [f64; 3]> = rows.get_mut(v.wrapping_sub(first));
            if let Some(row) = row {
                let force = force();
                for k in 0..3 {
                    row[k] += force[k];
                }
            }
        };
        for (k, stencil) in stencils.iter().enumerate() {
            for (v, force) in turning(k) {
                add(v.index(), &|| force);
            }
            let second = second(k);
            for (v, weights) in stencil {
                add(v, &|| second * weights);
            }
        }
    });
}
