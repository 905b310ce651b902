//! Reading Wavefront OBJ files.
//!
//! This crate has its own reader because a sheet needs what general readers do not keep: the numbering of the
//! vertices (scenes hold "vertex 0"), vertices shared between groups, all digits, and the line of an error.

use super::error::{Located, Location, excerpt, no_such_vertex};
use super::faces::Polyhedron;
use isosheet_files::DataError;
use isosheet_mesh::wording::given;

/// Reads the vertices and faces of an OBJ file.
///
/// Understood: `v`, `vt`, `f` (indices from 1, or negative and counted backwards; indices of normals are
/// skipped), `g`, `o` and `usemtl` as groups of the faces that follow, line continuation by a backslash,
/// comments. Normals, colours, lines and points are skipped. Texture coordinates that are not finite or not
/// there are none.
pub(super) fn parse(bytes: &[u8]) -> Result<Polyhedron, Located> {
    let mut parser = Parser {
        mesh: Polyhedron::counted_from(1),
        unknown: None,
        texture: Vec::new(),
        groups: Default::default(),
    };
    // Names may be in any encoding; numbers are ASCII.
    let text = String::from_utf8_lossy(bytes);
    let mut joined = String::new();
    let mut first = 0;
    for (k, line) in text.lines().enumerate() {
        if joined.is_empty() {
            first = k + 1;
        }
        let is_comment = joined.is_empty() && line.trim_start().starts_with('#');
        if let Some(part) = line.trim_end().strip_suffix('\\').filter(|_| !is_comment) {
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
    /// Texture coordinates read so far.
    texture: Vec<Option<[f64; 2]>>,
    /// Names by which the faces that follow are grouped: those after `g`, after `o` and after `usemtl`.
    groups: [Vec<String>; 3],
}

/// Words that begin the other lines of an OBJ file.
const SKIPPED: [&str; 18] = [
    "vn",
    "vp",
    "s",
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
                let corners = words.clone().map(|w| self.corner(w));
                let corners: Vec<i64> = corners.collect::<Result<_, _>>()?;
                self.mesh.push_face(corners, Location::Line(number));
                let texture: Vec<_> = words.map(|w| self.texture_at(w)).collect();
                if texture.iter().any(Option::is_some) {
                    self.mesh.push_texture(texture);
                }
                for name in self.groups.iter().flatten() {
                    self.mesh.push_group(name);
                }
            }
            Some("vt") => self.texture.push(texture(words)?),
            Some("g") => self.groups[0] = words.map(str::to_owned).collect(),
            // Their names may have spaces.
            Some("o") => self.groups[1] = name(words),
            Some("usemtl") => self.groups[2] = name(words),
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

    /// The texture coordinates of a corner.
    fn texture_at(&self, word: &str) -> Option<[f64; 2]> {
        let index = word.split('/').nth(1)?.parse::<i64>().ok()?;
        let count = self.texture.len() as i64;
        let number = if index > 0 {
            index - 1
        } else {
            count.checked_add(index)?
        };
        *self.texture.get(usize::try_from(number).ok()?)?
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

/// The name that some words are, if there are any.
fn name<'a>(words: impl Iterator<Item = &'a str>) -> Vec<String> {
    let name = words.collect::<Vec<_>>().join(" ");
    Vec::from_iter((!name.is_empty()).then_some(name))
}

/// The texture coordinates on a line, the second of which may be left out; none where they are not finite.
fn texture<'a>(
    words: impl Iterator<Item = &'a str> + Clone,
) -> Result<Option<[f64; 2]>, DataError> {
    let numbers = words.clone().map(str::parse::<f64>);
    match numbers.collect::<Result<Vec<_>, _>>().as_deref() {
        Ok([u]) => Ok(Some([*u, 0.0])),
        Ok([u, v, ..]) => Ok(Some([*u, *v])),
        Ok([]) | Err(_) => {
            let found = excerpt(&words.collect::<Vec<_>>().join(" "));
            let message = format!("texture coordinates are numbers, found {found:?}");
            Err(DataError::new(message, "write `vt u v`"))
        }
    }
    .map(|uv| uv.filter(|uv| uv.iter().all(|c| c.is_finite())))
}

#[cfg(test)]
mod tests;
