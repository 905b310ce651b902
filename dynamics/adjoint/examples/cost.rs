//! What gradients cost beside their runs, in CPU seconds: `cargo run -p isosheet-adjoint --example cost`.

use cpu_time::ProcessTime;
use isosheet_adjoint::{AdjointOptions, Family, Plan, Run, Scene, SceneError, coordinate};
use isosheet_collide::{Coefficients, Contacts, Obstacle, Shape};
use isosheet_dynamics::{Material, Method, SheetModel, State};
use isosheet_mesh::{FaceId, MassKind, VertexId, generate};

fn rods(p: &[f64]) -> Result<Scene, SceneError> {
    let sheet = generate::isotropic_square(3, 0.2)?;
    let sheet = sheet.map_positions(|[x, y, _]| [x, y, 2.0 * x * (x - 0.3 * y) + y * y])?;
    let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
        .with_acceleration([0.0, 0.0, -p[0]])
        .with_pins(&[VertexId(0)])?;
    Ok(Scene::new(
        model,
        State::at_rest(sheet.positions().to_vec()),
    ))
}

fn paper(p: &[f64], size: u32) -> Result<Scene, SceneError> {
    let sheet = generate::isotropic_square(size, 0.3)?;
    let mut material = Material::office_paper();
    material.rigidity = p[1];
    let model = SheetModel::of_material(&sheet, &material)
        .clamped(&[VertexId(0)])
        .build()?
        .with_acceleration([0.0, 0.0, -p[0]]);
    Ok(Scene::new(
        model,
        State::at_rest(sheet.positions().to_vec()),
    ))
}

/// Gravity, and the rigidities of patches, each of as many faces in their order.
fn patches(p: &[f64], size: u32) -> Result<Scene, SceneError> {
    let sheet = generate::isotropic_square(size, 0.3)?;
    let faces: Vec<FaceId> = sheet.topology().face_ids().collect();
    let own = faces.chunks(faces.len().div_ceil(p.len() - 1));
    let of = |rigidity: f64| {
        let mut material = Material::office_paper();
        material.rigidity = rigidity;
        material
    };
    let mut builder = SheetModel::of_material(&sheet, &of(p[1])).clamped(&[VertexId(0)]);
    for (own, rigidity) in own.zip(&p[1..]) {
        builder = builder.with_patch(own.to_vec(), &of(*rigidity));
    }
    let model = builder.build()?.with_acceleration([0.0, 0.0, -p[0]]);
    Ok(Scene::new(
        model,
        State::at_rest(sheet.positions().to_vec()),
    ))
}

fn drape(p: &[f64]) -> Result<Scene, SceneError> {
    let square = generate::isotropic_square(3, 0.3)?;
    let sheet = square.map_positions(|[x, y, _]| [x - 0.15, y - 0.15, 0.11])?;
    let mut material = Material::office_paper();
    material.rigidity = p[1];
    let model = SheetModel::of_material(&sheet, &material)
        .build()?
        .with_acceleration([0.0, 0.0, -p[0]]);
    let ball = Obstacle::at(Shape::Sphere { radius: 0.1 }, [0.0, 0.003, 0.0])?;
    let contacts = Contacts::for_sheet(&model, [ball], Coefficients::equal(0.3))?;
    let start = State::at_rest(sheet.positions().to_vec());
    Ok(Scene::new(model, start).with_contact(contacts))
}

fn measure(
    name: &str,
    family: &dyn Family,
    numbers: &[f64],
    count: usize,
) -> Result<(), SceneError> {
    let plan = Plan::steps(Method::default(), 1.0 / 60.0, count);
    let begin = ProcessTime::now();
    let Scene {
        model,
        start,
        contact,
    } = family.scene(numbers)?;
    let mut simulation = isosheet_dynamics::Simulation::new(model, start, plan.method.clone())?;
    if let Some(contact) = contact {
        simulation = simulation.with_boxed_contact(contact)?;
    }
    let vertices = simulation.state().x.len() / 3;
    let (mut iterations, mut factorisations) = (0, 0);
    for h in &plan.steps {
        let report = simulation.step(*h)?;
        iterations += report.iterations;
        factorisations += report.factorisations;
    }
    let plain = begin.elapsed().as_secs_f64();
    let begin = ProcessTime::now();
    let run = Run::record(family, numbers, plan, AdjointOptions::default())?;
    let recorded = begin.elapsed().as_secs_f64();
    let begin = ProcessTime::now();
    let gradient = run.gradient(&coordinate(vertices - 1, 2, count))?;
    let back = begin.elapsed().as_secs_f64();
    println!(
        "{name}: {vertices} vertices, run {plain:.3} s ({iterations} iterations, {factorisations} \
         factorisations), recorded {recorded:.3} s, gradient by {} numbers {back:.3} s = {:.2} runs; {:?}",
        numbers.len(),
        back / plain,
        gradient.effort
    );
    Ok(())
}

fn main() -> Result<(), SceneError> {
    measure("rods", &rods, &[9.8], 60)?;
    measure("paper", &|p: &[f64]| paper(p, 3), &[9.8, 5e-4], 60)?;
    measure("paper", &|p: &[f64]| paper(p, 4), &[9.8, 5e-4], 60)?;
    let of_patches = (0..29).map(|k| 5e-4 * (1.0 + 1e-2 * f64::from(k)));
    let many: Vec<f64> = [9.8].into_iter().chain(of_patches).collect();
    for count in [60, 240] {
        measure("patches", &|p: &[f64]| patches(p, 3), &many, count)?;
    }
    measure("drape", &drape, &[9.8, 5e-4], 60)?;
    Ok(())
}
