//! What every crease pattern that can be folded flat fulfils, for tests of generators.

use crate::generate::{FoldAssignment, FoldPattern};
use crate::{FlatCrease, FlatFoldingLaw, VertexId};

/// Checks that a pattern is a flat disk and that every inner vertex of which `folds_flat` is true breaks no
/// [`FlatFoldingLaw`]. Returns the number of these vertices.
pub(crate) fn check_flat_folding(p: &FoldPattern, folds_flat: impl Fn(VertexId) -> bool) -> usize {
    let t = p.sheet.topology();
    t.check_invariants();
    assert_eq!((t.euler_characteristic(), t.component_count()), (1, 1));
    assert!(p.sheet.positions().chunks_exact(3).all(|x| x[2] == 0.0));
    p.sheet.check_developable(1e-12).unwrap();
    for e in t.edge_ids() {
        let is_boundary = p.assignment(e) == FoldAssignment::Boundary;
        assert_eq!(is_boundary, t.is_boundary_edge(e), "{e}");
    }
    let inner = t.vertex_ids().filter(|v| !t.is_boundary_vertex(*v));
    let mut count = 0;
    for v in inner.filter(|v| folds_flat(*v)) {
        let [x, y, _] = p.sheet.position(v);
        let edges = t.vertex_edges(v).iter();
        let creases = edges.filter(|e| p.assignment(**e).sign() != 0.0);
        let creases = creases.map(|e| {
            let [a, b, _] = p.sheet.position(t.other_end(*e, v));
            FlatCrease {
                direction: (b - y).atan2(a - x),
                is_mountain: p.assignment(*e) == FoldAssignment::Mountain,
            }
        });
        let creases: Vec<FlatCrease> = creases.collect();
        assert_eq!(FlatFoldingLaw::broken(&creases, 1e-12), None, "{v}");
        count += 1;
    }
    count
}
