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
    use super::super::problem::Problem;
    use super::*;
    use isosheet_mesh::EdgeId;

    /// Full matrix of the blocks.
    struct Dense<'a> {
        topology: &'a Topology,
        n: usize,
        values: Vec<f64>,
    }

    impl Dense<'_> {
        fn add(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
            for r in 0..3 {
                for c in 0..3 {
                    self.values[(3 * a.index() + r) * self.n + 3 * b.index() + c] += block[(r, c)];
                }
            }
        }
    }

    impl HessianSink for Dense<'_> {
        fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
            self.add(v, v, block);
        }

        fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
            let [a, b] = self.topology.edges()[e.index()];
            self.add(a, b, block);
            self.add(b, a, &block.transpose());
        }

        fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
            self.add(a, b, block);
            self.add(b, a, &block.transpose());
        }
    }

    /// A cloth laid into the reach of the table: slopes of the energy, and the part of the Hessian that a
    /// push straight down sees, against differences.
    #[test]
    fn the_barrier_has_the_derivatives_of_its_energy() {
        let problem = Problem::Cloth(1);
        let sheet = problem.sheet().unwrap();
        let contacts = problem.contacts().unwrap().unwrap();
        let mut x = sheet.positions().to_vec();
        let depth = contacts.options().activation;
        let start = problem.start().unwrap();
        let barrier = Barrier::new(contacts, &problem.without_contact().unwrap(), &start).unwrap();
        assert_eq!(
            barrier.energy(0.0, &x),
            0.0,
            "the cloth starts out of reach"
        );
        // Flat, half-way into the reach, and not quite level.
        let top = super::super::problem::TABLE_TOP;
        for (i, p) in x.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            p[0] += 0.013;
            p[1] += 0.007;
            p[2] = top + depth * (0.5 + 0.05 * (i as f64).sin());
        }
        let mut gradient = vec![0.0; x.len()];
        barrier.add_gradient(0.0, &x, &mut gradient);
        let mut dense = Dense {
            topology: sheet.topology(),
            n: x.len(),
            values: vec![0.0; x.len() * x.len()],
        };
        barrier.add_hessian(0.0, &x, &mut dense);
        let down: Vec<f64> = (0..x.len()).map(|i| f64::from(i % 3 == 2)).collect();
        let h = 1e-4 * depth;
        let moved = |s: f64| -> Vec<f64> { x.iter().zip(&down).map(|(x, d)| x + s * d).collect() };
        let slope = (barrier.energy(0.0, &moved(h)) - barrier.energy(0.0, &moved(-h))) / (2.0 * h);
        let along: f64 = gradient.iter().zip(&down).map(|(g, d)| g * d).sum();
        assert!(
            slope < 0.0 && (slope / along - 1.0).abs() < 1e-6,
            "{slope} {along}"
        );
        let (mut up, mut low) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        barrier.add_gradient(0.0, &moved(h), &mut up);
        barrier.add_gradient(0.0, &moved(-h), &mut low);
        for i in (2..x.len()).step_by(3) {
            let want = (up[i] - low[i]) / (2.0 * h);
            let row = &dense.values[i * x.len()..(i + 1) * x.len()];
            let found: f64 = row.iter().zip(&down).map(|(k, d)| k * d).sum();
            let scale = dense.values.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
            assert!((found - want).abs() < 1e-5 * scale, "{i}: {found} {want}");
        }
    }
}
