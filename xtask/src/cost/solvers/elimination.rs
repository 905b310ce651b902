//! An elimination order for saddle-point matrices.

use super::body::Body;
use isosheet_coords::linalg::{Ordering, elimination_order};

/// Elimination order of the saddle-point matrix `[A G^T; G 0]`: nested dissection of `A`, and every multiplier
/// right after the last of its own unknowns. The pivots of `L D L^T` are positive for the unknowns and negative
/// for the multipliers then, so that no pivoting is needed (Bridson, "An ordering method for the direct
/// solution of saddle-point matrices", 2007).
pub(super) fn elimination(body: &Body) -> Vec<usize> {
    let unknowns = body.system.unknowns();
    let equations = body.system.equations();
    let mut equations_of = vec![Vec::new(); unknowns];
    let mut waiting_for = vec![0; equations];
    for (e, u) in body.system.jacobian_entries() {
        equations_of[u as usize].push(e as usize);
        waiting_for[e as usize] += 1;
    }
    let mut order = Vec::with_capacity(unknowns + equations);
    for u in elimination_order(&body.primal().pattern, 3, Ordering::NestedDissection) {
        order.push(u);
        for &e in &equations_of[u] {
            waiting_for[e] -= 1;
            if waiting_for[e] == 0 {
                order.push(unknowns + e);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multipliers_follow_all_their_unknowns() {
        let body = Body::all(2).last().unwrap().unwrap();
        let mut order = elimination(&body);
        let mut place = vec![0; order.len()];
        for (k, &i) in order.iter().enumerate() {
            place[i] = k;
        }
        for (e, u) in body.system.jacobian_entries() {
            assert!(place[body.system.unknowns() + e as usize] > place[u as usize]);
        }
        order.sort_unstable();
        let total = body.system.unknowns() + body.system.equations();
        assert!(order.into_iter().eq(0..total));
    }
}
