//! Methods, and what they do where they find no step.

use isosheet_dynamics::{Fallback, Method, StepControl};

/// A method, and what it does where it finds no step.
pub(super) struct Way {
    pub(super) name: &'static str,
    pub(super) method: Method,
    pub(super) control: StepControl,
}

impl Way {
    /// A method that ends the run where it finds no step.
    pub(super) fn ending((name, method): (&'static str, Method)) -> Self {
        let control = StepControl::default();
        Self {
            name,
            method,
            control,
        }
    }

    /// The default method, which divides no step, and ends the step without a minimum where it finds none.
    pub(super) fn holding() -> Self {
        let control = StepControl {
            min_fraction: 1.0,
            fallback: Fallback::Hold,
            ..StepControl::default()
        };
        Self {
            name: "BDF2, holding",
            method: Method::default(),
            control,
        }
    }
}
