//! Topology, lengths and masses at the paper's mesh sizes and the next.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use isosheet_mesh::{LengthConstraints, MassKind, MassMatrix, Topology, generate};
use std::hint::black_box;
use std::time::Duration;

const SIZES: [(u32, &str); 4] = [
    (1, "25/32"),
    (2, "81/128"),
    (3, "289/512"),
    (4, "1089/2048"),
];

fn mesh(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh");
    for (level, size) in SIZES {
        let sheet = generate::isotropic_square(level, 1.0).expect("valid");
        let faces = sheet.face_indices();
        let vertices = sheet.topology().vertex_count();
        group.bench_function(BenchmarkId::new("topology", size), |b| {
            b.iter(|| Topology::from_faces(vertices, black_box(&faces)).expect("a manifold"));
        });
        let rods = LengthConstraints::new(&sheet);
        let x = sheet.positions();
        let mut residual = vec![0.0; rods.len()];
        group.bench_function(BenchmarkId::new("length residuals", size), |b| {
            b.iter(|| rods.residual_into(black_box(x), &mut residual));
        });
        let mut force = vec![0.0; x.len()];
        group.bench_function(BenchmarkId::new("G^T lambda", size), |b| {
            b.iter(|| rods.apply_transpose_add(black_box(x), &residual, &mut force));
        });
        let mass = MassMatrix::from_total(&sheet, 0.1, MassKind::Consistent).expect("valid");
        group.bench_function(BenchmarkId::new("kinetic energy", size), |b| {
            b.iter(|| mass.kinetic_energy(sheet.topology(), black_box(x)));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(500));
    targets = mesh
}
criterion_main!(benches);
