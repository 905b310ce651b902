//! Updates of the fronts above all subtrees, on the threads of rayon's current pool.

use crate::dense::{self, TOGETHER};
use crate::parallel::{Work, both};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Nanoseconds for a multiplication, estimated: it decides what is shared among threads, and no result.
const MULTIPLICATION_TIME: f64 = 0.1;

/// Columns of an update.
struct Columns<'a> {
    panel: &'a [f64],
    height: usize,
    /// From the first of the columns on.
    out: &'a mut [f64],
    size: usize,
    columns: Range<usize>,
}

/// Sets an update, see [`dense::square`], to the same bits for any number of threads.
pub(super) fn square((panel, height): (&[f64], usize), (out, size): (&mut [f64], usize)) {
    let all = Columns {
        panel,
        height,
        out,
        size,
        columns: 0..size,
    };
    all.share(rayon::current_num_threads());
}

impl Columns<'_> {
    /// Sets them in as many pieces as there are threads.
    fn share(self, threads: usize) {
        let Range { start, end } = self.columns;
        let (first, last) = ((self.size - start) as f64, (self.size - end) as f64);
        let work = Work {
            count: (self.panel.len() / self.height) * (end - start),
            each: MULTIPLICATION_TIME * 0.5 * (first + last),
        };
        if threads < 2 || !work.is_shared() {
            return Arch::new().dispatch(self);
        }
        // Both triangles below have the same area.
        let height = (0.5 * (first * first + last * last)).sqrt();
        let middle = (self.size - height as usize).next_multiple_of(TOGETHER);
        let middle = middle.clamp(start, end);
        let (left, right) = self.out.split_at_mut((middle - start) * self.size);
        let left = Columns {
            out: left,
            columns: start..middle,
            ..self
        };
        let right = Columns {
            out: right,
            columns: middle..end,
            ..self
        };
        both(
            || left.share(threads / 2),
            || right.share(threads.div_ceil(2)),
        );
    }
}

impl WithSimd for Columns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            panel,
            height,
            out,
            size,
            columns,
        } = self;
        dense::square(simd, (panel, height), (out, size), columns);
    }
}
