//! Loads that follow the sheet: pressure, enclosed gas, moments.

use super::builder::{Builder, at};
use crate::Selection;
use crate::loads::enclosed::EnclosedGauge;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_dynamics::{EdgeMoment, EnclosedGas, LoadedFaces, SimulationError};
use isosheet_mesh::wording::given;
use isosheet_mesh::{EdgeId, FaceId, VertexId};
use std::sync::Arc;

impl Builder<'_> {
    /// Adds what acts on faces and edges; seams that close surfaces have to be known.
    pub(super) fn add_follower_loads(&mut self) -> Result<(), SceneError> {
        let forces = &self.scene.forces;
        let key = Key::root().name("forces");
        for (key, pressure) in key.name("pressure").entries(&forces.pressure) {
            let faces = self.loaded(&pressure.sheets, &pressure.at, &key)?;
            let size = pressure.size.as_given();
            if let Some(name) = &pressure.name {
                let gauge = EnclosedGauge::Pressure(faces.clone(), size.clone());
                self.enclosed.insert(name.clone(), gauge);
            }
            self.change(|m| m.with_pressure(faces, size), at(&key.name("size")))?;
        }
        for (number, (key, gas)) in key.name("gas").entries(&forces.gas).enumerate() {
            let faces = self.loaded(&gas.sheets, &Selection::All, &key)?;
            let volume = faces.volume(&self.x).abs();
            let filled = EnclosedGas::new(&faces, gas.as_engine(), &self.x);
            let filled = Arc::new(filled.map_err(at(&key))?);
            let gauge = EnclosedGauge::Gas(Arc::clone(&filled));
            self.gases.push((gas.called(number), gauge.clone()));
            self.enclosed
                .extend(gas.name.clone().map(|name| (name, gauge)));
            self.change(
                |m| Ok(m.with_potential(filled)),
                at::<SimulationError>(&key),
            )?;
            let [least, _] = gas.added.range(self.scene.stop.time);
            if -least >= volume {
                let message = format!(
                    "{} m3 are let out, and there are {} m3 at the start",
                    given(-least),
                    given(volume)
                );
                let remedy = "let out less than is enclosed at the start";
                return Err(Problem::new(key.name("added"), message, remedy).into());
            }
        }
        for (key, moment) in key.name("moment").entries(&forces.moment) {
            let vertices = self
                .sheets
                .vertices(moment.sheet.as_deref(), &moment.at, &key)?;
            let edges = self.edges_between(&vertices, &key)?;
            let topology = self.model().topology();
            let size = moment.size.as_given();
            let moment = EdgeMoment::new(topology, &edges, moment.axis, size, &self.x);
            let moment = moment.map_err(at(&key))?;
            self.change(
                |m| Ok(m.with_edge_moment(moment)),
                at::<SimulationError>(&key),
            )?;
        }
        self.count(forces.pressure.len(), "pressure", "pressures");
        self.count(forces.gas.len(), "enclosed gas", "enclosed gases");
        self.count(forces.moment.len(), "moment on edges", "moments on edges");
        Ok(())
    }

    /// The faces of sheets with all corners selected, in the order in which the sheets are named.
    fn loaded(
        &self,
        names: &Option<Vec<String>>,
        selection: &Selection,
        key: &Key,
    ) -> Result<LoadedFaces, SceneError> {
        let names: Vec<Option<&str>> = match names {
            None => vec![None],
            Some(names) => names.iter().map(|name| Some(&name[..])).collect(),
        };
        let topology = self.model().topology();
        let mut faces: Vec<FaceId> = Vec::new();
        for name in names {
            let vertices = self.sheets.vertices(name, selection, key)?;
            let is_selected = |v: &VertexId| vertices.binary_search(v).is_ok();
            let own = topology.face_ids();
            faces.extend(own.filter(|f| topology.faces()[f.index()].iter().all(is_selected)));
        }
        if faces.is_empty() {
            return Err(Problem::new(
                key.name("at"),
                "no face has all of its corners in the selection",
                "select the corners of at least one face",
            )
            .into());
        }
        let seams = self.targets.seams.iter();
        let joined: Vec<[VertexId; 2]> = seams.flat_map(|seam| seam.pairs()).copied().collect();
        LoadedFaces::new(topology, &faces, &joined).map_err(at(key))
    }

    /// The edges both ends of which are among some vertices, in their order.
    fn edges_between(&self, vertices: &[VertexId], key: &Key) -> Result<Vec<EdgeId>, Problem> {
        let topology = self.model().topology();
        let is_between = |e: &EdgeId| {
            let ends = topology.edges()[e.index()];
            ends.iter().all(|v| vertices.binary_search(v).is_ok())
        };
        let edges: Vec<EdgeId> = topology.edge_ids().filter(is_between).collect();
        if edges.is_empty() {
            return Err(Problem::new(
                key.name("at"),
                "no edge has both of its ends in the selection",
                "select the vertices of a line of edges",
            ));
        }
        Ok(edges)
    }
}
