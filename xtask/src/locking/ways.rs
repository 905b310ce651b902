//! Methods by which models are tried.

use isosheet_dynamics::Method;
use isosheet_tests::damped;

/// A method with its name.
pub(super) struct Way {
    pub(super) name: &'static str,
    pub(super) method: Method,
}

/// The damped methods.
pub(super) fn ways() -> Vec<Way> {
    let named = damped().map(|(name, method)| Way { name, method });
    named.into()
}

/// The numbers of the default method and of implicit Euler among [`ways`].
pub(super) const BDF2: usize = 0;
pub(super) const EULER: usize = 1;
