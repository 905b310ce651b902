//! Joints of rigid bodies, and what acts on them.

use super::builder::{Builder, at};
use crate::bodies::guides::Guide;
use crate::placing::placed_bodies::JointMotion;
use crate::words::error::SceneError;
use isosheet_dynamics::constraint::{Line, Plane, Side};
use isosheet_dynamics::{JointSpring, SimulationError, VertexConstraint};
use nalgebra::Vector3;

impl Builder<'_> {
    pub(super) fn add_guides(&mut self) -> Result<(), SceneError> {
        for k in 0..self.bodies.list.len() {
            let body = &self.bodies.list[k];
            let Some(guide) = &body.of.guide else {
                continue;
            };
            let (key, vertices) = (body.key.name("guide").name(guide.name()), body.vertices());
            let motion = body.guided_motion(guide, &self.x)?;
            self.origins.guides.extend(vertices.map(|v| (v, k)));
            match guide {
                Guide::Ball { .. } => self.change(|m| m.with_pins(&vertices[..1]), at(&key))?,
                Guide::Hinge { .. } => self.change(|m| m.with_pins(&vertices[..2]), at(&key))?,
                Guide::Slider { direction, .. } => {
                    for v in [vertices[0], vertices[1]] {
                        let line = Line::new(self.position(v), *direction).map_err(at(&key))?;
                        let constraint = VertexConstraint::on_curve(v, line);
                        self.change(|m| m.with_constraint(constraint), at(&key))?;
                    }
                    // The third corner is beside the line of the other two.
                    let [a, b, c] = [0, 1, 2].map(|i| Vector3::from(self.position(vertices[i])));
                    let normal = (b - a).cross(&(c - a));
                    let plane = Plane::new(c.into(), normal.into()).map_err(at(&key))?;
                    let constraint = VertexConstraint::on_surface(vertices[2], plane, Side::On);
                    self.change(|m| m.with_constraint(constraint), at(&key))?;
                }
            }
            if let Some(JointMotion {
                coordinate,
                stiffness,
                rest,
                damping,
            }) = motion
            {
                if stiffness > 0.0 {
                    let spring = JointSpring::new(coordinate.clone(), stiffness, rest);
                    let spring = spring.map_err(at(&key))?;
                    self.change(
                        |m| Ok(m.with_potential(spring)),
                        at::<SimulationError>(&key),
                    )?;
                }
                if damping > 0.0 {
                    self.change(|m| m.with_joint_damper(coordinate, damping), at(&key))?;
                }
            }
        }
        let guided = self
            .bodies
            .list
            .iter()
            .filter(|body| body.of.guide.is_some());
        self.count(guided.count(), "guide of a body", "guides of bodies");
        Ok(())
    }

    pub(super) fn add_body_forces(&mut self) -> Result<(), SceneError> {
        let (mut forces, mut torques) = (0, 0);
        for k in 0..self.bodies.list.len() {
            let of = self.bodies.list[k].of;
            for (i, force) in of.force.iter().enumerate() {
                let (key, force) = self.bodies.list[k].force(i, force)?;
                self.change(|m| Ok(m.with_force(force)), at::<SimulationError>(&key))?;
            }
            for (i, torque) in of.torque.iter().enumerate() {
                let (key, torque) = self.bodies.list[k].torque(i, torque)?;
                self.change(|m| Ok(m.with_force(torque)), at::<SimulationError>(&key))?;
            }
            forces += of.force.len();
            torques += of.torque.len();
        }
        self.count(forces, "force on a body", "forces on bodies");
        self.count(torques, "torque on a body", "torques on bodies");
        Ok(())
    }
}
