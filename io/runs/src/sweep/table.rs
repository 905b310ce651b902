//! The table of the runs of a sweep.

use super::SweepError;
use isosheet_files::{FileError, input, write_atomically};
use std::path::Path;

/// The first two columns; the keys follow.
const COLUMNS: [&str; 2] = ["run", "folder"];

/// The keys of a sweep, and of each run the folder and the value of each key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SweepTable {
    pub(crate) keys: Vec<String>,
    pub(crate) runs: Vec<(String, Vec<String>)>,
}

impl SweepTable {
    /// Whether the other table has the same keys and nothing but the first runs of this one.
    pub(crate) fn begins_with(&self, other: &Self) -> bool {
        self.keys == other.keys && self.runs.starts_with(&other.runs)
    }

    /// Writes the columns `run`, `folder` and the keys, one row for each run.
    pub(crate) fn write(&self, path: &Path) -> Result<(), SweepError> {
        write_atomically(path, |w| {
            let mut writer = csv::Writer::from_writer(w);
            let keys = self.keys.iter().map(String::as_str);
            writer.write_record(COLUMNS.into_iter().chain(keys))?;
            for (k, (folder, values)) in self.runs.iter().enumerate() {
                let number = k.to_string();
                let first = [number.as_str(), folder];
                let values = values.iter().map(String::as_str);
                writer.write_record(first.into_iter().chain(values))?;
            }
            writer.flush()
        })?;
        Ok(())
    }

    /// Reads what [`SweepTable::write`] has written.
    pub(crate) fn read(path: &Path) -> Result<Self, FileError> {
        let text = input::read(path).map_err(|e| FileError::unreadable(path, e))?;
        let remedy = "make the sweep anew in another folder";
        Self::parse(&text).map_err(|problem| FileError::content(path, problem, remedy))
    }

    fn parse(text: &[u8]) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(text);
        let header = reader.headers().map_err(|e| e.to_string())?;
        let keys: Vec<String> = header
            .iter()
            .skip(COLUMNS.len())
            .map(str::to_owned)
            .collect();
        if !header.iter().take(COLUMNS.len()).eq(COLUMNS) || keys.is_empty() {
            return Err("its columns are not `run`, `folder` and keys of a scene".into());
        }
        let mut runs = Vec::new();
        for (k, row) in reader.records().enumerate() {
            let row = row.map_err(|e: csv::Error| e.to_string())?;
            let folder = format!("{k:03}");
            if row.get(0) != Some(k.to_string().as_str()) || row.get(1) != Some(folder.as_str()) {
                return Err(format!(
                    "row {} does not belong to run {k} in the folder {folder}",
                    k + 1
                ));
            }
            let values = row.iter().skip(COLUMNS.len()).map(str::to_owned);
            runs.push((folder, values.collect()));
        }
        Ok(Self { keys, runs })
    }
}
