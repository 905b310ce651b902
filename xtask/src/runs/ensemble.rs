//! Ensembles: a run and its neighbours, the same scene from starts that differ by a small part of an edge.
//! Sheets that fall, buckle and crumple do so in another way each time, so that one run alone says little.

use super::{FigureScene, Run, displaced};
use crate::draw::Series;
use crate::progress::Progress;
use crate::report::{Effort, extremes, median};
use crate::store::{Store, Unit};
use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::json;

/// Random displacements of the starts of neighbours, mean edge lengths: a fiftieth of a millimetre on M^3 of
/// a sheet as wide as A4.
const BUMP: f64 = 1e-3;

/// Members of an ensemble where a run takes seconds, and with quick runs.
const MEMBERS: [usize; 2] = [12, 3];

/// What was measured of a run and of its neighbours.
#[derive(Clone, Debug)]
pub(crate) struct Ensemble<T> {
    members: Vec<T>,
}

/// How many members an ensemble has where a run takes seconds: the run that is shown alone, unless the report
/// has all the time that it takes.
pub(crate) fn members(effort: Effort) -> usize {
    let [many, quick] = MEMBERS;
    effort.pick(quick, 1, many)
}

/// What ensembles are, for the captions of tables.
pub(crate) fn about_ensembles() -> String {
    format!(
        "Numbers with a range are medians, leasts and greatests of ensembles: of the run that is shown and of neighbours, whose \
         starts differ from it by random displacements of up to {:.1} % of an edge.",
        100.0 * BUMP
    )
}

impl<T: Serialize + DeserializeOwned + Send> Ensemble<T> {
    /// Measures a run, which is the first member, and its neighbours, which are made side by side on the
    /// threads that rayon has and of which nothing else is kept. No number depends on how many threads there
    /// are.
    ///
    /// # Errors
    /// [`Interrupted`](crate::interrupt::Interrupted) after Ctrl-C; errors of the simulation and of
    /// `measure`.
    pub(crate) fn of(
        store: &Store,
        run: &Run,
        members: usize,
        measure: impl Fn(&Run) -> Result<T> + Sync,
    ) -> Result<Self> {
        let name = run.scene.name();
        let title = format!("neighbours of {name}");
        let unit = Unit {
            name: format!("neighbours-{name}"),
            title: title.clone(),
            options: json!({ "scene": run.scene.options(), "members": members }),
        };
        if members == 1 {
            let members = vec![measure(run)?];
            return Ok(Self { members });
        }
        let neighbours: Vec<T> = store.keep(&unit, |_| {
            let bar = Progress::start(title, members - 1);
            let one = |seed: usize| {
                let measured = measure(&Run::passing(neighbour(&run.scene, seed as u64)?)?);
                bar.step();
                measured
            };
            let seeds = (2..members + 1).into_par_iter().with_max_len(1);
            let all = seeds.map(one).collect::<Result<Vec<T>>>()?;
            bar.finish(&format!("{} runs", all.len()));
            Ok(all)
        })?;
        let members = [measure(run)?].into_iter().chain(neighbours).collect();
        Ok(Self { members })
    }
}

/// The scene from another start. A scene that has an uneven start of its own has that of seed 1.
fn neighbour(scene: &FigureScene, seed: u64) -> Result<FigureScene> {
    scene.edited(scene.name(), &[displaced(BUMP, seed)])
}

impl<T> Ensemble<T> {
    /// Number of members.
    pub(crate) fn len(&self) -> usize {
        self.members.len()
    }

    /// Median and extremes of a number of the members.
    pub(crate) fn spread(&self, value: impl Fn(&T) -> f64) -> Spread {
        Spread::of(self.members.iter().map(value))
    }

    /// The median of a number of the members.
    pub(crate) fn median(&self, value: impl Fn(&T) -> f64) -> f64 {
        self.spread(value).median
    }
}

/// The median of some numbers, and the least and the greatest of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    pub(crate) median: f64,
    pub(crate) range: [f64; 2],
}

impl Spread {
    /// Of some numbers; zeros of none.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        Self {
            range: extremes(values.iter().copied()).unwrap_or_default(),
            median: median(values).unwrap_or_default(),
        }
    }

    /// In words: `3.1 (2.9–4.2)`, or the median alone where all are the same as far as they are shown.
    pub(crate) fn text(&self, show: impl Fn(f64) -> String) -> String {
        let [low, high] = self.range.map(&show);
        let median = show(self.median);
        match low == high {
            true => median,
            false => format!("{median} ({low}–{high})"),
        }
    }
}

/// Medians with error bars from the least to the greatest value, each at its place on the horizontal axis, as
/// the series `k` of a chart.
pub(crate) fn spreads(
    k: usize,
    name: &str,
    all: impl IntoIterator<Item = (f64, Spread)>,
) -> Series {
    let all = all.into_iter().map(|(x, s)| ([x, s.median], s.range));
    let (points, bars) = all.unzip();
    Series::styled(k, name, points).with_bars(bars)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Remake;

    #[test]
    fn spreads_are_medians_with_extremes() {
        let spread = Spread::of([3.0, 1.0, 10.0, 2.0].into_iter());
        assert_eq!((spread.median, spread.range), (2.5, [1.0, 10.0]));
        assert_eq!(spread.text(|v| format!("{v:.1}")), "2.5 (1.0–10.0)");
        let same = Spread::of([1.01, 0.99].into_iter());
        assert_eq!(same.text(|v| format!("{v:.1}")), "1.0");
    }

    /// Neighbours part from the run that is shown and from each other, and are the same on any number of
    /// threads.
    #[test]
    fn members_differ_and_do_not_depend_on_threads() {
        let quick = ["stop.time=0.2".to_owned()];
        let scene = FigureScene::of("fig11", "ensemble", &quick).unwrap();
        let measure = |threads: usize| {
            let folder = tempfile::tempdir().unwrap();
            let store = Store::open(folder.path(), "test", Effort::Quick, Remake::Never);
            let store = store.unwrap();
            let run = Run::of(&store, scene.clone()).unwrap();
            let ends = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap()
                .install(|| Ensemble::of(&store, &run, 3, |run| Ok(run.end().to_vec())));
            ends.unwrap().members
        };
        let [one, two] = [1, 2].map(measure);
        assert_eq!(one, two);
        let apart = |a: &[f64], b: &[f64]| isosheet_tests::max_difference(a, b);
        for [a, b] in [[0, 1], [0, 2], [1, 2]] {
            let distance = apart(&one[a], &one[b]);
            assert!(
                distance > 1e-6 && distance < 0.1,
                "{a} and {b}: {distance:e} m"
            );
        }
    }
}
