//! A plate that several models have.

use isosheet_dynamics::{CouplingKind, HessianSink, PlateBending, Potential, PotentialShape};
use isosheet_mesh::VertexId;
use std::sync::Arc;

/// The bending stiffness of a plate that does not yield, and so has no memory: models can share it.
#[derive(Clone, Debug)]
pub(super) struct SharedPlate(Arc<PlateBending>);

impl SharedPlate {
    pub(super) fn new(plate: PlateBending) -> Self {
        Self(Arc::new(plate))
    }
}

impl Potential for SharedPlate {
    fn energy(&self, t: f64, x: &[f64]) -> f64 {
        self.0.energy(t, x)
    }

    fn add_gradient(&self, t: f64, x: &[f64], gradient: &mut [f64]) {
        self.0.add_gradient(t, x, gradient);
    }

    fn add_hessian(&self, t: f64, x: &[f64], hessian: &mut dyn HessianSink) {
        self.0.add_hessian(t, x, hessian);
    }

    fn add_semidefinite_hessian(&self, t: f64, x: &[f64], hessian: &mut dyn HessianSink) {
        self.0.add_semidefinite_hessian(t, x, hessian);
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        self.0.couplings()
    }

    fn coupling_kind(&self) -> CouplingKind {
        self.0.coupling_kind()
    }

    fn add_bending_energies(&self, x: &[f64], faces: &mut [f64]) {
        self.0.add_bending_energies(x, faces);
    }

    fn shape(&self) -> PotentialShape {
        self.0.shape()
    }
}
