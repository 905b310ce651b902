//! A limit of wall time that holds within a step as well.

use crate::interrupt;
use isosheet_dynamics::{Potential, PotentialShape};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

/// Why a piece of work was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GivenUp {
    /// The time was over.
    TimeOver,
    /// Ctrl-C was pressed.
    Interrupted,
}

/// A potential without energy that looks at the clock whenever the energy or its gradient is evaluated.
///
/// A single step of a sheet that locks can take minutes, and there is no way to ask the solver to stop
/// meanwhile. When the time is over the potential unwinds the stack up to [`unless_given_up`], which calls no
/// panic handler and prints nothing. The simulation must not be moved any further after that; its state is
/// that of the last accepted sub-step.
#[derive(Debug)]
pub(super) struct Guard {
    end: Instant,
}

impl Guard {
    /// The limit begins now.
    pub(super) fn new(patience: Duration) -> Self {
        Self {
            end: Instant::now() + patience,
        }
    }

    fn check(&self) {
        if interrupt::requested() {
            resume_unwind(Box::new(GivenUp::Interrupted));
        }
        if Instant::now() > self.end {
            resume_unwind(Box::new(GivenUp::TimeOver));
        }
    }
}

impl Potential for Guard {
    fn energy(&self, _t: f64, _x: &[f64]) -> f64 {
        self.check();
        0.0
    }

    fn add_gradient(&self, _t: f64, _x: &[f64], _gradient: &mut [f64]) {
        self.check();
    }

    fn shape(&self) -> PotentialShape {
        PotentialShape::Linear
    }
}

/// The result of work under a [`Guard`], or why the guard ended it. Panics of other origin go on.
pub(super) fn unless_given_up<T>(work: impl FnOnce() -> T) -> Result<T, GivenUp> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload: Box<dyn Any + Send>| {
        match payload.downcast::<GivenUp>() {
            Ok(reason) => *reason,
            Err(other) => resume_unwind(other),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guard_ends_work_only_when_its_time_is_over() {
        let patient = Guard::new(Duration::from_secs(3600));
        assert_eq!(unless_given_up(|| patient.energy(0.0, &[])), Ok(0.0));
        let over = Guard::new(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(2));
        let energy = unless_given_up(|| over.energy(0.0, &[]));
        assert_eq!(energy, Err(GivenUp::TimeOver));
        let gradient = unless_given_up(|| over.add_gradient(0.0, &[], &mut []));
        assert_eq!(gradient, Err(GivenUp::TimeOver));
    }

    #[test]
    #[should_panic(expected = "another reason")]
    fn other_panics_go_on() {
        let _ = unless_given_up(|| panic!("another reason"));
    }
}
