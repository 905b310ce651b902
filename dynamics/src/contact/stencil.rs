//! The points of a contact with their weights in its relative motion.

use super::{ActiveContact, Round};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Most points of a contact: four of the two primitives, and four of each of two round bodies.
const MOST: usize = 12;

/// Points with their weights in a relative motion, each point once.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stencil {
    points: [u32; MOST],
    weights: [f64; MOST],
    count: u8,
}

impl Stencil {
    /// Of some points with their weights. Those without weight are left out.
    ///
    /// # Panics
    /// If there are more than twelve.
    pub fn new(points: impl IntoIterator<Item = (u32, f64)>) -> Self {
        let mut stencil = Self {
            points: [0; MOST],
            weights: [0.0; MOST],
            count: 0,
        };
        for (point, weight) in points {
            stencil.add(point, weight);
        }
        stencil
    }

    /// How the two surfaces of a contact move where they are closest to each other, with the points at `x`
    /// (three coordinates each).
    ///
    /// The closest points of two primitives move by `sum_i w_i u_i` relative to each other. The surface of a
    /// round body is at `o = -r n` from the closest point of the first primitive, and at `o = r n` from that
    /// of the second, with the radius `r` and the normal `n`. With four points `p_k` that the body carries,
    /// and `q` such that `o = sum_k q_k (p_k - p_0)`, its material there moves by `sum_k q_k (u_k - u_0)`
    /// more: the lever of friction.
    pub(super) fn of(contact: &ActiveContact, x: &[f64]) -> Self {
        let own = contact.vertices.into_iter().zip(contact.weights);
        let mut stencil = Self::new(own);
        for (round, sign) in contact.round.iter().zip([1.0, -1.0]) {
            if let Some(Round { radius, frame }) = round {
                let place = |p: u32| {
                    let i = 3 * p as usize;
                    Vector3::new(x[i], x[i + 1], x[i + 2])
                };
                let [origin, others @ ..] = *frame;
                let axes = others.map(|p| place(p) - place(origin));
                let offset = -sign * *radius * contact.normal;
                // (Four points in a plane, which a body does not have, would have no lever.)
                let parts = Matrix3::from_columns(&axes).lu().solve(&offset);
                let parts = parts.unwrap_or_default();
                stencil.add(origin, -sign * parts.sum());
                for (point, part) in others.into_iter().zip(&parts) {
                    stencil.add(point, sign * part);
                }
            }
        }
        stencil
    }

    fn add(&mut self, point: u32, weight: f64) {
        if weight == 0.0 {
            return;
        }
        let count = usize::from(self.count);
        match self.points[..count].iter().position(|p| *p == point) {
            Some(place) => self.weights[place] += weight,
            None => {
                self.points[count] = point;
                self.weights[count] = weight;
                self.count += 1;
            }
        }
    }

    /// The points.
    pub fn points(&self) -> &[u32] {
        &self.points[..usize::from(self.count)]
    }

    /// Their weights.
    pub fn weights(&self) -> &[f64] {
        &self.weights[..usize::from(self.count)]
    }

    /// Both.
    pub fn iter(&self) -> impl Iterator<Item = (u32, f64)> {
        self.points()
            .iter()
            .copied()
            .zip(self.weights().iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ContactKey, ContactKind};
    use nalgebra::Rotation3;

    /// Of a ball that turns about its centre, seen from a face below, the surface moves by `w x o`; of two
    /// balls each by its own.
    #[test]
    fn the_lever_is_that_of_the_surface() {
        let turn = Rotation3::from_euler_angles(0.3, -0.5, 1.1);
        let frame = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let centre = Vector3::new(2.0, -1.0, 0.5);
        let mut x: Vec<f64> = Vec::new();
        for p in [Vector3::x(), Vector3::y(), Vector3::new(-1.0, -1.0, 0.0)] {
            x.extend(&p);
        }
        for p in frame {
            x.extend(&(centre + 0.2 * (turn * p)));
        }
        let normal = Vector3::new(0.2, 0.1, 1.0).normalize();
        let radius = 0.7;
        let round = Round {
            radius,
            frame: [3, 4, 5, 6],
        };
        let mut contact = ActiveContact {
            key: ContactKey {
                body: None,
                kind: ContactKind::VertexFace,
                pair: [3, 0],
            },
            vertices: [3, 0, 1, 2],
            weights: [1.0, -0.5, -0.3, -0.2],
            normal,
            gap: 1e-3,
            closest: Vector3::zeros(),
            parallel: None,
            rolling: None,
            round: [Some(round), None],
        };
        let spin = Vector3::new(0.4, 2.0, -1.0);
        let moved = |stencil: &Stencil| {
            let velocity = |p: u32| match p {
                0..3 => Vector3::new(1.0, 2.0, 3.0),
                _ => {
                    let i = 3 * p as usize;
                    spin.cross(&(Vector3::new(x[i], x[i + 1], x[i + 2]) - centre))
                }
            };
            stencil
                .iter()
                .map(|(p, w)| w * velocity(p))
                .sum::<Vector3<f64>>()
        };
        let face = Vector3::new(1.0, 2.0, 3.0);
        let found = moved(&Stencil::of(&contact, &x));
        let wanted = spin.cross(&(-radius * normal)) - face;
        assert!((found - wanted).norm() < 1e-12, "{found} {wanted}");
        // The other way round.
        contact.weights = contact.weights.map(|w| -w);
        contact.round = [None, Some(round)];
        let found = moved(&Stencil::of(&contact, &x));
        let wanted = face - spin.cross(&(radius * normal));
        assert!((found - wanted).norm() < 1e-12, "{found} {wanted}");
        // Weights add up to nothing, and no point is there twice.
        let stencil = Stencil::of(&contact, &x);
        assert!(stencil.weights().iter().sum::<f64>().abs() < 1e-12);
        assert_eq!(stencil.points().len(), 7);
    }
}
