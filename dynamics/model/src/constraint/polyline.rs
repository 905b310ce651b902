//! Polylines with rounded corners.

use super::curve::{round, straight};
use super::{ConstraintError, Curve, CurvePoint};
use nalgebra::Vector3;

/// Straight sides joined by circular arcs; it continues straight beyond its ends.
///
/// Corners are rounded because at a sharp one the motion of a vertex has no velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    pieces: Vec<PolylinePiece>,
}

#[derive(Debug, Clone, PartialEq)]
enum PolylinePiece {
    /// From `start` in the unit direction, over the range of lengths.
    Side {
        start: Vector3<f64>,
        direction: Vector3<f64>,
        range: [f64; 2],
    },
    /// About `centre`, from the first axis towards the second over `angle`.
    Arc {
        centre: Vector3<f64>,
        axes: [Vector3<f64>; 2],
        radius: f64,
        angle: f64,
    },
}

/// Turns of less than this angle (radians) are no corners: rounding one would need an arc shorter than
/// round-off.
const STRAIGHT: f64 = 1e-9;

impl Polyline {
    /// Through points (metres), corners rounded with a radius (metres).
    ///
    /// # Errors
    /// [`ConstraintError`] if a number is not finite, there are fewer than two points, neighbours coincide,
    /// or the radius does not fit between the corners.
    pub fn new(points: &[[f64; 3]], corner_radius: f64) -> Result<Self, ConstraintError> {
        let radius = ConstraintError::check_positive("the radius of the corners", corner_radius)?;
        if points.len() < 2 {
            return Err(ConstraintError::TooFewPoints {
                what: "polyline",
                found: points.len(),
                needed: 2,
            });
        }
        let points = points
            .iter()
            .map(|p| ConstraintError::check_vector("a point of the polyline", p))
            .collect::<Result<Vec<_>, _>>()?;
        let sides = points
            .windows(2)
            .enumerate()
            .map(|(i, w)| {
                let d = w[1] - w[0];
                let length = d.norm();
                let direction = d.try_normalize(0.0).ok_or(ConstraintError::Coincident {
                    first: i,
                    second: i + 1,
                })?;
                Ok((direction, length))
            })
            .collect::<Result<Vec<_>, _>>()?;
        // What an arc takes of either side: r tan(turn / 2).
        let turns: Vec<f64> = sides
            .windows(2)
            .map(|w| w[0].0.cross(&w[1].0).norm().atan2(w[0].0.dot(&w[1].0)))
            .collect();
        let cut = |corner: usize, r: f64| r * (0.5 * turns[corner]).tan();
        let last = sides.len() - 1;
        for (corner, turn) in turns.iter().enumerate() {
            for side in [corner, corner + 1] {
                // A side between two corners is shared by both in halves.
                let share = if side == 0 || side == last { 1.0 } else { 0.5 };
                let room = share * sides[side].1;
                if cut(corner, radius) > room {
                    return Err(ConstraintError::Corner {
                        point: corner + 1,
                        radius,
                        largest: room / (0.5 * turn).tan(),
                    });
                }
            }
        }
        let mut pieces = Vec::new();
        for (i, &(direction, length)) in sides.iter().enumerate() {
            let from = match i {
                0 => f64::NEG_INFINITY,
                _ => cut(i - 1, radius),
            };
            let to = if i == last {
                f64::INFINITY
            } else {
                length - cut(i, radius)
            };
            pieces.push(PolylinePiece::Side {
                start: points[i],
                direction,
                range: [from, to],
            });
            if i == last || turns[i] < STRAIGHT {
                continue;
            }
            let next = sides[i + 1].0;
            let inward = (next - direction * direction.dot(&next)).normalize();
            pieces.push(PolylinePiece::Arc {
                centre: points[i] + to * direction + radius * inward,
                axes: [-inward, direction],
                radius,
                angle: turns[i],
            });
        }
        Ok(Self { pieces })
    }
}

impl PolylinePiece {
    fn closest(&self, p: &Vector3<f64>) -> CurvePoint {
        match self {
            Self::Side {
                start,
                direction,
                range,
            } => {
                let at = direction.dot(&(p - start)).clamp(range[0], range[1]);
                straight(start, direction, &(start + at * direction))
            }
            Self::Arc {
                centre,
                axes,
                radius,
                angle,
            } => {
                let d = p - centre;
                let at = axes[1].dot(&d).atan2(axes[0].dot(&d));
                // The far side of the circle is as near to one end as to the other.
                let opposite = 0.5 * angle - std::f64::consts::PI;
                let at = if at < opposite {
                    *angle
                } else {
                    at.clamp(0.0, *angle)
                };
                let (s, c) = at.sin_cos();
                round(centre, axes, *radius, c, s)
            }
        }
    }
}

impl Curve for Polyline {
    fn closest(&self, p: &Vector3<f64>) -> CurvePoint {
        let distance = |at: &CurvePoint| (p - at.position).norm_squared();
        self.pieces
            .iter()
            .map(|piece| piece.closest(p))
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("a polyline has a side")
    }
}
