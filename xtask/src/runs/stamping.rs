//! A sheet of metal on a frame, punched upwards by a square die.

use super::Staged;
use super::scene::SelfContact;
use anyhow::Result;
use isosheet_collide::{
    Coefficients, ContactOptions, Contacts, Keyframe, Motion, Obstacle, Shape, Stiffness,
};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::generate::isotropic_square;
use isosheet_mesh::{MassKind, Sheet};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};

/// Everything that decides how a run goes: the blank starts flat and at rest on the frame, its middle at the origin, the die just
/// below it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stamping {
    /// Name of the folder of the run.
    pub(crate) name: String,
    /// Level k of the mesh M^k.
    pub(crate) level: u32,
    /// Side of the blank, metres.
    pub(crate) side: f64,
    /// Mass of a square metre, kilograms.
    pub(crate) weight: f64,
    /// Half the side of the die, metres.
    pub(crate) die: f64,
    /// Half the side of the opening of the frame, metres.
    pub(crate) opening: f64,
    /// Half the width of the four holders above the middles of the frame's sides, metres.
    pub(crate) holder: f64,
    /// Clearance between frame and holders, metres.
    pub(crate) clearance: f64,
    /// Speed of the die, metres per second.
    pub(crate) speed: f64,
    /// Way of the die, metres.
    pub(crate) stroke: f64,
    /// Gap below which contact acts, metres.
    pub(crate) activation: f64,
    /// Stiffness of the contact barrier, joules.
    pub(crate) stiffness: f64,
    /// Coefficient of friction with the tools.
    pub(crate) friction: f64,
    pub(crate) contact: SelfContact,
    /// Rate of the velocity damping, 1/s.
    pub(crate) damping: f64,
    /// Time between frames, seconds.
    pub(crate) frame: f64,
    /// Number of frames after the first.
    pub(crate) frames: usize,
}

/// The number of the die among the bodies; frame and holders follow, four each.
pub(crate) const DIE: usize = 0;

/// Thickness of frame and holders, and height of the die, metres.
const PLATE: f64 = 0.02;
const BLOCK: f64 = 0.2;

/// How far frame and holders reach out beyond the blank, as part of half its side.
const MARGIN: f64 = 0.2;

impl Stamping {
    /// The same scene with a sheet that may pass through itself.
    pub(crate) fn without_self_contact(&self) -> Self {
        Self {
            name: format!("{}-free", self.name),
            contact: SelfContact::None,
            ..self.clone()
        }
    }

    /// Four bars around the opening, from its edge outwards, `half` as wide, at height `z` of their middle.
    fn ring(&self, half: [f64; 2], z: f64) -> Result<Vec<Obstacle>> {
        let outer = 0.5 * (1.0 + MARGIN) * self.side;
        let width = 0.5 * (outer - self.opening);
        let middle = self.opening + width;
        let bar = |x: f64, y: f64, hx: f64, hy: f64| {
            let half = [hx, hy, 0.5 * PLATE];
            Obstacle::still(Shape::Cuboid { half }, Isometry3::translation(x, y, z))
        };
        let [across, along] = half;
        Ok(vec![
            bar(middle, 0.0, width, across)?,
            bar(-middle, 0.0, width, across)?,
            bar(0.0, middle, along, width)?,
            bar(0.0, -middle, along, width)?,
        ])
    }
}

impl Staged for Stamping {
    fn name(&self) -> &str {
        &self.name
    }

    fn frame(&self) -> f64 {
        self.frame
    }

    fn frames(&self) -> usize {
        self.frames
    }

    fn sheet(&self) -> Result<Sheet> {
        let half = 0.5 * self.side;
        Ok(isotropic_square(self.level, self.side)?
            .map_positions(|[x, y, z]| [x - half, y - half, z])?)
    }

    fn bodies(&self) -> Result<Vec<Obstacle>> {
        let pose = |z: f64| Isometry3::translation(0.0, 0.0, z - 0.5 * BLOCK);
        let low = -self.activation;
        let motion = Motion::new(vec![
            Keyframe {
                t: 0.0,
                pose: pose(low),
            },
            Keyframe {
                t: self.stroke / self.speed,
                pose: pose(low + self.stroke),
            },
        ])?;
        let half = [self.die, self.die, 0.5 * BLOCK];
        let mut bodies = vec![Obstacle::new(Shape::Cuboid { half }, motion)?];
        let outer = 0.5 * (1.0 + MARGIN) * self.side;
        bodies.extend(self.ring([outer, self.opening], low - 0.5 * PLATE)?);
        bodies.extend(self.ring([self.holder; 2], low + self.clearance + 0.5 * PLATE)?);
        Ok(bodies)
    }

    fn simulation(&self, sheet: &Sheet) -> Result<Simulation> {
        let model = SheetModel::new(sheet, self.weight * sheet.area(), MassKind::Lumped)?
            .with_gravity()
            .with_damping(self.damping)?;
        let options = ContactOptions {
            activation: self.activation,
            stiffness: Stiffness::Joules(self.stiffness),
            ..ContactOptions::for_sheet(&model)
        };
        let mut contacts = Contacts::new(&model, options)?;
        for body in self.bodies()? {
            contacts = contacts.with_body(body, Coefficients::equal(self.friction))?;
        }
        contacts = self.contact.add_to(contacts)?;
        let state = State::at_rest(sheet.positions().to_vec());
        Ok(Simulation::new(model, state, Method::default())?.with_contact(contacts)?)
    }
}
