//! Whether potentials name the vertices that they couple.

use crate::hessian::HessianSink;
use crate::potential::At;
use crate::report::simulation_error::SimulationError;
use crate::{SheetModel, State};
use isosheet_mesh::{EdgeId, VertexId};
use nalgebra::{Matrix3, Vector3};
use std::collections::HashSet;

/// Refuses a potential whose Hessian at the start has a block of a pair that its
/// [`Potential::couplings`](crate::Potential::couplings) do not name, or of a vertex or an edge that the sheet has not: the
/// matrix of a step has no place for it.
///
/// # Errors
/// [`SimulationError::Coupling`].
pub(super) fn check_couplings(model: &SheetModel, state: &State) -> Result<(), SimulationError> {
    let topology = model.topology();
    for (index, potential) in model.potentials().enumerate() {
        let named = potential.couplings().into_iter();
        let mut blocks = NamedBlocks {
            named: named.map(sorted).collect(),
            vertices: topology.vertex_count(),
            edges: topology.edge_count(),
            unknown: None,
        };
        let memory = potential
            .remembering()
            .map_or_else(Vec::new, |p| p.memory());
        potential.add_hessian(At::new(state.t, &state.x).with_memory(&memory), &mut blocks);
        let out_of_range = blocks
            .named
            .iter()
            .flatten()
            .find(|v| v.index() >= blocks.vertices);
        let unknown = out_of_range
            .map(|v| format!("{v} in its couplings"))
            .or(blocks.unknown);
        if let Some(block) = unknown {
            return Err(SimulationError::Coupling { index, block });
        }
    }
    Ok(())
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

/// Compares the blocks of a potential with those that there are.
struct NamedBlocks {
    named: HashSet<[VertexId; 2]>,
    vertices: usize,
    edges: usize,
    /// The first block that has no place, in words.
    unknown: Option<String>,
}

impl NamedBlocks {
    fn require(&mut self, is_known: bool, what: impl FnOnce() -> String) {
        if !is_known {
            self.unknown.get_or_insert_with(what);
        }
    }
}

impl HessianSink for NamedBlocks {
    fn add_vertex(&mut self, v: VertexId, _: &Matrix3<f64>) {
        self.require(v.index() < self.vertices, || format!("{v}"));
    }

    fn add_edge(&mut self, e: EdgeId, _: &Matrix3<f64>) {
        self.require(e.index() < self.edges, || format!("edge {}", e.index()));
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, _: &Matrix3<f64>) {
        let is_known = self.named.contains(&sorted([a, b]));
        self.require(is_known, || format!("the pair of {a} and {b}"));
    }

    fn add_square(&mut self, _: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        for (v, _) in gradient {
            self.require(v.index() < self.vertices, || format!("{v}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, Potential, Simulation};
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
        let Some(SimulationError::Coupling { index: 0, block }) = found else {
            panic!("{found:?}")
        };
        assert!(block == "the pair of vertex 0 and vertex 24", "{block}");
        let found = start(vec![], vec![[VertexId(0), VertexId(1000)]]);
        assert!(matches!(found, Some(SimulationError::Coupling { .. })));
    }
}
