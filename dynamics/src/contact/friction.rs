//! Which law of friction acts between two.

use super::{Coefficients, Coulomb, FrictionError, FrictionLaw, check_values};
use std::sync::Arc;

/// Friction between two that may touch.
#[derive(Debug, Clone)]
pub enum Friction {
    /// Coulomb's law with these coefficients, smoothed below the
    /// [speed that counts as rest](super::ContactLaws::rest_speed).
    Coulomb(Coefficients),
    /// Another law.
    Law(Arc<dyn FrictionLaw>),
}

impl Friction {
    /// No friction, and no cost of it.
    pub const NONE: Self = Self::Coulomb(Coefficients::FRICTIONLESS);

    /// By another law than Coulomb's.
    pub fn law(law: impl FrictionLaw + 'static) -> Self {
        Self::Law(Arc::new(law))
    }

    /// # Errors
    /// [`FrictionError`] unless coefficients are `0 <= sliding <= rest`, and another law is zero at rest with
    /// a finite slope.
    pub fn validate(&self) -> Result<(), FrictionError> {
        match self {
            Self::Coulomb(coefficients) => coefficients.validate(),
            Self::Law(law) => check_values(law.as_ref(), 0.0),
        }
    }

    /// Whether there is no friction.
    pub(crate) fn is_none(&self) -> bool {
        matches!(self, Self::Coulomb(coefficients) if coefficients.is_frictionless())
    }
}

impl From<Coefficients> for Friction {
    fn from(coefficients: Coefficients) -> Self {
        Self::Coulomb(coefficients)
    }
}

/// Laws are equal to themselves alone.
impl PartialEq for Friction {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Coulomb(a), Self::Coulomb(b)) => a == b,
            (Self::Law(a), Self::Law(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// Coulomb's law of a step of `h` seconds, with speeds in metres a step; none in a step without duration.
pub(super) fn coulomb(coefficients: Coefficients, rest_speed: f64, h: f64) -> Option<Coulomb> {
    if coefficients.is_frictionless() {
        return None;
    }
    Coulomb::new(coefficients.rest, coefficients.sliding, rest_speed * h).ok()
}
