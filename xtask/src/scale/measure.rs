//! What is measured at one mesh size.

use crate::interrupt;
use crate::speed_vs_error::{bumped, corner};
use anyhow::{Context, Result};
use isosheet_coords::linalg::{Fill, Ordering, Pattern, SparseLlt, elimination_order};
use isosheet_dynamics::{History, Method, SheetModel, Simulation, State, StepReport};
use isosheet_mesh::{MassKind, Sheet};
use std::num::NonZeroUsize;
use std::time::Instant;

/// Length of a step, seconds. The finer the mesh, the sooner a sheet that starts all but flat comes to states
/// that its length equations barely determine, where a step takes hundreds of factorisations: with 66 049
/// vertices after 3 ms, with 4225 after 15 ms. Steps this short stay before them at every size, so that what
/// is measured is the price of the size.
pub(crate) const STEP: f64 = 2.5e-4;

/// Stiffness of the rods relative to the masses in the matrices that the orders are compared on.
const STIFFNESS: f64 = 1e4;

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

/// A few steps of the hanging sheet at one mesh size.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) level: u32,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    /// Seconds to set the simulation up.
    pub(crate) setup: f64,
    pub(crate) steps: usize,
    /// Wall seconds per step.
    pub(crate) per_step: f64,
    pub(crate) iterations: f64,
    pub(crate) factorisations: f64,
    /// Largest relative edge length error.
    pub(crate) strain: f64,
    /// Energy gained or lost against the potential energy released.
    pub(crate) balance: f64,
    /// Most memory the process has used so far, bytes, where the system tells.
    pub(crate) peak: Option<f64>,
    /// Minimum degree and nested dissection.
    pub(crate) orders: [OrderRow; 2],
}

impl Row {
    /// Parts of a step's time, seconds: factorisations and solves, their numbers times what one of each takes
    /// alone.
    pub(super) fn linear(&self) -> [f64; 2] {
        let best = self.best();
        let solves = self.iterations.max(self.factorisations);
        [self.factorisations * best.numeric, solves * best.solve]
    }

    /// The order that a simulation uses: the one with fewer operations.
    pub(crate) fn best(&self) -> &OrderRow {
        let [a, b] = &self.orders;
        if b.fill.operations < a.fill.operations {
            b
        } else {
            a
        }
    }
}

/// Height of the bump of the hanging sheet, metres: all but flat.
const BUMP: f64 = 1e-3;

/// Measures one level: orders of elimination, and `steps` steps of the hanging sheet after a first one that
/// is not timed.
pub(crate) fn measure(level: u32, steps: usize) -> Result<Row> {
    let sheet = bumped(level, BUMP)?;
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?
        .with_gravity()
        .with_pins(&[corner(level)])?;
    let start = sheet.positions().to_vec();
    let before = model.potential_energy(0.0, &start);
    let clock = Instant::now();
    let mut run = Simulation::new(model, State::at_rest(start), Method::default())?;
    let setup = clock.elapsed().as_secs_f64();
    let context = |k| format!("step {k} of the sheet of level {level}");
    run.step(STEP).with_context(|| context(0))?;
    let clock = Instant::now();
    let mut history = History::default();
    let end = run.run(
        steps as f64 * STEP,
        STEP,
        &mut [&mut history, &mut interrupt::observe],
    );
    let per_step = clock.elapsed().as_secs_f64() / steps as f64;
    interrupt::check()?;
    let reports = history.reports();
    end.with_context(|| context(reports.len() + 1))?;
    let mean = |count: fn(&StepReport) -> usize| {
        reports.iter().map(count).sum::<usize>() as f64 / steps as f64
    };
    let released = before - run.model().potential_energy(0.0, &run.state().x);
    let peak = peak_memory();
    drop(run);
    Ok(Row {
        level,
        vertices: sheet.topology().vertex_count(),
        faces: sheet.topology().face_count(),
        setup,
        steps,
        per_step,
        iterations: mean(|r| r.iterations),
        factorisations: mean(|r| r.factorisations),
        strain: reports.iter().map(|r| r.strain).fold(0.0, f64::max),
        balance: reports.last().map_or(0.0, |r| r.energy_drift) / released,
        peak,
        orders: [
            order(&sheet, Ordering::MinimumDegree)?,
            order(&sheet, Ordering::NestedDissection)?,
        ],
    })
}

/// Measures an elimination order on the matrix `M + r G^T G` of the whole sheet.
fn order(sheet: &Sheet, ordering: Ordering) -> Result<OrderRow> {
    let (pattern, values) = stiff_sheet(sheet)?;
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

/// Pattern and values of `M + r G^T G`, lower triangle.
fn stiff_sheet(sheet: &Sheet) -> Result<(Pattern, Vec<f64>)> {
    let model = SheetModel::new(sheet, 0.1, MassKind::Lumped)?;
    let x = sheet.positions();
    let (mut entries, mut terms) = (Vec::new(), Vec::new());
    for (v, m) in model.mass().vertex.iter().enumerate() {
        for r in 0..3 {
            for c in 0..=r {
                entries.push((3 * v as u32 + r, 3 * v as u32 + c));
                terms.push(if r == c { *m } else { 0.0 });
            }
        }
    }
    for (&[a, b], l) in model.rods().edges().iter().zip(model.rods().lengths()) {
        let mass = &model.mass().vertex;
        let stiffness = STIFFNESS / ((1.0 / mass[a] + 1.0 / mass[b]) * l * l);
        let d: [f64; 3] = std::array::from_fn(|k| x[3 * a + k] - x[3 * b + k]);
        for (i, j, sign) in [(a, a, 1.0), (b, b, 1.0), (a.max(b), a.min(b), -1.0)] {
            for r in 0..3 {
                for c in 0..(if i == j { r + 1 } else { 3 }) {
                    entries.push(((3 * i + r) as u32, (3 * j + c) as u32));
                    terms.push(sign * stiffness * d[r] * d[c]);
                }
            }
        }
    }
    let n = x.len();
    let (pattern, slots) = Pattern::from_entries(n, n, &entries);
    let mut values = vec![0.0; pattern.len()];
    for (slot, term) in slots.iter().zip(terms) {
        values[*slot as usize] += term;
    }
    Ok((pattern, values))
}

/// Most resident memory of this process so far, bytes; `None` where the system does not tell.
pub(super) fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024.0 * kibibytes)
}

/// Exponent `p` of the least-squares fit `y ~ x^p`; `None` from fewer than two sizes.
pub(crate) fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k].ln()).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let (mut above, mut below) = (0.0, 0.0);
    for p in points {
        above += (p[0].ln() - x) * (p[1].ln() - y);
        below += (p[0].ln() - x).powi(2);
    }
    (below > 0.0).then(|| above / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_of_powers() {
        let points: Vec<[f64; 2]> = [1.0, 3.0, 10.0, 40.0]
            .map(|x: f64| [x, 7.0 * x.powf(1.5)])
            .to_vec();
        assert!((exponent(&points).expect("four sizes") - 1.5).abs() < 1e-12);
        assert_eq!(exponent(&points[..1]), None);
    }

    #[test]
    fn a_small_sheet_is_measured() {
        let row = measure(1, 3).expect("a small sheet moves");
        assert_eq!((row.vertices, row.faces, row.steps), (25, 32, 3));
        assert!(row.strain < 1e-12 && row.factorisations >= 1.0 && row.per_step > 0.0);
        for o in &row.orders {
            assert!(o.stored as f64 >= o.fill.entries && o.fill.entries >= 75.0);
        }
    }
}
