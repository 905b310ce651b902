//! The forces of the supports of a scene.

use crate::Origins;
use crate::building::setup::Facts;
use isosheet_dynamics::{Reaction, Simulation, Support};
use isosheet_mesh::VertexId;
use nalgebra::{DMatrix, Vector3};
use std::collections::HashMap;
use std::sync::Arc;

/// How the forces of a simulation give the forces of the supports of its scene.
///
/// A vertex that rods to held ones keep in place ([`Simulation::immobile_vertices`]), such as one on the
/// straight edge of a banner between two corners, has a force of its own in the simulation, which its rods
/// hand on to the supports. They do so as strings of equal tension would: with the lengths `l` of the rods,
/// the shares `w` of a support obey `sum (w_i - w_j) / l_ij = 0` at each such vertex i, are one at the
/// vertices of this support and zero at the vertices of the others. On a straight line of rods this is the
/// law of the lever. The shares of all supports add up to one, so that the forces balance the weight.
#[derive(Clone, Debug)]
pub struct SupportForces {
    facts: Arc<Facts>,
    /// The vertices of each support.
    vertices: Vec<Vec<VertexId>>,
    /// The shares of the supports at each vertex that is kept in place.
    shares: HashMap<VertexId, Vec<f64>>,
}

impl SupportForces {
    /// The forces of the first `count` supports of a scene.
    pub fn new(facts: Arc<Facts>, simulation: &Simulation, count: usize) -> Self {
        let origins = &facts.origins;
        let shares = shares(origins, simulation, count).unwrap_or_default();
        Self {
            vertices: origins.vertices(simulation.model(), count),
            facts,
            shares,
        }
    }

    /// Force of each support on the sheet in the last step, newtons; zero before the first one.
    pub fn of(&self, simulation: &Simulation) -> Vec<[f64; 3]> {
        self.loads(simulation).map(|load| load.force).collect()
    }

    /// Force and torque of each support on the sheet in the last step.
    pub fn loads(&self, simulation: &Simulation) -> impl Iterator<Item = SupportLoad> {
        let x = &simulation.state().x;
        let place = |v: VertexId| Vector3::from_column_slice(&x[3 * v.index()..3 * v.index() + 3]);
        let means = self.vertices.iter().map(|vertices| {
            let sum: Vector3<f64> = vertices.iter().map(|v| place(*v)).sum();
            sum / vertices.len().max(1) as f64
        });
        let means: Vec<Vector3<f64>> = means.collect();
        let mut loads = vec![[Vector3::zeros(); 2]; self.vertices.len()];
        for Reaction { support, force } in simulation.reactions() {
            match (self.facts.origins.support(support), support) {
                (Some(number), _) if number < loads.len() => {
                    let [sum, torque] = &mut loads[number];
                    *sum += force;
                    *torque += (place(support.vertex()) - means[number]).cross(&force);
                }
                (None, Support::Pin(vertex)) => {
                    // Rods hand these forces on to the supports.
                    let shares = self.shares.get(&vertex).into_iter().flatten();
                    for ([sum, _], share) in loads.iter_mut().zip(shares) {
                        *sum += *share * force;
                    }
                }
                _ => {}
            }
        }
        let clamps = self.facts.origins.clamps.iter();
        for (number, moment) in clamps.zip(simulation.clamp_moments()) {
            if let Some([_, torque]) = loads.get_mut(*number) {
                *torque += Vector3::from(moment);
            }
        }
        loads.into_iter().map(|[force, torque]| SupportLoad {
            force: force.into(),
            torque: torque.into(),
        })
    }
}

/// What a support does to the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportLoad {
    /// Force, newtons.
    pub force: [f64; 3],
    /// Torque about the mean of the places of its vertices, newton metres.
    pub torque: [f64; 3],
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
