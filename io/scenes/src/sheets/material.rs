//! The material of the sheet.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::toml_problem::suggestion;
use crate::words::unit::Unit;
use crate::words::warning::Warning;
use isosheet_dynamics as engine;
use isosheet_dynamics::OptionsError;
use isosheet_mesh::wording::{brief, given};
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// What the sheet is made of: the name of a material (materials.md lists all of them, with numbers and
/// sources), or a `Plate`. A material gives the sheet its mass and bending stiffness, and makes it elastic;
/// `density`, `mass`, `bending` and `isometry` beside it replace what it gives.
///
/// ```toml
/// [sheet]
/// material = "office paper"
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Part)]
#[serde(untagged)]
pub enum MaterialKey {
    /// One of the materials that have a name.
    #[schemars(extend("examples" = engine::Material::names().collect::<Vec<_>>()))]
    Named(String),
    /// A plate of one isotropic material.
    Plate(Plate),
}

/// A plate of one isotropic material: its mass is `density thickness`, its membrane stiffness `youngs
/// thickness` and its flexural rigidity `youngs thickness^3 / (12 (1 - poisson^2))`.
///
/// ```toml
/// [sheet]
/// material = { youngs = 2.1e11, thickness = 5e-4, density = 7850, poisson = 0.3 }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    /// Young's modulus, Pa: steel has 2.1e11.
    pub youngs: f64,
    /// Thickness of the material, metres. Contact keeps the distance `sheet.thickness`, not this one.
    pub thickness: f64,
    /// Mass of a cubic metre, kg/m3: steel has 7850.
    pub density: f64,
    /// Poisson's ratio, from 0 to 0.5.
    #[serde(default = "typical_poisson")]
    pub poisson: f64,
    /// Young's modulus across the `direction` of the sheet, Pa, of a material that is stiffer along it, as
    /// laminates and wood are; `youngs` is the modulus along it, and `poisson` the contraction across it by a
    /// pull along it, of any sign.
    #[serde(default)]
    pub youngs_across: Option<f64>,
    /// Shear modulus of a material with a `direction`, Pa.
    #[serde(default)]
    pub shear: Option<f64>,
    /// Stress at which the material yields, Pa: steel has from 2e8. It makes the sheet yield where
    /// `sheet.yield` says so, at the moment `yield_stress thickness^2 / 4`.
    #[serde(default)]
    pub yield_stress: Option<f64>,
}

/// Poisson's ratio of most solids, between 0.25 and 0.4: metals, paper, films.
pub(crate) fn typical_poisson() -> f64 {
    0.3
}

/// The range of Poisson's ratio of a material with a stiffness along its direction and one across it, whose
/// root it must not exceed; that of isotropic ones without.
pub(crate) fn ratios(along: Option<f64>, across: Option<f64>) -> [f64; 2] {
    let most = along
        .zip(across)
        .map(|(along, across)| (along / across).sqrt());
    let most = most.filter(|most| most.is_normal());
    most.map_or([0.0, 0.5], |most| [-most, most])
}

/// Young's modulus by density below which the unit of the modulus is questioned, m2/s2. Gels have 5 to 100,
/// foams and rubbers from 500; metals, papers and films have from 1e6, and with a modulus in megapascals 1 to
/// 30.
const SOFTEST: f64 = 50.0;

impl Plate {
    /// Numbers that are right in another unit, as it seems.
    pub(crate) fn warning(&self, key: &Key) -> Option<Warning> {
        (self.youngs / self.density < SOFTEST).then(|| {
            let message = format!(
                "`{}` is {} Pa, softer than jelly",
                key.name("youngs"),
                given(self.youngs)
            );
            Warning::new(message, "give it in pascals: 3500 MPa are 3.5e9 Pa")
        })
    }

    /// Whether it is stiffer along a direction.
    fn has_directions(&self) -> bool {
        self.youngs_across.is_some() || self.shear.is_some()
    }

    fn numbers(&self) -> Result<engine::Material, OptionsError> {
        let Self {
            youngs,
            thickness,
            density,
            poisson,
            ..
        } = *self;
        let material = match (self.youngs_across, self.shear) {
            (Some(youngs_across), Some(shear)) => {
                engine::Material::orthotropic(engine::Orthotropic {
                    youngs,
                    youngs_across,
                    shear,
                    poisson,
                    thickness,
                    density,
                })
            }
            _ => engine::Material::isotropic(engine::Isotropic {
                youngs,
                thickness,
                density,
                poisson,
            }),
        };
        let material = material?;
        Ok(match self.yield_stress {
            Some(stress) => material.with_yield_stress(self.thickness, stress),
            None => material,
        })
    }

    fn check(&self, key: &Key, checks: &mut Checks) {
        let before = checks.problems.len();
        checks.positive(key.name("youngs"), self.youngs, Unit::Pascal);
        checks.positive(key.name("thickness"), self.thickness, Unit::Metre);
        let unit = Unit::KilogramPerCubicMetre;
        checks.positive(key.name("density"), self.density, unit);
        let ratios = ratios(Some(self.youngs), self.youngs_across);
        checks.within(key.name("poisson"), self.poisson, ratios);
        for (name, modulus) in [("youngs_across", self.youngs_across), ("shear", self.shear)] {
            checks.positive(key.name(name), modulus, Unit::Pascal);
        }
        if self.has_directions() && (self.youngs_across.is_none() || self.shear.is_none()) {
            let message =
                "`youngs_across` and `shear` belong together, and one of them is left out";
            checks.report(key.clone(), message, "give both, or none");
        }
        checks.positive(key.name("yield_stress"), self.yield_stress, Unit::Pascal);
        if checks.problems.len() > before {
            return;
        }
        if let Err(error) = self.numbers() {
            let message = format!("these numbers give no sheet: {error}");
            checks.report(
                key.clone(),
                message,
                "check `thickness`, which is in metres",
            );
        }
    }
}

impl MaterialKey {
    /// The material of a name.
    pub fn named(name: impl Into<String>) -> Self {
        Self::Named(name.into())
    }

    /// Its numbers; `None` if it has a name that is not known, or numbers that make no sense.
    pub fn numbers(&self) -> Option<engine::Material> {
        match self {
            Self::Named(name) => engine::Material::named(name).ok(),
            Self::Plate(plate) => plate.numbers().ok(),
        }
    }

    /// Its numbers in a line, for those who read what a scene is.
    pub(crate) fn in_words(&self) -> Option<String> {
        let numbers = self.numbers()?;
        let what = match self {
            Self::Named(name) => {
                let mut all = engine::Material::catalogue().iter();
                let named = all.find(|m| m.material == numbers);
                named.map_or(name.clone(), |m| format!("{}, {}", m.name, m.form))
            }
            Self::Plate(plate) => format!("a plate of {} m", given(plate.thickness)),
        };
        Some(
            format!(
                "{what}: {} kg/m2, E h {} N/m, D {} N m, Poisson's ratio {}, strain at most {} %",
                brief(numbers.density),
                brief(numbers.stiffness),
                brief(numbers.rigidity),
                brief(numbers.poisson),
                brief(100.0 * numbers.strain_limit)
            ) + &numbers.yields.map_or(String::new(), |yields| {
                format!(", yields at {} N m/m", brief(yields.moment))
            }) + &numbers.directions.map_or(String::new(), |_| {
                ", stiffer along its direction where `sheet.direction` names one".to_owned()
            }),
        )
    }

    /// Whether it is given by two moduli, whose direction has to be known.
    pub(crate) fn needs_direction(&self) -> bool {
        matches!(self, Self::Plate(plate) if plate.has_directions())
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        match self {
            Self::Named(name) => {
                if let Err(unknown) = engine::Material::named(name) {
                    let message = format!("`{name}` is no material that is known");
                    let remedy = format!(
                        "{}; or give its numbers, `{{ youngs = ..., thickness = ..., density = ... }}`",
                        suggestion(name, &unknown.names)
                    );
                    checks.report(key.clone(), message, remedy);
                }
            }
            Self::Plate(plate) => plate.check(key, checks),
        }
    }
}

impl<'de> Deserialize<'de> for MaterialKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(MaterialVisitor)
    }
}

struct MaterialVisitor;

impl<'de> Visitor<'de> for MaterialVisitor {
    type Value = MaterialKey;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "the name of a material in quotes, or a table with `youngs`, `thickness` and `density`",
        )
    }

    fn visit_str<E>(self, name: &str) -> Result<MaterialKey, E> {
        Ok(MaterialKey::named(name))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MaterialKey, A::Error> {
        Plate::deserialize(MapAccessDeserializer::new(map)).map(MaterialKey::Plate)
    }
}
