//! Meshes and states shared by the tests of this crate.

use crate::cartesian_chart::{CartesianChart, Choice};
use crate::chart::Chart;
use crate::linearised::Linearised;
use crate::system::RodSystem;
use isosheet_mesh::{Sheet, VertexId};
use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The union-jack square, of sizes that exist.
pub(crate) fn isotropic_square(level: u32, side: f64) -> Sheet {
    isosheet_mesh::generate::isotropic_square(level, side).expect("a small level is valid")
}

/// A random planar triangulation: a square of two triangles, random faces split at random inner
/// points, then random edges flipped where their two triangles form a convex quadrilateral.
pub(crate) fn random_sheet(splits: usize, seed: u64) -> Sheet {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut p: Vec<[f64; 2]> = vec![[0.0, 0.0], [1.0, 0.0], [1.1, 0.9], [-0.1, 1.0]];
    let mut faces: Vec<[u32; 3]> = vec![[0, 1, 2], [0, 2, 3]];
    for _ in 0..splits {
        let f = rng.random_range(0..faces.len());
        let [a, b, c] = faces[f];
        let mut w = [0.0; 3].map(|_: f64| rng.random_range(0.2..0.6));
        let s: f64 = w.iter().sum();
        w = w.map(|v| v / s);
        let at =
            |i: usize| w[0] * p[a as usize][i] + w[1] * p[b as usize][i] + w[2] * p[c as usize][i];
        let n = p.len() as u32;
        p.push([at(0), at(1)]);
        faces[f] = [a, b, n];
        faces.extend([[b, c, n], [c, a, n]]);
    }
    let area = |p: &[[f64; 2]], f: [u32; 3]| {
        let [a, b, c] = f.map(|v| p[v as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    for _ in 0..5 * splits {
        let (f, i) = (
            rng.random_range(0..faces.len()),
            rng.random_range(0..3usize),
        );
        let [a, b, c] = [faces[f][i], faces[f][(i + 1) % 3], faces[f][(i + 2) % 3]];
        // The face on the other side of a-b runs b -> a -> d.
        let Some(g) = faces
            .iter()
            .position(|t| (0..3).any(|j| t[j] == b && t[(j + 1) % 3] == a))
        else {
            continue;
        };
        let d = faces[g].into_iter().find(|v| *v != a && *v != b);
        let Some(d) = d else { continue };
        let joined = faces.iter().any(|t| t.contains(&c) && t.contains(&d));
        let small = 0.3 * area(&p, faces[f]).min(area(&p, faces[g]));
        if !joined && area(&p, [a, d, c]) > small && area(&p, [d, b, c]) > small {
            faces[f] = [a, d, c];
            faces[g] = [d, b, c];
        }
    }
    let positions = p.iter().flat_map(|v| [v[0], v[1], 0.0]).collect();
    Sheet::new(positions, &faces).expect("flips keep a planar triangulation valid")
}

/// An m x m grid with moved vertices and random diagonals: inner vertices of degree 4 to 8.
pub(crate) fn irregular_grid(m: u32, seed: u64) -> Sheet {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let h = 1.0 / f64::from(m);
    let mut x = Vec::new();
    for j in 0..=m {
        for i in 0..=m {
            let mut moved = |k: u32| h * (f64::from(k) + rng.random_range(-0.2..0.2));
            x.extend([moved(i), moved(j), 0.0]);
        }
    }
    let mut faces = Vec::new();
    for j in 0..m {
        for i in 0..m {
            let a = i + j * (m + 1);
            let (b, c, d) = (a + 1, a + m + 2, a + m + 1);
            if rng.random_range(0..2) == 0 {
                faces.extend([[a, b, c], [a, c, d]]);
            } else {
                faces.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    Sheet::new(x, &faces).expect("vertices move too little to turn a face over")
}

/// A bent state with exact lengths: noise out of plane of size `noise`, then Newton's method on the
/// lengths with selected coordinates fixed. `None` where that does not lead to a regular state.
pub(crate) fn bent(sheet: &Sheet, pins: &[VertexId], noise: f64, seed: u64) -> Option<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut x = sheet.positions().to_vec();
    for z in x.iter_mut().skip(2).step_by(3) {
        *z = noise * rng.random_range(-1.0..1.0);
    }
    for v in pins {
        x[3 * v.index() + 2] = 0.0;
    }
    let system = RodSystem::new(sheet, pins).ok()?;
    let chart = CartesianChart::new(system.clone(), Choice::Auto, &x).ok()?;
    let mut linear = Linearised::new(&system, chart.pattern()).ok()?;
    let mut q = vec![0.0; chart.dimension()];
    chart.coordinates(&x, &mut q).ok()?;
    let near = x.clone();
    chart.realise(&mut linear, &q, &near, &mut x).ok()?;
    // Vertices of degree 3 and unlucky noise lead to states where the length equations are nearly
    // dependent; those are not what is tested here.
    let mut g = DMatrix::zeros(system.equations(), system.unknowns());
    for ((e, u), value) in system.jacobian_entries().zip(system.jacobian_values(&x)) {
        g[(e as usize, u as usize)] = value;
    }
    let values = g.singular_values();
    (values.min() > 3e-3 * values.max()).then_some(x)
}
