//! Seams.

use super::builder::{Builder, at};
use crate::scene::SeamBend;
use crate::scene::bodies;
use crate::scene::error::SceneError;
use crate::scene::key::Key;
use crate::scene::problem::Problem;
use isosheet_dynamics::{
    Attachment, CreaseSpring, CreaseSprings, Glue, PAPER_GRAVITY, SimulationError,
};
use isosheet_mesh::{EdgeId, VertexId};
use std::collections::BTreeMap;

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
            let closing = seam.closing.as_given();
            if let Some(bend) = &seam.bend {
                let springs = self.seam_springs(bend, &pairs, &key)?;
                let springs = CreaseSprings::across_seams(self.sheets.union.topology(), springs);
                let springs = springs.map_err(at(&key.name("bend")))?;
                self.change(
                    |m| Ok(m.with_potential(springs)),
                    at::<SimulationError>(&key),
                )?;
            }
            let model = self.model();
            let glue = Glue::new(model.topology(), &pairs, stiffness, closing, &self.x);
            let glue = glue.map_err(at(&key))?;
            self.targets.seams.push(glue.clone());
            self.change(|m| Ok(m.with_potential(glue)), at::<SimulationError>(&key))?;
        }
        self.count(self.scene.glue.len(), "seam", "seams");
        Ok(())
    }

    /// The springs across a seam of these pairs, each with the opposite corner of the face on its second side. Seam
    /// and faces beside it are springs in series ([`CreaseSpring::put_in_sheet`]).
    fn seam_springs(
        &self,
        bend: &SeamBend,
        pairs: &[[VertexId; 2]],
        key: &Key,
    ) -> Result<Vec<(CreaseSpring, VertexId)>, Problem> {
        let union = &self.sheets.union;
        let topology = union.topology();
        let partners: BTreeMap<VertexId, VertexId> = pairs.iter().map(|&[a, b]| (a, b)).collect();
        // Radians of bend by a moment on a metre of the edge.
        let compliance = |edge: EdgeId| {
            let [face] = topology
                .edge_faces(edge)
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()[..]
            else {
                return 0.0;
            };
            let sheets = self.sheets.list.iter();
            let mut own = sheets.filter(|sheet| sheet.part.faces.contains(&face.index()));
            let rigidity = own
                .next()
                .map_or(0.0, |sheet| sheet.of.bending().rigidity());
            match rigidity > 0.0 {
                true => {
                    union.face_areas()[face.index()] / (rigidity * union.lengths()[edge.index()])
                }
                false => 0.0,
            }
        };
        let spring = |edge: EdgeId| {
            let ends = topology.edges()[edge.index()].map(|v| partners.get(&v).copied());
            let other = topology.find_edge(ends[0]?, ends[1]?)?;
            let [opposite] = topology
                .opposite_vertices(other)
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()[..]
            else {
                return None;
            };
            if !topology.is_boundary_edge(edge) {
                return None;
            }
            let beside = compliance(edge) + compliance(other);
            let stiffness = bend.stiffness / (1.0 + bend.stiffness * beside);
            let spring = CreaseSpring {
                edge,
                stiffness: stiffness * union.lengths()[edge.index()],
                rest: bend.angle.to_radians().into(),
                yields: None,
            };
            Some((spring, opposite))
        };
        let springs: Vec<_> = topology.edge_ids().filter_map(spring).collect();
        if springs.is_empty() {
            return Err(Problem::new(
                key.name("bend"),
                "no edge of the rim of one side of the seam is glued to one of the other side",
                "glue vertices that follow one another on the rims of both sides, or leave the key out",
            ));
        }
        Ok(springs)
    }
}
