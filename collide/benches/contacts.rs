//! Contact as a step of the dynamics asks for it, at the paper's mesh sizes and the next.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::contact::internals::{
    BarrierPotential, ContactSet, ContactTerms, CouplingSink, Course, LaggedFriction,
};
use isosheet_dynamics::contact::{ActiveContacts, BodyMotions, Contact, JointMotion, StepSpan};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, generate};
use nalgebra::{Isometry3, Matrix3};
use std::hint::black_box;
use std::time::Duration;

struct Sum(f64);

impl CouplingSink for Sum {
    fn add(&mut self, _: u32, _: u32, block: &Matrix3<f64>) {
        self.0 += block[(0, 0)] + block[(2, 1)];
    }
}

fn model(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .expect("a positive mass")
        .with_gravity()
}

const SIZES: [(u32, &str); 4] = [
    (1, "25/32"),
    (2, "81/128"),
    (3, "289/512"),
    (4, "1089/2048"),
];

fn pieces(
    c: &mut Criterion,
    [name, size]: [&str; 2],
    mut contacts: Contacts,
    model: &SheetModel,
    x: &[f64],
) {
    let start = State::at_rest(x.to_vec());
    contacts
        .check_start(model, &start)
        .expect("a start without touch");
    let barrier = BarrierPotential::at_start(contacts.laws(), model, &start).expect("valid laws");
    let span = StepSpan {
        t0: 0.0,
        h: 1.0 / 60.0,
    };
    let bodies = BodyMotions::over(&contacts, span);
    let dx: Vec<f64> = (0..x.len())
        .map(|i| 1e-5 * (7.0 * i as f64).sin())
        .collect();
    let motion = |x| JointMotion {
        bodies: &bodies,
        progress: [1.0; 2],
        x,
        dx: &dx,
    };
    let mut set = ContactSet::of(&mut contacts, motion(x));
    let mut active = ActiveContacts::at(&contacts, &set, 1.0, x);
    println!(
        "{name}, {size}: safe {}, {} pairs, {} contacts, gap {}",
        set.safe_fraction(),
        set.pairs().len(),
        active.list().len(),
        active.gap()
    );
    let mut friction = LaggedFriction::none();
    let mut group = c.benchmark_group(name);
    let id = |what: &str| BenchmarkId::new(what, size);
    group.bench_function(id("query"), |b| {
        b.iter(|| set.update(&mut contacts, motion(black_box(x))));
    });
    group.bench_function(id("evaluate"), |b| {
        b.iter(|| active.update(&contacts, &set, 1.0, black_box(x)));
    });
    group.bench_function(id("lag friction"), |b| {
        b.iter(|| {
            friction.lag(
                contacts.laws(),
                &barrier,
                black_box(&active),
                Course::from_start(x, span.h),
                x,
            );
        });
    });
    let terms = ContactTerms {
        x,
        active: &active,
        barrier: &barrier,
        friction: &friction,
    };
    group.bench_function(id("energy"), |b| b.iter(|| black_box(terms).energy()));
    group.bench_function(id("gradient"), |b| {
        let mut out = vec![0.0; x.len()];
        b.iter(|| black_box(terms).add_gradient(1.0, &mut out));
    });
    group.bench_function(id("Hessian"), |b| {
        let mut sum = Sum(0.0);
        b.iter(|| black_box(terms).add_hessian(&mut sum));
    });
    group.finish();
}

fn tables(c: &mut Criterion) {
    for (level, size) in SIZES {
        table(c, level, size);
    }
}

fn table(c: &mut Criterion, level: u32, size: &str) {
    let sheet = generate::isotropic_square(level, 1.0).expect("a valid sheet");
    let model = model(&sheet);
    let options = ContactOptions::for_sheet(&model);
    let half = Shape::Cuboid {
        half: [0.25, 0.25, 0.1],
    };
    let pose = Isometry3::translation(0.5, 0.5, -0.1 - 0.5 * options.activation);
    let body = Obstacle::fixed(half, pose).expect("a box");
    for (name, coefficients) in [
        ("table", Coefficients::FRICTIONLESS),
        ("rough table", Coefficients::equal(0.3)),
    ] {
        let contacts = Contacts::new(&model, options)
            .and_then(|c| c.with_body(body.clone(), coefficients))
            .expect("valid options");
        pieces(c, [name, size], contacts, &model, sheet.positions());
    }
}

fn rolls(c: &mut Criterion) {
    // The spiral of the coarser meshes passes through itself.
    for (level, size) in &SIZES[2..] {
        rolled(c, *level, size);
    }
}

fn rolled(c: &mut Criterion, level: u32, size: &str) {
    let sheet = generate::isotropic_square(level, 1.0).expect("a valid sheet");
    let model = model(&sheet);
    let mut x = sheet.positions().to_vec();
    for p in x.as_chunks_mut::<3>().0 {
        let angle = 4.0 * std::f64::consts::PI * p[0];
        let radius = 0.06 + 0.04 * p[0];
        *p = [radius * angle.cos(), p[1], radius * angle.sin()];
    }
    for (name, activation) in [
        ("rolled", None),
        ("rolled, layers in contact", Some(0.0185)),
    ] {
        let defaults = ContactOptions::for_sheet(&model);
        let options = ContactOptions {
            activation: activation.unwrap_or(defaults.activation),
            ..defaults
        };
        let contacts = Contacts::new(&model, options)
            .and_then(|c| c.with_self_contact(Coefficients::FRICTIONLESS))
            .expect("valid options");
        pieces(c, [name, size], contacts, &model, &x);
    }
}

/// Five steps of a cloth on a table, from rest within reach of it, by the methods that take contact.
fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("five steps on a table");
    for (level, size) in SIZES {
        let sheet = generate::isotropic_square(level, 1.0).expect("a valid sheet");
        let start = || {
            let model = model(&sheet);
            let options = ContactOptions::for_sheet(&model);
            let half = Shape::Cuboid {
                half: [0.25, 0.25, 0.1],
            };
            let pose = Isometry3::translation(0.5, 0.5, -0.1 - 0.95 * options.activation);
            let body = Obstacle::fixed(half, pose).expect("a box");
            let contacts = Contacts::new(&model, options)
                .and_then(|c| c.with_body(body, Coefficients::FRICTIONLESS))
                .expect("valid options");
            (model, contacts)
        };
        for (name, method) in [
            ("BDF2", Method::default()),
            ("implicit Euler", Method::ImplicitEuler(Default::default())),
        ] {
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter_batched(
                    || {
                        let (model, contacts) = start();
                        let state = State::at_rest(sheet.positions().to_vec());
                        Simulation::new(model, state, method.clone())
                            .and_then(|s| s.with_contact(contacts))
                            .expect("a start without touch")
                    },
                    |mut run| {
                        for _ in 0..5 {
                            black_box(run.step(1.0 / 240.0).ok());
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
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(300));
    targets = tables, rolls, steps
}
criterion_main!(benches);
