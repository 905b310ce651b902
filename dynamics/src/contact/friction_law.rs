//! What every law of friction says.

use super::{FrictionError, FrictionLawFault};
use std::fmt::{Debug, Write};

/// A law of friction: the friction force over the normal force, `mu(v)`, at the speed `v >= 0` at which two
/// surfaces slide on each other.
///
/// The force `N mu(v)` acts against the sliding, with the normal force `N`; it depends on no direction.
/// Speeds are in metres per second. A law has
///
/// * `mu(0) = 0` and no jump: what sticks creeps, at the speed at which `mu` balances the pull. A law with
///   friction at rest rises from zero over speeds that count as rest, as [`Coulomb`](super::Coulomb) does;
/// * `mu(v) >= 0`: friction takes energy out;
/// * `mu` as the derivative of its integral, the dissipation potential over the normal force, which the
///   solver minimises.
///
/// `mu` may fall, as Stribeck's curve does. Where its slope is negative, the Hessian has zero in its place,
/// which costs iterations and changes no result. The slope may jump.
///
/// The speed in a step is that of its end by the formula of the method, and the force acts over the step:
/// BDF2 takes smooth laws with second order, implicit Euler with first order.
/// [`check_friction_law`](crate::check_friction_law) compares a law with differences. A step with a law that
/// returns no number or a negative coefficient ends with
/// [`StepError::FrictionLaw`](crate::StepError::FrictionLaw), and so does one for which no end is found where
/// the law is not the derivative of its integral.
///
/// Viscous friction `mu = c v`, of a film of oil or water:
///
/// ```
/// use isosheet_dynamics::check_friction_law;
/// use isosheet_dynamics::contact::{ContactLaws, Friction, FrictionLaw};
///
/// /// With the coefficient in seconds per metre.
/// #[derive(Debug)]
/// struct Viscous(f64);
///
/// impl FrictionLaw for Viscous {
///     fn coefficient(&self, v: f64) -> f64 {
///         self.0 * v
///     }
///
///     fn integral(&self, v: f64) -> f64 {
///         0.5 * self.0 * v * v
///     }
///
///     fn slope(&self, _v: f64) -> f64 {
///         self.0
///     }
/// }
///
/// # fn main() -> Result<(), isosheet_dynamics::contact::FrictionError> {
/// check_friction_law(&Viscous(0.5), &[0.0, 1e-3, 1.0])?;
/// let laws = ContactLaws {
///     bodies: vec![Friction::law(Viscous(0.5))],
///     ..ContactLaws::frictionless(1e-3)
/// };
/// laws.validate()
/// # }
/// ```
pub trait FrictionLaw: Debug + Send + Sync {
    /// `mu(v)`: friction force over normal force at a sliding speed `v >= 0`.
    fn coefficient(&self, v: f64) -> f64;

    /// The integral of `mu` from 0 to `v`, metres per second.
    fn integral(&self, v: f64) -> f64;

    /// `dmu/dv`, seconds per metre, finite; at rest it is not negative.
    fn slope(&self, v: f64) -> f64;

    /// `mu(v) / v`, seconds per metre, and at rest its limit, which is the slope there.
    fn coefficient_over_speed(&self, v: f64) -> f64 {
        match v > 0.0 {
            true => self.coefficient(v) / v,
            false => self.slope(v),
        }
    }
}

/// Compares what a law says at a sliding speed (metres per second) with what every law has there.
///
/// # Errors
/// [`FrictionError::Law`].
pub(crate) fn check_values(law: &dyn FrictionLaw, speed: f64) -> Result<(), FrictionError> {
    let [coefficient, slope] = [law.coefficient(speed), law.slope(speed)];
    let values = [
        ("coefficient", coefficient),
        ("integral", law.integral(speed)),
        ("slope", slope),
        (
            "coefficient over the speed",
            law.coefficient_over_speed(speed),
        ),
    ];
    let fault = match values.into_iter().find(|(_, value)| !value.is_finite()) {
        Some((quantity, value)) => FrictionLawFault::NotFinite { quantity, value },
        None if coefficient < 0.0 => FrictionLawFault::Negative(coefficient),
        None if speed == 0.0 && coefficient != 0.0 => FrictionLawFault::Rest(coefficient),
        None if speed == 0.0 && slope < 0.0 => FrictionLawFault::Falls(slope),
        None => return Ok(()),
    };
    Err(wrong(law, speed, fault))
}

/// The error of a law that has a fault.
pub(crate) fn wrong(law: &dyn FrictionLaw, speed: f64, fault: FrictionLawFault) -> FrictionError {
    FrictionError::Law {
        name: name_of(law),
        speed,
        fault,
    }
}

/// The type of a value, as it begins to name itself.
pub(crate) fn name_of(value: &dyn Debug) -> String {
    /// Takes a word, and then no more.
    struct Word(String);
    impl Write for Word {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            let end = text.find(|c: char| !c.is_alphanumeric() && c != '_');
            self.0.push_str(&text[..end.unwrap_or(text.len())]);
            end.map_or(Ok(()), |_| Err(std::fmt::Error))
        }
    }
    let mut word = Word(String::new());
    // It ends with an error as soon as it has the word.
    let _ = write!(word, "{value:?}");
    word.0
}
