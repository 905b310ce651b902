//! A flat square that is bent to a part of a polygonal cylinder.

use isosheet_mesh::{Sheet, generate};

/// The union-jack square `M^level` of side 1 m, which is flat at rest, and its positions (3V, metres) bent by
/// `angle` radians at each of its inner lines of edges that are parallel to y: a developable state in which
/// no inner vertex is flat, so that the lengths are independent of each other.
pub fn bent(level: u32, angle: f64) -> (Sheet, Vec<f64>) {
    let sheet = generate::isotropic_square(level, 1.0).expect("a level that memory can hold");
    let cells = 2 << level;
    let width = 1.0 / f64::from(cells);
    let mut profile = vec![[0.0, 0.0]];
    for k in 0..cells {
        let turn = angle * (f64::from(k) - 0.5 * f64::from(cells - 1));
        let [x, z] = profile[k as usize];
        profile.push([x + width * turn.cos(), z + width * turn.sin()]);
    }
    let columns = sheet.positions().as_chunks::<3>().0.iter();
    let bent = columns.flat_map(|[x, y, _]| {
        let [x, z] = profile[(x * f64::from(cells)).round() as usize];
        [x, *y, z]
    });
    let bent = bent.collect();
    (sheet, bent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{LengthConstraints, fold_angle};

    #[test]
    fn lengths_are_kept_and_lines_are_folded() {
        let (sheet, x) = bent(2, 0.3);
        assert!(LengthConstraints::new(&sheet).max_strain(&x) < 1e-14);
        let t = sheet.topology();
        let folds = t.edge_ids().filter_map(|e| fold_angle(t, &x, e));
        let folded: Vec<f64> = folds.map(f64::abs).filter(|f| *f > 1e-9).collect();
        // Eight cells across: seven lines of eight edges.
        assert_eq!(folded.len(), 7 * 8);
        assert!(folded.iter().all(|f| (f - 0.3).abs() < 1e-12));
    }
}
