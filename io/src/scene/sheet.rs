//! The sheet: mesh, material, placement and start.

use super::key::Key;
use super::mesh::{Mesh, MeshFile};
use super::pose::Pose;
use super::problem::Checks;
use super::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The sheet.
///
/// ```toml
/// [sheet]
/// mesh = { square = { side = 0.21, level = 2 } }
/// density = 0.08
/// thickness = 0.0001
/// bending = { plate = { rigidity = 5e-4 } }
/// damping = 2
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    /// Where the mesh comes from. Its shape is the rest shape: the one with the rest lengths.
    pub mesh: Mesh,
    /// Mass of a square metre, kg/m2: office paper has 0.08, steel of 1 mm 7.8. Not used if `mass` is given.
    #[serde(default = "paper_density")]
    pub density: f64,
    /// Mass of the whole sheet, kilograms; if left out, `density` times its area.
    #[serde(default)]
    pub mass: Option<f64>,
    /// Thickness, metres: the least distance of its middle surface from bodies and from itself. It does not
    /// change mass or stiffness.
    #[serde(default)]
    pub thickness: f64,
    /// What keeps the lengths.
    #[serde(default)]
    pub isometry: Isometry,
    /// What resists bending.
    #[serde(default)]
    pub bending: Bending,
    /// Rate of the velocity damping `v <- v exp(-damping h)` after each step of `h` seconds, 1/s.
    #[serde(default)]
    pub damping: f64,
    /// Where the sheet is placed in space.
    #[serde(default)]
    pub placement: Pose,
    /// How the sheet starts, if not at rest in its rest shape.
    #[serde(default)]
    pub start: Start,
}

/// Mass of a square metre of office paper, kg/m2.
fn paper_density() -> f64 {
    0.08
}

/// What keeps the lengths.
///
/// ```toml
/// [sheet]
/// isometry = { membrane = { stiffness = 3e5, poisson = 0.3 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Isometry {
    /// Rigid rods along all edges: exact lengths, folds along the lines of the mesh alone.
    #[default]
    Rods,
    /// The elasticity of the material: edges stretch. For `bdf2` and `implicit_euler`.
    Membrane {
        /// Young's modulus times thickness, N/m: office paper has 3e5.
        stiffness: f64,
        /// Poisson's ratio, from 0 to 0.5.
        #[serde(default)]
        poisson: f64,
    },
    /// Lengths in the mean around each vertex, and a soft membrane: smooth bends in every direction. The rest
    /// shape has to be flat. For `bdf2` and `implicit_euler`.
    Weak {
        /// Stiffness of the membrane, N/m; if left out, 100 times the flexural rigidity over the squared size
        /// of the mesh.
        #[serde(default)]
        stiffness: Option<f64>,
    },
}

/// What resists bending.
///
/// ```toml
/// [sheet]
/// bending = { plate = { rigidity = 5e-4 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Bending {
    /// Nothing: the sheet is limp.
    #[default]
    None,
    /// The bending stiffness of a plate, which does not depend on the mesh. Supports that pin all corners of
    /// a face clamp it.
    Plate {
        /// Flexural rigidity, N m: office paper has about 5e-4.
        rigidity: f64,
    },
    /// Springs at the edges: cheaper than a plate, and dependent on the mesh where bends do not follow its
    /// lines.
    Hinges {
        /// Flexural rigidity, N m.
        rigidity: f64,
    },
}

/// How the sheet starts.
///
/// ```toml
/// [sheet]
/// start = { perturbation = 0.01, seed = 1 }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Start {
    /// A mesh file with the vertices and faces of `mesh` in the same order, whose positions are those at the
    /// start. It is placed as the rest shape is. With rigid rods, lengths that differ from the rest lengths
    /// by up to 1e-4 of these, as in files of six digits, are corrected by moving the vertices.
    pub file: Option<MeshFile>,
    /// Size of a random displacement of all free vertices, as a part of the mean edge length, from 0 to 1:
    /// conservative methods cannot start from a flat sheet under load.
    pub perturbation: f64,
    /// Another number gives another displacement.
    pub seed: u64,
}

impl Sheet {
    /// A sheet of office paper without bending stiffness, of rigid rods.
    pub fn new(mesh: Mesh) -> Self {
        Self {
            mesh,
            density: paper_density(),
            mass: None,
            thickness: 0.0,
            isometry: Isometry::default(),
            bending: Bending::default(),
            damping: 0.0,
            placement: Pose::default(),
            start: Start::default(),
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        self.mesh.check(&key.name("mesh"), checks);
        checks.positive(
            key.name("density"),
            self.density,
            Unit::KilogramPerSquareMetre,
        );
        if let Some(mass) = self.mass {
            checks.positive(key.name("mass"), mass, Unit::Kilogram);
        }
        checks.not_negative(key.name("thickness"), self.thickness, Unit::Metre);
        checks.not_negative(key.name("damping"), self.damping, Unit::PerSecond);
        self.isometry.check(&key.name("isometry"), checks);
        self.bending.check(&key.name("bending"), checks);
        if matches!(self.isometry, Isometry::Weak { stiffness: None })
            && self.bending.rigidity() == 0.0
        {
            checks.report(
                key.name("isometry.weak"),
                "the stiffness of the membrane follows from a flexural rigidity, and the sheet has none",
                "give `stiffness` in N/m, or `bending = { plate = { rigidity = ... } }`",
            );
        }
        self.placement.check(&key.name("placement"), checks);
        let start = key.name("start");
        checks.within(
            start.name("perturbation"),
            self.start.perturbation,
            [0.0, 1.0],
        );
        if let Some(file) = &self.start.file {
            file.check(&start.name("file"), checks);
        }
    }
}

impl Isometry {
    fn check(&self, key: &Key, checks: &mut Checks) {
        match self {
            Self::Rods | Self::Weak { stiffness: None } => {}
            Self::Membrane { stiffness, poisson } => {
                checks.positive(
                    key.name("membrane.stiffness"),
                    *stiffness,
                    Unit::NewtonPerMetre,
                );
                checks.within(key.name("membrane.poisson"), *poisson, [0.0, 0.5]);
            }
            Self::Weak {
                stiffness: Some(stiffness),
            } => checks.positive(key.name("weak.stiffness"), *stiffness, Unit::NewtonPerMetre),
        }
    }
}

impl Bending {
    /// The flexural rigidity, N m.
    pub(crate) fn rigidity(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Plate { rigidity } | Self::Hinges { rigidity } => *rigidity,
        }
    }

    fn check(&self, key: &Key, checks: &mut Checks) {
        let name = match self {
            Self::None => return,
            Self::Plate { .. } => "plate.rigidity",
            Self::Hinges { .. } => "hinges.rigidity",
        };
        checks.positive(key.name(name), self.rigidity(), Unit::NewtonMetre);
    }
}
