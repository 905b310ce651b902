//! What is wrong with the potentials of a model.

use super::derivatives::check_derivatives;
use crate::SheetModel;
use crate::contact::name_of;
use isosheet_materials::hessian::HessianSink;
use isosheet_materials::potential::{At, Memories, Potential};
use isosheet_mesh::{EdgeId, VertexId};
use isosheet_model::{BadPotential, PotentialFault};
use nalgebra::{Matrix3, Vector3};
use std::collections::HashSet;

/// Part of the gradient by which it may differ from central differences of the energy before it is called
/// wrong: these err by some 1e-9 where energies are smooth, and a gradient that is wrong in the third digit
/// changes no result that is measured.
pub(super) const WRONG: f64 = 1e-3;

/// Whether gradients are compared with differences of the energies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Differences {
    Skip,
    Compare,
}

/// The first potential that cannot be used at time `t` (seconds) and positions `x` (`3V`, metres): that is
/// not finite, whose Hessian has a block of a pair that its [`Potential::couplings`] do not name, or of a
/// vertex or an edge that the sheet has not, or whose gradient is not the derivative of its energy.
pub(crate) fn find_fault(
    model: &SheetModel,
    memories: &Memories,
    (t, x): (f64, &[f64]),
    differences: Differences,
) -> Option<BadPotential> {
    let all = model.potentials_at(t, x, memories).enumerate();
    let mut faults = all.filter_map(|(index, (potential, at))| {
        let fault = fault_of(potential, model, at, differences)?;
        let name = name_of(&potential);
        Some(BadPotential { index, name, fault })
    });
    faults.next()
}

fn fault_of(
    potential: &dyn Potential,
    model: &SheetModel,
    at: At<'_>,
    differences: Differences,
) -> Option<PotentialFault> {
    let topology = model.topology();
    let vertices = topology.vertex_count();
    let named = potential.couplings();
    if let Some(v) = named.iter().flatten().find(|v| v.index() >= vertices) {
        let block = format!("{v}");
        return Some(PotentialFault::Block { block });
    }
    let mut gradient = vec![0.0; at.x.len()];
    potential.add_gradient(at, &mut gradient);
    let energy = std::iter::once(potential.energy(at));
    let values = energy.map(|e| ("energy", e));
    let mut values = values.chain(gradient.iter().map(|g| ("gradient", *g)));
    if let Some((quantity, value)) = values.find(|(_, value)| !value.is_finite()) {
        return Some(PotentialFault::NotFinite { quantity, value });
    }
    let mut blocks = NamedBlocks {
        named: named.into_iter().map(sorted).collect(),
        vertices,
        edges: topology.edge_count(),
        fault: None,
    };
    potential.add_hessian(at, &mut blocks);
    // Near a limit the energy changes too fast for differences.
    let is_smooth = potential.limit().is_none();
    if blocks.fault.is_some() || differences == Differences::Skip || !is_smooth {
        return blocks.fault;
    }
    let part = check_derivatives(potential, topology, at).gradient;
    (part > WRONG).then_some(PotentialFault::Gradient { part })
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

/// Compares the blocks of a potential with the places in the matrix of a step.
struct NamedBlocks {
    named: HashSet<[VertexId; 2]>,
    vertices: usize,
    edges: usize,
    fault: Option<PotentialFault>,
}

impl NamedBlocks {
    fn take(&mut self, is_known: bool, values: &[f64], what: impl FnOnce() -> String) {
        if self.fault.is_some() {
            return;
        }
        let quantity = "Hessian";
        self.fault = match values.iter().find(|value| !value.is_finite()) {
            _ if !is_known => Some(PotentialFault::Block { block: what() }),
            Some(&value) => Some(PotentialFault::NotFinite { quantity, value }),
            None => None,
        };
    }
}

impl HessianSink for NamedBlocks {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        let is_known = v.index() < self.vertices;
        self.take(is_known, block.as_slice(), || format!("{v}"));
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        let is_known = e.index() < self.edges;
        self.take(is_known, block.as_slice(), || format!("{e}"));
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        let is_known = self.named.contains(&sorted([a, b]));
        let what = || format!("the pair of {a} and {b}");
        self.take(is_known, block.as_slice(), what);
    }

    fn add_square(&mut self, factor: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        for (v, g) in gradient {
            let is_known = v.index() < self.vertices;
            self.take(is_known, (factor * g).as_slice(), || format!("{v}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, Simulation, SimulationError, State, StepError};
    use isosheet_mesh::{MassKind, generate};

    /// Springs of no length and 1 N/m, between pairs of which it names some.
    #[derive(Debug)]
    struct Springs {
        pairs: Vec<[VertexId; 2]>,
        named: Vec<[VertexId; 2]>,
    }

    impl Springs {
        fn along(x: &[f64], [a, b]: [VertexId; 2]) -> Vector3<f64> {
            let point = |v: VertexId| Vector3::from_column_slice(&x[3 * v.index()..][..3]);
            point(b) - point(a)
        }
    }

    impl Potential for Springs {
        fn energy(&self, at: At<'_>) -> f64 {
            let pairs = self.pairs.iter();
            pairs
                .map(|p| 0.5 * Self::along(at.x, *p).norm_squared())
                .sum()
        }

        fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
            for &[a, b] in &self.pairs {
                let along = Self::along(at.x, [a, b]);
                for k in 0..3 {
                    gradient[3 * a.index() + k] -= along[k];
                    gradient[3 * b.index() + k] += along[k];
                }
            }
        }

        fn add_hessian(&self, _: At<'_>, hessian: &mut dyn HessianSink) {
            for &[a, b] in &self.pairs {
                hessian.add_vertex(a, &Matrix3::identity());
                hessian.add_vertex(b, &Matrix3::identity());
                hessian.add_pair(a, b, &-Matrix3::identity());
            }
        }

        fn couplings(&self) -> Vec<[VertexId; 2]> {
            self.named.clone()
        }
    }

    #[test]
    fn a_pair_that_is_not_named_is_refused_at_the_start() {
        let sheet = generate::isotropic_square(2, 1.0).unwrap();
        let far = [VertexId(0), VertexId(24)];
        let start = |pairs: Vec<[VertexId; 2]>, named: Vec<[VertexId; 2]>| {
            let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
            let model = model.with_potential(Springs { pairs, named });
            let state = State::at_rest(sheet.positions().to_vec());
            Simulation::new(model, state, Method::default()).err()
        };
        assert_eq!(start(vec![far], vec![[far[1], far[0]]]), None);
        let found = start(vec![far], vec![[VertexId(0), VertexId(12)]]);
        let Some(SimulationError::Start(StepError::Potential { bad, .. })) = found else {
            panic!("{found:?}")
        };
        let block = "the pair of vertex 0 and vertex 24".to_owned();
        let fault = PotentialFault::Block { block };
        assert_eq!(
            (bad.index, bad.name.as_str(), bad.fault),
            (0, "Springs", fault)
        );
        let found = start(vec![], vec![[VertexId(0), VertexId(1000)]]);
        assert!(matches!(
            found,
            Some(SimulationError::Start(StepError::Potential { .. }))
        ));
    }
}
