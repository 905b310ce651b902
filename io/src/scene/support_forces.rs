//! The forces of the supports of a scene.

use super::Origins;
use isosheet_dynamics::{Reaction, Simulation, Support};
use isosheet_mesh::VertexId;
use nalgebra::{DMatrix, Vector3};
use std::collections::HashMap;

/// How the forces of a simulation are those of the supports of its scene.
///
/// A vertex that rods to held ones keep in place ([`Simulation::immobile_vertices`]), such as one on the
/// straight edge of a banner between two corners, has a force of its own in the simulation, which its rods
/// hand on to the supports. They do so as strings of equal tension would: with the lengths `l` of the rods,
/// the shares `w` of a support obey `sum (w_i - w_j) / l_ij = 0` at each such vertex i, are one at the
/// vertices of this support and zero at those of the others. On a straight line of rods this is the law of
/// the lever. The shares of all supports add up to one, so that the forces balance the weight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SupportForces {
    origins: Origins,
    /// Number of supports.
    count: usize,
    /// The shares of the supports at each vertex that is kept in place.
    shares: HashMap<VertexId, Vec<f64>>,
}

impl SupportForces {
    /// For the first `count` supports of a scene.
    pub fn new(origins: Origins, simulation: &Simulation, count: usize) -> Self {
        let shares = shares(&origins, simulation, count).unwrap_or_default();
        Self {
            origins,
            count,
            shares,
        }
    }

    /// Force of each support on the sheet in the last step, newtons; zero before the first one.
    pub fn of(&self, simulation: &Simulation) -> Vec<[f64; 3]> {
        let mut forces = vec![Vector3::zeros(); self.count];
        for Reaction { support, force } in simulation.reactions() {
            match (self.origins.support(support), support) {
                (Some(number), _) if number < self.count => forces[number] += force,
                (None, Support::Pin(vertex)) => {
                    let shares = self.shares.get(&vertex).into_iter().flatten();
                    for (sum, share) in forces.iter_mut().zip(shares) {
                        *sum += *share * force;
                    }
                }
                _ => {}
            }
        }
        forces.into_iter().map(Into::into).collect()
    }
}

/// The shares at the immobile vertices; `None` if there are none, or nothing holds some of them.
fn shares(
    origins: &Origins,
    simulation: &Simulation,
    count: usize,
) -> Option<HashMap<VertexId, Vec<f64>>> {
    let immobile = simulation.immobile_vertices();
    if immobile.is_empty() || count == 0 {
        return None;
    }
    let model = simulation.model();
    let (t, lengths) = (model.topology(), model.edges().lengths());
    let numbers = immobile.iter().enumerate().map(|(i, &v)| (v, i));
    let number: HashMap<VertexId, usize> = numbers.collect();
    let mut matrix = DMatrix::zeros(immobile.len(), immobile.len());
    let mut right = DMatrix::zeros(immobile.len(), count);
    for (edge, &[a, b]) in t.edges().iter().enumerate() {
        let tension = 1.0 / lengths[edge];
        for (v, other) in [(a, b), (b, a)] {
            let Some(&i) = number.get(&v) else { continue };
            let held = origins.support_of_vertex(model, other);
            match (number.get(&other), held) {
                (Some(&j), _) => matrix[(i, j)] -= tension,
                (None, Some(support)) if support < count => right[(i, support)] += tension,
                // A free vertex takes no part.
                _ => continue,
            }
            matrix[(i, i)] += tension;
        }
    }
    let solution = matrix.cholesky()?.solve(&right);
    let of = |(&v, &i): (&VertexId, &usize)| (v, solution.row(i).iter().copied().collect());
    Some(number.iter().map(of).collect())
}
