//! Gaps between the sheet and bodies, linearised at a state.

use super::driver::Drive;
use crate::State;
use crate::contact::{ContactState, ContactTerm, CouplingSink, StepSpan, add_at, add_weighted};
use isosheet_materials::vectors::point;
use isosheet_mesh::VertexId;
use isosheet_model::Driver;
use nalgebra::Vector3;

/// A contact of the sheet with a body: `g(x) = offset + n . sum_i w_i x_i`.
struct Gap {
    body: usize,
    /// The vertex with the largest weight.
    vertex: VertexId,
    vertices: Vec<u32>,
    weights: Vec<f64>,
    normal: Vector3<f64>,
    /// Metres.
    offset: f64,
    /// By how much the motion of the body closes the gap, metres.
    closed_by_body: f64,
}

impl Gap {
    fn at(&self, x: &[f64]) -> f64 {
        let parts = self.vertices.iter().zip(&self.weights);
        let along = parts.map(|(v, w)| w * self.normal.dot(&point(x, VertexId(*v))));
        self.offset + along.sum::<f64>()
    }
}

/// The gaps that the contacts at a state have with the bodies in their places at a later time.
#[derive(Default)]
pub(super) struct Gaps {
    list: Vec<Gap>,
    /// Kilograms, as penalties over a squared second are.
    stiffness: f64,
    /// The bodies that move.
    moving: Vec<usize>,
}

impl Gaps {
    /// Of the contacts at a state, at time `t` of the bodies, with a stiffness in kilograms.
    pub(super) fn of(
        term: &mut ContactTerm,
        contacts: &ContactState,
        state: &State,
        t: f64,
        stiffness: f64,
    ) -> Self {
        let span = StepSpan {
            t0: state.t,
            h: t - state.t,
        };
        let points = term.shared_points();
        let motions = term.motions(span);
        let mut list = Vec::new();
        for contact in contacts.active.list() {
            let Some(body) = contact.key.body else {
                continue;
            };
            let body = body as usize;
            let shift = motions.list()[body].surface.displacement(&contact.closest);
            let stencil = contact.corners().iter().copied().zip(contact.weights);
            let (vertices, weights) = match &points {
                None => stencil.unzip(),
                Some(points) => points.carried_weights(stencil).into_iter().unzip(),
            };
            let mut gap = Gap {
                body,
                vertex: contact.heaviest_vertex(points.as_deref()),
                vertices,
                weights,
                normal: contact.normal,
                offset: 0.0,
                closed_by_body: shift.dot(&contact.normal),
            };
            gap.offset = contact.gap - gap.at(&state.x) - gap.closed_by_body;
            list.push(gap);
        }
        let moving = motions.list().iter().enumerate();
        Self {
            list,
            stiffness,
            moving: moving
                .filter(|(_, motion)| motion.surface.moves())
                .map(|(body, _)| body)
                .collect(),
        }
    }

    /// The negative gaps, metres.
    fn closed<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = (&'a Gap, f64)> {
        let gaps = self.list.iter().map(move |gap| (gap, gap.at(x)));
        gaps.filter(|(_, value)| *value < 0.0)
    }

    pub(super) fn energy(&self, x: &[f64]) -> f64 {
        let squares = self.closed(x).map(|(_, value)| value * value);
        0.5 * self.stiffness * squares.sum::<f64>()
    }

    pub(super) fn largest_violation(&self, x: &[f64]) -> f64 {
        self.closed(x)
            .fold(0.0, |most, (_, value)| most.max(-value))
    }

    pub(super) fn add_gradient(&self, x: &[f64], gradient: &mut [f64]) {
        for (gap, value) in self.closed(x) {
            let force = self.stiffness * value * gap.normal;
            for (v, w) in gap.vertices.iter().zip(&gap.weights) {
                add_at(gradient, *v, *w * force);
            }
        }
    }

    pub(super) fn add_hessian(&self, x: &[f64], sink: &mut dyn CouplingSink) {
        for (gap, _) in self.closed(x) {
            let block = self.stiffness * gap.normal * gap.normal.transpose();
            add_weighted(&gap.vertices, &gap.weights, &block, sink);
        }
    }

    /// What the bodies that move do.
    pub(super) fn drives(&self, x: &[f64]) -> impl Iterator<Item = Drive> {
        self.moving.iter().map(|&body| {
            let mut drive = Drive {
                by: Driver::Body(body),
                force: 0.0,
                work: 0.0,
                displacement: 0.0,
            };
            for (gap, value) in self.closed(x).filter(|(gap, _)| gap.body == body) {
                let force = -self.stiffness * value;
                drive.force += force;
                drive.work += force * gap.closed_by_body;
                drive.displacement = drive.displacement.max(gap.closed_by_body);
            }
            drive
        })
    }

    /// The vertices that are pressed by a body, or by any, those pressed most first; and all bodies that
    /// press the sheet.
    pub(super) fn pressed(&self, x: &[f64], by: Option<usize>) -> (Vec<VertexId>, Vec<usize>) {
        let mut closed: Vec<_> = self.closed(x).collect();
        closed.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (mut vertices, mut bodies) = (Vec::new(), Vec::new());
        for (gap, _) in closed {
            if !bodies.contains(&gap.body) {
                bodies.push(gap.body);
            }
            if by.is_none_or(|body| body == gap.body) && !vertices.contains(&gap.vertex) {
                vertices.push(gap.vertex);
            }
        }
        bodies.sort_unstable();
        (vertices, bodies)
    }
}
