//! Random stencils, difference quotients, and queries over candidate pairs for the tests.

use crate::distance::{Jet, edge_edge, point_triangle};
use crate::vectors::{gather, smaller};
use crate::{Candidates, CcdOptions, ContactMesh};
use nalgebra::Vector3;
use proptest::prelude::*;

/// `N` points in the cube `[-1, 1]^3`.
pub(crate) fn points<const N: usize>() -> impl Strategy<Value = [Vector3<f64>; N]> {
    proptest::collection::vec(proptest::array::uniform3(-1.0..1.0_f64), N)
        .prop_map(|list| std::array::from_fn(|i| Vector3::from(list[i])))
}

/// Sizes from a micrometre to a kilometre.
pub(crate) fn sizes() -> impl Strategy<Value = f64> {
    (-6.0..3.0_f64).prop_map(|p| 10.0_f64.powf(p))
}

/// A rotation and a translation of the order of `size`, applied to the points scaled by `size`.
pub(crate) fn place<const N: usize>(
    x: &[Vector3<f64>; N],
    size: f64,
    pose: &[f64; 6],
) -> [Vector3<f64>; N] {
    let rotation = nalgebra::Rotation3::new(3.0 * Vector3::new(pose[0], pose[1], pose[2]));
    let shift = Vector3::new(pose[3], pose[4], pose[5]);
    x.map(|p| size * (rotation * p + shift))
}

/// Compares gradient and Hessian with central differences. `length` is the length over which the
/// function changes.
pub(crate) fn check_jet<const N: usize>(
    x: &[Vector3<f64>; N],
    length: f64,
    f: &dyn Fn(&[Vector3<f64>; N]) -> Jet<N>,
) {
    let at = f(x);
    // Round-off and the h^2 term balance at the cube root of the machine precision.
    let h = 6e-6 * length;
    let steepest = at.gradient.iter().map(|g| g.norm()).fold(0.0, f64::max);
    let curvature = (0..N * N)
        .map(|k| at.hessian[k / N][k % N].norm())
        .fold(0.0, f64::max);
    let slope_scale = steepest + curvature * length + at.value.abs() / length;
    let curvature_scale = curvature + steepest / length + at.value.abs() / (length * length);
    for j in 0..N {
        for k in 0..3 {
            let shifted = |d: f64| {
                let mut y = *x;
                y[j][k] += d;
                f(&y)
            };
            let (up, down) = (shifted(h), shifted(-h));
            let slope = (up.value - down.value) / (2.0 * h);
            assert!(
                (slope - at.gradient[j][k]).abs() <= 1e-7 * slope_scale,
                "slope {j},{k}: {slope} against {}",
                at.gradient[j][k]
            );
            for i in 0..N {
                let column = (up.gradient[i] - down.gradient[i]) / (2.0 * h);
                let error = (column - at.hessian[i][j].column(k)).norm();
                assert!(
                    error <= 1e-6 * curvature_scale,
                    "curvature {i},{j},{k}: {column} against {}",
                    at.hessian[i][j]
                );
            }
        }
    }
}

/// The vertices of the pairs of a vertex and a face, and those of the pairs of two edges.
fn stencils(mesh: &ContactMesh, pairs: &Candidates) -> [Vec<[u32; 4]>; 2] {
    let vertex_face = pairs.vertex_face.iter().map(|&[v, f]| {
        let [a, b, c] = mesh.faces()[f as usize];
        [v, a, b, c]
    });
    let edge_edge = pairs.edge_edge.iter().map(|&[e, g]| {
        let ([a, b], [c, d]) = (mesh.edges()[e as usize], mesh.edges()[g as usize]);
        [a, b, c, d]
    });
    [vertex_face.collect(), edge_edge.collect()]
}

/// Part of the motion from `x` to `x + dx` that brings no pair to within the separation of the options.
pub(crate) fn safe_part(
    mesh: &ContactMesh,
    pairs: &Candidates,
    options: &CcdOptions,
    [x, dx]: [&[f64]; 2],
) -> f64 {
    let [vertex_face, edge_edge] = stencils(mesh, pairs);
    let part = vertex_face.into_iter().fold(1.0, |part, stencil| {
        options.point_triangle(&gather(x, stencil), &gather(dx, stencil), part)
    });
    edge_edge.into_iter().fold(part, |part, stencil| {
        options.edge_edge(&gather(x, stencil), &gather(dx, stencil), part)
    })
}

/// Smallest distance of the pairs at positions `x`, metres.
pub(crate) fn smallest_distance(mesh: &ContactMesh, pairs: &Candidates, x: &[f64]) -> f64 {
    let [vertex_face, two_edges] = stencils(mesh, pairs);
    let faces = vertex_face
        .into_iter()
        .map(|stencil| point_triangle(&gather(x, stencil)).distance());
    let edges = two_edges
        .into_iter()
        .map(|stencil| edge_edge(&gather(x, stencil)).distance());
    faces.chain(edges).fold(f64::INFINITY, smaller)
}
