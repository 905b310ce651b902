//! Distances, derivatives, collision times, the broad phase of a rolled sheet, and obstacles.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_geometry::distance::{edge_edge, point_triangle};
use isosheet_geometry::{BroadPhase, Candidates, CcdOptions, ContactMesh, Shape, TriangleSurface};
use isosheet_mesh::generate;
use nalgebra::Vector3;
use std::hint::black_box;
use std::time::Duration;

type Stencil = [Vector3<f64>; 4];

/// Stencils that fill the unit cube evenly, without a random number generator.
fn stencils(count: usize) -> Vec<Stencil> {
    // Fractional parts of multiples of square roots of primes.
    let roots = [
        2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0_f64,
    ]
    .map(f64::sqrt);
    (1..=count)
        .map(|i| {
            std::array::from_fn(|p| Vector3::from_fn(|k, _| (i as f64 * roots[3 * p + k]).fract()))
        })
        .collect()
}

fn queries(c: &mut Criterion) {
    let x = stencils(1000);
    let mut group = c.benchmark_group("1000 stencils");
    let sum = |f: &dyn Fn(&Stencil) -> f64| black_box(&x).iter().map(f).sum::<f64>();
    group.bench_function("point-triangle distance", |b| {
        b.iter(|| sum(&|x| point_triangle(x).distance2));
    });
    group.bench_function("edge-edge distance", |b| {
        b.iter(|| sum(&|x| edge_edge(x).distance2));
    });
    group.bench_function("edge-edge jet", |b| {
        b.iter(|| sum(&|x| edge_edge(x).jet(x).hessian[0][3][(0, 1)]));
    });
    let options = CcdOptions::default();
    let dx = stencils(2000).split_off(1000);
    let total = |f: &dyn Fn(&Stencil, &Stencil) -> f64| {
        let pairs = black_box(&x).iter().zip(&dx);
        pairs.map(|(x, dx)| f(x, dx)).sum::<f64>()
    };
    group.bench_function("point-triangle collision time", |b| {
        b.iter(|| total(&|x, dx| options.point_triangle(x, dx, 1.0)));
    });
    group.bench_function("edge-edge collision time", |b| {
        b.iter(|| total(&|x, dx| options.edge_edge(x, dx, 1.0)));
    });
    group.finish();
}

/// A unit sheet rolled into a spiral of two turns, `8 * 4^k` faces.
fn rolled(level: u32) -> (ContactMesh, Vec<f64>, Vec<f64>) {
    let sheet = generate::isotropic_square(level, 1.0).expect("a valid sheet");
    let flat = sheet.positions().to_vec();
    let mut x = flat.clone();
    for p in x.as_chunks_mut::<3>().0 {
        let angle = 4.0 * std::f64::consts::PI * p[0];
        let radius = 0.06 + 0.04 * p[0];
        *p = [radius * angle.cos(), p[1], radius * angle.sin()];
    }
    (ContactMesh::from_topology(sheet.topology()), flat, x)
}

fn broad_phase(c: &mut Criterion) {
    let mut group = c.benchmark_group("rolled sheet");
    // The paper's sizes, the next, and one where the price of the size shows.
    for level in [1, 2, 3, 4, 6] {
        let (mesh, flat, x) = rolled(level);
        let faces = mesh.faces().len();
        let h = 1.0 / f64::from(2_u32 << level);
        let mut phase = BroadPhase::new(mesh.clone(), &flat);
        let mut pairs = Candidates::default();
        phase.update(&x, &x, 0.05 * h);
        phase.self_candidates(&mut pairs);
        println!("{faces} faces: {} pairs", pairs.len());
        group.bench_function(BenchmarkId::new("refit", faces), |b| {
            b.iter(|| phase.update(black_box(&x), &x, 0.05 * h));
        });
        group.bench_function(BenchmarkId::new("pairs", faces), |b| {
            b.iter(|| phase.self_candidates(black_box(&mut pairs)));
        });
    }
    group.finish();
}

fn obstacles(c: &mut Criterion) {
    let points: Vec<Vector3<f64>> = stencils(1000).iter().map(|x| x[0]).collect();
    let cylinder = Shape::Cylinder {
        radius: 0.5,
        half_height: 0.3,
    };
    let prism = cylinder.contact_geometry(100);
    let prism = prism.expect("enough segments").expect("a finite body");
    let surface = TriangleSurface::new(&prism.positions, prism.mesh.faces()).expect("a prism");
    let mut group = c.benchmark_group("1000 points");
    group.bench_function("cylinder", |b| {
        b.iter(|| {
            let values = black_box(&points).iter();
            values
                .map(|p| cylinder.signed_distance(p).value)
                .sum::<f64>()
        });
    });
    group.bench_function("surface of 400 faces", |b| {
        b.iter(|| {
            let values = black_box(&points).iter();
            values
                .map(|p| surface.signed_distance(p).value)
                .sum::<f64>()
        });
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(500));
    targets = queries, broad_phase, obstacles
}
criterion_main!(benches);
