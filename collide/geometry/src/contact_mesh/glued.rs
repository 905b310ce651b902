//! Vertices that are glued to each other.

use std::collections::BTreeSet;

/// Which vertices of a mesh count as one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Glued {
    /// For each vertex the lowest number of it and of the vertices that it is glued to.
    lowest: Vec<u32>,
    /// Edges between glued vertices that both sides of a seam have, by these numbers, the lower one first.
    shared: BTreeSet<[u32; 2]>,
}

impl Glued {
    /// Of pairs of vertices, in a mesh of so many vertices with the given edges.
    pub(super) fn new(vertex_count: usize, edges: &[[u32; 2]], pairs: &[[u32; 2]]) -> Self {
        // Each vertex names a lower one that it is glued to, or itself.
        let mut lowest: Vec<u32> = (0..).take(vertex_count).collect();
        for pair in pairs {
            let [a, b] = pair.map(|mut v| {
                while lowest[v as usize] != v {
                    v = lowest[v as usize];
                }
                v
            });
            lowest[a.max(b) as usize] = a.min(b);
        }
        for v in 0..vertex_count {
            lowest[v] = lowest[lowest[v] as usize];
        }
        let (mut seen, mut shared) = (BTreeSet::new(), BTreeSet::new());
        for edge in edges {
            let edge = sorted(edge.map(|v| lowest[v as usize]));
            if !seen.insert(edge) {
                shared.insert(edge);
            }
        }
        Self { lowest, shared }
    }

    /// Adds vertices that are glued to nothing, up to so many in all.
    pub(super) fn extend(&mut self, vertex_count: usize) {
        let count = self.lowest.len();
        self.lowest.extend((0..).take(vertex_count).skip(count));
    }

    /// Whether two primitives have vertices that are the same or glued to each other, or are the two
    /// diagonals of one quadrangle of glued vertices: where two sides of a seam overlap, one side may have
    /// the one and the other side the other diagonal.
    pub(super) fn are_joined(&self, first: &[u32], second: &[u32]) -> bool {
        let lowest = |v: &u32| self.lowest[*v as usize];
        let mut pairs = first
            .iter()
            .flat_map(|v| second.iter().map(move |w| [lowest(v), lowest(w)]));
        if pairs.clone().any(|[v, w]| v == w) {
            return true;
        }
        let are_edges = first.len() == 2 && second.len() == 2;
        are_edges && pairs.all(|pair| self.shared.contains(&sorted(pair)))
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares that are glued onto each other with crossing diagonals, and a third one beside the first.
    #[test]
    fn what_coincides_is_joined_and_what_is_beside_is_not() {
        // Square 0: vertices 0 to 3, diagonal 0 - 2. Square 1: vertices 4 to 7, diagonal 5 - 7.
        let edges = [
            [0, 1],
            [1, 2],
            [2, 3],
            [0, 3],
            [0, 2],
            [4, 5],
            [5, 6],
            [6, 7],
            [4, 7],
            [5, 7],
            [8, 9],
        ];
        let glued = Glued::new(10, &edges, &[[0, 4], [1, 5], [2, 6], [3, 7]]);
        assert!(
            glued.are_joined(&[0, 1], &[4, 7]),
            "a glued vertex in common"
        );
        assert!(glued.are_joined(&[4], &[0, 1, 2]));
        assert!(glued.are_joined(&[0, 2], &[5, 7]), "crossing diagonals");
        assert!(!glued.are_joined(&[0, 2], &[8, 9]));
        assert!(!glued.are_joined(&[3], &[4, 5, 6]));
        // Opposite sides of the square: two of their ends are at the ends of a diagonal, which only one side
        // has.
        assert!(!glued.are_joined(&[0, 1], &[6, 7]));
        assert!(!glued.are_joined(&[0, 3], &[5, 6]));
    }
}
