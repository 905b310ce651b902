//! Pairs of a number and a value, which all of a DXF file consists of.

use isosheet_files::DataError;

/// What to do about a file that is no such drawing.
const EXPORT: &str = "export it again as DXF in text form, with blocks and texts exploded";

/// What begins with a group 0: an entity, the entry of a table, or the mark of a section.
#[derive(Clone, Debug)]
pub(super) struct Record<'a> {
    /// The value of the group 0.
    pub(super) kind: &'a str,
    /// The line on which it begins, from 1.
    pub(super) line: usize,
    /// The other groups.
    pub(super) groups: Vec<(i32, &'a str)>,
}

/// The records of a file.
pub(super) fn records(text: &str) -> Result<Vec<Record<'_>>, DataError> {
    if text.starts_with("AutoCAD Binary DXF") {
        return Err(DataError::new("it is a binary DXF file", EXPORT));
    }
    let mut records: Vec<Record<'_>> = Vec::new();
    let mut lines = text.lines().map(str::trim).zip(1..);
    while let Some((code, line)) = lines.next() {
        let value = lines.next().map(|(value, _)| value);
        if value.is_none() && code.is_empty() {
            break;
        }
        let Ok(code) = code.parse::<i32>() else {
            let found: String = code.chars().take(30).collect();
            let message = format!("line {line}: {found:?} is no number of a group");
            return Err(DataError::new(message, EXPORT).at(line));
        };
        let value = value.ok_or_else(|| truncated(line))?;
        match (code, records.last_mut()) {
            (0, _) => records.push(Record {
                kind: value,
                line,
                groups: Vec::new(),
            }),
            (_, Some(record)) => record.groups.push((code, value)),
            (_, None) => {}
        }
    }
    match records.iter().any(|r| r.kind == "SECTION") {
        true => Ok(records),
        false => Err(DataError::new("it has no section", EXPORT)),
    }
}

/// The records of a section; none if there is no such section.
///
/// # Errors
/// [`DataError`] for a section without an end.
pub(super) fn section<'a, 'b>(
    records: &'b [Record<'a>],
    name: &str,
) -> Result<&'b [Record<'a>], DataError> {
    let is_begin = |r: &Record<'_>| r.kind == "SECTION" && r.text(2) == Some(name);
    let Some(begin) = records.iter().position(is_begin) else {
        return Ok(&[]);
    };
    let rest = &records[begin + 1..];
    match rest.iter().position(|r| r.kind == "ENDSEC") {
        Some(end) => Ok(&rest[..end]),
        None => Err(truncated(records[records.len() - 1].line)),
    }
}

/// The error of a file that ends too early.
fn truncated(line: usize) -> DataError {
    let message = format!("line {line}: the file ends in the middle of a section");
    let remedy = "it is not complete: copy or export it again";
    DataError::new(message, remedy).at(line)
}

impl<'a> Record<'a> {
    /// The first value of a group.
    pub(super) fn text(&self, code: i32) -> Option<&'a str> {
        self.groups.iter().find(|g| g.0 == code).map(|g| g.1)
    }

    /// The first number of a group.
    pub(super) fn number(&self, code: i32) -> Result<Option<f64>, DataError> {
        self.text(code)
            .map(|text| self.parse(code, text))
            .transpose()
    }

    /// The first number of a group, which has to be there.
    pub(super) fn needed(&self, code: i32) -> Result<f64, DataError> {
        self.number(code)?.ok_or_else(|| {
            let message = format!("line {}: {} has no group {code}", self.line, self.kind);
            DataError::new(message, EXPORT).at(self.line)
        })
    }

    /// The first number of a group that is whole, 0 if there is none.
    pub(super) fn flags(&self, code: i32) -> Result<i64, DataError> {
        Ok(self.number(code)?.unwrap_or(0.0) as i64)
    }

    /// The numbers of all groups with a code.
    pub(super) fn numbers(&self, code: i32) -> Result<Vec<f64>, DataError> {
        let own = self.groups.iter().filter(|g| g.0 == code);
        own.map(|(_, text)| self.parse(code, text)).collect()
    }

    /// The point of two groups.
    pub(super) fn point(&self, code: i32) -> Result<[f64; 2], DataError> {
        Ok([self.needed(code)?, self.needed(code + 10)?])
    }

    /// The value of a variable of the header.
    pub(super) fn after(&self, variable: &str) -> Option<&'a str> {
        let mut groups = self.groups.iter();
        groups.find(|g| **g == (9, variable))?;
        groups.next().map(|g| g.1)
    }

    pub(super) fn parse(&self, code: i32, text: &str) -> Result<f64, DataError> {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => {
                let found: String = text.chars().take(30).collect();
                let message = format!(
                    "line {}: {} has {found:?} for group {code}, which is no number",
                    self.line, self.kind
                );
                Err(DataError::new(message, EXPORT).at(self.line))
            }
        }
    }
}
