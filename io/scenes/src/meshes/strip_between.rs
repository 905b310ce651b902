//! Strips between two curves.

use crate::meshes::mesh_file::Files;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_files::FileError;
use isosheet_formats::parse_curve;
use isosheet_mesh::generate::{self, GenerateError, RuledStrip};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::path::PathBuf;

/// The strip between two curves that is developable, or as nearly so as it can be: its rulings join points of
/// the curves whose tangents lie in one plane with the ruling. Both curves go smoothly through their points
/// from start to end; if both are closed (the last point is the first one) the strip is. The strip starts in
/// its place in space, and its edges keep the lengths that they have there.
///
/// ```toml
/// [sheet.mesh.strip_between]
/// first = [[0, 0, 0], [0.1, 0.02, 0], [0.2, 0, 0]]
/// second = [[0, 0, 0.1], [0.1, 0.03, 0.1], [0.2, 0, 0.1]]
/// columns = 20
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct StripBetween {
    /// The first curve.
    pub first: StripCurve,
    /// The second curve. One that runs against the first one is reversed.
    pub second: StripCurve,
    /// Number of cells along the curves.
    pub columns: usize,
    /// Number of cells across.
    #[serde(default = "one_row")]
    pub rows: usize,
}

fn one_row() -> usize {
    1
}

/// A curve: the list of its points in order, x, y and z in metres, or a `CurveFile` with them.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Part)]
#[serde(untagged)]
pub enum StripCurve {
    /// The points.
    Points(Vec<[f64; 3]>),
    /// A file that has them.
    File(CurveFile),
}

/// A file with the points of a curve: an OBJ file with a line, or a point on each line of a text, as in CSV
/// files.
///
/// ```toml
/// [sheet.mesh.strip_between]
/// first = { path = "lower.csv", scale = 0.001 }
/// second = { path = "upper.csv", scale = 0.001 }
/// columns = 60
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct CurveFile {
    /// Path of the file, relative to the scene file.
    pub path: PathBuf,
    /// Length of one unit of the file, metres: 0.001 for a file in millimetres.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

impl StripCurve {
    fn check(&self, key: &Key, checks: &mut Checks) {
        match self {
            Self::Points(points) => {
                checks.points(key.clone(), points);
                checks.count(key.clone(), points.len(), 2);
            }
            Self::File(file) => {
                checks.positive(key.name("scale"), file.scale, Unit::Metre);
                if file.path.as_os_str().is_empty() {
                    checks.report(
                        key.name("path"),
                        "the path is empty",
                        "name a file of points",
                    );
                }
            }
        }
    }

    /// Its points, metres.
    fn points(&self, key: &Key, files: &mut Files) -> Result<Vec<[f64; 3]>, Problem> {
        let file = match self {
            Self::Points(points) => return Ok(points.clone()),
            Self::File(file) => file,
        };
        let problem = |e: FileError| Problem::from_error(key.name("path"), &e);
        let bytes = files.contents(&file.path);
        let bytes = bytes.map_err(|e| problem(FileError::unreadable(&file.path, e)))?;
        let points = parse_curve(&bytes, &file.path).map_err(problem)?;
        Ok(points
            .into_iter()
            .map(|p| p.map(|c| file.scale * c))
            .collect())
    }
}

impl StripBetween {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        self.first.check(&key.name("first"), checks);
        self.second.check(&key.name("second"), checks);
        checks.count(key.name("columns"), self.columns, 1);
        checks.count(key.name("rows"), self.rows, 1);
    }

    /// The strip; `key` is its place in the scene.
    pub(crate) fn strip(&self, key: &Key, files: &mut Files) -> Result<RuledStrip, Problem> {
        let first = self.first.points(&key.name("first"), files)?;
        let second = self.second.points(&key.name("second"), files)?;
        let strip = generate::strip_between(&first, &second, self.columns, self.rows);
        strip.map_err(|error| {
            let key = match error {
                GenerateError::Curve { name, .. } | GenerateError::Count { name, .. } => {
                    key.name(name)
                }
                _ => key.clone(),
            };
            Problem::from_error(key, &error)
        })
    }
}

impl<'de> Deserialize<'de> for StripCurve {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CurveVisitor)
    }
}

struct CurveVisitor;

impl<'de> Visitor<'de> for CurveVisitor {
    type Value = StripCurve;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of points, or `path` in a table")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<StripCurve, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(StripCurve::Points)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<StripCurve, A::Error> {
        CurveFile::deserialize(MapAccessDeserializer::new(map)).map(StripCurve::File)
    }
}
