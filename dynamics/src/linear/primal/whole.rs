//! The whole primal matrix, far couplings included, for direct factorisation.

use super::cost::Direct;
use super::far::FarCouplings;
use crate::linear::layout::FULL;
use isosheet_linalg::{LinalgError, Pattern, SparseLlt};

pub(super) struct WholeMatrix {
    llt: SparseLlt,
    /// Slots of the values of the matrix without far couplings.
    near: Vec<u32>,
    /// Slots of the block of each far pair, row by row.
    far: Vec<[u32; 9]>,
}

impl WholeMatrix {
    /// Of a matrix with the pattern `near` and far couplings of the given pairs.
    pub(super) fn new(near: &Pattern, pairs: &[[u32; 2]]) -> Result<Self, LinalgError> {
        let columns = (0..near.cols()).flat_map(|c| {
            let rows = &near.row_idx()[near.col_ptr()[c]..near.col_ptr()[c + 1]];
            rows.iter().map(move |&r| (r as u32, c as u32))
        });
        let blocks = pairs
            .iter()
            .flat_map(|[i, j]| FULL.map(|(r, c)| (3 * i + r, 3 * j + c)));
        let entries: Vec<(u32, u32)> = columns.chain(blocks).collect();
        let (pattern, mut slots) = Pattern::from_entries(near.cols(), near.cols(), &entries);
        let far = slots.split_off(near.len());
        Ok(Self {
            llt: SparseLlt::with_blocks(pattern, 3)?,
            near: slots,
            far: far.as_chunks().0.to_vec(),
        })
    }

    pub(super) fn cost(&self) -> Direct {
        Direct::of(&self.llt)
    }

    /// Factorises the matrix with the given parts.
    pub(super) fn factorize(
        &mut self,
        near: &[f64],
        far: &FarCouplings,
    ) -> Result<(), LinalgError> {
        let values = self.llt.values_mut();
        values.fill(0.0);
        for (slot, value) in self.near.iter().zip(near) {
            values[*slot as usize] = *value;
        }
        far.for_each(|pair, block| {
            for (slot, (r, c)) in self.far[pair].iter().zip(FULL) {
                values[*slot as usize] += block[(r as usize, c as usize)];
            }
        });
        self.llt.factorize()
    }

    pub(super) fn solve(&mut self, rhs: &mut [f64]) {
        self.llt.solve(rhs);
    }
}
