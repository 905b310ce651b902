//! Steps in a chart at the paper's mesh sizes: a sheet of 1 m and 0.1 kg held at a corner, in mid-fall.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_charts::{ChartMethod, ChartOptions, ChartStepControl, MassSolverKind};
use isosheet_coords::{CartesianChart, Choice, RodSystem};
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

const SIZES: [(u32, &str); 3] = [(1, "25/32"), (2, "81/128"), (3, "289/512")];

fn corner(level: u32) -> VertexId {
    let n = (1 << (level + 1)) + 1;
    VertexId(n * (n - 1))
}

fn model(sheet: &Sheet, level: u32) -> SheetModel {
    SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_pins(&[corner(level)])
        .expect("the corner exists")
}

fn simulation(sheet: &Sheet, level: u32, start: State, method: Method) -> Simulation {
    let model = model(sheet, level);
    Simulation::new(model, start, method).expect("valid")
}

/// In a chart of well-chosen Cartesian coordinates.
fn chart_steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("step in a chart");
    let h = 1e-5;
    for (level, size) in &SIZES {
        let (sheet, state) = falling(*level);
        for (name, method) in [
            ("Runge-Kutta 4", ChartMethod::RungeKutta4),
            ("forward Euler", ChartMethod::ForwardEuler),
        ] {
            for (solver, kind) in [
                ("saddle", MassSolverKind::Saddle),
                ("dense LU", MassSolverKind::DenseLu),
                ("Cramer's rule", MassSolverKind::Cramer),
            ] {
                let system = RodSystem::new(&sheet, &[corner(*level)]).expect("valid");
                if kind == MassSolverKind::Cramer && system.dof() > 40 {
                    continue;
                }
                let chart = CartesianChart::new(system, Choice::Auto, &state.x).expect("a chart");
                let options = ChartOptions {
                    method,
                    solver: kind,
                    control: ChartStepControl::Fixed(h),
                    ..Default::default()
                };
                let model = model(&sheet, *level);
                let run = isosheet_charts::in_chart(model, state.clone(), Box::new(chart), options);
                let mut run = run.expect("a regular state");
                let id = BenchmarkId::new(format!("{name}, {solver}"), size);
                // So short that thousands of them stay in mid-fall.
                group.bench_function(id, |b| b.iter(|| black_box(run.step(h).ok())));
            }
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
    targets = chart_steps
}
criterion_main!(benches);
