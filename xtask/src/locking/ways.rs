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

/// The damped methods, which hold sheets of rods where they find no step, and the default method with a control
/// that divides such a step and ends the run if no part of it is found either.
pub(super) fn ways() -> Vec<Way> {
    let holding = damped().map(|(name, method)| Way {
        name,
        method,
        control: StepControl::default(),
    });
    let refusing = Way {
        name: "BDF2, refusing",
        method: Method::default(),
        control: refusing(),
    };
    holding.into_iter().chain([refusing]).collect()
}

/// Ends a run where no part of a step is found.
pub(super) fn refusing() -> StepControl {
    StepControl {
        fallback: Fallback::Refuse,
        ..StepControl::default()
    }
}

/// The numbers of the default method, of implicit Euler, and of the default method that ends a run where it
/// finds no step, among [`ways`].
pub(super) const BDF2: usize = 0;
pub(super) const EULER: usize = 1;
pub(super) const REFUSING: usize = 3;

/// The ways of the default method that are tried on a model.
pub(super) fn by_default_method(isometry: Isometry) -> &'static [usize] {
    match isometry {
        Isometry::Rods => &[BDF2, REFUSING],
        // Elastic sheets find every step.
        _ => &[BDF2],
    }
}
