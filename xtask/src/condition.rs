//! `condition-table`: condition numbers of the mass matrix in three charts, by mesh level.

use crate::cli::ConditionArgs;
use crate::draw::Anchor;
use crate::draw::{
    Axis, Colour, Drawing, Legend, Line, Marker, Plot, Series, TEXT, Vertical, palette, row,
};
use crate::progress::Progress;
use crate::store::Store;
use crate::{Outcome, interrupt};
use anyhow::Result;
use isosheet_coords::{BentState, ConditionRow, TableChart, condition_table};
use std::fmt::Write;

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

/// Runs the command.
pub(crate) fn run(args: &ConditionArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let bar = Progress::start("condition numbers", args.level as usize + 1);
    let mut rows = Vec::new();
    for level in 0..=args.level {
        if interrupt::requested() {
            return Ok(Outcome::Interrupted);
        }
        rows.extend(condition_table([level])?);
        bar.step();
    }
    bar.finish("computed");
    store.write("condition.csv", csv(&rows).as_bytes())?;
    let title = "Condition number of the mass matrix against the mesh level in three charts";
    store.write("condition.svg", plot(&rows).to_svg(title)?.as_bytes())?;
    print!("{}", text(&rows));
    println!("{}", store.root().join("condition.csv").display());
    println!("{}", store.root().join("condition.svg").display());
    Ok(Outcome::Complete)
}

fn of(
    rows: &[ConditionRow],
    state: BentState,
    chart: TableChart,
) -> impl Iterator<Item = &ConditionRow> {
    rows.iter()
        .filter(move |r| r.state == state && r.chart == chart)
}

fn csv(rows: &[ConditionRow]) -> String {
    let mut out = String::from("level,vertices,faces,state,chart,condition\n");
    for (state, state_name) in STATES {
        for (chart, chart_name, ..) in CHARTS {
            for r in of(rows, state, chart) {
                // Writing to a string cannot fail.
                let _ = writeln!(
                    out,
                    "{},{},{},{state_name},{chart_name},{:e}",
                    r.level, r.vertices, r.faces, r.condition
                );
            }
        }
    }
    out
}

/// The table for people: noise / cylinder in each cell.
fn text(rows: &[ConditionRow]) -> String {
    let mut out = String::from("cond(C) for a bent sheet (out-of-plane noise / cylinder)\n");
    let _ = write!(out, "{:<14}", "mesh");
    for (_, _, name, ..) in CHARTS {
        let _ = write!(out, "{name:<22}");
    }
    out.push('\n');
    let mut levels: Vec<u32> = rows.iter().map(|r| r.level).collect();
    levels.dedup();
    for level in levels {
        let at = |state, chart| of(rows, state, chart).find(|r| r.level == level);
        let Some(first) = at(BentState::Noise, TableChart::Cartesian) else {
            continue;
        };
        let _ = write!(
            out,
            "{:<14}",
            format!("M^{level} {}/{}", first.vertices, first.faces)
        );
        for (chart, ..) in CHARTS {
            let cell = STATES.map(|(state, _)| {
                at(state, chart).map_or(String::new(), |r| format!("{:.0e}", r.condition))
            });
            let _ = write!(out, "{:<22}", cell.join(" / "));
        }
        out.push('\n');
    }
    out
}

/// Last decade of the axis and decades between ticks.
fn decades(rows: &[ConditionRow]) -> (i32, usize) {
    let largest = rows.iter().map(|r| r.condition).fold(1.0, f64::max).log10();
    let step = [2, 5, 10, 20, 50]
        .into_iter()
        .find(|s| largest <= 6.0 * f64::from(*s))
        .unwrap_or(100);
    (
        step * (largest / f64::from(step)).ceil().max(1.0) as i32,
        step as usize,
    )
}

/// The table as a plot, one panel for each state.
pub(crate) fn plot(rows: &[ConditionRow]) -> Drawing {
    let last = rows.iter().map(|r| r.level).max().unwrap_or(0);
    let (top, every) = decades(rows);
    let panels: Vec<Drawing> = STATES
        .iter()
        .enumerate()
        .map(|(k, (state, _))| {
            let mut series: Vec<Series> = CHARTS
                .iter()
                .map(|(chart, _, name, colour, marker)| Series {
                    name: (*name).to_owned(),
                    points: of(rows, *state, *chart)
                        .map(|r| [f64::from(r.level), r.condition])
                        .collect(),
                    colour: *colour,
                    marker: Some(*marker),
                    line: Line::Solid,
                })
                .collect();
            series.push(Series {
                name: "1/ε of f64".into(),
                points: vec![
                    [-0.2, 1.0 / f64::EPSILON],
                    [f64::from(last) + 0.2, 1.0 / f64::EPSILON],
                ],
                colour: palette::GREY,
                marker: None,
                line: Line::Dashed,
            });
            let ticks = (0..=last)
                .map(|k| (f64::from(k), format!("~M~^{{{k}}}")))
                .collect();
            let plot = Plot {
                x: Axis::linear("mesh", [-0.2, f64::from(last) + 0.2], ticks),
                y: Axis::decades("condition number of ~C~", 0, top, every),
                size: [170.0, 150.0],
                series,
                legend: if k + 1 == STATES.len() {
                    Legend::Right
                } else {
                    Legend::None
                },
            };
            let mut d = plot.draw();
            let title = ["out-of-plane noise", "bent to a cylinder"][k];
            d.text(
                [85.0, 158.0],
                title,
                TEXT,
                Anchor::Middle,
                Vertical::Above,
                palette::INK,
            );
            d
        })
        .collect();
    row(&panels, 24.0)
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
        let csv = csv(&rows);
        assert_eq!(csv.lines().count(), 1 + 2 * 3 * 2);
        assert!(csv.contains("1,25,32,cylinder,cartesian,"));
        assert!(text(&rows).contains("M^1 25/32"));
        assert!(plot(&rows).to_svg("t").unwrap().contains("front, corner"));
    }
}
