//! Crease patterns by formula.

use super::problem::{Checks, Key};
use isosheet_mesh::EdgeId;
use isosheet_mesh::generate::{
    FoldAssignment, FoldPattern, GenerateError, degree_four, miura, miura_zigzags,
};
use isosheet_mesh::origami;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Miura's crease pattern, with mountains and valleys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Miura {
    /// Number of panels along x.
    pub columns: usize,
    /// Number of panels along y.
    pub rows: usize,
    /// Length of the straight creases, metres.
    pub straight: f64,
    /// Length of each part of the zigzag creases, metres.
    pub zigzag: f64,
    /// Acute angle of the panels, degrees.
    pub angle: f64,
}

/// Four triangles round a vertex that folds flat: creases 1 to 4 lead from vertex 0 at the origin to the
/// vertices 1 to 4, the first one along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DegreeFour {
    /// Angles from crease 1 to 2 and from 2 to 3, degrees; the other two are what is left of 180 degrees of
    /// each.
    pub sectors: [f64; 2],
    /// Length of the creases, metres.
    pub radius: f64,
    /// Which of the creases fold alike, the first one as a valley; the other two fold unlike.
    pub alike: AlikeCreases,
}

/// The creases of a vertex of degree four that fold alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AlikeCreases {
    /// Creases 1 and 3.
    Odd,
    /// Creases 2 and 4.
    Even,
}

/// What the edges of a sheet with a crease pattern are meant to do.
#[derive(Clone, Debug, Default)]
pub(crate) struct EdgeRoles {
    /// One entry for each edge; none where the pattern does not say it.
    pub(crate) assignments: Vec<Option<FoldAssignment>>,
    /// The zigzag creases of Miura's pattern.
    pub(crate) zigzags: Vec<EdgeId>,
}

impl From<&FoldPattern> for EdgeRoles {
    fn from(pattern: &FoldPattern) -> Self {
        Self {
            assignments: pattern.assignments.iter().copied().map(Some).collect(),
            zigzags: Vec::new(),
        }
    }
}

impl Miura {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("straight"), self.straight, "m");
        checks.positive(key.name("zigzag"), self.zigzag, "m");
        checks.count(key.name("columns"), self.columns, 1);
        checks.count(key.name("rows"), self.rows, 1);
        check_angle(key.name("angle"), self.angle, 90.0, checks);
    }

    /// The flat sheet with its mountains and valleys.
    ///
    /// # Errors
    /// [`GenerateError`] naming the value that cannot be used.
    pub fn pattern(&self) -> Result<FoldPattern, GenerateError> {
        let angle = self.angle.to_radians();
        miura(self.columns, self.rows, self.straight, self.zigzag, angle)
    }

    /// How it folds with rigid panels.
    pub fn kinematics(&self) -> origami::Miura {
        origami::Miura {
            straight: self.straight,
            zigzag: self.zigzag,
            angle: self.angle.to_radians(),
        }
    }

    /// What the edges of its pattern are meant to do.
    pub(crate) fn roles(pattern: &FoldPattern) -> EdgeRoles {
        EdgeRoles {
            zigzags: miura_zigzags(pattern),
            ..EdgeRoles::from(pattern)
        }
    }
}

impl DegreeFour {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("radius"), self.radius, "m");
        for (k, sector) in self.sectors.iter().enumerate() {
            check_angle(key.name("sectors").entry(k), *sector, 180.0, checks);
        }
    }

    /// The flat sheet with its mountains and valleys.
    ///
    /// # Errors
    /// [`GenerateError`] naming the value that cannot be used.
    pub fn pattern(&self) -> Result<FoldPattern, GenerateError> {
        let kinematics = self.kinematics();
        let assignment = kinematics.assignment(self.mode());
        degree_four(kinematics.sectors, self.radius, assignment)
    }

    /// How it folds.
    pub fn kinematics(&self) -> origami::DegreeFour {
        origami::DegreeFour {
            sectors: self.sectors.map(f64::to_radians),
        }
    }

    /// Which of the two ways it folds.
    pub fn mode(&self) -> origami::FoldingMode {
        match self.alike {
            AlikeCreases::Odd => origami::FoldingMode::OddAlike,
            AlikeCreases::Even => origami::FoldingMode::EvenAlike,
        }
    }
}

/// An angle in degrees between 0 and `most`, both excluded.
fn check_angle(key: Key, angle: f64, most: f64, checks: &mut Checks) {
    if !(angle > 0.0 && angle < most) {
        let message = format!("`{key}` is {angle} degrees");
        checks.report(
            key,
            message,
            format!("give more than 0 and less than {most}"),
        );
    }
}
