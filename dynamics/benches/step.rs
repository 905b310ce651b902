//! One step of each integrator at the paper's mesh sizes: a sheet of 1 m and 0.1 kg held at a
//! corner, in mid-fall.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use std::f64::consts::PI;
use std::hint::black_box;

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

fn simulation(sheet: &Sheet, level: u32, start: State, method: Method) -> Simulation {
    let n = (1 << (level + 1)) + 1;
    let model = SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_pins(&[VertexId(n * (n - 1))])
        .expect("the corner exists");
    Simulation::new(model, start, method).expect("valid")
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("step");
    for (level, size) in [
        (1, "25/32"),
        (2, "81/128"),
        (3, "289/512"),
        (4, "1089/2048"),
    ] {
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
                "projection 1/60 s",
                Method::Projection(Default::default()),
                1.0 / 60.0,
            ),
            (
                "energy-momentum 1 ms",
                Method::EnergyMomentum(Default::default()),
                1e-3,
            ),
            ("RATTLE 1 ms", Method::Rattle(Default::default()), 1e-3),
        ];
        for (name, method, h) in cases {
            group.bench_with_input(BenchmarkId::new(name, size), &h, |b, &h| {
                b.iter_batched(
                    || simulation(&sheet, level, state.clone(), method.clone()),
                    |mut run| {
                        // Five steps, so that multipliers are warm as they are in a run.
                        for _ in 0..5 {
                            black_box(run.step(h).ok());
                        }
                    },
                    BatchSize::LargeInput,
                );
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(std::time::Duration::from_secs(2));
    targets = steps
}
criterion_main!(benches);
