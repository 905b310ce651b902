//! Gradients of runs without contact.

use crate::support::{bdf2, checked, exact};
use isosheet_adjoint::{Plan, Scene, SceneError, coordinate};
use isosheet_dynamics::{ElasticSheet, Method, SheetModel, State};
use isosheet_mesh::{MassKind, VertexId, generate};

/// A sheet of rods that hangs by a corner and swings: its mass, gravity, and where the corner moves to.
#[test]
fn hanging_rods() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::isotropic_square(2, 0.2)?;
        let corner = VertexId(0);
        let [x, y, z] = sheet.position(corner);
        let (lift, push) = (p[1], p[2]);
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_acceleration([0.0, push, -p[0]])
            .with_moving_pin(corner, move |t: f64| [x, y, z + lift * t * t])?;
        Ok(Scene::new(model, State::at_rest(sheet.positions().to_vec())))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 12);
    let loss = coordinate(40, 2, 12);
    checked("hanging rods", &family, &[9.8, 0.3, 0.2], &plan, &loss, 1e-6);
}

/// An elastic membrane that hangs by two corners.
#[test]
fn hanging_membrane() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::isotropic_square(2, 0.2)?;
        let model = SheetModel::new(&sheet, p[2], MassKind::Lumped)?
            .with_acceleration([0.0, 0.1, -p[0]])
            .with_pins(&[VertexId(0), VertexId(8)])?
            .with_elastic_sheet(ElasticSheet::new(&sheet, p[1], 0.3)?)?;
        Ok(Scene::new(model, State::at_rest(sheet.positions().to_vec())))
    };
    for (name, method) in [
        ("hanging membrane, BDF2", bdf2()),
        ("hanging membrane, Euler", Method::ImplicitEuler(exact())),
    ] {
        let plan = Plan::steps(method, 1e-2, 12);
        let loss = coordinate(40, 2, 12);
        checked(name, &family, &[9.8, 30.0, 4e-3], &plan, &loss, 1e-6);
    }
}
