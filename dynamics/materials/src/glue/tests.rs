//! Glue against differences, closed forms and what it is for.

use super::*;
use isosheet_mesh::Sheet;

fn two_triangles() -> Sheet {
    let (first, second) = ([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], 1.5);
    let moved = first.iter().enumerate().map(|(i, c)| match i % 3 {
        0 => c + second,
        _ => *c,
    });
    let positions = first.iter().copied().chain(moved).collect();
    Sheet::new(positions, &[[0, 1, 2], [3, 4, 5]]).unwrap()
}

/// Smooth from 0 to 1 between the times 0 and 1.
fn closing() -> Profile {
    Profile::SmoothStep {
        from: 0.0,
        to: 1.0,
        begin: 0.0,
        end: 1.0,
    }
}

/// A sink that is a dense matrix.
struct Dense<'a>(&'a Topology, Vec<f64>);

impl HessianSink for Dense<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.add_pair(v, v, &(0.5 * block));
    }
    fn add_edge(&mut self, e: isosheet_mesh::EdgeId, block: &Matrix3<f64>) {
        let [a, b] = self.0.edges()[e.index()];
        self.add_pair(a, b, block);
    }
    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        let n = 3 * self.0.vertex_count();
        for r in 0..3 {
            for c in 0..3 {
                self.1[(3 * a.index() + r) * n + 3 * b.index() + c] += block[(r, c)];
                self.1[(3 * b.index() + c) * n + 3 * a.index() + r] += block[(r, c)];
            }
        }
    }
}

#[test]
fn derivatives_match_differences() {
    let sheet = two_triangles();
    let t = sheet.topology();
    let pairs = [[1, 3], [2, 4], [0, 5]].map(|pair| pair.map(VertexId));
    let glue = Glue::new(t, &pairs, 3.0, closing(), sheet.positions()).unwrap();
    let mut x = sheet.positions().to_vec();
    for (i, x) in x.iter_mut().enumerate() {
        *x += 0.1 * (1.7 * i as f64).sin();
    }
    let gradient = |x: &[f64]| {
        let mut g = vec![0.0; x.len()];
        glue.add_gradient(At::new(0.3, x), &mut g);
        g
    };
    let n = x.len();
    let mut hessian = Dense(t, vec![0.0; n * n]);
    glue.add_hessian(At::new(0.3, &x), &mut hessian);
    let (g, h) = (gradient(&x), 1e-3);
    for i in 0..n {
        let [mut up, mut down] = [x.clone(), x.clone()];
        up[i] += h;
        down[i] -= h;
        // The energy is quadratic, so that central differences are exact.
        let slope = (glue.energy(At::new(0.3, &up)) - glue.energy(At::new(0.3, &down))) / (2.0 * h);
        assert!((slope - g[i]).abs() < 1e-11);
        let column = gradient(&up)
            .iter()
            .zip(gradient(&down))
            .map(|(a, b)| (a - b) / (2.0 * h))
            .collect::<Vec<_>>();
        for (j, c) in column.iter().enumerate() {
            assert!((c - hessian.1[j * n + i]).abs() < 1e-11, "{j} {i}");
        }
    }
}

#[test]
fn senseless_glue_is_refused() {
    let sheet = two_triangles();
    let (t, x) = (sheet.topology(), sheet.positions());
    let glue = |a, b, k: f64| Glue::new(t, &[[VertexId(a), VertexId(b)]], k, 1.0, x);
    assert!(matches!(glue(0, 1, 1.0), Err(GlueError::Neighbours { .. })));
    assert!(matches!(glue(0, 0, 1.0), Err(GlueError::Neighbours { .. })));
    assert!(matches!(glue(0, 6, 1.0), Err(GlueError::NoVertex { .. })));
    for k in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(glue(0, 3, k), Err(GlueError::Stiffness { .. })));
    }
    let wrong = Glue::new(t, &[], 1.0, f64::NAN, x);
    assert!(matches!(wrong, Err(GlueError::Closing(_))));
}
