//! Dependent rods that block a motion.

use crate::linear::rod_least_squares::RodLeastSquares;
use crate::{SheetModel, State};
use isosheet_linalg::norm_inf;
use isosheet_materials::potential::Memories;
use isosheet_materials::vectors::point;
use isosheet_mesh::VertexId;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Singular value of the rigidity matrix of unit rods below which rods are dependent, as in
/// [`rod_rank`](crate::rod_rank).
const DEPENDENT_BELOW: f64 = 1e-5;
/// Part of the second-order elongations, or of random forces, outside the range of the rigidity matrix from
/// which a motion is blocked. It is 1e-5 or less where a sheet may fold along a line of the mesh, a tenth or
/// more elsewhere.
const UNREACHED_PART: f64 = 1e-2;
/// Part of the largest value from which displacements of vertices and elongations of rods count.
const COUNTED_PART: f64 = 0.1;

/// The free vertices that inertia and loads would move within `h` seconds at rods that block the motion to
/// second order; none where it is not blocked, and for sheets without rods.
///
/// The free displacement is projected onto the first-order flexes `A d = 0` of the rigidity matrix `A` of
/// unit rods. The elongations `q_e = |d_a - d_b|^2 / (2 l_e)` need a second-order displacement `A w = -q`;
/// the part of `q` outside the range of `A` is a self-stress of the blocking rods (Connelly and Whiteley,
/// SIAM J. Discrete Math. 9, 1996).
pub(crate) fn blocked_vertices(
    model: &SheetModel,
    memories: &Memories,
    state: &State,
    h: f64,
) -> Vec<VertexId> {
    let x = &state.x;
    let Some(mut solver) =
        rods_of(model).and_then(|model| RodLeastSquares::new(model, x, DEPENDENT_BELOW))
    else {
        return Vec::new();
    };
    let rods = model.rods();
    let lengths = rods.lengths();
    let mut d = free_displacement(model, memories, state, h);
    let mut rates = vec![0.0; rods.len()];
    rods.apply(x, &d, &mut rates);
    for (r, l) in rates.iter_mut().zip(lengths) {
        *r /= l;
    }
    let correction = solver.reduce(&mut rates);
    for (d, c) in d.iter_mut().zip(correction) {
        *d -= c;
    }
    let largest = norm_inf(&d);
    if largest == 0.0 {
        return Vec::new();
    }
    let elongation = |([a, b], l): (&[usize; 2], &f64)| {
        let [a, b] = [a, b].map(|v| point(&d, VertexId(*v as u32)));
        ((a - b) / largest).norm_squared() / (2.0 * l)
    };
    let mut left: Vec<f64> = rods.edges().iter().zip(lengths).map(elongation).collect();
    let asked = norm_inf(&left);
    // Ends of rods that move alike but for round-off make no elongation.
    if asked * model.mean_length() <= f64::EPSILON {
        return Vec::new();
    }
    solver.reduce(&mut left);
    let most = norm_inf(&left);
    if most <= UNREACHED_PART * asked {
        return Vec::new();
    }
    let mut vertices = free_ends(model, &left, most);
    vertices.retain(|v| point(&d, *v).norm() >= COUNTED_PART * largest);
    vertices
}

/// The free vertices at rods with self-stresses, found from a random vector of forces, at positions `x`
/// (`3V`, metres); none for sheets without rods.
pub(crate) fn dependent_vertices(model: &SheetModel, x: &[f64]) -> Vec<VertexId> {
    let Some(mut solver) =
        rods_of(model).and_then(|model| RodLeastSquares::new(model, x, DEPENDENT_BELOW))
    else {
        return Vec::new();
    };
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let count = model.rods().len();
    let mut left: Vec<f64> = (0..count).map(|_| rng.random_range(-1.0..1.0)).collect();
    for (left, [a, b]) in left.iter_mut().zip(model.rods().edges()) {
        if [a, b].iter().all(|v| model.is_pinned(VertexId(**v as u32))) {
            *left = 0.0;
        }
    }
    solver.reduce(&mut left);
    match norm_inf(&left) {
        most if most > UNREACHED_PART => free_ends(model, &left, most),
        _ => Vec::new(),
    }
}

/// The model, if it has rods.
fn rods_of(model: &SheetModel) -> Option<&SheetModel> {
    (!model.rods().is_empty()).then_some(model)
}

/// The free vertices at rods with values above [`COUNTED_PART`] of the largest.
fn free_ends(model: &SheetModel, values: &[f64], largest: f64) -> Vec<VertexId> {
    let counting = model.rods().edges().iter().zip(values);
    let counting = counting.filter(|(_, q)| q.abs() >= COUNTED_PART * largest);
    let ends = counting.flat_map(|(ends, _)| ends.map(|v| VertexId(v as u32)));
    let mut vertices: Vec<VertexId> = ends.filter(|v| !model.is_pinned(*v)).collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// The displacements within `h` seconds without rods, metres.
fn free_displacement(model: &SheetModel, memories: &Memories, state: &State, h: f64) -> Vec<f64> {
    let State { t, x, v } = state;
    let mut force = vec![0.0; x.len()];
    let mut applied = vec![0.0; x.len()];
    model.acting_force(memories, *t, x, &mut force);
    model.applied_force(*t, x, v, &mut applied);
    let masses = &model.mass().vertex;
    let free = |i: usize| h * v[i] + h * h * (force[i] + applied[i]) / masses[i / 3];
    let mut d: Vec<f64> = (0..x.len()).map(free).collect();
    model.clear_pinned(&mut d);
    let mut end = x.clone();
    model.place_pins(t + h, &mut end);
    for (d, (end, x)) in d.iter_mut().zip(end.iter().zip(x)) {
        *d += end - x;
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, Sheet, generate};

    const STEP: f64 = 1.0 / 60.0;

    /// The blocked vertices of a flat sheet, at rest under its weight, with the vertices pinned for which the
    /// function is at most zero.
    fn blocked(sheet: &Sheet, beyond: impl Fn([f64; 3]) -> f64) -> (SheetModel, Vec<VertexId>) {
        let vertices = sheet.topology().vertex_ids();
        let pins: Vec<VertexId> = vertices
            .filter(|v| beyond(sheet.position(*v)) <= 0.0)
            .collect();
        let model = SheetModel::new(sheet, 0.1, MassKind::Lumped)
            .and_then(|m| m.with_gravity().with_pins(&pins))
            .unwrap();
        let state = State::at_rest(sheet.positions().to_vec());
        let found = blocked_vertices(&model, &model.memories(), &state, STEP);
        (model, found)
    }

    /// Along lines of the mesh clamped sheets fold, across them they do not.
    #[test]
    fn clamps_across_the_mesh_block() {
        for cells in [4, 8] {
            let sheet = generate::anisotropic_grid(cells, cells, 1.0, 1.0).unwrap();
            let h = 1.0 / cells as f64;
            assert_eq!(blocked(&sheet, |p| p[0] - 1.01 * h).1, []);
            assert_eq!(blocked(&sheet, |p| p[1] - 1.01 * h).1, []);
            let (model, found) = blocked(&sheet, |p| p[0] + 0.4 * p[1] - 0.4);
            assert!(found.len() > 2, "{found:?}");
            // They are free, and some are beside the clamp.
            assert!(found.iter().all(|v| !model.is_pinned(*v)), "{found:?}");
            let beside = |v: &VertexId| {
                let mut near = model.topology().neighbours(*v);
                near.any(|n| model.is_pinned(n))
            };
            assert!(found.iter().any(beside), "{found:?}");
        }
    }

    /// The rods around each interior vertex of a flat sheet depend on each other; in a folded sheet they do
    /// not.
    #[test]
    fn rods_of_flat_parts_are_dependent() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        let mut x = sheet.positions().to_vec();
        // (A random self-stress leaves some of the vertices nearly free of forces.)
        assert!(dependent_vertices(&model, &x).len() > x.len() / 6);
        for p in x.chunks_mut(3) {
            p[2] = 0.2 * (3.0 * p[0]).sin() * (1.0 + p[1]);
        }
        let folded = Sheet::new(x.clone(), &sheet.face_indices()).unwrap();
        let model = SheetModel::new(&folded, 0.1, MassKind::Lumped).unwrap();
        assert_eq!(dependent_vertices(&model, &x), []);
    }

    /// Without a clamp, and for elastic sheets, nothing blocks.
    #[test]
    fn free_and_elastic_sheets_are_not_blocked() {
        let sheet = generate::delaunay_square(1.0, 0.2, 5).unwrap();
        assert_eq!(blocked(&sheet, |_| 1.0).1, []);
        let (model, found) = blocked(&sheet, |p| p[0] + 0.4 * p[1] - 0.4);
        assert!(!found.is_empty());
        let elasticity = crate::ElasticSheet::new(&sheet, 1e3, 0.3).unwrap();
        let model = model.with_elastic_sheet(elasticity).unwrap();
        let state = State::at_rest(sheet.positions().to_vec());
        assert_eq!(
            blocked_vertices(&model, &model.memories(), &state, STEP),
            []
        );
    }
}
