//! What the measurements of the scaling study are required to show, whatever the machine: counts, lengths, gaps.

use super::Results;
use super::findings::points;
use super::steps::Row;
use crate::report::{Bound, LENGTHS, Requirement, exponent};

/// Largest fitted powers of V: a planar graph has factors of V log V entries, formed with the 1.5th power of V
/// operations (George, SIAM J. Numer. Anal. 10, 1973); the terms of lower order raise or lower the power that
/// is fitted to few sizes.
const ENTRIES: f64 = 1.35;
const OPERATIONS: f64 = 1.75;

/// The requirements, each with the part of the study that it is on.
pub(super) fn required(results: &Results) -> Vec<(String, Requirement)> {
    let power = |value: fn(&Row) -> f64| {
        let of = points(&results.hanging, |r| [r.vertices as f64, value(r)]);
        [exponent(&of)]
    };
    let orders = results.hanging.iter().flat_map(|r| &r.orders);
    let differ = orders.filter(|o| !o.same_bits).count() as f64;
    let hanging: Vec<_> = results
        .hanging
        .iter()
        .map(|r| Some(r.course.strain))
        .collect();
    let draping: Vec<_> = results
        .draping
        .iter()
        .map(|r| Some(r.course.strain))
        .collect();
    let gaps: Vec<_> = results.draping.iter().map(|r| r.course.gap).collect();
    let (factor, steps) = ("Cholesky factor", "BDF2 (default)");
    let all = [
        (
            "hanging sheet",
            factor,
            "factors whose bits depend on the number of threads",
            (Bound::AtMost, 0.0),
            &[Some(differ)][..],
        ),
        (
            "hanging sheet",
            factor,
            "fitted power of V of its entries",
            (Bound::AtMost, ENTRIES),
            &power(|r| r.best().entries),
        ),
        (
            "hanging sheet",
            factor,
            "fitted power of V of its operations",
            (Bound::AtMost, OPERATIONS),
            &power(|r| r.best().operations),
        ),
        (
            "hanging sheet",
            steps,
            "largest strain of an edge",
            (Bound::AtMost, LENGTHS),
            &hanging,
        ),
        (
            "draping sheet",
            steps,
            "largest strain of an edge",
            (Bound::AtMost, LENGTHS),
            &draping,
        ),
        (
            "draping sheet",
            steps,
            "smallest gap, m",
            (Bound::Above, 0.0),
            &gaps,
        ),
    ];
    let named = |(part, of, quantity, bound, values): (&str, &str, &str, _, &[Option<f64>])| {
        (
            part.to_owned(),
            Requirement::of(of, quantity, bound, values),
        )
    };
    all.map(named).to_vec()
}
