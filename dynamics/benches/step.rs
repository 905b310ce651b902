//! Steps of each integrator, and what they assemble, at the paper's mesh sizes and the next: a sheet of 1 m
//! and 0.1 kg held at a corner, in mid-fall.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Duration;

/// A state in mid-fall: a quarter of a second after release from a bumped sheet.
fn falling(level: u32) -> (Sheet, State) {
    let flat = generate::isotropic_square(level, 1.0).expect("valid");
    let mut x = flat.positions().to_vec();
    for p in x.chunks_mut(3) {
        p[2] = 0.05 * (PI * p[0]).sin() * (PI * p[1]).sin();
    }
    let sheet = Sheet::new(x, &flat.face_indices()).expect("valid");
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = simulation(&sheet, level, start, Method::default());
    for _ in 0..60 {
        run.step(1.0 / 240.0).expect("accepted");
    }
    let state = run.state().clone();
    (sheet, state)
}

const SIZES: [(u32, &str); 4] = [
    (1, "25/32"),
    (2, "81/128"),
    (3, "289/512"),
    (4, "1089/2048"),
];

fn corner(level: u32) -> VertexId {
    let n = (1 << (level + 1)) + 1;
    VertexId(n * (n - 1))
}

fn model(sheet: &Sheet, level: u32, kind: MassKind) -> SheetModel {
    SheetModel::new(sheet, 0.1, kind)
        .expect("valid")
        .with_gravity()
        .with_pins(&[corner(level)])
        .expect("the corner exists")
}

fn simulation(sheet: &Sheet, level: u32, start: State, method: Method) -> Simulation {
    let model = model(sheet, level, MassKind::Lumped);
    Simulation::new(model, start, method).expect("valid")
}

/// What is summed over the mesh in every iteration of a step; the matrix and its factorisation are in the
/// benches of the coordinates.
fn assembly(c: &mut Criterion) {
    let mut group = c.benchmark_group("assembly");
    for (level, size) in SIZES {
        let (sheet, state) = falling(level);
        for (name, kind) in [
            ("lumped", MassKind::Lumped),
            ("consistent", MassKind::Consistent),
        ] {
            let model = model(&sheet, level, kind);
            let mut residual = vec![0.0; model.rods().len()];
            let (mut force, mut weighted) = (vec![0.0; state.x.len()], vec![0.0; state.x.len()]);
            let name = format!("gradient, {name} mass");
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter(|| {
                    let x = black_box(&state.x);
                    model.rods().residual_into(x, &mut residual);
                    model.potential_force(state.t, x, &mut force);
                    model.rods().apply_transpose_add(x, &residual, &mut force);
                    model.apply_mass(&state.v, &mut weighted);
                });
            });
        }
    }
    group.finish();
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("step");
    for (level, size) in SIZES {
        let (sheet, state) = falling(level);
        // Conservative methods at a step that they accept whole next to singular states.
        let cases = [
            ("BDF2 1/60 s", Method::default(), 1.0 / 60.0),
            (
                "implicit Euler 1/60 s",
                Method::ImplicitEuler(Default::default()),
                1.0 / 60.0,
            ),
            (
                "energy-momentum 1 ms",
                Method::EnergyMomentum(Default::default()),
                1e-3,
            ),
            ("RATTLE 1 ms", Method::Rattle(Default::default()), 1e-3),
            (
                "RATTLE composition 1 ms",
                Method::RattleComposition(Default::default()),
                1e-3,
            ),
        ];
        for (name, method, h) in cases {
            group.bench_with_input(BenchmarkId::new(name, size), &h, |b, &h| {
                b.iter_batched(
                    || {
                        // After a first step, so that multipliers are warm as they are in a run.
                        let mut run = simulation(&sheet, level, state.clone(), method.clone());
                        run.step(h).ok();
                        run
                    },
                    |mut run| {
                        black_box(run.step(h).ok());
                        run
                    },
                    BatchSize::PerIteration,
                );
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(500));
    targets = assembly, steps
}
criterion_main!(benches);
