use super::*;
use crate::sheet_model::follower::tests::{check_derivatives, crumpled, wave};
use isosheet_materials::potential::Force;

fn moment(edges: &[EdgeId], axis: [f64; 3]) -> Result<EdgeMoment, LoadError> {
    let sheet = crumpled();
    EdgeMoment::new(sheet.topology(), edges, axis, 3.0, sheet.positions())
}

#[test]
fn derivatives_are_those_of_differences() {
    let sheet = crumpled();
    let x = sheet.positions().iter().enumerate();
    let moved: Vec<f64> = x.map(|(i, x)| x + wave(0.02, i + 2)).collect();
    let edges: Vec<EdgeId> = sheet.topology().edge_ids().collect();
    check_derivatives(&moment(&edges, [1.0, 0.7, 0.4]).expect("a moment"), &moved);
}

/// The forces at an edge add up to nothing, and turn about it by the moment: at one of the rim and within the
/// sheet, whichever direction the axis has along it.
#[test]
fn the_forces_are_a_couple_about_the_edge() {
    let sheet = crumpled();
    let (topology, x) = (sheet.topology(), sheet.positions());
    for edge in topology.edge_ids() {
        let [a, b] = topology.edges()[edge.index()].map(|v| point(x, v));
        let along = (b - a).normalize();
        for sign in [1.0, -1.0] {
            let moment = moment(&[edge], (sign * along).into()).expect("a moment");
            let mut forces = vec![0.0; x.len()];
            Follower(Arc::new(moment)).add_force(0.0, x, &[], &mut forces);
            let sum: Vector3<f64> = topology.vertex_ids().map(|v| point(&forces, v)).sum();
            assert!(sum.norm() < 1e-11, "{edge}: {sum}");
            let torque: Vector3<f64> = topology
                .vertex_ids()
                .map(|v| point(x, v).cross(&point(&forces, v)))
                .sum();
            assert!(
                (torque - 3.0 * sign * along).norm() < 1e-11,
                "{edge}: {torque}"
            );
        }
    }
}

#[test]
fn what_cannot_be_used_is_named() {
    let edge = EdgeId(0);
    let sheet = crumpled();
    let [a, b] = sheet.topology().edges()[0].map(|v| point(sheet.positions(), v));
    let across = (b - a).cross(&Vector3::new(0.1, 0.2, 0.5));
    let error = moment(&[edge], across.into()).expect_err("an axis across the edge");
    assert_eq!(error, LoadError::AcrossAxis { edge });
    assert_eq!(moment(&[], [1.0, 0.0, 0.0]), Err(LoadError::NoEdges));
    let error = moment(&[edge], [0.0; 3]).expect_err("no direction");
    assert!(matches!(error, LoadError::Direction { .. }));
}
