//! Searches that gradients lead.

use crate::closed_forms::{LENGTH, at_rest, strip};
use crate::search::minimise;
use crate::support::as_meshed;
use isosheet_adjoint::{
    AdjointOptions, Family, OfState, Plan, Run, Scene, SceneError, Share, coordinate,
    squared_distances,
};
use isosheet_dynamics::{
    Curl, Curvature, Material, MaterialDirection, NaturalTensor, SheetModel, State,
};
use isosheet_mesh::VertexId;

fn solve(family: &dyn Family, plan: &Plan, start: f64, vertex: usize, target: f64) -> (f64, usize) {
    let count = plan.steps.len();
    let loss = coordinate(vertex, 2, count);
    let mut number = start;
    for runs in 1..20 {
        let run = Run::record(family, &[number], plan.clone(), AdjointOptions::default());
        let gradient = run.expect("a run").gradient(&loss).expect("a gradient");
        let step = (gradient.value - target) / gradient.of_numbers[0];
        number -= step.clamp(-0.5 * number.abs(), 0.5 * number.abs());
        if step.abs() <= 1e-9 * number.abs() {
            return (number, runs);
        }
    }
    panic!("the search does not end: {number}");
}

/// The rigidity of paper from its sag.
#[test]
fn the_rigidity_from_the_sag() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = strip(12)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
        let mut paper = Material::office_paper();
        paper.rigidity = p[0];
        let model = SheetModel::of_material(&sheet, &paper)
            .clamped(&clamp)
            .build()?
            .with_gravity();
        Ok(as_meshed(model, &sheet))
    };
    let (tip, rigidity) = (13, 4.2e-4);
    let run = Run::record(&family, &[rigidity], at_rest(), AdjointOptions::default());
    let measured = run.expect("a run").value(&coordinate(tip, 2, 1));
    let measured = measured.expect("a height");
    let (found, runs) = solve(&family, &at_rest(), 8e-4, tip, measured);
    println!("{found} in {runs} runs");
    assert!((found / rigidity - 1.0).abs() < 1e-6, "{found}");
    assert!(runs <= 10, "{runs}");
}

/// The height of a clamp that brings a tip to a height.
#[test]
fn the_clamp_that_brings_the_tip_there() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = strip(12)?;
        let height = p[0];
        let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
        let lifted = sheet.map_positions(|[x, y, z]| [x, y, z + height])?;
        let model = SheetModel::of_material(&sheet, &Material::office_paper())
            .clamped(&clamp)
            .build()?
            .with_gravity();
        Ok(Scene::new(
            model,
            State::at_rest(lifted.positions().to_vec()),
        ))
    };
    let (tip, target) = (13, 0.05);
    let (found, runs) = solve(&family, &at_rest(), 0.1, tip, target);
    println!("{found} in {runs} runs");
    let run = Run::record(&family, &[found], at_rest(), AdjointOptions::default());
    let reached = run.expect("a run").value(&coordinate(tip, 2, 1));
    let reached = reached.expect("a height");
    assert!((reached - target).abs() < 1e-9, "{reached}");
}

/// Film that is soft in its plane.
fn film() -> Material {
    let mut film = Material::office_paper();
    film.stiffness = 300.0;
    film.rigidity = 1e-3;
    film
}

/// The curl of three patches of a strip that gives it the shape that it has with other curls.
#[test]
fn the_curl_by_patches_of_a_shape() {
    let cells = 12;
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = strip(cells)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 1e-9);
        let t = sheet.topology();
        let patch = |face: &[VertexId; 3]| {
            let x: f64 = face.iter().map(|v| sheet.position(*v)[0]).sum::<f64>() / 3.0;
            let number = ((3.0 * x / LENGTH).max(0.0) as usize).min(2);
            Curvature {
                along: p[number],
                ..Curvature::default()
            }
        };
        let curl = Curl {
            direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
            curvature: NaturalTensor::Faces(t.faces().iter().map(patch).collect()),
            profile: 1.0.into(),
        };
        let model = SheetModel::of_material(&sheet, &film())
            .clamped(&clamp)
            .curled(curl)
            .build()?
            .with_acceleration([0.0, 0.0, -0.5]);
        Ok(as_meshed(model, &sheet))
    };
    let wanted = [2.0, -1.0, 3.0];
    let run = Run::record(&family, &wanted, at_rest(), AdjointOptions::default());
    let run = run.expect("a run");
    let end = run.states()[1].vertex_positions();
    let row = 1..=cells + 1;
    let targets: Vec<(usize, [f64; 3])> = row.map(|v| (v, end[v])).collect();
    let loss = squared_distances(targets, 1);
    let found = minimise(
        &family,
        &at_rest(),
        &loss,
        &[0.1, 0.1, 0.1],
        100.0,
        25,
        1e-16,
    );
    println!("{:?} {:?}", found.numbers, found.losses);
    for (found, wanted) in found.numbers.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-4, "{found} {wanted}");
    }
}

/// The rest shape of a strip that its weight makes straight: thirty heights, in at most twenty runs.
#[test]
fn the_rest_shape_of_a_strip_that_is_straight_under_load() {
    let cells = 30;
    let cell = LENGTH / f64::from(cells);
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let flat = strip(cells as usize)?;
        // The columns of vertices, from the clamp on, keep their distances.
        let mut places = vec![[-cell, 0.0], [0.0, 0.0]];
        for z in p {
            let [x, before] = places[places.len() - 1];
            let rise: f64 = z - before;
            places.push([x + (cell * cell - rise * rise).sqrt(), *z]);
        }
        let sheet = flat.map_positions(|[x, y, _]| {
            let column = ((x + cell) / cell).round() as usize;
            let [x, z] = places[column];
            [x, y, z]
        })?;
        let clamp = flat.vertices_where(|[x, _, _]| x < 1e-9);
        let model = SheetModel::of_material(&sheet, &film())
            .clamped(&clamp)
            .curved()
            .build()?
            .with_acceleration([0.0, 0.0, -0.5]);
        Ok(as_meshed(model, &sheet))
    };
    let columns = 2..cells as usize + 2;
    // Only the heights count: the targets are where the strip would be.
    let loss = move |n: usize, state: &State| {
        (n == 1).then(|| {
            let mut of = OfState::zeros(state.x.len());
            let mut value = 0.0;
            for v in columns.clone() {
                let z = state.x[3 * v + 2];
                value += 0.5 * z * z;
                of.x[3 * v + 2] = z;
            }
            Share::of_state(value, of)
        })
    };
    let start = vec![0.0; 30];
    let found = minimise(&family, &at_rest(), &loss, &start, 1.0, 20, 1e-10);
    println!("{:?}", found.losses);
    let last = found.losses.iter().copied().fold(f64::INFINITY, f64::min);
    // A root mean square of a micrometre or two, of a sag of centimetres.
    assert!(last < 1e-6 * found.losses[0], "{:?}", found.losses);
    assert!(found.losses.len() <= 20);
}
