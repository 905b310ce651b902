//! What is read off the table of all runs of a yardstick, by the names of its columns: tables of groups of
//! runs, requirements, figures.

use super::model::Model;
use crate::report::{Bound, Cell, Effort, Finding, Shortfall, Table, Verdict};
use crate::report::{exponent, median, number};
use isosheet_dynamics::ElasticSheet;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Columns with the entry that they have.
type Only = BTreeMap<String, String>;

/// A table with a row for each group of runs that agree in some columns.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SummaryTable {
    name: String,
    caption: String,
    #[serde(default)]
    only: Only,
    by: Vec<String>,
    columns: Vec<String>,
}

/// A bound for what the runs of each model have in a column.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Required {
    quantity: String,
    of: String,
    #[serde(default)]
    only: Only,
    bound: Bound,
    /// Models that may miss it, and the word for why.
    #[serde(default)]
    open: BTreeMap<String, String>,
}

/// An entry as text.
fn word(cell: &Cell) -> String {
    match cell {
        Cell::Number(value) => value.to_string(),
        Cell::Text(text) => text.clone(),
        Cell::Missing => String::new(),
    }
}

/// The entries of a column.
///
/// # Panics
/// If there is no such column.
fn column<'a>(table: &'a Table, name: &str) -> impl Iterator<Item = &'a Cell> + Clone {
    let place = table.head.iter().position(|head| head == name);
    let place = place.unwrap_or_else(|| panic!("no column `{name}`"));
    table.rows.iter().map(move |row| &row[place])
}

fn value(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Number(value) => Some(*value),
        _ => None,
    }
}

/// The different entries of a column in the order in which they come.
fn distinct<'a>(cells: impl Iterator<Item = &'a Cell>) -> Vec<&'a Cell> {
    let mut found = Vec::new();
    for cell in cells {
        if !found.contains(&cell) {
            found.push(cell);
        }
    }
    found
}

/// The runs that have an entry.
fn with(table: &Table, name: &str, entry: &str) -> Table {
    let mut kept = table.clone();
    let mut cells = column(table, name);
    kept.rows
        .retain(|_| cells.next().is_some_and(|cell| word(cell) == entry));
    kept
}

/// The runs that have some entries.
fn only(table: &Table, wanted: &Only) -> Table {
    wanted.iter().fold(table.clone(), |runs, (name, entry)| {
        with(&runs, name, entry)
    })
}

/// Relative errors below this come from a sheet that has come to rest to within a speed, and of answers with
/// four digits.
const FLOOR: f64 = 1e-4;

/// Fitted power of the errors above [`FLOOR`], below which an error says nothing; nothing from fewer than
/// two.
fn order(points: &[[f64; 2]]) -> Option<f64> {
    let above = points.iter().filter(|p| p[1] > FLOOR);
    let above: Vec<[f64; 2]> = above.copied().collect();
    (above.len() > 1).then(|| exponent(&above)).flatten()
}

/// What is made of a column of some runs, by its name with a word before it; see `yardsticks.toml`. `size` is
/// the column with the size of the mesh.
fn made(runs: &Table, of: &str, size: &str) -> Cell {
    let (kind, name) = kind(of);
    let cells = column(runs, name);
    let values: Vec<f64> = cells.clone().filter_map(value).collect();
    let sum: f64 = values.iter().sum();
    match kind {
        "largest" => values.into_iter().reduce(f64::max).into(),
        "smallest" => values.into_iter().reduce(f64::min).into(),
        "mean" | "part" => (sum / values.len() as f64).into(),
        "median" => median(values).into(),
        "sum" => sum.into(),
        "counts" => {
            let mut entries = distinct(cells.clone().filter(|c| **c != Cell::Missing));
            entries.sort_by_key(|entry| word(entry));
            let count = |entry: &Cell| cells.clone().filter(|c| *c == entry).count();
            let texts = entries
                .into_iter()
                .map(|e| format!("{} {}", count(e), word(e)));
            texts.collect::<Vec<_>>().join(", ").into()
        }
        "power" => {
            let points = column(runs, size).zip(cells);
            let points = points.map(|(n, error)| Some([1.0 / value(n)?, value(error)?]));
            let points: Option<Vec<_>> = points.collect();
            points.and_then(|points| order(&points)).into()
        }
        _ => cells.clone().next().cloned().unwrap_or(Cell::Missing),
    }
}

/// The word before the name of a column, if [`made`] knows it, and the name.
fn kind(of: &str) -> (&str, &str) {
    const KINDS: [&str; 8] = [
        "largest", "smallest", "mean", "median", "sum", "part", "counts", "power",
    ];
    let split = of.split_once(' ').filter(|(kind, _)| KINDS.contains(kind));
    split.unwrap_or(("", of))
}

/// The name of a column of a table of groups.
fn title(of: &str) -> String {
    match kind(of) {
        ("" | "counts" | "sum", name) => name.to_owned(),
        ("part", name) => format!("part that {name}"),
        ("power", name) => format!("power of h, {name}"),
        (kind, name) => format!("{kind} {name}"),
    }
}

impl SummaryTable {
    /// The table of the groups, in the order in which the entries that they agree in come first.
    pub(super) fn of(&self, runs: &Table, size: &str) -> Table {
        let mut groups = vec![only(runs, &self.only)];
        for name in &self.by {
            let split = |group: &Table| -> Vec<Table> {
                let entries = distinct(column(group, name)).into_iter().map(word);
                entries.map(|entry| with(group, name, &entry)).collect()
            };
            groups = groups.iter().flat_map(split).collect();
        }
        let mut columns = self.by.clone();
        let is_grouped = groups.iter().any(|group| group.rows.len() > 1);
        columns.extend(is_grouped.then(|| "runs".to_owned()));
        columns.extend(self.columns.iter().cloned());
        let head: Vec<String> = columns.iter().map(|of| title(of)).collect();
        let head: Vec<&str> = head.iter().map(String::as_str).collect();
        let mut table = Table::new(self.caption.trim(), &head).named(&self.name);
        for group in &groups {
            let cell = |of: &String| match of.as_str() {
                "runs" => group.rows.len().into(),
                of => made(group, of, size),
            };
            table.push(columns.iter().map(cell).collect());
        }
        table
    }
}

const QUICK: &str = "the meshes and times of the quick form are too small for it";

impl Required {
    /// What a model reaches. Where the largest or smallest value is asked for, it is missed if one is
    /// missing.
    fn on(
        &self,
        model: Model,
        runs: &Table,
        effort: Effort,
        reasons: &BTreeMap<String, String>,
    ) -> Finding {
        let model = model.to_string();
        let runs = only(&with(runs, "model", &model), &self.only);
        let values: Vec<Option<f64>> = match kind(&self.of) {
            ("largest" | "smallest", name) => column(&runs, name).map(value).collect(),
            _ => vec![value(&made(&runs, &self.of, ""))],
        };
        let open = self.open.get(&model).map(|word| &*reasons[word]);
        let mut finding = Finding::worst(model, &self.quantity, self.bound, &values);
        if let Some(why) = open.or((effort == Effort::Quick).then_some(QUICK)) {
            finding.limited(why, Shortfall::Varies);
        }
        finding
    }
}

/// What every accepted step guarantees: lengths to within the limit of the strain that all models have by
/// default, lengths of rods to 1e-12, and gaps above 0. Steps of runs that did not reach their end count.
///
/// The norm of Green's strain `(l^2 / L^2 - 1) / 2` is below the limit `m`, so that an edge becomes shorter
/// by a part of `1 - sqrt(1 - 2 m)` at most, and longer by less.
fn guarantees() -> [(&'static str, Bound); 3] {
    [
        (
            "largest strain of an edge",
            Bound::AtMost(1.0 - (1.0 - 2.0 * ElasticSheet::LIMIT).sqrt()),
        ),
        (
            "largest violation of the equations of isometry",
            Bound::AtMost(1e-12),
        ),
        ("smallest gap, m", Bound::Above(0.0)),
    ]
}

/// What every model reaches of what is required, and what all steps guarantee.
pub(super) fn findings(
    required: &[Required],
    runs: &Table,
    effort: Effort,
    reasons: &BTreeMap<String, String>,
) -> Vec<Finding> {
    let mut all = Vec::new();
    for model in Model::ALL {
        let of = with(runs, "model", &model.to_string());
        if of.rows.is_empty() {
            continue;
        }
        all.extend(required.iter().map(|r| r.on(model, runs, effort, reasons)));
        for (name, bound) in guarantees() {
            let worst = value(&made(&of, name, ""));
            let finding = worst.map(|v| Finding::worst(model.to_string(), name, bound, &[Some(v)]));
            all.extend(finding);
        }
    }
    all
}

/// All findings with a column for each model; values within their bounds are bold.
pub(super) fn by_model<'a>(all: impl IntoIterator<Item = (&'a str, &'a Finding)>) -> Table {
    let models = Model::ALL.map(|model| model.to_string());
    let mut head = vec!["yardstick", "quantity", "required"];
    head.extend(models.iter().map(String::as_str));
    let mut table = Table::new(
        "Measured against target: the worst of all runs that the requirement names, bold where it is met. A dash: \
         one of these runs did not end, or the model is not asked.",
        &head,
    );
    let all: Vec<(&str, &Finding)> = all.into_iter().collect();
    let key = |(yardstick, f): &(&str, &Finding)| {
        [yardstick, f.quantity.as_str(), &f.bound.text()].map(Cell::from)
    };
    for row in &all {
        let mut cells = key(row).to_vec();
        if table.rows.iter().any(|known| known.starts_with(&cells)) {
            continue;
        }
        for model in &models {
            let found = all
                .iter()
                .find(|other| key(other) == key(row) && other.1.of == *model);
            cells.push(match found.map(|(_, f)| (f.value, f.verdict())) {
                Some((Some(v), Verdict::Passed)) => format!("**{}**", number(v)).into(),
                found => found.and_then(|(value, _)| value).into(),
            });
        }
        table.push(cells);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two models on two meshes of two sizes; one of the runs has no error.
    fn runs() -> Table {
        let mut table = Table::new("", &["model", "mesh", "n", "error"]);
        for (model, scale) in [("rods", 8.0), ("elastic", 1.0)] {
            for (mesh, n) in [("a", 2.0), ("a", 4.0), ("b", 2.0), ("b", 4.0)] {
                let is_lost = (model, mesh, n) == ("rods", "b", 4.0);
                let error: f64 = if is_lost { f64::NAN } else { scale / (n * n) };
                table.push(vec![model.into(), mesh.into(), n.into(), error.into()]);
            }
        }
        table
    }

    #[test]
    fn groups_have_their_worst_values_counts_and_orders() {
        let summary: SummaryTable = toml::from_str(
            "name = 's'
            caption = 'c'
            only = { mesh = 'b' }
            by = ['mesh', 'model']
            columns = ['largest error', 'counts n', 'power error', 'error']",
        )
        .unwrap();
        let table = summary.of(&runs(), "n");
        let head = [
            "mesh",
            "model",
            "runs",
            "largest error",
            "n",
            "power of h, error",
            "error",
        ];
        assert_eq!(table.head, head);
        let first = [
            2_usize.into(),
            2.0.into(),
            "1 2, 1 4".into(),
            Cell::Missing,
            2.0.into(),
        ];
        assert_eq!(table.rows[0][2..], first);
        let power = value(&table.rows[1][5]).unwrap();
        assert!((power - 2.0).abs() < 1e-12, "{power}");
    }

    #[test]
    fn a_missing_value_misses_a_requirement_unless_it_is_open() {
        let text = "quantity = 'q'
            of = 'largest error'
            only = { n = '4' }
            bound = { at_most = 0.1 }
            open = { rods = 'why' }";
        let required: Required = toml::from_str(text).unwrap();
        let reasons = BTreeMap::from([("why".into(), "they lock".into())]);
        let on = |model| required.on(model, &runs(), Effort::Standard, &reasons);
        let (rods, elastic) = (on(Model::Rods), on(Model::Elastic));
        assert_eq!((rods.value, rods.verdict()), (None, Verdict::Limitation));
        assert_eq!(
            (elastic.value, elastic.verdict()),
            (Some(0.0625), Verdict::Passed)
        );
        assert_eq!(on(Model::Material).verdict(), Verdict::Failed);
        let table = by_model([("y", &rods), ("y", &elastic)]);
        let cells = ["y", "q", "≤ 0.1"].map(Cell::from);
        let values = [Cell::Missing, Cell::Missing, "**0.0625**".into()];
        assert_eq!(table.rows, [[cells, values].concat()]);
    }
}
