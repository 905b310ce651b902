//! Bodies in prescribed motion, as contact sees them over a step.

use super::{BodyMotionError, Contact};
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// The span of time of a step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StepSpan {
    /// Its start, seconds.
    pub t0: f64,
    /// Its duration, seconds; may be zero.
    pub h: f64,
}

impl StepSpan {
    /// From the first time to the last, seconds.
    pub(crate) fn between([t0, end]: [f64; 2]) -> Self {
        Self { t0, h: end - t0 }
    }
}

/// The motion of a frame over a step: its origin on a straight line at constant speed, its orientation about
/// a fixed axis at a constant rate, from the pose at the start to that at the end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StepMotion {
    start: Isometry3<f64>,
    end: Isometry3<f64>,
    /// Displacement of the origin, metres.
    shift: Vector3<f64>,
    /// Rotation vector in space, radians.
    turn: Vector3<f64>,
}

impl StepMotion {
    /// From one pose to another, the shorter way round.
    pub fn new(start: Isometry3<f64>, end: Isometry3<f64>) -> Self {
        let turn = if start.rotation == end.rotation {
            Vector3::zeros()
        } else {
            start.rotation.rotation_to(&end.rotation).scaled_axis()
        };
        Self {
            start,
            end,
            shift: end.translation.vector - start.translation.vector,
            turn,
        }
    }

    /// Whether the two poses differ.
    pub fn moves(&self) -> bool {
        self.start != self.end
    }

    /// The pose at the start.
    pub fn start(&self) -> &Isometry3<f64> {
        &self.start
    }

    /// The pose at the end.
    pub fn end(&self) -> &Isometry3<f64> {
        &self.end
    }

    /// Displacement of the origin, metres.
    pub fn shift(&self) -> &Vector3<f64> {
        &self.shift
    }

    /// Rotation vector in space, radians.
    pub fn turn(&self) -> &Vector3<f64> {
        &self.turn
    }

    /// Displacement of what is at a place in space (metres), to first order, metres.
    pub(crate) fn displacement(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.shift + self.turn.cross(&(place - self.start.translation.vector))
    }

    /// The pose at progress `s`, from 0 to 1.
    pub fn pose(&self, s: f64) -> Isometry3<f64> {
        if s >= 1.0 {
            return self.end;
        }
        Isometry3::from_parts(
            Translation3::from(self.start.translation.vector + s * self.shift),
            UnitQuaternion::from_scaled_axis(s * self.turn) * self.start.rotation,
        )
    }
}

/// The motion of a body over a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BodyMotion {
    /// Motion of the material, with which friction goes.
    pub material: StepMotion,
    /// Motion of the surface: that of the material but for the spin of a round body about its own axis,
    /// which does not move the surface.
    pub surface: StepMotion,
}

/// The motions of all bodies over a step.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMotions {
    span: StepSpan,
    list: Vec<BodyMotion>,
}

impl BodyMotions {
    /// The motions over a span of time.
    pub fn over(contact: &dyn Contact, span: StepSpan) -> Self {
        let mut motions = Self {
            span,
            list: Vec::new(),
        };
        motions.update(contact, span);
        motions
    }

    /// Becomes those over another span; reuses memory.
    pub fn update(&mut self, contact: &dyn Contact, span: StepSpan) {
        self.span = span;
        self.list.clear();
        contact.body_motions(span, &mut self.list);
    }

    /// Refuses poses that are not finite, which the function of a motion can return.
    ///
    /// # Errors
    /// [`BodyMotionError`] with the first body, time and value that is not finite.
    pub fn check(&self) -> Result<(), BodyMotionError> {
        let StepSpan { t0, h } = self.span;
        for (body, BodyMotion { material, surface }) in self.list.iter().enumerate() {
            let ends = [
                (t0, material.start, surface.start),
                (t0 + h, material.end, surface.end),
            ];
            for (t, material, surface) in ends {
                let found = non_finite(&material).or_else(|| non_finite(&surface));
                if let Some(value) = found {
                    return Err(BodyMotionError { body, value, t });
                }
            }
        }
        Ok(())
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.span = other.span;
        self.list.clone_from(&other.list);
    }

    /// The span of time.
    pub fn span(&self) -> StepSpan {
        self.span
    }

    /// The motions, in the order of the bodies.
    pub fn list(&self) -> &[BodyMotion] {
        &self.list
    }

    /// Whether a body moves, if only by spinning.
    pub(crate) fn any_moves(&self) -> bool {
        self.list.iter().any(|m| m.material.moves())
    }

    /// The progress at which a step starts: 0, or 1 if no body moves.
    pub fn first_progress(&self) -> f64 {
        if self.any_moves() { 0.0 } else { 1.0 }
    }

    /// The time at progress `s`, seconds.
    pub fn time(&self, s: f64) -> f64 {
        self.span.t0 + s * self.span.h
    }
}

/// The progress after a fraction of what is left of a step's motions after progress `s`:
/// `s + fraction (1 - s)`, and 1 exactly for `fraction = 1`.
pub(crate) fn advanced(s: f64, fraction: f64) -> f64 {
    if fraction >= 1.0 || s >= 1.0 {
        1.0
    } else {
        s + fraction * (1.0 - s)
    }
}

/// A body in its place at a progress of its motion over a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BodyPlace {
    motion: BodyMotion,
    /// Pose of the material.
    material: Isometry3<f64>,
    /// Pose of the surface.
    origin: Vector3<f64>,
    frame: Matrix3<f64>,
}

impl BodyPlace {
    /// The place at progress `s`.
    pub fn at(motion: &BodyMotion, s: f64) -> Self {
        let surface = motion.surface.pose(s);
        Self {
            motion: *motion,
            material: motion.material.pose(s),
            origin: surface.translation.vector,
            frame: surface.rotation.to_rotation_matrix().into_inner(),
        }
    }

    /// Whether the body moves in this step, if only by spinning.
    pub fn moves(&self) -> bool {
        self.motion.material.moves()
    }

    /// Origin of the body's frame, metres.
    pub fn origin(&self) -> &Vector3<f64> {
        &self.origin
    }

    /// The axes of the surface's frame in space, as columns.
    pub fn frame(&self) -> &Matrix3<f64> {
        &self.frame
    }

    /// A place in space (metres) in the frame of the surface.
    pub fn to_local(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.frame.tr_mul(&(place - self.origin))
    }

    /// The place in space (metres) of a point in the frame of the surface.
    pub fn to_space(&self, local: &Vector3<f64>) -> Vector3<f64> {
        self.frame * local + self.origin
    }

    /// Velocity of the surface at a place in space times the duration of the step, metres.
    pub(crate) fn step_velocity(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let surface = &self.motion.surface;
        surface.shift + surface.turn.cross(&(place - self.origin))
    }

    /// Angular velocity of the surface times the duration of the step, radians.
    pub(crate) fn step_turn(&self) -> Vector3<f64> {
        self.motion.surface.turn
    }

    /// The material point at a place in space, in the frame of the material, metres.
    pub(crate) fn material_point(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let point = Point3::from(*place);
        self.material.inverse_transform_point(&point).coords
    }

    /// The place in space of a material point, metres.
    pub(crate) fn material_place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        moved(&self.material, point)
    }

    /// The place in space of a material point at the start of the step, metres.
    pub(crate) fn material_start(&self, point: &Vector3<f64>) -> Vector3<f64> {
        moved(&self.motion.material.start, point)
    }

    /// The place in space of a material point at the end of the step, metres.
    pub(crate) fn material_end(&self, point: &Vector3<f64>) -> Vector3<f64> {
        moved(&self.motion.material.end, point)
    }
}

/// The first component of a pose that is not finite.
fn non_finite(pose: &Isometry3<f64>) -> Option<f64> {
    let (place, turn) = (&pose.translation.vector, pose.rotation.coords);
    place.iter().chain(&turn).copied().find(|c| !c.is_finite())
}

fn moved(pose: &Isometry3<f64>, local: &Vector3<f64>) -> Vector3<f64> {
    (pose * Point3::from(*local)).coords
}
