//! Loads, accelerations and the air.

use super::builder::{Builder, at};
use crate::sheets::several;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::{AirKey, Frame, Selection};
use isosheet_attached_flow::AttachedFlow;
use isosheet_dynamics::{AccelerationField, SimulationError, TurningLoad, VertexLoad};
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

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
        if let Some(air) = &self.scene.air {
            self.add_air(air)?;
        }
        Ok(())
    }

    fn add_air(&mut self, air: &AirKey) -> Result<(), SceneError> {
        let key = Key::root().name("air");
        let Some(attached) = &air.attached else {
            self.change(|m| m.with_air(air.as_engine()), at(&key))?;
            self.modelled.push("air".into());
            return Ok(());
        };
        let key = key.name("attached");
        let name = attached.sheet.as_deref();
        let vertices = self.sheets.vertices(name, &Selection::All, &key)?;
        let shedding = self
            .sheets
            .vertices(name, &attached.trailing, &key.name("trailing"))?;
        self.check_leeward(air, name, [&vertices, &shedding], &key)?;
        let topology = self.model().topology();
        let among = |some: &[VertexId], corners: &[VertexId]| {
            corners.iter().all(|v| some.binary_search(v).is_ok())
        };
        let faces = topology.face_ids();
        let edges = topology
            .edge_ids()
            .filter(|e| topology.is_boundary_edge(*e));
        let flow = AttachedFlow {
            faces: faces
                .filter(|f| among(&vertices, &topology.faces()[f.index()]))
                .collect(),
            trailing: edges
                .filter(|e| among(&shedding, &topology.edges()[e.index()]))
                .collect(),
            rows: attached.rows,
        };
        self.change(|m| flow.around(m, air.as_engine()), at(&key))?;
        self.modelled.push("air with attached flow".into());
        Ok(())
    }

    /// Refuses a trailing edge all of which is on the windward half of the sheet at the start.
    fn check_leeward(
        &self,
        air: &AirKey,
        name: Option<&str>,
        [all, trailing]: [&[VertexId]; 2],
        key: &Key,
    ) -> Result<(), SceneError> {
        let Some(number) = several::number_of(&self.scene.sheet, name, key)? else {
            return Ok(());
        };
        let velocity = self.scene.sheet[number].start.velocity;
        let place = |v: &VertexId| Vector3::from(self.position(*v));
        let middle = all.iter().map(place).sum::<Vector3<f64>>() / all.len().max(1) as f64;
        let wind = air.wind.each_ref().map(|component| component.value(0.0));
        let flow = Vector3::from(wind) - Vector3::from(velocity);
        let is_windward = |v: &VertexId| flow.dot(&(place(v) - middle)) < 0.0;
        if !trailing.iter().all(is_windward) {
            return Ok(());
        }
        let message = "the air comes from the trailing edge at the start";
        let remedy = "name the edge on the other side, where the air leaves the sheet, or turn `air.wind` round";
        Err(Problem::new(key.name("trailing"), message, remedy).into())
    }
}
