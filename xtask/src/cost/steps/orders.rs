//! What the factorisation of the matrix of a step costs.

use crate::cost::solvers::{Body, Sparse};
use crate::threads;
use anyhow::Result;
use cpu_time::ThreadTime;
use isosheet_coords::linalg::{Fill, Ordering, SparseLlt, elimination_order};
use isosheet_mesh::Sheet;
use rayon::ThreadPool;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Number of times that a duration is measured, the least of which counts.
const REPETITIONS: usize = 5;

/// One elimination order of the matrix of a step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct OrderRow {
    /// Its name in tables.
    pub(super) ordering: String,
    /// Entries of the factor without padding, and operations of a numeric factorisation, see [`Fill`].
    pub(super) entries: f64,
    pub(super) operations: f64,
    /// Entries of the factor as stored, with the zeros that supernodes pad in.
    pub(super) stored: usize,
    /// CPU seconds to find the order, for the symbolic analysis, for a numeric factorisation and for a solve.
    pub(super) order: f64,
    pub(super) symbolic: f64,
    pub(super) numeric: f64,
    pub(super) solve: f64,
    /// Wall seconds for a numeric factorisation on two threads, and whether it gives the same bits.
    pub(super) two_threads: f64,
    pub(super) same_bits: bool,
}

/// Measures an elimination order on the matrix `M + r G^T G` of the whole sheet.
pub(super) fn order(sheet: &Sheet, ordering: Ordering) -> Result<OrderRow> {
    let Sparse {
        pattern, values, ..
    } = Body::new(String::new(), sheet.clone())?.primal();
    let clock = ThreadTime::now();
    let order = elimination_order(&pattern, 3, ordering);
    let found = clock.elapsed().as_secs_f64();
    let fill = Fill::new(&pattern, 3, &order);
    let clock = ThreadTime::now();
    let mut llt = SparseLlt::with_ordering(pattern, &order)?;
    let symbolic = clock.elapsed().as_secs_f64();
    llt.values_mut().copy_from_slice(&values);
    let [numeric, _] = fastest(&threads::pool(1)?, &mut llt)?;
    let factor = llt.factor().to_vec();
    let [_, two_threads] = fastest(&threads::pool(2)?, &mut llt)?;
    let mut pairs = llt.factor().iter().zip(&factor);
    let same_bits = pairs.all(|(a, b)| a.to_bits() == b.to_bits());
    let (mut rhs, mut solve) = (vec![1.0; llt.order()], f64::INFINITY);
    for _ in 0..REPETITIONS {
        rhs.fill(1.0);
        let clock = ThreadTime::now();
        llt.solve(&mut rhs);
        solve = solve.min(clock.elapsed().as_secs_f64());
    }
    let name = match ordering {
        Ordering::MinimumDegree => "minimum_degree",
        Ordering::NestedDissection => "nested_dissection",
        Ordering::Best => "best",
    };
    Ok(OrderRow {
        ordering: name.to_owned(),
        entries: fill.entries,
        operations: fill.operations,
        stored: llt.factor_len(),
        order: found,
        symbolic,
        numeric,
        solve,
        two_threads,
        same_bits,
    })
}

/// CPU seconds of the calling thread, and wall seconds, for a numeric factorisation on the threads of a pool.
fn fastest(pool: &ThreadPool, llt: &mut SparseLlt) -> Result<[f64; 2]> {
    let mut best = [f64::INFINITY; 2];
    for _ in 0..REPETITIONS {
        let spent = pool.install(|| {
            let (cpu, wall) = (ThreadTime::now(), Instant::now());
            llt.factorize()?;
            anyhow::Ok([cpu.elapsed(), wall.elapsed()])
        })?;
        best = [0, 1].map(|k| best[k].min(spent[k].as_secs_f64()));
    }
    Ok(best)
}

/// Seconds for one numeric factorisation of `M + r G^T G` of the whole sheet, by the better of the orders.
pub(in crate::cost) fn factorisation_time(sheet: &Sheet) -> Result<f64> {
    let degree = order(sheet, Ordering::MinimumDegree)?;
    let dissection = order(sheet, Ordering::NestedDissection)?;
    Ok(degree.numeric.min(dissection.numeric))
}

impl OrderRow {
    /// Bytes of the factor.
    pub(super) fn bytes(&self) -> f64 {
        8.0 * self.stored as f64
    }
}
