//! Membrane stiffness of an elastic sheet.

use crate::constraint::rows::point;
use crate::{HessianSink, Potential};
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, EdgeId, Sheet, VertexId};
use nalgebra::{Matrix3, Vector2, Vector3};

/// Why the membrane of a sheet cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MembraneError {
    /// The stiffness is not positive or not finite.
    #[error("the membrane stiffness is {stiffness} N/m", stiffness = given(*stiffness))]
    Stiffness {
        /// The stiffness given, N/m.
        stiffness: f64,
    },
    /// Poisson's ratio is out of range.
    #[error("Poisson's ratio is {ratio}", ratio = given(*ratio))]
    Poisson {
        /// The ratio given.
        ratio: f64,
    },
}

impl Advice for MembraneError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Stiffness { .. } => Some("give a finite one above 0"),
            Self::Poisson { .. } => Some("give a value from 0 to 0.5"),
        }
    }
}

/// Elastic energy of a sheet that stretches in its plane (St. Venant and Kirchhoff, plane stress, one
/// constant strain for each face),
///
/// ```text
/// V(x) = 1/2 sum_T A_T K [ (1 - nu) |E_T|^2 + nu (tr E_T)^2 ],     K = E h / (1 - nu^2),
/// ```
///
/// with the rest areas `A_T`, Green's strain `E_T` of the face, Young's modulus times thickness `E h`
/// (newtons per metre; office paper 3e5) and Poisson's ratio `nu`. Green's strain is linear in the length
/// errors of the three edges `c_e = (|x_a - x_b|^2 - l_e^2) / 2`: for the vector `e` of an edge at rest, `e^T
/// E_T e = c_e`.
///
/// Rigid rods are the limit `E h -> infinity`: strains and the distance from the motion of rods, where that
/// exists, are of first order in `1 / (E h)`. As rods do, a stiff membrane locks on coarse meshes: bends that
/// the mesh cannot follow by folding stretch the sheet. With the bending stiffness `D` and edges of length
/// `l` a stiffness of about `100 D / l^2` leaves bends free.
#[derive(Debug)]
pub struct Membrane {
    faces: Vec<Face>,
}

#[derive(Debug)]
struct Face {
    edges: [EdgeId; 3],
    /// First and second end of each edge.
    ends: [[VertexId; 2]; 3],
    squared_lengths: [f64; 3],
    /// `V_T = c^T stiffness c / 2`, newtons per cubic metre.
    stiffness: Matrix3<f64>,
}

impl Membrane {
    /// A membrane at rest in the shape of `sheet`; `stiffness` is `E h` in newtons per metre.
    ///
    /// # Errors
    /// [`MembraneError`].
    pub fn new(sheet: &Sheet, stiffness: f64, poisson: f64) -> Result<Self, MembraneError> {
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(MembraneError::Stiffness { stiffness });
        }
        if !(0.0..=0.5).contains(&poisson) {
            return Err(MembraneError::Poisson { ratio: poisson });
        }
        let faces = sheet.topology().face_ids().map(|f| {
            let topology = sheet.topology();
            let edges = topology.face_edges(f);
            let lengths = edges.map(|e| sheet.lengths()[e.index()]);
            let area = sheet.face_areas()[f.index()];
            Face {
                edges,
                ends: edges.map(|e| topology.edges()[e.index()]),
                squared_lengths: lengths.map(|l| l * l),
                stiffness: face_stiffness(lengths, area, stiffness, poisson),
            }
        });
        Ok(Self {
            faces: faces.collect(),
        })
    }
}

/// The energy of a face by the length errors of its edges, given their lengths.
fn face_stiffness(lengths: [f64; 3], area: f64, stiffness: f64, nu: f64) -> Matrix3<f64> {
    let [a, b, c] = lengths;
    // The edges as vectors that close.
    let along = (a * a + b * b - c * c) / (2.0 * a);
    let first = Vector2::new(a, 0.0);
    let second = Vector2::new(-along, 2.0 * area / a);
    let third = -(first + second);
    // Rows: `e^T E e` by the components (11, 12, 22) of the strain.
    let row = |e: Vector2<f64>| [e.x * e.x, 2.0 * e.x * e.y, e.y * e.y];
    let errors = Matrix3::from_rows(
        &[row(first), row(second), row(third)].map(|r| Vector3::from(r).transpose()),
    );
    let strains = errors.try_inverse().unwrap_or_else(Matrix3::zeros);
    let k = area * stiffness / (1.0 - nu * nu);
    let law = k * Matrix3::new(1.0, 0.0, nu, 0.0, 2.0 * (1.0 - nu), 0.0, nu, 0.0, 1.0);
    strains.transpose() * law * strains
}

/// The state of a face: edge vectors, length errors and the derivatives of the energy by these.
struct Strained {
    vectors: [Vector3<f64>; 3],
    errors: Vector3<f64>,
    /// `dV/dc`, newtons per metre.
    forces: Vector3<f64>,
}

impl Face {
    fn at(&self, x: &[f64]) -> Strained {
        let vectors = self.ends.map(|[a, b]| point(x, a) - point(x, b));
        let error = |k: usize| 0.5 * (vectors[k].norm_squared() - self.squared_lengths[k]);
        let errors = Vector3::new(error(0), error(1), error(2));
        Strained {
            forces: self.stiffness * errors,
            vectors,
            errors,
        }
    }

    /// Adds the Hessian with the given force density of each edge.
    fn add_hessian(
        &self,
        strained: &Strained,
        densities: Vector3<f64>,
        hessian: &mut dyn HessianSink,
    ) {
        for i in 0..3 {
            let [a, b] = self.ends[i];
            let own = densities[i] * Matrix3::identity();
            for v in [a, b] {
                hessian.add_vertex(v, &own);
            }
            hessian.add_edge(self.edges[i], &-own);
            for j in 0..3 {
                let d = &strained.vectors;
                let block = self.stiffness[(i, j)] * d[i] * d[j].transpose();
                self.add_product([i, j], &block, hessian);
            }
        }
    }

    /// Adds the block of the product of the gradients of the length errors of edges `i` and `j`.
    fn add_product(&self, [i, j]: [usize; 2], block: &Matrix3<f64>, hessian: &mut dyn HessianSink) {
        for (p, sp) in self.ends[i].into_iter().zip([1.0, -1.0]) {
            for (q, sq) in self.ends[j].into_iter().zip([1.0, -1.0]) {
                let signed = sp * sq * block;
                if p == q {
                    hessian.add_vertex(p, &signed);
                    continue;
                }
                // Each pair comes twice, once in each order: the one from the first to the second end counts.
                let edge = (0..3).find(|&k| self.ends[k] == [p, q]);
                if let Some(k) = edge {
                    hessian.add_edge(self.edges[k], &signed);
                }
            }
        }
    }
}

impl Potential for Membrane {
    fn energy(&self, _t: f64, x: &[f64]) -> f64 {
        let energy = |f: &Face| {
            let strained = f.at(x);
            0.5 * strained.errors.dot(&strained.forces)
        };
        self.faces.iter().map(energy).sum()
    }

    fn add_gradient(&self, _t: f64, x: &[f64], gradient: &mut [f64]) {
        for f in &self.faces {
            let strained = f.at(x);
            for (k, [a, b]) in f.ends.into_iter().enumerate() {
                let force = strained.forces[k] * strained.vectors[k];
                for c in 0..3 {
                    gradient[3 * a.index() + c] += force[c];
                    gradient[3 * b.index() + c] -= force[c];
                }
            }
        }
    }

    fn add_hessian(&self, _t: f64, x: &[f64], hessian: &mut dyn HessianSink) {
        for f in &self.faces {
            let strained = f.at(x);
            f.add_hessian(&strained, strained.forces, hessian);
        }
    }

    /// With the curvature of edges under tension alone.
    fn add_semidefinite_hessian(&self, _t: f64, x: &[f64], hessian: &mut dyn HessianSink) {
        for f in &self.faces {
            let strained = f.at(x);
            f.add_hessian(&strained, strained.forces.map(|d| d.max(0.0)), hessian);
        }
    }
}

#[cfg(test)]
mod tests;
