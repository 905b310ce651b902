//! Matrices for tests.

use super::pattern::Pattern;

/// The matrices of square grids, one beside the other, whose nodes have `block` unknowns each.
pub(super) fn grids(sides: &[u32], block: u32) -> (Pattern, Vec<f64>) {
    let (mut entries, mut first) = (Vec::new(), 0);
    for side in sides {
        let at = |i: u32, j: u32| first + i * side + j;
        for i in 0..*side {
            for j in 0..*side {
                for (k, l) in [(i, j), (i + 1, j), (i, j + 1)] {
                    if k < *side && l < *side {
                        entries.push((at(k, l), at(i, j)));
                    }
                }
            }
        }
        first += side * side;
    }
    let in_block = |&(r, c): &(u32, u32)| {
        let rows = (0..block).flat_map(move |a| (0..block).map(move |b| (a, b)));
        rows.map(move |(a, b)| (block * r + a, block * c + b))
            .filter(|(r, c)| r >= c)
    };
    let entries: Vec<(u32, u32)> = entries.iter().flat_map(in_block).collect();
    let n = (first * block) as usize;
    let (pattern, slots) = Pattern::from_entries(n, n, &entries);
    let mut values = vec![0.0; pattern.len()];
    for (&(r, c), slot) in entries.iter().zip(slots) {
        values[slot as usize] = if r == c {
            5.1 * f64::from(block)
        } else {
            -f64::from(r + 3 * c).sin()
        };
    }
    (pattern, values)
}
