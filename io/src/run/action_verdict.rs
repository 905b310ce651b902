//! What came of a sheet that drapes, hangs or was crumpled, in words.

use super::{EndReason, Recording, Summary};
use crate::scene::bounds;
use isosheet_mesh::wording::counted;

/// The sheet at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ActionVerdict {
    /// Its bounds at the start and at the end, metres.
    pub(crate) bounds: [[[f64; 3]; 2]; 2],
    /// The height of the highest pinned vertex at the end, metres.
    pub(crate) held: Option<f64>,
    /// The number of vertices, and of those that touch something.
    pub(crate) touching: [usize; 2],
    /// The time of the end, seconds.
    pub(crate) t: f64,
    /// The speed of the fastest vertex, m/s, with the number and the place of the one that moved most in the last frame;
    /// none of a sheet at rest.
    pub(crate) moving: Option<(f64, usize, [f64; 3])>,
}

/// A sheet that is slower is at rest, m/s.
const STILL: f64 = 1e-3;

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
        let is_at_rest =
            summary.ending.reason == EndReason::Rest || summary.ending.largest_speed < STILL;
        let forces = frames.contact_forces(last).unwrap_or_default();
        let touching = forces.as_chunks::<3>().0.iter().filter(|f| **f != [0.0; 3]);
        let held = recording.pins.iter().map(|v| end[v.index()][2]);
        Some(Self {
            bounds: [bounds(first), bounds(end)],
            held: held.reduce(f64::max),
            touching: [end.len(), touching.count()],
            t: summary.ending.t,
            moving: (!is_at_rest).then_some((summary.ending.largest_speed, fastest, end[fastest])),
        })
    }

    /// Of a sheet on a body whose top is at z = 0.
    pub(crate) fn draped(&self) -> String {
        let lowest = self.bounds[1][0][2];
        let hem = match lowest < 0.0 {
            true => format!("the hem hangs {} below the top", length(-lowest)),
            false => "no part is below the top".to_owned(),
        };
        format!("draped: {hem}; {}", self.rest_in_words())
    }

    /// Of a sheet that is held.
    pub(crate) fn hung(&self) -> String {
        let below = self.held.unwrap_or(0.0) - self.bounds[1][0][2];
        let low = length(below);
        format!(
            "hangs: its lowest point is {low} below where it is held; {}",
            self.rest_in_words()
        )
    }

    /// Of a sheet that was pushed together.
    pub(crate) fn crumpled(&self) -> String {
        let [from, to] = self.bounds.map(|[low, high]| {
            let sides = [0, 1, 2].map(|k| length(high[k] - low[k]));
            sides.join(" by ")
        });
        format!("crumpled: from {from} to {to}; {}", self.rest_in_words())
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
            Some((speed, v, [x, y, z])) => format!(
                "not at rest after {:.2} s: {:.1} mm/s at most, about vertex {v} at ({x:.3}, {y:.3}, {z:.3}) m",
                self.t,
                1e3 * speed
            ),
        };
        format!("{touching}, {moving}")
    }
}

/// A length in millimetres below one metre.
fn length(metres: f64) -> String {
    match metres < 1.0 {
        true => format!("{:.0} mm", 1e3 * metres),
        false => format!("{metres:.2} m"),
    }
}
