//! Crease patterns by formula.

use crate::words::part::Part;
use isosheet_formats::DrawnEdges;
use isosheet_mesh::generate::{
    FoldAssignment, FoldPattern, GenerateError, degree_four, miura, miura_zigzags,
};
use isosheet_mesh::{EdgeId, origami};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Miura's crease pattern, with mountains and valleys (K. Miura, *Method of packaging and deployment of large
/// membranes in space*, 1985).
///
/// ```toml
/// [sheet.mesh.miura]
/// columns = 6
/// rows = 4
/// straight = 0.05
/// zigzag = 0.05
/// angle = 60
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct MiuraKey {
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
///
/// ```toml
/// [sheet.mesh.degree_four]
/// sectors = [60, 90]
/// radius = 0.1
/// alike = "odd"
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct DegreeFourKey {
    /// Angles from crease 1 to 2 and from 2 to 3, degrees; each of the other two adds up to 180 degrees with
    /// the angle opposite.
    pub sectors: [f64; 2],
    /// Length of the creases, metres.
    pub radius: f64,
    /// Which of the creases fold alike, the first one as a valley; the other two fold unlike.
    pub alike: AlikeCreases,
}

/// The creases of a vertex of degree four that fold alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum AlikeCreases {
    /// Creases 1 and 3.
    Odd,
    /// Creases 2 and 4.
    Even,
}

/// The waterbomb tessellation: a rectangle of squares whose diagonals are valleys and whose sides and middle
/// lines are mountains. Odd rows are moved by half a square. The pattern is from Y. Chen, H. Feng, J. Ma, R.
/// Peng and Z. You, *Symmetric waterbomb origami*, Proc. R. Soc. A 472, 2016.
///
/// ```toml
/// [sheet.mesh.waterbomb]
/// columns = 4
/// rows = 4
/// side = 0.04
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Waterbomb {
    /// Number of squares along x.
    pub columns: usize,
    /// Number of rows of squares along y.
    pub rows: usize,
    /// Side of the squares, metres.
    pub side: f64,
}

/// Yoshimura's pattern: bands of isosceles triangles, whose bases are valleys and whose sides are mountains
/// (Y. Yoshimura, *On the mechanism of buckling of a circular cylindrical shell under axial compression*,
/// NACA TM 1390, 1955).
///
/// ```toml
/// [sheet.mesh.yoshimura]
/// columns = 6
/// rows = 4
/// base = 0.06
/// height = 0.02
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Yoshimura {
    /// Number of triangles of each kind, upright and upside down, in a band along x.
    pub columns: usize,
    /// Number of bands along y.
    pub rows: usize,
    /// Base of the triangles, metres.
    pub base: f64,
    /// Height of the triangles, metres.
    pub height: f64,
}

/// Kresling's pattern: parallelograms whose sides are mountains and whose longer diagonals are valleys (B.
/// Kresling, *Natural twist buckling in shells*, IASS-IACM 2008).
///
/// ```toml
/// [sheet.mesh.kresling]
/// columns = 6
/// rows = 2
/// base = 0.05
/// side = 0.06
/// angle = 60
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Kresling {
    /// Number of parallelograms along x.
    pub columns: usize,
    /// Number of rows of parallelograms along y.
    pub rows: usize,
    /// Length of the sides along x, metres.
    pub base: f64,
    /// Length of the other sides, metres.
    pub side: f64,
    /// Acute angle of the parallelograms, degrees.
    pub angle: f64,
}

/// The pleated hyperbolic paraboloid: concentric squares about the origin, mountains and valleys in turn. The
/// trapezoids between them are cut as in E. Demaine, M. Demaine, V. Hart, G. Price and T. Tachi,
/// *(Non)existence of pleated folds*, Graphs and Combinatorics 27, 2011.
///
/// ```toml
/// [sheet.mesh.hypar]
/// side = 0.2
/// rings = 8
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Hypar {
    /// Number of squares, the edge of the sheet included.
    pub rings: usize,
    /// Side of the sheet, metres.
    pub side: f64,
}

/// The square twist: a square about the origin from whose sides pleats lead to the edges of the sheet.
///
/// ```toml
/// [sheet.mesh.square_twist]
/// side = 0.2
/// square = 0.05
/// angle = 30
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct SquareTwist {
    /// Side of the sheet, metres.
    pub side: f64,
    /// Side of the square in the middle, metres; its diagonal has to be shorter than the side of the sheet.
    pub square: f64,
    /// The angle by which the square in the middle is turned, degrees, more than 0 and less than 90.
    pub angle: f64,
}

/// What the edges of a sheet with a crease pattern are meant to do.
#[derive(Clone, Debug, Default)]
pub(crate) struct EdgeRoles {
    /// One entry for each edge; none where the pattern does not say it.
    pub(crate) assignments: Vec<Option<FoldAssignment>>,
    /// The zigzag creases of Miura's pattern.
    pub(crate) zigzags: Vec<EdgeId>,
    /// Which edges of the mesh, before it is refined, follow which lines of its drawing.
    pub(crate) drawn: Option<DrawnEdges>,
}

impl From<&FoldPattern> for EdgeRoles {
    fn from(pattern: &FoldPattern) -> Self {
        Self {
            assignments: pattern.assignments.iter().copied().map(Some).collect(),
            ..Self::default()
        }
    }
}

impl MiuraKey {
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

impl DegreeFourKey {
    /// The flat sheet with its mountains and valleys.
    pub(crate) fn pattern(&self) -> Result<FoldPattern, GenerateError> {
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
