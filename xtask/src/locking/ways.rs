//! Methods, and what they do where they find no step.

use super::isometry::Isometry;
use crate::methods::damped;
use isosheet_dynamics::{Fallback, Method, StepControl};

/// A method, and what it does where it finds no step.
pub(super) struct Way {
    pub(super) name: &'static str,
    pub(super) method: Method,
    pub(super) control: StepControl,
}

/// The damped methods, which end a run where they find no step, and the default method, which divides no
/// step and ends it there without a minimum.
pub(super) fn ways() -> Vec<Way> {
    let ending = damped().map(|(name, method)| Way {
        name,
        method,
        control: StepControl::default(),
    });
    let holding = Way {
        name: "BDF2, holding",
        method: Method::default(),
        control: StepControl {
            fallback: Fallback::Hold,
            ..StepControl::default()
        },
    };
    ending.into_iter().chain([holding]).collect()
}

/// The numbers of the default method, of implicit Euler, and of the default method that holds sheets, among
/// [`ways`].
pub(super) const BDF2: usize = 0;
pub(super) const EULER: usize = 1;
pub(super) const HOLDING: usize = 3;

/// The ways of the default method that are tried on a model.
pub(super) fn by_default_method(isometry: Isometry) -> &'static [usize] {
    match isometry {
        Isometry::Rods => &[BDF2, HOLDING],
        // Elastic sheets find every step.
        _ => &[BDF2],
    }
}
