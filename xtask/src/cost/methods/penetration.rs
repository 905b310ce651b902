//! Whether the cloth penetrates the table or itself, apart from the contact code.

use crate::runs::{CLEARANCE, Pairs, TABLE};
use anyhow::Result;
use isosheet_collide::{ContactMesh, crossings, crossings_between};
use isosheet_mesh::Sheet;

/// Depth of the deepest vertex in the table, metres; 0 if none is inside.
pub(super) fn depth(x: &[f64]) -> f64 {
    x.as_chunks::<3>().0.iter().fold(0.0, |deepest: f64, p| {
        let sides = (TABLE[0] - (p[0] - 0.5).abs()).min(TABLE[1] - (p[1] - 0.5).abs());
        let below_top = -CLEARANCE - p[2];
        deepest.max(sides.min(below_top).min(2.0 * TABLE[2] - below_top))
    })
}

/// The table as triangles, and the sheet.
pub(super) struct Checker {
    sheet: ContactMesh,
    table: ContactMesh,
    corners: Vec<f64>,
}

impl Checker {
    pub(super) fn new(sheet: &Sheet) -> Result<Self> {
        // Corner k lies towards positive x, y, z where its bits 1, 2, 4 are set.
        let corners = (0..8)
            .flat_map(|k| {
                let side = |bit: u32, half: f64| if k & bit == 0 { -half } else { half };
                [
                    0.5 + side(1, TABLE[0]),
                    0.5 + side(2, TABLE[1]),
                    side(4, TABLE[2]) - TABLE[2] - CLEARANCE,
                ]
            })
            .collect();
        let faces: Vec<[u32; 3]> = [
            [0, 1, 3, 2],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 3, 7, 5],
        ]
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
        Ok(Self {
            sheet: ContactMesh::from_topology(sheet.topology()),
            table: ContactMesh::from_triangles(8, &faces)?,
            corners,
        })
    }

    /// Pairs of an edge and a face that cross.
    pub(super) fn crossings(&self, x: &[f64], pairs: Pairs) -> usize {
        let table = crossings_between(&self.sheet, x, &self.table, &self.corners).len()
            + crossings_between(&self.table, &self.corners, &self.sheet, x).len();
        match pairs {
            Pairs::Table => table,
            Pairs::TableAndItself => table + crossings(&self.sheet, x).len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::{BUMP, bumped};

    /// A sheet pushed into the table is found by both checks.
    #[test]
    fn penetration_is_seen() {
        let sheet = bumped(2, BUMP);
        let checker = Checker::new(&sheet).unwrap();
        let mut x = sheet.positions().to_vec();
        assert_eq!(
            (depth(&x), checker.crossings(&x, Pairs::TableAndItself)),
            (0.0, 0)
        );
        // To the side as well: vertices in the planes of the table's sides cross nothing.
        for p in x.as_chunks_mut::<3>().0 {
            p[0] += 0.03;
            p[1] += 0.02;
            p[2] -= 0.011;
        }
        let middle = depth(&x);
        assert!((middle - 0.01).abs() < 1.1e-3, "{middle}");
        assert!(checker.crossings(&x, Pairs::Table) > 0);
        // Below the table it is free again.
        for p in x.as_chunks_mut::<3>().0 {
            p[2] -= 0.3;
        }
        assert_eq!((depth(&x), checker.crossings(&x, Pairs::Table)), (0.0, 0));
    }
}
