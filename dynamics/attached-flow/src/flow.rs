//! The circulation of a lattice in the wind, and its forces.

use super::lattice::{Lattice, LatticeShape};
use super::vortex::segment;
use super::wake::Past;
use isosheet_dynamics::Wind;
use isosheet_linalg::{DenseLu, LinalgError};
use nalgebra::Vector3;

/// Radius of the core of the vortices of the wake, in shortest edges.
const CORE: f64 = 0.1;

/// A lattice in the air.
#[derive(Debug)]
pub(super) struct InAir {
    pub(super) lattice: Lattice,
    /// Kilograms per cubic metre.
    pub(super) density: f64,
    pub(super) wind: Wind,
}

/// The equations of the flow at the end of a step, in a place of the lattice: nothing flows through the faces
/// at their centres,
///
/// ```text
/// n_i . (w + sum_j q_ij Gamma_j + wake - v_i) = 0.
/// ```
///
/// The row of the wake that the step sheds is part of the sum, so that no vortex is at the trailing edges
/// (the condition of Kutta).
pub(super) struct Flow {
    pub(super) shape: LatticeShape,
    /// With the line that the step sheds.
    past: Past,
    matrix: DenseLu,
    /// Velocity of the air and of what is known of the wake along the normals.
    wash: Vec<f64>,
}

impl Flow {
    /// What is remembered after the step, whose end is at a time (seconds).
    pub(super) fn settled(self, t: f64, circulation: Vec<f64>) -> Past {
        self.past.settled(t, circulation)
    }
}

impl InAir {
    fn core(&self) -> f64 {
        CORE * self.lattice.size
    }

    fn wind(&self, at: &Vector3<f64>, t: f64) -> Vector3<f64> {
        self.wind.velocity((*at).into(), t).into()
    }

    /// The flow at a time (seconds) and positions (`3V`, metres) after a past that has been carried there,
    /// which grows.
    ///
    /// # Errors
    /// [`LinalgError::Singular`] where faces lie on each other or the wind is not finite.
    pub(super) fn flow(&self, past: &Past, t: f64, x: &[f64]) -> Result<Flow, LinalgError> {
        let lattice = &self.lattice;
        let shape = lattice.shape(x);
        let past = past.grown(&lattice.edge(&shape), &lattice.trailing);
        let count = lattice.faces.len();
        let mut matrix = vec![0.0; count * count];
        let mut wash = vec![0.0; count];
        let (core, line) = (self.core(), past.first_line());
        for (i, (at, normal)) in shape.centres.iter().zip(&shape.normals).enumerate() {
            let across = |ends: [&Vector3<f64>; 2], core: f64| normal.dot(&segment(at, ends, core));
            for edge in &lattice.edges {
                let velocity = across(edge.ends.map(|k| &shape.nodes[k]), 0.0);
                matrix[count * edge.left + i] += velocity;
                if let Some(right) = edge.right {
                    matrix[count * right + i] -= velocity;
                }
            }
            for trailing in &lattice.trailing {
                let [p, q] = trailing.points;
                let [from, to] = [p, q].map(|k| &shape.nodes[lattice.shedding[k]]);
                matrix[count * trailing.face + i] += across([to, from], 0.0)
                    + across([from, &line[p]], core)
                    + across([&line[p], &line[q]], core)
                    + across([&line[q], to], core);
            }
            let known = self.wind(at, t) + past.velocity(at, &lattice.trailing, core);
            wash[i] = normal.dot(&known);
        }
        if wash.iter().any(|w| !w.is_finite()) {
            let backward_error = f64::INFINITY;
            return Err(LinalgError::Singular {
                order: count,
                backward_error,
            });
        }
        let matrix = DenseLu::new(count, matrix)?;
        Ok(Flow {
            past,
            shape,
            matrix,
            wash,
        })
    }

    /// The circulation in the flow where the vertices have some velocities (`3V`, metres per second), square
    /// metres per second.
    pub(super) fn circulation(&self, flow: &Flow, v: &[f64]) -> Vec<f64> {
        let of_probes = self.lattice.at_probes(v);
        let through = |(i, (normal, wash)): (usize, (&Vector3<f64>, &f64))| {
            normal.dot(&self.lattice.at_centre(i, &of_probes)) - wash
        };
        let faces = flow.shape.normals.iter().zip(&flow.wash).enumerate();
        let mut circulation: Vec<f64> = faces.map(through).collect();
        flow.matrix.solve(&mut circulation);
        circulation
    }

    /// The derivatives of the circulation by the velocities of the vertices of the lattice: for each of these
    /// the columns of its three components.
    pub(super) fn circulation_derivative(&self, flow: &Flow) -> Vec<f64> {
        let count = self.lattice.faces.len();
        let mut columns = vec![0.0; 3 * self.lattice.vertices.len() * count];
        for (i, (corners, normal)) in self
            .lattice
            .faces
            .iter()
            .zip(&flow.shape.normals)
            .enumerate()
        {
            for (v, weight) in corners
                .iter()
                .flat_map(|node| self.lattice.probe_weights(*node))
            {
                for k in 0..3 {
                    columns[count * (3 * v + k) + i] += weight * normal[k] / 3.0;
                }
            }
        }
        flow.matrix.solve(&mut columns);
        columns
    }

    /// The forces on both ends of each ring edge by a unit of circulation along it (Kutta and Joukowski),
    /// newtons times seconds per square metre: the velocity of the air relative to the edge along the sheet,
    /// across the edge. Trailing edges have none.
    pub(super) fn edge_forces(&self, shape: &LatticeShape, t: f64, v: &[f64]) -> Vec<Vector3<f64>> {
        let of_nodes = self.lattice.at_nodes(v);
        let force = |edge: &super::lattice::RingEdge| {
            if edge.is_trailing {
                return Vector3::zeros();
            }
            let [a, b] = edge.ends;
            let middle = 0.5 * (shape.nodes[a] + shape.nodes[b]);
            let air = self.wind(&middle, t) - 0.5 * (of_nodes[a] + of_nodes[b]);
            let other = edge.right.map_or(Vector3::zeros(), |f| shape.normals[f]);
            let normal = shape.normals[edge.left] + other;
            let normal = normal.try_normalize(0.0).unwrap_or_default();
            let along = air - air.dot(&normal) * normal;
            0.5 * self.density * along.cross(&(shape.nodes[b] - shape.nodes[a]))
        };
        self.lattice.edges.iter().map(force).collect()
    }

    /// The force on each corner of a face by the rate of change of its circulation, newtons times square
    /// seconds per square metre.
    pub(super) fn rate_force(&self, shape: &LatticeShape, face: usize) -> Vector3<f64> {
        -self.density * shape.areas[face] / 3.0 * shape.normals[face]
    }

    /// The forces on the vertices of the lattice, newtons.
    pub(super) fn forces(
        &self,
        shape: &LatticeShape,
        edge_forces: &[Vector3<f64>],
        circulation: &[f64],
        rate: &[f64],
    ) -> Vec<Vector3<f64>> {
        let mut of_nodes = vec![Vector3::zeros(); shape.nodes.len()];
        for (edge, force) in self.lattice.edges.iter().zip(edge_forces) {
            let right = edge.right.map_or(0.0, |f| circulation[f]);
            for node in edge.ends {
                of_nodes[node] += (circulation[edge.left] - right) * force;
            }
        }
        for (face, corners) in self.lattice.faces.iter().enumerate() {
            let force = rate[face] * self.rate_force(shape, face);
            for node in corners {
                of_nodes[*node] += force;
            }
        }
        self.lattice.to_vertices(&of_nodes)
    }
}
