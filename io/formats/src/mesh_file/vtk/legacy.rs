//! Legacy files of VTK (`.vtk`), text or binary.

use super::{TimedPolygons, other_data, plain, strips};
use crate::mesh_file::error::{COPY, Located, Location, announced, cut_short, excerpt, unexpected};
use isosheet_files::DataError;

/// The points and polygons of a data set `POLYDATA`, and the field `TimeValue`. Vertices, lines and data of
/// points and cells are skipped.
pub(in crate::mesh_file) fn parse(bytes: &[u8]) -> Result<TimedPolygons, Located> {
    let mut file = Cursor { bytes, place: 0 };
    let read = polygons(&mut file);
    read.map_err(|problem| (Some(Location::Byte(file.place)), problem.into()))
        .and_then(|contents: Contents| {
            let mut found = TimedPolygons {
                time: contents.time,
                ..TimedPolygons::default()
            };
            let added = found.add(&contents.points, &contents.corners, &contents.ends);
            added.map_err(plain).map(|()| found)
        })
}

#[derive(Default)]
struct Contents {
    points: Vec<f64>,
    corners: Vec<i64>,
    ends: Vec<i64>,
    time: Option<f64>,
}

fn polygons(file: &mut Cursor<'_>) -> Result<Contents, DataError> {
    let mut found = Contents::default();
    if file.bytes.is_empty() {
        return Ok(found);
    }
    let head = file.line();
    if !head.starts_with("# vtk DataFile") {
        return Err(unexpected("# vtk DataFile Version", &excerpt(&head)));
    }
    file.line();
    let form = match file.line().trim().to_ascii_uppercase().as_str() {
        "ASCII" => Form::Text,
        "BINARY" => Form::Binary,
        other => return Err(unexpected("ASCII or BINARY", &excerpt(other))),
    };
    while let Some(word) = file.word() {
        match word.to_ascii_uppercase().as_str() {
            "DATASET" => match file.needed("the kind of the data")? {
                kind if kind.eq_ignore_ascii_case("POLYDATA") => {}
                kind => return Err(other_data(&excerpt(&kind))),
            },
            "POINTS" => {
                let count = file.count("the number of points")?;
                found.points = file.numbers(form, count.saturating_mul(3))?;
            }
            "POLYGONS" => [found.ends, found.corners] = file.cells(form)?,
            "VERTICES" | "LINES" => drop(file.cells(form)?),
            "TRIANGLE_STRIPS" => return Err(strips()),
            "FIELD" => {
                file.needed("the name of a field")?;
                for _ in 0..file.count("the number of arrays of a field")? {
                    let name = file.needed("the name of an array")?;
                    let size = file.count("the number of components")?;
                    let size = size.saturating_mul(file.count("the number of tuples")?);
                    let values = file.numbers(form, size)?;
                    if name == "TimeValue" {
                        found.time = values.first().copied();
                    }
                }
            }
            // Information on an array, which ends with an empty line.
            "METADATA" => {
                file.line();
                while file.place < file.bytes.len() && !file.line().trim().is_empty() {}
            }
            "POINT_DATA" | "CELL_DATA" => break,
            other => return Err(unexpected("POINTS or POLYGONS", &excerpt(other))),
        }
    }
    Ok(found)
}

/// How numbers are written.
#[derive(Clone, Copy)]
enum Form {
    Text,
    /// The byte of the largest value first.
    Binary,
}

/// The part of a file that has not been read.
struct Cursor<'a> {
    bytes: &'a [u8],
    place: usize,
}

impl Cursor<'_> {
    fn rest(&self) -> &[u8] {
        &self.bytes[self.place..]
    }

    /// What is left of the line.
    fn line(&mut self) -> String {
        let rest = self.rest();
        let length = rest.iter().position(|b| *b == b'\n');
        let line = &rest[..length.unwrap_or(rest.len())];
        let line = String::from_utf8_lossy(line).into_owned();
        self.place += length.map_or(self.rest().len(), |length| length + 1);
        line
    }

    /// The next word.
    fn word(&mut self) -> Option<String> {
        let rest = self.rest();
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let word = &rest[start..];
        let length = word.iter().position(u8::is_ascii_whitespace);
        let length = length.unwrap_or(word.len());
        let word = String::from_utf8_lossy(&word[..length]).into_owned();
        self.place += start + length;
        Some(word)
    }

    fn needed(&mut self, what: &str) -> Result<String, DataError> {
        self.word().ok_or_else(|| cut_short(what))
    }

    fn count(&mut self, what: &str) -> Result<usize, DataError> {
        let word = self.needed(what)?;
        word.parse().map_err(|_| unexpected(what, &excerpt(&word)))
    }

    /// So many numbers after the name of their type.
    fn numbers<T: Number>(&mut self, form: Form, count: usize) -> Result<Vec<T>, DataError> {
        let kind = self.needed("the type of an array")?.to_ascii_lowercase();
        match form {
            Form::Text => {
                let enough = count <= self.rest().len();
                let words = (0..if enough { count } else { 0 }).map(|k| {
                    let word = self.needed(&format!("number {k} of {count}"))?;
                    T::of_text(&word).ok_or_else(|| unexpected("a number", &excerpt(&word)))
                });
                let values: Vec<T> = words.collect::<Result<_, _>>()?;
                if enough {
                    Ok(values)
                } else {
                    Err(cut_short(&format!("{count} numbers")))
                }
            }
            Form::Binary => {
                self.line();
                let size = match &kind[..] {
                    "char" | "unsigned_char" => 1,
                    "short" | "unsigned_short" => 2,
                    "int" | "unsigned_int" | "float" => 4,
                    "double" | "long" | "unsigned_long" | "vtkidtype" | "vtktypeint64" => 8,
                    other => return Err(unexpected("the type of an array", &excerpt(other))),
                };
                let (needed, left) = (count.saturating_mul(size), self.rest().len());
                let bytes = self.rest().get(..needed).ok_or_else(|| {
                    announced("numbers", count as u64, needed as u64, left as u64)
                })?;
                let values = bytes.chunks_exact(size).map(|b| T::of_bytes(&kind, b));
                let values: Option<Vec<T>> = values.collect();
                self.place += needed;
                values.ok_or_else(|| unexpected("an array of another type", &kind))
            }
        }
    }

    /// Where each cell ends among the corners, and the corners.
    fn cells(&mut self, form: Form) -> Result<[Vec<i64>; 2], DataError> {
        let first = self.count("the number of cells")?;
        let size = self.count("the size of the list of cells")?;
        let mut ahead = Cursor {
            bytes: self.bytes,
            place: self.place,
        };
        // Files of version 5 have the places in the list and the list itself.
        if ahead.word().as_deref() == Some("OFFSETS") {
            self.place = ahead.place;
            let mut ends: Vec<i64> = self.numbers(form, first)?;
            let word = self.needed("the word CONNECTIVITY")?;
            if word != "CONNECTIVITY" {
                return Err(unexpected("the word CONNECTIVITY", &excerpt(&word)));
            }
            let corners = self.numbers(form, size)?;
            // The first place is that where the list begins.
            ends.drain(..ends.len().min(1));
            return Ok([ends, corners]);
        }
        let list: Vec<i64> = match form {
            Form::Text => {
                let values = (0..size.min(self.rest().len())).map(|k| {
                    let word = self.needed(&format!("number {k} of {size}"))?;
                    word.parse()
                        .map_err(|_| unexpected("the number of a point", &excerpt(&word)))
                });
                values.collect::<Result<_, _>>()?
            }
            Form::Binary => {
                self.line();
                let (needed, left) = (size.saturating_mul(4), self.rest().len());
                let bytes = self.rest().get(..needed);
                let bytes = bytes
                    .ok_or_else(|| announced("numbers", size as u64, needed as u64, left as u64))?;
                let values = bytes.as_chunks().0.iter();
                let values = values.map(|b| i64::from(i32::from_be_bytes(*b))).collect();
                self.place += needed;
                values
            }
        };
        let (mut ends, mut corners) = (Vec::new(), Vec::new());
        let mut rest = &list[..];
        while let [count, after @ ..] = rest {
            let own = usize::try_from(*count).ok().and_then(|n| after.get(..n));
            let own = own.ok_or_else(|| {
                let message = format!(
                    "cell {} has {count} corners, and {} numbers follow",
                    ends.len(),
                    after.len()
                );
                DataError::new(message, COPY).at(ends.len())
            })?;
            corners.extend_from_slice(own);
            ends.push(corners.len() as i64);
            rest = &after[own.len()..];
        }
        if ends.len() != first {
            let message = format!(
                "{first} cells are announced, and {} are in the list",
                ends.len()
            );
            return Err(DataError::new(message, COPY));
        }
        Ok([ends, corners])
    }
}

/// What arrays hold.
trait Number: Sized {
    fn of_text(word: &str) -> Option<Self>;
    /// Nothing for a type that has no such numbers.
    fn of_bytes(kind: &str, bytes: &[u8]) -> Option<Self>;
}

impl Number for f64 {
    fn of_text(word: &str) -> Option<Self> {
        word.parse().ok()
    }

    fn of_bytes(kind: &str, bytes: &[u8]) -> Option<Self> {
        match kind {
            "float" => Some(f32::from_be_bytes(bytes.try_into().ok()?).into()),
            "double" => Some(Self::from_be_bytes(bytes.try_into().ok()?)),
            _ => i64::of_bytes(kind, bytes).map(|integer| integer as f64),
        }
    }
}

impl Number for i64 {
    fn of_text(word: &str) -> Option<Self> {
        word.parse().ok()
    }

    fn of_bytes(kind: &str, bytes: &[u8]) -> Option<Self> {
        let is_signed = !kind.starts_with("unsigned");
        match (bytes, kind) {
            (_, "float" | "double") => None,
            ([byte], _) if is_signed => Some((*byte as i8).into()),
            ([byte], _) => Some((*byte).into()),
            (&[a, b], _) if is_signed => Some(i16::from_be_bytes([a, b]).into()),
            (&[a, b], _) => Some(u16::from_be_bytes([a, b]).into()),
            (&[a, b, c, d], _) if is_signed => Some(i32::from_be_bytes([a, b, c, d]).into()),
            (&[a, b, c, d], _) => Some(u32::from_be_bytes([a, b, c, d]).into()),
            _ => Some(Self::from_be_bytes(bytes.try_into().ok()?)),
        }
    }
}
