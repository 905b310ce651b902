//! Contact for methods that have no place for it: its barrier as a potential like any other.

use isosheet_collide::Contacts;
use isosheet_dynamics::contact::{
    ActiveContacts, BarrierError, BarrierPotential, Contact, CouplingSink,
};
use isosheet_dynamics::{HessianSink, Potential, SheetModel, State};
use isosheet_mesh::{Topology, VertexId};
use nalgebra::Matrix3;
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// The barrier of frictionless contact with resting bodies as a potential of the positions.
///
/// The same function that [`isosheet_dynamics::Simulation::with_contact`] takes, but no motion is checked: a
/// method that steps too far passes through the bodies.
pub(crate) struct Barrier {
    /// Energies want the pairs within reach to be found anew at every place.
    contacts: Mutex<Contacts>,
    potential: BarrierPotential,
    topology: Topology,
}

impl Barrier {
    /// The barrier of a simulation of `model` without the barrier from a state.
    pub(crate) fn new(
        contacts: Contacts,
        model: &SheetModel,
        start: &State,
    ) -> Result<Self, BarrierError> {
        Ok(Self {
            potential: BarrierPotential::at_start(contacts.laws(), model, start)?,
            contacts: Mutex::new(contacts),
            topology: model.topology().clone(),
        })
    }

    /// The contacts at `x`.
    fn at(&self, x: &[f64]) -> ActiveContacts {
        let lock = self.contacts.lock();
        // Whatever a thread that panicked left behind is overwritten.
        let mut contacts = lock.unwrap_or_else(PoisonError::into_inner);
        ActiveContacts::at_rest(&mut *contacts, 0.0, x)
    }
}

impl fmt::Debug for Barrier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Barrier").finish_non_exhaustive()
    }
}

impl Potential for Barrier {
    fn energy(&self, _t: f64, x: &[f64]) -> f64 {
        self.at(x).barrier_energy(&self.potential)
    }

    fn add_gradient(&self, _t: f64, x: &[f64], gradient: &mut [f64]) {
        let active = self.at(x);
        active.add_barrier_gradient(&self.potential, 1.0, gradient);
    }

    fn add_hessian(&self, _t: f64, x: &[f64], hessian: &mut dyn HessianSink) {
        let mut sink = Along {
            topology: &self.topology,
            hessian,
        };
        let active = self.at(x);
        active.add_barrier_hessian(&self.potential, &mut sink);
    }
}

/// Passes on the blocks of vertices and edges; contact with bodies has no others.
struct Along<'a> {
    topology: &'a Topology,
    hessian: &'a mut dyn HessianSink,
}

impl CouplingSink for Along<'_> {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        let (a, b) = (VertexId(a), VertexId(b));
        if a == b {
            self.hessian.add_vertex(a, block);
        } else if let Some(e) = self.topology.find_edge(a, b) {
            // The edge may run the other way.
            if self.topology.edges()[e.index()] == [a, b] {
                self.hessian.add_edge(e, block);
            } else {
                self.hessian.add_edge(e, &block.transpose());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::{Problem, TABLE_TOP};
    use super::*;
    use isosheet_mesh::EdgeId;
    use nalgebra::Vector3;

    /// The product of the matrix of the blocks with a direction that is the same at all vertices.
    struct Product<'a> {
        topology: &'a Topology,
        direction: Vector3<f64>,
        product: Vec<Vector3<f64>>,
    }

    impl HessianSink for Product<'_> {
        fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
            self.product[v.index()] += block * self.direction;
        }

        fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
            let [a, b] = self.topology.edges()[e.index()];
            self.add_pair(a, b, block);
        }

        fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
            self.product[a.index()] += block * self.direction;
            self.product[b.index()] += block.transpose() * self.direction;
        }
    }

    /// A cloth laid into the reach of the table: slopes of the energy, and the part of the Hessian that a
    /// push straight down sees, against differences.
    #[test]
    fn the_barrier_has_the_derivatives_of_its_energy() {
        let setup = Problem::Cloth(1).setup().unwrap();
        let contacts = setup.contacts.unwrap();
        let depth = contacts.options().activation;
        let mut x = setup.state.x.clone();
        let barrier = Barrier::new(contacts, &setup.model, &setup.state).unwrap();
        let far = barrier.energy(0.0, &x);
        assert_eq!(far, 0.0, "the cloth starts out of reach");
        // Flat, half-way into the reach, and not quite level.
        for (i, p) in x.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            p[0] += 0.013;
            p[1] += 0.007;
            p[2] = TABLE_TOP + depth * (0.5 + 0.05 * (i as f64).sin());
        }
        let gradient = |x: &[f64]| {
            let mut gradient = vec![0.0; x.len()];
            barrier.add_gradient(0.0, x, &mut gradient);
            gradient
        };
        let upwards = |values: &[f64]| values.iter().skip(2).step_by(3).copied().collect();
        let h = 1e-4 * depth;
        let [low, up] = [-h, h].map(|shift| {
            let mut moved = x.clone();
            moved
                .iter_mut()
                .skip(2)
                .step_by(3)
                .for_each(|z| *z += shift);
            moved
        });
        let slope = (barrier.energy(0.0, &up) - barrier.energy(0.0, &low)) / (2.0 * h);
        let along: Vec<f64> = upwards(&gradient(&x));
        let along: f64 = along.iter().sum();
        assert!(
            slope < 0.0 && (slope / along - 1.0).abs() < 1e-6,
            "{slope} {along}"
        );
        let mut found = Product {
            topology: setup.model.topology(),
            direction: Vector3::z(),
            product: vec![Vector3::zeros(); x.len() / 3],
        };
        barrier.add_hessian(0.0, &x, &mut found);
        let [low, up]: [Vec<f64>; 2] = [low, up].map(|x| upwards(&gradient(&x)));
        let scale = found.product.iter().map(|f| f.z.abs()).fold(0.0, f64::max);
        assert!(scale > 0.0);
        for (found, (up, low)) in found.product.iter().zip(up.iter().zip(&low)) {
            let want = (up - low) / (2.0 * h);
            assert!((found.z - want).abs() < 1e-5 * scale, "{found} {want}");
        }
    }
}
