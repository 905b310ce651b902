//! Methods, and what they do where they find no step.

use super::isometry::Isometry;
use crate::methods::damped;
use isosheet_dynamics::{Method, StepControl};

/// A method, and what it does where it finds no step.
pub(super) struct Way {
    pub(super) name: &'static str,
    pub(super) method: Method,
    pub(super) control: StepControl,
}

/// The damped methods, which divide a step that they do not find, and the default method, which does not and ends
/// it without a minimum at once.
pub(super) fn ways() -> Vec<Way> {
    let dividing = damped().map(|(name, method)| Way {
        name,
        method,
        control: StepControl::default(),
    });
    let undivided = Way {
        name: "BDF2, undivided",
        method: Method::default(),
        control: StepControl {
            hold_fraction: 1.0,
            ..StepControl::default()
        },
    };
    dividing.into_iter().chain([undivided]).collect()
}

/// The numbers of the default method, of implicit Euler, and of the default method that divides no step, among
/// [`ways`].
pub(super) const BDF2: usize = 0;
pub(super) const EULER: usize = 1;
pub(super) const UNDIVIDED: usize = 3;

/// The ways of the default method that are tried on a model.
pub(super) fn by_default_method(isometry: Isometry) -> &'static [usize] {
    match isometry {
        Isometry::Rods => &[BDF2, UNDIVIDED],
        // Elastic sheets find every step.
        _ => &[BDF2],
    }
}
