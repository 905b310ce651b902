//! A strip of paper that is pushed into a bent guide.

use super::Staged;
use super::guide::Guide;
use super::scene::SelfContact;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Stiffness};
use isosheet_dynamics::{CreaseSprings, ImplicitOptions, Method, SheetModel, Simulation, State};
use isosheet_mesh::generate::{Diagonals, grid};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use serde::{Deserialize, Serialize};

/// Everything that decides how a run goes: the strip starts flat and at rest in the middle of the channel,
/// its leading edge where the bend begins. A nip holds the last two rungs, so that the strip leaves it
/// straight, and moves along.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Feed {
    /// Name of the folder of the run.
    pub(crate) name: String,
    pub(crate) guide: Guide,
    /// Length and width of the strip, metres.
    pub(crate) size: [f64; 2],
    /// Cells along the strip and over its width.
    pub(crate) cells: [usize; 2],
    /// Mass of a square metre, kilograms.
    pub(crate) weight: f64,
    /// Flexural rigidity of the paper, newton metres.
    pub(crate) rigidity: f64,
    /// Speed of the nip, metres per second, and how long it takes to reach it, seconds.
    pub(crate) speed: f64,
    pub(crate) ramp: f64,
    /// The nip slips at this force, newtons: then the run ends.
    pub(crate) limit: f64,
    /// Coefficient of friction with the walls.
    pub(crate) friction: f64,
    pub(crate) contact: SelfContact,
    /// Gap below which contact acts, metres.
    pub(crate) activation: f64,
    /// Stiffness of the contact barrier, joules.
    pub(crate) stiffness: f64,
    /// Rate of the velocity damping, 1/s.
    pub(crate) damping: f64,
    /// Time between frames, seconds.
    pub(crate) frame: f64,
    /// Number of frames after the first.
    pub(crate) frames: usize,
}

impl Feed {
    /// How far the nip has moved at time `t`, metres: its speed grows linearly to the full one.
    pub(crate) fn feed_length(&self, t: f64) -> f64 {
        let t = t.max(0.0);
        if t < self.ramp {
            0.5 * self.speed * t * t / self.ramp
        } else {
            self.speed * (t - 0.5 * self.ramp)
        }
    }

    /// The vertices in the nip.
    pub(crate) fn pinned(&self) -> Vec<VertexId> {
        let [along, across] = self.cells;
        let rung = |i: usize| (0..=across).map(move |j| VertexId::from_index(i + j * (along + 1)));
        rung(0).chain(rung(1)).collect()
    }
}

/// Penalty of the rods, ten times the default: the paper's bending resists a step a thousand times as much as
/// its inertia does, and the rods have to be stiffer than both.
const ROD_STIFFNESS: f64 = 1e5;

/// Force with which moving pins push a sheet along x, newtons.
pub(crate) fn push(simulation: &Simulation) -> f64 {
    simulation.reactions().iter().map(|r| r.force.x).sum()
}

impl Staged for Feed {
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
        let ([length, width], [along, across]) = (self.size, self.cells);
        Ok(grid(along, across, length, width, Diagonals::UnionJack)?
            .map_positions(|[x, y, z]| [x - length, y - 0.5 * width, z])?)
    }

    fn bodies(&self) -> Result<Vec<Obstacle>> {
        self.guide.bodies()
    }

    fn ends(&self, simulation: &Simulation) -> bool {
        push(simulation) > self.limit
    }

    fn simulation(&self, sheet: &Sheet) -> Result<Simulation> {
        let mut model = SheetModel::new(sheet, self.weight * sheet.area(), MassKind::Lumped)?
            .with_gravity()
            .with_damping(self.damping)?
            .with_potential(CreaseSprings::bending(sheet, self.rigidity)?);
        for v in self.pinned() {
            let (scene, [x, y, z]) = (self.clone(), sheet.position(v));
            model = model.with_moving_pin(v, move |t| [x + scene.feed_length(t), y, z])?;
        }
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
        let method = Method::Bdf2(ImplicitOptions {
            stiffness: ROD_STIFFNESS,
            ..ImplicitOptions::default()
        });
        Ok(Simulation::new(model, state, method)?.with_contact(contacts)?)
    }
}
