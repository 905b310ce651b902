//! Seams.

use super::builder::{Builder, at};
use crate::SeamBend;
use crate::bodies::body;
use crate::holding::bond::Bond;
use crate::holding::switch::Holder;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_dynamics::{
    Attachment, CreaseSpring, CreaseSprings, Glue, PAPER_GRAVITY, Potential, Profile,
    SimulationError,
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
        let list = Key::root().name("glue");
        for (k, seam) in self.scene.glue.iter().enumerate() {
            let key = list.entry(k);
            let of = Holder::Glue(k);
            let model = self.model();
            let (mass, length) = (model.mass().total(), self.sheets.union.mean_length());
            let stiffness = seam.stiffness(mass, gravity, rigidity, length);
            let number = seam
                .body()
                .and_then(|name| body::number_of(&self.scene.body, name));
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
            if let Some(bend) = &seam.bend {
                let springs = self.seam_springs(bend, &holding, &key)?;
                let springs = CreaseSprings::across_seams(self.sheets.union.topology(), springs);
                let springs = springs.map_err(at(&key.name("bend")))?;
                self.change(
                    |m| Ok(m.with_potential(springs)),
                    at::<SimulationError>(&key),
                )?;
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

    /// The springs across a seam of these pairs, each with the opposite corner of the face on its second
    /// side. Seam and faces beside it are springs in series ([`CreaseSpring::put_in_sheet`]).
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
                in_series: None,
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
