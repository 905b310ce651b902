//! The matrix of the equations by edges: products that visit every edge once.

use super::rows::WeakRows;
use crate::constraint::rows::point;
use isosheet_mesh::{Sheet, VertexId};
use nalgebra::{Vector2, Vector3};

/// The matrix `W` by edges.
#[derive(Debug, Default)]
pub(super) struct Columns {
    edges: Vec<Edge>,
    /// Where the shares of each edge begin, and their number.
    starts: Vec<usize>,
    shares: Vec<Share>,
}

/// An edge at rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    ends: [VertexId; 2],
    /// Metres.
    pub(super) length: f64,
}

/// The weights of an edge in the two equations of a vertex.
#[derive(Debug, Clone, Copy)]
struct Share {
    vertex: u32,
    /// 1/m2.
    weights: Vector2<f64>,
}

impl Columns {
    pub(super) fn new(sheet: &Sheet, rows: &WeakRows) -> Self {
        let edges = sheet.topology().edges().iter().zip(sheet.lengths());
        let edges: Vec<_> = edges
            .map(|(&ends, &length)| Edge { ends, length })
            .collect();
        let mut by_edge = vec![Vec::new(); edges.len()];
        for v in 0..rows.vertex_count() {
            for term in rows.ring(v).terms {
                by_edge[term.edge as usize].push(Share {
                    vertex: v as u32,
                    weights: term.weights,
                });
            }
        }
        let mut starts = vec![0];
        for shares in &by_edge {
            starts.push(starts[starts.len() - 1] + shares.len());
        }
        Self {
            edges,
            starts,
            shares: by_edge.concat(),
        }
    }

    pub(super) fn edge(&self, index: u32) -> &Edge {
        &self.edges[index as usize]
    }

    fn iter(&self) -> impl Iterator<Item = (&Edge, &[Share])> {
        let shares = self.starts.windows(2).map(|w| &self.shares[w[0]..w[1]]);
        self.edges.iter().zip(shares)
    }

    /// `W` times the vector with the given entry for each edge.
    pub(super) fn product_into(&self, entry: impl Fn(&Edge) -> f64, out: &mut [f64]) {
        out.fill(0.0);
        for (edge, shares) in self.iter() {
            let value = entry(edge);
            for share in shares {
                let i = 2 * share.vertex as usize;
                out[i] += value * share.weights.x;
                out[i + 1] += value * share.weights.y;
            }
        }
    }

    /// `W^T m`.
    pub(super) fn transpose_product_into(&self, m: &[f64], out: &mut [f64]) {
        let m = m.as_chunks::<2>().0;
        for ((_, shares), out) in self.iter().zip(out) {
            let share = |s: &Share| s.weights.dot(&Vector2::from(m[s.vertex as usize]));
            *out = shares.iter().map(share).sum();
        }
    }
}

impl Edge {
    /// Difference of the ends' vectors in `x` (`3V`).
    pub(super) fn difference(&self, x: &[f64]) -> Vector3<f64> {
        point(x, self.ends[0]) - point(x, self.ends[1])
    }

    /// The length error `d_e`, square metres.
    pub(super) fn error(&self, x: &[f64]) -> f64 {
        // The product form loses nothing when the two squares are nearly equal.
        let d = self.difference(x).norm();
        0.5 * (d - self.length) * (d + self.length)
    }
}
