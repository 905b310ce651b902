//! Parts of a surface that do not touch themselves.

use std::collections::BTreeSet;
use std::ops::Range;

/// Which parts the vertices of a mesh belong to, and which other vertices are attached to parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Parts {
    /// Of each vertex its part, if it belongs to one.
    of: Vec<Option<u32>>,
    /// Vertices with the parts that they are attached to.
    attached: BTreeSet<(u32, u32)>,
}

impl Parts {
    /// Of so many vertices.
    pub(super) fn new(
        vertex_count: usize,
        parts: &[Range<usize>],
        attached: impl IntoIterator<Item = (u32, u32)>,
    ) -> Self {
        let mut of = vec![None; vertex_count];
        for (number, part) in (0..).zip(parts) {
            of[part.clone()].fill(Some(number));
        }
        Self {
            of,
            attached: attached.into_iter().collect(),
        }
    }

    /// Adds so many vertices to a part.
    pub(super) fn extend(&mut self, count: usize, part: usize) {
        self.of
            .extend(std::iter::repeat_n(Some(part as u32), count));
    }

    /// Whether two primitives are of one part, or one is attached to that of the other.
    pub(super) fn are_joined(&self, first: &[u32], second: &[u32]) -> bool {
        let of = |vertices: &[u32]| vertices.first().and_then(|v| self.of[*v as usize]);
        let is_attached = |vertices: &[u32], part: Option<u32>| {
            let mut vertices = vertices.iter();
            part.is_some_and(|part| vertices.any(|v| self.attached.contains(&(*v, part))))
        };
        let parts = [of(first), of(second)];
        parts[0].is_some() && parts[0] == parts[1]
            || is_attached(first, parts[1])
            || is_attached(second, parts[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bodies and a sheet, of which a vertex is attached to the first body: the bodies meet.
    #[test]
    fn bodies_meet_each_other_and_not_what_is_attached_to_them() {
        let parts = Parts::new(12, &[4..8, 8..12], [(1, 0)]);
        assert!(parts.are_joined(&[4, 5], &[6, 7]));
        assert!(!parts.are_joined(&[4], &[8, 9, 10]));
        assert!(parts.are_joined(&[0, 1], &[4, 5]) && parts.are_joined(&[7], &[0, 1, 2]));
        assert!(!parts.are_joined(&[0, 2], &[4, 5]) && !parts.are_joined(&[0, 1], &[8, 9]));
        assert!(!parts.are_joined(&[0], &[1, 2, 3]));
    }
}
