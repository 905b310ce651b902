//! Vertices that rods hold.

use isosheet_dynamics::{SheetModel, immobile_vertices, project_positions};
use isosheet_mesh::{MassKind, VertexId, generate};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Largest displacement along an axis, metres. Most free vertices are left as far away.
const SHAKE: f64 = 0.3;
const TOLERANCE: f64 = 1e-12;

/// How far a tolerance of the lengths lets vertices go that a chain of three lines holds, each of which
/// ends at vertices of the one before, on a sheet of side 1; metres. A line of length `l` with the slack
/// `s` deviates by `sqrt(l s / 2)` in its middle. The slack of the first is `l` times the tolerance, that
/// of the next ones twice the deviation of the one before.
fn leeway() -> f64 {
    let l = 2.0_f64.sqrt();
    let deviation = |slack: f64| (0.5 * l * slack).sqrt();
    let first = deviation(l * TOLERANCE);
    deviation(2.0 * deviation(2.0 * first))
}

proptest! {
    #![proptest_config(isosheet_random::cases(24))]

    /// Vertices found return to their places when the sheet is displaced at random and brought back to
    /// the rest lengths, whatever the others do.
    #[test]
    fn immobile_vertices_do_not_move(seed in 0_u64..1000, angle in 0.0..6.3_f64, part in 0.2..0.5_f64) {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let sheet = generate::delaunay(&square, 0.3, seed).unwrap();
        let along = |v: &VertexId| {
            let p = sheet.position(*v);
            p[0] * angle.cos() + p[1] * angle.sin()
        };
        let mut order: Vec<VertexId> = sheet.topology().vertex_ids().collect();
        order.sort_by(|a, b| along(a).total_cmp(&along(b)));
        order.truncate((part * order.len() as f64) as usize);
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped)
            .and_then(|m| m.with_pins(&order))
            .unwrap();
        let rest = sheet.positions();
        let found = immobile_vertices(&model, rest);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut x: Vec<f64> = rest.iter().map(|c| c + rng.random_range(-SHAKE..SHAKE)).collect();
        for v in &order {
            let k = 3 * v.index();
            x[k..k + 3].copy_from_slice(&rest[k..k + 3]);
        }
        // Where this finds no positions there is nothing to compare with.
        if project_positions(&model, &mut x, TOLERANCE).is_ok() {
            for v in found {
                for k in 3 * v.index()..3 * v.index() + 3 {
                    let moved = (x[k] - rest[k]).abs();
                    prop_assert!(moved < leeway(), "{} by {moved:e}", v.0);
                }
            }
        }
    }
}
