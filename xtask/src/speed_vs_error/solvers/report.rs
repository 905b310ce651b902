//! What the rows of the solver study say: tables, plot, words.

use super::row::{CHOLESKY, CRAMER, LDLT, MINORS, SCHUR, SOLVERS, SPARSE_LU, SolverRow};
use crate::draw::{Axis, Chart, Charts, Colour, Legend, Line, Marker, Series, palette};
use crate::report::{Table, exponent, short};

/// All rows, solver by solver.
pub(crate) fn table(rows: &[SolverRow]) -> Table {
    let of = |solver: &'static str| rows.iter().filter(move |r| r.solver == solver);
    Table::of(
        "Linear solvers by size",
        SOLVERS.into_iter().flat_map(of),
        &[
            ("solver", &|r| r.solver.as_str().into()),
            ("mesh", &|r| r.mesh.as_str().into()),
            ("degrees_of_freedom", &|r| r.n.into()),
            ("order", &|r| r.order.into()),
            ("form_s", &|r| r.form.into()),
            ("first_s", &|r| r.first.into()),
            ("again_s", &|r| r.again.into()),
            ("solve_s", &|r| r.solve.into()),
            ("backward_error", &|r| r.backward.into()),
            ("velocity_error", &|r| r.velocity.into()),
            ("two_cores", &|r| r.two.into()),
            ("failure", &|r| r.failure.clone().into()),
        ],
    )
}

/// Measurements that an exponent rests on: the largest sizes.
const FITTED: usize = 3;

/// Exponent of the time of a factorisation over n at the largest sizes.
fn growth(rows: &[SolverRow], solver: &str) -> Option<(f64, [usize; 2])> {
    let points: Vec<(usize, f64)> = of(rows, solver).map(|r| (r.n, r.again)).collect();
    let last = &points[points.len().saturating_sub(FITTED)..];
    let e = exponent(
        &last
            .iter()
            .map(|(n, t)| [*n as f64, *t])
            .collect::<Vec<_>>(),
    )?;
    (last.len() == FITTED).then(|| (e, [last[0].0, last[FITTED - 1].0]))
}

fn of<'a>(rows: &'a [SolverRow], solver: &'a str) -> impl Iterator<Item = &'a SolverRow> {
    rows.iter()
        .filter(move |r| r.solver == solver && r.failure.is_none())
}

/// The n from which on the second solver takes less time than the first, by interpolation of logarithms.
fn crossing(rows: &[SolverRow], first: &str, second: &str) -> Option<f64> {
    let pairs: Vec<(f64, f64)> = of(rows, first)
        .filter_map(|a| {
            let b = of(rows, second).find(|b| b.n == a.n)?;
            Some((a.n as f64, (b.step() / a.step()).ln()))
        })
        .collect();
    let k = pairs.iter().rposition(|(_, r)| *r > 0.0)?;
    let ((n0, r0), (n1, r1)) = (pairs[k], *pairs.get(k + 1)?);
    Some((n0.ln() + (n1 / n0).ln() * r0 / (r0 - r1)).exp())
}

/// What the rows say.
pub(crate) fn conclusions(rows: &[SolverRow]) -> Vec<String> {
    let mut all = Vec::new();
    let growths: Vec<String> = SOLVERS
        .iter()
        .filter_map(|s| growth(rows, s).map(|(e, [a, b])| format!("{s} n^{e:.1} (n = {a} to {b})")))
        .collect();
    all.push(format!(
        "Time of a factorisation at the largest sizes: {}. The order of the sparse matrices grows as n^2.",
        growths.join("; ")
    ));
    all.push(format!(
        "Fastest at forming, factorising and solving once: {}.",
        fastest(rows).join("; ")
    ));
    let crossings = crossings(rows);
    if !crossings.is_empty() {
        all.push(format!("Cross-over points: {}.", crossings.join("; ")));
    }
    let of_sparse = |words: &dyn Fn(&SolverRow) -> Option<String>| {
        let last = |s: &&str| Some(format!("{s} {}", words(of(rows, s).last()?)?));
        let all = SOLVERS[4..].iter().filter_map(last);
        all.collect::<Vec<_>>().join("; ")
    };
    all.push(format!(
        "A first factorisation, analysis included, takes so many times a later one, at the largest size of each: {}.",
        of_sparse(&|last| Some(short(last.first / last.again)))
    ));
    all.push(format!(
        "Largest backward error / error of the velocities: {}.",
        worst_errors(rows).join("; ")
    ));
    all.push(format!(
        "Two cores with one factorisation each do so many times the work of one, at the largest size of each: {}. That means \
         something only on a machine with two idle cores. Within one factorisation one core is used.",
        of_sparse(&|last| Some(format!("{:.1}", last.two?)))
    ));
    let failed = |r: &SolverRow| {
        let why = r.failure.as_ref()?;
        Some(format!("{} on {}: {why}", r.solver, r.mesh))
    };
    let failed: Vec<String> = rows.iter().filter_map(failed).collect();
    if !failed.is_empty() {
        all.push(format!("Failed: {}.", failed.join("; ")));
    }
    all
}

/// Which solver is the fastest at which sizes.
fn fastest(rows: &[SolverRow]) -> Vec<String> {
    let mut sizes: Vec<usize> = rows.iter().map(|r| r.n).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let mut winners: Vec<(String, [usize; 2])> = Vec::new();
    for n in sizes {
        let best = rows
            .iter()
            .filter(|r| r.n == n && r.failure.is_none())
            .min_by(|a, b| a.step().total_cmp(&b.step()));
        if let Some(best) = best {
            match winners.last_mut() {
                Some((name, range)) if *name == best.solver => range[1] = n,
                _ => winners.push((best.solver.clone(), [n, n])),
            }
        }
    }
    winners
        .iter()
        .map(|(s, [a, b])| {
            if a == b {
                format!("{s} at n = {a}")
            } else {
                format!("{s} from n = {a} to {b}")
            }
        })
        .collect()
}

/// The sizes from which on one solver passes another.
fn crossings(rows: &[SolverRow]) -> Vec<String> {
    [
        (MINORS, CHOLESKY),
        (CRAMER, CHOLESKY),
        (CHOLESKY, SPARSE_LU),
        (CHOLESKY, LDLT),
        (CHOLESKY, SCHUR),
        (SPARSE_LU, LDLT),
        (LDLT, SCHUR),
    ]
    .into_iter()
    .filter_map(|(a, b)| {
        let n = crossing(rows, a, b)?;
        Some(format!("{b} passes {a} at n = {n:.0}"))
    })
    .collect()
}

/// The largest errors of each solver.
fn worst_errors(rows: &[SolverRow]) -> Vec<String> {
    SOLVERS
        .iter()
        .filter_map(|s| {
            let of = |f: fn(&SolverRow) -> Option<f64>| of(rows, s).filter_map(f).reduce(f64::max);
            let velocity = of(|r| r.velocity).map_or("–".into(), |v| format!("{v:.0e}"));
            Some(format!("{s} {:.0e} / {velocity}", of(|r| r.backward)?))
        })
        .collect()
}

/// Time of a step's solve and backward error against n.
pub(crate) fn plot(rows: &[SolverRow]) -> Charts {
    let looks: [(Colour, Marker, Line); 8] = [
        (palette::BLACK, Marker::Square, Line::Dashed),
        (palette::GREY, Marker::Square, Line::Dashed),
        (palette::GREY, Marker::Disc, Line::Dashed),
        (palette::BLACK, Marker::Disc, Line::Dashed),
        (palette::VERMILION, Marker::Diamond, Line::Solid),
        (palette::ORANGE, Marker::Triangle, Line::Solid),
        (palette::BLUE, Marker::Disc, Line::Solid),
        (palette::GREEN, Marker::Square, Line::Solid),
    ];
    let panel = |label: &str, value: fn(&SolverRow) -> Option<f64>| {
        let good = || rows.iter().filter(|r| r.failure.is_none());
        let look = |(name, (colour, marker, line)): (&&str, (Colour, Marker, Line))| {
            let points = of(rows, name).filter_map(|r| Some([r.n as f64, value(r)?]));
            let series = Series::line(name, colour, points.collect()).marked(marker);
            Series { line, ..series }
        };
        let series = SOLVERS.iter().zip(looks).map(look).collect();
        let x = Axis::decades("degrees of freedom n", rows.iter().map(|r| r.n as f64));
        let y = Axis::decades(label, good().filter_map(value));
        Chart::new(x, y, [150.0, 160.0], series)
    };
    let time = panel("form C, factorise again, solve (s)", |r| Some(r.step()));
    let error = panel("velocity error", |r| r.velocity.map(|v| v.max(1e-17)));
    Charts::row([time.with_legend(Legend::None), error])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_interpolated() {
        let row = |solver: &str, n: usize, again: f64| SolverRow {
            n,
            again,
            ..SolverRow::new(solver, "", n)
        };
        let mut rows = Vec::new();
        for n in [10, 40, 160, 640] {
            rows.push(row(CHOLESKY, n, (n as f64).powi(3)));
            rows.push(row(SCHUR, n, 8e3 * n as f64));
        }
        let n = crossing(&rows, CHOLESKY, SCHUR).unwrap();
        assert!((n / 8e3f64.sqrt() - 1.0).abs() < 1e-12, "{n}");
        assert_eq!(crossing(&rows, SCHUR, CHOLESKY), None);
        let (e, range) = growth(&rows, CHOLESKY).unwrap();
        assert!((e - 3.0).abs() < 1e-12 && range == [40, 640]);
    }
}
