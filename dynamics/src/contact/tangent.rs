//! The derivatives of contact where a step has ended.

use super::surface_points::CarriedSink;
use super::term::{ContactTerm, InStep, at_rest};
use super::{ActiveContact, BarrierPotential, BodyPlace, Contact, CouplingSink};
use super::{DIFFERENCE, SurfacePoints, add_block};
use crate::StepError;
use isosheet_materials::hessian::BlockSink;
use isosheet_model::term::{StartProducts, StepStart, Term};
use nalgebra::{Matrix3, Vector3};

/// Where friction was lagged for the last time in a step.
#[derive(Debug, Clone, Copy)]
pub(crate) enum LagAt<'a> {
    /// At its start, with the bodies where they start.
    Start,
    /// At positions (`3V`, metres), with the bodies at the ends of their motions.
    Places(&'a [f64]),
}

impl ContactTerm {
    /// Puts sheet and bodies where a step ends, at positions `x` (`3V`, metres), with friction as it was
    /// lagged.
    pub(crate) fn arrive(
        &mut self,
        start: &StepStart<'_>,
        lag: LagAt<'_>,
        x: &[f64],
    ) -> Result<(), StepError> {
        self.begin(start)?;
        let geometry = self.geometry.as_mut();
        let step = self.step.as_mut().expect("it has begun");
        step.lagged_at.clone_from(&step.start);
        step.lagged_bodies.clear();
        step.lagged_bodies
            .extend_from_slice(step.state.active.bodies());
        if let LagAt::Places(y) = lag {
            step.go_to_end(geometry, y);
            self.at(y);
            let geometry = self.geometry.as_ref();
            let step = self.step.as_mut().expect("it has begun");
            let places = step.places().to_vec();
            let course = step.velocity.course(&step.start);
            let state = &mut step.state;
            let (barrier, active) = (&state.barrier, &state.active);
            state
                .friction
                .lag(geometry.laws(), barrier, active, course, &places);
            step.lagged_bodies.clear();
            step.lagged_bodies.extend_from_slice(active.bodies());
            step.lagged_at = places;
        }
        let geometry = self.geometry.as_mut();
        let step = self.step.as_mut().expect("it has begun");
        step.go_to_end(geometry, x);
        Ok(())
    }

    /// Adds the second derivatives of barrier and friction at positions `x` by these, those of
    /// the barrier by differences of its gradient.
    pub(crate) fn add_tangent(&mut self, x: &[f64], sink: &mut dyn BlockSink) {
        self.at(x);
        let step = self.step.as_ref().expect("a step has begun");
        let geometry = self.geometry.as_ref();
        let places = step.places();
        let state = &step.state;
        let bodies = state.active.bodies();
        let add = |sink: &mut dyn CouplingSink| {
            let mut moved = places.to_vec();
            for contact in state.active.list() {
                add_barrier(geometry, &state.barrier, contact, &mut moved, bodies, sink);
            }
            state.friction.add_tangent(places, bodies, sink);
        };
        match &step.points {
            None => add(sink),
            Some(points) => CarriedSink::hand_on(points, sink, add),
        }
    }

    /// Adds `scale` times the derivatives of `w . dD/dx` (`3V`) by where friction was lagged.
    pub(crate) fn add_lag_products(&mut self, x: &[f64], w: &[f64], scale: f64, out: &mut [f64]) {
        self.at(x);
        let geometry = self.geometry.as_ref();
        let step = self.step.as_ref().expect("a step has begun");
        let w = SurfacePoints::placed(step.points.as_deref(), w);
        let state = &step.state;
        let mut of_points = vec![0.0; w.len()];
        state.friction.add_lag_products(
            geometry,
            &state.barrier,
            (&step.lagged_at, &step.lagged_bodies),
            (step.places(), state.active.bodies()),
            (&w, scale),
            &mut of_points,
        );
        hand_on(step.points.as_deref(), &of_points, out);
    }

    /// Adds `scale` times the derivatives of `w . dD/dx` (`3V`) by the positions from which slips are
    /// measured.
    pub(crate) fn add_slip_products(
        &mut self,
        x: &[f64],
        w: &[f64],
        scale: f64,
        out: &mut StartProducts,
    ) {
        self.at(x);
        let step = self.step.as_ref().expect("a step has begun");
        let points = step.points.as_deref();
        let w = SurfacePoints::placed(points, w);
        let [mut start, mut rest] = [vec![0.0; w.len()], vec![0.0; w.len()]];
        let (x, bodies) = (step.places(), step.state.active.bodies());
        let friction = &step.state.friction;
        friction.add_start_products(x, bodies, &w, scale, [&mut start, &mut rest]);
        hand_on(points, &start, &mut out.start);
        hand_on(points, &rest, &mut out.rest);
    }
}

impl InStep {
    /// Puts bodies at the ends of their motions, and finds the pairs within reach at positions `x`.
    fn go_to_end(&mut self, geometry: &mut dyn Contact, x: &[f64]) {
        self.progress = 1.0;
        let places = SurfacePoints::placed(self.points.as_deref(), x);
        let motion = at_rest(&self.bodies, 1.0, &places, &self.zeros);
        self.set.update(geometry, motion);
        self.forget();
    }
}

/// Adds what forces on points do to the vertices.
fn hand_on(points: Option<&SurfacePoints>, forces: &[f64], out: &mut [f64]) {
    match points {
        Some(points) => points.add_forces(forces, out),
        None => out.iter_mut().zip(forces).for_each(|(o, f)| *o += f),
    }
}

/// Adds the second derivatives of the barrier of a contact: central differences of its gradient, made
/// symmetric. `moved` are the positions, which come back as they were.
fn add_barrier(
    geometry: &dyn Contact,
    barrier: &BarrierPotential,
    contact: &ActiveContact,
    moved: &mut [f64],
    bodies: &[BodyPlace],
    sink: &mut dyn CouplingSink,
) {
    let corners = contact.corners();
    let step = DIFFERENCE * contact.gap;
    let mut blocks = [[Matrix3::<f64>::zeros(); 4]; 4];
    let mut found = Vec::new();
    for (column, vertex) in corners.iter().enumerate() {
        for axis in 0..3 {
            let i = 3 * *vertex as usize + axis;
            let here = moved[i];
            for side in [1.0, -1.0] {
                moved[i] = here + side * step;
                found.clear();
                geometry.evaluate(&[contact.key], moved, bodies, &mut found);
                let Some(there) = found.first() else { continue };
                there.gradient(barrier, |v, gradient| {
                    let row = corners.iter().position(|own| *own == v);
                    let row = row.expect("a pair keeps its corners");
                    let change: Vector3<f64> = side / (2.0 * step) * gradient;
                    let mut of_axis = blocks[row][column].column_mut(axis);
                    of_axis += change;
                });
            }
            moved[i] = here;
        }
    }
    for i in 0..corners.len() {
        for j in i..corners.len() {
            let block = 0.5 * (blocks[i][j] + blocks[j][i].transpose());
            add_block(corners[i], corners[j], block, sink);
        }
    }
}
