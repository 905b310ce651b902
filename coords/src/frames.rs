//! Reference frames in which angles are measured: the coordinates of the placement rules.
//!
//! A [`SphericalFrame`] gives an edge from a known vertex its two spherical coordinates (rule *h*),
//! an [`EdgeFrame`] gives a triangle on a known edge its rotation angle (rule *g*). Both define
//! functions of the positions of the vertices they involve; gradients are exact and so is their
//! rate along a velocity.

use crate::placement_error::PlacementError;
use crate::vec3::{
    Scalar, Vec3, add, any_perpendicular, axpy, cross, dot, lift, neg, norm, scale, sub,
};
use num_dual::{Dual64, DualNum};

/// Below this value of `1 + a . b` two unit vectors count as antiparallel.
///
/// The aligning rotation turns about `a x b`, whose length is about `sqrt(2 (1 + a . b))`; at 1e-12
/// the axis still has nine correct digits; below that it is dominated by rounding.
const ANTIPARALLEL: f64 = 1e-12;

/// Relative size below which a length that must not vanish counts as zero.
const VANISHING: f64 = 1e-12;

/// The four Euler parameters of a rotation, `(cos(t/2), r sin(t/2))` (Liu, Tang and Joneja 2007, Sec. 3.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EulerParameters {
    /// `cos(t/2)`.
    pub scalar: f64,
    /// `r sin(t/2)`, r the unit axis.
    pub vector: [f64; 3],
}

impl EulerParameters {
    /// The smallest rotation that turns the unit vector `a` into the unit vector `b`.
    ///
    /// The published construction normalises `a x b`, which is 0/0 when the edge has not turned.
    /// Here `scalar = sqrt((1 + a . b) / 2)`, `vector = a x b / (2 scalar)`, which is smooth there and
    /// gives the identity. For `b = -a` no smallest rotation is distinguished; the one about
    /// `antiparallel_axis` (a unit vector perpendicular to `a`) is taken.
    #[must_use]
    pub fn aligning(a: &[f64; 3], b: &[f64; 3], antiparallel_axis: &[f64; 3]) -> Self {
        let c = 1.0 + dot(a, b);
        if c <= ANTIPARALLEL {
            return Self {
                scalar: 0.0,
                vector: *antiparallel_axis,
            };
        }
        let s = (0.5 * c).sqrt();
        Self {
            scalar: s,
            vector: scale(&cross(a, b), 0.5 / s),
        }
    }

    /// The rotation by `angle` radians about the unit vector `axis`, right-handed.
    #[must_use]
    pub fn about(axis: &[f64; 3], angle: f64) -> Self {
        let (s, c) = (0.5 * angle).sin_cos();
        Self {
            scalar: c,
            vector: scale(axis, s),
        }
    }

    /// The rotation matrix `A` of Sec. 3.5, row by row.
    #[must_use]
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        let t0 = self.scalar;
        let [t1, t2, t3] = self.vector;
        [
            [
                1.0 - 2.0 * (t2 * t2 + t3 * t3),
                2.0 * (t1 * t2 - t0 * t3),
                2.0 * (t1 * t3 + t0 * t2),
            ],
            [
                2.0 * (t1 * t2 + t0 * t3),
                1.0 - 2.0 * (t1 * t1 + t3 * t3),
                2.0 * (t2 * t3 - t0 * t1),
            ],
            [
                2.0 * (t1 * t3 - t0 * t2),
                2.0 * (t2 * t3 + t0 * t1),
                1.0 - 2.0 * (t1 * t1 + t2 * t2),
            ],
        ]
    }

    /// The rotated vector `A v`.
    #[must_use]
    pub fn rotate(&self, v: &[f64; 3]) -> [f64; 3] {
        self.matrix().map(|row| dot(&row, v))
    }
}

/// Right-handed orthonormal axes for the two spherical coordinates of rule *h*.
///
/// With `d` the vector from the known to the unknown vertex, the coordinates are the longitude
/// `atan2(d . e2, d . e1)` and the latitude `atan2(d . e3, |(d . e1, d . e2)|)`. The poles `+-e3` are
/// singular: the frame is therefore taken from a reference state with `e1` along the edge
/// ([`SphericalFrame::along`]), so that the edge starts on the equator at (0, 0) and has to turn by a
/// right angle before it meets a pole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalFrame {
    axes: [[f64; 3]; 3],
}

impl SphericalFrame {
    /// The frame whose first axis is along `direction`, with a horizontal polar axis
    /// perpendicular to it.
    ///
    /// An edge that falls or swings in its own vertical plane then changes its longitude only, however
    /// far it turns, and meets a pole only after a quarter turn sideways. For a vertical edge the
    /// polar axis is x.
    ///
    /// # Errors
    /// [`PlacementError::Coincident`] when `direction` is zero or not finite.
    pub fn along(direction: &[f64; 3]) -> Result<Self, PlacementError> {
        let length = norm(direction);
        if !(length > 0.0 && length.is_finite()) {
            return Err(PlacementError::Coincident { distance: length });
        }
        let e1 = scale(direction, 1.0 / length);
        let sideways = cross(&[0.0, 0.0, 1.0], &e1);
        // Within a thousandth of vertical the cross product would follow small changes too closely.
        let pole = if norm(&sideways) > 1e-3 {
            sideways
        } else {
            axpy(&[1.0, 0.0, 0.0], -e1[0], &e1)
        };
        let e3 = scale(&pole, 1.0 / norm(&pole));
        let e3 = axpy(&e3, -dot(&e3, &e1), &e1);
        let e3 = scale(&e3, 1.0 / norm(&e3));
        let e2 = cross(&e3, &e1);
        Ok(Self { axes: [e1, e2, e3] })
    }

    /// The axes e1, e2, e3.
    #[must_use]
    pub fn axes(&self) -> &[[f64; 3]; 3] {
        &self.axes
    }

    /// The unit vector with the given longitude and latitude (radians).
    #[must_use]
    pub fn direction(&self, q: [f64; 2]) -> [f64; 3] {
        let (sl, cl) = q[0].sin_cos();
        let (sp, cp) = q[1].sin_cos();
        let [e1, e2, e3] = &self.axes;
        let d = axpy(&scale(e1, cp * cl), cp * sl, e2);
        axpy(&d, sp, e3)
    }

    /// Longitude and latitude of the vector from `known` to `unknown`, radians, longitude in
    /// (-pi, pi], latitude in [-pi/2, pi/2].
    #[must_use]
    pub fn coordinates(&self, known: &[f64; 3], unknown: &[f64; 3]) -> [f64; 2] {
        let d = sub(unknown, known);
        let c = self.axes.map(|e| dot(&e, &d));
        [c[1].atan2(c[0]), c[2].atan2(c[0].hypot(c[1]))]
    }

    fn gradient_generic<T: Scalar>(&self, known: &Vec3<T>, unknown: &Vec3<T>) -> [Vec3<T>; 2] {
        let d = sub(unknown, known);
        let e = [
            lift(&self.axes[0]),
            lift(&self.axes[1]),
            lift(&self.axes[2]),
        ];
        let c = [dot(&e[0], &d), dot(&e[1], &d), dot(&e[2], &d)];
        let s2 = c[0] * c[0] + c[1] * c[1];
        let s = DualNum::sqrt(&s2);
        let r2 = s2 + c[2] * c[2];
        let longitude = add(&scale(&e[0], -c[1] / s2), &scale(&e[1], c[0] / s2));
        let k = -c[2] / (s * r2);
        let latitude = add(&scale(&e[0], k * c[0]), &scale(&e[1], k * c[1]));
        [longitude, axpy(&latitude, s / r2, &e[2])]
    }

    /// Gradients of the two coordinates with respect to the unknown vertex; with respect to the
    /// known vertex they are the negatives. Radians per metre.
    ///
    /// # Errors
    /// [`PlacementError::Pole`] when the edge points along the polar axis.
    pub fn gradient(
        &self,
        known: &[f64; 3],
        unknown: &[f64; 3],
    ) -> Result<[[f64; 3]; 2], PlacementError> {
        self.check(known, unknown)?;
        Ok(self.gradient_generic(known, unknown))
    }

    /// Derivative of [`Self::gradient`] along the velocities of the two vertices, exact.
    ///
    /// # Errors
    /// As [`Self::gradient`].
    pub(crate) fn gradient_rate(
        &self,
        positions: [&[f64; 3]; 2],
        velocities: [&[f64; 3]; 2],
    ) -> Result<[[f64; 3]; 2], PlacementError> {
        self.check(positions[0], positions[1])?;
        let known = dual(positions[0], velocities[0]);
        let unknown = dual(positions[1], velocities[1]);
        Ok(self
            .gradient_generic(&known, &unknown)
            .map(|row| row.map(|c| c.eps)))
    }

    fn check(&self, known: &[f64; 3], unknown: &[f64; 3]) -> Result<(), PlacementError> {
        let d = sub(unknown, known);
        let c = self.axes.map(|e| dot(&e, &d));
        let r = norm(&d);
        let s = c[0].hypot(c[1]);
        if !(r > 0.0 && r.is_finite()) {
            return Err(PlacementError::Coincident { distance: r });
        }
        if s <= VANISHING * r {
            return Err(PlacementError::Pole { sine: s / r });
        }
        Ok(())
    }
}

/// Reference directions for the rotation angle of rule *g*.
///
/// Vertex III hangs on the line I-II. The frame holds a unit reference edge `a` and a unit vector
/// `u` perpendicular to it, both from the rest triangle: `a` along `v_II - v_I`, `u` along the part of
/// `v_III - v_I` perpendicular to it. At any state the smallest rotation of `a` onto the current edge
/// direction carries `u` along (Liu, Tang and Joneja 2007, Sec. 3.5, through [`EulerParameters`]), and the
/// coordinate is the angle from there to vertex III about `v_II - v_I`, right-handed.
///
/// Where the edge points along `-a` that transport is singular, whatever formula is used: no
/// continuous field of perpendicular directions exists on the sphere. [`EdgeFrame::at_edge`] then
/// turns the frame by pi about `a x u`, the normal of the rest triangle. This agrees with the
/// published construction with that rotation axis at the antiparallel edge itself and is smooth
/// around it; coordinate values before and after differ, so a chart does this only when it is rebased.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeFrame {
    axis: [f64; 3],
    side: [f64; 3],
}

impl EdgeFrame {
    /// The frame of a rest triangle I, II, III.
    ///
    /// Three collinear rest points leave `u` open; any perpendicular is taken then.
    ///
    /// # Errors
    /// [`PlacementError::Coincident`] when the points I and II coincide or are not finite.
    pub fn from_triangle(v: [&[f64; 3]; 3]) -> Result<Self, PlacementError> {
        let e = sub(v[1], v[0]);
        let length = norm(&e);
        if !(length > 0.0 && length.is_finite()) {
            return Err(PlacementError::Coincident { distance: length });
        }
        let axis = scale(&e, 1.0 / length);
        let d = sub(v[2], v[0]);
        let p = axpy(&d, -dot(&d, &axis), &axis);
        let height = norm(&p);
        let side = if height > VANISHING * norm(&d) {
            // Orthogonalised once more: after the first pass the rest is of the size of rounding.
            let u = scale(&p, 1.0 / height);
            let u = axpy(&u, -dot(&u, &axis), &axis);
            scale(&u, 1.0 / norm(&u))
        } else {
            any_perpendicular(&axis)
        };
        Ok(Self { axis, side })
    }

    /// The reference edge direction a.
    #[must_use]
    pub fn axis(&self) -> &[f64; 3] {
        &self.axis
    }

    /// The reference perpendicular u.
    #[must_use]
    pub fn side(&self) -> &[f64; 3] {
        &self.side
    }

    /// This frame, or the one turned by pi about `a x u` when that is nearer to the edge `v_II - v_I`.
    #[must_use]
    pub fn at_edge(&self, v1: &[f64; 3], v2: &[f64; 3]) -> Self {
        if dot(&self.axis, &sub(v2, v1)) >= 0.0 {
            return *self;
        }
        Self {
            axis: neg(&self.axis),
            side: neg(&self.side),
        }
    }

    /// Cosine of the angle between the reference edge and the current one. The frame is singular at -1.
    #[must_use]
    pub(crate) fn alignment(&self, v1: &[f64; 3], v2: &[f64; 3]) -> f64 {
        let e = sub(v2, v1);
        dot(&self.axis, &e) / norm(&e)
    }

    /// The perpendicular `u` carried to the unit edge direction `b`, and `b x u`.
    fn transported<T: Scalar>(&self, b: &Vec3<T>) -> [Vec3<T>; 2] {
        let a: Vec3<T> = lift(&self.axis);
        let u: Vec3<T> = lift(&self.side);
        // A(theta) u with scalar^2 = (1 + a.b)/2 and vector = a x b / (2 scalar), multiplied out.
        let c = cross(&a, b);
        let k = (dot(&a, b) + 1.0).recip();
        let cu = cross(&c, &u);
        let u = axpy(&add(&u, &cu), k, &cross(&c, &cu));
        let w = cross(b, &u);
        [u, w]
    }

    /// The transported pair `(u, b x u)` for the current edge.
    ///
    /// # Errors
    /// [`PlacementError::Coincident`] for an edge without length, [`PlacementError::Antiparallel`]
    /// for an edge along `-a` ([`Self::at_edge`] gives the frame to use there).
    pub fn carried(&self, v1: &[f64; 3], v2: &[f64; 3]) -> Result<[[f64; 3]; 2], PlacementError> {
        let b = self.edge_direction(v1, v2)?;
        Ok(self.transported(&b))
    }

    fn edge_direction(&self, v1: &[f64; 3], v2: &[f64; 3]) -> Result<[f64; 3], PlacementError> {
        let e = sub(v2, v1);
        let length = norm(&e);
        if !(length > 0.0 && length.is_finite()) {
            return Err(PlacementError::Coincident { distance: length });
        }
        let b = scale(&e, 1.0 / length);
        let c = 1.0 + dot(&self.axis, &b);
        if c <= ANTIPARALLEL {
            return Err(PlacementError::Antiparallel { one_plus_cosine: c });
        }
        Ok(b)
    }

    /// The angle coordinate of vertex III, radians in (-pi, pi].
    ///
    /// # Errors
    /// As [`Self::carried`], and [`PlacementError::OnAxis`] when III lies on the line I-II.
    pub fn coordinate(&self, v: [&[f64; 3]; 3]) -> Result<f64, PlacementError> {
        self.check(v)?;
        let [u, w] = self.carried(v[0], v[1])?;
        let d = sub(v[2], v[0]);
        Ok(dot(&d, &w).atan2(dot(&d, &u)))
    }

    fn gradient_generic<T: Scalar>(&self, v: [&Vec3<T>; 3]) -> [Vec3<T>; 3] {
        let a: Vec3<T> = lift(&self.axis);
        let e = sub(v[1], v[0]);
        let inverse_length = norm(&e).recip();
        let b = scale(&e, inverse_length);
        let d = sub(v[2], v[0]);
        let t = dot(&d, &b);
        // b x d has length rho, the distance of III from the line, and points along the motion.
        let bd = cross(&b, &d);
        let rho2 = dot(&bd, &bd);
        let at_third = scale(&bd, rho2.recip());
        // Turning the edge tilts the radius (first part) and spins the carried frame (second part).
        let spin = (dot(&a, &b) + 1.0).recip();
        let tilt = axpy(&scale(&cross(&a, &b), spin), -t, &at_third);
        let at_second = scale(&tilt, inverse_length);
        let at_first = neg(&add(&at_third, &at_second));
        [at_first, at_second, at_third]
    }

    /// Gradients of the angle with respect to vertices I, II, III; radians per metre. They add up to zero.
    ///
    /// # Errors
    /// As [`Self::coordinate`].
    pub fn gradient(&self, v: [&[f64; 3]; 3]) -> Result<[[f64; 3]; 3], PlacementError> {
        self.check(v)?;
        Ok(self.gradient_generic(v))
    }

    /// Derivative of [`Self::gradient`] along the velocities of the three vertices, exact.
    ///
    /// # Errors
    /// As [`Self::coordinate`].
    pub(crate) fn gradient_rate(
        &self,
        v: [&[f64; 3]; 3],
        velocities: [&[f64; 3]; 3],
    ) -> Result<[[f64; 3]; 3], PlacementError> {
        self.check(v)?;
        let d = [
            dual(v[0], velocities[0]),
            dual(v[1], velocities[1]),
            dual(v[2], velocities[2]),
        ];
        Ok(self
            .gradient_generic([&d[0], &d[1], &d[2]])
            .map(|row| row.map(|c| c.eps)))
    }

    fn check(&self, v: [&[f64; 3]; 3]) -> Result<(), PlacementError> {
        let b = self.edge_direction(v[0], v[1])?;
        let d = sub(v[2], v[0]);
        let rho = norm(&cross(&b, &d));
        let length = norm(&d);
        if !length.is_finite() || rho <= VANISHING * length {
            return Err(PlacementError::OnAxis {
                sine: rho / length.max(f64::MIN_POSITIVE),
            });
        }
        Ok(())
    }
}

fn dual(x: &[f64; 3], v: &[f64; 3]) -> Vec3<Dual64> {
    [
        Dual64::new(x[0], v[0]),
        Dual64::new(x[1], v[1]),
        Dual64::new(x[2], v[2]),
    ]
}
