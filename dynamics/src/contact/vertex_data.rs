//! Contact as numbers at the vertices: forces and gaps.

use super::{ActiveContacts, ContactTerms};

impl ContactTerms<'_> {
    /// Force of contact on each vertex, `-d(B + D)/dx`, newtons (`3V`): barrier and friction together.
    pub fn vertex_forces(&self) -> Vec<f64> {
        let mut forces = vec![0.0; self.x.len()];
        self.add_gradient(-1.0, &mut forces);
        forces
    }
}

impl ActiveContacts {
    /// Smallest gap of the contacts in which each of so many vertices takes part, by itself or as a corner of
    /// an edge or a face that does, metres; `reach`, the activation distance, where there is none.
    pub fn vertex_gaps(&self, vertices: usize, reach: f64) -> Vec<f64> {
        let mut gaps = vec![reach; vertices];
        for contact in self.list() {
            for &v in contact.corners() {
                let least = &mut gaps[v as usize];
                *least = least.min(contact.gap);
            }
        }
        gaps
    }
}
