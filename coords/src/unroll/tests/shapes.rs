//! Surfaces made by formula.

use isosheet_mesh::{MeshError, Sheet};
use std::f64::consts::TAU;

/// The faces of a grid of `columns` by `rows` cells whose vertices are numbered by `number`.
fn cells(columns: usize, rows: usize, number: impl Fn(usize, usize) -> u32) -> Vec<[u32; 3]> {
    let cell = |k: usize| {
        let (i, j) = (k % columns, k / columns);
        let [a, b] = [number(i, j), number(i + 1, j)];
        let [d, c] = [number(i, j + 1), number(i + 1, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..columns * rows).flat_map(cell).collect()
}

/// A prism without its ends.
pub(super) fn cylinder(sides: usize, rings: usize, radius: f64, height: f64) -> Sheet {
    let mut x = Vec::new();
    for j in 0..=rings {
        for i in 0..sides {
            let (s, c) = (TAU * i as f64 / sides as f64).sin_cos();
            x.extend([radius * c, radius * s, height * j as f64 / rings as f64]);
        }
    }
    let faces = cells(sides, rings, |i, j| (j * sides + i % sides) as u32);
    Sheet::new(x, &faces).unwrap()
}

/// A pyramid without its base: the apex is vertex 0, at the origin, and its edges are `length` long.
pub(super) fn cone(sides: usize, rings: usize, half_angle: f64, length: f64) -> Sheet {
    let mut x = vec![0.0; 3];
    for j in 1..=rings {
        let out = length * j as f64 / rings as f64;
        for i in 0..sides {
            let (s, c) = (TAU * i as f64 / sides as f64).sin_cos();
            let r = out * half_angle.sin();
            x.extend([r * c, r * s, -out * half_angle.cos()]);
        }
    }
    let number = |i: usize, j: usize| (1 + j * sides + i % sides) as u32;
    let mut faces = cells(sides, rings - 1, number);
    // Seen from outside they run the other way round, as those at the apex do.
    faces.iter_mut().for_each(|f| f.swap(1, 2));
    faces.extend((0..sides).map(|i| [0, number(i, 0), number(i + 1, 0)]));
    Sheet::new(x, &faces).unwrap()
}

/// A strip of `columns` by `rows` cells of the surface `at(column, across)`, across from 0 to `width`.
pub(super) fn strip(
    columns: usize,
    rows: usize,
    at: impl Fn(f64, f64) -> [f64; 3],
    width: f64,
) -> Result<Sheet, MeshError> {
    let mut x = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            x.extend(at(i as f64, width * j as f64 / rows as f64));
        }
    }
    let faces = cells(columns, rows, |i, j| (j * (columns + 1) + i) as u32);
    Sheet::new(x, &faces)
}

/// A surface that closes in both directions.
pub(super) fn ring(columns: usize, rows: usize, at: impl Fn(usize, usize) -> [f64; 3]) -> Sheet {
    let places = (0..columns * rows).flat_map(|k| at(k % columns, k / columns));
    let number = |i: usize, j: usize| (j % rows * columns + i % columns) as u32;
    let faces = cells(columns, rows, number);
    Sheet::new(places.collect(), &faces).unwrap()
}

/// The convex hull of points of which no four are in a plane with all others on one side.
pub(super) fn hull(points: &[[f64; 3]]) -> Sheet {
    use isosheet_mesh::vec3::{cross, dot, sub};
    let n = points.len();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                let normal = cross(sub(points[b], points[a]), sub(points[c], points[a]));
                let others = (0..n).filter(|k| ![a, b, c].contains(k));
                let heights = others.map(|k| dot(normal, sub(points[k], points[a])));
                let (mut above, mut below) = (false, false);
                heights.for_each(|h| if h > 0.0 { above = true } else { below = true });
                if above != below {
                    let [a, b, c] = [a, b, c].map(|k| k as u32);
                    faces.push(if below { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let number = |v: u32| used.binary_search(&v).unwrap() as u32;
    let faces: Vec<[u32; 3]> = faces.iter().map(|f| f.map(number)).collect();
    Sheet::new(
        used.iter().flat_map(|v| points[*v as usize]).collect(),
        &faces,
    )
    .unwrap()
}
