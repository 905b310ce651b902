//! What an experiment says: errors by mesh and size, orders, tables, a plot, findings.

use super::experiment::{Experiment, MESHES, Row};
use super::limitations::Limitations;
use crate::draw::{Chart, Charts, Series};
use crate::report::{
    Bound, Effort, Finding, Part, Record, Table, Verdict, columns, exponent, plot,
};
use crate::runs::meshes::Grid;
use crate::store::Files;
use anyhow::Result;
use maud::html;
use serde::{Deserialize, Serialize};

/// Sizes, squares across.
pub(super) const SIZES: [usize; 3] = [4, 8, 16];

/// The claim of the book: the largest errors, per cent, at these sizes. The first follows from the second by
/// second order.
const CLAIMS: [f64; 3] = [12.0, 3.0, 1.0];

/// What is kept of an experiment.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Outcome {
    pub(super) record: Record,
    pub(super) rows: Vec<Row>,
}

/// The largest error of some lines at a size, per cent; nothing where a run did not end or there is none.
fn worst<'a>(rows: impl Iterator<Item = &'a Row>, across: usize) -> Option<f64> {
    let errors: Option<Vec<f64>> = rows
        .filter(|r| r.across == across)
        .map(|r| r.error.map(f64::abs))
        .collect();
    errors?.into_iter().reduce(f64::max)
}

/// The order of convergence, by a fit through the errors of all three sizes.
fn order(errors: [Option<f64>; 3]) -> Option<f64> {
    let point = |(across, error): (usize, Option<f64>)| Some([1.0 / across as f64, error?]);
    let points: Option<Vec<[f64; 2]>> = SIZES.into_iter().zip(errors).map(point).collect();
    exponent(&points?)
}

/// The largest errors of some lines at all sizes.
fn worsts<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> [Option<f64>; 3] {
    SIZES.map(|across| worst(rows.clone(), across))
}

/// The lines of a quantity.
fn of<'a>(rows: &'a [Row], quantity: &'a str) -> impl Iterator<Item = &'a Row> + Clone {
    rows.iter().filter(move |r| r.quantity == quantity)
}

impl Outcome {
    pub(super) fn new(
        experiment: &Experiment,
        rows: Vec<Row>,
        files: &mut Files<'_>,
    ) -> Result<Self> {
        let name = experiment.name;
        Table::of_fields("Every run", &rows)?
            .named(&format!("{name}-all"))
            .write(files)?;
        let by_mesh = by_mesh(experiment, &rows);
        let summary = by_quantity(experiment, &rows);
        by_mesh.clone().named(name).write(files)?;
        let alt = format!("{}: errors by size", experiment.title);
        let figure = plot(files, name, &chart(&rows), &alt)?;
        let section = html! {
            h2 { (experiment.title) }
            p { (experiment.about) " Source: " (experiment.source) "." }
            (summary)
            (figure)
            (by_mesh)
            (costs(&rows))
            p { "Every run: tables/" (name) "-all.csv." }
        };
        let record = Record {
            excerpt: vec![Part::table(name, &summary)],
            ..Record::new(name, section)
        };
        Ok(Self { record, rows })
    }
}

/// The largest errors of each quantity over all meshes.
fn by_quantity(experiment: &Experiment, rows: &[Row]) -> Table {
    let caption = format!(
        "{} ({}): largest errors over all meshes, %, by squares across, and order of convergence",
        experiment.title, experiment.source
    );
    Table::of(
        caption,
        (experiment.quantities)(),
        columns! { q;
            "quantity" => q.name.as_str(),
            "reference" => q.reference,
            "4" => worst(of(rows, &q.name), 4),
            "8" => worst(of(rows, &q.name), 8),
            "16" => worst(of(rows, &q.name), 16),
            "order" => order(worsts(of(rows, &q.name))),
        },
    )
}

/// The errors of each quantity on each mesh, with their signs.
fn by_mesh(experiment: &Experiment, rows: &[Row]) -> Table {
    let quantities = (experiment.quantities)();
    let all = quantities.iter().flat_map(|q| MESHES.map(|mesh| (q, mesh)));
    let lines = |row: &(&super::experiment::Quantity, Grid)| -> Vec<Row> {
        let (quantity, mesh) = *row;
        of(rows, &quantity.name)
            .filter(|r| r.mesh == mesh)
            .cloned()
            .collect()
    };
    let all = all.filter(|row| !lines(row).is_empty());
    let at = |row: &(&super::experiment::Quantity, Grid), across: usize| {
        let lines = lines(row);
        lines
            .iter()
            .find(|r| r.across == across)
            .and_then(|r| r.error)
    };
    Table::of(
        "Errors by mesh and squares across, %, and order of convergence",
        all,
        columns! { row;
            "quantity" => row.0.name.as_str(),
            "reference" => row.0.reference,
            "mesh" => row.1.name(),
            "4" => at(row, 4),
            "8" => at(row, 8),
            "16" => at(row, 16),
            "order" => order(SIZES.map(|across| at(row, across).map(f64::abs))),
        },
    )
}

/// What the runs took; each has one line for every quantity.
fn costs(rows: &[Row]) -> Table {
    let mut runs: Vec<&Row> = rows.iter().collect();
    runs.dedup_by_key(|r| (r.mesh.name(), r.across));
    Table::of(
        "Runs",
        runs,
        columns! { r;
            "mesh" => r.mesh.name(),
            "squares across" => r.across,
            "V" => r.vertices,
            "CPU s" => r.cpu,
            "factorisations" => r.factorisations,
            "message" => Some(r.message.as_str()).filter(|m| !m.is_empty()),
        },
    )
}

/// The largest error of each mesh against the size.
fn chart(rows: &[Row]) -> Charts {
    let series = MESHES.into_iter().enumerate().map(|(k, mesh)| {
        let own = rows.iter().filter(move |r| r.mesh == mesh);
        let point = |across: usize| Some([across as f64, worst(own.clone(), across)?]);
        let points = SIZES.into_iter().filter_map(point).collect();
        Series::styled(k, mesh.name(), points)
    });
    let series = series.collect();
    Chart::log_log("squares across", "largest error, %", [240.0, 160.0], series).into()
}

/// The claim, for each quantity and each size that was run.
pub(super) fn findings(
    experiment: &Experiment,
    rows: &[Row],
    effort: Effort,
    limitations: &Limitations,
) -> Vec<Finding> {
    let mut all = Vec::new();
    for quantity in (experiment.quantities)() {
        for (across, claim) in SIZES.into_iter().zip(CLAIMS) {
            let own = of(rows, &quantity.name).filter(|r| r.across == across);
            let errors: Vec<Option<f64>> = own.clone().map(|r| r.error.map(f64::abs)).collect();
            if errors.is_empty() {
                continue;
            }
            let what = format!("error of {}, %", quantity.name);
            let size = format!("{across} across");
            let mut finding = Finding::worst(size, what, Bound::AtMost(claim), &errors);
            let message = own.map(|r| r.message.clone()).find(|m| !m.is_empty());
            finding.remark(message);
            let names = [experiment.name, &quantity.name];
            limitations.declare(&mut finding, names, across, effort);
            all.push(finding);
        }
    }
    all
}

/// One line for each experiment.
pub(super) fn summary(experiments: &[&Experiment], outcomes: &[Outcome]) -> Table {
    let of = |e: &&Experiment| outcomes.iter().find(|o| o.record.name == e.name);
    let named = experiments.iter().filter_map(|e| Some((*e, of(e)?)));
    let all = |o: &Outcome| worsts(o.rows.iter());
    let quantity = |o: &Outcome| {
        let error = |r: &&Row| r.error.map_or(f64::INFINITY, f64::abs);
        let finest = o.rows.iter().map(|r| r.across).max();
        let rows = o.rows.iter().filter(|r| Some(r.across) == finest);
        let worst = rows.max_by(|a, b| error(a).total_cmp(&error(b)));
        worst.map(|r| r.quantity.clone())
    };
    let verdict = |o: &Outcome| {
        let verdicts = o.record.findings.iter().map(Finding::verdict);
        verdicts.max().unwrap_or(Verdict::Passed).text()
    };
    let cpu = |o: &Outcome| {
        let mut runs: Vec<&Row> = o.rows.iter().collect();
        runs.dedup_by_key(|r| (r.mesh.name(), r.across));
        runs.iter().map(|r| r.cpu).sum::<f64>()
    };
    Table::of(
        "The largest errors over all quantities and meshes, %, by squares across; order of convergence; the quantity \
         with the largest error on the finest meshes; CPU time of all runs",
        named,
        columns! { row;
            "experiment" => row.0.title,
            "reference" => row.0.source,
            "4" => all(row.1)[0],
            "8" => all(row.1)[1],
            "16" => all(row.1)[2],
            "order" => order(all(row.1)),
            "worst" => quantity(row.1),
            "verdict" => verdict(row.1),
            "CPU s" => cpu(row.1),
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_order_is_found() {
        let errors = [16.0, 4.0, 1.0].map(Some);
        assert!((order(errors).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(order([Some(1.0), None, Some(2.0)]), None);
    }
}
