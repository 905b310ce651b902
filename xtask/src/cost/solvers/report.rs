//! What the rows of the solver study say: tables, plot, words.

use super::row::{SOLVERS, SolverRow};
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
    let last = |s: &&str| {
        let last = of(rows, s).last()?;
        Some(format!("{s} {}", short(last.first / last.again)))
    };
    let first: Vec<String> = SOLVERS[4..].iter().filter_map(last).collect();
    all.push(format!(
        "A first factorisation, analysis included, takes so many times a later one, at the largest size of each: {}.",
        first.join("; ")
    ));
    all.push(format!(
        "Largest backward error / error of the velocities: {}.",
        worst_errors(rows).join("; ")
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
    use super::super::row::{CHOLESKY, SCHUR};
    use super::*;

    #[test]
    fn growth_and_winners_follow_the_numbers() {
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
        let (e, range) = growth(&rows, CHOLESKY).unwrap();
        assert!((e - 3.0).abs() < 1e-12 && range == [40, 640]);
        assert_eq!(
            fastest(&rows),
            [
                format!("{CHOLESKY} from n = 10 to 40"),
                format!("{SCHUR} from n = 160 to 640")
            ]
        );
    }
}
