//! Laws of friction against differences.

use super::derivatives::error_at;
use super::potentials::WRONG;
use crate::contact::{FrictionError, FrictionLaw, FrictionLawFault, check_values, wrong};

/// Checks a law of friction at sliding speeds of at least 0, metres per second: that it returns numbers, that
/// its coefficient is not negative and zero at rest, and that coefficient and slope are the derivatives of
/// integral and coefficient, by central differences. Speeds at which the slope jumps are none to check.
///
/// ```
/// use isosheet_dynamics::check_friction_law;
/// use isosheet_dynamics::contact::{Coulomb, FrictionError};
///
/// # fn main() -> Result<(), FrictionError> {
/// check_friction_law(&Coulomb::new(0.5, 0.3, 1e-3)?, &[0.0, 5e-4, 2e-3, 0.1])
/// # }
/// ```
///
/// # Errors
/// [`FrictionError::Law`] with the first fault.
pub fn check_friction_law(law: &dyn FrictionLaw, speeds: &[f64]) -> Result<(), FrictionError> {
    for &speed in speeds {
        check_at(law, speed)?;
        if speed > 0.0 {
            let part = error_at(speed, |v| law.coefficient(v), law.slope(speed));
            refuse(part, || wrong(law, speed, FrictionLawFault::Slope(part)))?;
        }
    }
    Ok(())
}

/// Checks what a step cannot do without: all but the slope, which changes iterations and no result.
pub(crate) fn check_at(law: &dyn FrictionLaw, speed: f64) -> Result<(), FrictionError> {
    check_values(law, 0.0)?;
    check_values(law, speed)?;
    if speed == 0.0 {
        return Ok(());
    }
    let part = error_at(speed, |v| law.integral(v), law.coefficient(speed));
    refuse(part, || wrong(law, speed, FrictionLawFault::Integral(part)))
}

fn refuse(part: f64, error: impl FnOnce() -> FrictionError) -> Result<(), FrictionError> {
    match part > WRONG {
        true => Err(error()),
        false => Ok(()),
    }
}
