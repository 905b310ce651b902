//! The direction of the material of a sheet.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use isosheet_dynamics::MaterialDirection;
use isosheet_mesh::Sheet;
use nalgebra::{Matrix2, Vector2, Vector3};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::sync::Arc;

/// A direction in a sheet, as a vector or by the texture coordinates of its mesh file.
///
/// ```toml
/// [sheet]
/// mesh = { file = { path = "sleeve.obj" } }
/// material = "office paper"
/// direction = { uv = "v" }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Part)]
#[serde(untagged)]
pub enum Direction {
    /// One direction everywhere, in the frame of the mesh, of any length.
    Vector([f64; 3]),
    /// Of each face its own.
    Texture(TextureDirection),
    /// Of each face its own, in space: what is made of the texture of a mesh.
    #[serde(skip)]
    #[schemars(skip)]
    Faces(Arc<Vec<[f64; 3]>>),
}

/// A direction by texture coordinates.
///
/// ```toml
/// [sheet]
/// mesh = { file = { path = "shirt.obj" } }
/// material = "cotton"
/// direction = { uv = "u" }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct TextureDirection {
    /// The texture coordinate that grows along the direction, and steepest: of an OBJ file `vt`, of a glTF
    /// file `TEXCOORD_0`, of a PLY file `s` and `t` or `u` and `v` of vertices, or `texcoord` of faces.
    pub uv: TextureAxis,
}

/// One of the two texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum TextureAxis {
    /// The first one.
    U,
    /// The second one.
    V,
}

impl From<[f64; 3]> for Direction {
    fn from(vector: [f64; 3]) -> Self {
        Self::Vector(vector)
    }
}

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DirectionVisitor)
    }
}

struct DirectionVisitor;

impl<'de> Visitor<'de> for DirectionVisitor {
    type Value = Direction;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of three numbers, or `uv` as a table")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Direction, A::Error> {
        <[f64; 3]>::deserialize(SeqAccessDeserializer::new(list)).map(Direction::Vector)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Direction, A::Error> {
        TextureDirection::deserialize(MapAccessDeserializer::new(map)).map(Direction::Texture)
    }
}

impl Direction {
    pub(crate) fn check(&self, key: Key, checks: &mut Checks) {
        if let Self::Vector(vector) = self {
            checks.direction(key, vector);
        }
    }

    /// As the engine has it, with vectors taken to space by `placed`. That of a texture is none before it is
    /// known which face has which.
    pub(crate) fn in_space(&self, placed: impl Fn([f64; 3]) -> [f64; 3]) -> MaterialDirection {
        match self {
            Self::Vector(vector) => MaterialDirection::Uniform(placed(*vector)),
            Self::Texture(_) => MaterialDirection::Faces(Vec::new()),
            Self::Faces(vectors) => MaterialDirection::Faces(vectors.to_vec()),
        }
    }
}

/// Texture coordinates of the corners of a face, if it has them.
pub(crate) type FaceTexture = Option<[[f64; 2]; 3]>;

/// Part of the product of its two sides that the area of a face has at least in the texture: below, it is
/// round-off of numbers with six digits.
const LEAST_AREA: f64 = 1e-6;

/// The gradients of a texture coordinate on the faces of a mesh, in its frame.
pub(crate) fn gradients(
    mesh: &Sheet,
    texture: &[FaceTexture],
    TextureDirection { uv }: TextureDirection,
    key: &Key,
) -> Result<Vec<[f64; 3]>, Problem> {
    let problem = |message: String| {
        let remedy =
            "export the mesh with texture coordinates, and lay out every face in the texture";
        Problem::new(key.name("uv"), message, remedy)
    };
    let faces = mesh.topology().faces();
    if texture.len() != faces.len() {
        return Err(problem(
            "the mesh of the sheet has no texture coordinates".to_owned(),
        ));
    }
    let gradient = |(k, (corners, texture)): (usize, (&[_; 3], &FaceTexture))| {
        let Some([p, q, r]) = texture.map(|corners| corners.map(Vector2::from)) else {
            return Err(problem(format!(
                "face {k} of the mesh has no texture coordinates"
            )));
        };
        let (first, second) = (q - p, r - p);
        let area = (first.x * second.y - first.y * second.x).abs();
        let is_laid_out = area > LEAST_AREA * first.norm() * second.norm();
        if !is_laid_out {
            return Err(problem(format!(
                "face {k} of the mesh has no area in the texture"
            )));
        }
        let [a, b, c] = corners.map(|v| Vector3::from(mesh.position(v)));
        let sides = [b - a, c - a];
        // The vector in the plane of the face whose products with the sides are the differences.
        let products = Matrix2::from_fn(|i, j| sides[i].dot(&sides[j]));
        let axis = match uv {
            TextureAxis::U => 0,
            TextureAxis::V => 1,
        };
        let differences = Vector2::new(first[axis], second[axis]);
        let weights = products.lu().solve(&differences);
        let weights =
            weights.ok_or_else(|| problem(format!("face {k} of the mesh has no area")))?;
        Ok((weights.x * sides[0] + weights.y * sides[1])
            .normalize()
            .into())
    };
    let of_faces = faces.iter().zip(texture).enumerate();
    of_faces.map(gradient).collect()
}
