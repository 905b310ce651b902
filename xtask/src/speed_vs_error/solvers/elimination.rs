//! An elimination order for saddle-point matrices.

use crate::timing::Body;
use isosheet_coords::linalg::delay_multipliers;
use isosheet_mesh::VertexId;

/// Elimination order of the saddle-point matrix: nested dissection of the vertices by their positions, every
/// multiplier right after its last vertex.
pub(super) fn elimination(body: &Body) -> Vec<usize> {
    let topology = body.sheet.topology();
    let mut vertices: Vec<VertexId> = topology.vertex_ids().collect();
    let mut order = Vec::with_capacity(vertices.len());
    dissect(body, &mut vertices, &mut order);
    let unknowns = body.system.unknowns();
    let total = unknowns + body.system.equations();
    let mut adjacency = vec![Vec::new(); total];
    for (e, u) in body.system.jacobian_entries() {
        adjacency[u as usize].push(unknowns as u32 + e);
        adjacency[unknowns + e as usize].push(u);
    }
    let base: Vec<usize> = (unknowns..total)
        .chain(order.iter().flat_map(|v| {
            let first = 3 * v.index();
            first..first + 3
        }))
        .collect();
    delay_multipliers(&base, &adjacency, unknowns)
}

/// Vertices that are not cut further.
const LEAF: usize = 12;

/// Cuts the vertices in two halves along their longer side; the border of the second half comes last.
fn dissect(body: &Body, vertices: &mut [VertexId], order: &mut Vec<VertexId>) {
    if vertices.len() <= LEAF {
        order.extend_from_slice(vertices);
        return;
    }
    let at = |v: &VertexId, k: usize| body.sheet.position(*v)[k];
    let extent = |k: usize| {
        let (low, high) = vertices
            .iter()
            .map(|v| at(v, k))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(x), h.max(x))
            });
        high - low
    };
    let k = usize::from(extent(1) > extent(0));
    vertices.sort_by(|a, b| at(a, k).total_cmp(&at(b, k)).then(a.cmp(b)));
    let half = vertices.len() / 2;
    let mut side = vec![0u8; body.sheet.topology().vertex_count()];
    vertices[..half].iter().for_each(|v| side[v.index()] = 1);
    let (mut rest, border): (Vec<VertexId>, Vec<VertexId>) =
        vertices[half..].iter().partition(|v| {
            body.sheet
                .topology()
                .neighbours(**v)
                .all(|w| side[w.index()] != 1)
        });
    dissect(body, &mut vertices[..half], order);
    if rest.len() < vertices.len() - half {
        dissect(body, &mut rest, order);
    } else {
        order.append(&mut rest);
    }
    order.extend(border);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_elimination_order_is_a_permutation() {
        let body = Body::all(2).last().unwrap().unwrap();
        let mut order = elimination(&body);
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..order.len()));
        assert_eq!(
            order.len(),
            body.system.unknowns() + body.system.equations()
        );
    }
}
