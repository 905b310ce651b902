//! Faces cut into pieces that are small enough for shading from corner to corner.

use super::vector::{dot, sub};
use std::collections::BTreeMap;

/// A face or a part of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) corners: [usize; 3],
    /// The number of the face that it is part of.
    pub(super) face: usize,
    /// Whether it is seen from behind.
    pub(super) back: bool,
}

/// Halves a piece at its longest edge until no edge is longer than `limit`, and adds the new points to `x`.
///
/// `halves` remembers the middles of edges, so that pieces of faces that share an edge fit together.
pub(super) fn cut(
    piece: Piece,
    limit: f64,
    x: &mut Vec<[f64; 3]>,
    halves: &mut BTreeMap<[usize; 2], usize>,
) -> Vec<Piece> {
    let mut done = Vec::new();
    let mut open = vec![piece];
    while let Some(piece) = open.pop() {
        let length = |k: usize| distance(&x[piece.corners[k]], &x[piece.corners[(k + 1) % 3]]);
        let mut longest = 0;
        for k in 1..3 {
            if length(k) > length(longest) {
                longest = k;
            }
        }
        if length(longest) <= limit {
            done.push(piece);
            continue;
        }
        let [a, b, c] = [0, 1, 2].map(|k| piece.corners[(longest + k) % 3]);
        let middle = *halves.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            x.push([0, 1, 2].map(|k| 0.5 * (x[a][k] + x[b][k])));
            x.len() - 1
        });
        for corners in [[a, middle, c], [middle, b, c]] {
            open.push(Piece { corners, ..piece });
        }
    }
    done
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let d = sub(a, b);
    dot(&d, &d).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::vector::cross;
    use super::*;

    #[test]
    fn pieces_are_small_and_fit_together() {
        let mut x = vec![
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let piece = |face: usize, corners: [usize; 3]| Piece {
            corners,
            face,
            back: false,
        };
        let mut halves = BTreeMap::new();
        let mut pieces = Vec::new();
        for (face, corners) in [[0, 1, 2], [0, 2, 3]].into_iter().enumerate() {
            pieces.extend(cut(piece(face, corners), 0.3, &mut x, &mut halves));
        }
        let mut sides: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut area = 0.0;
        for p in &pieces {
            let [a, b, c] = p.corners;
            area += 0.5 * cross(&sub(&x[b], &x[a]), &sub(&x[c], &x[a]))[2];
            for [a, b] in [[a, b], [b, c], [c, a]] {
                assert!(distance(&x[a], &x[b]) <= 0.3);
                *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        assert!((area - 2.0).abs() < 1e-12);
        // Every side but those on the rim is shared.
        for ([a, b], count) in sides {
            let on = |axis: usize, v: f64| x[a][axis] == v && x[b][axis] == v;
            let rim = on(0, 0.0) || on(0, 2.0) || on(1, 0.0) || on(1, 1.0);
            assert_eq!(count, if rim { 1 } else { 2 });
        }
    }
}
