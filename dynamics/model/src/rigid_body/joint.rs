//! What joints of rigid bodies leave free, and springs and dampers there.

use crate::StepError;
use crate::sheet_model::SheetModel;
use crate::term::{
    Exchange, Formula, ImplicitForce, Iterate, StartProducts, StepStart, Term, Value,
};
use isosheet_materials::HessianSink;
use isosheet_materials::NoDerivative;
use isosheet_materials::hessian::{BlockSink, HessianPart};
use isosheet_materials::potential::{
    At, Force, HessianKind, Potential, Reached, Remembering, Settled,
};
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, VertexId, angle_near};
use isosheet_motion::{Profile, ProfileError};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Why there can be no spring or damper at a joint.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointError {
    /// A stiffness or a coefficient of damping is negative or not finite.
    #[error("the {what} of the joint is {value}", value = given(*value))]
    Number {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The profile at which the spring is at rest cannot be used.
    #[error("the rest of the spring cannot be used: {0}")]
    Rest(#[from] ProfileError),
}

impl Advice for JointError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Number { .. } => Some("give a finite number of at least 0"),
            Self::Rest(error) => error.advice(),
        }
    }
}

/// The coordinate that a joint leaves free: zero where the joint is made.
#[derive(Debug, Clone, PartialEq)]
pub struct JointCoordinate {
    /// The vertex that moves, and those on the axis with weights at the foot of the perpendicular from it.
    vertices: [(VertexId, f64); 3],
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// An angle in the plane of two directions, radians.
    Angle([Vector3<f64>; 2]),
    /// A distance from a point along a direction, metres.
    Distance(Vector3<f64>, Vector3<f64>),
}

impl JointCoordinate {
    /// The angle (radians) by which a body has turned about its first edge, which is [on the
    /// axis](crate::RigidBody::with_edge) of a hinge and is held there, counter-clockwise as seen against the
    /// direction from the first vertex to the second. The vertices are at positions `x` (`3V`, metres).
    pub fn angle(vertices: [VertexId; 4], x: &[f64]) -> Self {
        let [first, second, beside, _] = vertices;
        let [a, b, p] = [first, second, beside].map(|v| point(x, v));
        let along = (b - a) / (b - a).norm_squared();
        let part = along.dot(&(p - a));
        let ahead = (p - (a + part * (b - a))).normalize();
        let aside = (b - a).normalize().cross(&ahead);
        Self {
            vertices: [(beside, 1.0), (first, part - 1.0), (second, -part)],
            kind: Kind::Angle([ahead, aside]),
        }
    }

    /// The distance (metres) by which a vertex has moved along a unit vector.
    pub fn distance(vertex: VertexId, direction: [f64; 3], x: &[f64]) -> Self {
        Self {
            vertices: [(vertex, 1.0), (vertex, 0.0), (vertex, 0.0)],
            kind: Kind::Distance(point(x, vertex), direction.into()),
        }
    }

    /// The arm of the vertex that moves.
    fn arm(&self, x: &[f64]) -> Vector3<f64> {
        self.vertices.iter().map(|(v, w)| *w * point(x, *v)).sum()
    }

    /// Its value at positions `x`; of an angle the one nearest to another.
    fn value(&self, x: &[f64], near: f64) -> f64 {
        let arm = self.arm(x);
        match &self.kind {
            Kind::Angle([ahead, aside]) => angle_near(aside.dot(&arm).atan2(ahead.dot(&arm)), near),
            Kind::Distance(start, direction) => direction.dot(&(arm - start)),
        }
    }

    /// Its derivative by the arm.
    fn gradient(&self, x: &[f64]) -> Vector3<f64> {
        match &self.kind {
            Kind::Angle([ahead, aside]) => {
                let arm = self.arm(x);
                let [a, b] = [ahead.dot(&arm), aside.dot(&arm)];
                (a * aside - b * ahead) / (a * a + b * b)
            }
            Kind::Distance(_, direction) => *direction,
        }
    }

    /// Its second derivative by the arm.
    fn curvature(&self, x: &[f64]) -> Matrix3<f64> {
        match &self.kind {
            Kind::Angle([ahead, aside]) => {
                let arm = self.arm(x);
                let [a, b] = [ahead.dot(&arm), aside.dot(&arm)];
                let mixed = ahead * aside.transpose() + aside * ahead.transpose();
                let pure = ahead * ahead.transpose() - aside * aside.transpose();
                (2.0 * a * b * pure + (b * b - a * a) * mixed) / (a * a + b * b).powi(2)
            }
            Kind::Distance(..) => Matrix3::zeros(),
        }
    }

    /// Adds a force against the coordinate: forces on its vertices, those on the axis included.
    fn add(&self, x: &[f64], force: f64, out: &mut [f64]) {
        let along = force * self.gradient(x);
        for (v, w) in self.vertices {
            add(out, v, &(w * along));
        }
    }
}

fn checked(what: &'static str, value: f64) -> Result<f64, JointError> {
    match value.is_finite() && value >= 0.0 {
        true => Ok(value),
        false => Err(JointError::Number { what, value }),
    }
}

/// A spring at a joint, `V = k (q - q0(t))^2 / 2` with the coordinate `q` that the joint leaves free and a
/// profile `q0`. Angles count turns.
#[derive(Debug, Clone)]
pub struct JointSpring {
    coordinate: JointCoordinate,
    stiffness: f64,
    rest: Profile,
}

impl JointSpring {
    /// A spring of a stiffness, in newton metres per radian or newtons per metre, that is at rest at radians
    /// or metres by a profile.
    ///
    /// # Errors
    /// [`JointError`] naming what cannot be used.
    pub fn new(
        coordinate: JointCoordinate,
        stiffness: f64,
        rest: Profile,
    ) -> Result<Self, JointError> {
        rest.validate()?;
        Ok(Self {
            coordinate,
            stiffness: checked("stiffness", stiffness)?,
            rest,
        })
    }

    fn stretch(&self, at: At<'_>) -> f64 {
        let near = at.memory.first().copied().unwrap_or_default();
        self.coordinate.value(at.x, near) - self.rest.value(at.t)
    }
}

impl Potential for JointSpring {
    fn energy(&self, at: At<'_>) -> f64 {
        0.5 * self.stiffness * self.stretch(at).powi(2)
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let force = self.stiffness * self.stretch(at);
        self.coordinate.add(at.x, force, gradient);
    }

    /// Of the vertex that moves alone: those on the axis are held.
    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        self.add_semidefinite_hessian(at, hessian);
        let curved = self.stiffness * self.stretch(at) * self.coordinate.curvature(at.x);
        hessian.add_vertex(self.coordinate.vertices[0].0, &curved);
    }

    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let g = self.coordinate.gradient(at.x);
        let block = self.stiffness * g * g.transpose();
        hessian.add_vertex(self.coordinate.vertices[0].0, &block);
    }

    /// The derivatives by the vertices on the axis are left out.
    fn hessian_kind(&self) -> HessianKind {
        HessianKind::Partial
    }

    fn is_driven(&self) -> bool {
        !self.rest.is_constant()
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        Some(self)
    }
}

impl Remembering for JointSpring {
    /// The angle that was reached, by which turns are counted.
    fn memory(&self) -> Vec<f64> {
        vec![0.0]
    }

    fn start(&self, state: Reached<'_>, memory: &mut [f64]) {
        memory[0] = self.coordinate.value(state.x, memory[0]);
    }

    /// What is remembered counts turns, and no derivative depends on it.
    fn add_memory_products(
        &self,
        _at: At<'_>,
        _w: &[f64],
        _of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        Ok(())
    }

    fn add_memory_slopes(
        &self,
        _at: At<'_>,
        _scale: f64,
        _of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        Ok(())
    }

    fn pull_back_settling(
        &self,
        _state: Reached<'_>,
        _found: (&[f64], &[f64]),
        of_memory: &mut [f64],
        _of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        of_memory.fill(0.0);
        Ok(())
    }

    fn settle(&self, state: Reached<'_>, memory: &mut [f64]) -> Settled {
        memory[0] = self.coordinate.value(state.x, memory[0]);
        Settled::default()
    }
}

/// A damper at a joint: a force `-c dq/dt` against the coordinate `q` that the joint leaves free.
#[derive(Debug, Clone)]
struct Damper {
    coordinate: JointCoordinate,
    coefficient: f64,
}

impl SheetModel {
    /// Adds a damper at a joint, of a coefficient in newton metres seconds or newton seconds per metre. What
    /// it takes is a part of `StepReport::work`.
    ///
    /// # Errors
    /// [`JointError::Number`].
    pub fn with_joint_damper(
        self,
        coordinate: JointCoordinate,
        coefficient: f64,
    ) -> Result<Self, JointError> {
        Ok(self.with_implicit_force(Damper {
            coordinate,
            coefficient: checked("damping", coefficient)?,
        }))
    }
}

impl Force for Damper {
    fn add_force(&self, _t: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        let rate = self.coordinate.gradient(x).dot(&self.coordinate.arm(v));
        self.coordinate.add(x, -self.coefficient * rate, force);
    }
}

impl ImplicitForce for Damper {
    fn term(&self, free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(DamperStep {
            damper: self.clone(),
            free,
            direction: Vector3::zeros(),
            rest: Vec::new(),
            h: 1.0,
        })
    }
}

/// The incremental potential `c (g . (a - a_y))^2 / 2` of a damper in a step that makes velocities of
/// positions by `x = y + h v`, with the arms `a` and `a_y` at `x` and `y`, and the derivative `g` of the
/// coordinate where the velocities at the start lead to; times `1 / h`.
#[derive(Debug)]
struct DamperStep {
    damper: Damper,
    /// Which vertices are free.
    free: Arc<[bool]>,
    direction: Vector3<f64>,
    /// `y`, `3V`, metres.
    rest: Vec<f64>,
    /// The effective step `h`, seconds.
    h: f64,
}

impl DamperStep {
    /// The rate of the coordinate.
    fn rate(&self, x: &[f64]) -> f64 {
        let arm = |x: &[f64]| self.damper.coordinate.arm(x);
        self.direction.dot(&(arm(x) - arm(&self.rest))) / self.h
    }

    fn add_scaled(&self, force: f64, out: &mut [f64]) {
        for (v, w) in self.damper.coordinate.vertices {
            add(out, v, &(w * force * self.direction));
        }
    }
}

impl Term for DamperStep {
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        self.h = step.h;
        self.rest.clear();
        self.rest.extend_from_slice(step.rest);
        self.direction = self.damper.coordinate.gradient(step.ahead);
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        Value::of(0.5 * self.damper.coefficient * self.h * self.rate(at.x).powi(2))
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        self.add_scaled(scale * self.damper.coefficient * self.rate(at.x), out);
    }

    fn add_hessian(&mut self, _at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        let g = self.direction;
        let block = self.damper.coefficient / self.h * g * g.transpose();
        sink.add_vertex(self.damper.coordinate.vertices[0].0, &block);
    }

    fn add_start_products(
        &mut self,
        step: &StepStart<'_>,
        at: Iterate<'_>,
        w: &[f64],
        scale: f64,
        out: &mut StartProducts,
    ) -> Result<(), NoDerivative> {
        let Damper {
            coordinate,
            coefficient,
        } = &self.damper;
        let g = self.direction;
        let along = coordinate.arm(w);
        let moved = coordinate.arm(at.x) - coordinate.arm(step.rest);
        let size = scale * coefficient / self.h;
        let of_moved = size * g.dot(&along) * g;
        let of_direction = size * (g.dot(&moved) * along + g.dot(&along) * moved);
        let of_ahead = coordinate.curvature(step.ahead) * of_direction;
        let [(moving, _), ..] = coordinate.vertices;
        for (v, part) in coordinate.vertices {
            add(&mut out.rest, v, &(-part * of_moved));
            add(&mut out.ahead, v, &(part * of_ahead));
            add(&mut out.end, v, &(part * of_moved));
        }
        // The Hessian has this.
        let own = size * g.dot(&point(w, moving)) * g;
        add(&mut out.end, moving, &-own);
        Ok(())
    }

    /// The work on the free vertices: by the force at the end, or of a two-step formula by the mean of those
    /// at both ends.
    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        let start = step.state;
        let mut force = vec![0.0; at.x.len()];
        self.add_gradient(at, -1.0, &mut force);
        if step.formula == Formula::TwoStep {
            self.damper
                .add_force(start.t, &start.x, &start.v, &mut force);
            force.iter_mut().for_each(|f| *f *= 0.5);
        }
        let moved = |v: VertexId| point(at.x, v) - point(&start.x, v);
        let vertices = self.damper.coordinate.vertices.iter().map(|(v, _)| *v);
        let mut vertices: Vec<VertexId> = vertices.collect();
        vertices.dedup();
        let free = vertices.into_iter().filter(|v| self.free[v.index()]);
        let work = free.map(|v| point(&force, v).dot(&moved(v))).sum();
        Ok(Exchange::driven(work))
    }
}
