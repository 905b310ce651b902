//! How stiff the barrier at the limit of the strain has to be.

use crate::{PAPER_GRAVITY, PotentialShape, SheetModel, State};
use nalgebra::Vector3;

/// Stiffness of the barrier in parts of the energy of the motion to come, see [`strain_barrier_at_start`]. From 0.01 to
/// 3 all runs end; factorisations a step with 0.003, 0.01, 0.03, 0.1, 0.3, 1 and 3: 40 clamped sheets 5.6, 4.7, 4.8,
/// 5.3, 5.9, 6.7, 7.2; 24 sheets that fall on bodies 40, 17, 15, 16, 17, 19, 21; a banner of 289 vertices on two corners
/// 8.8, 8.1, 9.1, 10, 11, 13, 15.
const BARRIER: f64 = 0.03;

/// The stiffness `kappa` of the barrier of an elastic sheet that starts at a state, joules per square metre: 3 % of
/// `rho (a L + v^2)`, with the mass per area `rho`, the largest acceleration `a` by constant forces (9.8 m/s2 if
/// there are none), the diameter `L` of the sheet and its largest speed `v`. What is in parentheses is about the
/// square of the speed with which the sheet meets an obstacle.
pub(crate) fn strain_barrier_at_start(model: &SheetModel, state: &State) -> f64 {
    let Some(elastic) = model.elastic_sheet() else {
        return 0.0;
    };
    let density = model.mass().total() / elastic.area();
    let own = constant_acceleration(model, state);
    let acceleration = if own > 0.0 && own.is_finite() {
        own
    } else {
        Vector3::from(PAPER_GRAVITY).norm()
    };
    let speed = largest_norm(&state.v);
    BARRIER * density * (acceleration * diameter(&state.x) + speed * speed)
}

/// Largest acceleration of a vertex by potentials that are linear, metres per second squared.
fn constant_acceleration(model: &SheetModel, state: &State) -> f64 {
    let mut gradient = vec![0.0; state.x.len()];
    for p in model.potentials() {
        if p.shape() == PotentialShape::Linear {
            p.add_gradient(state.t, &state.x, &mut gradient);
        }
    }
    for (g, m) in gradient
        .as_chunks_mut::<3>()
        .0
        .iter_mut()
        .zip(&model.mass().vertex)
    {
        g.iter_mut().for_each(|g| *g /= m);
    }
    largest_norm(&gradient)
}

/// Largest norm of the vectors of the vertices.
fn largest_norm(values: &[f64]) -> f64 {
    let vectors = values.as_chunks::<3>().0.iter();
    vectors
        .map(|v| Vector3::from(*v).norm())
        .fold(0.0, f64::max)
}

/// Diagonal of the box around the vertices, metres.
fn diameter(x: &[f64]) -> f64 {
    let extent = |k: usize| {
        let values = || x.as_chunks::<3>().0.iter().map(move |p| p[k]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    Vector3::new(extent(0), extent(1), extent(2)).norm()
}
