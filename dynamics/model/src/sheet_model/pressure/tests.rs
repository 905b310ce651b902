use super::*;
use crate::sheet_model::follower::tests::{check_derivatives, crumpled};
use crate::sheet_model::volume::tests::octahedron;
use isosheet_materials::potential::Force;
use isosheet_materials::vectors::point;
use isosheet_mesh::{MassKind, Sheet};
use nalgebra::Vector3;

#[test]
fn derivatives_are_those_of_differences() {
    let sheet = crumpled();
    let corners = LoadedFaces::all(sheet.topology()).expect("faces").corners;
    let size = Profile::Constant(3.0);
    check_derivatives(&OpenPressure { corners, size }, sheet.positions());
}

/// Both forms of the pressure push each face along the normal of its front, a third on each corner.
#[test]
fn a_pressure_pushes_along_normals() {
    let (topology, x) = octahedron();
    let faces = LoadedFaces::all(&topology).expect("faces");
    let mut wanted = vec![0.0; x.len()];
    for face in topology.faces() {
        let [a, b, c] = face.map(|v| point(&x, v));
        let share: Vector3<f64> = 40.0 / 6.0 * (b - a).cross(&(c - a));
        face.iter().for_each(|v| add(&mut wanted, *v, &share));
    }
    let open = OpenPressure {
        corners: faces.corners.clone(),
        size: 40.0.into(),
    };
    let mut found = vec![0.0; x.len()];
    Follower(Arc::new(open)).add_force(0.0, &x, &[], &mut found);
    let sheet = Sheet::from_topology(topology, x.clone()).expect("a sheet");
    let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).expect("a model");
    let model = model.with_pressure(faces, 40.0).expect("a pressure");
    let mut potential = vec![0.0; x.len()];
    model.potential_force(0.0, &x, &mut potential);
    for (i, w) in wanted.iter().enumerate() {
        assert!((found[i] - w).abs() < 1e-12, "{i}");
        assert!((potential[i] - w).abs() < 1e-12, "{i}");
    }
    let mut none = vec![0.0; x.len()];
    model.applied_force(0.0, &x, &none.clone(), &mut none);
    assert_eq!(none, vec![0.0; x.len()]);
}
