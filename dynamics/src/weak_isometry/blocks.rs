//! The penalty matrix of the equations in weak form.

use super::rows::WeakRows;
use crate::constraint::rows::point;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// Where the blocks of the matrix `J^T P J` of the equations in weak form are in a sparse matrix: for each
/// ring the lower triangle of its vertices' blocks, row by row.
#[derive(Debug)]
pub(crate) struct RingBlocks {
    /// Where the blocks of each ring begin.
    starts: Vec<usize>,
    blocks: Vec<Option<Block>>,
    jacobian: Vec<[Vector3<f64>; 2]>,
}

/// A block of two different vertices, or of a vertex and itself.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Block {
    /// Of a vertex: the slots of its lower triangle, row by row.
    Diagonal([u32; 6]),
    /// Of two vertices: the slot of the first row of each column; whether its rows belong to the vertex named
    /// first.
    Pair([u32; 3], BlockRows),
}

/// Whose coordinates the rows of a block belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BlockRows {
    First,
    Second,
}

impl RingBlocks {
    /// `block` finds the block of two vertices; there is none where one is pinned.
    pub(crate) fn new(
        rows: &WeakRows,
        block: impl Fn(VertexId, VertexId) -> Option<Block>,
    ) -> Self {
        let (mut starts, mut blocks) = (Vec::new(), Vec::new());
        for v in 0..rows.vertex_count() {
            starts.push(blocks.len());
            let vertices = rows.ring(v).vertices;
            for (i, a) in vertices.iter().enumerate() {
                blocks.extend(vertices[..=i].iter().map(|b| block(*a, *b)));
            }
        }
        Self {
            starts,
            blocks,
            jacobian: Vec::new(),
        }
    }

    /// Adds `J(x)^T P J(x)` to the values of the matrix, with the penalties `P` of the equations.
    pub(crate) fn add(
        &mut self,
        rows: &WeakRows,
        x: &[f64],
        penalties: &[f64],
        values: &mut [f64],
    ) {
        for (v, penalty) in penalties.as_chunks::<2>().0.iter().enumerate() {
            if *penalty == [0.0; 2] {
                continue;
            }
            let ring = rows.ring(v);
            ring.jacobian_into(|w| point(x, w), &mut self.jacobian);
            let mut blocks = self.blocks[self.starts[v]..].iter();
            for i in 0..ring.vertices.len() {
                let [first, second] = self.jacobian[i];
                let weighted = [penalty[0] * first, penalty[1] * second];
                for (other, block) in self.jacobian[..=i].iter().zip(&mut blocks) {
                    match block {
                        Some(block) => block.add(&weighted, other, values),
                        None => continue,
                    }
                }
            }
        }
    }
}

impl Block {
    /// Adds the sum of the two products `u v^T`, rows at the vertex of `u`.
    #[inline]
    fn add(&self, u: &[Vector3<f64>; 2], v: &[Vector3<f64>; 2], values: &mut [f64]) {
        let entry = |r: usize, c: usize| u[0][r] * v[0][c] + u[1][r] * v[1][c];
        match self {
            Self::Diagonal(slots) => {
                let mut k = 0;
                for r in 0..3 {
                    for c in 0..=r {
                        values[slots[k] as usize] += entry(r, c);
                        k += 1;
                    }
                }
            }
            Self::Pair(starts, rows) => {
                for c in 0..3 {
                    let column = &mut values[starts[c] as usize..starts[c] as usize + 3];
                    for (r, value) in column.iter_mut().enumerate() {
                        *value += match rows {
                            BlockRows::First => entry(r, c),
                            BlockRows::Second => entry(c, r),
                        };
                    }
                }
            }
        }
    }
}
