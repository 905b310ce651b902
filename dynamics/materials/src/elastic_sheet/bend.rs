//! How the elasticity of a face sees its bend.

use nalgebra::Vector3;

/// Numbers that are remembered of the bend of a face.
pub(super) const NUMBERS: usize = 6;

/// The bend of a face as its elasticity sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bend {
    /// The length errors of its edges as chords of their arcs, m2.
    pub(super) chords: Vector3<f64>,
    /// The square of its bend, `(kappa h)^2`.
    pub(super) own: f64,
    /// The squared bend that its slack is for: that of the face around that bends most, or what is left of
    /// it.
    pub(super) squared: f64,
    /// Energy that slack has let go as it grew, and has not taken up again, joules.
    pub(super) credit: f64,
}

impl Bend {
    pub(super) const FLAT: Self = Self {
        chords: Vector3::new(0.0, 0.0, 0.0),
        own: 0.0,
        squared: 0.0,
        credit: 0.0,
    };

    /// Of the numbers that are remembered.
    pub(super) fn remembered(&[a, b, c, own, squared, credit]: &[f64; NUMBERS]) -> Self {
        Self {
            chords: Vector3::new(a, b, c),
            own,
            squared,
            credit,
        }
    }

    /// As it is remembered.
    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        let [a, b, c] = self.chords.into();
        [a, b, c, self.own, self.squared, self.credit]
    }
}
