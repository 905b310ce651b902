//! Seams.

use super::builder::{Builder, at};
use crate::scene::bodies;
use crate::scene::error::SceneError;
use crate::scene::key::Key;
use isosheet_dynamics::{Attachment, Glue, PAPER_GRAVITY, SimulationError};
use isosheet_mesh::VertexId;

impl Builder<'_> {
    pub(super) fn add_glue(&mut self) -> Result<(), SceneError> {
        let rigidity = self.scene.sheet.iter().map(|s| s.bending().rigidity());
        let rigidity = rigidity.fold(0.0, f64::max);
        let norm = |g: [f64; 3]| g.iter().map(|c| c * c).sum::<f64>().sqrt();
        let gravity = self.scene.forces.gravity.map(norm).filter(|g| *g > 0.0);
        let gravity = gravity.unwrap_or(norm(PAPER_GRAVITY));
        for (key, seam) in Key::root().name("glue").entries(&self.scene.glue) {
            let model = self.model();
            let (mass, length) = (model.mass().total(), self.sheets.union.mean_length());
            let stiffness = seam.stiffness(mass, gravity, rigidity, length);
            let number = seam
                .body()
                .and_then(|name| bodies::number_of(&self.scene.body, name));
            if let Some(number) = number {
                let body = &self.bodies.list[number];
                let vertices = seam.first_vertices(&self.sheets, &key)?;
                let glued = vertices.iter().map(|v| (*v, number));
                self.glued_to_bodies.extend(glued);
                let carried = |v: VertexId| (v, body.body.carried(self.position(v), body.first));
                let pairs = vertices.into_iter().map(carried).collect();
                let attachment = Attachment::new(pairs, stiffness).map_err(at(&key))?;
                self.change(
                    |m| Ok(m.with_potential(attachment)),
                    at::<SimulationError>(&key),
                )?;
                continue;
            }
            let pairs = seam.pairs(&self.sheets, &key)?;
            let model = self.model();
            let closing = seam.closing.as_given();
            let glue = Glue::new(model.topology(), &pairs, stiffness, closing, &self.x);
            let glue = glue.map_err(at(&key))?;
            self.targets.seams.push(glue.clone());
            self.change(|m| Ok(m.with_potential(glue)), at::<SimulationError>(&key))?;
        }
        self.count(self.scene.glue.len(), "seam", "seams");
        Ok(())
    }
}
