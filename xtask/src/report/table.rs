//! Tables: the same rows as a CSV file for programs, in a page and on a terminal for people.

use super::number::number;
use crate::store::Files;
use anyhow::Result;
use isosheet_files::write_atomically;
use maud::{Markup, Render, html};
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// An entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    Text(String),
    /// There is no such number: a run did not get that far.
    Missing,
}

impl From<f64> for Cell {
    /// A number that is not finite is never written.
    fn from(value: f64) -> Self {
        if value.is_finite() {
            Self::Number(value)
        } else {
            Self::Missing
        }
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        Self::Number(value as f64)
    }
}

impl From<u32> for Cell {
    fn from(value: u32) -> Self {
        Self::Number(f64::from(value))
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, T::into)
    }
}

impl Cell {
    /// All digits, in the shorter of the two notations.
    fn exact(&self) -> String {
        match self {
            Self::Number(v) if *v != 0.0 && !(1e-4..1e15).contains(&v.abs()) => format!("{v:e}"),
            Self::Number(v) => v.to_string(),
            Self::Text(text) => text.clone(),
            Self::Missing => String::new(),
        }
    }

    /// Rounded, for people.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Number(value) => number(*value),
            Self::Text(text) => text.clone(),
            Self::Missing => "–".into(),
        }
    }
}

/// A column: its name, with the unit, and what it shows of a row.
pub(crate) type Column<'a, R> = (&'a str, &'a dyn Fn(&R) -> Cell);

/// The columns of a table, each with what it shows of a row: `columns! { row; "name" => cell, ... }`.
macro_rules! columns {
    ($row:ident; $($name:expr => $cell:expr),* $(,)?) => {
        &[$(($name, &|$row| {
            // Some columns have the same entry in all rows.
            let _ = $row;
            $crate::report::Cell::from($cell)
        })),*]
    };
}
pub(crate) use columns;

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table {
    /// Name of its file, without folder and extension; empty where it is not a file.
    pub(crate) name: String,
    /// What the table shows.
    pub(crate) caption: String,
    /// Names of the columns, with units.
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub(crate) fn new(caption: impl Into<String>, head: &[&str]) -> Self {
        Self {
            name: String::new(),
            caption: caption.into(),
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// A table of rows that are alike.
    pub(crate) fn of<R>(
        caption: impl Into<String>,
        rows: impl IntoIterator<Item = R>,
        columns: &[Column<'_, R>],
    ) -> Self {
        let mut table = Self::new(caption, &[]);
        table.head = columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        for row in rows {
            table.push(columns.iter().map(|(_, cell)| cell(&row)).collect());
        }
        table
    }

    /// A table whose columns are the fields of its rows, structs or tuples of structs, by the names that
    /// serde gives them.
    ///
    /// # Errors
    /// A field is neither a number nor a text.
    pub(crate) fn of_fields<R: Serialize>(
        caption: impl Into<String>,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<Self> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in rows {
            writer.serialize(row)?;
        }
        let bytes = writer.into_inner()?;
        let mut reader = csv::Reader::from_reader(&*bytes);
        let mut table = Self::new(caption, &reader.headers()?.iter().collect::<Vec<_>>());
        for record in reader.records() {
            let cell = |text: &str| match (text, text.parse::<f64>()) {
                ("", _) => Cell::Missing,
                (_, Ok(value)) => value.into(),
                _ => text.into(),
            };
            table.push(record?.iter().map(cell).collect());
        }
        Ok(table)
    }

    /// This table as the file `name.csv`.
    pub(crate) fn named(mut self, name: &str) -> Self {
        name.clone_into(&mut self.name);
        self
    }

    /// This table with more rows, given as text.
    pub(crate) fn with_texts(mut self, rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        for row in rows {
            self.push(row.into_iter().map(Cell::from).collect());
        }
        self
    }

    /// Some columns of the table under another caption, by their names with spaces between; of equal rows
    /// that follow each other one is left.
    ///
    /// # Panics
    /// If there is no such column.
    pub(crate) fn select(&self, caption: impl Into<String>, names: &str) -> Self {
        let head: Vec<&str> = names.split_whitespace().collect();
        let place = |name: &&str| self.head.iter().position(|h| h == name);
        let places: Vec<usize> = head.iter().map(|h| place(h).expect("a column")).collect();
        let mut table = Self::new(caption, &head);
        let pick = |row: &Vec<Cell>| places.iter().map(|k| row[*k].clone()).collect();
        table.rows = self.rows.iter().map(pick).collect();
        table.rows.dedup();
        table
    }

    /// Adds a row with an entry for every column.
    ///
    /// # Panics
    /// If the row has more or fewer entries.
    pub(crate) fn push(&mut self, row: Vec<Cell>) {
        assert_eq!(row.len(), self.head.len(), "columns of {}", self.caption);
        self.rows.push(row);
    }

    /// The table as comma-separated values (RFC 4180) with all digits of its numbers.
    ///
    /// # Errors
    /// None in practice: the file is written to memory.
    pub(crate) fn csv(&self) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.head)?;
        for row in &self.rows {
            writer.write_record(row.iter().map(Cell::exact))?;
        }
        Ok(writer.into_inner()?)
    }

    /// Writes the table as a CSV file.
    pub(crate) fn write_to(&self, path: &Path) -> Result<()> {
        let bytes = self.csv()?;
        Ok(write_atomically(path, |w| w.write_all(&bytes))?)
    }

    /// Writes the table as `tables/name.csv`.
    pub(crate) fn write(&self, files: &mut Files<'_>) -> Result<()> {
        Ok(files.write(&format!("tables/{}.csv", self.name), &self.csv()?)?)
    }

    /// The table for a terminal: columns of equal width.
    pub(crate) fn text(&self) -> String {
        let rows = self.rows.iter();
        let rows = rows.map(|row| row.iter().map(Cell::text).collect());
        let lines: Vec<Vec<String>> = std::iter::once(self.head.clone()).chain(rows).collect();
        let width = |k: usize| lines.iter().map(|l| l[k].chars().count()).max();
        let widths: Vec<usize> = (0..self.head.len()).filter_map(width).collect();
        let line = |cells: &Vec<String>| {
            let padded = cells.iter().zip(&widths);
            let padded = padded.map(|(c, w)| format!("{c:<w$}"));
            padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        };
        let body: Vec<String> = lines.iter().map(line).collect();
        format!("{}\n{}\n", self.caption, body.join("\n"))
    }
}

/// A table of a page, which scrolls when it is wide; numbers are rounded, and names of columns that programs
/// read have spaces. Columns without an entry are left out, and tables without a row.
impl Render for Table {
    fn render(&self) -> Markup {
        let is_there = |k: &usize| self.rows.iter().any(|row| row[*k] != Cell::Missing);
        let shown: Vec<usize> = (0..self.head.len()).filter(is_there).collect();
        html! {
            @if !shown.is_empty() { div.scroll { table {
                caption { (self.caption) }
                thead { tr { @for k in &shown { th { (self.head[*k].replace('_', " ")) } } } }
                tbody { @for row in &self.rows { tr { @for k in &shown { td { (row[*k].text()) } } } } }
            } } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_never_infinite() {
        assert_eq!(Cell::from(f64::NAN), Cell::Missing);
        assert_eq!(Cell::from(f64::INFINITY), Cell::Missing);
        assert_eq!(Cell::from(Some(2.0)), Cell::Number(2.0));
        assert_eq!(Cell::from(Some(f64::NAN)), Cell::Missing);
    }

    #[test]
    fn tables_for_programs_and_people() {
        let rows = [(0.123_456, "x, \"y\""), (2.5e-18, "<z>")];
        let t = Table::of(
            "caption",
            rows,
            &[
                ("a", &|r| r.1.into()),
                ("b, m", &|r| r.0.into()),
                ("c", &|_| f64::NAN.into()),
            ],
        );
        let csv = String::from_utf8(t.csv().unwrap()).unwrap();
        assert_eq!(
            csv,
            "a,\"b, m\",c\n\"x, \"\"y\"\"\",0.123456,\n<z>,2.5e-18,\n"
        );
        assert_eq!(
            t.text(),
            "caption\na       b, m     c\nx, \"y\"  0.123    –\n<z>     2.5e-18  –\n"
        );
        let page = t.render().into_string();
        assert!(page.contains("<td>&lt;z&gt;</td><td>2.5e-18</td></tr>"));
        assert!(!page.contains("<th>c</th>"), "it has no entry");
        let none = Table::new("caption", &["a"]).render().into_string();
        assert_eq!(none, "");
    }

    /// All digits of a number come back from a file.
    #[test]
    fn numbers_survive_a_file() {
        for value in [0.1, -1.0 / 3.0, 1e-300, 2.5e17, 12345.678, 0.0, 9e-5] {
            assert_eq!(Cell::from(value).exact().parse::<f64>().unwrap(), value);
        }
    }

    /// All digits of numbers are kept, and what is not there is missing.
    #[test]
    fn fields_are_columns() {
        #[derive(Serialize)]
        struct Job {
            #[serde(rename = "h, m")]
            spacing: f64,
            model: Model,
        }
        #[derive(Serialize)]
        enum Model {
            #[serde(rename = "real stiffness")]
            Material,
        }
        #[derive(Serialize)]
        struct Found {
            error: Option<f64>,
        }
        let row = |spacing, error| {
            let model = Model::Material;
            (Job { spacing, model }, Found { error })
        };
        let rows = [row(0.1 + 0.2, None), row(1.0, Some(1e-20))];
        let table = Table::of_fields("runs", rows).unwrap();
        assert_eq!(table.head, ["h, m", "model", "error"]);
        let text = || Cell::from("real stiffness");
        let first = [(0.1 + 0.2).into(), text(), Cell::Missing];
        assert_eq!(table.rows, [first, [1.0.into(), text(), 1e-20.into()]]);
    }
}
