//! Where the folds of a draped cloth are, and how many.

use isosheet_mesh::{Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A convex outline, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    corners: Vec<[f64; 2]>,
}

impl Outline {
    /// With its corners, metres.
    pub(super) fn of(corners: Vec<[f64; 2]>) -> Self {
        Self { corners }
    }

    /// The rectangle about the origin with half its sides along x and y, metres.
    pub(super) fn rectangle(a: f64, b: f64) -> Self {
        Self::of(vec![[a, b], [-a, b], [-a, -b], [a, -b]])
    }

    /// How far a point is outside, negative inside: the largest distance from the lines of the sides.
    pub(super) fn outside(&self, p: [f64; 2]) -> f64 {
        let n = self.corners.len();
        (0..n)
            .map(|k| {
                let (a, b) = (self.corners[k], self.corners[(k + 1) % n]);
                let side = [b[0] - a[0], b[1] - a[1]];
                (side[1] * (p[0] - a[0]) - side[0] * (p[1] - a[1])) / side[0].hypot(side[1])
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Where the ray from the origin, which is inside, through a point leaves the outline: the distance of
    /// the point over that of the outline.
    fn gauge(&self, [x, y]: [f64; 2]) -> f64 {
        let sides = self.corners.iter().zip(self.corners.iter().cycle().skip(1));
        let ratio = |([a, b], [c, d]): (&[f64; 2], &[f64; 2])| {
            let [u, v] = [d - b, a - c];
            (u * x + v * y) / (u * a + v * b)
        };
        sides.map(ratio).fold(0.0, f64::max)
    }
}

/// Along which lines from corners of the table to corners of the cloth folds run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct CornerFolds {
    /// Corner lines along which a fold runs, and their number.
    pub(super) along: usize,
    pub(super) lines: usize,
    /// The part of all directions in which a fold runs, which is what chance would give the corners.
    pub(super) part: f64,
}

/// Parts of the way from the edge of the table to the hem at which a fold has to be seen.
const STATIONS: [f64; 3] = [0.35, 0.65, 0.95];

impl CornerFolds {
    /// Measures the positions `x`; corners of table and cloth belong together by number. A fold runs in a
    /// direction, seen from the axis, if the cloth is in the outer half of an outward bulge there at all of
    /// [`STATIONS`].
    pub(super) fn of(sheet: &Sheet, x: &[f64], table: &Outline, cloth: &Outline) -> Self {
        let inner = cloth.gauge(table.corners[0]);
        let mut runs = [true; SAMPLES];
        for s in STATIONS {
            let ring = ring(sheet, x, cloth, inner + s * (1.0 - inner));
            let mut outer = [false; SAMPLES];
            for (top, height) in peaks(&ring, s * PROMINENCE) {
                for step in [1, SAMPLES - 1] {
                    let mut k = top;
                    while ring[k] >= ring[top] - 0.5 * height {
                        outer[k] = true;
                        k = (k + step) % SAMPLES;
                    }
                }
            }
            let both = runs.iter_mut().zip(outer);
            both.for_each(|(all, one)| *all &= one);
        }
        let at = |[a, b]: &[f64; 2]| {
            let place = b.atan2(*a).rem_euclid(TAU) / TAU * SAMPLES as f64;
            runs[place.round() as usize % SAMPLES]
        };
        Self {
            along: cloth.corners.iter().filter(|c| at(c)).count(),
            lines: cloth.corners.len(),
            part: runs.iter().filter(|r| **r).count() as f64 / SAMPLES as f64,
        }
    }
}

/// The curve of the cloth that was `level` times its outline in the flat cloth: the distance from the axis,
/// divided by that in the flat cloth, by angle.
fn ring(sheet: &Sheet, x: &[f64], cloth: &Outline, level: f64) -> Vec<f64> {
    let t = sheet.topology();
    let mut points = Vec::new();
    for ends in t.edges() {
        let flat = ends.map(|v| sheet.position(v));
        let gauges = flat.map(|[a, b, _]| cloth.gauge([a, b]) - level);
        if (gauges[0] < 0.0) == (gauges[1] < 0.0) {
            continue;
        }
        let s = gauges[0] / (gauges[0] - gauges[1]);
        let mix = |a: f64, b: f64| a + s * (b - a);
        let now = ends.map(|v| [x[3 * v.index()], x[3 * v.index() + 1]]);
        let [[a, b], [c, d]] = [
            [0, 1].map(|k| mix(flat[0][k], flat[1][k])),
            [0, 1].map(|k| mix(now[0][k], now[1][k])),
        ];
        points.push([b.atan2(a).rem_euclid(TAU), c.hypot(d) / a.hypot(b)]);
    }
    points.sort_by(|p, q| p[0].total_cmp(&q[0]));
    resample(&points)
}

/// The hem of a cloth at rest, by angle about the middle of the table: its distance from the axis, divided by
/// that of the flat cloth, so that corners of the outline do not count as folds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Hem {
    /// Number of folds: outward bulges of the hem that stand out by [`PROMINENCE`].
    pub(super) folds: usize,
    /// Spread (standard deviation over mean) of the angles between neighbouring folds: 0 for a uniform
    /// pattern.
    pub(super) spacing_spread: f64,
    /// Spread of how far the folds stand out.
    pub(super) size_spread: f64,
}

/// A bulge of the hem counts from this part of its flat distance: a twentieth of a typical overhang.
const PROMINENCE: f64 = 0.02;

/// Points at which the hem is sampled.
const SAMPLES: usize = 720;

impl Hem {
    /// Measures the hem of positions `x` of a cloth around the z axis.
    pub(super) fn of(sheet: &Sheet, x: &[f64]) -> Self {
        let t = sheet.topology();
        let mut hem: Vec<[f64; 2]> = t
            .vertex_ids()
            .filter(|v| t.is_boundary_vertex(*v))
            .map(|v: VertexId| {
                let [a, b, _] = sheet.position(v);
                let i = 3 * v.index();
                let relative = x[i].hypot(x[i + 1]) / a.hypot(b);
                [b.atan2(a).rem_euclid(TAU), relative]
            })
            .collect();
        hem.sort_by(|p, q| p[0].total_cmp(&q[0]));
        let curve = resample(&hem);
        Self::of_curve(&curve)
    }

    fn of_curve(curve: &[f64]) -> Self {
        let peaks = peaks(curve, PROMINENCE);
        let n = curve.len();
        let gaps: Vec<f64> = (0..peaks.len())
            .map(|k| {
                let next = peaks[(k + 1) % peaks.len()].0;
                let gap = (next + n - peaks[k].0) % n;
                if gap == 0 { n as f64 } else { gap as f64 }
            })
            .collect();
        let sizes: Vec<f64> = peaks.iter().map(|p| p.1).collect();
        Self {
            folds: peaks.len(),
            spacing_spread: spread(&gaps),
            size_spread: spread(&sizes),
        }
    }
}

/// Values at equal angles of points sorted by angle, joined by straight lines round the circle.
fn resample(points: &[[f64; 2]]) -> Vec<f64> {
    let n = points.len();
    (0..SAMPLES)
        .map(|k| {
            let a = TAU * k as f64 / SAMPLES as f64;
            let after = points.partition_point(|p| p[0] <= a);
            let (p, q) = (points[(after + n - 1) % n], points[after % n]);
            let width = (q[0] - p[0]).rem_euclid(TAU);
            let s = (a - p[0]).rem_euclid(TAU) / width.max(1e-12);
            p[1] + s * (q[1] - p[1])
        })
        .collect()
}

/// Maxima of a closed curve that stand out by at least `least`: place and prominence, the smaller descent to
/// the lowest point before something higher on either side.
fn peaks(curve: &[f64], least: f64) -> Vec<(usize, f64)> {
    let n = curve.len();
    let descent = |k: usize, step: usize| {
        let (mut low, mut j) = (curve[k], k);
        for _ in 0..n {
            j = (j + step) % n;
            if curve[j] > curve[k] {
                break;
            }
            low = low.min(curve[j]);
        }
        curve[k] - low
    };
    (0..n)
        // The first of equal neighbours counts.
        .filter(|k| curve[*k] > curve[(k + n - 1) % n] && curve[*k] >= curve[(k + 1) % n])
        .map(|k| (k, descent(k, 1).min(descent(k, n - 1))))
        .filter(|p| p.1 >= least)
        .collect()
}

/// Standard deviation over mean.
fn spread(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    if mean > 0.0 {
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt() / mean
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate::{polygon_rings, regular_outline};

    #[test]
    fn outside_is_the_distance_from_the_sides() {
        let square = Outline::rectangle(2.0, 1.0);
        assert_eq!(square.outside([0.0, 0.0]), -1.0);
        assert_eq!(square.outside([2.5, 0.0]), 0.5);
        let octagon = Outline::of(regular_outline(8, 1.0).unwrap());
        let apothem = (TAU / 16.0).cos();
        assert!((octagon.outside([0.0, 0.0]) + apothem).abs() < 1e-14);
        assert!((octagon.outside([2.0, 0.0]) - (2.0 - apothem)).abs() < 1e-14);
        let mut corners = octagon.corners.iter();
        assert!(corners.all(|c| octagon.outside(*c).abs() < 1e-14));
    }

    #[test]
    fn waves_are_counted_and_ripples_are_not() {
        let curve = |f: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..SAMPLES)
                .map(|k| f(TAU * k as f64 / SAMPLES as f64))
                .collect()
        };
        let even = Hem::of_curve(&curve(&|a| {
            0.4 + 0.03 * (9.0 * a + 0.3).cos() + 1e-3 * (31.0 * a).cos()
        }));
        assert_eq!(even.folds, 9);
        assert!(even.spacing_spread < 0.05, "{even:?}");
        // Two families of different size: uneven.
        let uneven = Hem::of_curve(&curve(&|a| {
            0.4 + 0.03 * (4.0 * a).cos() + 0.03 * (5.0 * a).cos()
        }));
        assert!(uneven.size_spread > 0.3, "{uneven:?}");
        let round = Hem::of_curve(&curve(&|_| 0.4));
        assert_eq!(round.folds, 0);
    }

    #[test]
    fn folds_along_corner_lines_are_told_from_others() {
        let cloth = Outline::of(regular_outline(8, 1.0).unwrap());
        assert!((cloth.gauge([0.5, 0.0]) / cloth.gauge([0.25, 0.0]) - 2.0).abs() < 1e-14);
        let mut corners = cloth.corners.iter();
        assert!(corners.all(|c| (cloth.gauge(*c) - 1.0).abs() < 1e-14));
        let table = Outline::of(regular_outline(8, 0.5).unwrap());
        let [a, b] = cloth.corners[0];
        let sheet = polygon_rings(&regular_outline(8, 1.0).unwrap(), 24).unwrap();
        // Eight folds that grow from the table on, turned by an angle against the corners.
        let draped = |turn: f64| -> Vec<f64> {
            let positions = sheet.positions().as_chunks::<3>().0.iter();
            let moved = positions.flat_map(|[x, y, z]| {
                let angle = y.atan2(*x) - b.atan2(a) - turn;
                let out = (cloth.gauge([*x, *y]) - 0.5).max(0.0);
                let s = 1.0 + 0.3 * out * (8.0 * angle).cos();
                [s * x, s * y, *z]
            });
            moved.collect()
        };
        let along = |turn: f64| CornerFolds::of(&sheet, &draped(turn), &table, &cloth);
        let found = along(0.0);
        assert_eq!((found.along, found.lines), (8, 8));
        assert!((found.part - 0.5).abs() < 0.1, "{found:?}");
        assert_eq!(along(TAU / 16.0).along, 0);
        // A flat cloth has folds nowhere.
        let flat = CornerFolds::of(&sheet, sheet.positions(), &table, &cloth);
        assert_eq!((flat.along, flat.part), (0, 0.0));
    }
}
