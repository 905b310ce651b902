//! Seams.

use super::builder::{Builder, at};
use crate::scene::bodies;
use crate::scene::bond::Bond;
use crate::scene::error::SceneError;
use crate::scene::key::Key;
use crate::scene::switch::Holder;
use isosheet_dynamics::{Attachment, Glue, PAPER_GRAVITY, Potential, Profile, SimulationError};
use isosheet_mesh::VertexId;

impl Builder<'_> {
    pub(super) fn add_glue(&mut self) -> Result<(), SceneError> {
        let rigidity = self.scene.sheet.iter().map(|s| s.bending().rigidity());
        let rigidity = rigidity.fold(0.0, f64::max);
        let norm = |g: [f64; 3]| g.iter().map(|c| c * c).sum::<f64>().sqrt();
        let gravity = self.scene.forces.gravity.map(norm).filter(|g| *g > 0.0);
        let gravity = gravity.unwrap_or(norm(PAPER_GRAVITY));
        let list = Key::root().name("glue");
        for (k, seam) in self.scene.glue.iter().enumerate() {
            let key = list.entry(k);
            let of = Holder::Glue(k);
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
                let numbers = self.switches.pairs(of, vertices.len());
                let pairs = numbers.iter().map(|n| carried(vertices[*n])).collect();
                let attachment = Attachment::new(pairs, stiffness).map_err(at(&key))?;
                let bond = Bond::of_body(numbers, attachment.clone());
                self.add_bond(&key, bond, attachment)?;
                continue;
            }
            let pairs = seam.pairs(&self.sheets, &key)?;
            let topology = self.model().topology();
            let glue = |pairs: &[[VertexId; 2]]| {
                let (closing, x) = match (&seam.from, self.switches.rest(of)) {
                    (None, _) => (seam.closing.as_given(), &self.x[..]),
                    (Some(_), rest) => (Profile::Constant(0.0), rest.unwrap_or(&self.x)),
                };
                Glue::new(topology, pairs, stiffness, closing, x).map_err(at(&key))
            };
            // All of them are checked, whichever hold.
            glue(&pairs)?;
            let numbers = self.switches.pairs(of, pairs.len());
            let holding: Vec<_> = numbers.iter().map(|n| pairs[*n]).collect();
            let glue = glue(&holding)?;
            if seam.from.is_none() {
                self.glued.extend(pairs);
            }
            self.targets.seams.push(glue.clone());
            let bond = Bond::of_sheets(numbers, glue.clone());
            self.add_bond(&key, bond, glue)?;
        }
        self.count(self.scene.glue.len(), "seam", "seams");
        Ok(())
    }

    /// Adds a seam, unless all of its pairs are open.
    fn add_bond(
        &mut self,
        key: &Key,
        bond: Bond,
        potential: impl Potential + 'static,
    ) -> Result<(), SceneError> {
        let holds = bond.holds();
        self.bonds.push(holds.then_some(bond));
        if !holds {
            return Ok(());
        }
        self.change(
            |m| Ok(m.with_potential(potential)),
            at::<SimulationError>(key),
        )
    }
}
