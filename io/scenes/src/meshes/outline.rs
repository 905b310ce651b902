//! Outlines in the plane.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_mesh::generate::regular_outline;
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// A polygon in the xy plane: the list of its corners in order, x and y in metres, or an `OutlineShape`.
///
/// ```toml
/// [sheet.mesh.polygon]
/// outline = [[0, 0], [0.3, 0], [0.2, 0.2]]
/// spacing = 0.02
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Part)]
#[serde(untagged)]
pub enum Outline {
    /// The corners.
    Corners(Vec<[f64; 2]>),
    /// A polygon by formula.
    Shape(OutlineShape),
}

/// Most sides of a regular polygon: what has more is a circle.
const MOST_SIDES: f64 = 1e4;

/// A polygon by formula.
///
/// ```toml
/// [sheet.mesh.polygon_rings]
/// outline = { regular = { sides = 6, radius = 0.1 } }
/// rings = 5
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum OutlineShape {
    /// A regular polygon about the origin. The x axis leads through the middle of a side.
    Regular {
        /// Number of sides, at most 10 000.
        sides: usize,
        /// Radius of the circle through the corners, metres.
        radius: f64,
    },
}

impl Outline {
    /// The regular polygon about the origin whose corners are at the distance `radius` (metres).
    pub fn regular(sides: usize, radius: f64) -> Self {
        Self::Shape(OutlineShape::Regular { sides, radius })
    }

    /// The corners in order, metres; of values that [`Scene::validate`](crate::Scene::validate) refuses,
    /// none.
    pub fn corners(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Corners(corners) => corners.clone(),
            Self::Shape(OutlineShape::Regular { sides, radius }) => {
                regular_outline(*sides, *radius).unwrap_or_default()
            }
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        match self {
            Self::Corners(corners) => {
                checks.points(key.clone(), corners);
                checks.count(key.clone(), corners.len(), 3);
            }
            Self::Shape(OutlineShape::Regular { sides, radius }) => {
                let key_of_sides = key.name("regular.sides");
                checks.within(key_of_sides, *sides as f64, [3.0, MOST_SIDES]);
                checks.positive(key.name("regular.radius"), *radius, Unit::Metre);
            }
        }
    }
}

impl<'de> Deserialize<'de> for Outline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OutlineVisitor)
    }
}

struct OutlineVisitor;

impl<'de> Visitor<'de> for OutlineVisitor {
    type Value = Outline;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of corners, or `regular` as a table")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Outline, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(Outline::Corners)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Outline, A::Error> {
        OutlineShape::deserialize(MapAccessDeserializer::new(map)).map(Outline::Shape)
    }
}
