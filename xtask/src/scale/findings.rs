//! What the measurements of single steps say, in words.

use super::Results;
use super::drape::DrapeRow;
use super::steps::Row;
use crate::report::{exponent, extremes};
use crate::timing::OrderRow;
use std::fmt::Write;

/// Points of a plot.
pub(super) fn points<R>(rows: &[R], point: impl Fn(&R) -> [f64; 2]) -> Vec<[f64; 2]> {
    rows.iter().map(point).collect()
}

/// The fitted power of V, for people.
pub(super) fn power(points: &[[f64; 2]]) -> String {
    exponent(points).map_or("?".into(), |p| format!("{p:.2}"))
}

/// What the measurements say.
pub(super) fn conclusion(rows: &[Row]) -> String {
    let power = |value: fn(&Row) -> f64| power(&points(rows, |r| [r.vertices as f64, value(r)]));
    let mut out = format!(
        "Fitted powers of V: time per step {}, factorisations per step {}, one numeric factorisation {}, its operations {}, \
         entries of the factor {}.",
        power(Row::step),
        power(Row::factorisations),
        power(|r| r.best().numeric),
        power(|r| r.best().operations),
        power(|r| r.best().entries),
    );
    if let Some(last) = rows.last() {
        let [degree, dissection] = &last.orders;
        let _ = write!(
            out,
            " At {} vertices nested dissection needs {:.2} times the operations and {:.2} times the entries of minimum degree.",
            last.vertices,
            dissection.operations / degree.operations,
            dissection.entries / degree.entries
        );
        if let Some(peak) = last.peak {
            let _ = write!(out, " The process used at most {:.2} GB.", peak / 1e9);
        }
    }
    if let Some([slope, offset, deviation]) = logarithmic(rows) {
        let _ = write!(
            out,
            " The entries of the factor as stored, padding included, are {slope:.0} V log2 V {} {:.0} V to within {:.0} %.",
            if offset < 0.0 { "−" } else { "+" },
            offset.abs(),
            100.0 * deviation
        );
    }
    let multiples = rows.iter().map(|r| r.step() / r.best().numeric);
    if let Some(words) = of_the_limit(multiples) {
        let _ = write!(out, " {words}");
    }
    out
}

/// How steps compare with the least that an implicit step can do.
fn of_the_limit(multiples: impl Iterator<Item = f64>) -> Option<String> {
    let [low, high] = extremes(multiples)?;
    Some(format!(
        "A step takes {low:.1} to {high:.1} times as long as one factorisation of its matrix, the least that an implicit step can do."
    ))
}

/// `a`, `b` of `a V log2 V + b V` entries of the factor, with the least squares of relative deviations, and
/// the largest of these. (Plain powers mislead: the term linear in V is negative, and makes what grows as V
/// log V look faster.)
fn logarithmic(rows: &[Row]) -> Option<[f64; 3]> {
    let points: Vec<[f64; 2]> = points(rows, |r| {
        let v = r.vertices as f64;
        [v.log2(), r.best().stored as f64 / v]
    });
    if points.len() < 4 {
        return None;
    }
    // Weights 1 / y^2 make the deviations relative.
    let sum = |f: fn(f64, f64) -> f64| points.iter().map(|[x, y]| f(*x, *y) / (y * y)).sum::<f64>();
    let (w, wx, wy) = (sum(|_, _| 1.0), sum(|x, _| x), sum(|_, y| y));
    let (wxx, wxy) = (sum(|x, _| x * x), sum(|x, y| x * y));
    let a = (w * wxy - wx * wy) / (w * wxx - wx * wx);
    let b = (wy - a * wx) / w;
    let deviation = points
        .iter()
        .map(|[x, y]| ((a * x + b) / y - 1.0).abs())
        .fold(0.0, f64::max);
    Some([a, b, deviation])
}

/// What two threads in one factorisation do.
pub(super) fn threads(rows: &[Row]) -> String {
    let all: Vec<&OrderRow> = rows.iter().flat_map(|r| &r.orders).collect();
    let faster: Vec<String> = rows
        .iter()
        .filter(|r| r.best().two_threads < PAYS * r.best().numeric)
        .map(|r| format!("M^{}", r.level))
        .collect();
    let ratios = extremes(rows.iter().map(|r| r.best().two_threads / r.best().numeric));
    let ratios = ratios.unwrap_or_default();
    format!(
        "Two threads within one factorisation take {:.1} to {:.1} times as long as one, and {}; they {}. Simulations share \
         factorisations among threads from some 2000 vertices on.",
        ratios[0],
        ratios[1],
        if faster.is_empty() {
            "pay at no size".to_owned()
        } else {
            format!("pay on {}", faster.join(", "))
        },
        if all.iter().all(|o| o.same_bits) {
            "give the same bits in every factor"
        } else {
            "do not give the same bits in every factor"
        }
    )
}

/// Two threads pay where they save a tenth.
const PAYS: f64 = 0.9;

pub(super) fn draping_conclusion(results: &Results) -> String {
    let rows = &results.draping;
    let power =
        |value: fn(&DrapeRow) -> f64| power(&points(rows, |r| [r.vertices as f64, value(r)]));
    let mut out = format!(
        "Fitted powers of V with contact: time per step {}, factorisations per step {}, detection {}, distances of contacts {}.",
        power(DrapeRow::step),
        power(DrapeRow::factorisations),
        power(DrapeRow::detection),
        power(DrapeRow::evaluation),
    );
    let shares = extremes(rows.iter().map(|r| r.detection() / r.step())).unwrap_or_default();
    let couplings = rows.iter().map(|r| r.couplings).max().unwrap_or(0);
    let _ = write!(
        out,
        " Detection takes {:.0} to {:.0} % of a step. ",
        100.0 * shares[0],
        100.0 * shares[1]
    );
    out.push_str(&if couplings == 0 {
        "Contact adds no couplings here: with a body it has none but those of the mesh, and the layers do not touch; the factor is the one of \
         the hanging sheet."
            .to_owned()
    } else {
        format!("Contact adds up to {couplings} couplings, which the factor has to be analysed and filled for.")
    });
    let multiples = rows.iter().filter_map(|r| {
        let hanging = results.hanging.iter().find(|h| h.level == r.level)?;
        Some(r.step() / hanging.best().numeric)
    });
    if let Some(words) = of_the_limit(multiples) {
        let _ = write!(out, " {words}");
    }
    for r in rows {
        if let Some(stopped) = r.course.failure() {
            let (level, steps) = (r.level, r.course.cost.steps);
            let _ = write!(out, " M^{level}: {steps} steps only ({stopped}).");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::steps::measure;

    #[test]
    fn growth_as_v_log_v_is_told_from_powers() {
        let rows = |entries: fn(f64) -> f64| {
            let row = measure(1, 1).expect("a small sheet moves");
            let of = |level: i32| {
                let mut row = row.clone();
                row.vertices = (2_usize.pow(level as u32 + 1) + 1).pow(2);
                for o in &mut row.orders {
                    o.stored = entries(row.vertices as f64) as usize;
                }
                row
            };
            (2..=7).map(of).collect::<Vec<_>>()
        };
        let [a, b, deviation] = logarithmic(&rows(|v| 20.0 * v * v.log2() - 50.0 * v)).unwrap();
        assert!((a - 20.0).abs() < 0.01 && (b + 50.0).abs() < 0.1 && deviation < 1e-3);
        for power in [|v: f64| 8.0 * v.powf(1.3), |v: f64| v.powf(1.5)] {
            let [.., deviation] = logarithmic(&rows(power)).unwrap();
            assert!(deviation > 0.15, "{deviation}");
        }
    }

    #[test]
    fn steps_are_compared_with_one_factorisation() {
        let mut row = measure(1, 1).expect("a small sheet moves");
        let steps = row.course.cost.steps as f64;
        row.course.cost.wall = 3.0 * steps * row.best().numeric;
        let mut other = row.clone();
        other.course.cost.wall = 7.0 * steps * other.best().numeric;
        let text = conclusion(&[row, other]);
        assert!(
            text.contains("3.0 to 7.0 times as long as one factorisation"),
            "{text}"
        );
    }

    #[test]
    fn words_follow_the_numbers() {
        let mut row = measure(1, 1).expect("a small sheet moves");
        for o in &mut row.orders {
            o.two_threads = 2.0 * o.numeric;
        }
        let rows = [row];
        assert!(threads(&rows).contains(
            "2.0 to 2.0 times as long as one, and pay at no size; they give the same bits"
        ));
        let [mut row] = rows;
        for o in &mut row.orders {
            (o.two_threads, o.same_bits) = (0.5 * o.numeric, false);
        }
        assert!(threads(&[row]).contains("pay on M^1; they do not give the same bits"));
    }
}
