//! What the rows of the solver study say: tables, plot, words.

use super::super::analysis::{exponent, short};
use super::super::study::{axis, decades};
use super::{CHOLESKY, CRAMER, LDLT, MINORS, SCHUR, SOLVERS, SPARSE_LU, SolverRow};
use crate::draw::{Colour, Drawing, Legend, Line, Marker, Plot, Series, palette, row};
use crate::figures::Table;
use std::fmt::Write;

/// All rows as CSV.
pub(crate) fn csv(rows: &[SolverRow]) -> String {
    let mut out = String::from(
        "solver,mesh,degrees_of_freedom,order,form_s,first_s,again_s,solve_s,backward_error,velocity_error,two_cores,failure\n",
    );
    let number = |v: Option<f64>| v.map_or(String::new(), |v| format!("{v:e}"));
    for r in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "\"{}\",{},{},{},{:e},{:e},{:e},{:e},{},{},{},\"{}\"",
            r.solver,
            r.mesh,
            r.n,
            r.order,
            r.form,
            r.first,
            r.again,
            r.solve,
            number(r.backward),
            number(r.velocity),
            number(r.two),
            r.failure.as_deref().unwrap_or("").replace('"', "'")
        );
    }
    out
}

/// Time in microseconds or milliseconds.
fn time(seconds: f64) -> String {
    match seconds {
        0.0 => "–".into(),
        s if s < 1e-3 => format!("{} µs", short(1e6 * s)),
        s if s < 1.0 => format!("{} ms", short(1e3 * s)),
        s => format!("{} s", short(s)),
    }
}

/// The table for people.
pub(crate) fn table(rows: &[SolverRow]) -> Table {
    let number = |v: Option<f64>| v.map_or("–".into(), |v| format!("{v:.0e}"));
    Table {
        caption: "Linear solvers by size".into(),
        head: [
            "solver",
            "mesh",
            "n",
            "order",
            "forming C",
            "first",
            "again",
            "solve",
            "backward error",
            "velocity error",
            "two at once",
            "remark",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: SOLVERS
            .iter()
            .flat_map(|s| rows.iter().filter(move |r| r.solver == *s))
            .map(|r| {
                vec![
                    r.solver.clone(),
                    r.mesh.clone(),
                    r.n.to_string(),
                    r.order.to_string(),
                    time(r.form),
                    time(r.first),
                    time(r.again),
                    time(r.solve),
                    number(r.backward),
                    number(r.velocity),
                    r.two.map_or("–".into(), |t| format!("{t:.1}×")),
                    r.failure.clone().unwrap_or_default(),
                ]
            })
            .collect(),
    }
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
    let fastest: Vec<String> = winners
        .iter()
        .map(|(s, [a, b])| {
            if a == b {
                format!("{s} at n = {a}")
            } else {
                format!("{s} from n = {a} to {b}")
            }
        })
        .collect();
    all.push(format!(
        "Fastest at forming, factorising and solving once: {}.",
        fastest.join("; ")
    ));
    let crossings: Vec<String> = [
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
    .collect();
    if !crossings.is_empty() {
        all.push(format!("Cross-over points: {}.", crossings.join("; ")));
    }
    let analysis: Vec<String> = SOLVERS[4..]
        .iter()
        .filter_map(|s| {
            let last = of(rows, s).last()?;
            Some(format!("{s} {}", short(last.first / last.again)))
        })
        .collect();
    all.push(format!(
        "A first factorisation, analysis included, takes so many times a later one, at the largest size of each: {}.",
        analysis.join("; ")
    ));
    let worst: Vec<String> = SOLVERS
        .iter()
        .filter_map(|s| {
            let of = |f: fn(&SolverRow) -> Option<f64>| of(rows, s).filter_map(f).reduce(f64::max);
            let velocity = of(|r| r.velocity).map_or("–".into(), |v| format!("{v:.0e}"));
            Some(format!("{s} {:.0e} / {velocity}", of(|r| r.backward)?))
        })
        .collect();
    all.push(format!(
        "Largest backward error / error of the velocities: {}.",
        worst.join("; ")
    ));
    let two: Vec<String> = SOLVERS[4..]
        .iter()
        .filter_map(|s| {
            let last = of(rows, s).last()?;
            Some(format!("{s} {:.1}", last.two?))
        })
        .collect();
    all.push(format!(
        "Two cores with one factorisation each do so many times the work of one, at the largest size of each: {}. That means \
         something only on a machine with two idle cores. Within one factorisation one core is used.",
        two.join("; ")
    ));
    let failed: Vec<String> = rows
        .iter()
        .filter_map(|r| {
            Some(format!(
                "{} on {}: {}",
                r.solver,
                r.mesh,
                r.failure.as_ref()?
            ))
        })
        .collect();
    if !failed.is_empty() {
        all.push(format!("Failed: {}.", failed.join("; ")));
    }
    all
}

/// Time of a step's solve and backward error against n.
pub(crate) fn plot(rows: &[SolverRow]) -> Drawing {
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
    let sizes = decades(rows.iter().map(|r| r.n as f64));
    let panel = |label: &str, value: fn(&SolverRow) -> Option<f64>, legend| {
        let good = || rows.iter().filter(|r| r.failure.is_none());
        let series = SOLVERS
            .iter()
            .zip(looks)
            .map(|(s, (colour, marker, line))| Series {
                name: (*s).to_owned(),
                points: of(rows, s)
                    .filter_map(|r| Some([r.n as f64, value(r)?]))
                    .collect(),
                colour,
                marker: Some(marker),
                line,
            })
            .collect();
        Plot {
            x: axis("degrees of freedom ~n~", sizes),
            y: axis(label, decades(good().filter_map(value))),
            size: [150.0, 160.0],
            series,
            legend,
        }
        .draw()
    };
    row(
        &[
            panel(
                "form ~C~, factorise again, solve (s)",
                |r| Some(r.step()),
                Legend::None,
            ),
            panel(
                "velocity error",
                |r| r.velocity.map(|v| v.max(1e-17)),
                Legend::Right,
            ),
        ],
        18.0,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_interpolated() {
        let row = |solver: &str, n: usize, again: f64| SolverRow {
            solver: solver.into(),
            mesh: String::new(),
            n,
            order: n,
            form: 0.0,
            first: again,
            again,
            solve: 0.0,
            backward: None,
            velocity: None,
            two: None,
            failure: None,
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
