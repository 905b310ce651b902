//! The summaries of many runs as one table.

use super::Summary;
use super::folder::RunFolder;
use super::sweep::{Sweep, SweepError};
use isosheet_files::{FileError, cell, check_finite, read_json, write_atomically};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The summaries of many runs as one table: a row for each complete run.
///
/// The columns are `folder`, the keys of the sweeps, and the fields of [`Summary`], those inside of others
/// with names such as `ending.t` and `ending.supports[0].x`. A run without a field has an empty cell there.
/// Numbers have all their digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Collection {
    columns: Vec<String>,
    rows: Vec<SummaryRow>,
    incomplete: Vec<PathBuf>,
}

/// The cells of a run, with the names of their columns.
type SummaryRow = Vec<(String, String)>;

impl Collection {
    /// Reads the summaries of runs and of all runs of sweeps, in the order of `folders` and of their numbers.
    ///
    /// # Errors
    /// [`SweepError::NothingToCollect`] for a folder with neither a run nor a sweep, [`SweepError`] if a
    /// table or a summary cannot be read or has a number that is not finite.
    pub fn of(folders: &[PathBuf]) -> Result<Self, SweepError> {
        let mut collection = Self {
            columns: vec!["folder".into()],
            rows: Vec::new(),
            incomplete: Vec::new(),
        };
        let mut keys = Vec::new();
        for folder in folders {
            if let Some(table) = Sweep::table_in(folder)? {
                for key in &table.keys {
                    note(&mut keys, key);
                }
                for (name, values) in table.runs {
                    let cells = table.keys.iter().cloned().zip(values).collect();
                    collection.add(&folder.join(name), cells)?;
                }
            } else if folder.join(RunFolder::SCENE).is_file() {
                collection.add(folder, Vec::new())?;
            } else {
                let folder = folder.clone();
                return Err(SweepError::NothingToCollect { folder });
            }
        }
        collection.columns.extend(keys);
        for (column, _) in collection.rows.iter().flatten() {
            note(&mut collection.columns, column);
        }
        Ok(collection)
    }

    /// The folders of the runs that are not complete. They have no row.
    pub fn incomplete(&self) -> &[PathBuf] {
        &self.incomplete
    }

    /// Number of complete runs.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// The table as CSV. Texts that spreadsheets would take for formulas have an apostrophe before them.
    pub fn to_csv(&self) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut record = |cells: Vec<&str>| {
            let written =
                writer.write_record(cells.into_iter().map(|text| cell(text).into_owned()));
            written.expect("memory takes rows of equal length");
        };
        record(self.columns.iter().map(String::as_str).collect());
        for row in &self.rows {
            let of_column = |column: &String| {
                let found = row.iter().find(|(name, _)| name == column);
                found.map_or("", |(_, value)| value.as_str())
            };
            record(self.columns.iter().map(of_column).collect());
        }
        writer.into_inner().expect("memory can be flushed")
    }

    /// Writes the table as a CSV file, which appears when it is complete.
    ///
    /// # Errors
    /// [`SweepError::File`].
    pub fn write(&self, path: &Path) -> Result<(), SweepError> {
        use std::io::Write;
        Ok(write_atomically(path, |w| w.write_all(&self.to_csv()))?)
    }

    fn add(&mut self, folder: &Path, keys: SummaryRow) -> Result<(), SweepError> {
        let path = folder.join(RunFolder::SUMMARY);
        if !path.is_file() {
            self.incomplete.push(folder.to_owned());
            return Ok(());
        }
        let summary: Summary = read_json(&path)?;
        let wrong = |problem: String| FileError::content(&path, problem, "run the scene again");
        check_finite(&summary).map_err(|e| wrong(e.message))?;
        let fields = serde_json::to_value(&summary).map_err(|e| wrong(e.to_string()))?;
        let mut row = vec![("folder".to_owned(), folder.display().to_string())];
        row.extend(keys);
        add_fields(&mut row, "", &fields);
        self.rows.push(row);
        Ok(())
    }
}

/// Adds a name that is not in the list yet.
fn note(names: &mut Vec<String>, name: &str) {
    if !names.iter().any(|known| known == name) {
        names.push(name.to_owned());
    }
}

/// Adds the fields of a value by their names.
fn add_fields(row: &mut SummaryRow, name: &str, value: &Value) {
    match value {
        Value::Null => row.push((name.to_owned(), String::new())),
        Value::String(text) => row.push((name.to_owned(), text.clone())),
        // The shortest text from which the same bits are read, with an exponent where that is shorter.
        Value::Bool(_) | Value::Number(_) => row.push((name.to_owned(), value.to_string())),
        Value::Object(fields) => {
            for (field, value) in fields {
                let dot = if name.is_empty() { "" } else { "." };
                add_fields(row, &format!("{name}{dot}{field}"), value);
            }
        }
        Value::Array(entries) => {
            let words: Option<Vec<&str>> = entries.iter().map(Value::as_str).collect();
            if let Some(words) = words.filter(|words| !words.is_empty()) {
                return row.push((name.to_owned(), words.join("; ")));
            }
            for (k, entry) in entries.iter().enumerate() {
                let name = format!("{name}[{k}]");
                let Some(components) = entry.as_array() else {
                    add_fields(row, &name, entry);
                    continue;
                };
                for (axis, component) in ["x", "y", "z"].iter().zip(components) {
                    add_fields(row, &format!("{name}.{axis}"), component);
                }
            }
        }
    }
}
