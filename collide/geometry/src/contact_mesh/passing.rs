//! Ranges of vertices that pass through each other.

use std::ops::Range;

/// Pairs of ranges of vertices: what has its vertices in one of a pair does not repel what has them in the
/// other.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Passing(Vec<[Range<usize>; 2]>);

impl Passing {
    pub(super) fn add(&mut self, pair: [Range<usize>; 2]) {
        self.0.push(pair);
    }

    /// Whether two primitives, each of one range, pass through each other.
    pub(super) fn pass(&self, first: &[u32], second: &[u32]) -> bool {
        let is_in = |range: &Range<usize>, vertices: &[u32]| {
            let first = vertices.first();
            first.is_some_and(|v| range.contains(&(*v as usize)))
        };
        self.0.iter().any(|[a, b]| {
            is_in(a, first) && is_in(b, second) || is_in(b, first) && is_in(a, second)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_pass_through_each_other_and_not_through_themselves_unless_named() {
        let mut passing = Passing::default();
        assert!(!passing.pass(&[0], &[4, 5]));
        passing.add([0..4, 4..8]);
        assert!(passing.pass(&[0], &[4, 5]) && passing.pass(&[6, 7], &[3]));
        assert!(!passing.pass(&[0], &[1, 2, 3]) && !passing.pass(&[0], &[8, 9]));
        passing.add([8..12, 8..12]);
        assert!(passing.pass(&[8], &[9, 10, 11]));
    }
}
