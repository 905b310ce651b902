//! What the points of a study say: orders, Pareto fronts, in numbers and words.

use super::measure::{Errors, Point};
use crate::report::{exponent, short};
use std::fmt::Write;

/// Which error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    /// The largest error that is of use: coarser runs are cheap, but no motion. Position errors of sheets of
    /// 1 m.
    useful: f64,
    pub(crate) of: fn(&Errors) -> f64,
}

/// Distances from the reference, changes of energy, edge strains: see [`Errors`].
pub(crate) const POSITION: Measure = Measure {
    name: "position",
    unit: " m",
    useful: 0.05,
    of: |errors| errors.position,
};
pub(crate) const ENERGY: Measure = Measure {
    name: "energy",
    unit: "",
    useful: 0.1,
    of: |errors| errors.energy,
};
pub(crate) const STRAIN: Measure = Measure {
    name: "strain",
    unit: "",
    useful: 1e-2,
    of: |errors| errors.strain,
};

/// Points that a fitted order rests on: the finest ones, before floors are reached.
const FITTED: usize = 4;

/// Order of a method: the slope of its error over its step, from the finest runs whose error is ten times
/// above `floor` and whose steps were taken as asked for.
pub(crate) fn order(points: &[Point], scheme: &str, measure: Measure, floor: f64) -> Option<f64> {
    let usable: Vec<[f64; 2]> = points
        .iter()
        .filter(|p| p.scheme == scheme && p.uniform)
        .filter_map(|p| {
            p.errors
                .map(|e| [p.step, (measure.of)(&e)])
                .filter(|[_, e]| *e > 10.0 * floor)
        })
        .collect();
    let finest = usable.len().saturating_sub(FITTED);
    exponent(&usable[finest..]).filter(|_| usable.len() - finest >= 3)
}

/// Times within this factor count as equal: repeated measurements differ by as much.
const NOISE: f64 = 1.1;

/// The cheapest point whose error is at most `level`.
pub(crate) fn cheapest<'a>(
    points: impl IntoIterator<Item = &'a Point>,
    measure: Measure,
    level: f64,
) -> Option<&'a Point> {
    points
        .into_iter()
        .filter(|p| p.errors.is_some_and(|e| (measure.of)(&e) <= level))
        .min_by(|a, b| a.cpu.total_cmp(&b.cpu))
}

/// The largest and smallest useful error of the points of a method that no other method reaches in less time
/// (beyond noise) with as small an error: its part of the front.
pub(crate) fn on_front(points: &[Point], scheme: &str, measure: Measure) -> Option<[f64; 2]> {
    points
        .iter()
        .filter(|p| p.scheme == scheme)
        .filter_map(|p| {
            let level = (measure.of)(&p.errors?);
            let others = points.iter().filter(|q| q.scheme != scheme);
            let first = cheapest(others, measure, level).is_none_or(|q| q.cpu * NOISE >= p.cpu);
            (first && level <= measure.useful).then_some([level; 2])
        })
        .reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])])
}

/// One piece of a front: the method to use for errors from one level to another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) scheme: String,
    /// The smallest error, a power of ten.
    pub(crate) to: i32,
    /// Its price at the smallest error, CPU seconds for a simulated second.
    pub(crate) cpu: f64,
}

/// Which method is the cheapest at errors of 1e-1, 1e-2, ..., neighbouring levels with the same one joined.
pub(crate) fn front(points: &[Point], measure: Measure) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    for k in 1..=14 {
        let Some(best) = cheapest(points, measure, 10f64.powi(-k)) else {
            break;
        };
        let stretch = Stretch {
            scheme: best.scheme.clone(),
            to: -k,
            cpu: best.cpu,
        };
        match stretches.last_mut() {
            Some(last) if last.scheme == stretch.scheme => *last = stretch,
            _ => stretches.push(stretch),
        }
    }
    stretches
}

/// The front in words.
pub(crate) fn advice(points: &[Point], measure: Measure) -> String {
    let mut text = String::new();
    for stretch in front(points, measure) {
        let join = if text.is_empty() { "" } else { "; " };
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{join}down to 1e{}{}: {} ({} s/s)",
            stretch.to,
            measure.unit,
            stretch.scheme,
            short(stretch.cpu)
        );
    }
    if text.is_empty() {
        text.push_str("no method reaches 1e-1");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(scheme: &str, step: f64, cpu: f64, position: f64) -> Point {
        Point {
            scheme: scheme.into(),
            fineness: step,
            step,
            uniform: true,
            cpu,
            errors: Some(Errors {
                position,
                energy: position,
                strain: 0.0,
            }),
            reached: 1.0,
            ..Point::default()
        }
    }

    fn sample() -> Vec<Point> {
        let mut points = Vec::new();
        for k in 0..6 {
            let h = 0.1 * 0.5f64.powi(k);
            points.push(point("one", h, 0.01 / h, h));
            points.push(point("four", h, 0.1 / h, h.powi(4)));
            points.push(point("bad", h, 1.0 / h, h));
        }
        points
    }

    #[test]
    fn orders_are_slopes_above_the_floor() {
        let points = sample();
        let o = |name, floor| order(&points, name, POSITION, floor);
        assert!((o("one", 1e-12).unwrap() - 1.0).abs() < 1e-12);
        assert!((o("four", 1e-12).unwrap() - 4.0).abs() < 1e-12);
        assert_eq!(o("four", 1e-5), None, "too few points are left");
    }

    #[test]
    fn the_front_names_the_cheapest() {
        let points = sample();
        let stretches = front(&points, POSITION);
        assert_eq!(stretches[0].scheme, "one");
        assert_eq!(stretches[0].to, -1);
        assert_eq!(stretches[1].scheme, "four");
        let [high, low] = on_front(&points, "one", POSITION).unwrap();
        assert!(
            high == 0.05 && low < high,
            "{high} is no more than what is of use"
        );
        assert!(on_front(&points, "four", POSITION).is_some());
        assert_eq!(on_front(&points, "bad", POSITION), None);
        assert_eq!(on_front(&points, "absent", POSITION), None);
        let words = advice(&points, POSITION);
        assert!(
            words.starts_with("down to 1e-1 m: one (0.10 s/s)"),
            "{words}"
        );
        assert_eq!(advice(&[], ENERGY), "no method reaches 1e-1");
    }
}
