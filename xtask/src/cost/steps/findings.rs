//! What steps by size say, and what they are required to show on any machine.

use super::measure::Row;
use super::orders::OrderRow;
use crate::cost::DEFAULT;
use crate::report::{Bound, LENGTHS, Requirement, exponent, extremes};
use crate::runs::Course;

/// Largest fitted powers of V: a planar graph has factors of V log V entries, formed with the 1.5th power of V
/// operations (George, SIAM J. Numer. Anal. 10, 1973); the terms of lower order raise or lower the power that
/// is fitted to few sizes.
const ENTRIES: f64 = 1.35;
const OPERATIONS: f64 = 1.75;

/// Two threads pay where they save a tenth.
const PAYS: f64 = 0.9;

/// The fitted power of V of a quantity.
fn fit(rows: &[Row], value: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
    let point = |r: &Row| Some([r.vertices as f64, value(r)?]);
    exponent(&rows.iter().filter_map(point).collect::<Vec<_>>())
}

/// The same for people.
fn power(rows: &[Row], value: impl Fn(&Row) -> Option<f64>) -> String {
    fit(rows, value).map_or("?".into(), |p| format!("{p:.2}"))
}

/// What the measurements say.
pub(super) fn findings(rows: &[Row]) -> Vec<String> {
    let mut all = vec![
        format!(
            "Fitted powers of V without contact: time per step {}, factorisations per step {}, one numeric factorisation {}, its operations \
             {}, entries of the factor {}.",
            power(rows, |r| r.hanging.cost.cpu_per_step()),
            power(rows, |r| r.hanging.cost.factorisations_per_step()),
            power(rows, |r| Some(r.best().numeric)),
            power(rows, |r| Some(r.best().operations)),
            power(rows, |r| Some(r.best().entries)),
        ),
        format!(
            "With contact: time per step {}, factorisations per step {}, detection {}, distances of contacts {}.",
            power(rows, |r| r.draping.cost.cpu_per_step()),
            power(rows, |r| r.draping.cost.factorisations_per_step()),
            power(rows, |r| Some(r.contact.detection)),
            power(rows, |r| Some(r.contact.distances)),
        ),
    ];
    let of_the_limit = |steps: fn(&Row) -> &Course| {
        let time = |r: &Row| Some(steps(r).cost.cpu_per_step()? / r.best().numeric);
        extremes(rows.iter().filter_map(time)).unwrap_or_default()
    };
    let [free, touching] = [of_the_limit(|r| &r.hanging), of_the_limit(|r| &r.draping)];
    all.push(format!(
        "A step takes {:.1} to {:.1} times as long as one factorisation of its matrix, the least that an implicit step can do; with contact \
         {:.1} to {:.1} times.",
        free[0], free[1], touching[0], touching[1]
    ));
    let share = |r: &Row| Some(100.0 * r.contact.detection / r.draping.cost.cpu_per_step()?);
    let shares = extremes(rows.iter().filter_map(share)).unwrap_or_default();
    let couplings = rows.iter().map(|r| r.contact.couplings).max().unwrap_or(0);
    all.push(format!(
        "Detection takes {:.0} to {:.0} % of a step with contact, which adds up to {couplings} couplings to the pattern of the matrix.",
        shares[0], shares[1]
    ));
    all.extend(rows.last().map(finest));
    all.extend(logarithmic(rows).map(|[slope, offset, deviation]| {
        format!(
            "The entries of the factor as stored, padding included, are {slope:.0} V log2 V {} {:.0} V to within {:.0} %.",
            if offset < 0.0 { "−" } else { "+" },
            offset.abs(),
            100.0 * deviation
        )
    }));
    all.push(threads(rows));
    all
}

/// The two orders of elimination, and the memory, on the finest mesh.
fn finest(last: &Row) -> String {
    let [degree, dissection] = &last.orders;
    let peak = last.peak.map_or(String::new(), |peak| {
        format!(" The process used at most {:.2} GB there.", peak / 1e9)
    });
    format!(
        "At {} vertices nested dissection needs {:.2} times the operations and {:.2} times the entries of minimum degree.{peak}",
        last.vertices,
        dissection.operations / degree.operations,
        dissection.entries / degree.entries
    )
}

/// `a`, `b` of `a V log2 V + b V` entries of the factor, with the least squares of relative deviations, and
/// the largest of these. (Plain powers mislead: the term linear in V is negative, and makes what grows as V
/// log V look faster.)
fn logarithmic(rows: &[Row]) -> Option<[f64; 3]> {
    let point = |r: &Row| {
        let v = r.vertices as f64;
        [v.log2(), r.best().stored as f64 / v]
    };
    let points: Vec<[f64; 2]> = rows.iter().map(point).collect();
    if points.len() < 4 {
        return None;
    }
    // Weights 1 / y^2 make the deviations relative.
    let sum = |f: fn(f64, f64) -> f64| points.iter().map(|[x, y]| f(*x, *y) / (y * y)).sum::<f64>();
    let (w, wx, wy) = (sum(|_, _| 1.0), sum(|x, _| x), sum(|_, y| y));
    let (wxx, wxy) = (sum(|x, _| x * x), sum(|x, y| x * y));
    let a = (w * wxy - wx * wy) / (w * wxx - wx * wx);
    let b = (wy - a * wx) / w;
    let deviations = points.iter().map(|[x, y]| ((a * x + b) / y - 1.0).abs());
    Some([a, b, deviations.fold(0.0, f64::max)])
}

/// What two threads in one factorisation do.
fn threads(rows: &[Row]) -> String {
    let ratio = |r: &Row| r.best().two_threads / r.best().numeric;
    let faster = rows.iter().filter(|r| ratio(r) < PAYS);
    let faster: Vec<String> = faster.map(|r| format!("M^{}", r.level)).collect();
    let ratios = extremes(rows.iter().map(ratio)).unwrap_or_default();
    format!(
        "Two threads within one factorisation take {:.1} to {:.1} times as long as one, and {}; they {}. Simulations share \
         factorisations among threads from some 2000 vertices on.",
        ratios[0],
        ratios[1],
        match &faster[..] {
            [] => "pay at no size".to_owned(),
            names => format!("pay on {}", names.join(", ")),
        },
        match different(rows) {
            0 => "give the same bits in every factor",
            _ => "do not give the same bits in every factor",
        }
    )
}

/// Factors whose bits depend on the number of threads.
fn different(rows: &[Row]) -> usize {
    let orders = rows.iter().flat_map(|r| &r.orders);
    orders.filter(|o: &&OrderRow| !o.same_bits).count()
}

/// The requirements.
pub(super) fn required(rows: &[Row]) -> Vec<Requirement> {
    let courses = rows.iter().flat_map(|r| [&r.hanging, &r.draping]);
    let strains: Vec<_> = courses.map(|c| Some(c.strain)).collect();
    let gaps: Vec<_> = rows.iter().map(|r| r.draping.gap).collect();
    let power = |value: fn(&Row) -> f64| [fit(rows, |r| Some(value(r)))];
    let factor = "Cholesky factor";
    vec![
        Requirement::of(
            factor,
            "factors whose bits depend on the number of threads",
            (Bound::AtMost, 0.0),
            &[Some(different(rows) as f64)],
        ),
        Requirement::of(
            factor,
            "fitted power of V of its entries",
            (Bound::AtMost, ENTRIES),
            &power(|r| r.best().entries),
        ),
        Requirement::of(
            factor,
            "fitted power of V of its operations",
            (Bound::AtMost, OPERATIONS),
            &power(|r| r.best().operations),
        ),
        Requirement::of(
            DEFAULT,
            "largest strain of an edge",
            (Bound::AtMost, LENGTHS),
            &strains,
        ),
        Requirement::of(DEFAULT, "smallest gap, m", (Bound::Above, 0.0), &gaps),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::measure::measure;
    use super::*;

    #[test]
    fn growth_as_v_log_v_is_told_from_powers() {
        let row = measure(1, 1).expect("a small sheet moves");
        let rows = |entries: fn(f64) -> f64| {
            let of = |level: u32| {
                let mut row = row.clone();
                row.vertices = (2_usize.pow(level + 1) + 1).pow(2);
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
    fn words_and_requirements_follow_the_numbers() {
        let mut row = measure(1, 1).expect("a small sheet moves");
        let steps = row.hanging.cost.steps as f64;
        row.hanging.cost.cpu = 3.0 * steps * row.best().numeric;
        for o in &mut row.orders {
            o.two_threads = 2.0 * o.numeric;
        }
        let mut other = row.clone();
        other.hanging.cost.cpu *= 2.0;
        let text = findings(&[row.clone(), other]).join(" ");
        for part in [
            "3.0 to 6.0 times as long as one factorisation",
            "2.0 to 2.0 times as long as one, and pay at no size; they give the same bits",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
        for o in &mut row.orders {
            (o.two_threads, o.same_bits) = (0.5 * o.numeric, false);
        }
        assert!(threads(&[row.clone()]).contains("pay on M^1; they do not give the same bits"));
        let required = required(&[row]);
        assert!(!required[0].is_met() && required[0].measured == Some(2.0));
        assert!(required[3].is_met() && required[4].is_met());
    }
}
