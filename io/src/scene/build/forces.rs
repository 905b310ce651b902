//! Loads, accelerations and the air.

use super::builder::{Builder, at};
use crate::scene::error::SceneError;
use crate::scene::key::Key;
use crate::scene::{Air, Frame};
use isosheet_dynamics::{AccelerationField, SimulationError, TurningLoad, VertexLoad};

impl Builder<'_> {
    pub(super) fn add_forces(&mut self) -> Result<(), SceneError> {
        let forces = &self.scene.forces;
        let key = Key::root().name("forces");
        if let Some(gravity) = forces.gravity {
            self.change(
                |m| Ok(m.with_acceleration(gravity)),
                at::<SimulationError>(&key),
            )?;
            self.modelled.push("gravity".into());
        }
        for (key, load) in key.name("load").entries(&forces.load) {
            let vertices = self
                .sheets
                .vertices(load.sheet.as_deref(), &load.at, &key)?;
            let size = load.size.scaled(1.0 / vertices.len() as f64);
            let topology = self.model().topology();
            let direction = load.direction;
            let error = at::<SimulationError>(&key);
            match load.frame {
                Frame::Space => {
                    let load = VertexLoad::new(topology, &vertices, direction, size);
                    let load = load.map_err(at(&key))?;
                    self.change(|m| Ok(m.with_force(load)), error)?;
                }
                Frame::Sheet => {
                    let load = TurningLoad::new(topology, &vertices, direction, size, &self.x);
                    let load = load.map_err(at(&key))?;
                    self.change(|m| Ok(m.with_turning_load(load)), error)?;
                }
            }
        }
        for (key, field) in key.name("acceleration").entries(&forces.acceleration) {
            let weights = self.model().mass().row_sums(self.model().topology());
            let size = field.size.as_given();
            let field = AccelerationField::new(weights, field.direction, size);
            let field = field.map_err(at(&key))?;
            self.change(|m| Ok(m.with_force(field)), at::<SimulationError>(&key))?;
        }
        self.count(forces.load.len(), "load", "loads");
        let fields = ["field of acceleration", "fields of acceleration"];
        self.count(forces.acceleration.len(), fields[0], fields[1]);
        if let Some(air) = self.scene.air.as_ref().map(Air::as_engine) {
            self.change(|m| m.with_air(air), at(&Key::root().name("air")))?;
            self.modelled.push("air".into());
        }
        Ok(())
    }
}
