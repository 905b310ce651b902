//! Gradients of runs without contact.

use crate::support::{bdf2, checked, exact};
use isosheet_adjoint::{Plan, Scene, SceneError, coordinate};
use isosheet_dynamics::{
    ElasticSheet, Material, Method, PlateBending, PlateStiffness, SheetModel, State,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};

/// A sheet that is curved in two directions, so that no rod depends on others.
fn shell() -> Result<Sheet, SceneError> {
    let square = generate::isotropic_square(2, 0.2)?;
    let lifted = square.map_positions(|[x, y, _]| [x, y, 2.0 * x * (x - 0.3 * y) + y * y])?;
    Ok(lifted)
}

/// A shell of rods that hangs by a corner: gravity, a wind of acceleration, and where the corner moves to.
#[test]
fn hanging_rods() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = shell()?;
        let corner = VertexId(0);
        let [x, y, z] = sheet.position(corner);
        let (lift, push) = (p[1], p[2]);
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_acceleration([0.0, push, -p[0]])
            .with_moving_pin(corner, move |t: f64| [x, y, z + lift * t * t])?;
        Ok(Scene::new(model, State::at_rest(sheet.positions().to_vec())))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 8);
    let loss = coordinate(40, 2, 8);
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
            .with_elastic_sheet(ElasticSheet::new(&sheet, p[1], p[3])?)?;
        Ok(Scene::new(model, State::at_rest(sheet.positions().to_vec())))
    };
    for (name, method) in [
        ("hanging membrane, BDF2", bdf2()),
        ("hanging membrane, Euler", Method::ImplicitEuler(exact())),
    ] {
        let plan = Plan::steps(method, 1e-2, 12);
        let loss = coordinate(40, 2, 12);
        let numbers = [9.8, 300.0, 4e-3, 0.3];
        checked(name, &family, &numbers, &plan, &loss, 1e-6);
    }
}

/// A strip of paper that is clamped at one end and bends under its weight: rigidity, stiffness, Poisson's
/// ratio, density.
#[test]
fn clamped_paper() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(10, 3, 0.2, 0.06)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
        let mut material = Material::office_paper();
        material.rigidity = p[0];
        material.stiffness = p[1];
        material.poisson = p[2];
        material.density = p[3];
        let model = SheetModel::of_material(&sheet, &material)
            .clamped(&clamp)
            .build()?
            .with_acceleration([0.0, 0.0, -p[4]]);
        Ok(Scene::new(model, State::at_rest(sheet.positions().to_vec())))
    };
    let paper = Material::office_paper();
    let numbers = [paper.rigidity, paper.stiffness, paper.poisson, paper.density, 9.8];
    for (name, method, h) in [
        ("clamped paper, BDF2", bdf2(), 1e-2),
        ("clamped paper, at rest", Method::Equilibrium(exact()), 1.0),
    ] {
        let count = if h < 1.0 { 10 } else { 1 };
        let plan = Plan::steps(method, h, count);
        let loss = coordinate(10, 2, count);
        checked(name, &family, &numbers, &plan, &loss, 1e-6);
    }
}

/// A plate without a membrane's slack: rods, with a plate.
#[test]
fn rods_with_a_plate() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = shell()?;
        let plate = PlateStiffness {
            rigidity: p[0],
            poisson: p[1],
        };
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_gravity()
            .with_pins(&[VertexId(0)])?
            .with_potential(PlateBending::new(&sheet, plate)?);
        Ok(Scene::new(model, State::at_rest(sheet.positions().to_vec())))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 6);
    let loss = coordinate(40, 2, 6);
    checked("rods with a plate", &family, &[5e-4, 0.3], &plan, &loss, 1e-6);
}
