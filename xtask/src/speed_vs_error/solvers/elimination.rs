//! An elimination order for saddle-point matrices.

use crate::timing::Body;
use isosheet_coords::linalg::{Ordering, delay_multipliers, elimination_order};

/// Elimination order of the saddle-point matrix: nested dissection of the primal matrix, every multiplier
/// right after its last vertex.
pub(super) fn elimination(body: &Body) -> Vec<usize> {
    let unknowns = body.system.unknowns();
    let total = unknowns + body.system.equations();
    let mut adjacency = vec![Vec::new(); total];
    for (e, u) in body.system.jacobian_entries() {
        adjacency[u as usize].push(unknowns as u32 + e);
        adjacency[unknowns + e as usize].push(u);
    }
    let primal = elimination_order(&body.primal().pattern, 3, Ordering::NestedDissection);
    let base: Vec<usize> = (unknowns..total).chain(primal).collect();
    delay_multipliers(&base, &adjacency, unknowns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_elimination_order_is_a_permutation() {
        let body = Body::all(2).last().unwrap().unwrap();
        let mut order = elimination(&body);
        order.sort_unstable();
        let total = body.system.unknowns() + body.system.equations();
        assert!(order.into_iter().eq(0..total));
    }
}
