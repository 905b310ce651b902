//! Crescent marks: how far the folds of a crumpled sheet concentrate in few edges.

use super::crescent::Crescent;
use super::{Table, degrees, mean, nearest, whole_percent};
use crate::draw::{Axis, Chart, Charts, Colour, Legend, Series, palette};
use crate::report::{Cell, columns};
use isosheet_io::Trajectory;
use isosheet_mesh::{EdgeId, Sheet, fold_angle};
use serde::Serialize;

/// Part of the inner edges that counts as marks.
const SHARPEST: f64 = 0.05;

/// An edge counts as one of the sharpest if its fold angle is at least this part of the last one's: a
/// symmetric sheet has folds that are equal but for round-off.
const TIE: f64 = 0.99;

/// Bends by less than this over an edge are no marks, radians: an eye sees folds from about five degrees on.
const MARK: f64 = 0.1;

/// What this part of the edges would carry if fold angles were normally distributed: E(|x|; |x| > 1.96 s) /
/// E|x| = exp(-1.96^2 / 2).
const NORMAL: f64 = 0.146_5;

/// The concentration of folds over a run.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Marks {
    pub(super) name: String,
    /// Inner edges, and how many of them are the sharpest.
    pub(super) edges: usize,
    pub(super) sharpest: usize,
    /// Time, part of the sum of all sizes of fold angles that the sharpest edges carry then, and the part of
    /// the sharpest edges at the end that are among the sharpest already.
    pub(super) shares: Vec<[f64; 3]>,
    /// The smallest fold angle of the sharpest edges at the end, radians.
    pub(super) least: f64,
    /// Shape of the largest connected mark at the end, if there are marks.
    pub(super) shape: Option<Crescent>,
}

impl Marks {
    pub(super) fn of(name: &str, sheet: &Sheet, trajectory: &Trajectory) -> Self {
        let t = sheet.topology();
        let inner: Vec<EdgeId> = t.edge_ids().filter(|e| !t.is_boundary_edge(*e)).collect();
        let count = ((SHARPEST * inner.len() as f64).round() as usize).max(1);
        let mut frames = Vec::new();
        let (mut shape, mut last_least) = (None, 0.0);
        for k in 0..trajectory.len() {
            let Some(x) = trajectory.frame(k) else {
                continue;
            };
            let fold = |e: &EdgeId| (fold_angle(t, x, *e).unwrap_or(0.0).abs(), *e);
            let mut folds: Vec<(f64, EdgeId)> = inner.iter().map(fold).collect();
            let in_order: Vec<f64> = folds.iter().map(|f| f.0).collect();
            folds.sort_by(|a, b| b.0.total_cmp(&a.0));
            let all: f64 = folds.iter().map(|f| f.0).sum();
            let top: f64 = folds[..count].iter().map(|f| f.0).sum();
            // The sheet starts flat, where there is nothing to share.
            if all > 1e-6 {
                let least = folds[count - 1].0;
                last_least = least;
                let marks = (least >= MARK).then(|| Crescent::largest(sheet, &folds[..count]));
                shape = marks.flatten();
                frames.push((trajectory.times()[k], top / all, least, in_order));
            }
        }
        // The sharpest edges at the end, by their places among the inner ones.
        let last: Vec<usize> = frames.last().map_or(Vec::new(), |(_, _, _, folds)| {
            let mut order: Vec<usize> = (0..folds.len()).collect();
            order.sort_by(|a, b| folds[*b].total_cmp(&folds[*a]));
            order.truncate(count);
            order
        });
        let kept = |least: f64, folds: &[f64]| {
            let sharp = |e: &&usize| folds[**e] >= TIE * least;
            last.iter().filter(sharp).count() as f64 / count as f64
        };
        Self {
            name: name.to_owned(),
            edges: inner.len(),
            sharpest: count,
            shares: frames
                .iter()
                .map(|(t, share, least, folds)| [*t, *share, kept(*least, folds)])
                .collect(),
            least: last_least,
            shape,
        }
    }

    /// Mean of a column from the middle of the run on.
    fn late(&self, column: usize) -> f64 {
        let end = self.shares.last().map_or(0.0, |s| s[0]);
        let late: Vec<f64> = self
            .shares
            .iter()
            .filter(|s| s[0] >= 0.5 * end)
            .map(|s| s[column])
            .collect();
        mean(&late)
    }

    fn at(&self, t: f64, column: usize) -> f64 {
        let at = nearest(self.shares.iter().map(|s| s[0]), t);
        self.shares.get(at).map_or(f64::NAN, |s| s[column])
    }
}

const COLOURS: [Colour; 3] = [palette::VERMILION, palette::GREEN, palette::BLUE];

/// The shares over time of rods and of paper, and how many of the final marks of rods are there already.
pub(super) fn plot([rods, paper]: [&[Marks]; 2]) -> Charts {
    let ends = rods.iter().filter_map(|m| Some(m.shares.last()?[0]));
    let end = ends.fold(0.0, f64::max);
    let panel = |all: &[Marks], label: &str, column: usize, guide: Option<Series>| {
        let of = |(m, colour): (&Marks, Colour)| {
            let points = m.shares.iter().map(|s| [s[0], 100.0 * s[column]]);
            Series::line(&m.name, colour, points.collect())
        };
        let series = all.iter().zip(COLOURS).map(of).chain(guide).collect();
        let x = Axis::linear("time (s)", [0.0, end]);
        let y = Axis::linear(label, [0.0, 100.0]);
        Chart::new(x, y, [165.0, 118.0], series)
    };
    let normal = [0.0, end].map(|t| [t, 100.0 * NORMAL]).to_vec();
    let normal = Some(Series::guide("normal", normal));
    let [left, below] =
        [rods, paper].map(|all| panel(all, "share of fold angle (%)", 1, normal.clone()));
    let right = panel(rods, "final marks present (%)", 2, None).with_legend(Legend::None);
    Charts(vec![vec![left, right], vec![below]])
}

/// A mark is an arc if the circle leaves at most this part of the mean square distance from the line.
const ARC: f64 = 0.5;

/// What the table shows.
const ABOUT: &str = "\
    Marks: the part of the sum of all sizes of fold angles that the sharpest of the inner edges carry, and how many of the edges that are \
    sharpest at the end are among the sharpest earlier (to 1 %, as symmetric folds are equal). Late: mean over the second half of the run. \
    There are marks where all of these edges are bent by a least angle. The largest connected mark at the end is compared, in the flat \
    sheet, with the arc of a crescent: the angle in which the centre of the best circle sees it (a straight fold: near zero), and what is \
    left of its mean square distance from the best line when the line is bent to the circle (a perfect arc: nothing). The last rows: \
    what the sharpest edges would carry if all folds were equal and if they were normally distributed; the least angle of marks, and \
    the most that an arc leaves. Rods have neither bending stiffness nor memory, and the elastic sheet has no memory: no fold is \
    permanent by itself, and the table shows where folds gather and whether they stay there.";

pub(super) fn table(all: &[Marks]) -> Table {
    let shape = |m: &Marks, f: fn(&Crescent) -> String| Cell::from(m.shape.as_ref().map(f));
    let share = |part: f64| Cell::from(whole_percent(part));
    let marks = |m: &Marks, part: f64| Cell::from((m.least >= MARK).then(|| whole_percent(part)));
    let mut table = Table::of(
        ABOUT,
        all,
        columns! { m;
            "mesh" => m.name.as_str(),
            "edges" => format!("{} of {}", m.sharpest, m.edges),
            "share at 0.2 s" => share(m.at(0.2, 1)),
            "share at 0.6 s" => share(m.at(0.6, 1)),
            "share, late" => share(m.late(1)),
            "least of these, end" => degrees(m.least),
            "final marks present at 0.6 s" => marks(m, m.at(0.6, 2)),
            "late" => marks(m, m.late(2)),
            "edges of the largest mark" => shape(m, |c| c.edges.to_string()),
            "opening" => shape(m, |c| format!("{:.0}°", c.opening.to_degrees())),
            "left by the arc" => shape(m, |c| whole_percent(c.straightness)),
            "an arc" => shape(m, |c| { if c.straightness <= ARC { "yes" } else { "no" }.into() }),
        },
    );
    let shares = |part: f64| [2, 3, 4].map(|column| (column, whole_percent(part)));
    table.push_some("equal folds", &shares(SHARPEST));
    table.push_some("normally distributed", &shares(NORMAL));
    table.push_some(
        "marks and arcs",
        &[(5, degrees(MARK)), (10, whole_percent(ARC))],
    );
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate::strip;

    #[test]
    fn one_sharp_fold_carries_everything() {
        // A strip of twenty cells has 39 inner edges, of which two count; it is folded at two rungs.
        let sheet = strip(20, 1.0, 0.1, isosheet_mesh::generate::Diagonals::Rising).unwrap();
        let mut trajectory = Trajectory::new(&sheet);
        let fold = |a: f64| -> Vec<f64> {
            let bend = |s: f64| {
                let (first, second) = (s.min(0.5), (s - 0.5).max(0.0));
                [first + second * a.cos(), second * a.sin()]
            };
            sheet
                .positions()
                .as_chunks::<3>()
                .0
                .iter()
                .flat_map(|p| {
                    let [x, z] = bend(p[0]);
                    [x, p[1], z]
                })
                .collect()
        };
        trajectory.push(0.0, sheet.positions()).unwrap();
        trajectory.push(1.0, &fold(1.0)).unwrap();
        let m = Marks::of("strip", &sheet, &trajectory);
        assert_eq!((m.edges, m.sharpest, m.shares.len()), (39, 2, 1));
        assert!((m.shares[0][1] - 1.0).abs() < 1e-9);
    }
}
