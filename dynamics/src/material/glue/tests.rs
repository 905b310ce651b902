//! Glue against differences, closed forms and what it is for.

use super::*;
use crate::{Method, Profile, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, generate};

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

/// A triangle that hangs by glue on a pinned one: each pair carries its share of the weight, `k d = m g /
/// pairs`.
#[test]
fn glue_gives_way_by_its_load_over_its_stiffness() {
    let sheet = two_triangles();
    let x: Vec<f64> = sheet.positions().to_vec();
    // The second triangle is put onto the first.
    let on: Vec<f64> = x[..9].iter().chain(&x[..9]).copied().collect();
    let pairs = [[0, 3], [1, 4], [2, 5]].map(|pair| pair.map(VertexId));
    let (mass, stiffness) = (0.6, 50.0);
    let glue = Glue::new(sheet.topology(), &pairs, stiffness, 1.0, &on).unwrap();
    let model = SheetModel::new(&sheet, mass, MassKind::Lumped)
        .unwrap()
        .with_pins(&[0, 1, 2].map(VertexId))
        .unwrap()
        .with_gravity()
        .with_damping(20.0)
        .unwrap()
        .with_potential(glue);
    let mut simulation = Simulation::new(model, State::at_rest(on), Method::default()).unwrap();
    for _ in 0..300 {
        simulation.step(0.02).unwrap();
    }
    let expected = 0.5 * mass * 9.8 / 3.0 / stiffness;
    for v in 3..6 {
        let depth = -simulation.state().x[3 * v + 2];
        assert!((depth / expected - 1.0).abs() < 1e-6, "{depth} {expected}");
    }
}

/// A strip whose ends are glued by a driven closing, with and without half a turn, by rods and elastic: the
/// seam closes, and the sheet does what a band does.
#[test]
fn strips_close_to_bands() {
    let (columns, length, width) = (32, 0.3, 0.02);
    let strip = generate::grid(columns, 1, length, width, generate::Diagonals::Falling).unwrap();
    let row = columns as u32 + 1;
    let straight = [[0, row - 1], [row, 2 * row - 1]].map(|pair| pair.map(VertexId));
    let twisted = [[0, 2 * row - 1], [row, row - 1]].map(|pair| pair.map(VertexId));
    for pairs in [straight, twisted] {
        let mut x = strip.positions().to_vec();
        let stiffness = 1e3;
        let glue = Glue::new(strip.topology(), &pairs, stiffness, closing(), &x).unwrap();
        let bending = crate::CreaseSprings::bending(&strip, 1e-4).unwrap();
        let model = SheetModel::new(&strip, 5e-4, MassKind::Lumped)
            .unwrap()
            .with_damping(5.0)
            .unwrap()
            .with_potential(bending)
            .with_potential(glue);
        crate::leave_flat(&model, &mut x, 0.05, 1).unwrap();
        let mut simulation = Simulation::new(model, State::at_rest(x), Method::default()).unwrap();
        let mut worst = 0.0_f64;
        for _ in 0..90 {
            worst = worst.max(simulation.step(1.0 / 60.0).unwrap().strain);
        }
        assert!(worst < 1e-12, "{worst}");
        let x = &simulation.state().x;
        for [a, b] in pairs {
            let gap = (point(x, a) - point(x, b)).norm();
            // The moment of the bent strip over its width, as a force on the glue.
            assert!(gap < 1e-4 * length, "{gap}");
        }
        // The strip has left its plane, and its middle is about as far from the seam as a circle of its
        // length.
        let middle = point(x, VertexId(row / 2));
        let far = (middle - point(x, pairs[0][0])).norm();
        assert!(far > 0.2 * length, "{far}");
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
