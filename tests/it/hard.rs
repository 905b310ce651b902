//! Situations that break sheet solvers, with closed forms: meshes that cannot bend, a branch point, slivers,
//! extreme masses, short steps, many threads.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{
    ElasticSheet, Method, PlateBending, SheetModel, Simulation, State, StepError,
};
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId, fold_angle, generate};
use isosheet_tests::{
    Flap, Named, Pendulum, RigidBody, bumped, conservative, energy_momentum, implicit_euler,
    max_difference, orders,
};
use nalgebra::{Isometry3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Every method, with the order of its error.
fn methods() -> impl Iterator<Item = (Named, f64)> {
    let damped = [
        (("BDF2", Method::default()), 2.0),
        (("implicit Euler", implicit_euler()), 1.0),
    ];
    let conservative = conservative().into_iter().zip([2.0, 2.0, 4.0]);
    damped.into_iter().chain(conservative)
}

/// A run of so many steps, and its largest strain.
fn go(mut run: Simulation, h: f64, steps: usize) -> Result<(Vec<f64>, f64), StepError> {
    let mut strain = 0.0_f64;
    for _ in 0..steps {
        strain = strain.max(run.step(h)?.strain);
    }
    Ok((run.state().x.clone(), strain))
}

/// A sheet of 0.1 kg under gravity, held at some vertices.
fn pinned(sheet: &Sheet, pins: &[VertexId]) -> SheetModel {
    let model = SheetModel::new(sheet, 0.1, MassKind::Lumped).expect("valid");
    model
        .with_gravity()
        .with_pins(pins)
        .expect("vertices exist")
}

fn tetrahedron() -> Sheet {
    let x = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.2, 0.8, 0.1],
        [0.3, 0.2, 0.9],
    ];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    Sheet::new(x.concat(), &faces).expect("closed")
}

/// A box with a vertex in the middle of each side: infinitesimally flexible there, and rigid.
fn boxed() -> Sheet {
    let (size, mut x, mut faces) = ([0.7, 0.9, 1.1], Vec::new(), Vec::new());
    for k in 0..8 {
        x.extend((0..3).map(|i| (f64::from(k >> i & 1) - 0.5) * size[i]));
    }
    for axis in 0..3 {
        for side in 0..2_u32 {
            let middle = (x.len() / 3) as u32;
            let mut p = [0.0; 3];
            p[axis] = (f64::from(side) - 0.5) * size[axis];
            x.extend(p);
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |a: u32, b: u32| side << axis | a << u | b << v;
            let mut ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if side == 0 {
                ring.reverse();
            }
            faces.extend((0..4).map(|k| [ring[k], ring[(k + 1) % 4], middle]));
        }
    }
    Sheet::new(x, &faces).expect("closed")
}

/// Largest change of a fold angle, radians.
fn bending(sheet: &Sheet, x: &[f64]) -> f64 {
    let t = sheet.topology();
    let change = |e| {
        let d = fold_angle(t, x, e)? - fold_angle(t, sheet.positions(), e)?;
        Some(d.sin().atan2(d.cos()).abs())
    };
    t.edge_ids().filter_map(change).fold(0.0, f64::max)
}

/// A closed surface turns as Euler's rigid body, about no principal axis, and does not bend. Moving a vertex
/// inside a flat side by `d` strains its rods by `d^2`, so that lengths determine positions to the square
/// root of the strain there; the conservative methods, which need unique forces of rods, refuse such a box.
#[test]
fn closed_meshes_turn_as_eulers_rigid_body() {
    let (spin, h, steps) = ([1.0, 3.0, 0.5], 2e-3, 500);
    for (sheet, bound) in [(tetrahedron(), 1e-9), (boxed(), 1e-5)] {
        let count = sheet.topology().vertex_count();
        let places = sheet.positions().chunks(3);
        let masses = places.map(|p| (0.1, Vector3::from_column_slice(p)));
        let body = RigidBody::of_masses(&masses.collect::<Vec<_>>());
        for ((name, method), order) in methods() {
            let mass = MassMatrix::from_vertex_masses(vec![0.1; count]).expect("positive");
            let model = SheetModel::with_mass(&sheet, mass).expect("valid");
            let run = Simulation::new(model, body.start(&sheet, spin), method).expect("valid");
            let is_damped = ["BDF2", "implicit Euler"].contains(&name);
            let end = match go(run, h, steps) {
                Ok((end, _)) => end,
                Err(error) => {
                    let is_known = matches!(error, StepError::RankDeficient { .. });
                    assert!(count > 4 && !is_damped && is_known, "{name}: {error}");
                    continue;
                }
            };
            let bent = bending(&sheet, &end);
            assert!(bent < bound, "{name}, {count} vertices: {bent:e}");
            if order == 4.0 {
                let exact = body.positions(&sheet, spin, h * steps as f64, 20 * steps);
                let off = max_difference(&end, &exact);
                assert!(off < 1e-6, "{off:e} m");
            }
        }
    }
}

/// The flap with a vertex in the middle of its hinge, so that two straight creases cross there.
fn crossing(start_angle: f64) -> (Flap, SheetModel, State) {
    let flap = Flap {
        start_angle,
        ..Flap::default()
    };
    let with_middle = |x: &[f64]| {
        let middle = (0..3).map(|k| 0.5 * (x[k] + x[3 + k]));
        x.iter().copied().chain(middle).collect::<Vec<_>>()
    };
    let State { x, v, .. } = flap.start();
    let faces = [[0, 2, 4], [4, 2, 1], [0, 4, 3], [4, 1, 3]];
    let sheet = Sheet::new(with_middle(&x), &faces).expect("four triangles");
    let (m, hinge) = (flap.apex_mass, flap.hinge_mass / 3.0);
    let mass = MassMatrix::from_vertex_masses(vec![hinge, hinge, m, m, hinge]);
    let model = SheetModel::with_mass(&sheet, mass.expect("positive")).expect("valid");
    (flap, model, State::moving(with_middle(&x), with_middle(&v)))
}

/// Folded along one of two crossing lines the sheet swings through flat, where it could as well fold along
/// the other one: by inertia it goes on along the first, at the order of the method. The same from exactly
/// there.
#[test]
fn a_fold_passes_a_branch_point() {
    for ((name, method), order) in methods() {
        let error = |angle: f64, steps: usize| {
            let (flap, model, start) = crossing(angle);
            let run = Simulation::new(model, start, method.clone()).expect("valid");
            let (end, strain) = go(run, 1.0 / steps as f64, steps).expect("passes");
            assert!(strain < 1e-12, "{name}: {strain:e}");
            max_difference(&end[..12], &flap.exact(1.0))
        };
        let errors = [200, 400].map(|steps| error(1.1, steps));
        let observed = orders(&errors)[0];
        let is_exact = order == 4.0 && errors[1] < 1e-7;
        assert!(is_exact || observed > order - 0.2, "{name}: {errors:?}");
        let bound = if order == 1.0 { 2e-2 } else { 1e-3 };
        let from_there = error(FRAC_PI_2, 200);
        assert!(from_there < bound, "{name}: {from_there:e} m");
    }
}

/// Triangles a million times longer than wide swing with the right period, held at the short side or the long
/// one. (A strain of 1e-12 is all of an altitude of 1e-6 of the side, so that BDF2 loses its way there.)
#[test]
fn needles_swing_as_pendulums() {
    let bdf2 = || ("BDF2", Method::default());
    let exact = || ("energy-momentum", energy_momentum());
    for (base, altitude, (name, method)) in [
        (1e-6, 1.0, bdf2()),
        (1e-6, 1.0, exact()),
        (1.0, 1e-3, bdf2()),
        (1.0, 1e-3, exact()),
        (1.0, 1e-6, exact()),
    ] {
        let (s, c) = 1.0_f64.sin_cos();
        let corner = [altitude * s, 0.0, -altitude * c];
        let x = [[0.0, -0.4 * base, 0.0], [0.0, 0.6 * base, 0.0], corner].concat();
        let sheet = Sheet::new(x.clone(), &[[0, 1, 2]]).expect("a triangle");
        let model = pinned(&sheet, &[VertexId(0), VertexId(1)]);
        let pendulum = Pendulum {
            length: altitude,
            amplitude: 1.0,
            gravity: 9.8,
        };
        let quarter = 0.25 * pendulum.period();
        let run = Simulation::new(model, State::at_rest(x), method).expect("valid");
        let (end, _) = go(run, quarter / 2000.0, 2000).expect("swings");
        let exact = pendulum.exact(quarter);
        let off = (end[6] - exact[6]).hypot(end[8] - exact[8]) / altitude;
        assert!(off < 1e-5, "{name}, {base} by {altitude}: {off:e}");
    }
}

/// Two hinged triangles whose apexes or whose hinge is 1e8 times as heavy as the rest open as the closed form
/// says.
#[test]
fn extreme_masses_open_a_flap() {
    for (apex_mass, hinge_mass) in [(1.0, 1e-8), (1e-8, 1.0)] {
        let flap = Flap {
            apex_mass,
            hinge_mass,
            ..Flap::default()
        };
        for ((name, method), order) in methods().filter(|(_, order)| *order > 1.0) {
            let run = Simulation::new(flap.model(), flap.start(), method).expect("valid");
            let (end, _) = go(run, 1e-3, 400).expect("opens");
            let off = max_difference(&end, &flap.exact(0.4));
            let bound = if order == 4.0 { 1e-8 } else { 1e-4 };
            assert!(off < bound, "{name}, apexes {apex_mass} kg: {off:e} m");
        }
    }
}

/// Errors go down to round-off with very short steps and stay there. Lengths that err by 1e-12 over a step of
/// 1e-5 s leave velocities of 1e-7 m/s open.
#[test]
fn short_steps_are_as_good_as_any() {
    let (problem, end) = (Pendulum::default(), 0.1);
    for ((name, method), order) in methods() {
        let run = Simulation::new(problem.model(), problem.start(), method).expect("valid");
        let (x, strain) = go(run, 1e-5, 10_000).expect("swings");
        let off = max_difference(&x, &problem.exact(end));
        let bound = if order == 1.0 { 1e-5 } else { 1e-7 };
        assert!(off < bound && strain < 1e-12, "{name}: {off:e} m");
    }
}

/// A cloth that touches a table and itself, with thousands of pairs to judge, whose order decides the last
/// bits of sums and of safe motions: the same bits on any number of threads.
#[test]
fn a_cloth_has_the_same_bits_on_any_number_of_threads() {
    let cloth = || {
        let sheet = bumped(4, 0.1);
        let model = pinned(&sheet, &[]);
        let options = ContactOptions::for_sheet(&model);
        let half = [0.25, 0.25, 0.1];
        // Just below the lowest part of the bump above it.
        let top = 0.05 - 0.95 * options.activation;
        let pose = Isometry3::translation(0.5, 0.5, top - half[2]);
        let table = Obstacle::fixed(Shape::Cuboid { half }, pose).expect("a box");
        let contacts = Contacts::new(&model, options)
            .and_then(|c| c.with_body(table, Coefficients::FRICTIONLESS))
            .and_then(|c| c.with_self_contact(Coefficients::FRICTIONLESS));
        let start = State::at_rest(sheet.positions().to_vec());
        let run = Simulation::new(model, start, Method::default()).expect("valid");
        let run = run.with_contact(contacts.expect("apart")).expect("apart");
        go(run, 1e-3, 2).expect("accepted").0
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("threads").install(cloth)
    };
    let one = on(1);
    assert!([2, 4].iter().all(|&threads| on(threads) == one));
}

/// A film with a plate, of as many vertices as whole steps are shared from, that touches a ball and itself:
/// faces, points, products, pairs and factorisations are shared among threads that stay awake.
#[test]
fn a_film_has_the_same_bits_on_any_number_of_threads() {
    let film = || {
        let sheet = generate::disk(30, 0.5).expect("a disk");
        let plate = PlateBending::new(&sheet, 1e-3).expect("a rigidity");
        let elastic = ElasticSheet::new(&sheet, 5e5, 0.3).expect("a stiffness");
        let elastic = elastic.beside(&sheet, &plate);
        let model = pinned(&sheet, &[]).with_potential(plate);
        let model = model.with_elastic_sheet(elastic).expect("its own sheet");
        let options = ContactOptions::for_sheet(&model);
        let below = Isometry3::translation(0.0, 0.0, -0.2 - 0.9 * options.activation);
        let ball = Obstacle::fixed(Shape::Sphere { radius: 0.2 }, below).expect("a ball");
        let friction = Coefficients::equal(0.3);
        let contacts = Contacts::new(&model, options)
            .and_then(|c| c.with_body(ball, friction))
            .and_then(|c| c.with_self_contact(friction));
        let start = State::at_rest(sheet.positions().to_vec());
        let run = Simulation::new(model, start, Method::default()).expect("valid");
        let run = run.with_contact(contacts.expect("apart")).expect("apart");
        let (x, _) = go(run, 1.0 / 60.0, 2).expect("accepted");
        x.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("threads").install(film)
    };
    let one = on(1);
    assert!([2, 3, 5].iter().all(|&threads| on(threads) == one));
}
