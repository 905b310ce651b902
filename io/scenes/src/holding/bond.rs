//! What the pairs of a seam carry.

use isosheet_dynamics::{Attachment, Glue};

/// The pairs of a seam that hold, with their numbers in the seam.
#[derive(Clone, Debug)]
pub(crate) struct Bond {
    numbers: Vec<usize>,
    of: Bonded,
}

#[derive(Clone, Debug)]
enum Bonded {
    Sheets(Glue),
    Body(Attachment),
}

impl Bond {
    /// Of two sides of sheets.
    pub(crate) fn of_sheets(numbers: Vec<usize>, glue: Glue) -> Self {
        let of = Bonded::Sheets(glue);
        Self { numbers, of }
    }

    /// Of a sheet and a body.
    pub(crate) fn of_body(numbers: Vec<usize>, attachment: Attachment) -> Self {
        let of = Bonded::Body(attachment);
        Self { numbers, of }
    }

    /// Whether a pair holds.
    pub(crate) fn holds(&self) -> bool {
        !self.numbers.is_empty()
    }

    /// The force (newtons) that each pair carries at time `t` (seconds) and positions `x` (`3V`, metres), by
    /// its number.
    pub(crate) fn forces(&self, t: f64, x: &[f64]) -> Vec<(usize, f64)> {
        let forces = match &self.of {
            Bonded::Sheets(glue) => glue.pair_forces(t, x),
            Bonded::Body(attachment) => attachment.pair_forces(x),
        };
        self.numbers.iter().copied().zip(forces).collect()
    }
}
