//! Seams: vertices of one sheet or of two that are glued to each other.

use crate::bodies::body;
use crate::holding::switch::When;
use crate::meshes::selection::{ON_LINE, beside_line, by_number, nearest, nearest_in_words, size};
use crate::placing::placed::PlacedSheets;
use crate::sheets::several;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use crate::words::warning::Warning;
use crate::{BodyKey, SheetKey};
use isosheet_mesh::wording::brief;
use isosheet_mesh::{Sheet, VertexId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Vertices of one sheet or of two that are glued to each other in pairs: the first of one side to the first
/// of the other side, and so on.
///
/// Pairs that coincide at the start stay together. Others are drawn together by a `closing` from 0 to 1. The
/// sides of a seam may run in opposite directions: two ends of a strip make a band, and a Moebius band if one
/// of them is given from its other end. A seam along one line is a hinge without stiffness, unless it has a
/// `bend`; with a second one along the next lines of vertices (an overlap) the curvature goes on across it.
/// Sides that overlap are drawn together through each other, so that with `contact.self_contact` an overlap
/// has to be there at the start.
///
/// ```toml
/// [[glue]]
/// first = { line = { from = [0, 0, 0], to = [0, 0.02, 0] } }
/// second = { line = { from = [0.3, 0, 0], to = [0.3, 0.02, 0] } }
/// closing = { smooth_step = { to = 1, end = 1.0 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct GlueKey {
    /// The names of the sheets of the two sides, if there are several; of a seam with a body the name of the
    /// sheet, then the name of the body.
    #[serde(default)]
    pub sheets: Option<[String; 2]>,
    /// The vertices of one side.
    pub first: SeamSide,
    /// The vertices of the other side, as many as of the first. Leave it out for a seam with a body, which
    /// carries the vertices of the sheet where they are at the start.
    #[serde(default)]
    pub second: Option<SeamSide>,
    /// How far the glue has drawn the two sides together: from 0, as at the start, to 1, closed.
    #[serde(default = "closed")]
    #[unit(Factor)]
    pub closing: ProfileKey,
    /// Stiffness of each pair, N/m. If left out, `1e4 (m g + D / L) / L` with the mass `m` of all sheets,
    /// gravity `g` (9.8 m/s2 if there is none), the largest flexural rigidity `D` and the mean edge length
    /// `L`: a pair that carries all of that is apart by a ten-thousandth of an edge.
    #[serde(default)]
    pub stiffness: Option<f64>,
    /// What resists bending across the seam, where edges of the two sides lie on one another. If left out,
    /// nothing.
    #[serde(default)]
    pub bend: Option<SeamBend>,
    /// When the glue sets; if left out, at the start. It then holds the vertices of each pair as far apart as
    /// they are at that moment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<When>,
    /// When the seam opens; if left out, never. By a force each pair tears for itself, as a peeled film does.
    /// The sides of a seam that was glued at the start do not meet in contact where they were glued.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<When>,
}

/// What resists bending across a seam: a crease between the faces of both sides.
///
/// ```toml
/// [[glue]]
/// first = { line = { from = [0, 0, 0], to = [0, 0.02, 0] } }
/// second = { line = { from = [0.3, 0, 0], to = [0.3, 0.02, 0] } }
/// bend = { stiffness = 0.1 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct SeamBend {
    /// Torsional stiffness of a metre of the seam, N (newton metres per radian and metre).
    pub stiffness: f64,
    /// Fold angle at rest, degrees: 0 for flat, positive for a valley as seen from the side from which the
    /// faces of the first side are counter-clockwise.
    #[serde(default)]
    pub angle: f64,
}

fn closed() -> ProfileKey {
    ProfileKey::Constant(1.0)
}

/// One side of a seam. Points are in the rest shape before it is placed.
///
/// ```toml
/// [[glue]]
/// first = { vertices = [0, 21, 42] }
/// second = { vertices = [20, 41, 62] }
/// closing = { ramp = { to = 1, end = 0.5 } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SeamSide {
    /// Vertices by their numbers, from 0, in order.
    Vertices(Vec<usize>),
    /// The vertices on a straight line, in the order in which they lie on it.
    Line {
        /// Where the line begins, metres.
        from: [f64; 3],
        /// Where the line ends, metres.
        to: [f64; 3],
    },
    /// For each point (metres) the vertex nearest to it: dots of glue.
    Nearest(Vec<[f64; 3]>),
}

/// Stiffness of glue in units of `(m g + D / L) / L`, see [`GlueKey::stiffness`].
const STIFFNESS: f64 = 1e4;

/// Largest distance of the sides of a seam that coincide, as a part of the size of the sheets: above the
/// round-off of coordinates that went through a text file with seven digits.
const COINCIDE: f64 = 1e-6;

impl GlueKey {
    pub(crate) fn check(
        &self,
        all: &[SheetKey],
        bodies: &[BodyKey],
        key: &Key,
        checks: &mut Checks,
    ) {
        let body = self
            .body()
            .filter(|name| body::number_of(bodies, name).is_some());
        for (i, name) in self.sheets.iter().flatten().enumerate() {
            let key = key.name("sheets").entry(i);
            if i == 0
                && let Some([first, second]) = &self.sheets
                && body::number_of(bodies, first).is_some()
            {
                let message = format!("the body `{first}` stands before the sheet `{second}`");
                let remedy =
                    format!("write the sheet first, `sheets = [\"{second}\", \"{first}\"]`");
                checks.report(key, message, remedy);
                return;
            }
            // A scene of one sheet need not name it.
            let is_only = i == 0 && body.is_some() && all.len() == 1 && name == "sheet";
            if (i == 0 || body.is_none()) && !is_only {
                several::check_reference(all, Some(name), &key, checks);
            }
        }
        match (&self.second, body) {
            (Some(_), Some(_)) => checks.report(
                key.name("second"),
                "the second side of the seam is a body",
                "leave the key out: the vertices of the sheet are held where they are at the start",
            ),
            (None, None) => checks.report(
                key.clone(),
                "the seam has no second side",
                "give `second`, or the names of a sheet and a body, `sheets = [\"flag\", \"pole\"]`",
            ),
            _ => {}
        }
        if let Some(bend) = &self.bend {
            let key = key.name("bend");
            checks.not_negative(key.name("stiffness"), bend.stiffness, Unit::Newton);
            checks.within(key.name("angle"), bend.angle, [-180.0, 180.0]);
            let switches = self.from.is_some() || self.until.is_some();
            if body.is_some() || self.closing != closed() || switches {
                let message =
                    "bending is resisted across seams that are closed at all times, between sheets";
                checks.report(key, message, "leave the key out");
            }
        }
        if body.is_some() && self.closing != closed() {
            let remedy = "leave the key out";
            checks.report(
                key.name("closing"),
                "a seam with a body is closed at all times",
                remedy,
            );
        }
        if self.from.is_some() && self.closing != closed() {
            checks.report(
                key.name("closing"),
                "glue that sets later holds the sides as far apart as they are then",
                "leave out `closing` or `from`",
            );
        }
        if self.from.is_some() && body.is_some() {
            checks.report(
                key.name("from"),
                "a seam with a body holds from the start on",
                "leave the key out",
            );
        }
        if self.until.is_some() && body.is_some() {
            let message = format!(
                "the faces at `{}` do not meet the body in contact, also after `{}`",
                key.name("first"),
                key.name("until")
            );
            let remedy = "hold the sheet by a support with `until` in the place of glue where it may touch the body again";
            checks.doubts.push(Warning::new(message, remedy));
        }
        let sides = [
            ("first", Some(&self.first)),
            ("second", self.second.as_ref()),
        ];
        for (name, side) in sides
            .into_iter()
            .filter_map(|(name, side)| Some((name, side?)))
        {
            let key = key.name(name);
            match side {
                SeamSide::Line { from, to } => checks.line(&key.name("line"), from, to),
                SeamSide::Nearest(points) => checks.points(key.name("nearest"), points),
                SeamSide::Vertices(_) => {}
            }
        }
        checks.positive(key.name("stiffness"), self.stiffness, Unit::NewtonPerMetre);
    }

    /// The name of the body that is the second side, if one is.
    pub(crate) fn body(&self) -> Option<&str> {
        self.sheets.as_ref().map(|[_, name]| name.as_str())
    }

    /// The vertices of the first side, by their numbers in the union of all sheets.
    pub(crate) fn first_vertices(
        &self,
        all: &PlacedSheets<'_>,
        key: &Key,
    ) -> Result<Vec<VertexId>, Problem> {
        let name = self.sheets.as_ref().map(|[name, _]| name.as_str());
        let name = name.filter(|_| all.list.len() > 1);
        let sheet = all.one(name, key, "the vertices of the seam")?;
        let found = self
            .first
            .vertices(sheet.form.unplaced.sheet(), &key.name("first"))?;
        Ok(found.into_iter().map(|v| sheet.part.vertex(v)).collect())
    }

    /// The pairs of vertices, by their numbers in the union of all sheets.
    pub(crate) fn pairs(
        &self,
        all: &PlacedSheets<'_>,
        key: &Key,
    ) -> Result<Vec<[VertexId; 2]>, Problem> {
        let names = |i: usize| self.sheets.as_ref().map(|names| names[i].as_str());
        let side = |i: usize, name: &str, side: &SeamSide| {
            let sheet = all.one(names(i), key, "the sides of the seam")?;
            let found = side.vertices(sheet.form.unplaced.sheet(), &key.name(name))?;
            let found = found.into_iter().map(|v| sheet.part.vertex(v));
            Ok::<_, Problem>(found.collect::<Vec<_>>())
        };
        let first = side(0, "first", &self.first)?;
        let second = match &self.second {
            Some(second) => side(1, "second", second)?,
            None => Vec::new(),
        };
        if first.len() != second.len() {
            return Err(Problem::new(
                key.name("second"),
                format!(
                    "one side of the seam has {} vertices, and the other {}",
                    first.len(),
                    second.len()
                ),
                "give as many on both sides: a mesh with the same spacing along both has them, and `nearest` finds the vertices \
                 next to points",
            ));
        }
        let pairs = first.into_iter().zip(second).map(|(a, b)| [a, b]);
        // (The tip of a cone is on both sides of its seam.)
        let pairs: Vec<[VertexId; 2]> = pairs.filter(|[a, b]| a != b).collect();
        if self.from.is_none() {
            self.check_apart(&pairs, all, key)?;
        }
        Ok(pairs)
    }

    /// Refuses glue that would draw its sides together in no time.
    fn check_apart(
        &self,
        pairs: &[[VertexId; 2]],
        all: &PlacedSheets<'_>,
        key: &Key,
    ) -> Result<(), Problem> {
        let points = all.start.as_chunks::<3>().0;
        let apart = |&[a, b]: &[VertexId; 2]| {
            let [a, b] = [a, b].map(|v| points[v.index()]);
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
        };
        let farthest = pairs.iter().map(apart).fold(0.0, f64::max);
        let drawn = farthest * self.closing.as_given().value(0.0).abs();
        if drawn > COINCIDE * size(points) {
            return Err(Problem::new(
                key.name("closing"),
                format!(
                    "the sides of the seam are {} m apart at the start",
                    brief(farthest)
                ),
                "draw them together in time, `closing = { smooth_step = { to = 1, end = 1 } }`, or start where they \
                 meet (`sheet.start.file`)",
            ));
        }
        Ok(())
    }

    /// The stiffness of each pair, N/m.
    pub(crate) fn stiffness(&self, mass: f64, gravity: f64, rigidity: f64, length: f64) -> f64 {
        let automatic = STIFFNESS * (mass * gravity + rigidity / length) / length;
        self.stiffness.unwrap_or(automatic)
    }
}

impl SeamSide {
    fn vertices(&self, mesh: &Sheet, key: &Key) -> Result<Vec<VertexId>, Problem> {
        let points = mesh.positions().as_chunks::<3>().0;
        let found = match self {
            Self::Vertices(numbers) => by_number(numbers, key, points.len())?,
            Self::Line { from, to } => on_line(points, from, to),
            Self::Nearest(wanted) => wanted.iter().map(|p| nearest(points, p).0).collect(),
        };
        if found.is_empty() {
            let nearest = match self {
                Self::Vertices(_) | Self::Nearest(_) => String::new(),
                Self::Line { from, to } => {
                    nearest_in_words(points, |p| beside_line(p, [from, to]).1)
                }
            };
            return Err(Problem::new(
                key.clone(),
                format!("no vertex of the mesh is selected here{nearest}"),
                "compare the line with the mesh before it is placed",
            ));
        }
        Ok(found)
    }
}

/// The points on a line between two points, in its order.
fn on_line(points: &[[f64; 3]], from: &[f64; 3], to: &[f64; 3]) -> Vec<VertexId> {
    let tolerance = ON_LINE * size(points);
    let place = |(v, p): (usize, &[f64; 3])| {
        let (part, distance) = beside_line(p, [from, to]);
        (distance <= tolerance).then_some((part, VertexId::from_index(v)))
    };
    let mut found: Vec<(f64, VertexId)> = points.iter().enumerate().filter_map(place).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, v)| v).collect()
}
