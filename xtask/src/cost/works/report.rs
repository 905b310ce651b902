//! What the rows say.

use super::run::WorkRow;
use crate::cost::DEFAULT;
use crate::draw::{Chart, Charts, Series};
use crate::report::{Bound, Finding, LENGTHS, Table, columns, exponent};
use crate::runs::STEP;
use anyhow::Result;

/// The kinds whose times are fitted and drawn over their sizes, with their names in the chart.
const OVER_SIZES: [(&str, &str); 4] = [
    ("w1", "hanging, rods"),
    ("w1e", "hanging, elastic"),
    ("w2", "table, rods"),
    ("w2e", "table, elastic"),
];

/// Largest relative edge length error of a run that counts as exact: the loosest tolerance that the runs of
/// the report ask for. Programs that let edges stretch are at 1e-5 and above.
const EXACT: f64 = 1e-9;

/// The rows of a table, each compared with the fastest of the same work and size that keeps the lengths.
pub(super) fn table(caption: &str, mut rows: Vec<WorkRow>) -> Result<Table> {
    let all = rows.clone();
    for row in &mut rows {
        let alike = all
            .iter()
            .filter(|r| (&r.work, &r.size) == (&row.work, &row.size));
        let exact = alike
            .filter(|r| r.strain <= EXACT)
            .filter_map(WorkRow::rate);
        let least = exact.reduce(f64::min);
        row.times_fastest_exact = row.rate().zip(least).map(|(rate, least)| rate / least);
    }
    Table::of_fields(caption, rows)
}

/// The runs of the default with its default step, for the README.
pub(super) fn default(rows: &[WorkRow]) -> Table {
    let is_default = |r: &&WorkRow| r.method.as_deref() == Some(DEFAULT) && r.step_s == STEP;
    Table::of(
        "A square sheet that hangs by a corner and moves for one second, in steps of 1/60 s on one core.",
        rows.iter().filter(is_default),
        columns! { r;
            "vertices" => r.vertices,
            "CPU seconds" => r.cpu_s,
            "largest relative error of a length" => r.strain,
            "change of energy, part of that released" => r.energy_balance,
        },
    )
}

/// The rows of a kind that ended, as numbers of vertices with a quantity.
fn points(rows: &[WorkRow], work: &str, value: fn(&WorkRow) -> Option<f64>) -> Vec<[f64; 2]> {
    let of = rows.iter().filter(|r| r.work == work);
    let points = of.filter_map(|r| Some([r.vertices as f64, value(r)?]));
    points.collect()
}

/// Fitted powers over the sizes, by kind.
pub(super) fn powers(rows: &[WorkRow]) -> Table {
    let power =
        |work: &str, value: fn(&WorkRow) -> Option<f64>| exponent(&points(rows, work, value));
    let vertices = |work: &str| {
        let points = points(rows, work, WorkRow::rate);
        let ends = points.first().zip(points.last());
        ends.map(|(first, last)| format!("{} to {}", first[0], last[0]))
    };
    let is_fitted = |(work, _): &(&str, &str)| power(work, WorkRow::rate).is_some();
    Table::of(
        "Fitted powers of the number of vertices V: of the CPU time of whole runs, and of the factorisations of a step",
        OVER_SIZES.into_iter().filter(is_fitted),
        columns! { kind;
            "runs" => kind.1,
            "vertices" => vertices(kind.0),
            "power_of_the_time" => power(kind.0, WorkRow::rate),
            "power_of_the_factorisations" => power(kind.0, WorkRow::factorisations),
        },
    )
}

/// CPU seconds for a simulated second against the number of vertices, by kind.
pub(super) fn chart(rows: &[WorkRow]) -> Charts {
    let mut series = Vec::new();
    for (k, (work, name)) in OVER_SIZES.into_iter().enumerate() {
        series.push(Series::styled(k, name, points(rows, work, WorkRow::rate)));
    }
    series.retain(|s| !s.points.is_empty());
    let (x, y) = ("vertices", "CPU seconds / simulated second");
    let chart = Chart::log_log(x, y, [260.0, 170.0], series);
    chart.into()
}

/// Lengths of rods by the methods of scene files, gaps, and what is checked beside the contact code.
pub(super) fn required(rows: &[WorkRow]) -> Vec<Finding> {
    let files = rows.iter().filter(|r| r.method.is_none());
    let rods: Vec<_> = files
        .filter(|r| r.model == "rods")
        .map(|r| r.strain)
        .collect();
    let of = |value: fn(&WorkRow) -> Option<f64>| rows.iter().filter_map(value).collect::<Vec<_>>();
    let gap = Bound::Above(0.0);
    let all = [
        (
            "rods",
            "largest strain of an edge",
            Bound::AtMost(LENGTHS),
            rods,
        ),
        ("contact", "smallest gap, m", gap, of(|r| r.smallest_gap_m)),
    ];
    let there = all.into_iter().filter(|(.., values)| !values.is_empty());
    let finding = |(of, quantity, bound, values): (&str, &str, _, Vec<f64>)| {
        let values: Vec<_> = values.into_iter().map(Some).collect();
        Finding::worst(of, quantity, bound, &values)
    };
    there.map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Cell, Verdict};

    fn row(work: &str, level: u32, threads: usize, cpu: f64) -> WorkRow {
        WorkRow {
            work: work.to_owned(),
            what_happens: "a sheet".to_owned(),
            size: format!("M^{level}"),
            model: "rods".to_owned(),
            vertices: ((2_usize << level) + 1).pow(2),
            threads,
            cpu_s_per_simulated_s: Some(cpu),
            wall_s_per_simulated_s: Some(cpu),
            factorisations_per_step: Some(5.0),
            strain: 1e-13,
            smallest_gap_m: Some(1e-4),
            ..WorkRow::default()
        }
    }

    #[test]
    fn powers_and_ratios_are_those_of_runs_that_ended() {
        let cost = |level: u32| f64::from((2_u32 << level) + 1).powf(3.0);
        let mut rows: Vec<WorkRow> = (2..=4).map(|k| row("w1", k, 1, cost(k))).collect();
        let text = powers(&rows).text();
        assert!(text.contains("hanging, rods  81 to 1089  1.5 "), "{text}");
        rows[2].failure = Some("late".to_owned());
        let text = powers(&rows).text();
        assert!(text.contains("81 to 289"), "{text}");
        assert_eq!(points(&rows, "w1", WorkRow::rate).len(), 2);
        let verdicts = |rows: &[WorkRow]| -> Vec<Verdict> {
            required(rows).iter().map(Finding::verdict).collect()
        };
        assert_eq!(verdicts(&rows), [Verdict::Passed; 2]);
        rows[0].strain = 1e-9;
        assert_eq!(verdicts(&rows), [Verdict::Failed, Verdict::Passed]);
    }

    /// A run is compared with the fastest that ended on its mesh with its lengths kept.
    #[test]
    fn the_fastest_exact_run_is_the_unit() {
        let run = |level, cpu| row("hanging", level, 1, cpu);
        let (mut loose, mut lost) = (run(1, 0.3), run(1, 0.1));
        loose.strain = 1e-3;
        lost.failure = Some("late".to_owned());
        let rows = [run(1, 0.6), run(1, 1.8), loose, lost, run(2, 0.2)];
        let times = table("", rows.to_vec())
            .unwrap()
            .select("", "times_fastest_exact");
        let number = |row: &Vec<Cell>| match row[0] {
            Cell::Number(value) => Some((1e9 * value).round() / 1e9),
            _ => None,
        };
        let numbers: Vec<Option<f64>> = times.rows.iter().map(number).collect();
        assert_eq!(numbers, [Some(1.0), Some(3.0), Some(0.5), None, Some(1.0)]);
    }
}
