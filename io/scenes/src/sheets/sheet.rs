//! The sheet: mesh, material, placement and start.

use crate::meshes::direction::Direction;
use crate::meshes::mesh::Mesh;
use crate::sheets::curl::CurlKey;
use crate::sheets::material::{MaterialKey, ratios, typical_poisson};
use crate::sheets::patch::Patch;
use crate::sheets::start::StartKey;
use crate::sheets::yields::SheetYield;
use crate::time::pose::Pose;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics as engine;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A sheet. A scene of several has a table `[[sheet]]` for each, with a `name` by which supports, creases and
/// loads name it; where they name none, regions and points are of all sheets. Each is of its own material,
/// rods beside elastic sheets, with its own `damping`, `yield` and `thickness`. With `contact.self_contact`
/// they meet one another.
///
/// ```toml
/// [sheet]
/// mesh = { square = { side = 0.21, level = 2 } }
/// material = "office paper"
/// thickness = 0.0001
/// damping = 2
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct SheetKey {
    /// Its name, which each of several sheets has to have.
    #[serde(default)]
    pub name: Option<String>,
    /// Where the mesh comes from. Its shape is the rest shape: the one with the rest lengths.
    pub mesh: Mesh,
    /// How often all faces of the mesh are divided into four, as the paper's Fig. 4 does: the middle of the
    /// longest edge is joined to the opposite corner and to the middles of the other two. Vertices and edges
    /// of the mesh keep their numbers and their creases; panels of a crease pattern can bend where they are
    /// divided.
    #[serde(default)]
    pub refine: usize,
    /// What the sheet is made of. Without it, the sheet is one of rigid rods, as in the paper.
    #[serde(default)]
    pub material: Option<MaterialKey>,
    /// The direction of the material: along the machine of paper, along the warp of cloth, along the fibres
    /// of a laminate. A vector in the frame of the mesh, of any length, or a texture coordinate of the mesh
    /// file. A material that has two directions is stiffer along this one than across; without the key it is
    /// the same in all directions, with the means of both.
    #[serde(default)]
    pub direction: Option<Direction>,
    /// Mass of a square metre, kg/m2: steel of 1 mm has 7.8. By default the value of the material; without a
    /// material 0.08, as for office paper. Not used if `mass` is given.
    #[serde(default)]
    pub density: Option<f64>,
    /// Mass of the whole sheet, kilograms; if left out, `density` times its area.
    #[serde(default)]
    pub mass: Option<f64>,
    /// Thickness, metres: the least distance of its middle surface from bodies and from itself. From another
    /// sheet it keeps the mean of both, so that a stack has its height. It does not change mass or stiffness.
    /// Faces with a common vertex do not keep it: a fold is sharp at its line, and the layers open beside it.
    #[serde(default)]
    pub thickness: f64,
    /// What keeps the lengths. By default the elasticity of the material; without a material rigid rods.
    #[serde(default)]
    pub isometry: Option<IsometryKey>,
    /// What resists bending. By default a plate with the rigidity of the material; without a material
    /// nothing.
    #[serde(default)]
    pub bending: Option<Bending>,
    /// What bends are measured from.
    #[serde(default)]
    pub rest: RestShape,
    /// The curvature that it has by itself. If left out, none.
    #[serde(default)]
    pub curl: Option<CurlKey>,
    /// The part by which all its lengths grow by themselves, a function of time from -0.2 to 0.2: negative
    /// for paper that dries, positive for film that is heated. For elastic sheets. If left out, none.
    #[serde(default)]
    #[unit(Factor)]
    pub swell: Option<ProfileKey>,
    /// The factor of its resistance to bending, a function of time above 0: paper whose glue dries, film that
    /// is heated. If left out, it stays.
    #[serde(default)]
    #[unit(Factor)]
    pub stiffening: Option<ProfileKey>,
    /// When it yields in bending. If left out, never: bends spring back.
    #[serde(default, rename = "yield")]
    pub yields: Option<SheetYield>,
    /// Parts that are of other materials.
    #[serde(default)]
    pub patch: Vec<Patch>,
    /// Rate of the velocity damping, 1/s: a force `-damping m v` on each vertex, under which a free sheet has
    /// `v exp(-damping t)` left after `t` seconds, in steps of any length.
    #[serde(default)]
    pub damping: f64,
    /// Where the sheet is placed in space.
    #[serde(default)]
    pub placement: Pose,
    /// How the sheet starts, if not at rest in its rest shape.
    #[serde(default)]
    pub start: StartKey,
}

/// Mass of a square metre of office paper, kg/m2: that of sheets of which nothing is said.
const PAPER_DENSITY: f64 = 0.08;

/// Numbers of an elastic sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Elasticity {
    /// How stiff it is in its plane.
    pub law: engine::MembraneLaw,
    /// The limit of the strain.
    pub limit: f64,
}

/// What keeps the lengths.
///
/// ```toml
/// [sheet]
/// isometry = { elastic = { stiffness = 3e5, limit = 0.05 } }
/// bending = { plate = { rigidity = 5e-4 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IsometryKey {
    /// Rigid rods along all edges: exact lengths, folds along the lines of the mesh alone.
    #[default]
    Rods,
    /// The elasticity of the material, with slack where faces bend, and a limit of strain that nothing
    /// exceeds. For `bdf2` and `implicit_euler`.
    Elastic {
        /// Young's modulus times thickness, N/m: office paper has 3e5. By default the value of the material.
        #[serde(default)]
        stiffness: Option<f64>,
        /// Young's modulus times thickness across the `direction` of the sheet, N/m; `stiffness` is then
        /// along it.
        #[serde(default)]
        across: Option<f64>,
        /// Shear modulus times thickness of a sheet with a `direction`, N/m.
        #[serde(default)]
        shear: Option<f64>,
        /// Poisson's ratio, from 0 to 0.5. By default the value of the material; without a material 0.3. With
        /// `across` and `shear` it is the contraction across the direction by a pull along it, of any sign,
        /// by default 0.3.
        #[serde(default)]
        poisson: Option<f64>,
        /// The limit of the strain of a face, which nothing exceeds: above 0, below 0.5. By default the
        /// largest limit of the materials of the sheet and its patches; without a material 0.05. The limit
        /// `m` bounds the norm of Green's strain: edges become longer by a part of `sqrt(1 + 2 m) - 1` at
        /// most, shorter by `1 - sqrt(1 - 2 m)`.
        #[serde(default)]
        limit: Option<f64>,
    },
}

/// What bends are measured from: the shape that the sheet has without moments. (Creases have rest angles of
/// their own.)
///
/// ```toml
/// [sheet]
/// material = "office paper"
/// rest = "mesh"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum RestShape {
    /// The sheet unbends, however its mesh is curved.
    #[default]
    Flat,
    /// The mesh: a sheet that is curved stays curved. (`start.file` begins with another shape.)
    Mesh,
}

/// What resists bending.
///
/// ```toml
/// [sheet]
/// bending = { plate = { rigidity = 5e-4 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
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
        /// Poisson's ratio, from 0 to 0.5: how twist and bends in two directions at once compare with bends
        /// in one. By default the value of `isometry` or of the material; without both 0.3.
        #[serde(default)]
        poisson: Option<f64>,
    },
    /// A plate that is stiffer along one direction than across, as paper, wood and laminates are: curvatures
    /// `k_1` along the direction, `k_2` across and the twist `k_12` store
    /// `(along k_1^2 + 2 coupling k_1 k_2 + across k_2^2 + 4 twist k_12^2) / 2` per area.
    Orthotropic {
        /// The direction, in the frame of the mesh, of any length. By default the direction of the sheet.
        #[serde(default)]
        direction: Option<[f64; 3]>,
        /// Rigidity `D11` along the direction, N m.
        along: f64,
        /// Rigidity `D22` across it, N m.
        across: f64,
        /// Rigidity `D66` against twist, N m.
        twist: f64,
        /// Coupling `D12` of both, N m.
        #[serde(default)]
        coupling: f64,
    },
    /// Springs at the edges: cheaper than a plate, and dependent on the mesh where bends do not follow its
    /// lines. They know no Poisson's ratio.
    Hinges {
        /// Flexural rigidity, N m.
        rigidity: f64,
    },
}

impl SheetKey {
    /// A sheet of office paper without bending stiffness, of rigid rods.
    pub fn new(mesh: Mesh) -> Self {
        Self {
            name: None,
            mesh,
            refine: 0,
            material: None,
            direction: None,
            density: None,
            mass: None,
            thickness: 0.0,
            isometry: None,
            bending: None,
            rest: RestShape::Flat,
            curl: None,
            swell: None,
            stiffening: None,
            yields: None,
            patch: Vec::new(),
            damping: 0.0,
            placement: Pose::default(),
            start: StartKey::default(),
        }
    }

    /// The numbers of the material, if the sheet has one that is known; the means of both directions where it
    /// names one.
    pub(crate) fn made_of(&self) -> Option<engine::Material> {
        let material = self.material.as_ref().and_then(MaterialKey::numbers)?;
        Some(match self.direction {
            Some(_) => material.directed(),
            None => material,
        })
    }

    /// A sheet that is as one of its patches all over.
    pub(crate) fn of_patch(&self, patch: &Patch) -> Self {
        Self {
            material: Some(patch.material.clone()),
            direction: patch
                .direction
                .map(Direction::from)
                .or_else(|| self.direction.clone()),
            density: patch.density,
            isometry: match self.isometry() {
                IsometryKey::Rods => Some(IsometryKey::Rods),
                IsometryKey::Elastic { .. } => None,
            },
            bending: None,
            patch: Vec::new(),
            ..self.clone()
        }
    }

    /// Its direction in space.
    fn material_direction(&self) -> Option<engine::MaterialDirection> {
        let direction = self.direction.as_ref()?;
        Some(direction.in_space(|vector| self.placed(vector)))
    }

    /// A direction in the frame of the mesh in space, or that of the sheet.
    fn direction_or(&self, own: Option<[f64; 3]>) -> engine::MaterialDirection {
        let own = own.map(|own| engine::MaterialDirection::Uniform(self.placed(own)));
        let direction = own.or_else(|| self.material_direction());
        direction.unwrap_or(engine::MaterialDirection::Faces(Vec::new()))
    }

    /// Mass of a square metre, kg/m2, unless `mass` is given: as written, of the material, or of office
    /// paper.
    pub fn areal_density(&self) -> f64 {
        let density = self.density.or(self.made_of().map(|m| m.density));
        density.unwrap_or(PAPER_DENSITY)
    }

    /// The numbers across the direction that are written for the elasticity in the plane.
    fn written_across(&self) -> Option<[f64; 2]> {
        match self.isometry {
            Some(IsometryKey::Elastic { across, shear, .. }) => Some([across?, shear?]),
            _ => None,
        }
    }

    /// What keeps the lengths: as written, or what follows from the material.
    pub fn isometry(&self) -> IsometryKey {
        match (&self.isometry, &self.material) {
            (Some(isometry), _) => isometry.clone(),
            (None, Some(_)) => IsometryKey::ELASTIC,
            (None, None) => IsometryKey::Rods,
        }
    }

    /// What resists bending: as written, or what follows from the material.
    pub fn bending(&self) -> Bending {
        match (&self.bending, self.made_of()) {
            (Some(bending), _) => bending.clone(),
            (None, Some(m)) if m.rigidity > 0.0 => Bending::Plate {
                rigidity: m.rigidity,
                poisson: None,
            },
            (None, _) => Bending::None,
        }
    }

    /// Poisson's ratio: as written for the elasticity in the plane, of the material, or a typical one.
    fn poisson(&self) -> f64 {
        let written = match self.isometry {
            Some(IsometryKey::Elastic { poisson, .. }) => poisson,
            _ => None,
        };
        let given = written.or(self.made_of().map(|m| m.poisson));
        given.unwrap_or_else(typical_poisson)
    }

    /// The stiffness of the plate, if bending is resisted by one: as written, or what follows from the
    /// elasticity and the material.
    pub fn plate(&self) -> Option<engine::PlateLaw> {
        let direction = self.material_direction();
        if let (None, Some(material), Some(_)) = (&self.bending, self.made_of(), &direction) {
            return (material.rigidity > 0.0).then(|| material.plate(direction.as_ref()));
        }
        match self.bending() {
            Bending::Plate { rigidity, poisson } => {
                let poisson = poisson.unwrap_or_else(|| self.poisson());
                Some(engine::PlateStiffness { rigidity, poisson }.into())
            }
            Bending::Orthotropic {
                direction,
                along,
                across,
                twist,
                coupling,
            } => {
                let direction = self.direction_or(direction);
                let plate = engine::OrthotropicPlate {
                    along,
                    across,
                    coupling,
                    twist,
                    direction,
                };
                Some(plate.into())
            }
            Bending::None | Bending::Hinges { .. } => None,
        }
    }

    /// The curvature that it has by itself, unless that is of another shape.
    pub(crate) fn natural_curvature(&self) -> Option<engine::Curl> {
        let curl = self.curl.as_ref()?;
        Some(engine::Curl {
            direction: self.direction_or(curl.along),
            curvature: curl.tensor().into(),
            profile: curl.profile.as_given(),
        })
    }

    /// A direction in the frame of the mesh, in space.
    pub(crate) fn placed(&self, direction: [f64; 3]) -> [f64; 3] {
        let [from, to] = [[0.0; 3], direction].map(|p| self.placement.place(p));
        std::array::from_fn(|k| to[k] - from[k])
    }

    /// When the sheet yields in bending, per metre of its width: as written, or of the material. Nothing if
    /// it never does.
    pub fn yields(&self) -> Option<engine::Yield> {
        self.yields?.numbers(self.made_of().and_then(|m| m.yields))
    }

    /// The numbers of an elastic sheet: as written, of the material, or defaults. `None` of other sheets, and
    /// without a stiffness.
    pub fn elasticity(&self) -> Option<Elasticity> {
        let IsometryKey::Elastic {
            stiffness,
            poisson,
            limit,
            ..
        } = self.isometry()
        else {
            return None;
        };
        let (material, direction) = (self.made_of(), self.material_direction());
        let law = match (stiffness, self.written_across(), &direction, material) {
            (Some(along), Some([across, shear]), Some(direction), _) => {
                let membrane = engine::OrthotropicMembrane {
                    along,
                    across,
                    shear,
                    poisson: poisson.unwrap_or_else(typical_poisson),
                    direction: direction.clone(),
                };
                membrane.into()
            }
            (None, _, Some(_), Some(material)) if material.directions.is_some() => {
                material.membrane(direction.as_ref())
            }
            _ => engine::MembraneLaw::Isotropic {
                stiffness: stiffness.or(material.map(|m| m.stiffness))?,
                poisson: self.poisson(),
            },
        };
        let of_material = material.map_or(engine::Material::STRAIN_LIMIT, |m| m.strain_limit);
        let of_patches = self
            .patch
            .iter()
            .filter_map(|own| self.of_patch(own).made_of());
        let of_patches = of_patches.map(|material| material.strain_limit);
        Some(Elasticity {
            law,
            limit: limit.unwrap_or_else(|| of_patches.fold(of_material, f64::max)),
        })
    }

    /// Checks that the sheet has a direction where its stiffness has, and nowhere else.
    fn check_direction(&self, key: &Key, checks: &mut Checks) {
        if let Some(direction) = &self.direction {
            direction.check(key.name("direction"), checks);
            if matches!(direction, Direction::Texture(_)) && !matches!(self.mesh, Mesh::File(_)) {
                let message = "the direction comes from a texture, but the mesh is from no file";
                checks.report(
                    key.name("direction.uv"),
                    message,
                    "give a vector, for instance [1, 0, 0]",
                );
            }
        }
        let of_material = self.made_of().is_some_and(|m| m.directions.is_some());
        let own = match self.bending {
            Some(Bending::Orthotropic { direction, .. }) => Some(direction),
            _ => None,
        };
        let across = match self.isometry {
            Some(IsometryKey::Elastic { across, shear, .. }) => [across, shear],
            _ => [None; 2],
        };
        let elastic = key.name("isometry.elastic");
        if let [None, Some(_)] | [Some(_), None] = across {
            let message = "`across` and `shear` belong together, and one of them is left out";
            checks.report(elastic.clone(), message, "give both, or none");
        }
        let is_written = across[0].is_some();
        if is_written
            && matches!(
                self.isometry,
                Some(IsometryKey::Elastic {
                    stiffness: None,
                    ..
                })
            )
        {
            let message = "the stiffness across the direction is given, and not that along it";
            checks.report(elastic, message, "give `stiffness` as well");
        }
        let remedy = "give the sheet its `direction`, for instance [1, 0, 0]";
        if self.direction.is_none() {
            if is_written {
                let message = "the sheet is stiffer along a direction, and has none";
                checks.report(key.name("isometry.elastic.across"), message, remedy);
            }
            if own == Some(None) {
                let message = "the plate is stiffer along a direction, and the sheet has none";
                checks.report(key.name("bending.orthotropic"), message, remedy);
            }
            if self
                .material
                .as_ref()
                .is_some_and(MaterialKey::needs_direction)
            {
                let message = "the material is stiffer along a direction, and the sheet has none";
                checks.report(key.name("material"), message, remedy);
            }
        } else if !(of_material || is_written || own == Some(None)) && self.patch.is_empty() {
            checks.report(
                key.name("direction"),
                "nothing of the sheet depends on a direction",
                "leave it out, or give a material that has two directions (docs/materials.md says which)",
            );
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        self.mesh.check(&key.name("mesh"), checks);
        if let Some(material) = &self.material {
            material.check(&key.name("material"), checks);
        }
        self.check_direction(key, checks);
        checks.positive(
            key.name("density"),
            self.density,
            Unit::KilogramPerSquareMetre,
        );
        checks.positive(key.name("mass"), self.mass, Unit::Kilogram);
        checks.not_negative(key.name("thickness"), self.thickness, Unit::Metre);
        checks.not_negative(key.name("damping"), self.damping, Unit::PerSecond);
        let isometry = self.isometry();
        isometry.check(&key.name("isometry"), checks);
        if let Some(bending) = &self.bending {
            bending.check(&key.name("bending"), checks);
        }
        if self.yields.is_some() {
            let key = key.name("yield");
            if self.yields().is_none() {
                checks.report(
                    key.clone(),
                    "the sheet has neither a moment at which it yields nor a material that gives one",
                    "give `moment` in N m per m of width, or a material of which docs/materials.md says when it yields",
                );
            }
            if self.bending() == Bending::None {
                checks.report(
                    key,
                    "the sheet yields in bending, and nothing resists bending",
                    "give `sheet.bending`, or `sheet.material`",
                );
            }
        }
        if let Some(curl) = &self.curl {
            let key = key.name("curl");
            curl.check(self.direction.as_ref(), &key, checks);
            if matches!(self.bending(), Bending::None | Bending::Hinges { .. }) {
                let message = "the sheet curls, and no plate resists bending";
                checks.report(key.clone(), message, PLATE);
            }
            if self.rest == RestShape::Mesh {
                let remedy = "leave out `curl`, or `rest`";
                checks.report(
                    key,
                    "the sheet is curved as its mesh is, and curls besides",
                    remedy,
                );
            }
        }
        if let Some(swell) = &self.swell {
            let key = key.name("swell");
            if swell.as_given().validate().is_ok() {
                for part in swell.range(0.0) {
                    checks.within(key.clone(), part, engine::ElasticSheet::SWELLING);
                }
            }
            if isometry == IsometryKey::Rods {
                checks.report(
                    key,
                    "the sheet swells or shrinks, and it is of rigid rods, which keep their lengths",
                    "give `sheet.material`, or `isometry = { elastic = { stiffness = ... } }`",
                );
            }
        }
        if let Some(stiffening) = &self.stiffening {
            let key = key.name("stiffening");
            if stiffening.as_given().validate().is_ok() {
                let [least, _] = stiffening.range(0.0);
                checks.positive(key.clone(), least, Unit::Factor);
            }
            if self.bending() == Bending::None {
                let message = "the stiffness changes, and nothing resists bending";
                checks.report(key, message, "give `sheet.bending`, or `sheet.material`");
            }
        }
        if self.rest == RestShape::Mesh && self.bending() == Bending::None {
            let message = "bends are measured from the mesh, and nothing resists bending";
            checks.report(
                key.name("rest"),
                message,
                "give `sheet.bending`, or `sheet.material`",
            );
        }
        let is_elastic = matches!(isometry, IsometryKey::Elastic { .. });
        if is_elastic && self.material.is_none() && self.elasticity().is_none() {
            checks.report(
                key.name("isometry.elastic"),
                "the elastic sheet has neither a stiffness nor a material that gives one",
                "give `stiffness` in N/m, Young's modulus times thickness, or `sheet.material`",
            );
        }
    }
}

/// What to do where a plate is needed.
const PLATE: &str = "give `sheet.bending` as a `plate`, or `sheet.material`";

/// Limits of strain. Smaller ones than a millionth come near the rounding of positions; at a strain of -0.5
/// an edge has no length.
const LIMITS: [f64; 2] = [1e-6, 0.49];

impl IsometryKey {
    /// Elastic, with the numbers of the material.
    pub const ELASTIC: Self = Self::Elastic {
        stiffness: None,
        across: None,
        shear: None,
        poisson: None,
        limit: None,
    };

    fn check(&self, key: &Key, checks: &mut Checks) {
        match self {
            Self::Elastic {
                stiffness,
                across,
                shear,
                poisson,
                limit,
            } => {
                let key = key.name("elastic");
                let unit = Unit::NewtonPerMetre;
                let all = [
                    ("stiffness", stiffness),
                    ("across", across),
                    ("shear", shear),
                ];
                for (name, stiffness) in all {
                    checks.positive(key.name(name), *stiffness, unit);
                }
                let ratios = ratios(*stiffness, *across);
                checks.within(key.name("poisson"), *poisson, ratios);
                checks.within(key.name("limit"), *limit, LIMITS);
            }
            Self::Rods => {}
        }
    }
}

impl Bending {
    /// The flexural rigidity, N m.
    pub(crate) fn rigidity(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Plate { rigidity, .. } | Self::Hinges { rigidity } => *rigidity,
            // That of the least work: what locks first where a mesh cannot follow a bend.
            Self::Orthotropic { along, across, .. } => along.min(*across),
        }
    }

    fn check(&self, key: &Key, checks: &mut Checks) {
        let name = match self {
            Self::None => return,
            Self::Plate { poisson, .. } => {
                if let Some(poisson) = poisson {
                    checks.within(key.name("plate.poisson"), *poisson, [0.0, 0.5]);
                }
                "plate.rigidity"
            }
            Self::Hinges { .. } => "hinges.rigidity",
            Self::Orthotropic {
                direction,
                along,
                across,
                twist,
                coupling,
            } => {
                let key = key.name("orthotropic");
                if let Some(direction) = direction {
                    checks.direction(key.name("direction"), direction);
                }
                let unit = Unit::NewtonMetre;
                for (name, rigidity) in [("along", along), ("across", across), ("twist", twist)] {
                    checks.positive(key.name(name), *rigidity, unit);
                }
                checks.number(key.name("coupling"), *coupling, unit);
                if coupling * coupling >= along * across {
                    let message = "the coupling leaves a bend without resistance";
                    let remedy = "give one whose square is less than `along across`";
                    checks.report(key.name("coupling"), message, remedy);
                }
                return;
            }
        };
        checks.positive(key.name(name), self.rigidity(), Unit::NewtonMetre);
    }
}
