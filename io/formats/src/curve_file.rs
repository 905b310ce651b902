//! Curves in files: the points of a polygon in space.

use isosheet_files::{DataError, FileError, input};
use std::path::Path;

/// What to do about a file that is none of a curve.
const REMEDY: &str = "write a line with x, y and z for each point, or vertices and one line (`l`) in a file that ends with .obj";

/// Reads the points of a curve: [`parse_curve`].
///
/// # Errors
/// [`FileError`] with the file and what is wrong.
pub fn read_curve(path: &Path) -> Result<Vec<[f64; 3]>, FileError> {
    let bytes = input::read(path).map_err(|e| FileError::unreadable(path, e))?;
    parse_curve(&bytes, path)
}

/// The points of a curve. In an OBJ file (.obj) they are the vertices of its lines `l`, which have to follow
/// one another, or all vertices where it has no lines. Any other file has a point on each line: three numbers
/// with blanks, commas or semicolons between them; a line that begins with `#` is a comment, and a first line
/// of words is a heading. Points have the unit of the file.
///
/// ```
/// let text = "x, y, z\n0, 0, 0\n1, 0, 0.5\n";
/// let points = isosheet_formats::parse_curve(text.as_bytes(), "rail.csv".as_ref())?;
/// assert_eq!(points, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5]]);
/// # Ok::<(), isosheet_files::FileError>(())
/// ```
///
/// # Errors
/// [`FileError`] with the line and what is wrong there, or for fewer than two points.
pub fn parse_curve(bytes: &[u8], path: &Path) -> Result<Vec<[f64; 3]>, FileError> {
    let text = String::from_utf8_lossy(input::without_mark(bytes));
    let is_obj = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let points = if is_obj {
        of_obj(&text)
    } else {
        of_lines(&text)
    };
    let points = points.and_then(|points| match points.len() {
        0 | 1 => {
            let message = "it has fewer than two points of a curve";
            Err(DataError::new(message, REMEDY))
        }
        _ => Ok(points),
    });
    points.map_err(|e| FileError::content(path, e, REMEDY))
}

/// Three finite numbers.
fn point<'a>(words: impl Iterator<Item = &'a str>) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = words
        .map(|word| word.parse().ok().filter(|c: &f64| c.is_finite()))
        .collect::<Option<_>>()?;
    numbers.try_into().ok()
}

fn wrong(line: usize, what: &str) -> DataError {
    DataError::new(format!("line {}: {what}", line + 1), REMEDY).at(line + 1)
}

fn of_lines(text: &str) -> Result<Vec<[f64; 3]>, DataError> {
    let mut points = Vec::new();
    let lines = text.lines().map(str::trim).enumerate();
    let lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    for (place, (number, line)) in lines.enumerate() {
        let words = || {
            line.split([' ', '\t', ',', ';'])
                .filter(|word| !word.is_empty())
        };
        match point(words()) {
            Some(point) => points.push(point),
            None if place == 0 && words().all(|word| word.parse::<f64>().is_err()) => {}
            None => return Err(wrong(number, "it does not have three finite numbers")),
        }
    }
    Ok(points)
}

fn of_obj(text: &str) -> Result<Vec<[f64; 3]>, DataError> {
    let mut vertices = Vec::new();
    let mut chain: Vec<usize> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let point = point(words.take(3));
                vertices
                    .push(point.ok_or_else(|| wrong(number, "a vertex lacks a finite number"))?);
            }
            Some("l") => {
                for (k, word) in words.enumerate() {
                    let index: Option<i64> = word.split('/').next().and_then(|w| w.parse().ok());
                    let index = index.and_then(|index| match index {
                        1.. => usize::try_from(index - 1).ok(),
                        // It counts back from the last vertex before.
                        _ => vertices
                            .len()
                            .checked_sub(usize::try_from(index.unsigned_abs()).ok()?),
                    });
                    let index = index.filter(|v| *v < vertices.len());
                    let v = index
                        .ok_or_else(|| wrong(number, "a line has a vertex that is not there"))?;
                    match chain.last() {
                        Some(last) if k == 0 && *last != v => {
                            return Err(wrong(number, "a second line begins elsewhere"));
                        }
                        Some(_) if k == 0 => {}
                        _ => chain.push(v),
                    }
                }
            }
            _ => {}
        }
    }
    Ok(match chain.is_empty() {
        true => vertices,
        false => chain.into_iter().map(|v| vertices[v]).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(name: &str, text: &str) -> Result<Vec<[f64; 3]>, String> {
        parse_curve(text.as_bytes(), Path::new(name)).map_err(|e| e.to_string())
    }

    #[test]
    fn points_are_read_in_their_order() {
        let points = vec![[0.0, 1.0, 2.0], [3.0, 4.0, -5e-1]];
        for text in [
            "0 1 2\n3 4 -0.5",
            "# a rail\nx;y;z\n0;1;2\n\n3;4;-0.5\n",
            "0,\t1, 2\r\n3,4,-.5",
        ] {
            assert_eq!(parsed("rail.txt", text).as_ref(), Ok(&points), "{text}");
        }
        let obj = "v 3 4 -0.5\nv 9 9 9\nv 0 1 2\n";
        assert_eq!(
            parsed("rail.obj", &format!("{obj}l 3 1\n")),
            Ok(points.clone())
        );
        assert_eq!(parsed("rail.OBJ", &format!("{obj}l -1 1\n")), Ok(points));
        assert_eq!(parsed("rail.obj", obj).unwrap().len(), 3);
        assert_eq!(
            parsed("rail.obj", &format!("{obj}l 3 1\nl 1 2\n"))
                .unwrap()
                .len(),
            3
        );
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        for (name, text, expected) in [
            ("a.csv", "", "fewer than two points"),
            ("a.csv", "1 2 3", "fewer than two points"),
            ("a.csv", "1 2 3\n1 2", "line 2"),
            ("a.csv", "1 2 3\n1 2 nan", "line 2"),
            ("a.csv", "1 2 3\nx y z", "line 2"),
            ("a.obj", "v 1 2\n", "line 1"),
            ("a.obj", "v 1 2 3\nv 2 2 2\nl 1 3\n", "line 3"),
            (
                "a.obj",
                "v 1 2 3\nv 2 2 2\nv 0 0 0\nl 1 2\nl 3 1\n",
                "line 5",
            ),
            ("a.obj", "v 1 2 3\nl 1 -9223372036854775808\n", "line 2"),
        ] {
            let error = parsed(name, text).unwrap_err();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
    }
}
