//! Numbers that are read off the sheet at each step.

use super::key::Key;
use super::placed::PlacedSheets;
use super::placed_bodies::PlacedBodies;
use super::problem::{Checks, Problem};
use super::selection::Selection;
use super::unit::Unit;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// A length that is read off the sheet at the start and after each step: how deep a tip hangs, how far a
/// corner is from its place, how wide a fold is. A run writes it to `measures.csv`, and its last, least and
/// largest value to `summary.json` as `measures.NAME`.
///
/// ```toml
/// [[measure]]
/// name = "tip"
/// at = { nearest = [[0.2, 0, 0]] }
/// quantity = "z"
///
/// [[measure]]
/// name = "width"
/// at = { vertices = [0] }
/// quantity = { distance_to = { vertices = [8] } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Measure {
    /// Its name, of letters, digits, `_` and `-`.
    pub name: String,
    /// The name of the sheet, if there are several and not the vertices of all are meant; or of a body, whose
    /// vertices are those of its surface.
    #[serde(default)]
    pub sheet: Option<String>,
    /// Which vertices. What is measured is their mean place.
    pub at: Selection,
    /// What is measured of it.
    pub quantity: Quantity,
}

/// What is measured of the mean place of some vertices, metres.
///
/// ```toml
/// [[measure]]
/// name = "corner"
/// at = { vertices = [0] }
/// quantity = { distance_to_point = [0, 0, 0] }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Quantity {
    /// Its x coordinate.
    X,
    /// Its y coordinate.
    Y,
    /// Its z coordinate.
    Z,
    /// Its distance from where it was at the start.
    Displacement,
    /// Its distance from a point (metres).
    DistanceToPoint([f64; 3]),
    /// Its distance from the mean place of other vertices.
    DistanceTo(Selection),
}

impl Measure {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let is_usual = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        // Spreadsheets take a name that begins with a minus for a formula.
        let is_text = self.name.starts_with(|c| is_usual(c) && c != '-');
        if !is_text || !self.name.chars().all(is_usual) {
            checks.report(
                key.name("name"),
                format!("`{}` cannot be the name of a measure", self.name),
                "use letters, digits, `_` and `-`, which is not the first",
            );
        }
        self.at.check(&key.name("at"), checks);
        let key = key.name("quantity");
        match &self.quantity {
            Quantity::X | Quantity::Y | Quantity::Z | Quantity::Displacement => {}
            Quantity::DistanceToPoint(point) => {
                checks.finite(key.name("distance_to_point"), point, Unit::Metre);
            }
            Quantity::DistanceTo(others) => others.check(&key.name("distance_to"), checks),
        }
    }

    /// With the vertices that it is of.
    pub(super) fn gauge(
        &self,
        key: &Key,
        sheets: &PlacedSheets<'_>,
        bodies: &PlacedBodies<'_>,
    ) -> Result<Gauge, Problem> {
        let sheet = self.sheet.as_deref();
        let start = [&sheets.start[..], &bodies.surface_positions()].concat();
        let find =
            |selection: &Selection, key: &Key| match sheet.and_then(|name| bodies.named(name)) {
                Some(body) => body.vertices_at(selection, &key.name("at")),
                None => sheets.vertices(sheet, selection, key),
            };
        let vertices = find(&self.at, key)?;
        let of = match &self.quantity {
            Quantity::X => Reading::Coordinate(0),
            Quantity::Y => Reading::Coordinate(1),
            Quantity::Z => Reading::Coordinate(2),
            Quantity::Displacement => Reading::Point(mean(&vertices, &start)),
            Quantity::DistanceToPoint(point) => Reading::Point((*point).into()),
            Quantity::DistanceTo(others) => {
                let key = key.name("quantity.distance_to");
                Reading::Vertices(find(others, &key)?)
            }
        };
        let name = self.name.clone();
        Ok(Gauge { name, vertices, of })
    }
}

/// Refuses names that stand twice.
pub(super) fn check_names(measures: &[Measure], root: &Key, checks: &mut Checks) {
    let mut names = HashSet::new();
    for (k, measure) in measures.iter().enumerate() {
        if !names.insert(&measure.name) {
            checks.report(
                root.name("measure").entry(k).name("name"),
                format!("another measure has the name `{}`", measure.name),
                "give each measure a name of its own",
            );
        }
    }
}

/// A [`Measure`] with the vertices that it is of.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauge {
    /// Its name.
    pub name: String,
    vertices: Vec<VertexId>,
    of: Reading,
}

#[derive(Clone, Debug, PartialEq)]
enum Reading {
    /// By its number.
    Coordinate(usize),
    Point(Vector3<f64>),
    Vertices(Vec<VertexId>),
}

impl Gauge {
    /// What it shows of positions `x` (`3V`, metres) of the sheets and of the surfaces of bodies, metres.
    pub fn value(&self, x: &[f64]) -> f64 {
        let place = mean(&self.vertices, x);
        match &self.of {
            Reading::Coordinate(k) => place[*k],
            Reading::Point(point) => (place - point).norm(),
            Reading::Vertices(others) => (place - mean(others, x)).norm(),
        }
    }
}

/// The mean place of vertices at positions `x`.
fn mean(vertices: &[VertexId], x: &[f64]) -> Vector3<f64> {
    let points = x.as_chunks::<3>().0;
    let sum: Vector3<f64> = vertices
        .iter()
        .map(|v| Vector3::from(points[v.index()]))
        .sum();
    sum / vertices.len() as f64
}
