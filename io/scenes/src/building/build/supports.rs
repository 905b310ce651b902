//! Supports.

use super::builder::{Builder, at};
use crate::holding::supports::Hold;
use crate::holding::switch::Holder;
use crate::placing::placed::PlacedSheet;
use crate::sheets::sheet::Bending;
use crate::time::pose::MotionKey;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::part::all;
use crate::words::problem::Problem;
use isosheet_dynamics::VertexConstraint;
use isosheet_dynamics::constraint::Line;
use isosheet_mesh::wording::{brief, counted};
use isosheet_mesh::{EdgeId, VertexId};
use nalgebra::{Isometry3, Vector3};
use std::collections::BTreeSet;

impl Builder<'_> {
    pub(super) fn add_supports(&mut self) -> Result<(), SceneError> {
        for (k, support) in self.scene.support.iter().enumerate() {
            let key = Key::root().name("support").entry(k);
            let name = support.sheet.as_deref();
            let mut vertices = self.sheets.vertices(name, &support.at, &key)?;
            let motions = all::<MotionKey>(&support.hold, key.name("hold")).into_iter();
            let moved = motions.map(|(at, _)| at.key).next();
            let moved = moved.unwrap_or_else(|| key.name("hold"));
            if let Some(motion) = support.hold.clamp_motion() {
                let slides = matches!(support.hold, Hold::SlidingClamp { .. });
                vertices.extend(self.clamped_faces(&vertices, slides, &key)?);
                if !self.switches.holds(Holder::Support(k)) {
                    continue;
                }
                let motion = self.led.of_body(&moved, &motion, Isometry3::identity());
                self.clamps.push((k, vertices.clone(), motion));
            }
            if !self.switches.holds(Holder::Support(k)) {
                continue;
            }
            for &v in &vertices {
                self.check_free(v, k, &key)?;
            }
            match &support.hold {
                Hold::SlidingClamp { direction, motion } => {
                    for &v in &vertices {
                        let point = self.held_position(k, v);
                        let line = Line::new(point, *direction).map_err(at(&key))?;
                        let constraint = VertexConstraint::on_curve(v, line);
                        self.constrain(constraint, motion, (k, &moved))?;
                    }
                }
                Hold::Pin | Hold::Clamp => self.change(|m| m.with_pins(&vertices), at(&key))?,
                Hold::MovingPin(motion) | Hold::MovingClamp(motion) => {
                    for &v in &vertices {
                        let place = self.held_position(k, v);
                        let motion = self.led.of_pin(&moved, motion, place);
                        self.change(|m| m.with_moving_pin(v, motion), at(&key))?;
                    }
                }
                Hold::Follow {
                    sequence,
                    vertices: followed,
                } => {
                    let key = key.name("hold.follow");
                    self.follow(&vertices, (sequence, followed), &key)?;
                }
                Hold::Curve { shape, motion } => {
                    for &v in &vertices {
                        let constraint = shape.constrain(v).map_err(at(&key))?;
                        self.constrain(constraint, motion, (k, &moved))?;
                    }
                }
                Hold::Surface {
                    shape,
                    side,
                    motion,
                } => {
                    for &v in &vertices {
                        let constraint = shape.constrain(v, side.as_engine());
                        let constraint = constraint.map_err(at(&key))?;
                        self.constrain(constraint, motion, (k, &moved))?;
                    }
                }
            }
            if support.hold.is_pin() {
                self.origins.pins.extend(vertices.iter().map(|&v| (v, k)));
            }
        }
        self.count(self.scene.support.len(), "support", "supports");
        self.name_hinges();
        Ok(())
    }

    pub(super) fn name_hinges(&mut self) {
        let topology = self.sheets.union.topology();
        for (k, support) in self.scene.support.iter().enumerate() {
            let turns = match &support.hold {
                Hold::Pin => false,
                Hold::MovingPin(motion) => motion.turns(),
                _ => continue,
            };
            let held = |v: &VertexId| self.origins.pins.get(v) == Some(&k);
            let bends = self.sheets.list.iter().any(|sheet| {
                let mut vertices = sheet.part.vertices.clone().map(VertexId::from_index);
                sheet.of.bending() != Bending::None && vertices.any(|v| held(&v))
            });
            let has_edge = || topology.edges().iter().any(|ends| ends.iter().all(held));
            let has_face = || topology.faces().iter().any(|f| f.iter().all(held));
            if bends && !turns && has_edge() && !has_face() {
                self.modelled.push(format!("a hinge at `support[{k}]`"));
            }
        }
    }

    pub(super) fn clamped_faces(
        &self,
        vertices: &[VertexId],
        slides: bool,
        key: &Key,
    ) -> Result<Vec<VertexId>, Problem> {
        let topology = self.sheets.union.topology();
        let held: BTreeSet<VertexId> = vertices.iter().copied().collect();
        let is_held = |e: &EdgeId| topology.edges()[e.index()].iter().all(|v| held.contains(v));
        let edges: Vec<EdgeId> = topology.edge_ids().filter(is_held).collect();
        if edges.is_empty() {
            let start = self.sheets.start.as_chunks::<3>().0;
            let ends = topology.edges().iter();
            let at_it = ends.filter(|ends| ends.iter().any(|v| held.contains(v)));
            let lengths = at_it.map(|&[a, b]| {
                let [a, b] = [a, b].map(|v| Vector3::from(start[v.index()]));
                (b - a).norm()
            });
            return Err(Problem::new(
                key.name("at"),
                format!(
                    "a clamp needs an edge of the mesh between two of its vertices: it has {}, and the nearest neighbour \
                     is {} m away",
                    counted(held.len(), "vertex", "vertices"),
                    brief(lengths.fold(f64::INFINITY, f64::min))
                ),
                "name neighbours along the line that is clamped, or use `pin`",
            ));
        }
        let mut third = BTreeSet::new();
        for PlacedSheet { of, part, .. } in &self.sheets.list {
            let own = edges.iter().filter(|e| part.edges.contains(&e.index()));
            let faces = own.flat_map(|e| topology.edge_faces(*e)).flatten();
            let corners = faces.flat_map(|f| topology.faces()[f.index()]);
            let corners: Vec<VertexId> = corners.filter(|v| !held.contains(v)).collect();
            if of.plate().is_some() || corners.is_empty() {
                continue;
            }
            if slides {
                return Err(Problem::new(
                    key.name("hold"),
                    "a sliding clamp holds the slope of a plate, and this sheet has none",
                    "give the sheet `bending` as a `plate`, or a `material`",
                ));
            }
            third.extend(corners);
        }
        Ok(third.into_iter().collect())
    }

    pub(super) fn check_free(&self, v: VertexId, number: usize, key: &Key) -> Result<(), Problem> {
        let supports = &self.scene.support;
        let constrained = self
            .model()
            .constraints()
            .iter()
            .position(|c| c.vertex() == v);
        let constrained = constrained.map(|c| self.origins.constraints[c]);
        let pins = supports[number].hold.is_pin();
        let other = match self.origins.pins.get(&v) {
            Some(&k) if [k, number].iter().any(|k| !supports[*k].hold.is_at_rest()) => Some(k),
            _ => constrained.filter(|_| pins),
        };
        match other {
            None => Ok(()),
            Some(k) => Err(Problem::new(
                key.name("at"),
                format!("vertex {} is held by `support[{k}]` already", v.index()),
                "let the selections of the two supports have no vertex in common",
            )),
        }
    }

    pub(super) fn constrain(
        &mut self,
        constraint: VertexConstraint,
        motion: &MotionKey,
        (number, moved): (usize, &Key),
    ) -> Result<(), SceneError> {
        let key = Key::root().name("support").entry(number).name("hold");
        let constraint = match *motion != MotionKey::default() || self.led.has(moved) {
            false => constraint,
            true => {
                let motion = self.led.of_body(moved, motion, Isometry3::identity());
                constraint.moving(motion)
            }
        };
        self.change(|m| m.with_constraint(constraint), at(&key))?;
        self.origins.constraints.push(number);
        Ok(())
    }
}
