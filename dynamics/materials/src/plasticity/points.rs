//! The layers of half a section: the points of Gauss and Legendre.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// A layer in parts of the section.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// `3 w z^2`.
    pub(super) rigidity: f64,
    /// `2 w z`.
    pub(super) moment: f64,
}

/// The largest number of layers.
pub(super) const MOST: usize = 100;

/// The layers for each number of layers that has been asked for.
static KNOWN: [OnceLock<Box<[Point]>>; MOST + 1] = [const { OnceLock::new() }; MOST + 1];

/// The layers of a section in so many, the innermost first; at most [`MOST`].
pub(super) fn points(count: usize) -> &'static [Point] {
    KNOWN[count].get_or_init(|| of_gauss(count))
}

/// Steps of Newton's method from the asymptotic value of a root, of which five are enough.
const STEPS: usize = 10;

fn of_gauss(count: usize) -> Box<[Point]> {
    let n = count as f64;
    let point = |i: usize| {
        let mut x = -(PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..STEPS {
            let [value, before] = legendre(count, x);
            slope = n * (before - x * value) / (1.0 - x * x);
            x -= value / slope;
        }
        let (place, weight) = (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope));
        Point {
            rigidity: 3.0 * weight * place * place,
            moment: 2.0 * weight * place,
        }
    };
    let points: Vec<Point> = (0..count).map(point).collect();
    // One point alone is not exact for the rigidity.
    let rigidity: f64 = points.iter().map(|p| p.rigidity).sum();
    let moment: f64 = points.iter().map(|p| p.moment).sum();
    let whole = points.into_iter().map(|p| Point {
        rigidity: p.rigidity / rigidity,
        moment: p.moment / moment,
    });
    whole.collect()
}

/// Legendre's polynomial of a degree, and the one before.
fn legendre(degree: usize, x: f64) -> [f64; 2] {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (before, value) = (
            value,
            ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k,
        );
    }
    [value, before]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of degree `2 n - 1`: two thirds of the rigidity over the moment are the place `z`, and a third of the
    /// rigidity over `z^2` the weight; the integral of `z^m` over the half is `1 / (m + 1)`.
    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in [2, 3, 11, 40] {
            for degree in [2, 3, 2 * count as i32 - 1] {
                let terms = points(count).iter().map(|p| {
                    let z = 2.0 / 3.0 * p.rigidity / p.moment;
                    p.rigidity / 3.0 * z.powi(degree - 2)
                });
                let (sum, exact) = (terms.sum::<f64>(), 1.0 / f64::from(degree + 1));
                assert!((sum / exact - 1.0).abs() < 1e-12, "{count} {degree}: {sum}");
            }
        }
    }

    #[test]
    fn one_layer_is_the_whole_section_and_none_is_nothing() {
        let [whole] = points(1) else {
            panic!("one layer");
        };
        assert_eq!((whole.rigidity, whole.moment), (1.0, 1.0));
        assert!(points(0).is_empty());
    }

    #[test]
    fn the_outermost_layer_is_the_last() {
        for count in [2, 11, 100] {
            let places = points(count).windows(2);
            let mut places = places.map(|p| [p[0], p[1]].map(|p| p.rigidity / p.moment));
            assert!(places.all(|[inner, outer]| 0.0 < inner && inner < outer && outer < 1.5));
        }
    }
}
