//! What the rows say.

use super::run::{Row, Run};
use crate::draw::{Chart, Charts, Series};
use crate::report::{Bound, Finding, LENGTHS, Table, exponent, rounded, short};
use anyhow::{Context, Result};
use std::path::Path;

/// The columns that the page and the book show.
pub(super) const SHOWN: &str = "work what_happens size vertices model threads starts simulated_s cpu_s wall_s \
    factorisations_per_step largest_over_smallest strain smallest_gap_m peak_bytes ended failure scene";
pub(super) const IN_THE_BOOK: &str = "work what_happens vertices model threads starts simulated_s cpu_s factorisations_per_step \
    strain smallest_gap_m failure";

/// The kinds whose times are fitted and drawn over their sizes, with their names in the chart.
const OVER_SIZES: [(&str, &str); 4] = [
    ("w1", "hanging, rods"),
    ("w1e", "hanging, elastic"),
    ("w2", "table, rods"),
    ("w2e", "table, elastic"),
];

/// All rows.
pub(super) fn table(rows: &[Row]) -> Table {
    Table::of(
        "Whole runs: medians over the starts of CPU and wall seconds and of factorisations a step; the most factorisations of a start over the \
         fewest; largest strain of an edge of rods or of a face of an elastic sheet, smallest gap",
        rows,
        &[
            ("work", &|r| r.work.as_str().into()),
            ("what_happens", &|r| r.title.as_str().into()),
            ("size", &|r| r.size.as_str().into()),
            ("vertices", &|r| r.vertices.into()),
            ("model", &|r| r.model.as_str().into()),
            ("threads", &|r| r.threads.into()),
            ("starts", &|r| r.runs.len().into()),
            ("simulated_s", &|r| r.median(|r| Some(r.course.time)).into()),
            ("cpu_s", &|r| r.median(|r| Some(r.cpu)).into()),
            ("cpu_s_per_simulated_s", &|r| r.rate().into()),
            ("wall_s", &|r| r.median(|r| Some(r.course.cost.wall)).into()),
            ("factorisations_per_step", &|r| r.factorisations().into()),
            ("iterations_per_step", &|r| {
                r.median(|r| r.course.cost.iterations_per_step()).into()
            }),
            ("largest_over_smallest", &|r| r.spread().into()),
            ("most_in_a_step", &|r| {
                r.runs.iter().map(|r| r.course.worst).max().into()
            }),
            ("strain", &|r| r.strain().into()),
            ("smallest_gap_m", &|r| r.gap().into()),
            ("peak_bytes", &|r| r.peak().into()),
            ("ended", &|r| {
                r.runs.iter().filter(|r| r.course.is_good()).count().into()
            }),
            ("failure", &|r| failure(r).into()),
            ("scene", &|r| r.command.as_str().into()),
        ],
    )
}

/// Why a run of a row did not come to its end, of the last one that did not.
fn failure(row: &Row) -> Option<String> {
    let reason = |r: &Run| Some((r.course.time, r.course.failure()?));
    let (time, reason) = row.runs.iter().filter_map(reason).next_back()?;
    Some(format!("at {} s: {}", short(time), rounded(&reason)))
}

/// The rows of a kind at its sizes.
fn of<'a>(rows: &'a [Row], work: &'a str) -> impl Iterator<Item = &'a Row> {
    rows.iter().filter(move |r| r.work == work)
}

/// The rows of a kind that ended, as numbers of vertices with a quantity.
fn points(rows: &[Row], work: &str, value: impl Fn(&Row) -> Option<f64>) -> Vec<[f64; 2]> {
    let ended = of(rows, work).filter(|r| r.is_good());
    ended
        .filter_map(|r| Some([r.vertices as f64, value(r)?]))
        .collect()
}

/// Fitted powers over the sizes, by kind.
pub(super) fn powers(rows: &[Row]) -> Table {
    let caption = "Fitted powers of the number of vertices V: of the CPU time of whole runs, and of the factorisations \
        of a step";
    let of = |work: &str, value: fn(&Row) -> Option<f64>| exponent(&points(rows, work, value));
    let vertices = |work: &str| {
        let points = points(rows, work, Row::rate);
        let ends = points.first().zip(points.last());
        ends.map(|(first, last)| format!("{} to {}", first[0], last[0]))
    };
    let fitted = OVER_SIZES
        .into_iter()
        .filter(|(work, _)| of(work, Row::rate).is_some());
    Table::of(
        caption,
        fitted,
        &[
            ("runs", &|(_, name)| (*name).into()),
            ("vertices", &|(work, _)| vertices(work).into()),
            ("power_of_the_time", &|(work, _)| of(work, Row::rate).into()),
            ("power_of_the_factorisations", &|(work, _)| {
                of(work, Row::factorisations).into()
            }),
        ],
    )
}

/// Wall times on two threads over those on one.
pub(super) fn threads(rows: &[Row]) -> Table {
    let wall = |r: &Row| r.median(|r| r.course.rate()).filter(|_| r.is_good());
    let pairs = rows.chunk_by(|a, b| (&a.work, &a.size) == (&b.work, &b.size));
    let ratio = |pair: &[Row]| match pair {
        [one, two] => Some((two.clone(), wall(two)? / wall(one)?)),
        _ => None,
    };
    Table::of(
        "Wall time of several threads over that of one",
        pairs.filter_map(ratio),
        &[
            ("run", &|(r, _)| r.title.as_str().into()),
            ("vertices", &|(r, _)| r.vertices.into()),
            ("threads", &|(r, _)| r.threads.into()),
            ("part_of_the_time", &|(_, ratio)| (*ratio).into()),
        ],
    )
}

/// CPU seconds for a simulated second against the number of vertices, by kind, and beside them the fastest
/// program of docs/measured-elsewhere.md that stretches edges, on the hanging square.
pub(super) fn chart(rows: &[Row]) -> Result<Charts> {
    let mut series = Vec::new();
    for (k, (work, name)) in OVER_SIZES.into_iter().enumerate() {
        series.push(Series::styled(k, name, points(rows, work, Row::rate)));
    }
    series.push(Series::guide("hanging, XPBD (elsewhere)", elsewhere()?));
    series.retain(|s| !s.points.is_empty());
    let (x, y) = ("vertices", "CPU seconds / simulated second");
    Ok(Charts::column([Chart::log_log(
        x,
        y,
        [260.0, 170.0],
        series,
    )]))
}

/// The page, and the row of its table of the hanging square, with which the chart compares.
const PAGE: &str = "docs/measured-elsewhere.md";
const FASTEST: &str = "| PositionBasedDynamics 2.2 (XPBD) | fastest |";

/// Vertices of the meshes M^2 to M^5, and the seconds for a simulated second that the page has of them.
///
/// # Errors
/// A page that is not there or has no such row.
fn elsewhere() -> Result<Vec<[f64; 2]>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(PAGE);
    let text = std::fs::read_to_string(path).context(PAGE)?;
    let row = text.lines().find_map(|line| line.strip_prefix(FASTEST));
    let row = row.with_context(|| format!("{PAGE} has no row {FASTEST}"))?;
    let cells = row.trim_end_matches('|').split('|').map(str::trim);
    let seconds = |cell: &str| cell.split(',').next()?.parse().ok();
    let levels = cells.zip(2..).filter_map(|(cell, level): (&str, u32)| {
        let side = f64::from((2_u32 << level) + 1);
        Some([side * side, seconds(cell)?])
    });
    Ok(levels.collect())
}

/// Lengths of rods, the limit of the strain of elastic sheets, gaps.
pub(super) fn required(rows: &[Row]) -> Vec<Finding> {
    let of = |model: &str| rows.iter().filter(|r| r.model == model).collect::<Vec<_>>();
    let gaps: Vec<_> = rows.iter().filter_map(Row::gap).map(Some).collect();
    let rods: Vec<_> = of("rods").iter().map(|r| Some(r.strain())).collect();
    let mut all = Vec::new();
    if !rods.is_empty() {
        let bound = Bound::AtMost(LENGTHS);
        all.push(Finding::worst(
            "rods",
            "largest strain of an edge",
            bound,
            &rods,
        ));
    }
    if !gaps.is_empty() {
        let bound = Bound::Above(0.0);
        all.push(Finding::worst("contact", "smallest gap, m", bound, &gaps));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Verdict;
    use crate::runs::{Course, Ending};

    fn row(work: &str, level: u32, threads: usize, cpu: f64) -> Row {
        let mut course = Course {
            time: 1.0,
            gap: Some(1e-4),
            ..Course::default()
        };
        (course.cost.steps, course.cost.factorisations) = (10, 50);
        (course.cost.wall, course.strain) = (cpu, 1e-13);
        let json = serde_json::json!({
            "work": work, "title": "a sheet", "size": format!("M^{level}"), "model": "rods",
            "vertices": ((2_usize << level) + 1).pow(2), "threads": threads, "command": "scene",
            "runs": [{ "course": course, "cpu": cpu, "strain": 1e-13, "peak": null }],
        });
        serde_json::from_value(json).unwrap()
    }

    #[test]
    fn powers_and_ratios_are_those_of_runs_that_ended() {
        let cost = |level: u32| f64::from((2_u32 << level) + 1).powf(3.0);
        let mut rows: Vec<Row> = (2..=4).map(|k| row("w1", k, 1, cost(k))).collect();
        rows.extend([row("ball", 2, 1, 4.0), row("ball", 2, 2, 3.0)]);
        let text = powers(&rows).text();
        assert!(text.contains("hanging, rods  81 to 1089  1.5 "), "{text}");
        let text = threads(&rows).text();
        assert!(
            text.ends_with("a sheet  81        2        0.75\n"),
            "{text}"
        );
        rows[2].runs[0].course.ending = Ending::WallTime(60.0);
        let text = powers(&rows).text();
        assert!(text.contains("81 to 289"), "{text}");
        assert_eq!(points(&rows, "w1", Row::rate).len(), 2);
        let verdicts = |rows: &[Row]| -> Vec<Verdict> {
            required(rows).iter().map(Finding::verdict).collect()
        };
        assert_eq!(verdicts(&rows), [Verdict::Passed; 2]);
        rows[0].runs[0].strain = 1e-9;
        assert_eq!(verdicts(&rows), [Verdict::Failed, Verdict::Passed]);
    }

    /// The chart compares with numbers that stand in the book alone.
    #[test]
    fn the_book_has_the_fastest_program() {
        let points = elsewhere().unwrap();
        let vertices: Vec<f64> = points.iter().map(|p| p[0]).collect();
        assert_eq!(vertices, [81.0, 289.0, 1089.0, 4225.0]);
        assert!(points.iter().all(|p| p[1] > 0.0));
    }
}
