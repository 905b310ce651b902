//! `condition-table`: condition numbers of the mass matrix in three charts, by mesh level.

use crate::draw::{
    Axis, Chart, Charts, Colour, Legend, Marker, Series, Vector, mesh_name, palette,
};
use crate::interrupt;
use crate::progress::Progress;
use crate::report::{Bound, Cell, Effort, Finding, Part, Table, columns, demand, excerpt};
use crate::store::{Remake, Store};
use anyhow::Result;
use clap::Args;
use isosheet_coords::{BentState, ConditionRow, TableChart, condition_table};
use std::path::PathBuf;

const STATES: [BentState; 2] = [BentState::Noise, BentState::Cylinder];

const CHARTS: [(TableChart, &str, Colour, Marker); 3] = [
    (
        TableChart::FrontCorner,
        "front, corner",
        palette::VERMILION,
        Marker::Square,
    ),
    (
        TableChart::FrontCentre,
        "front, centre",
        palette::ORANGE,
        Marker::Triangle,
    ),
    (
        TableChart::Cartesian,
        "chosen Cartesian",
        palette::BLUE,
        Marker::Disc,
    ),
];

/// Arguments of `condition-table`.
#[derive(Debug, Args)]
pub(crate) struct ConditionArgs {
    /// Finest mesh, M^LEVEL
    #[arg(long, value_name = "LEVEL", default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=5))]
    level: u32,

    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/condition-table")]
    out: PathBuf,
}

/// Runs the command.
pub(crate) fn run(args: &ConditionArgs) -> Result<()> {
    let store = Store::of_report(&args.out, "condition-table", Effort::Standard, Remake::Once)?;
    let bar = Progress::start("condition numbers", args.level as usize + 1);
    let mut rows = Vec::new();
    for level in 0..=args.level {
        interrupt::check()?;
        rows.extend(condition_table([level])?);
        bar.step();
    }
    bar.finish("computed");
    table(&rows).write_to(&store.path("condition.csv"))?;
    let title = "Condition number of the mass matrix against the mesh level in three charts";
    store.write("condition.svg", plot(&rows).to_svg(title).as_bytes())?;
    excerpt::write(
        &store,
        "condition-table",
        vec![Part::table("table", &table(&rows))],
    )?;
    print!("{}", table(&rows).text());
    for file in ["condition.csv", "condition.svg"] {
        println!("{}", store.path(file).display());
    }
    let chosen = rows.iter().filter(|r| r.chart == TableChart::Cartesian);
    let worst = chosen.map(|r| r.condition).fold(0.0, f64::max);
    let mut finding = Finding::new("condition number", worst, Bound::AtMost(WELL));
    finding.of = "chosen Cartesian coordinates".to_owned();
    demand([("condition-table", &finding)])
}

/// Largest condition number of well-conditioned coordinates: ten digits are left of a solve.
const WELL: f64 = 1e6;

fn of(
    rows: &[ConditionRow],
    state: BentState,
    chart: TableChart,
) -> impl Iterator<Item = &ConditionRow> {
    rows.iter()
        .filter(move |r| r.state == state && r.chart == chart)
}

/// The table for people: noise / cylinder in each cell.
fn table(rows: &[ConditionRow]) -> Table {
    let at = |level, state, chart| of(rows, state, chart).find(|r| r.level == level);
    let cell = |level: u32, chart| {
        let conditions = STATES.map(|state| {
            let row = at(level, state, chart);
            row.map_or(String::new(), |r| format!("{:.0e}", r.condition))
        });
        Cell::from(conditions.join(" / "))
    };
    let meshes = of(rows, BentState::Noise, TableChart::Cartesian);
    Table::of(
        "cond(C) for a bent sheet (out-of-plane noise / cylinder)",
        meshes,
        columns! { r;
            "mesh" => format!("M^{} {}/{}", r.level, r.vertices, r.faces),
            CHARTS[0].1 => cell(r.level, CHARTS[0].0),
            CHARTS[1].1 => cell(r.level, CHARTS[1].0),
            CHARTS[2].1 => cell(r.level, CHARTS[2].0),
        },
    )
}

/// The table as a plot, one panel for each state.
pub(crate) fn plot(rows: &[ConditionRow]) -> Charts {
    let last = rows.iter().map(|r| r.level).max().unwrap_or(0);
    let all = || rows.iter().map(|r| r.condition).chain([1.0]);
    let ends = [-0.2, f64::from(last) + 0.2];
    let panel = |(state, title): (BentState, &str)| {
        let of_chart = |(chart, name, colour, marker): &(_, &str, Colour, Marker)| {
            let points = of(rows, state, *chart).map(|r| [f64::from(r.level), r.condition]);
            Series::line(name, *colour, points.collect()).marked(*marker)
        };
        let mut series: Vec<Series> = CHARTS.iter().map(of_chart).collect();
        let limit = ends.map(|x| [x, 1.0 / f64::EPSILON]).to_vec();
        series.push(Series::guide("1/ε of f64", limit));
        let ticks = (0..=last).map(|k| (f64::from(k), mesh_name(k)));
        let x = Axis::named("mesh", ends, ticks.collect());
        let y = Axis::decades("condition number of C", all());
        Chart::new(x, y, [170.0, 150.0], series).titled(title)
    };
    let noise = panel((BentState::Noise, "out-of-plane noise"));
    let cylinder = panel((BentState::Cylinder, "bent to a cylinder"));
    Charts::row([noise.with_legend(Legend::None), cylinder])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fronts_are_worse_and_the_files_say_so() {
        let rows = condition_table([0, 1]).unwrap();
        let value = |chart| {
            of(&rows, BentState::Noise, chart)
                .last()
                .map_or(f64::NAN, |r| r.condition)
        };
        assert!(value(TableChart::FrontCorner) > 100.0 * value(TableChart::Cartesian));
        assert!(table(&rows).text().contains("M^1 25/32"));
        assert!(plot(&rows).to_svg("t").contains("front, corner"));
    }
}
