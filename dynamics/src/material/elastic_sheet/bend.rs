//! How the elasticity of a face sees its bend.

use nalgebra::Vector3;

/// Numbers that are remembered of the bend of a face.
pub(super) const NUMBERS: usize = 4;

/// The bend of a face as its elasticity sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bend {
    /// The length errors of its edges as chords of their arcs, m2.
    pub(super) chords: Vector3<f64>,
    /// The square of the largest bend of a face around, `(kappa h)^2`.
    pub(super) squared: f64,
}

impl Bend {
    pub(super) const FLAT: Self = Self {
        chords: Vector3::new(0.0, 0.0, 0.0),
        squared: 0.0,
    };

    /// Of the numbers that are remembered.
    pub(super) fn remembered(&[a, b, c, squared]: &[f64; NUMBERS]) -> Self {
        Self {
            chords: Vector3::new(a, b, c),
            squared,
        }
    }

    /// As it is remembered.
    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        let [a, b, c] = self.chords.into();
        [a, b, c, self.squared]
    }
}
