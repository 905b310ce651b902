//! The direction in which a flat crease pattern folds.

use super::fold::Fold;
use isosheet_linalg::{Pattern, SparseLlt};
use isosheet_mesh::{EdgeId, Topology, VertexId, fold_angle};
use nalgebra::Vector3;

/// Sine of the fold angles up to which a sheet is flat: above the round-off of coordinates of seven digits in
/// faces that are a hundredth of the sheet, below any fold that is seen.
pub const FLAT: f64 = 1e-4;

/// Stiffness, beside that of the edges, of what brings vertices back that no edge holds: vertices of a rigid
/// motion, and of parts beyond hinges that may turn.
const RETURN: f64 = 1e-9;

/// The displacements (`3V`, metres) across the plane of a flat sheet at positions `x` (`3V`, metres) at which
/// the fold angles of edges are, to first order, the given targets (radians, positive for a valley), as far
/// as a weighted sum of squares allows:
///
/// ```text
/// sum_e k_e l_e (sum_i g_ei w_i - target_e)^2 / 2  ->  min
/// ```
///
/// with the heights `w_i` of the vertices, the derivatives `g_ei` of the fold angle of edge `e`, its length
/// `l_e` and its weight `k_e`; vertices of `held` stay. The lengths of rods are of second order here and are
/// left out, so that this is a direction to search in, and not yet a branch along which rods can fold.
///
/// Nothing if the sheet is not flat, or no edge has a target.
///
/// # Panics
/// If an edge is at the boundary, or `x` is not of length `3V`.
pub fn folding_from_flat(
    topology: &Topology,
    x: &[f64],
    targets: &[(EdgeId, f64, f64)],
    held: &[VertexId],
) -> Option<Vec<f64>> {
    let is_flat = |(edge, ..): &(EdgeId, f64, f64)| {
        fold_angle(topology, x, *edge).is_none_or(|angle| angle.sin().abs() < FLAT)
    };
    if targets.iter().all(|(_, target, _)| *target == 0.0) || !targets.iter().all(is_flat) {
        return None;
    }
    let count = topology.vertex_count();
    let mut entries: Vec<(u32, u32)> = (0..count as u32).map(|v| (v, v)).collect();
    let mut values = vec![0.0; count];
    let mut heights = vec![0.0; count];
    let mut plane = Vector3::zeros();
    let mut stiffest = 0.0_f64;
    for (edge, target, weight) in targets {
        let [a, b] = topology.edges()[edge.index()];
        let [Some(left), Some(right)] = topology.opposite_vertices(*edge) else {
            panic!("{edge} is at the boundary");
        };
        let vertices = [a, b, left, right];
        let fold = Fold::at(x, &vertices);
        // All faces of a flat sheet have this direction; faces that are folded over have its opposite.
        let normal = fold.normal();
        if plane == Vector3::zeros() {
            plane = normal;
        }
        let slopes = fold.gradient().map(|g| g.dot(&plane));
        let stiffness = weight * fold.length();
        for i in 0..4 {
            heights[vertices[i].index()] += stiffness * target * slopes[i];
            stiffest = stiffest.max(stiffness * slopes[i] * slopes[i]);
            for j in 0..4 {
                if vertices[i] >= vertices[j] {
                    entries.push((vertices[i].0, vertices[j].0));
                    values.push(stiffness * slopes[i] * slopes[j]);
                }
            }
        }
    }
    values[..count].fill(RETURN * stiffest);
    for v in held {
        values[v.index()] = stiffest / RETURN;
    }
    let (pattern, slots) = Pattern::from_entries(count, count, &entries);
    let mut matrix = SparseLlt::new(pattern).ok()?;
    let sums = matrix.values_mut();
    sums.fill(0.0);
    for (slot, value) in slots.iter().zip(values) {
        sums[*slot as usize] += value;
    }
    matrix.factorize().ok()?;
    matrix.solve(&mut heights);
    let displacements = heights.iter().flat_map(|w| (*w * plane).data.0[0]);
    Some(displacements.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::Sheet;
    use isosheet_mesh::generate::{FoldAssignment, miura};

    /// The first-order angles of Miura's pattern agree with its exact motion: every crease turns to its side.
    #[test]
    fn creases_turn_to_their_sides() {
        let pattern = miura(4, 4, 0.05, 0.05, 60.0_f64.to_radians()).unwrap();
        let t = pattern.sheet.topology();
        let x = pattern.sheet.positions();
        let target = |e: EdgeId| match pattern.assignments[e.index()] {
            FoldAssignment::Mountain => Some((e, -1.0, 1.0)),
            FoldAssignment::Valley => Some((e, 1.0, 1.0)),
            FoldAssignment::Flat => Some((e, 0.0, 50.0)),
            _ => None,
        };
        let inside = t.edge_ids().filter(|e| !t.is_boundary_edge(*e));
        let targets: Vec<_> = inside.filter_map(target).collect();
        let d = folding_from_flat(t, x, &targets, &[]).unwrap();
        let moved: Vec<f64> = x.iter().zip(&d).map(|(x, d)| x + 1e-3 * d).collect();
        for &(e, target, _) in &targets {
            let angle = fold_angle(t, &moved, e).unwrap();
            assert!(angle * target >= 0.0, "{e}: {angle}");
        }
        // A sheet that is folded has a direction of its own.
        assert_eq!(folding_from_flat(t, &moved, &targets, &[]), None);
    }

    /// Two triangles: the apex of one rises by the target times its distance from the edge, less the tilt
    /// that leaves the others in their places.
    #[test]
    fn one_crease_has_its_target() {
        let sheet = Sheet::new(
            vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0],
            &[[0, 1, 2], [0, 2, 3]],
        )
        .unwrap();
        let t = sheet.topology();
        let edge = t.find_edge(VertexId(0), VertexId(2)).unwrap();
        let held = [VertexId(0), VertexId(1), VertexId(2)];
        let d = folding_from_flat(t, sheet.positions(), &[(edge, 0.3, 1.0)], &held).unwrap();
        let expected = 0.3 * 0.5_f64.sqrt();
        assert!((d[11] - expected).abs() < 1e-6, "{d:?}");
        assert!(d[..9].iter().all(|c| c.abs() < 1e-6), "{d:?}");
    }
}
