//! The placement functions h, g and f (Liu, Tang and Joneja 2007, Sec. 3.1, 3.4, 3.5; Fig. 6).
//!
//! A vertex that the front reaches has one, two or three neighbours in known positions, and the
//! lengths of the edges to them are given:
//!
//! * [`place_h`]: one known neighbour, two spherical coordinates in a [`SphericalFrame`];
//! * [`place_g`]: two known neighbours, the rotation angle about their line in an [`EdgeFrame`];
//! * [`place_f`]: three known neighbours, no coordinate: the intersection of three spheres, two
//!   mirror images in the plane of the three, told apart by a [`Branch`];
//! * [`place_on_line`]: the degenerate case of Fig. 7, three known neighbours on a line.
//!
//! First derivatives follow from the implicit function theorem applied to the length equations and
//! the coordinate gradients: with `x - a_k` (and the coordinate gradients) as the rows of a 3 x 3
//! matrix N, `N dx` is a known linear form in the inputs. No inverse cosine is used anywhere.

use crate::frames::{EdgeFrame, SphericalFrame};
use crate::placement_error::PlacementError;
use crate::vec3::{add, axpy, cross, dot, inverse, norm, scale, sub};

/// Below this sine of the smallest angle of their triangle, three known vertices count as
/// collinear (Fig. 7).
///
/// [`place_f`] keeps the three lengths to rounding at any sine, but its position is uncertain by
/// rounding divided by the sine; at 1e-9 seven digits are left, about as many as the height above the
/// three has near a flat state. [`place_on_line`] in turn misses the third length by up to the sine.
pub const COLLINEAR: f64 = 1e-9;

/// Which of the two mirror images rule f takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Branch {
    /// On the side of `(k1 - k0) x (k2 - k0)`, k the known vertices in their order.
    Above,
    /// On the other side.
    Below,
    /// The image nearer to this position (continuity with an earlier state).
    Near([f64; 3]),
}

/// A position found by [`place_f`] or [`place_g`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// The position.
    pub position: [f64; 3],
    /// Squared height above the plane of the known vertices (f) or squared distance from their line
    /// (g), over the squared length of the first edge, before any clamping to zero.
    pub height_squared: f64,
}

/// Rule h (Eq. 13): the vertex at distance `length` from `known` in the direction with longitude `q[0]` and
/// latitude `q[1]`.
#[must_use]
pub fn place_h(known: &[f64; 3], length: f64, frame: &SphericalFrame, q: [f64; 2]) -> [f64; 3] {
    axpy(known, length, &frame.direction(q))
}

/// Rule g (Eq. 12): the vertex at distances `lengths` from the two known vertices, turned by the angle `q`
/// about their line out of the carried reference direction of `frame`.
///
/// The distance of the two known vertices is taken from their positions, so that the rule holds for
/// any two known neighbours, joined by an edge or not. `tolerance` is the relative squared radius
/// that still counts as zero, see [`place_f`].
///
/// # Errors
/// [`PlacementError::OutOfReach`] when the distances do not form a triangle, and the errors of
/// [`EdgeFrame::carried`].
pub fn place_g(
    known: [&[f64; 3]; 2],
    lengths: [f64; 2],
    frame: &EdgeFrame,
    q: f64,
    tolerance: f64,
) -> Result<Placed, PlacementError> {
    let [u, w] = frame.carried(known[0], known[1])?;
    let (s, c) = q.sin_cos();
    let side = axpy(&scale(&u, c), s, &w);
    on_circle(known, lengths, &side, tolerance)
}

/// The degenerate case of Fig. 7: the known neighbours lie on the line through `known`, and the
/// vertex stays in the half plane through that line in which `near` lies.
///
/// This is the perturbation policy of this crate for `gamma = pi`: the angle about the line, which the
/// lengths leave free, is carried over from the previous state.
///
/// # Errors
/// [`PlacementError::Coincident`], [`PlacementError::OutOfReach`] as for [`place_g`];
/// [`PlacementError::OnAxis`] when `near` lies on the line.
pub fn place_on_line(
    known: [&[f64; 3]; 2],
    lengths: [f64; 2],
    near: &[f64; 3],
    tolerance: f64,
) -> Result<Placed, PlacementError> {
    let frame = EdgeFrame::from_triangle([known[0], known[1], near])?;
    let d = sub(near, known[0]);
    let sine = norm(&cross(frame.axis(), &d)) / norm(&d);
    if sine.is_nan() || sine <= COLLINEAR {
        return Err(PlacementError::OnAxis { sine });
    }
    on_circle(known, lengths, frame.side(), tolerance)
}

/// The point at the given distances from two known points, on the side of the unit vector `side`
/// perpendicular to their line.
fn on_circle(
    known: [&[f64; 3]; 2],
    lengths: [f64; 2],
    side: &[f64; 3],
    tolerance: f64,
) -> Result<Placed, PlacementError> {
    let e = sub(known[1], known[0]);
    let span = norm(&e);
    if !(span > 0.0 && span.is_finite()) {
        return Err(PlacementError::Coincident { distance: span });
    }
    let [r, s] = lengths;
    // Foot of the perpendicular, (r^2 - s^2 + span^2) / (2 span) with the difference factored.
    let foot = 0.5 * ((r - s) * (r + s) / span + span);
    let radius_squared = (r - foot) * (r + foot);
    let height_squared = radius_squared / (r * r);
    let radius = clamped_root(height_squared, tolerance)? * r;
    let p = axpy(known[0], foot / span, &e);
    Ok(Placed {
        position: axpy(&p, radius, side),
        height_squared,
    })
}

/// Square root with a dead zone: values within `tolerance` of zero are zero, lower ones an error.
fn clamped_root(height_squared: f64, tolerance: f64) -> Result<f64, PlacementError> {
    if height_squared > tolerance {
        Ok(height_squared.sqrt())
    } else if height_squared >= -tolerance {
        Ok(0.0)
    } else {
        // Also catches NaN.
        Err(PlacementError::OutOfReach { height_squared })
    }
}

/// Sine of the smallest angle of a triangle: the relative criterion for Fig. 7.
#[must_use]
pub fn collinearity(known: [&[f64; 3]; 3]) -> f64 {
    let sides = [
        sub(known[1], known[0]),
        sub(known[2], known[0]),
        sub(known[2], known[1]),
    ];
    let area = norm(&cross(&sides[0], &sides[1]));
    let mut l = sides.map(|s| norm(&s));
    l.sort_by(f64::total_cmp);
    area / (l[1] * l[2])
}

/// Rule f (Eq. 11): the vertex at distances `lengths` from three known vertices.
///
/// The foot of the perpendicular in the plane of the three solves two linear equations (differences of
/// squared lengths) and the height h is left from the first length. Flat states have `h = 0`, where rounding
/// decides the sign of `h^2`: values within `tolerance` of zero, relative to the squared first length, count
/// as zero, which costs at most `tolerance / 2` of relative length. Below that the state violates Eq. 10 and
/// is refused.
///
/// # Errors
/// [`PlacementError::Collinear`] in the case of Fig. 7, see [`COLLINEAR`];
/// [`PlacementError::OutOfReach`] when the three spheres do not meet;
/// [`PlacementError::Coincident`] for input that is not finite.
pub fn place_f(
    known: [&[f64; 3]; 3],
    lengths: [f64; 3],
    branch: Branch,
    tolerance: f64,
) -> Result<Placed, PlacementError> {
    let sine = collinearity(known);
    if sine.is_nan() {
        return Err(PlacementError::Coincident { distance: sine });
    }
    if sine <= COLLINEAR {
        return Err(PlacementError::Collinear { sine });
    }
    // Orthonormal axes in the plane: along the first side, and along the rest of the second, which
    // keeps both perpendicular to rounding however small the angle between the sides is.
    let p = sub(known[1], known[0]);
    let r = sub(known[2], known[0]);
    let span = norm(&p);
    let e1 = scale(&p, 1.0 / span);
    let along = dot(&r, &e1);
    let rest = axpy(&r, -along, &e1);
    let rest = axpy(&rest, -dot(&rest, &e1), &e1);
    let height = norm(&rest);
    let e2 = scale(&rest, 1.0 / height);
    let unit = cross(&e1, &e2);
    let [l0, l1, l2] = lengths;
    let y1 = 0.5 * ((l0 - l1) * (l0 + l1) / span + span);
    let y2 = (0.5 * ((l0 - l2) * (l0 + l2) + dot(&r, &r)) - y1 * along) / height;
    let foot = axpy(&scale(&e1, y1), y2, &e2);
    let distance = y1.hypot(y2);
    let height_squared = (l0 - distance) * (l0 + distance) / (l0 * l0);
    let height = clamped_root(height_squared, tolerance)? * l0;
    let base = add(known[0], &foot);
    let above = match branch {
        Branch::Above => true,
        Branch::Below => false,
        Branch::Near(x) => dot(&unit, &sub(&x, &base)) >= 0.0,
    };
    let signed = if above { height } else { -height };
    Ok(Placed {
        position: axpy(&base, signed, &unit),
        height_squared,
    })
}

/// A 3 x 3 derivative, row by row: entry `[i][j]` is the change of component i with input j.
pub type PositionDerivative = [[f64; 3]; 3];

/// First derivatives of rule h.
#[derive(Clone, Copy, Debug)]
pub struct JacobianH {
    /// With respect to the known vertex.
    pub known: PositionDerivative,
    /// With respect to longitude and latitude, metres per radian.
    pub q: [[f64; 3]; 2],
}

/// First derivatives of rule g.
#[derive(Clone, Copy, Debug)]
pub struct JacobianG {
    /// With respect to the two known vertices.
    pub known: [PositionDerivative; 2],
    /// With respect to the angle, metres per radian.
    pub q: [f64; 3],
}

/// First derivatives of rule f, with respect to the three known vertices.
pub type JacobianF = [PositionDerivative; 3];

/// `column k of inv` times `row`.
fn outer(inv: &PositionDerivative, k: usize, row: &[f64; 3]) -> PositionDerivative {
    let mut b = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            b[i][j] = inv[i][k] * row[j];
        }
    }
    b
}

fn plus(a: &PositionDerivative, b: &PositionDerivative) -> PositionDerivative {
    [add(&a[0], &b[0]), add(&a[1], &b[1]), add(&a[2], &b[2])]
}

fn column(inv: &PositionDerivative, k: usize) -> [f64; 3] {
    [inv[0][k], inv[1][k], inv[2][k]]
}

/// Derivatives of [`place_h`] at a placed vertex, the coefficients of Eq. 15.
///
/// # Errors
/// [`PlacementError::Pole`] at a pole of the frame.
pub fn jacobian_h(
    known: &[f64; 3],
    frame: &SphericalFrame,
    position: &[f64; 3],
) -> Result<JacobianH, PlacementError> {
    let d = sub(position, known);
    let [longitude, latitude] = frame.gradient(known, position)?;
    let inv = inverse(&[d, longitude, latitude]).ok_or(PlacementError::Flat)?;
    // All three rows depend on the difference of the two vertices only.
    let known = plus(
        &plus(&outer(&inv, 0, &d), &outer(&inv, 1, &longitude)),
        &outer(&inv, 2, &latitude),
    );
    Ok(JacobianH {
        known,
        q: [column(&inv, 1), column(&inv, 2)],
    })
}

/// Derivatives of [`place_g`] at a placed vertex, the coefficients of Eq. 15.
///
/// # Errors
/// [`PlacementError::Flat`] when the vertex lies on the line of the known ones, and the errors of
/// [`EdgeFrame::gradient`].
pub fn jacobian_g(
    known: [&[f64; 3]; 2],
    frame: &EdgeFrame,
    position: &[f64; 3],
) -> Result<JacobianG, PlacementError> {
    let d = known.map(|k| sub(position, k));
    let s = frame.gradient([known[0], known[1], position])?;
    let inv = inverse(&[d[0], d[1], s[2]]).ok_or(PlacementError::Flat)?;
    let block = |k: usize| {
        let own = outer(&inv, k, &d[k]);
        let angle = outer(&inv, 2, &scale(&s[k], -1.0));
        plus(&own, &angle)
    };
    Ok(JacobianG {
        known: [block(0), block(1)],
        q: column(&inv, 2),
    })
}

/// Derivatives of [`place_f`] at a placed vertex, the coefficients of Eq. 15.
///
/// # Errors
/// [`PlacementError::Flat`] when the four vertices are coplanar: the two mirror images meet there
/// and the position has no derivative.
pub fn jacobian_f(known: [&[f64; 3]; 3], position: &[f64; 3]) -> Result<JacobianF, PlacementError> {
    let d = known.map(|k| sub(position, k));
    let inv = inverse(&d).ok_or(PlacementError::Flat)?;
    Ok([
        outer(&inv, 0, &d[0]),
        outer(&inv, 1, &d[1]),
        outer(&inv, 2, &d[2]),
    ])
}

#[cfg(test)]
mod tests;
