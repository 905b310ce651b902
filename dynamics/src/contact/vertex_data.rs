//! Contact as numbers at the vertices: forces and gaps.

use super::{ActiveContacts, ContactTerms, SurfacePoints};

impl ContactTerms<'_> {
    /// Force of contact on each vertex, `-d(B + D)/dx`, newtons (`3V`): barrier and friction together.
    pub(crate) fn vertex_forces(&self, points: Option<&SurfacePoints>) -> Vec<f64> {
        let mut forces = vec![0.0; self.x.len()];
        self.add_gradient(-1.0, &mut forces);
        let Some(points) = points else { return forces };
        let mut carried = vec![0.0; 3 * points.model_vertices()];
        points.add_forces(&forces, &mut carried);
        carried
    }
}

impl ActiveContacts {
    /// Smallest gap of the contacts in which each of so many points takes part, by itself or as a corner of
    /// an edge or a face that does, metres; `reach`, the activation distance, where there is none.
    pub(crate) fn point_gaps(&self, points: usize, reach: f64) -> Vec<f64> {
        let mut gaps = vec![reach; points];
        for contact in self.list() {
            for &v in contact.corners() {
                let least = &mut gaps[v as usize];
                *least = least.min(contact.gap);
            }
        }
        gaps
    }
}
