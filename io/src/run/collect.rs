//! The summaries of many runs as one table.

use super::folder::RunFolder;
use super::sweep::{Sweep, SweepError};
use super::{Ending, EnergySummary, Measured, Summary};
use crate::format::{Finding, JsonError, cell, check_finite, read_json, write_atomically};
use std::path::{Path, PathBuf};

/// The summaries of many runs as one table: a row for each complete run.
///
/// The columns are `folder`, the keys of the sweeps, and the fields of [`Summary`], those inside of others
/// with names such as `ending.t` and `ending.supports[0].x`. A run without a field has an empty cell there.
/// Numbers have all their digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Collection {
    columns: Vec<String>,
    rows: Vec<Row>,
    incomplete: Vec<PathBuf>,
}

/// The cells of a run, with the names of their columns.
type Row = Vec<(String, String)>;

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
    /// [`SweepError::Write`].
    pub fn write(&self, path: &Path) -> Result<(), SweepError> {
        use std::io::Write;
        Ok(write_atomically(path, |w| w.write_all(&self.to_csv()))?)
    }

    fn add(&mut self, folder: &Path, keys: Row) -> Result<(), SweepError> {
        let path = folder.join(RunFolder::SUMMARY);
        if !path.is_file() {
            self.incomplete.push(folder.to_owned());
            return Ok(());
        }
        let summary: Summary = read_json(&path)?;
        check_finite(&summary).map_err(|finding| match finding {
            Finding::NotFinite { path: field, value } => {
                JsonError::NotFinite { path, field, value }
            }
            Finding::Other(problem) => JsonError::Form { path, problem },
        })?;
        let mut row = vec![("folder".to_owned(), folder.display().to_string())];
        row.extend(keys);
        add_summary(&mut row, &summary);
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

/// All fields, in their order.
fn add_summary(row: &mut Row, summary: &Summary) {
    let Summary {
        program,
        version,
        commit,
        scene,
        wall_time,
        modelled,
        sheets,
        vertices,
        faces,
        steps,
        frames,
        largest_strain,
        largest_displacement,
        energy,
        smallest_gap,
        iterations,
        factorisations,
        rejected,
        elastic,
        measures,
        ending,
    } = summary;
    let mut cell = |name: &str, value: String| row.push((name.to_owned(), value));
    cell("program", program.clone());
    cell("version", version.clone());
    cell("commit", commit.clone().unwrap_or_default());
    cell("scene", scene.clone());
    cell("wall_time", number(*wall_time));
    cell("modelled", modelled.join("; "));
    for place in sheets {
        let [first, end] = place.vertices.map(|v| v.to_string());
        cell(&format!("sheets.{}.first_vertex", place.name), first);
        cell(&format!("sheets.{}.end_vertex", place.name), end);
    }
    cell("vertices", vertices.to_string());
    cell("faces", faces.to_string());
    cell("steps", steps.to_string());
    cell("frames", frames.to_string());
    cell("largest_strain", number(*largest_strain));
    if let Some(elastic) = elastic {
        cell("softest_face", number(elastic.used[0]));
        cell("largest_face_strain", number(elastic.strain));
        cell("stretching_share", number(elastic.share));
        cell(
            "sharpest_bend",
            number(elastic.sharpest.map_or(0.0, |b| b.angle)),
        );
    }
    cell("largest_displacement", number(*largest_displacement));
    let EnergySummary {
        largest_kinetic,
        largest_exchange,
        start_potential,
        round_off,
        least_potential,
        largest_error,
        largest_gain,
        relative_error,
        relative_gain,
    } = *energy;
    for (name, value) in [
        ("largest_kinetic", Some(largest_kinetic)),
        ("largest_exchange", Some(largest_exchange)),
        ("start_potential", Some(start_potential)),
        ("round_off", Some(round_off)),
        ("least_potential", Some(least_potential)),
        ("largest_error", Some(largest_error)),
        ("largest_gain", Some(largest_gain)),
        ("relative_error", relative_error),
        ("relative_gain", relative_gain),
    ] {
        cell(
            &format!("energy.{name}"),
            value.map(number).unwrap_or_default(),
        );
    }
    cell("smallest_gap", smallest_gap.map(number).unwrap_or_default());
    cell("iterations", iterations.to_string());
    cell("factorisations", factorisations.to_string());
    cell("rejected", rejected.to_string());
    for (name, measured) in measures {
        let Measured {
            last,
            least,
            largest,
        } = *measured;
        for (kind, value) in [("last", last), ("least", least), ("largest", largest)] {
            cell(&format!("measures.{name}.{kind}"), number(value));
        }
    }
    add_ending(row, ending);
}

fn add_ending(row: &mut Row, ending: &Ending) {
    let Ending {
        reason,
        t,
        kinetic,
        potential,
        plastic,
        energy_drift,
        largest_speed,
        supports,
        obstacles,
        taut,
        residuals,
    } = ending;
    let mut cell = |name: &str, value: String| row.push((format!("ending.{name}"), value));
    cell("reason", reason.name().to_owned());
    cell("t", number(*t));
    cell("kinetic", number(*kinetic));
    cell("potential", number(*potential));
    if let Some(plastic) = plastic {
        cell("plastic", number(*plastic));
    }
    cell("energy_drift", number(*energy_drift));
    cell("largest_speed", number(*largest_speed));
    if let Some(taut) = taut {
        cell("taut", taut.clone());
    }
    if let Some(folding) = &residuals.folding {
        cell("folding.creases", folding.creases.to_string());
        cell("folding.largest", number(folding.largest));
        cell("folding.rms", number(folding.rms));
        cell("folding.largest_flat", number(folding.largest_flat));
        cell("folding.wrong_side", folding.wrong_side.to_string());
    }
    for crease in &residuals.creases {
        cell(
            &format!("creases[{}].largest", crease.number),
            number(crease.largest),
        );
        cell(
            &format!("creases[{}].rms", crease.number),
            number(crease.rms),
        );
    }
    for (k, opening) in residuals.seams.iter().enumerate() {
        cell(&format!("seams[{k}]"), number(*opening));
    }
    for (list, forces) in [("supports", supports), ("obstacles", obstacles)] {
        for (k, force) in forces.iter().enumerate() {
            for (axis, component) in ["x", "y", "z"].into_iter().zip(force) {
                cell(&format!("{list}[{k}].{axis}"), number(*component));
            }
        }
    }
}

/// The shortest text from which the same bits are read, with an exponent where that is shorter.
fn number(value: f64) -> String {
    serde_json::Value::from(value).to_string()
}
