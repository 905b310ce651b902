//! Reading Wavefront OBJ files.
//!
//! This crate has its own reader because a sheet needs what general readers do not keep: the numbering of the
//! vertices (scenes hold "vertex 0"), vertices shared between groups, all digits, and the line of an error.

use super::error::{Located, Location, excerpt, no_such_vertex};
use super::faces::Polyhedron;
use crate::format::DataError;
use isosheet_mesh::wording::given;

/// Reads the vertices and faces of an OBJ file.
///
/// Understood: `v`, `f` (indices from 1, or negative and counted backwards; texture and normal indices are
/// skipped), line continuation by a backslash, comments. Groups, objects, materials, normals, texture
/// coordinates, colours, lines and points are skipped.
pub(super) fn parse(bytes: &[u8]) -> Result<Polyhedron, Located> {
    let mut parser = Parser {
        mesh: Polyhedron::counted_from(1),
        unknown: None,
    };
    // Names may be in any encoding; numbers are ASCII.
    let text = String::from_utf8_lossy(bytes);
    let mut joined = String::new();
    let mut first = 0;
    for (k, line) in text.lines().enumerate() {
        if joined.is_empty() {
            first = k + 1;
        }
        if let Some(part) = line.trim_end().strip_suffix('\\') {
            joined.push_str(part);
            joined.push(' ');
            continue;
        }
        let result = if joined.is_empty() {
            parser.line(line, first)
        } else {
            joined.push_str(line);
            let whole = std::mem::take(&mut joined);
            parser.line(&whole, first)
        };
        result.map_err(|problem| (Some(Location::Line(first)), problem.into()))?;
    }
    if !joined.is_empty() {
        parser
            .line(&joined, first)
            .map_err(|problem| (Some(Location::Line(first)), problem.into()))?;
    }
    parser.finish()
}

struct Parser {
    mesh: Polyhedron,
    unknown: Option<(usize, String)>,
}

/// Words that begin the other lines of an OBJ file.
const SKIPPED: [&str; 22] = [
    "vt",
    "vn",
    "vp",
    "g",
    "o",
    "s",
    "usemtl",
    "mtllib",
    "mg",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
    "deg",
    "bmat",
    "step",
    "cstype",
    "curv",
    "surf",
    "end",
];

impl Parser {
    fn line(&mut self, line: &str, number: usize) -> Result<(), DataError> {
        let content = line.split('#').next().unwrap_or_default();
        let mut words = content.split_whitespace();
        match words.next() {
            None => {}
            Some("v") => self.vertex(content)?,
            Some("f" | "fo") => {
                let corners: Vec<i64> = words.map(|w| self.corner(w)).collect::<Result<_, _>>()?;
                self.mesh.push_face(corners, Location::Line(number));
            }
            Some("l") => self.mesh.lines += 1,
            Some("p") => self.mesh.points += 1,
            Some(word) if SKIPPED.contains(&word) => {}
            Some(word) => {
                self.unknown.get_or_insert_with(|| (number, excerpt(word)));
            }
        }
        Ok(())
    }

    fn vertex(&mut self, content: &str) -> Result<(), DataError> {
        let words: Vec<&str> = content.split_whitespace().skip(1).collect();
        let bad = || {
            let found = excerpt(&words.join(" "));
            let message = format!("a vertex needs three numbers, found {found:?}");
            DataError::new(message, "write `v x y z`")
        };
        let [x, y, z, ..] = words[..] else {
            return Err(bad());
        };
        let number = |w: &str| w.parse::<f64>().map_err(|_| bad());
        self.mesh
            .push_vertex([number(x)?, number(y)?, number(z)?])?;
        // Three further numbers are a colour; a single one is a weight.
        if let [_, _, _, w] = words[..] {
            let weight = number(w)?;
            let vertex = self.mesh.positions.len() / 3;
            if weight != 1.0 {
                let message = format!(
                    "vertex {vertex} has the weight {}, and weights, which belong to curves, are not supported",
                    given(weight)
                );
                let error = DataError::new(message, "write the point itself");
                return Err(error.at(vertex).value(weight));
            }
        }
        Ok(())
    }

    fn corner(&self, word: &str) -> Result<i64, DataError> {
        let count = self.mesh.positions.len() / 3;
        let index = word.split('/').next().unwrap_or_default();
        match index.parse::<i64>() {
            Ok(k) if k > 0 => Ok(k - 1),
            // Backwards from the vertices read so far.
            Ok(k) if k < 0 && k.unsigned_abs() as usize <= count => Ok(count as i64 + k),
            Ok(index) => Err(no_such_vertex(index, count, 1)),
            Err(_) => {
                let message = format!("{:?} is not a vertex index", excerpt(word));
                let remedy = "write `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`";
                Err(DataError::new(message, remedy))
            }
        }
    }

    fn finish(self) -> Result<Polyhedron, Located> {
        match self.unknown {
            Some((line, word)) if self.mesh.positions.is_empty() && self.mesh.face_count() == 0 => {
                let message =
                    format!("the file has no vertices, and its first unknown word is {word:?}");
                let error = DataError::new(message, "check that it is an OBJ file");
                Err((Some(Location::Line(line)), error.into()))
            }
            _ => Ok(self.mesh),
        }
    }
}

#[cfg(test)]
mod tests;
