//! Rigid bodies that respond.

use crate::SheetKey;
use crate::bodies::guides::{BodyForceKey, BodyTorqueKey, Guide};
use crate::bodies::obstacles::ShapeKey;
use crate::sheets::start::Spin;
use crate::time::pose::Pose;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::{self, Part};
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rigid body that responds: contact and gravity move it. It meets sheets, obstacles and other bodies,
/// whether `contact.self_contact` is set or not, by their friction: `obstacle.friction`, or otherwise
/// `contact.friction`, or the friction of a `contact.pair` with its name.
///
/// ```toml
/// [[body]]
/// shape = { box = { size = [0.06, 0.05, 0.04] } }
/// density = 500
/// pose = { position = [0.05, 0.05, 0.1] }
/// velocity = [0, 0, -1]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct BodyKey {
    /// A name, by which measures and pairs of friction find it; if left out, `body_0` and so on.
    #[serde(default)]
    pub name: Option<String>,
    /// Its form, which encloses a volume. The triangles of a file have to be closed, with counter-clockwise
    /// corners as seen from outside; it may have cavities.
    pub shape: ShapeKey,
    /// Sides of the circles of round shapes, from 4 to 256, by which they are drawn and measured; if left out
    /// 32, and of cylinders 256. Spheres and capsules touch by their true surface, cylinders as a prism with
    /// so many sides, whose corners are on the shape. The body has the mass, centre and inertia of the true
    /// shape.
    #[serde(default)]
    pub sides: Option<usize>,
    /// Density, kg/m3. Either this or `mass` has to be given.
    #[serde(default)]
    pub density: Option<f64>,
    /// Mass, kilograms.
    #[serde(default)]
    pub mass: Option<f64>,
    /// Where it is at the start.
    #[serde(default)]
    pub pose: Pose,
    /// Velocity of its centre of mass at the start, m/s.
    #[serde(default)]
    pub velocity: [f64; 3],
    /// Rotation at the start beside the velocity, of a guided body about a point of the guide if no other is
    /// given.
    #[serde(default)]
    pub spin: Option<Spin>,
    /// A joint that guides it; without one it is free.
    #[serde(default)]
    pub guide: Option<Guide>,
    /// Forces on it besides gravity, contact and the guide.
    #[serde(default)]
    pub force: Vec<BodyForceKey>,
    /// Torques on it.
    #[serde(default)]
    pub torque: Vec<BodyTorqueKey>,
}

/// Sides of circles where a body is drawn with them.
const DRAWN: usize = 32;

/// Sides of circles where a body touches with them: it rolls down at the acceleration of a true cylinder to
/// half a per cent then.
const TOUCHING: usize = 256;

/// Least and largest number of sides of a circle.
const SIDES: [f64; 2] = [4.0, 256.0];

impl BodyKey {
    /// A free body at rest, of a shape with a density (kg/m3).
    pub fn new(shape: ShapeKey, density: f64) -> Self {
        Self {
            name: None,
            shape,
            sides: None,
            density: Some(density),
            mass: None,
            pose: Pose::default(),
            velocity: [0.0; 3],
            spin: None,
            guide: None,
            force: Vec::new(),
            torque: Vec::new(),
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        let shape = key.name("shape");
        match self.shape {
            ShapeKey::HalfSpace | ShapeKey::Wall(_) => checks.report(
                shape.clone(),
                format!(
                    "`{}` encloses no volume, and cannot be a body",
                    self.shape.name()
                ),
                "choose a closed shape, or make it an `[[obstacle]]`",
            ),
            ShapeKey::Sequence(_) => checks.report(
                shape.clone(),
                "a mesh in motion is no body that responds",
                "make it an `[[obstacle]]`",
            ),
            _ => self.shape.check(&shape, checks),
        }
        checks.within(key.name("sides"), self.sides() as f64, SIDES);
        match (self.density, self.mass) {
            (None, None) => checks.report(
                key.clone(),
                "the body has no mass",
                "give it a `density` in kg/m3, or a `mass` in kg",
            ),
            (Some(_), Some(_)) => checks.report(
                key.name("mass"),
                "the body has a density and a mass",
                "leave one of them out",
            ),
            _ => {}
        }
        checks.positive(
            key.name("density"),
            self.density,
            Unit::KilogramPerCubicMetre,
        );
        checks.positive(key.name("mass"), self.mass, Unit::Kilogram);
        checks.finite(key.name("velocity"), &self.velocity, Unit::MetrePerSecond);
    }

    /// Sides of its circles.
    pub(crate) fn sides(&self) -> usize {
        self.sides.unwrap_or(match self.shape {
            ShapeKey::Sphere { .. } | ShapeKey::Capsule { .. } => DRAWN,
            // Polyhedra have their own.
            _ => TOUCHING,
        })
    }

    /// What of it does not change during a simulation: all but its functions of time.
    pub(crate) fn lasting(&self) -> Self {
        let mut lasting = self.clone();
        for (_, function) in part::all_mut::<ProfileKey>(&mut lasting, Key::root()) {
            *function = ProfileKey::default();
        }
        lasting
    }

    /// What it is called in messages and results: its name, or `body[0]` by its number in the scene.
    pub fn called(&self, number: usize) -> String {
        let numbered = || Key::root().name("body").entry(number).to_string();
        self.name.clone().unwrap_or_else(numbered)
    }

    pub(crate) fn name(&self, number: usize) -> String {
        self.name
            .clone()
            .unwrap_or_else(|| format!("body_{number}"))
    }
}

/// The number of the body of a name.
pub(crate) fn number_of(bodies: &[BodyKey], name: &str) -> Option<usize> {
    (0..bodies.len()).find(|&k| bodies[k].name(k) == name)
}

/// Checks the bodies beside the sheets of a scene.
pub(crate) fn check(bodies: &[BodyKey], all: &[SheetKey], checks: &mut Checks) {
    for (k, (key, body)) in Key::root().name("body").entries(bodies).enumerate() {
        let name = body.name(k);
        let is_other = number_of(bodies, &name) != Some(k);
        if is_other || all.iter().any(|sheet| sheet.name.as_ref() == Some(&name)) {
            let message = format!("another body or sheet has the name `{name}`, too");
            let remedy = "give each body a `name` of its own";
            checks.report(key.name("name"), message, remedy);
        }
        if name.is_empty() {
            checks.report(key.name("name"), "the name is empty", "leave it out");
        }
    }
}

/// The names of all bodies.
pub(crate) fn names(bodies: &[BodyKey]) -> impl Iterator<Item = String> + '_ {
    bodies.iter().enumerate().map(|(k, body)| body.name(k))
}
