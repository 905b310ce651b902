//! Momentum that projections have given to the sheet and that is not yet assigned to the supports.

use crate::SheetModel;
use crate::linear::shares::{Shares, shares};
use crate::report::checkpoint_error::{CheckpointError, check_finite, check_length};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Largest number of entries, one for each iteration of a projection; projections need three to six. The
/// momentum of later iterations is added to the last entry.
const MAX_ENTRIES: usize = 16;
/// The parts of a step's change of momentum that no multiplier is known for, each with the positions whose
/// rods and vertex constraints gave it: iterations of a projection, and what a minimisation left.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ResidualMomentum {
    entries: Vec<Entry>,
    len: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Entry {
    /// `3V`, metres.
    x: Vec<f64>,
    /// Vertex constraints that took part.
    active: Vec<bool>,
    /// `3V`.
    momentum: Vec<f64>,
}

impl ResidualMomentum {
    /// With room, except where nothing holds the sheet. (The default has none.)
    pub(crate) fn new(model: &SheetModel) -> Self {
        let n = model.coordinate_count();
        let entry = Entry {
            x: vec![0.0; n],
            active: vec![false; model.constraints().len()],
            momentum: vec![0.0; n],
        };
        let room = if model.has_supports() { MAX_ENTRIES } else { 0 };
        Self {
            entries: vec![entry; room],
            len: 0,
        }
    }

    pub(crate) fn has_room(&self) -> bool {
        !self.entries.is_empty()
    }

    /// The entries alone, without room for further ones.
    pub(crate) fn compact(&self) -> Self {
        Self {
            entries: self.entries[..self.len].to_vec(),
            len: self.len,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds momentum given at positions `x` by the rods and the vertex constraints `active`, and returns
    /// where more of it may be added.
    pub(crate) fn push(
        &mut self,
        x: &[f64],
        active: &[bool],
        momentum: impl Iterator<Item = f64>,
    ) -> &mut [f64] {
        if self.len < MAX_ENTRIES {
            let entry = &mut self.entries[self.len];
            self.len += 1;
            entry.x.copy_from_slice(x);
            entry.active.copy_from_slice(active);
            entry.momentum.fill(0.0);
        }
        let entry = &mut self.entries[self.len - 1];
        for (sum, m) in entry.momentum.iter_mut().zip(momentum) {
            *sum += m;
        }
        &mut entry.momentum
    }

    /// Takes over another one, in place.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        if self.entries.len() < other.len {
            self.clone_from(other);
        } else {
            self.clear();
            self.append(other, 1.0);
        }
    }

    /// Refuses arrays of the wrong length and numbers that are not finite, for `n` coordinates and `m` vertex
    /// constraints.
    pub(crate) fn check(&self, n: usize, m: usize) -> Result<(), CheckpointError> {
        const WHAT: &str = "momenta that are not shared out";
        if self.len > self.entries.len() {
            check_length(WHAT, self.entries.len(), self.len)?;
        }
        for entry in &self.entries {
            check_length(WHAT, entry.momentum.len(), n)?;
            check_length("positions of these", entry.x.len(), n)?;
            check_length("constraints of these", entry.active.len(), m)?;
            check_finite(WHAT, &entry.momentum)?;
            check_finite("positions of these", &entry.x)?;
        }
        Ok(())
    }

    /// Sum of the momenta, and of their moments about a point, over all vertices.
    pub(crate) fn sums(&self, about: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let mut sums = [Vector3::zeros(); 2];
        for Entry { x, momentum, .. } in &self.entries[..self.len] {
            let places = x.as_chunks::<3>().0.iter();
            for (x, m) in places.zip(momentum.as_chunks::<3>().0) {
                let (arm, m) = (Vector3::from(*x) - about, Vector3::from(*m));
                sums[0] += m;
                sums[1] += arm.cross(&m);
            }
        }
        sums
    }

    /// Adds a multiple of another one.
    pub(crate) fn append(&mut self, other: &Self, factor: f64) {
        for entry in &other.entries[..other.len] {
            let momentum = entry.momentum.iter().map(|m| factor * m);
            self.push(&entry.x, &entry.active, momentum);
        }
    }

    /// Forces of the supports that, with tensions of the rods, balance the momentum of every entry at time
    /// `t`, see [`shares`]: a factorisation for each entry. (One entry, at the end of the step, would leave
    /// up to a thousandth of the forces of a nearly flat sheet: its rods turn in a restoration.)
    pub(crate) fn shares(&self, model: &SheetModel, t: f64) -> Shares {
        let mut sum = Shares::none(model);
        for Entry {
            x,
            active,
            momentum,
        } in &self.entries[..self.len]
        {
            if let Some(own) = shares(model, (t, x), momentum, active) {
                sum.add(&own);
            }
        }
        sum
    }
}
