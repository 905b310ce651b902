//! Pins and vertex constraints of a model, and their motions.

use super::moving_pin::MovingPin;
use super::{ModelError, PINNED, SheetModel};
use crate::State;
use crate::constraint::{ConstrainedVertex, VertexConstraint};
use crate::report::support::Support;
use isosheet_materials::vectors::point;
use isosheet_mesh::VertexId;
use isosheet_motion::PointMotion;
use nalgebra::Vector3;

impl SheetModel {
    /// Pins vertices where they are: they lose their unknowns (the single external point
    /// constraint of Sec. 3.3 is one such vertex).
    ///
    /// # Errors
    /// [`ModelError::NoSuchVertex`].
    pub fn with_pins(mut self, pins: &[VertexId]) -> Result<Self, ModelError> {
        for &v in pins {
            match self.free_index.get_mut(v.index()) {
                Some(i) => *i = PINNED,
                None => {
                    return Err(ModelError::NoSuchVertex {
                        vertex: v,
                        vertex_count: self.free_index.len(),
                    });
                }
            }
        }
        self.number_free();
        Ok(self)
    }

    /// Pins vertices of the sheet where they are.
    pub fn fix(&mut self, vertices: &[VertexId]) {
        for v in vertices {
            self.free_index[v.index()] = PINNED;
        }
        self.number_free();
    }

    /// Sets the velocities of some vertices to zero.
    pub fn clear_velocities(&self, vertices: &[VertexId], v: &mut [f64]) {
        for i in vertices {
            v[3 * i.index()..3 * i.index() + 3].fill(0.0);
        }
    }

    fn number_free(&mut self) {
        let mut next = 0;
        for i in self.free_index.iter_mut().filter(|i| **i != PINNED) {
            *i = next;
            next += 1;
        }
        self.free_count = next as usize;
    }

    /// Pins a vertex to a prescribed motion: a `PointProfile`, or a function of time
    /// (seconds) that returns its position (metres).
    ///
    /// The start state has to have it there. Like any pin it has no unknowns.
    ///
    /// ```
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    /// use isosheet_model::SheetModel;
    /// use isosheet_motion::{PointProfile, Profile};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 0.2)?;
    /// let shake = PointProfile {
    ///     offset: sheet.position(VertexId(0)),
    ///     z: Profile::Sine { mean: 0.0, amplitude: 0.01, frequency: 2.0, phase: 0.0 },
    ///     ..PointProfile::default()
    /// };
    /// let [x, y, z] = sheet.position(VertexId(24));
    /// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
    ///     .with_moving_pin(VertexId(0), shake)?
    ///     .with_moving_pin(VertexId(24), move |t: f64| [x, y, z + 0.01 * t.powi(3)])?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NoSuchVertex`], [`ModelError::Motion`].
    pub fn with_moving_pin(
        self,
        v: VertexId,
        motion: impl Into<PointMotion>,
    ) -> Result<Self, ModelError> {
        let motion = motion.into();
        motion
            .validate()
            .map_err(|source| ModelError::Motion { vertex: v, source })?;
        let mut model = self.with_pins(&[v])?;
        let vertex = v.index();
        model.moving_pins.retain(|pin| pin.vertex != vertex);
        model.moving_pins.push(MovingPin { vertex, motion });
        Ok(model)
    }

    /// Constrains a vertex to a curve or surface. The start state has to have it there.
    ///
    /// # Errors
    /// [`ModelError::NoSuchVertex`], [`ModelError::Motion`].
    pub fn with_constraint(mut self, constraint: VertexConstraint) -> Result<Self, ModelError> {
        let vertex = constraint.vertex();
        if vertex.index() >= self.free_index.len() {
            return Err(ModelError::NoSuchVertex {
                vertex,
                vertex_count: self.free_index.len(),
            });
        }
        constraint
            .validate_motion()
            .map_err(|source| ModelError::Motion { vertex, source })?;
        self.constraints.push(constraint);
        Ok(self)
    }

    /// The vertices on curves and surfaces; [`Support::Constraint`](crate::Support::Constraint) names one of
    /// them by its index.
    pub fn constraints(&self) -> &[VertexConstraint] {
        &self.constraints
    }

    /// Masses and lengths at the vertices of the constraints, one for each constraint.
    pub fn constrained_vertices(&self) -> Vec<ConstrainedVertex> {
        let vertices = self.constraints.iter().map(VertexConstraint::vertex);
        let scales = vertices.map(|vertex| ConstrainedVertex {
            vertex,
            mass: if self.is_pinned(vertex) {
                0.0
            } else {
                self.mass.vertex[vertex.index()]
            },
            length: self.shortest_edge(vertex.index()),
        });
        scales.collect()
    }

    /// Largest distance by which a vertex constraint is broken, metres; `None` if there is none.
    pub fn largest_violation(&self, t: f64, x: &[f64]) -> Option<f64> {
        self.constraints
            .iter()
            .map(|c| c.violation(t, &point(x, c.vertex())))
            // `max` would pass over a value that is not a number.
            .reduce(|m, v| if v.is_nan() { v } else { m.max(v) })
    }

    /// The first support whose motion is not finite at time `t`, and the value.
    pub fn find_bad_motion(&self, t: f64) -> Option<(Support, f64)> {
        let pins = self.moving_pins.iter().flat_map(|pin| {
            let at = pin.motion.position(t);
            at.map(|c| (Support::Pin(VertexId(pin.vertex as u32)), c))
        });
        let constraints = self.constraints.iter().enumerate().flat_map(|(index, c)| {
            let vertex = c.vertex();
            c.bad_pose(t)
                .map(|value| (Support::Constraint { index, vertex }, value))
        });
        pins.chain(constraints).find(|(_, c)| !c.is_finite())
    }

    /// Whether pins or vertex constraints move.
    pub fn has_drives(&self) -> bool {
        !self.moving_pins.is_empty() || self.constraints.iter().any(VertexConstraint::moves)
    }

    /// Whether anything holds the sheet.
    pub fn has_supports(&self) -> bool {
        self.free_count < self.free_index.len() || !self.constraints.is_empty()
    }

    /// Sets the velocities of pins in prescribed motion at time `t`; of functions by differences over a part
    /// of the time `span`.
    pub fn set_pin_velocities(&self, t: f64, span: f64, v: &mut [f64]) {
        for pin in &self.moving_pins {
            let rate = pin.motion.velocity(t, span);
            v[3 * pin.vertex..3 * pin.vertex + 3].copy_from_slice(rate.as_slice());
        }
    }

    /// Rates `dc/dt` of the vertex constraints at fixed positions, metres per second.
    pub fn constraint_rates(&self, t: f64, span: f64, x: &[f64]) -> Vec<Vector3<f64>> {
        let constraints = self.constraints.iter();
        constraints
            .map(|c| c.rate(t, span, &point(x, c.vertex())))
            .collect()
    }

    /// Moves the pins in prescribed motion to where they are at time `t`.
    pub fn place_pins(&self, t: f64, x: &mut [f64]) {
        for pin in &self.moving_pins {
            x[3 * pin.vertex..3 * pin.vertex + 3].copy_from_slice(&pin.motion.position(t));
        }
    }

    /// Work of non-conservative forces and air at the pins in motion between two states, joules, by the
    /// trapezoidal rule: a part of what the pins do passes on to these forces.
    pub fn applied_work_at_pins(&self, before: &State, after: &State) -> f64 {
        if !self.has_applied_forces() || self.moving_pins.is_empty() {
            return 0.0;
        }
        let mut force = vec![0.0; before.x.len()];
        for State { t, x, v } in [before, after] {
            self.add_applied_force(*t, x, v, &mut force);
        }
        let coordinates = self.moving_pins().flat_map(|v| 3 * v..3 * v + 3);
        let work = coordinates.map(|i| 0.5 * force[i] * (after.x[i] - before.x[i]));
        work.sum()
    }

    /// The motion of a pin, if one is prescribed.
    pub fn pin_motion(&self, v: VertexId) -> Option<&PointMotion> {
        let pin = self.moving_pins.iter().find(|p| p.vertex == v.index())?;
        Some(&pin.motion)
    }

    /// The vertices in prescribed motion.
    pub fn moving_pins(&self) -> impl Iterator<Item = usize> + '_ {
        self.moving_pins.iter().map(|pin| pin.vertex)
    }

    /// Whether the vertex is pinned.
    pub fn is_pinned(&self, v: VertexId) -> bool {
        self.free_index[v.index()] == PINNED
    }

    /// The pinned vertices.
    pub fn pins(&self) -> Vec<VertexId> {
        self.topology
            .vertex_ids()
            .filter(|&v| self.is_pinned(v))
            .collect()
    }

    /// Number of vertices that are pinned or have a constraint.
    pub fn supported_vertex_count(&self) -> usize {
        let constrained = |k: usize| self.constraints[k].vertex();
        let is_first = |k: &usize| (0..*k).all(|earlier| constrained(earlier) != constrained(*k));
        let others = (0..self.constraints.len()).filter(is_first);
        let others = others.filter(|k| !self.is_pinned(constrained(*k)));
        self.free_index.len() - self.free_count + others.count()
    }
}
