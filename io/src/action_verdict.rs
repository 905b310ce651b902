//! What came of a sheet that drapes, hangs or was crumpled, in words.

use isosheet_mesh::wording::counted;
use isosheet_runs::{EndReason, Recording, Summary};
use isosheet_scenes::bounds;
use nalgebra::{Matrix3, Rotation3, Vector3};

/// The sheet at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ActionVerdict {
    /// The height of its lowest point at the end, metres.
    lowest: f64,
    /// Its extents at the start and at the end along the axes of its mesh, which turn with the sheet, metres.
    sides: [[f64; 3]; 2],
    /// The root mean square distance of its vertices from their middle at the start, the least of all frames,
    /// and that at the end, metres.
    spread: [f64; 3],
    /// Whether it presses on an obstacle at the end.
    is_borne: bool,
    /// Whether its material can yield.
    can_yield: bool,
    /// The height of the highest pinned vertex at the end, metres.
    held: Option<f64>,
    /// The number of vertices, and of vertices that touch something.
    touching: [usize; 2],
    /// The time of the end, seconds.
    t: f64,
    /// The speed of the fastest vertex, m/s, with the number and the place of the one that moved most in the
    /// last frame; none of a sheet at rest.
    moving: Option<(f64, usize, [f64; 3])>,
}

/// A speed that nobody sees, m/s.
const SLOW: f64 = 1e-3;

impl ActionVerdict {
    /// Of a complete run; `None` if there is no frame.
    pub(crate) fn of(recording: &Recording) -> Option<Self> {
        let summary: &Summary = recording.summary.as_ref()?;
        let frames = &recording.trajectory;
        let last = frames.len().checked_sub(1)?;
        let points = |k: usize| frames.frame(k).map(|x| x.as_chunks::<3>().0);
        let (first, end) = (points(0)?, points(last)?);
        let before = points(last.saturating_sub(1))?;
        let moved = |v: &usize| {
            (0..3)
                .map(|k| (end[*v][k] - before[*v][k]).powi(2))
                .sum::<f64>()
        };
        let fastest = (0..end.len()).max_by(|a, b| moved(a).total_cmp(&moved(b)))?;
        let is_at_rest = summary.ending.reason == EndReason::Rest;
        let forces = frames.contact_forces(last).unwrap_or_default();
        let touching = forces.as_chunks::<3>().0.iter().filter(|f| **f != [0.0; 3]);
        let held = recording.pins.iter().map(|v| end[v.index()][2]);
        let placement = recording.scene.scene().sheet.first()?.placement.isometry();
        let axes = placement.rotation.to_rotation_matrix();
        let turned = turn_between(first, end) * axes;
        let spreads = (0..=last).filter_map(points).map(spread);
        let ending = &summary.ending;
        Some(Self {
            lowest: bounds(end)[0][2],
            sides: [sides(first, &axes), sides(end, &turned)],
            spread: [
                spread(first),
                spreads.fold(f64::INFINITY, f64::min),
                spread(end),
            ],
            // The body; a floor is the second obstacle.
            is_borne: ending
                .obstacles
                .first()
                .is_some_and(|force| *force != [0.0; 3]),
            can_yield: ending.plastic.is_some(),
            held: held.reduce(f64::max),
            touching: [end.len(), touching.count()],
            t: summary.ending.t,
            moving: (!is_at_rest).then_some((summary.ending.largest_speed, fastest, end[fastest])),
        })
    }

    /// Of a sheet on a body whose top is at z = 0.
    pub(crate) fn draped(&self) -> String {
        if !self.is_borne {
            return format!(
                "warning: the sheet fell past the body, which does not touch it after {:.2} s; a body that is wide beside \
                 the sheet bears it (`--size`, `--tool-size`)",
                self.t
            );
        }
        let hem = match self.lowest < 0.0 {
            true => format!("the hem hangs {} below the top", length(-self.lowest)),
            false => "no part is below the top".to_owned(),
        };
        format!("draped: {hem}; {}", self.rest_in_words())
    }

    /// Of a sheet that is held.
    pub(crate) fn hung(&self) -> String {
        let below = self.held.unwrap_or(0.0) - self.lowest;
        let low = length(below);
        format!(
            "hangs: its lowest point is {low} below where it is held; {}",
            self.rest_in_words()
        )
    }

    /// Of a sheet that was pushed together.
    pub(crate) fn crumpled(&self) -> String {
        let [from, to] = self.sides.map(|sides| sides.map(length).join(" by "));
        let [start, least, end] = self.spread;
        let what = match (start - end < end - least, self.can_yield) {
            (false, _) => "crumpled",
            (true, false) => "it sprang back, as its material does not yield",
            (true, true) => "it sprang back, as few of its bends were so sharp that they stay",
        };
        format!("{what}: from {from} to {to}; {}", self.rest_in_words())
    }

    /// What touches and what moves.
    fn rest_in_words(&self) -> String {
        let [all, touching] = self.touching;
        let touching = match touching {
            0 => "nothing touches".to_owned(),
            n => format!("{n} of {} touch", counted(all, "vertex", "vertices")),
        };
        let moving = match self.moving {
            None => format!("at rest after {:.2} s", self.t),
            Some((speed, ..)) if speed < SLOW => {
                format!("slower than {} mm/s after {:.2} s", 1e3 * SLOW, self.t)
            }
            Some((speed, v, [x, y, z])) => format!(
                "not at rest after {:.2} s: {:.1} mm/s at most, about vertex {v} at ({x:.3}, {y:.3}, {z:.3}) m",
                self.t,
                1e3 * speed
            ),
        };
        format!("{touching}, {moving}")
    }
}

/// The middle of points.
fn middle(points: &[[f64; 3]]) -> Vector3<f64> {
    let sum: Vector3<f64> = points.iter().map(|p| Vector3::from(*p)).sum();
    sum / points.len() as f64
}

/// The root mean square distance of points from their middle.
fn spread(points: &[[f64; 3]]) -> f64 {
    let middle = middle(points);
    let squares = points
        .iter()
        .map(|p| (Vector3::from(*p) - middle).norm_squared());
    (squares.sum::<f64>() / points.len() as f64).sqrt()
}

/// The extents of points along axes.
fn sides(points: &[[f64; 3]], axes: &Rotation3<f64>) -> [f64; 3] {
    let along: Vec<[f64; 3]> = points
        .iter()
        .map(|p| axes.inverse_transform_vector(&(*p).into()).into())
        .collect();
    let [low, high] = bounds(&along);
    [0, 1, 2].map(|k| high[k] - low[k])
}

/// The rotation that brings points next to others.
fn turn_between(from: &[[f64; 3]], to: &[[f64; 3]]) -> Rotation3<f64> {
    let [a, b] = [from, to].map(middle);
    let pairs = from.iter().zip(to);
    let products: Matrix3<f64> = pairs
        .map(|(p, q)| (Vector3::from(*q) - b) * (Vector3::from(*p) - a).transpose())
        .sum();
    let size = products.norm().max(f64::MIN_POSITIVE);
    Rotation3::from_matrix_eps(&(products / size), 1e-9, 100, Rotation3::identity())
}

/// A length in millimetres below one metre.
fn length(metres: f64) -> String {
    match metres < 1.0 {
        true => format!("{:.0} mm", 1e3 * metres),
        false => format!("{metres:.2} m"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rectangle of 3 by 2 that is turned by 40 degrees about an oblique axis keeps its sides.
    #[test]
    fn sides_are_along_the_axes_of_a_sheet_that_turns() {
        let flat = [[0.0; 3], [3.0, 0.0, 0.0], [3.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        let axis = Vector3::new(0.2, -0.3, 1.0).normalize();
        let turn = Rotation3::new(40_f64.to_radians() * axis);
        let turned = flat.map(|p| (turn * Vector3::from(p) + Vector3::new(5.0, 1.0, 0.0)).into());
        let found = sides(&turned, &turn_between(&flat, &turned));
        for (found, expected) in found.into_iter().zip([3.0, 2.0, 0.0]) {
            assert!((found - expected).abs() < 1e-6, "{found}");
        }
        assert!((spread(&turned) - spread(&flat)).abs() < 1e-12);
    }
}
