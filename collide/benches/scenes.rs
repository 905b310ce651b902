//! Two scenes in the middle of their runs, with meshes of 81 to 1089 vertices: a nearly flat sheet of 1 m
//! that is held at a corner, and the same sheet, free, above a table, with contact with the table and with
//! itself. Measured are the search for pairs, the narrow phase, the derivatives of contact, and one whole
//! step. A step continues from a checkpoint, so that history, multipliers and active contacts are those of
//! the run.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::contact::internals::{
    BarrierPotential, ContactSet, ContactTerms, CouplingSink, LaggedFriction,
};
use isosheet_dynamics::contact::{ActiveContacts, BodyMotions, Contact, JointMotion, StepSpan};
use isosheet_dynamics::{Checkpoint, Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::{Isometry3, Matrix3};
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Duration;

const SIZES: [(u32, &str); 3] = [(2, "81/128"), (3, "289/512"), (4, "1089/2048")];

/// Step, seconds.
const STEP: f64 = 1.0 / 60.0;

/// Height of the bump of the sheet and height of its rim above the table, metres.
const BUMP: f64 = 1e-3;
const CLEARANCE: f64 = 1e-3;

/// Half of the table's side, half of its thickness, metres.
const TABLE: [f64; 3] = [0.25, 0.25, 0.1];

/// Steps to two states of the run. Between them the rim of the cloth falls by some 0.4 m, many edge lengths.
const EARLY: usize = 24;
const LATE: usize = 30;

fn bumped(level: u32) -> Sheet {
    let flat = generate::isotropic_square(level, 1.0).expect("valid");
    let mut x = flat.positions().to_vec();
    for p in x.as_chunks_mut::<3>().0 {
        p[2] = BUMP * (PI * p[0]).sin() * (PI * p[1]).sin();
    }
    Sheet::new(x, &flat.face_indices()).expect("valid")
}

fn model(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .expect("a positive mass")
        .with_gravity()
}

/// The sheet held at the corner (0, 1).
fn held(sheet: &Sheet, level: u32) -> SheetModel {
    let n = (1 << (level + 1)) + 1;
    let corner = VertexId(n * (n - 1));
    model(sheet)
        .with_pins(&[corner])
        .expect("the corner exists")
}

fn contacts(model: &SheetModel) -> Contacts {
    let pose = Isometry3::translation(0.5, 0.5, -TABLE[2] - CLEARANCE);
    let table = Obstacle::fixed(Shape::Cuboid { half: TABLE }, pose).expect("a box");
    Contacts::new(model, ContactOptions::for_sheet(model))
        .and_then(|c| c.with_body(table, Coefficients::FRICTIONLESS))
        .and_then(|c| c.with_self_contact(Coefficients::FRICTIONLESS))
        .expect("valid options")
}

fn simulation(sheet: &Sheet, model: SheetModel) -> Simulation {
    let start = State::at_rest(sheet.positions().to_vec());
    Simulation::new(model, start, Method::default()).expect("valid")
}

fn advance(run: &mut Simulation, steps: usize) {
    for _ in 0..steps {
        run.step(STEP).expect("accepted");
    }
}

/// One step from the middle of the run, of which a new simulation is made for every measurement.
fn step(c: &mut Criterion, scene: &str, size: &str, resumed: &dyn Fn() -> Simulation) {
    let mut run = resumed();
    let report = run.step(STEP).expect("accepted");
    println!(
        "{scene}, {size}: {} factorisations in {} sub-steps",
        report.factorisations, report.substeps
    );
    let mut group = c.benchmark_group(scene);
    group.bench_function(BenchmarkId::new("warm step", size), |b| {
        b.iter_batched(
            resumed,
            |mut run| {
                black_box(run.step(STEP).ok());
                run
            },
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

fn hanging(c: &mut Criterion) {
    for (level, size) in SIZES {
        let sheet = bumped(level);
        let mut run = simulation(&sheet, held(&sheet, level));
        advance(&mut run, LATE);
        let middle: Checkpoint = run.checkpoint();
        step(c, "hanging sheet", size, &|| {
            Simulation::resume(held(&sheet, level), None, middle.clone()).expect("its own model")
        });
    }
}

fn tablecloth(c: &mut Criterion) {
    for (level, size) in SIZES {
        let sheet = bumped(level);
        let model = || model(&sheet);
        let mut run = simulation(&sheet, model())
            .with_contact(contacts(&model()))
            .expect("a start without touch");
        advance(&mut run, EARLY);
        let early = run.state().x.clone();
        advance(&mut run, LATE - EARLY);
        let late = run.state().x.clone();
        pieces(c, size, &sheet, [&early, &late]);
        let middle = run.checkpoint();
        step(c, "tablecloth with self-contact", size, &|| {
            let contact: Box<dyn Contact> = Box::new(contacts(&model()));
            Simulation::resume(model(), Some(contact), middle.clone()).expect("its own model")
        });
    }
}

/// Adds up entries, so that nothing is optimised away.
struct Sum(f64);

impl CouplingSink for Sum {
    fn add(&mut self, _: u32, _: u32, block: &Matrix3<f64>) {
        self.0 += block[(0, 0)] + block[(2, 1)];
    }
}

/// What a step asks of contact: at the later of two states, which are too far apart for common lists.
fn pieces(c: &mut Criterion, size: &str, sheet: &Sheet, [early, late]: [&[f64]; 2]) {
    let model = model(sheet);
    let mut contacts = contacts(&model);
    let start = State::at_rest(sheet.positions().to_vec());
    contacts
        .check_start(&model, &start)
        .expect("a start without touch");
    let barrier = BarrierPotential::at_start(contacts.laws(), &model, &start).expect("valid laws");
    let span = StepSpan { t0: 0.0, h: STEP };
    let bodies = BodyMotions::over(&contacts, span);
    // As short as the last motions of a step.
    let dx: Vec<f64> = (0..late.len())
        .map(|i| 1e-5 * (7.0 * i as f64).sin())
        .collect();
    let motion = |x| JointMotion {
        bodies: &bodies,
        progress: [1.0; 2],
        x,
        dx: &dx,
    };
    let mut group = c.benchmark_group("tablecloth with self-contact");
    let id = |what: &str| BenchmarkId::new(what, size);
    let mut set = ContactSet::of(&mut contacts, motion(early));
    // The state changes with every query, which makes the lists useless; the earlier state is not measured.
    group.bench_function(id("search, fresh"), |b| {
        b.iter_custom(|queries| {
            let mut time = Duration::ZERO;
            for _ in 0..queries {
                set.update(&mut contacts, motion(early));
                let clock = std::time::Instant::now();
                set.update(&mut contacts, motion(black_box(late)));
                time += clock.elapsed();
            }
            time
        });
    });
    group.bench_function(id("search, lists at hand"), |b| {
        b.iter(|| set.update(&mut contacts, motion(black_box(late))));
    });
    let mut active = ActiveContacts::at(&contacts, &set, 1.0, late);
    println!(
        "tablecloth, {size}: {} pairs, {} contacts, gap {}",
        set.pairs().len(),
        active.list().len(),
        active.gap()
    );
    group.bench_function(id("narrow phase"), |b| {
        b.iter(|| active.update(&contacts, &set, 1.0, black_box(late)));
    });
    let terms = ContactTerms {
        x: late,
        active: &active,
        barrier: &barrier,
        friction: &LaggedFriction::none(),
    };
    group.bench_function(id("gradient"), |b| {
        let mut out = vec![0.0; late.len()];
        b.iter(|| black_box(terms).add_gradient(1.0, &mut out));
    });
    group.bench_function(id("Hessian"), |b| {
        let mut sum = Sum(0.0);
        b.iter(|| black_box(terms).add_hessian(&mut sum));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(500));
    targets = hanging, tablecloth
}
criterion_main!(benches);
