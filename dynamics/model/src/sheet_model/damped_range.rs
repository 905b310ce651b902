//! What is damped.

use std::ops::Range;

/// The velocity damping of the vertices of a range.
#[derive(Debug, Clone)]
pub(super) struct Damping {
    pub(super) vertices: Range<usize>,
    /// 1/s.
    pub(super) rate: f64,
}
