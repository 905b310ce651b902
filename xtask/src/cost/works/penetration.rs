//! Whether the cloth penetrates the table or itself, apart from the contact code.

use crate::runs::{CLEARANCE, Pairs, TABLE};
use anyhow::{Context, Result};
use isosheet_collide::{ContactGeometry, ContactMesh, Shape, crossings, crossings_between};
use isosheet_mesh::Topology;

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
    table: ContactGeometry,
    pairs: Pairs,
}

impl Checker {
    pub(super) fn new(sheet: &Topology, pairs: Pairs) -> Result<Self> {
        // A box has no circles, whatever their number of sides.
        let table = Shape::Cuboid { half: TABLE }.contact_geometry(4)?;
        let mut table = table.context("a box has faces")?;
        for p in table.positions.as_chunks_mut::<3>().0 {
            let centre = [0.5, 0.5, -CLEARANCE - TABLE[2]];
            p.iter_mut().zip(centre).for_each(|(p, c)| *p += c);
        }
        Ok(Self {
            sheet: ContactMesh::from_topology(sheet),
            table,
            pairs,
        })
    }

    /// Pairs of an edge and a face that cross.
    pub(super) fn crossings(&self, x: &[f64]) -> usize {
        let (table, corners) = (&self.table.mesh, &self.table.positions);
        let with_table = crossings_between(&self.sheet, x, table, corners).len()
            + crossings_between(table, corners, &self.sheet, x).len();
        match self.pairs {
            Pairs::Table => with_table,
            Pairs::TableAndItself => with_table + crossings(&self.sheet, x).len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_tests::bumped;

    /// A sheet pushed into the table is found by both checks.
    #[test]
    fn penetration_is_seen() {
        let sheet = bumped(2, 1e-3);
        let checker = Checker::new(sheet.topology(), Pairs::TableAndItself).unwrap();
        let mut x = sheet.positions().to_vec();
        assert_eq!((depth(&x), checker.crossings(&x)), (0.0, 0));
        // To the side as well: vertices in the planes of the table's sides cross nothing.
        for p in x.as_chunks_mut::<3>().0 {
            p[0] += 0.03;
            p[1] += 0.02;
            p[2] -= 0.011;
        }
        let middle = depth(&x);
        assert!((middle - 0.01).abs() < 1.1e-3, "{middle}");
        assert!(checker.crossings(&x) > 0);
        // Below the table it is free again.
        for p in x.as_chunks_mut::<3>().0 {
            p[2] -= 0.3;
        }
        assert_eq!((depth(&x), checker.crossings(&x)), (0.0, 0));
    }
}
