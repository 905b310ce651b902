//! Points as seen from a rigid body that moves and turns, and how far their motion is safe.

use crate::ccd::{CLOSE_ENOUGH, CcdOptions, room};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

#[cfg(test)]
mod tests;

/// The motion of a rigid body as time runs from 0 to 1: its origin goes on a straight line, and it turns at a
/// constant rate about an axis through its origin that keeps its direction.
///
/// A point at rest above the middle of a slab that turns by a radian: the slab meets it as it turns.
///
/// ```
/// use isosheet_geometry::nalgebra::{Isometry3, Vector3, vector};
/// use isosheet_geometry::{CcdOptions, RigidPath, Shape};
///
/// let slab = Shape::Cuboid { half: [1.0, 1.0, 0.1] };
/// let path = RigidPath::new(&Isometry3::identity(), Vector3::zeros(), vector![0.0, 1.0, 0.0]);
/// let point = path.course(&vector![0.0, 0.0, 0.15], &Vector3::zeros());
/// let time = path.advance(&CcdOptions::default(), &[point], 1.0, |[p]| {
///     // A box is convex: the plane at the closest point has it on one side.
///     let distance = slab.signed_distance(p);
///     (distance.normal, distance.normal.dot(p) - distance.value)
/// });
/// // Where the point is at the height of the slab: cos(time) = 0.1 / 0.15.
/// let met = (0.1_f64 / 0.15).acos();
/// assert!(time < met && time > 0.9 * met);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct RigidPath {
    origin: Vector3<f64>,
    shift: Vector3<f64>,
    turn: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    /// Columns: the body's axes in space.
    frame: Matrix3<f64>,
}

/// A point on a straight line at a constant speed, relative to a rigid body that [moves](RigidPath).
#[derive(Debug, Clone, Copy)]
pub struct PointCourse {
    /// Offset from the body's origin in space, and its rate.
    offset: Vector3<f64>,
    rate: Vector3<f64>,
    /// Bound on the acceleration in the body's frame.
    bend: f64,
}

impl RigidPath {
    /// From a pose, by a displacement of the origin (metres) and a rotation vector (radians), both in space.
    pub fn new(start: &Isometry3<f64>, shift: Vector3<f64>, turn: Vector3<f64>) -> Self {
        Self {
            origin: start.translation.vector,
            shift,
            turn,
            rotation: start.rotation,
            frame: start.rotation.to_rotation_matrix().into_inner(),
        }
    }

    /// Whether the body moves or turns.
    #[inline]
    pub fn moves(&self) -> bool {
        self.shift != Vector3::zeros() || self.turn != Vector3::zeros()
    }

    /// The pose at a time, from 0 to 1.
    #[inline]
    pub fn pose_at(&self, time: f64) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::from(self.origin + time * self.shift),
            UnitQuaternion::from_scaled_axis(time * self.turn) * self.rotation,
        )
    }

    /// A point on its way from `x` to `x + dx` (metres, in space), as the body sees it.
    ///
    /// In the body's frame the point is at `p = Q^T y` with `y` linear in time and `Q' = [w] Q`, so
    /// `p'' = Q^T (w x (w x y) - 2 w x y')`, which is bounded.
    #[inline]
    pub fn course(&self, x: &Vector3<f64>, dx: &Vector3<f64>) -> PointCourse {
        let (offset, rate) = (x - self.origin, dx - self.shift);
        let w = &self.turn;
        let bend = if *w == Vector3::zeros() {
            0.0
        } else {
            let spin = |y: &Vector3<f64>| w.cross(y).norm();
            2.0 * spin(&rate) + w.norm() * spin(&offset).max(spin(&(offset + rate)))
        };
        PointCourse { offset, rate, bend }
    }

    /// Largest distance of a point of the body at radius `r` from the chord of its path in space,
    /// metres: its acceleration, at most `|w|^2 r`, over eight.
    #[inline]
    pub fn sagitta(&self, r: f64) -> f64 {
        self.turn.norm_squared() * r / 8.0
    }

    /// Takes vectors in space to the body's frame at a time.
    #[inline]
    fn body_axes(&self, time: f64) -> Matrix3<f64> {
        if self.turn == Vector3::zeros() {
            return self.frame.transpose();
        }
        let turned = UnitQuaternion::from_scaled_axis(time * self.turn);
        (turned.to_rotation_matrix().into_inner() * self.frame).transpose()
    }

    /// Positions and velocities of points in the body's frame.
    fn at<const N: usize>(&self, courses: &[PointCourse; N], time: f64) -> [[Vector3<f64>; N]; 2] {
        let axes = self.body_axes(time);
        let y = courses.map(|c| c.offset + time * c.rate);
        [
            y.map(|y| axes * y),
            std::array::from_fn(|i| axes * (courses[i].rate - self.turn.cross(&y[i]))),
        ]
    }

    /// Where a point is at the start, in the body's frame, metres.
    #[inline]
    pub fn now(&self, course: &PointCourse) -> Vector3<f64> {
        self.frame.tr_mul(&course.offset)
    }

    /// A time up to which a primitive that `N` points span stays further from a convex primitive of the body
    /// than the separation of the options; at most `limit` (0 to 1). Zero if it is not further to begin with,
    /// up to round-off.
    ///
    /// `support` gives, for places of the points in the body's frame, a unit vector `n` and a bound
    /// on `n . q` over the body's primitive: a separating plane. The distance of a point from that
    /// plane changes at a rate that is known at one time, and by no more than its bound on the
    /// acceleration allows later; the plane stays clear for as long as that. The sum of such times is
    /// safe whatever the choice of `n`, on the true curved path of a turning body. Without rotation
    /// it is the advance of [`CcdOptions`].
    pub fn advance<const N: usize>(
        &self,
        options: &CcdOptions,
        courses: &[PointCourse; N],
        limit: f64,
        support: impl Fn(&[Vector3<f64>; N]) -> (Vector3<f64>, f64),
    ) -> f64 {
        let far = self.origin.amax() + self.shift.amax();
        let size = courses
            .iter()
            .map(|c| 2.0 * (c.offset.amax() + c.rate.amax()) + far)
            .fold(far, f64::max);
        let margin = options.separation + ROUND_OFF * size;
        let mut time = 0.0;
        let mut least = 0.0;
        for iteration in 0..options.max_iterations {
            let [places, velocities] = self.at(courses, time);
            let (n, plane) = support(&places);
            let clear = places.map(|p| n.dot(&p) - plane - margin);
            let gap = clear.iter().copied().fold(f64::INFINITY, f64::min);
            // Not a number where the closest points coincide.
            if !(gap > 0.0 && plane.is_finite()) {
                return time;
            }
            if iteration == 0 {
                least = options.least_gap(gap);
            } else if gap <= CLOSE_ENOUGH * least {
                return time;
            }
            let mut step = f64::INFINITY;
            for i in 0..N {
                let closing = -n.dot(&velocities[i]);
                let room = room(clear[i], gap, least);
                step = step.min(crossing_time(closing, courses[i].bend, room));
            }
            time += step;
            if time >= limit {
                return limit;
            }
        }
        time
    }
}

impl PointCourse {
    /// Bound on the distance from the place at the start during the motion, in the body's frame, metres:
    /// chord and bulge.
    #[inline]
    pub fn reach(&self, part: &RigidPath) -> f64 {
        if self.bend == 0.0 {
            return self.rate.norm();
        }
        let [[now], _] = part.at(&[*self], 0.0);
        let [[then], _] = part.at(&[*self], 1.0);
        (then - now).norm() + self.bend / 8.0
    }
}

/// Least positive time at which `closing t + bend t^2 / 2 = room`; infinite if never.
fn crossing_time(closing: f64, bend: f64, room: f64) -> f64 {
    if bend > 0.0 {
        let root = (closing * closing + 2.0 * bend * room).sqrt();
        if closing > 0.0 {
            2.0 * room / (closing + root)
        } else {
            (root - closing) / bend
        }
    } else if closing > 0.0 {
        room / closing
    } else {
        f64::INFINITY
    }
}

/// Round-off of a gap relative to the largest coordinate: differences, rotations, products with the
/// direction and the poses that the caller computes, each a few units in the last place.
const ROUND_OFF: f64 = 32.0 * f64::EPSILON;
