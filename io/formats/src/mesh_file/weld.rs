//! Welding: vertices at one place become one.

use super::MeshFile;
use std::collections::HashMap;

/// Least size of a cell of the grid, as a part of the extent of the mesh: numbers of cells stay below
/// 2^53, so that they are exact, and coordinates that differ by less than their round-off fall into few
/// cells.
const LEAST_CELL: f64 = 1e-15;

impl MeshFile {
    /// Makes each vertex within `tolerance` (Euclidean distance, in the unit of the mesh) of an earlier
    /// one that was kept that vertex, and removes faces of which two corners were welded.
    ///
    /// Vertices are visited in order; of several kept ones within reach the nearest is taken, the first on a
    /// tie. With tolerance 0 coordinates have to be equal. `parts` are the first vertices of parts that stay
    /// apart.
    pub(super) fn weld(&mut self, tolerance: f64, parts: &[usize]) {
        let points = self.positions.as_chunks::<3>().0;
        let bound = |take: fn(f64, f64) -> f64, start: f64| -> [f64; 3] {
            std::array::from_fn(|k| points.iter().fold(start, |m, p| take(m, p[k])))
        };
        let (low, high) = (
            bound(f64::min, f64::INFINITY),
            bound(f64::max, f64::NEG_INFINITY),
        );
        let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        // An extent beyond the largest number leaves one cell; a single place needs no more.
        let size = tolerance.max(LEAST_CELL * extent);
        let cell = |p: &[f64; 3]| -> [i64; 3] {
            std::array::from_fn(|k| {
                let index = ((p[k] - low[k]) / size).floor();
                if index.is_finite() { index as i64 } else { 0 }
            })
        };
        let mut kept: HashMap<Cell, Vec<u32>> = HashMap::new();
        let mut label = Vec::with_capacity(points.len());
        let mut places = Vec::new();
        for (v, p) in points.iter().enumerate() {
            let at = (parts.partition_point(|&first| first <= v), cell(p));
            let found = nearest(&kept, &places, at, p, tolerance);
            label.push(found.unwrap_or_else(|| {
                let v = places.len() as u32;
                places.push(*p);
                kept.entry(at).or_default().push(v);
                v
            }));
        }
        self.changes.welded_vertices += points.len() - places.len();
        self.positions = places.into_flattened();
        self.relabel(&label);
        self.changes.collapsed_faces += self.retain_faces(|[a, b, c]| a != b && b != c && c != a);
        self.diagonals.retain(|[a, b]| a != b);
        self.unite_creases();
    }
}

/// A part of the mesh and a cell of the grid.
type Cell = (usize, [i64; 3]);

/// The nearest kept vertex within the tolerance.
fn nearest(
    kept: &HashMap<Cell, Vec<u32>>,
    places: &[[f64; 3]],
    (part, at): Cell,
    p: &[f64; 3],
    tolerance: f64,
) -> Option<u32> {
    let mut best: Option<(f64, u32)> = None;
    // The 27 cells about a place, of which the one in the middle has what is equal.
    for offset in if tolerance > 0.0 { 0..27_i64 } else { 13..14 } {
        let shift = [offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1];
        let neighbour = std::array::from_fn(|k| at[k].saturating_add(shift[k]));
        for &v in kept.get(&(part, neighbour)).into_iter().flatten() {
            let q = places[v as usize];
            let distance = (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2]);
            let better = best.is_none_or(|b| (distance, v) < b);
            if distance <= tolerance && better {
                best = Some((distance, v));
            }
        }
    }
    best.map(|(_, v)| v)
}

#[cfg(test)]
mod tests {
    use crate::{MeshFormat, MeshOptions, parse_mesh};
    use std::path::Path;

    /// Two triangles that miss each other by 1e-3 along their common edge.
    const GAP: &str =
        "OFF 6 2 0\n0 0 0\n1 0 0\n0 1 0\n1 0.001 0\n1 1 0\n0 1.001 0\n3 0 1 2\n3 3 4 5\n";

    fn welded(weld: Option<f64>) -> (usize, usize) {
        let options = MeshOptions {
            weld,
            ..MeshOptions::default()
        };
        let path = Path::new("gap.off");
        let mesh = parse_mesh(GAP.as_bytes(), MeshFormat::Off, path, &options).unwrap();
        (mesh.vertex_count(), mesh.faces.len())
    }

    #[test]
    fn the_tolerance_decides_what_is_one_vertex() {
        assert_eq!(welded(None), (6, 2));
        assert_eq!(welded(Some(0.0)), (6, 2));
        assert_eq!(welded(Some(0.0009)), (6, 2));
        assert_eq!(welded(Some(0.0011)), (4, 2));
        assert_eq!(welded(Some(10.0)), (1, 0), "all is one place");
        assert_eq!(welded(Some(1e-300)), (6, 2));
    }

    #[test]
    fn no_pair_within_the_tolerance_is_left_and_none_beyond_it_is_made_one() {
        let n = 400;
        let mut text = format!("OFF {n} 1 0\n");
        let mut state = 7_u64;
        let mut points = Vec::new();
        for _ in 0..n {
            let mut number = || {
                state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (state >> 40) as f64 / (1u64 << 24) as f64
            };
            let p = [number(), number(), 0.1 * number()];
            text += &format!("{} {} {}\n", p[0], p[1], p[2]);
            points.push(p);
        }
        text += "3 0 1 2\n";
        let tolerance = 0.05;
        let options = MeshOptions {
            weld: Some(tolerance),
            ..MeshOptions::default()
        };
        let mesh = parse_mesh(
            text.as_bytes(),
            MeshFormat::Off,
            Path::new("x.off"),
            &options,
        )
        .unwrap();
        let kept = mesh.positions.as_chunks::<3>().0;
        assert!(kept.len() < n && kept.len() > 20);
        let distance =
            |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
        for (k, p) in kept.iter().enumerate() {
            assert!(kept[..k].iter().all(|q| distance(p, q) > tolerance));
        }
        assert!(
            points
                .iter()
                .all(|p| kept.iter().any(|q| distance(p, q) <= tolerance))
        );
    }
}
