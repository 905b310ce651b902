//! The derivatives of contact where a step has ended.

use super::surface_points::CarriedSink;
use super::term::{ContactTerm, InStep, at_rest, span};
use super::{ActiveContact, BarrierPotential, BodyPlace, Contact, ContactKey, CouplingSink};
use super::{DIFFERENCE, SurfacePoints, add_block};
use isosheet_materials::hessian::BlockSink;
use isosheet_model::term::{StartProducts, StepStart};
use nalgebra::{Matrix3, Vector3};

/// Where friction was lagged for the last time in a step.
#[derive(Debug, Clone, Copy)]
pub(crate) enum LagAt<'a> {
    /// At its start, with the bodies where they start.
    Start,
    /// At positions (`3V`, metres), with the bodies at the ends of their motions.
    Places(&'a [f64]),
}

/// The pairs within reach where friction of a step was lagged, and where the step ends.
#[derive(Debug, Clone, Default)]
pub struct ReachedPairs {
    lag: Vec<ContactKey>,
    end: Vec<ContactKey>,
}

impl ContactTerm {
    /// Puts sheet and bodies where a step ends, at positions `x` (`3V`, metres), with friction as it was
    /// lagged. The pairs within reach are searched for where none are given.
    pub(crate) fn arrive(
        &mut self,
        start: &StepStart<'_>,
        lag: LagAt<'_>,
        x: &[f64],
        pairs: Option<&ReachedPairs>,
    ) {
        let geometry = self.geometry.as_mut();
        if self.step.is_none() {
            self.step = Some(InStep::new(geometry, self.barrier, start));
        }
        let step = self.step.as_mut().expect("it has just been made");
        step.place_start(geometry, start);
        let (progress, y) = match lag {
            LagAt::Start => (step.bodies.first_progress(), &start.state.x[..]),
            LagAt::Places(y) => (1.0, y),
        };
        step.go_to(geometry, progress, y, pairs.map(|pairs| &pairs.lag[..]));
        self.at(y);
        let geometry = self.geometry.as_mut();
        let step = self.step.as_mut().expect("it has begun");
        step.lag_here(geometry);
        step.go_to(geometry, 1.0, x, pairs.map(|pairs| &pairs.end[..]));
    }

    /// The pairs within reach where the step that has arrived was lagged, and where it ends.
    pub(crate) fn reached_pairs(&self) -> ReachedPairs {
        let step = self.step.as_ref();
        step.map_or_else(ReachedPairs::default, |step| ReachedPairs {
            lag: step.lagged_pairs.clone(),
            end: step.set.pairs().to_vec(),
        })
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
    /// Puts the start of slips, and the motions of the bodies, to those of a step.
    fn place_start(&mut self, geometry: &dyn Contact, start: &StepStart<'_>) {
        match &self.points {
            None => self.start.copy_from_slice(&start.state.x),
            Some(points) => points.place(&start.state.x, &mut self.start),
        }
        self.bodies.update(geometry, span(start));
        let points = self.points.clone();
        self.velocity
            .update(geometry.laws(), points.as_deref(), start);
    }

    /// Puts bodies at a progress of their motions, and takes the pairs within reach at positions `x`.
    fn go_to(
        &mut self,
        geometry: &mut dyn Contact,
        progress: f64,
        x: &[f64],
        pairs: Option<&[ContactKey]>,
    ) {
        self.progress = progress;
        match pairs {
            Some(pairs) => self.set.become_pairs(&self.bodies, pairs),
            None => {
                let places = SurfacePoints::placed(self.points.as_deref(), x);
                let motion = at_rest(&self.bodies, progress, &places, &self.zeros);
                self.set.update(geometry, motion);
            }
        }
        self.forget();
    }

    /// Lags friction where the contacts were evaluated.
    fn lag_here(&mut self, geometry: &dyn Contact) {
        let places = self.places().to_vec();
        let course = self.velocity.course(&self.start);
        let state = &mut self.state;
        let (barrier, active) = (&state.barrier, &state.active);
        let laws = geometry.laws();
        state.friction.lag(laws, barrier, active, course, &places);
        self.lagged_bodies.clear();
        self.lagged_bodies.extend_from_slice(active.bodies());
        self.lagged_pairs.clear();
        self.lagged_pairs.extend_from_slice(self.set.pairs());
        self.lagged_at = places;
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
