use super::*;
use crate::sheet_model::follower::tests::{check_derivatives, crumpled, wave};
use isosheet_materials::potential::Force;
use nalgebra::{Rotation3, Unit};

const ALONG: [f64; 3] = [1.0, -0.5, 2.0];

fn load(x: &[f64], vertices: &[VertexId]) -> TurningLoad {
    TurningLoad::new(crumpled().topology(), vertices, ALONG, 3.0, x).expect("a load")
}

fn forces(load: TurningLoad, x: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; x.len()];
    Follower(Arc::new(load)).add_force(0.0, x, &[], &mut forces);
    forces
}

#[test]
fn derivatives_are_those_of_differences() {
    let sheet = crumpled();
    let x = sheet.positions();
    let load = load(x, &[VertexId(0), VertexId(4), VertexId(7)]);
    let moved: Vec<f64> = x
        .iter()
        .enumerate()
        .map(|(i, x)| x + wave(0.02, i + 2))
        .collect();
    check_derivatives(&load, &moved);
}

/// At the start the loads are as they were asked for; where the sheet has turned, they have turned with it.
#[test]
fn the_load_turns_with_the_sheet() {
    let sheet = crumpled();
    let x = sheet.positions();
    let loaded = [VertexId(0), VertexId(4)];
    let axis = Unit::new_normalize(Vector3::new(0.3, -1.0, 0.4));
    let turn = Rotation3::from_axis_angle(&axis, 2.0);
    let turned: Vec<f64> = x
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| <[f64; 3]>::from(turn * Vector3::from(*p)))
        .collect();
    let wanted = 3.0 * Vector3::from(ALONG).normalize();
    for (x, wanted) in [(x, wanted), (&turned[..], turn * wanted)] {
        let found = forces(load(sheet.positions(), &loaded), x);
        for v in sheet.topology().vertex_ids() {
            let here = if loaded.contains(&v) {
                wanted
            } else {
                Vector3::zeros()
            };
            assert!((point(&found, v) - here).norm() < 1e-13, "{v}");
        }
    }
}
