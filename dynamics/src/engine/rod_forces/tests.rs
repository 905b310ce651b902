use crate::{
    ElasticSheet, EnergyMomentumOptions, ImplicitOptions, Method, RattleOptions, SheetModel,
    Simulation, State,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::Vector3;

/// Acceleration of gravity of the models, m/s^2.
const GRAVITY: f64 = 9.81;
/// Mass of the sheets, kg.
const MASS: f64 = 0.3;

fn methods() -> [Method; 5] {
    [
        Method::Bdf2(ImplicitOptions::default()),
        Method::ImplicitEuler(ImplicitOptions::default()),
        Method::EnergyMomentum(EnergyMomentumOptions::default()),
        Method::Rattle(RattleOptions::default()),
        Method::RattleComposition(RattleOptions::default()),
    ]
}

fn model(sheet: &Sheet, pins: &[VertexId]) -> SheetModel {
    SheetModel::new(sheet, MASS, MassKind::Lumped)
        .unwrap()
        .with_acceleration([0.0, 0.0, -GRAVITY])
        .with_pins(pins)
        .unwrap()
}

fn point(x: &[f64], v: usize) -> Vector3<f64> {
    Vector3::new(x[3 * v], x[3 * v + 1], x[3 * v + 2])
}

/// A triangle that turns about the side between its pins, the y axis: its third vertex, 0.3 m from the axis
/// and in the middle between the pins, 0.4 m apart, is `angle` away from hanging.
fn pendulum(angle: f64) -> Sheet {
    let (r, half) = (0.3, 0.2);
    let tip = [r * angle.sin(), 0.0, -r * angle.cos()];
    let x = vec![0.0, -half, 0.0, 0.0, half, 0.0, tip[0], tip[1], tip[2]];
    Sheet::new(x, &[[0, 1, 2]]).unwrap()
}

/// Tension of each of the two rods of the pendulum, newtons: together they carry along the radius what weight
/// and centripetal acceleration ask for.
fn tension(m: f64, x: &[f64], v: &[f64]) -> f64 {
    let (p, v) = (point(x, 2), point(v, 2));
    let (r, rod) = (0.3, 0.3_f64.hypot(0.2));
    let radial = m * GRAVITY * (-p.z / r) + m * v.norm_squared() / r;
    0.5 * radial * rod / r
}

#[test]
fn rods_of_a_hanging_triangle_carry_its_tip() {
    for method in methods() {
        let sheet = pendulum(0.0);
        let m = MASS / 3.0;
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::new(
            model(&sheet, &[VertexId(0), VertexId(1)]),
            start,
            method.clone(),
        );
        let run = run.as_mut().unwrap();
        assert_eq!(run.rod_forces().unwrap(), [0.0; 3], "before the first step");
        for _ in 0..5 {
            run.step(1e-2).unwrap();
        }
        let expected = 0.5 * m * GRAVITY * 0.3_f64.hypot(0.2) / 0.3;
        for (edge, force) in run
            .model()
            .topology()
            .edges()
            .iter()
            .zip(run.rod_forces().unwrap())
        {
            let expected = if edge.contains(&VertexId(2)) {
                expected
            } else {
                0.0
            };
            assert!(
                (force - expected).abs() < 1e-9 * m * GRAVITY,
                "{method:?}: {edge:?} {force} {expected}"
            );
        }
    }
}

/// The forces are known at the end of a step, over it in the mean, or at its start: the errors there are at
/// most of first order in the step, which shows as the ratio of the errors of two steps.
#[test]
fn rods_of_a_pendulum_carry_weight_and_centripetal_force() {
    for method in methods() {
        let error = |steps: usize| {
            let sheet = pendulum(1.2);
            let m = MASS / 3.0;
            let start = State::at_rest(sheet.positions().to_vec());
            let pinned = model(&sheet, &[VertexId(0), VertexId(1)]);
            let mut run = Simulation::new(pinned, start, method.clone()).unwrap();
            let h = 0.5 / steps as f64;
            let mut worst: f64 = 0.0;
            for k in 0..steps {
                let before = run.state().clone();
                run.step(h).unwrap();
                let after = run.state();
                let of = |s: &State| tension(m, &s.x, &s.v);
                let expected = match method {
                    Method::EnergyMomentum(_) => 0.5 * (of(&before) + of(after)),
                    Method::Rattle(_) => of(&before),
                    _ => of(after),
                };
                let forces = run.rod_forces().unwrap();
                let edges = run.model().topology().edges().iter();
                let of_tip = edges
                    .zip(forces)
                    .filter(|(ends, _)| ends.contains(&VertexId(2)));
                // The first step of BDF2 is one of implicit Euler.
                if k > 1 {
                    worst = of_tip.fold(worst, |e, (_, force)| e.max((force - expected).abs()));
                }
            }
            worst / (m * GRAVITY)
        };
        let (coarse, fine) = (error(50), error(100));
        assert!(
            fine < 0.05 && fine < 0.6 * coarse,
            "{method:?}: {coarse:.2e} {fine:.2e}"
        );
    }
}

/// Across each horizontal cut through a vertical strip that hangs by its upper corners the rods carry what is
/// below.
#[test]
fn rods_of_a_hanging_strip_carry_what_is_below_each_cut() {
    let rows = 6;
    let flat = generate::anisotropic_grid(1, rows, 0.1, 0.6).unwrap();
    let upright: Vec<f64> = flat
        .positions()
        .chunks(3)
        .flat_map(|p| [p[0], 0.0, p[1]])
        .collect();
    let sheet = Sheet::new(upright, &flat.face_indices()).unwrap();
    let z = |v: VertexId| sheet.positions()[3 * v.index() + 2];
    let top: Vec<VertexId> = sheet
        .topology()
        .vertex_ids()
        .filter(|&v| z(v) > 0.6 - 1e-9)
        .collect();
    assert_eq!(top.len(), 2);
    let pinned = model(&sheet, &top);
    let mass = pinned.mass().vertex.clone();
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(pinned, start, Method::default()).unwrap();
    for _ in 0..20 {
        run.step(1e-2).unwrap();
    }
    let (forces, x) = (run.rod_forces().unwrap(), &run.state().x);
    let weight_of_all = GRAVITY * mass.iter().sum::<f64>();
    for row in 0..rows {
        let cut = 0.6 / rows as f64 * (row as f64 + 0.5);
        let below = |v: VertexId| z(v) < cut;
        let mut carried = 0.0;
        for (&[a, b], force) in run.model().topology().edges().iter().zip(&forces) {
            if below(a) != below(b) {
                let d = point(x, a.index()) - point(x, b.index());
                carried += force * d.z.abs() / d.norm();
            }
        }
        let vertices = sheet.topology().vertex_ids().filter(|&v| below(v));
        let weight = GRAVITY * vertices.map(|v| mass[v.index()]).sum::<f64>();
        assert!(
            (carried - weight).abs() < 1e-6 * weight_of_all,
            "row {row}: {carried} N for {weight} N"
        );
    }
}

#[test]
fn there_are_no_forces_without_rods() {
    let sheet = pendulum(0.5);
    let pins = [VertexId(0), VertexId(1)];
    let start = State::at_rest(sheet.positions().to_vec());
    let elasticity = ElasticSheet::new(&sheet, 1e3, 0.3).unwrap();
    let elastic = model(&sheet, &pins).with_elastic_sheet(elasticity).unwrap();
    let mut run = Simulation::new(elastic, start, Method::default()).unwrap();
    run.step(1e-2).unwrap();
    assert_eq!(run.rod_forces(), None);
}

/// Forces of rods that depend on each other are the least ones that balance what the sheet carries: in a flat
/// sheet that lies between pins, where any self-stress could be added, and in a tablecloth, whose flat parts
/// would carry weight with a thousand times its size.
#[test]
fn forces_of_dependent_rods_are_of_the_size_of_their_load() {
    let sheet = generate::isotropic_square(2, 1.0).unwrap();
    let t = sheet.topology();
    let corner = |v: &VertexId| {
        let p = point(sheet.positions(), v.index());
        (p.x - 0.5).abs() > 0.4 && (p.y - 0.5).abs() > 0.4
    };
    let pins: Vec<VertexId> = t.vertex_ids().filter(corner).collect();
    let pinned = model(&sheet, &pins);
    // A load in the plane of the sheet, and a state of stress besides that loads no free vertex.
    let x = sheet.positions();
    let mut random = 0.3_f64;
    let given: Vec<f64> = t
        .edges()
        .iter()
        .map(|ends| {
            random = (random * 7919.0).fract();
            let is_free = ends.iter().any(|v| !pins.contains(v));
            if is_free { 1e4 * (random - 0.5) } else { 0.0 }
        })
        .collect();
    let least = super::least_forces(&pinned, x, &given).unwrap();
    let norm = |f: &[f64]| f.iter().map(|f| f * f).sum::<f64>().sqrt();
    assert!(norm(&least) < 0.9 * norm(&given));
    let load = |forces: &[f64]| {
        let mut load = vec![0.0; x.len()];
        let w: Vec<f64> = forces
            .iter()
            .zip(pinned.rods().lengths())
            .map(|(f, l)| f / l)
            .collect();
        pinned.rods().apply_transpose_add(x, &w, &mut load);
        pinned.clear_pinned(&mut load);
        load
    };
    let (expected, found) = (load(&given), load(&least));
    for (a, b) in expected.iter().zip(&found) {
        assert!((a - b).abs() < 1e-9 * norm(&expected), "{a} {b}");
    }
    // Least: what is left of the given forces is orthogonal to it.
    let rest: f64 = given.iter().zip(&least).map(|(g, l)| (g - l) * l).sum();
    assert!(rest.abs() < 1e-9 * norm(&given).powi(2), "{rest}");
}
