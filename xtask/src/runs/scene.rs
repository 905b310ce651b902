//! A sheet of paper held at its left-upper corner.

use super::Staged;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::generate::isotropic_square;
use isosheet_mesh::{MassKind, Sheet, VertexId};
use serde::{Deserialize, Serialize};

/// Everything that decides how a run goes: the sheet falls from exactly flat, horizontal and at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Scene {
    /// Name of the folder of the run.
    pub(crate) name: String,
    /// Level k of the mesh M^k.
    pub(crate) level: u32,
    /// Side of the sheet, metres.
    pub(crate) side: f64,
    /// Mass of a square metre, kilograms.
    pub(crate) paper: f64,
    /// Rate of the velocity damping, 1/s.
    pub(crate) damping: f64,
    /// Time between frames, seconds.
    pub(crate) frame: f64,
    /// Number of frames after the first.
    pub(crate) frames: usize,
    pub(crate) contact: SelfContact,
}

/// Whether a sheet meets itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SelfContact {
    /// It passes through itself.
    None,
    /// With this coefficient of friction.
    Friction(f64),
}

impl SelfContact {
    /// Adds it to the contacts of a scene.
    ///
    /// # Errors
    /// A coefficient that makes no sense.
    pub(crate) fn add_to(self, contacts: Contacts) -> Result<Contacts> {
        Ok(match self {
            Self::None => contacts,
            Self::Friction(mu) => contacts.with_self_contact(Coefficients::equal(mu))?,
        })
    }
}

/// Friction of paper on paper.
pub(crate) const PAPER_FRICTION: f64 = 0.3;

impl Scene {
    /// The scene of Figs. 11 and 12 at a level: office paper (80 g/m2) of the width of an A4 sheet.
    pub(crate) fn paper(level: u32, frames: usize) -> Self {
        Self {
            name: format!("crumple-m{level}"),
            level,
            side: 0.21,
            paper: 0.080,
            damping: 2.0,
            frame: 1.0 / 60.0,
            frames,
            contact: SelfContact::None,
        }
    }

    /// The same with contact of the sheet with itself.
    pub(crate) fn with_self_contact(self) -> Self {
        Self {
            name: format!("{}-contact", self.name),
            contact: SelfContact::Friction(PAPER_FRICTION),
            ..self
        }
    }

    /// The vertex that is held: the left-upper corner as seen from above.
    pub(crate) fn pin(&self) -> VertexId {
        let cells = 2usize << self.level;
        VertexId::from_index(cells * (cells + 1))
    }

    /// Mass of the sheet, kilograms.
    pub(crate) fn mass(&self) -> f64 {
        self.paper * self.side * self.side
    }

    /// The mechanical system: lumped masses as in the paper, gravity, damping, one corner held.
    pub(crate) fn model(&self, sheet: &Sheet) -> Result<SheetModel> {
        let model = SheetModel::new(sheet, self.mass(), MassKind::Lumped)?;
        Ok(model
            .with_gravity()
            .with_damping(self.damping)?
            .with_pins(&[self.pin()])?)
    }

    /// Name of the default method.
    pub(crate) fn method() -> &'static str {
        match Method::default() {
            Method::ImplicitEuler(_) => "implicit Euler",
            Method::Bdf2(_) => "BDF2",
            Method::Projection(_) => "projection",
            Method::EnergyMomentum(_) => "energy-momentum",
            Method::Rattle(_) => "RATTLE",
            Method::RattleComposition(_) => "fourth-order RATTLE",
        }
    }
}

impl Staged for Scene {
    fn name(&self) -> &str {
        &self.name
    }

    fn frame(&self) -> f64 {
        self.frame
    }

    fn frames(&self) -> usize {
        self.frames
    }

    /// The sheet at rest, `[0, side] x [0, side]` at height 0.
    fn sheet(&self) -> Result<Sheet> {
        Ok(isotropic_square(self.level, self.side)?)
    }

    /// With the default method.
    fn simulation(&self, sheet: &Sheet) -> Result<Simulation> {
        let model = self.model(sheet)?;
        let contacts = match self.contact {
            SelfContact::None => None,
            contact => {
                let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))?;
                Some(contact.add_to(contacts)?)
            }
        };
        let state = State::at_rest(sheet.positions().to_vec());
        let simulation = Simulation::new(model, state, Method::default())?;
        Ok(match contacts {
            None => simulation,
            Some(contacts) => simulation.with_contact(contacts)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pin_is_the_left_upper_corner() {
        for level in 0..4 {
            let scene = Scene::paper(level, 1);
            let sheet = scene.sheet().unwrap();
            assert_eq!(sheet.position(scene.pin()), [0.0, scene.side, 0.0]);
        }
        assert!((Scene::paper(0, 1).mass() - 3.528e-3).abs() < 1e-12);
    }
}
