//! Inverse problems that gradients solve, against closed forms.

use isosheet::adjoint::{AdjointOptions, Family, Plan, Run, Scene, SceneError, coordinate};
use isosheet::dynamics::{
    CreaseSpring, CreaseSprings, Curl, Curvature, ImplicitOptions, Material, MaterialDirection,
    Method, NaturalTensor, SheetModel, State,
};
use isosheet::io::read_mesh;
use isosheet::mesh::{EdgeId, Sheet, generate};
use nalgebra::{DMatrix, DVector};
use std::path::Path;

/// A coordinate of a vertex at rest, and the value that it is to have.
type Target = (usize, usize, f64);

/// Numbers with which a scene at rest has some coordinates, the number of runs, and the largest difference,
/// metres: the method of Gauss and Newton, with a gradient of each coordinate from one run.
fn solved(family: &dyn Family, start: &[f64], targets: &[Target]) -> (Vec<f64>, usize, f64) {
    let options = ImplicitOptions {
        tolerance: Some(1e-10),
        ..ImplicitOptions::default()
    };
    let plan = Plan::steps(Method::Equilibrium(options), 1.0, 1);
    let mut numbers = start.to_vec();
    for runs in 1..=20 {
        let run = Run::record(family, &numbers, plan.clone(), AdjointOptions::default());
        let run = run.unwrap();
        let mut differences = DVector::zeros(targets.len());
        let mut jacobian = DMatrix::zeros(targets.len(), numbers.len());
        for (k, (vertex, axis, wanted)) in targets.iter().enumerate() {
            let gradient = run.gradient(&coordinate(*vertex, *axis, 1)).unwrap();
            differences[k] = gradient.value - wanted;
            jacobian.row_mut(k).copy_from_slice(&gradient.of_numbers);
        }
        let largest = differences.amax();
        if largest < 1e-9 {
            return (numbers, runs, largest);
        }
        let step = jacobian.svd(true, true).solve(&differences, 1e-12).unwrap();
        for (number, step) in numbers.iter_mut().zip(step.iter()) {
            *number -= step;
        }
    }
    panic!("not found: {numbers:?}");
}

/// A sheet that is clamped at x = 0 over a column of faces, at rest as it is made.
fn clamped(sheet: &Sheet, material: &Material, gravity: f64) -> Result<SheetModel, SceneError> {
    let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
    let model = SheetModel::of_material(sheet, material)
        .clamped(&clamp)
        .build()?;
    Ok(model.with_acceleration([0.0, 0.0, -gravity]))
}

fn paper() -> Material {
    let mut paper = Material::office_paper();
    (paper.rigidity, paper.stiffness, paper.poisson) = (3e-4, 3e4, 0.0);
    paper
}

/// Which rest shape is straight under its weight? A strip of thirty columns with a height for each: the moment
/// `q (L - s)^2 / 2` of the straight strip is that of its curvature at rest, so that its slope there is
/// `q (L^3 - (L - s)^3) / (6 D)`.
#[test]
fn a_rest_shape_that_its_weight_makes_straight() {
    let (columns, length, gravity) = (30, 0.12, 9.81);
    let cell = length / columns as f64;
    let grid = generate::anisotropic_grid(columns + 1, 1, length + cell, 0.01).unwrap();
    let line = |x: f64| (x / cell).round() as usize;
    // Heights of the lines behind the clamp; the edges along keep their lengths.
    let made = |p: &[f64]| -> Result<Sheet, SceneError> {
        let mut places = vec![[-cell, 0.0], [0.0, 0.0]];
        for height in p {
            let [x, z] = places[places.len() - 1];
            let rise = height - z;
            places.push([x + (cell * cell - rise * rise).max(0.0).sqrt(), *height]);
        }
        Ok(grid.map_positions(|[x, y, _]| {
            let [x, z] = places[line(x)];
            [x, y, z]
        })?)
    };
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = made(p)?;
        let model = clamped(&sheet, &paper(), gravity)?;
        Ok(Scene::new(
            model,
            State::at_rest(sheet.positions().to_vec()),
        ))
    };
    // The vertices of one side.
    let targets: Vec<Target> = (2..columns + 2).map(|k| (k, 2, 0.0)).collect();
    let (heights, runs, largest) = solved(&family, &vec![0.0; columns], &targets);
    println!("{runs} runs, {largest:e} m");
    assert!(runs <= 20, "{runs}");
    let weight = paper().density * gravity / (6.0 * paper().rigidity);
    let slope = |s: f64| weight * (length.powi(3) - (length - s).powi(3));
    let steps = 10_000;
    let rise = |k: usize| {
        let s = length * (k as f64 + 0.5) / f64::from(steps);
        slope(s).sin() * length / f64::from(steps)
    };
    let tip: f64 = (0..steps as usize).map(rise).sum();
    let found = heights[columns - 1];
    // The mesh errs by a part of the second order of its columns.
    assert!((found / tip - 1.0).abs() < 5e-3, "{found} {tip}");
}

/// Which curl of four patches makes a given developable surface? A cylinder of other curvatures from patch to
/// patch, whose lines across are where arcs lead.
#[test]
fn the_curl_of_patches_that_makes_a_developable_surface() {
    let (columns, length) = (40, 0.2);
    let cell = length / columns as f64;
    let sheet = generate::anisotropic_grid(columns + 1, 1, length + cell, 0.02).unwrap();
    let sheet = sheet.map_positions(|[x, y, z]| [x - cell, y, z]).unwrap();
    let t = sheet.topology();
    let patch = |x: f64| ((4.0 * x / length).floor().max(0.0) as usize).min(3);
    let patches: Vec<usize> = t
        .faces()
        .iter()
        .map(|face| patch(face.iter().map(|v| sheet.position(*v)[0]).sum::<f64>() / 3.0))
        .collect();
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let along = |patch: &usize| Curvature {
            along: p[*patch],
            ..Curvature::default()
        };
        let curl = Curl {
            direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
            curvature: NaturalTensor::Faces(patches.iter().map(along).collect()),
            profile: 1.0.into(),
        };
        let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
        let model = SheetModel::of_material(&sheet, &paper())
            .clamped(&clamp)
            .curled(curl)
            .build()?;
        Ok(Scene::new(
            model,
            State::at_rest(sheet.positions().to_vec()),
        ))
    };
    let curvatures = [6.0, -3.0, 8.0, 2.0];
    // Where the surface is at the ends of the patches: arcs of a quarter of the length.
    let (mut angle, mut place) = (0.0_f64, [0.0, 0.0]);
    let mut targets: Vec<Target> = Vec::new();
    for (k, curvature) in curvatures.iter().enumerate() {
        let end = angle + curvature * length / 4.0;
        place = [
            place[0] + (end.sin() - angle.sin()) / curvature,
            place[1] + (angle.cos() - end.cos()) / curvature,
        ];
        angle = end;
        targets.push(((k + 1) * columns / 4 + 1, 2, place[1]));
    }
    let (found, runs, largest) = solved(&family, &[1.0, -1.0, 1.0, 1.0], &targets);
    println!("{found:?} in {runs} runs, {largest:e} m");
    for (found, exact) in found.iter().zip(curvatures) {
        // A patch has ten columns: its ends are right to a part of one.
        assert!((found - exact).abs() < 0.02 * 8.0, "{found} {exact}");
    }
    let run = Run::record(
        &family,
        &found,
        Plan::steps(Method::Equilibrium(ImplicitOptions::default()), 1.0, 1),
        AdjointOptions::default(),
    );
    let tip = run.unwrap().value(&coordinate(columns + 1, 0, 1));
    assert!((tip / place[0] - 1.0).abs() < 2e-3, "{tip} {place:?}");
}

/// Which angles of its creases bring a vertex of a third-party pattern to a place? The angles of mountains and
/// of valleys, and a vertex of a waterbomb's square base, which is held at one face.
#[test]
fn the_crease_angles_of_a_pattern_from_the_place_of_a_vertex() {
    let Some(data) = std::env::var_os("ISOSHEET_DATA") else {
        println!("skipped: ISOSHEET_DATA names no folder");
        return;
    };
    let pattern = Path::new(&data).join("fold/squarebase_tri.fold");
    let mesh = read_mesh(&pattern).unwrap();
    let sheet = Sheet::new(mesh.positions.clone(), &mesh.faces).unwrap();
    let side = sheet.area().sqrt();
    let sheet = sheet.map_positions(|p| p.map(|c| 0.1 * c / side)).unwrap();
    let t = sheet.topology();
    let creases: Vec<(EdgeId, f64)> = mesh
        .creases
        .iter()
        .filter_map(|crease| {
            let [a, b] = crease.ends.map(isosheet::mesh::VertexId);
            let edge = t.find_edge(a, b)?;
            let angle = crease.angle.filter(|angle| *angle != 0.0)?;
            Some((edge, angle.signum()))
        })
        .collect();
    assert!(creases.len() >= 4, "{}", creases.len());
    let edges: Vec<EdgeId> = creases.iter().map(|(e, _)| *e).collect();
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let springs = creases.iter().map(|(edge, sign)| CreaseSpring {
            edge: *edge,
            stiffness: 0.05,
            rest: if *sign > 0.0 { p[0] } else { -p[1] }.into(),
            yields: None,
            in_series: None,
        });
        let springs = CreaseSprings::new(t, springs.collect())?;
        let held = t.faces()[0];
        let model = SheetModel::of_material(&sheet, &paper())
            .creased(&edges)
            .build()?
            .with_pins(&held)?
            .with_potential(springs);
        Ok(Scene::new(
            model,
            State::at_rest(sheet.positions().to_vec()),
        ))
    };
    let options = ImplicitOptions {
        tolerance: Some(1e-10),
        ..ImplicitOptions::default()
    };
    let plan = Plan::steps(Method::Equilibrium(options), 1.0, 1);
    let asked = [0.9, 0.6];
    let made = Run::record(&family, &asked, plan, AdjointOptions::default()).unwrap();
    let end = &made.states()[1];
    let away = |v: usize| {
        (0..3)
            .map(|k| (end.x[3 * v + k] - sheet.positions()[3 * v + k]).powi(2))
            .sum::<f64>()
    };
    let vertex = (0..t.vertex_count())
        .max_by(|a, b| away(*a).total_cmp(&away(*b)))
        .unwrap();
    let targets: Vec<Target> = (0..3).map(|k| (vertex, k, end.x[3 * vertex + k])).collect();
    let (found, runs, largest) = solved(&family, &[0.6, 0.5], &targets);
    println!("{found:?} in {runs} runs, {largest:e} m");
    for (found, asked) in found.iter().zip(asked) {
        assert!((found / asked - 1.0).abs() < 1e-4, "{found} {asked}");
    }
}
