//! Layout of a sparse matrix: entries are named once, and found again as slots of the pattern.

use isosheet_linalg::Pattern;

/// Collects the entries of a matrix. What [`Layout::entry`] returns is a place-holder until
/// [`Layout::finish`] gives the slots that place-holders stand for.
#[derive(Debug, Default)]
pub(crate) struct Layout {
    entries: Vec<(u32, u32)>,
}

/// Slots in the values of a pattern, by place-holder.
#[derive(Debug)]
pub(crate) struct Slots(Vec<u32>);

impl Layout {
    /// An entry of the matrix; entries may be named more than once.
    pub(crate) fn entry(&mut self, row: u32, column: u32) -> u32 {
        self.entries.push((row, column));
        (self.entries.len() - 1) as u32
    }

    /// The entries `(3 i + r, 3 j + c)` of a block for pairs `(r, c)`.
    pub(crate) fn block<const N: usize>(
        &mut self,
        [i, j]: [u32; 2],
        entries: [(u32, u32); N],
    ) -> [u32; N] {
        entries.map(|(r, c)| self.entry(3 * i + r, 3 * j + c))
    }

    /// The pattern of a square matrix of the given order, and the slots.
    pub(crate) fn finish(self, order: usize) -> (Pattern, Slots) {
        let (pattern, slots) = Pattern::from_entries(order, order, &self.entries);
        (pattern, Slots(slots))
    }
}

impl Slots {
    /// Replaces place-holders by slots.
    pub(crate) fn resolve(&self, places: &mut [u32]) {
        for place in places {
            *place = self.0[*place as usize];
        }
    }
}

/// The lower triangle of a 3 x 3 block, row by row.
pub(crate) const LOWER: [(u32, u32); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// A whole 3 x 3 block, row by row.
pub(crate) const FULL: [(u32, u32); 9] = [
    (0, 0),
    (0, 1),
    (0, 2),
    (1, 0),
    (1, 1),
    (1, 2),
    (2, 0),
    (2, 1),
    (2, 2),
];

/// The diagonal of a 3 x 3 block.
pub(crate) const DIAGONAL: [(u32, u32); 3] = [(0, 0), (1, 1), (2, 2)];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_point_at_their_entries() {
        let mut layout = Layout::default();
        let mut block = layout.block([1, 0], FULL);
        let mut lower = layout.block([1, 1], LOWER);
        let mut again = [layout.entry(5, 4)];
        let (pattern, slots) = layout.finish(6);
        for places in [&mut block[..], &mut lower[..], &mut again[..]] {
            slots.resolve(places);
        }
        assert_eq!(again[0], lower[4]);
        let column = |slot: u32| {
            let ends = pattern.col_ptr();
            ends.partition_point(|&start| start <= slot as usize) - 1
        };
        for (k, (r, c)) in FULL.iter().enumerate() {
            assert_eq!(pattern.row_idx()[block[k] as usize], 3 + *r as usize);
            assert_eq!(column(block[k]), *c as usize);
        }
        for (k, (r, c)) in LOWER.iter().enumerate() {
            assert_eq!(pattern.row_idx()[lower[k] as usize], 3 + *r as usize);
            assert_eq!(column(lower[k]), 3 + *c as usize);
        }
    }
}
