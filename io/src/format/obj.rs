//! Reading Wavefront OBJ files.
//!
//! This crate has its own reader because a sheet needs what general readers do not keep: the numbering of the
//! vertices (scenes hold "vertex 0"), vertices shared between groups, all digits, and the line of an error.

use std::path::{Path, PathBuf};

use isosheet_mesh::Sheet;

use crate::format::obj_error::{ObjError, ObjProblem};
use crate::format::polygon;

/// What to do with faces of more than three corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Polygons {
    /// Refuse the file. A polygon's diagonals would be creases that its author did not draw.
    #[default]
    Refuse,
    /// Cut each polygon into triangles from that one of its corners which sees all others and needs the
    /// shortest cuts (so a quad is cut along its shorter diagonal). [`ObjMesh::polygons`] tells how many
    /// there were.
    Triangulate,
}

/// How to read an OBJ file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjOptions {
    /// Faces of more than three corners: refused unless asked otherwise.
    pub polygons: Polygons,
}

/// The vertices and triangles of an OBJ file, as numbered there (from 0), not yet checked to be a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjMesh {
    /// Coordinates x0 y0 z0 x1 ..., in the file's unit and axes.
    pub positions: Vec<f64>,
    /// Triangles, as wound in the file.
    pub faces: Vec<[u32; 3]>,
    /// How many faces had more than three corners and were cut.
    pub polygons: usize,
    path: PathBuf,
}

impl ObjMesh {
    /// The number of vertices, used or not.
    pub fn vertex_count(&self) -> usize {
        self.positions.len() / 3
    }

    /// Removes vertices that belong to no face and renumbers the rest in order; returns how many were
    /// removed.
    pub fn drop_unreferenced(&mut self) -> usize {
        let mut used = vec![false; self.vertex_count()];
        for &v in self.faces.iter().flatten() {
            used[v as usize] = true;
        }
        let mut label = vec![0u32; used.len()];
        let mut kept = Vec::with_capacity(self.positions.len());
        for (v, _) in used.iter().enumerate().filter(|(_, u)| **u) {
            label[v] = (kept.len() / 3) as u32;
            kept.extend_from_slice(&self.positions[3 * v..3 * v + 3]);
        }
        for v in self.faces.iter_mut().flatten() {
            *v = label[*v as usize];
        }
        let removed = used.len() - kept.len() / 3;
        self.positions = kept;
        removed
    }

    /// Checks that the faces are an oriented surface of rigid triangles, and makes it a sheet.
    ///
    /// # Errors
    /// [`ObjProblem::Mesh`] with the file's name. Indices in it are counted from 0.
    pub fn into_sheet(self) -> Result<Sheet, ObjError> {
        let Self {
            positions,
            faces,
            path,
            ..
        } = self;
        Sheet::new(positions, &faces).map_err(|e| ObjError {
            path,
            line: None,
            problem: e.into(),
        })
    }
}

/// Reads the vertices and faces of an OBJ file.
///
/// Understood: `v`, `f` (indices from 1, or negative and counted backwards; texture and normal indices are
/// skipped), line continuation by a backslash, comments. Groups, objects, materials, normals, texture
/// coordinates, colours, lines and points are skipped.
///
/// # Errors
/// [`ObjError`] with file, line and what is wrong.
pub fn read_obj(path: &Path, options: &ObjOptions) -> Result<ObjMesh, ObjError> {
    let bytes = std::fs::read(path).map_err(|e| ObjError {
        path: path.to_owned(),
        line: None,
        problem: ObjProblem::Read(e),
    })?;
    parse_obj(&bytes, path, options)
}

/// Reads a sheet from an OBJ file with default options: triangles only, an oriented surface that uses every
/// vertex.
///
/// # Errors
/// [`ObjError`] with file, line and what is wrong.
pub fn read_sheet(path: &Path) -> Result<Sheet, ObjError> {
    read_obj(path, &ObjOptions::default())?.into_sheet()
}

/// [`read_obj`] for text in memory; `path` is used in errors only.
///
/// # Errors
/// As [`read_obj`].
pub fn parse_obj(bytes: &[u8], path: &Path, options: &ObjOptions) -> Result<ObjMesh, ObjError> {
    let mut parser = Parser::default();
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
        result.map_err(|problem| ObjError {
            path: path.to_owned(),
            line: Some(first),
            problem,
        })?;
    }
    let error = |line, problem| ObjError {
        path: path.to_owned(),
        line,
        problem,
    };
    if !joined.is_empty() {
        parser
            .line(&joined, first)
            .map_err(|problem| error(Some(first), problem))?;
    }
    parser
        .finish(path, options)
        .map_err(|(line, problem)| error(line, problem))
}

/// What is wrong, with its line where there is one.
type Located = (Option<usize>, ObjProblem);

#[derive(Default)]
struct Parser {
    positions: Vec<f64>,
    /// Zero-based corners of all faces, one after the other; whether each exists is known at the end only.
    corners: Vec<i64>,
    /// End of each face in `corners`, and its line.
    ends: Vec<(usize, usize)>,
    lines: usize,
    points: usize,
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
    fn line(&mut self, line: &str, number: usize) -> Result<(), ObjProblem> {
        let content = line.split('#').next().unwrap_or_default();
        let mut words = content.split_whitespace();
        match words.next() {
            None => {}
            Some("v") => self.vertex(content)?,
            Some("f" | "fo") => {
                for w in words {
                    let corner = self.corner(w)?;
                    self.corners.push(corner);
                }
                self.ends.push((self.corners.len(), number));
            }
            Some("l") => self.lines += 1,
            Some("p") => self.points += 1,
            Some(word) if SKIPPED.contains(&word) => {}
            Some(word) => {
                let short = || word.chars().take(30).collect();
                self.unknown.get_or_insert_with(|| (number, short()));
            }
        }
        Ok(())
    }

    fn vertex(&mut self, content: &str) -> Result<(), ObjProblem> {
        let words: Vec<&str> = content.split_whitespace().skip(1).collect();
        let bad = || ObjProblem::BadVertex {
            found: words.join(" "),
        };
        let vertex = self.positions.len() / 3 + 1;
        if words.len() < 3 {
            return Err(bad());
        }
        for (axis, w) in words[..3].iter().enumerate() {
            let value: f64 = w.parse().map_err(|_| bad())?;
            if !value.is_finite() {
                return Err(ObjProblem::NonFinite {
                    vertex,
                    axis,
                    value,
                });
            }
            self.positions.push(value);
        }
        // Three further numbers are a colour; a single one is a weight.
        if let [_, _, _, w] = words[..] {
            let weight: f64 = w.parse().map_err(|_| bad())?;
            if weight != 1.0 {
                return Err(ObjProblem::Weight { vertex, weight });
            }
        }
        Ok(())
    }

    fn corner(&self, word: &str) -> Result<i64, ObjProblem> {
        let count = self.positions.len() / 3;
        let index = word.split('/').next().unwrap_or_default();
        match index.parse::<i64>() {
            Ok(k) if k > 0 => Ok(k - 1),
            // Backwards from the vertices read so far.
            Ok(k) if k < 0 && k.unsigned_abs() as usize <= count => Ok(count as i64 + k),
            Ok(index) => Err(ObjProblem::IndexOutOfRange { index, count }),
            Err(_) => Err(ObjProblem::BadIndex {
                found: word.chars().take(30).collect(),
            }),
        }
    }

    fn finish(self, path: &Path, options: &ObjOptions) -> Result<ObjMesh, Located> {
        if let Some(missing) = self.missing() {
            return Err(missing);
        }
        let (faces, polygons) = self.triangles(options)?;
        Ok(ObjMesh {
            positions: self.positions,
            faces,
            polygons,
            path: path.to_owned(),
        })
    }

    /// What a mesh needs and the file does not have.
    fn missing(&self) -> Option<Located> {
        let vertices = self.positions.len() / 3;
        let faces = self.ends.len();
        match (vertices, faces, &self.unknown) {
            (0, 0, None) => Some((None, ObjProblem::Empty)),
            (0, 0, Some((line, word))) => {
                let word = word.clone();
                Some((Some(*line), ObjProblem::NotObj { word }))
            }
            (0, _, _) => Some((None, ObjProblem::NoVertices { faces })),
            (_, 0, _) => {
                let (lines, points) = (self.lines, self.points);
                let problem = ObjProblem::NoFaces {
                    vertices,
                    lines,
                    points,
                };
                Some((None, problem))
            }
            _ => None,
        }
    }

    /// The triangles of all faces, and how many faces were cut.
    fn triangles(&self, options: &ObjOptions) -> Result<(Vec<[u32; 3]>, usize), Located> {
        let mut faces = Vec::with_capacity(self.ends.len());
        let mut polygons = 0;
        let mut start = 0;
        for &(end, line) in &self.ends {
            let fail = |problem| (Some(line), problem);
            let face = self.checked(&self.corners[start..end]).map_err(fail)?;
            start = end;
            let corners = face.len();
            match face[..] {
                [a, b, c] => faces.push([a, b, c]),
                [] | [_] | [_, _] => return Err(fail(ObjProblem::TooFewCorners { corners })),
                _ if options.polygons == Polygons::Refuse => {
                    return Err(fail(ObjProblem::Polygon { corners }));
                }
                _ => {
                    let cut = polygon::triangulate(&face, |v| self.position(v));
                    faces.extend(cut.ok_or_else(|| fail(ObjProblem::ConcavePolygon { corners }))?);
                    polygons += 1;
                }
            }
        }
        Ok((faces, polygons))
    }

    /// The corners of a face as vertex numbers, all of which the file has.
    fn checked(&self, corners: &[i64]) -> Result<Vec<u32>, ObjProblem> {
        let count = self.positions.len() / 3;
        let vertex = |&k: &i64| match u32::try_from(k) {
            Ok(v) if (v as usize) < count => Ok(v),
            _ => Err(ObjProblem::IndexOutOfRange {
                index: k + 1,
                count,
            }),
        };
        corners.iter().map(vertex).collect()
    }

    fn position(&self, v: u32) -> [f64; 3] {
        let k = 3 * v as usize;
        [
            self.positions[k],
            self.positions[k + 1],
            self.positions[k + 2],
        ]
    }
}

#[cfg(test)]
mod tests;
