//! Contacts for methods that use impulses in place of the barrier.

use super::{ActiveContacts, BodyMotionError, Contact};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A contact within reach, as impulses on momenta need it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ContactPoint {
    /// Vertices of the sheet that take part and their weights in the relative motion,
    /// `sum_i w_i v_i - body velocity`; unused places have weight zero.
    pub stencil: [(u32, f64); 4],
    /// Unit normal: the distance grows at the rate `n . (sum_i w_i v_i - body velocity)`.
    pub normal: Vector3<f64>,
    /// Distance less thickness, metres.
    pub gap: f64,
    /// Velocity of the body at the contact, metres per second; zero for the sheet with itself.
    pub body_velocity: Vector3<f64>,
    /// Kinetic coefficient of friction.
    pub friction: f64,
}

impl ActiveContacts {
    /// The contacts as impulses need them. Clears `out` first.
    ///
    /// # Errors
    /// [`BodyMotionError`] if the velocity of a body is not finite.
    pub(crate) fn contact_points(
        &self,
        contact: &dyn Contact,
        out: &mut Vec<ContactPoint>,
    ) -> Result<(), BodyMotionError> {
        out.clear();
        let (laws, t) = (contact.laws(), self.time());
        out.extend(self.list().iter().map(|c| ContactPoint {
            stencil: std::array::from_fn(|i| (c.vertices[i], c.weights[i])),
            normal: c.normal,
            gap: c.gap,
            body_velocity: match c.key.body {
                Some(b) => contact.body_velocity(b, t, &c.closest),
                None => Vector3::zeros(),
            },
            friction: laws.coefficients(c.key.body, c.vertices).sliding,
        }));
        for (contact, point) in self.list().iter().zip(&*out) {
            let value = point.body_velocity.iter().find(|c| !c.is_finite());
            if let (Some(body), Some(&value)) = (contact.key.body, value) {
                let body = body as usize;
                return Err(BodyMotionError { body, value, t });
            }
        }
        Ok(())
    }
}
