//! Tables of results: the same rows as a CSV file for programs and as a table of the page for people.

use crate::figures::Table;
use serde::{Deserialize, Serialize};

/// An entry of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Cell {
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

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Missing, Self::from)
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        Self::Number(value as f64)
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

impl Cell {
    fn csv(&self) -> String {
        match self {
            Self::Number(value) => value.to_string(),
            Self::Text(text) if text.contains([',', '"', '\n']) => {
                format!("\"{}\"", text.replace('"', "\"\""))
            }
            Self::Text(text) => text.clone(),
            Self::Missing => String::new(),
        }
    }

    fn page(&self) -> String {
        match self {
            Self::Number(value) => number(*value),
            Self::Text(text) => text.clone(),
            Self::Missing => "–".into(),
        }
    }
}

/// A number with three significant digits.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || value.fract() == 0.0 && value.abs() < 1e6 {
        return format!("{value:.0}");
    }
    if !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let digits = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.digits$}")
}

/// A table of results.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Results {
    /// Name of the file, without folder and extension.
    pub(super) name: String,
    /// What the table shows.
    pub(super) caption: String,
    /// Names of the columns, with units.
    pub(super) head: Vec<String>,
    pub(super) rows: Vec<Vec<Cell>>,
}

impl Results {
    /// A table without rows.
    pub(super) fn new(name: &str, caption: impl Into<String>, head: &[&str]) -> Self {
        Self {
            name: name.into(),
            caption: caption.into(),
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row with an entry for every column.
    ///
    /// # Panics
    /// If the row has more or fewer entries.
    pub(super) fn push(&mut self, row: Vec<Cell>) {
        assert_eq!(row.len(), self.head.len(), "columns of {}", self.name);
        self.rows.push(row);
    }

    /// The table as comma-separated values (RFC 4180) with all digits.
    pub(super) fn csv(&self) -> String {
        let head = self.head.iter().map(|h| Cell::from(h.as_str()).csv());
        let mut lines = vec![head.collect::<Vec<_>>().join(",")];
        for row in &self.rows {
            lines.push(row.iter().map(Cell::csv).collect::<Vec<_>>().join(","));
        }
        lines.join("\n") + "\n"
    }

    /// The table of the page, with rounded numbers.
    pub(super) fn table(&self) -> Table {
        Table {
            caption: self.caption.clone(),
            head: self.head.clone(),
            rows: self
                .rows
                .iter()
                .map(|row| row.iter().map(Cell::page).collect())
                .collect(),
        }
    }

    /// The table for a terminal: columns of equal width.
    pub(super) fn text(&self) -> String {
        let table = self.table();
        let lines = || std::iter::once(&table.head).chain(&table.rows);
        let widths: Vec<usize> = (0..self.head.len())
            .map(|k| lines().map(|l| l[k].chars().count()).max().unwrap_or(0))
            .collect();
        let line = |cells: &Vec<String>| {
            let padded = cells.iter().zip(&widths);
            let padded = padded.map(|(c, w)| format!("{c:<w$}"));
            padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        };
        let body: Vec<String> = lines().map(line).collect();
        format!("{}\n{}\n", self.caption, body.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_and_never_infinite() {
        for (value, text) in [
            (0.0, "0"),
            (15.0, "15"),
            (0.13294, "0.133"),
            (22.512, "22.5"),
            (1234.5, "1234"),
            (4.2e-7, "4.2e-7"),
            (-0.5, "-0.500"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(Cell::from(f64::NAN), Cell::Missing);
        assert_eq!(Cell::from(f64::INFINITY), Cell::Missing);
        assert_eq!(Cell::from(Some(2.0)), Cell::Number(2.0));
    }

    #[test]
    fn tables_for_programs_and_people() {
        let mut t = Results::new("t", "caption", &["a", "b, m", "c"]);
        t.push(vec!["x, \"y\"".into(), 0.123456.into(), f64::NAN.into()]);
        assert_eq!(t.csv(), "a,\"b, m\",c\n\"x, \"\"y\"\"\",0.123456,\n");
        assert_eq!(t.table().rows, [["x, \"y\"", "0.123", "–"]]);
        assert_eq!(t.text(), "caption\na       b, m   c\nx, \"y\"  0.123  –\n");
    }

    /// What is read back from the records is what was written.
    #[test]
    fn cells_survive_a_file() {
        let cells = vec![Cell::from(0.1), Cell::from("1"), Cell::Missing];
        let text = serde_json::to_string(&cells).unwrap();
        assert_eq!(serde_json::from_str::<Vec<Cell>>(&text).unwrap(), cells);
    }
}
