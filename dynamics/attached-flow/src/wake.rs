//! The wake of a lattice, and what else the flow remembers.

use super::lattice::{Lattice, Trailing};
use super::vortex::segment;
use isosheet_dynamics::Wind;
use nalgebra::Vector3;

/// Part of the way of the air in a step by which a line of the wake is behind the trailing edges that shed
/// it: the place of a vortex that acts at an edge as one that is spread over the way.
const BEHIND: f64 = 0.25;

/// What the flow remembers of the past, which is a list of numbers in simulations and checkpoints.
///
/// The wake is made of lines of vortices, and of rows of vortex rings between each line and the next one. It
/// moves with the wind, straight on: it does not roll up.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Past {
    size: Size,
    /// Time of the last step and of the one before, seconds.
    pub(super) times: [f64; 2],
    /// Circulation of each face at these times, square metres per second.
    pub(super) circulations: [Vec<f64>; 2],
    /// Its rate of change at the last time, square metres per square second.
    pub(super) rate: Vec<f64>,
    /// Points, metres: where the trailing edges were at the last time, and one line after the other.
    lines: Vec<Vector3<f64>>,
    /// Circulations, one row after the other.
    rows: Vec<f64>,
}

/// How long lists are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Size {
    faces: usize,
    points: usize,
    edges: usize,
    /// The number of rows of the wake.
    rows: usize,
}

impl Size {
    pub(super) fn of(lattice: &Lattice, rows: usize) -> Self {
        Self {
            faces: lattice.faces.len(),
            points: lattice.shedding.len(),
            edges: lattice.trailing.len(),
            rows,
        }
    }

    /// The number of points of all lines.
    fn lines(self) -> usize {
        self.points * (self.rows + 2)
    }

    /// The number of numbers.
    pub(super) fn len(self) -> usize {
        2 + 3 * self.faces + 3 * self.lines() + self.edges * self.rows
    }
}

impl Past {
    /// Without a wake: all lines where the trailing edges are.
    pub(super) fn at_start(
        size: Size,
        t: f64,
        circulation: Vec<f64>,
        edge: &[Vector3<f64>],
    ) -> Self {
        Self {
            size,
            times: [t, t],
            rate: vec![0.0; size.faces],
            circulations: [circulation.clone(), circulation],
            lines: edge.repeat(size.rows + 2),
            rows: vec![0.0; size.edges * size.rows],
        }
    }

    /// Of a list of numbers.
    pub(super) fn read(size: Size, numbers: &[f64]) -> Self {
        let (times, rest) = numbers.split_at(2);
        let (circulations, rest) = rest.split_at(2 * size.faces);
        let (rate, rest) = rest.split_at(size.faces);
        let (lines, rows) = rest.split_at(3 * size.lines());
        let (last, before) = circulations.split_at(size.faces);
        let points = lines.as_chunks::<3>().0.iter();
        Self {
            size,
            times: [times[0], times[1]],
            circulations: [last.to_vec(), before.to_vec()],
            rate: rate.to_vec(),
            lines: points.map(|p| Vector3::from(*p)).collect(),
            rows: rows.to_vec(),
        }
    }

    /// As a list of numbers.
    pub(super) fn write(&self, numbers: &mut [f64]) {
        let [last, before] = &self.circulations;
        let lines = self.lines.iter().flatten();
        let lists = last.iter().chain(before).chain(&self.rate).chain(lines);
        let all = self.times.iter().chain(lists).chain(&self.rows);
        for (number, value) in numbers.iter_mut().zip(all) {
            *number = *value;
        }
    }

    /// The wake after some time (seconds) in the wind.
    pub(super) fn carried(&self, wind: &Wind, span: f64) -> Self {
        let half = self.times[0] + 0.5 * span;
        let velocity = |p: &Vector3<f64>| Vector3::from(wind.velocity((*p).into(), half));
        let lines = self.lines.iter().map(|p| p + span * velocity(p));
        Self {
            lines: lines.collect(),
            ..self.clone()
        }
    }

    /// The wake with a line more behind the trailing edges, which are at these points now, and a row that has
    /// their circulation of the last time.
    pub(super) fn grown(&self, edge: &[Vector3<f64>], trailing: &[Trailing]) -> Self {
        let (last, old) = self.lines.split_at(self.size.points);
        let line = edge.iter().zip(last).map(|(e, l)| e + BEHIND * (l - e));
        let row = trailing.iter().map(|t| self.circulations[0][t.face]);
        Self {
            lines: edge
                .iter()
                .copied()
                .chain(line)
                .chain(old.iter().copied())
                .collect(),
            rows: row.chain(self.rows.iter().copied()).collect(),
            ..self.clone()
        }
    }

    /// The line next to the trailing edges.
    pub(super) fn first_line(&self) -> &[Vector3<f64>] {
        &self.lines[self.size.points..2 * self.size.points]
    }

    /// Velocity at a point by all rows.
    pub(super) fn velocity(
        &self,
        at: &Vector3<f64>,
        trailing: &[Trailing],
        core: f64,
    ) -> Vector3<f64> {
        let Size { points, edges, .. } = self.size;
        let count = self.rows.len() / edges;
        let mut sum = Vector3::zeros();
        let mut add = |a: usize, b: usize, circulation: f64| {
            if circulation != 0.0 {
                let ends = [&self.lines[a], &self.lines[b]];
                sum += circulation * segment(at, ends, core);
            }
        };
        for row in 0..count {
            let (near, far) = (points * (row + 1), points * (row + 2));
            for (k, Trailing { points: [p, q], .. }) in trailing.iter().enumerate() {
                let own = self.rows[row * edges + k];
                let behind = self.rows.get((row + 1) * edges + k).copied();
                if row == 0 {
                    add(near + q, near + p, own);
                }
                add(near + p, far + p, own);
                add(far + p, far + q, own - behind.unwrap_or(0.0));
                add(far + q, near + q, own);
            }
        }
        sum
    }

    /// The past at a time (seconds) at the end of a step by which the wake has been carried and has grown.
    /// The last rows become one.
    pub(super) fn settled(mut self, t: f64, circulation: Vec<f64>) -> Self {
        let [last, before] = &self.circulations;
        let [t0, t1] = self.times;
        let span = t - t0;
        // The formula of BDF2, and of implicit Euler after the start.
        let [back, part] = match t0 > t1 {
            true => {
                let ratio = span / (t0 - t1);
                [ratio * ratio, 1.0 + ratio].map(|c| c / (1.0 + 2.0 * ratio))
            }
            false => [0.0, 1.0],
        };
        let rate = circulation.iter().zip(last.iter().zip(before));
        let rate = rate.map(|(c, (c0, c1))| (c - c0 - back * (c0 - c1)) / (part * span));
        self.rate = rate.collect();
        let [last, _] = std::mem::take(&mut self.circulations);
        self.circulations = [circulation, last];
        self.times = [t, t0];
        self.merge_last();
        self
    }

    /// Takes the line between the last two rows away: they become one, of their mean circulation.
    fn merge_last(&mut self) {
        let Size {
            points,
            edges,
            rows,
            ..
        } = self.size;
        let line = |k: usize| &self.lines[points * k..points * (k + 1)];
        let length = |row: usize| -> f64 {
            let pairs = line(row + 1).iter().zip(line(row + 2));
            pairs.map(|(a, b)| (a - b).norm()).sum()
        };
        let (inner, outer) = (length(rows - 1), length(rows));
        let share = if inner + outer > 0.0 {
            inner / (inner + outer)
        } else {
            1.0
        };
        for k in 0..edges {
            let (near, far) = (edges * (rows - 1) + k, edges * rows + k);
            self.rows[near] = share * self.rows[near] + (1.0 - share) * self.rows[far];
        }
        self.rows.truncate(edges * rows);
        let far = self.lines.split_off(points * (rows + 2));
        self.lines.truncate(points * (rows + 1));
        self.lines.extend(far);
    }
}
