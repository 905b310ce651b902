//! `condition-table`: condition numbers of the mass matrix in three charts, by mesh level.

use crate::draw::{
    Axis, Chart, Charts, Colour, Legend, Marker, Series, Vector, mesh_name, palette,
};
use crate::interrupt;
use crate::progress::Progress;
use crate::report::{Cell, Effort, Part, Table, excerpt};
use crate::store::{Remake, Store};
use anyhow::Result;
use clap::Args;
use isosheet_coords::{BentState, ConditionRow, TableChart, condition_table};
use std::path::PathBuf;

const STATES: [(BentState, &str); 2] = [
    (BentState::Noise, "noise"),
    (BentState::Cylinder, "cylinder"),
];

const CHARTS: [(TableChart, &str, &str, Colour, Marker); 3] = [
    (
        TableChart::FrontCorner,
        "front_corner",
        "front, corner",
        palette::VERMILION,
        Marker::Square,
    ),
    (
        TableChart::FrontCentre,
        "front_centre",
        "front, centre",
        palette::ORANGE,
        Marker::Triangle,
    ),
    (
        TableChart::Cartesian,
        "cartesian",
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
    data(&rows).write_to(&store.path("condition.csv"))?;
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
    Ok(())
}

fn of(
    rows: &[ConditionRow],
    state: BentState,
    chart: TableChart,
) -> impl Iterator<Item = &ConditionRow> {
    rows.iter()
        .filter(move |r| r.state == state && r.chart == chart)
}

/// All numbers, for programs.
fn data(rows: &[ConditionRow]) -> Table {
    let all = STATES.iter().flat_map(|(state, name)| {
        let of_chart = |(chart, file, ..): &(TableChart, &'static str, &str, Colour, Marker)| {
            let row = |r| (r, *name, *file);
            of(rows, *state, *chart).map(row).collect::<Vec<_>>()
        };
        CHARTS.iter().flat_map(of_chart).collect::<Vec<_>>()
    });
    Table::of(
        "",
        all,
        &[
            ("level", &|(r, ..)| r.level.into()),
            ("vertices", &|(r, ..)| r.vertices.into()),
            ("faces", &|(r, ..)| r.faces.into()),
            ("state", &|(_, state, _)| (*state).into()),
            ("chart", &|(.., chart)| (*chart).into()),
            ("condition", &|(r, ..)| r.condition.into()),
        ],
    )
}

/// The table for people: noise / cylinder in each cell.
fn table(rows: &[ConditionRow]) -> Table {
    let at = |level, state, chart| of(rows, state, chart).find(|r| r.level == level);
    let cell = |level: u32, chart| {
        let conditions = STATES.map(|(state, _)| {
            let row = at(level, state, chart);
            row.map_or(String::new(), |r| format!("{:.0e}", r.condition))
        });
        Cell::from(conditions.join(" / "))
    };
    let meshes = of(rows, BentState::Noise, TableChart::Cartesian);
    Table::of(
        "cond(C) for a bent sheet (out-of-plane noise / cylinder)",
        meshes,
        &[
            ("mesh", &|r| {
                format!("M^{} {}/{}", r.level, r.vertices, r.faces).into()
            }),
            (CHARTS[0].2, &|r| cell(r.level, CHARTS[0].0)),
            (CHARTS[1].2, &|r| cell(r.level, CHARTS[1].0)),
            (CHARTS[2].2, &|r| cell(r.level, CHARTS[2].0)),
        ],
    )
}

/// The table as a plot, one panel for each state.
pub(crate) fn plot(rows: &[ConditionRow]) -> Charts {
    let last = rows.iter().map(|r| r.level).max().unwrap_or(0);
    let all = || rows.iter().map(|r| r.condition).chain([1.0]);
    let ends = [-0.2, f64::from(last) + 0.2];
    let panel = |(state, title): (BentState, &str)| {
        let of_chart = |(chart, _, name, colour, marker): &(_, _, &str, Colour, Marker)| {
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
        let csv = String::from_utf8(data(&rows).csv().unwrap()).unwrap();
        assert_eq!(csv.lines().count(), 1 + 2 * 3 * 2);
        assert!(csv.contains("1,25,32,cylinder,cartesian,"));
        assert!(table(&rows).text().contains("M^1 25/32"));
        assert!(plot(&rows).to_svg("t").contains("front, corner"));
    }
}
