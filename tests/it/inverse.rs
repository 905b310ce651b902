//! Gradients of runs: an inverse problem of origami, and bits on several threads.

use isosheet::adjoint::{
    AdjointOptions, Branches, Family, Plan, Run, Scene, SceneError, coordinate,
};
use isosheet::collide::{Coefficients, Contacts, Obstacle, Shape};
use isosheet::dynamics::{
    CreaseSpring, CreaseSprings, ImplicitOptions, Material, Method, SheetModel, State,
};
use isosheet::io::read_mesh;
use isosheet::mesh::{EdgeId, Sheet, generate};
use nalgebra::{DMatrix, DVector};
use std::path::Path;

/// A coordinate of a vertex at rest, and the value that it is to have.
type Target = (usize, usize, f64);

/// Numbers with which a scene at rest has some coordinates, and the number of runs: the method of Gauss and
/// Newton with a gradient of each coordinate from one run. A step that leads further away is halved.
fn solved(family: &dyn Family, start: &[f64], targets: &[Target]) -> (Vec<f64>, usize) {
    let run_of =
        |numbers: &[f64]| Run::record(family, numbers, at_rest(), AdjointOptions::default()).ok();
    let differences = |run: &Run<'_>| {
        let values = targets.iter().map(|(vertex, axis, wanted)| {
            let found = run.value(&coordinate(*vertex, *axis, 1));
            found.expect("a coordinate") - wanted
        });
        DVector::from_iterator(targets.len(), values)
    };
    let mut numbers = start.to_vec();
    let mut run = run_of(&numbers).expect("a run at the start");
    let mut runs = 1;
    while differences(&run).amax() > 1e-8 {
        let mut jacobian = DMatrix::zeros(targets.len(), numbers.len());
        for (mut row, (vertex, axis, _)) in jacobian.row_iter_mut().zip(targets) {
            let gradient = run.gradient(&coordinate(*vertex, *axis, 1)).unwrap();
            row.copy_from_slice(&gradient.of_numbers);
        }
        let before = differences(&run);
        let step = jacobian.svd(true, true).solve(&before, 1e-12).unwrap();
        let mut part = 1.0;
        (numbers, run) = loop {
            let next: Vec<f64> = numbers
                .iter()
                .zip(step.iter())
                .map(|(number, step)| number - part * step)
                .collect();
            runs += 1;
            assert!(runs <= 30, "not found: {numbers:?}, {before:?}");
            match run_of(&next).filter(|run| differences(run).norm() < before.norm()) {
                Some(run) => break (next, run),
                None => part /= 2.0,
            }
        };
    }
    (numbers, runs)
}

fn at_rest() -> Plan {
    let options = ImplicitOptions {
        tolerance: Some(1e-10),
        ..ImplicitOptions::default()
    };
    Plan::steps(Method::Equilibrium(options), 1.0, 1)
}

fn paper() -> Material {
    let mut paper = Material::office_paper();
    (paper.rigidity, paper.stiffness, paper.poisson) = (3e-4, 3e4, 0.0);
    paper
}

/// Which angles of its creases bring a vertex of a third-party pattern to a place? The angles of mountains
/// and of valleys, and the vertex of Miura's pattern that moves most while a face is held.
#[test]
fn the_crease_angles_of_a_pattern_from_the_place_of_a_vertex() {
    let Some(data) = std::env::var_os("ISOSHEET_DATA") else {
        println!("skipped: ISOSHEET_DATA names no folder");
        return;
    };
    let pattern = Path::new(&data).join("fold/miura_herringbone_8x8_tri.fold");
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
            stiffness: 1e-3,
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
    let asked = [0.7, 0.6];
    let made = Run::record(&family, &asked, at_rest(), AdjointOptions::default()).unwrap();
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
    let (found, runs) = solved(&family, &[0.5, 0.5], &targets);
    println!("{found:?} in {runs} runs");
    for (found, asked) in found.iter().zip(asked) {
        assert!((found / asked - 1.0).abs() < 1e-4, "{found} {asked}");
    }
}

/// The gradient of a fall of paper onto a ball has bits that do not depend on the threads: a sheet of as many
/// vertices as steps are shared from.
#[test]
fn bits_of_gradients_do_not_depend_on_threads() {
    let sheet = generate::disk(30, 0.1).unwrap();
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let model = SheetModel::of_material(&sheet, &Material::office_paper()).build()?;
        let model = model.with_acceleration([0.0, 0.0, -p[0]]);
        let ball = Obstacle::at(Shape::Sphere { radius: 0.05 }, [0.01, 0.0, -0.0505])?;
        let contacts = Contacts::for_sheet(&model, [ball], Coefficients::equal(p[1]))?;
        let start = State::at_rest(sheet.positions().to_vec());
        Ok(Scene::new(model, start).with_contact(contacts))
    };
    let found = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let plan = Plan::steps(Method::default(), 5e-3, 2);
            let options = AdjointOptions {
                branches: Branches::PassBy,
                ..AdjointOptions::default()
            };
            let run = Run::record(&family, &[9.8, 0.3], plan, options).unwrap();
            let gradient = run.gradient(&coordinate(0, 2, 2)).unwrap();
            let all = [
                gradient.of_numbers,
                gradient.of_start.x,
                gradient.of_start.v,
            ]
            .concat();
            all.into_iter().map(f64::to_bits).collect::<Vec<_>>()
        })
    });
    assert!(found[0].iter().any(|bits| *bits != 0));
    assert_eq!(found[0], found[1]);
}
