//! What the points of a study say: orders, which method is the cheapest.

use super::measure::{Errors, Point};
use crate::report::exponent;

/// Which error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    pub(crate) name: &'static str,
    /// The largest error that is of use, a power of ten: coarser runs are cheap, but no motion. Position
    /// errors of sheets of 1 m.
    pub(crate) useful: i32,
    pub(crate) of: fn(&Errors) -> f64,
}

/// Distances from the reference, changes of energy, edge strains: see [`Errors`].
pub(crate) const POSITION: Measure = Measure {
    name: "position, m",
    useful: -2,
    of: |errors| errors.position,
};
pub(crate) const ENERGY: Measure = Measure {
    name: "energy",
    useful: -1,
    of: |errors| errors.energy,
};
pub(crate) const STRAIN: Measure = Measure {
    name: "strain",
    useful: -2,
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
    fn the_cheapest_is_the_first_below_a_level() {
        let points = sample();
        let name = |level: f64| cheapest(&points, POSITION, level).map(|p| p.scheme.as_str());
        assert_eq!(name(0.1), Some("one"));
        assert_eq!(name(1e-4), Some("four"));
        assert_eq!(name(1e-20), None);
    }
}
