//! What the factorisation of the matrix of a step costs.

use super::matrices::{Body, Sparse};
use anyhow::Result;
use isosheet_coords::linalg::{Fill, Ordering, SparseLlt, elimination_order};
use isosheet_mesh::Sheet;
use std::num::NonZeroUsize;
use std::time::Instant;

const TWO: NonZeroUsize = NonZeroUsize::new(2).expect("two");

/// One elimination order of the matrix of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrderRow {
    pub(crate) ordering: Ordering,
    pub(crate) fill: Fill,
    /// Entries of the factor as stored, with the zeros that supernodes pad in.
    pub(crate) stored: usize,
    /// Seconds to find the order, for the symbolic analysis, for a numeric factorisation and for a solve.
    pub(crate) order: f64,
    pub(crate) symbolic: f64,
    pub(crate) numeric: f64,
    pub(crate) solve: f64,
    /// Seconds for a numeric factorisation on two threads, and whether it gives the same bits.
    pub(crate) two_threads: f64,
    pub(crate) same_bits: bool,
}

/// Measures an elimination order on the matrix `M + r G^T G` of the whole sheet.
pub(crate) fn order(sheet: &Sheet, ordering: Ordering) -> Result<OrderRow> {
    let Sparse {
        pattern, values, ..
    } = Body::new(String::new(), sheet.clone())?.primal();
    let clock = Instant::now();
    let order = elimination_order(&pattern, 3, ordering);
    let found = clock.elapsed().as_secs_f64();
    let fill = Fill::new(&pattern, 3, &order);
    let clock = Instant::now();
    let mut llt = SparseLlt::with_ordering(pattern, Some(&order))?;
    let symbolic = clock.elapsed().as_secs_f64();
    llt.values_mut().copy_from_slice(&values);
    let mut rhs = vec![1.0; llt.order()];
    let (mut numeric, mut solve) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..3 {
        let clock = Instant::now();
        llt.factorize()?;
        numeric = numeric.min(clock.elapsed().as_secs_f64());
        rhs.fill(1.0);
        let clock = Instant::now();
        llt.solve(&mut rhs);
        solve = solve.min(clock.elapsed().as_secs_f64());
    }
    let one = llt.factor().to_vec();
    let (mut two_threads, mut same_bits) = (f64::INFINITY, true);
    for _ in 0..3 {
        let clock = Instant::now();
        llt.factorize_on(TWO)?;
        two_threads = two_threads.min(clock.elapsed().as_secs_f64());
        let mut pairs = llt.factor().iter().zip(&one);
        same_bits &= pairs.all(|(a, b)| a.to_bits() == b.to_bits());
    }
    Ok(OrderRow {
        ordering,
        fill,
        stored: llt.factor_len(),
        order: found,
        symbolic,
        numeric,
        solve,
        two_threads,
        same_bits,
    })
}

/// Seconds for one numeric factorisation of `M + r G^T G` of the whole sheet, by the better of the orders.
pub(crate) fn factorisation_time(sheet: &Sheet) -> Result<f64> {
    let degree = order(sheet, Ordering::MinimumDegree)?;
    let dissection = order(sheet, Ordering::NestedDissection)?;
    Ok(degree.numeric.min(dissection.numeric))
}
