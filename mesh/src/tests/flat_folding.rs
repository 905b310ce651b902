//! What every crease pattern that can be folded flat fulfils, for tests of generators.

use crate::VertexId;
use crate::generate::{FoldAssignment, FoldPattern};
use std::f64::consts::TAU;

/// Checks that a pattern is a flat disk and that every inner vertex of which `folds_flat` is true fulfils the
/// theorems of Maekawa (mountains and valleys differ by two) and of Kawasaki (the sectors between creases,
/// with alternating signs, add up to zero). Returns the number of these vertices.
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
        let (mut directions, mut sum) = (Vec::new(), 0.0);
        for e in creases {
            let [a, b, _] = p.sheet.position(t.other_end(*e, v));
            directions.push((b - y).atan2(a - x));
            sum += p.assignment(*e).sign();
        }
        assert_eq!(f64::abs(sum), 2.0, "Maekawa at {v}");
        directions.sort_by(f64::total_cmp);
        directions.push(directions[0] + TAU);
        let sectors = directions.windows(2).map(|d| d[1] - d[0]);
        let signs = [1.0, -1.0].into_iter().cycle();
        let alternating: f64 = sectors.zip(signs).map(|(sector, sign)| sign * sector).sum();
        assert!(alternating.abs() < 1e-12, "Kawasaki at {v}: {alternating}");
        count += 1;
    }
    count
}
