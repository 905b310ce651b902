//! Placement, charts and sparse linear algebra at the paper's mesh sizes and the next.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_coords::linalg::{Ordering, Pattern, SparseLlt, elimination_order};
use isosheet_coords::{
    BentState, CartesianChart, Chart, Choice, FrontMap, Linearised, RealiseOptions, RodSystem,
    SaddlePoint, StartVertex, bent_square, sys_coord_assnmt_single,
};
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId, generate};
use std::hint::black_box;
use std::time::Duration;

const SIZES: [(u32, &str); 4] = [
    (1, "25/32"),
    (2, "81/128"),
    (3, "289/512"),
    (4, "1089/2048"),
];

fn sheet(level: u32) -> Sheet {
    generate::isotropic_square(level, 1.0).expect("valid")
}

fn placement(c: &mut Criterion) {
    let mut group = c.benchmark_group("placement");
    for (level, size) in SIZES {
        let sheet = sheet(level);
        // Bent to a cylinder: away from the flat state, where placements are at the edge of their range.
        let bent = bent_square(&sheet, level, BentState::Cylinder);
        let bent_sheet = Sheet::new(bent.clone(), &sheet.face_indices()).expect("valid");
        let assign = || sys_coord_assnmt_single(&bent_sheet, StartVertex::Pinned(VertexId(0)));
        group.bench_function(BenchmarkId::new("assignment", size), |b| {
            b.iter(|| assign().expect("assigned"));
        });
        let map = FrontMap::new(
            &bent_sheet,
            assign().expect("assigned"),
            &bent,
            RealiseOptions::default(),
        )
        .expect("placed");
        let mut q = vec![0.0; map.coordinate_count()];
        map.coordinates(&bent, &mut q).expect("defined");
        let mut x = bent.clone();
        group.bench_function(BenchmarkId::new("realise", size), |b| {
            // From 289/512 on many of these realisations fail because of round-off; then the time up to the
            // failure is measured.
            b.iter(|| black_box(map.realise(black_box(&q), &bent, &mut x).is_ok()));
        });
    }
    group.finish();
}

fn charts(c: &mut Criterion) {
    let mut group = c.benchmark_group("chart");
    for (level, size) in SIZES {
        let sheet = sheet(level);
        let x = bent_square(&sheet, level, BentState::Cylinder);
        let system = RodSystem::new(&sheet, &[VertexId(0)]).expect("valid");
        // The dense choice of the best coordinates takes seconds at the largest size.
        if level < 4 {
            group.bench_function(BenchmarkId::new("choose Cartesian", size), |b| {
                b.iter(|| CartesianChart::new(system.clone(), Choice::Auto, &x).expect("a chart"));
            });
        }
        let chart = CartesianChart::new(system.clone(), Choice::Auto, &x).expect("a chart");
        let mut linear = Linearised::new(&system, chart.pattern()).expect("analysed");
        group.bench_function(BenchmarkId::new("factorise [G; S]", size), |b| {
            b.iter(|| {
                chart
                    .linearise(&system, &mut linear, black_box(&x))
                    .expect("regular");
            });
        });
        let mass = MassMatrix::from_total(&sheet, 0.1, MassKind::Lumped).expect("valid");
        let mut saddle = SaddlePoint::new(&system, &mass).expect("analysed");
        group.bench_function(BenchmarkId::new("factorise saddle point", size), |b| {
            b.iter(|| saddle.factorize(&system, black_box(&x)).expect("regular"));
        });
        let force = vec![1.0; system.unknowns()];
        let rate = vec![0.0; system.equations()];
        let (mut v, mut mu) = (force.clone(), rate.clone());
        group.bench_function(BenchmarkId::new("solve saddle point", size), |b| {
            b.iter(|| {
                saddle
                    .solve(&force, &rate, &mut v, &mut mu)
                    .expect("regular")
            });
        });
    }
    group.finish();
}

/// Entries of `M + G^T G` in blocks of three, and their terms.
fn stiff(sheet: &Sheet, x: &[f64]) -> (Vec<(u32, u32)>, Vec<f64>) {
    let (mut entries, mut terms) = (Vec::new(), Vec::new());
    for v in 0..sheet.topology().vertex_count() as u32 {
        for r in 0..3 {
            for c in 0..=r {
                entries.push((3 * v + r, 3 * v + c));
                terms.push(if r == c { 1e-4 } else { 0.0 });
            }
        }
    }
    for &[a, b] in sheet.topology().edges() {
        let (a, b) = (a.index(), b.index());
        let d: [f64; 3] = std::array::from_fn(|k| x[3 * a + k] - x[3 * b + k]);
        for (i, j, sign) in [(a, a, 1.0), (b, b, 1.0), (a.max(b), a.min(b), -1.0)] {
            for r in 0..3 {
                for c in 0..(if i == j { r + 1 } else { 3 }) {
                    entries.push(((3 * i + r) as u32, (3 * j + c) as u32));
                    terms.push(sign * d[r] * d[c]);
                }
            }
        }
    }
    (entries, terms)
}

fn cholesky(c: &mut Criterion) {
    let mut group = c.benchmark_group("primal matrix");
    for (level, size) in SIZES {
        let sheet = sheet(level);
        let x = bent_square(&sheet, level, BentState::Cylinder);
        let (entries, terms) = stiff(&sheet, &x);
        let (pattern, slots) = Pattern::from_entries(x.len(), x.len(), &entries);
        for (name, ordering) in [
            ("order by minimum degree", Ordering::MinimumDegree),
            ("order by nested dissection", Ordering::NestedDissection),
        ] {
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter(|| elimination_order(black_box(&pattern), 3, ordering));
            });
        }
        group.bench_function(BenchmarkId::new("analyse", size), |b| {
            b.iter(|| SparseLlt::with_blocks(pattern.clone(), 3).expect("analysed"));
        });
        let mut llt = SparseLlt::with_blocks(pattern.clone(), 3).expect("analysed");
        group.bench_function(BenchmarkId::new("scatter", size), |b| {
            b.iter(|| {
                let values = llt.values_mut();
                values.fill(0.0);
                for (slot, term) in slots.iter().zip(black_box(&terms)) {
                    values[*slot as usize] += term;
                }
            });
        });
        group.bench_function(BenchmarkId::new("assemble", size), |b| {
            b.iter(|| {
                let (_, terms) = stiff(&sheet, black_box(&x));
                let values = llt.values_mut();
                values.fill(0.0);
                for (slot, term) in slots.iter().zip(&terms) {
                    values[*slot as usize] += term;
                }
            });
        });
        group.bench_function(BenchmarkId::new("factorise", size), |b| {
            b.iter(|| llt.factorize().expect("positive definite"));
        });
        let mut rhs = vec![1.0; x.len()];
        group.bench_function(BenchmarkId::new("solve", size), |b| {
            b.iter(|| {
                rhs.fill(1.0);
                llt.solve(black_box(&mut rhs));
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(400));
    targets = placement, charts, cholesky
}
criterion_main!(benches);
