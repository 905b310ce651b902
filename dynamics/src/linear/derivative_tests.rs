//! The matrices of the implicit methods against finite differences of what they are derivatives of.

use crate::conservative::saddle::{SaddleMatrix, System};
use crate::linear::primal::PrimalMatrix;
use crate::linear::primal::testing::add_potentials;
use crate::{At, HessianSink, Potential, SheetModel};
use isosheet_mesh::{EdgeId, MassKind, Sheet, VertexId, generate};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// `k/4 |x_a - x_b|^4` along every edge: couples the ends of the rods.
#[derive(Debug)]
struct Quartic {
    edges: Vec<[usize; 2]>,
    stiffness: f64,
}

impl Quartic {
    fn difference(x: &[f64], [a, b]: [usize; 2]) -> Vector3<f64> {
        Vector3::from_fn(|k, _| x[3 * a + k] - x[3 * b + k])
    }
}

impl Potential for Quartic {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { x, .. } = at;
        self.edges
            .iter()
            .map(|&e| 0.25 * self.stiffness * Self::difference(x, e).norm_squared().powi(2))
            .sum()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { x, .. } = at;
        for &e in &self.edges {
            let d = Self::difference(x, e);
            for k in 0..3 {
                let f = self.stiffness * d.norm_squared() * d[k];
                gradient[3 * e[0] + k] += f;
                gradient[3 * e[1] + k] -= f;
            }
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let At { x, .. } = at;
        for (i, &e) in self.edges.iter().enumerate() {
            let d = Self::difference(x, e);
            let block =
                self.stiffness * (Matrix3::identity() * d.norm_squared() + 2.0 * d * d.transpose());
            hessian.add_vertex(VertexId(e[0] as u32), &block);
            hessian.add_vertex(VertexId(e[1] as u32), &block);
            hessian.add_edge(EdgeId(i as u32), &-block);
        }
    }
}

/// A potential whose edge blocks are not symmetric, so that a transposed block shows:
/// `sum_e (x_a . p)(x_b . q)`.
#[derive(Debug)]
struct Bilinear {
    edges: Vec<[usize; 2]>,
}

const P: [f64; 3] = [0.3, -1.0, 0.7];
const Q: [f64; 3] = [1.1, 0.4, -0.2];

impl Potential for Bilinear {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { x, .. } = at;
        let at = |v: usize, w: [f64; 3]| (0..3).map(|k| x[3 * v + k] * w[k]).sum::<f64>();
        self.edges.iter().map(|&[a, b]| at(a, P) * at(b, Q)).sum()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { x, .. } = at;
        let at = |v: usize, w: [f64; 3]| (0..3).map(|k| x[3 * v + k] * w[k]).sum::<f64>();
        for &[a, b] in &self.edges {
            for k in 0..3 {
                gradient[3 * a + k] += P[k] * at(b, Q);
                gradient[3 * b + k] += Q[k] * at(a, P);
            }
        }
    }

    fn add_hessian(&self, _at: At<'_>, hessian: &mut dyn HessianSink) {
        let block = Vector3::from(P) * Vector3::from(Q).transpose();
        for i in 0..self.edges.len() {
            hessian.add_edge(EdgeId(i as u32), &block);
        }
    }
}

struct Setup {
    model: SheetModel,
    x: Vec<f64>,
    density: Vec<f64>,
    direction: Vec<f64>,
}

fn setup(kind: MassKind) -> Setup {
    let flat = generate::isotropic_square(0, 1.0).expect("valid");
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let x: Vec<f64> = flat
        .positions()
        .iter()
        .map(|p| p + rng.random_range(-0.1..0.1))
        .collect();
    let sheet = Sheet::new(x.clone(), &flat.face_indices()).expect("valid");
    let edges: Vec<[usize; 2]> = sheet
        .topology()
        .edges()
        .iter()
        .map(|e| e.map(VertexId::index))
        .collect();
    let density = edges.iter().map(|_| rng.random_range(-1.0..1.0)).collect();
    let model = SheetModel::new(&sheet, 1.0, kind)
        .expect("valid")
        .with_potential(Quartic {
            edges: edges.clone(),
            stiffness: 3.0,
        })
        .with_potential(Bilinear { edges })
        .with_pins(&[VertexId(4)])
        .expect("exists");
    let mut direction: Vec<f64> = x.iter().map(|_| rng.random_range(-1.0..1.0)).collect();
    model.clear_pinned(&mut direction);
    Setup {
        model,
        x,
        density,
        direction,
    }
}

/// Central difference of `f` at `x` along `direction`.
fn difference(x: &[f64], direction: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let h = 1e-5;
    let at = |s: f64| {
        let moved: Vec<f64> = x.iter().zip(direction).map(|(x, d)| x + s * d).collect();
        f(&moved)
    };
    at(h)
        .iter()
        .zip(at(-h))
        .map(|(up, down)| (up - down) / (2.0 * h))
        .collect()
}

fn potential_gradient(model: &SheetModel, x: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; x.len()];
    model.potential_force(0.0, x, &mut f);
    f.iter().map(|f| -f).collect()
}

#[test]
fn primal_matrix_is_the_hessian_of_the_augmented_lagrangian() {
    for kind in [MassKind::Lumped, MassKind::Consistent] {
        let Setup {
            model,
            x,
            density: multipliers,
            direction,
        } = setup(kind);
        let rods = model.rods();
        // Away from the rest lengths, so that the densities differ from the multipliers.
        let stretched: Vec<f64> = x.iter().map(|x| 1.03 * x).collect();
        let penalty = 2.5;
        let gradient = |x: &[f64]| {
            let mut g = vec![0.0; x.len()];
            model.apply_mass(x, &mut g);
            let mut c = rods.residual(x);
            for (c, m) in c.iter_mut().zip(&multipliers) {
                *c = m + penalty * *c;
            }
            rods.apply_transpose_add(x, &c, &mut g);
            for (g, p) in g.iter_mut().zip(potential_gradient(&model, x)) {
                *g += 0.7 * p;
            }
            model.clear_pinned(&mut g);
            g
        };
        let want = difference(&stretched, &direction, gradient);
        let transverse: Vec<f64> = rods
            .residual(&stretched)
            .iter()
            .zip(&multipliers)
            .map(|(c, m)| m + penalty * c)
            .collect();
        let mut matrix = PrimalMatrix::new(&model).expect("small");
        matrix.assemble(&model, &stretched, &vec![penalty; rods.len()], &transverse);
        add_potentials(&mut matrix, &model, 0.0, &stretched, 0.7);
        let got = matrix.product(&model, &direction);
        let error = got
            .iter()
            .zip(&want)
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(error < 1e-8, "{kind:?}: {error:e}");
    }
}

#[test]
fn saddle_matrix_is_the_jacobian_of_the_momentum_and_length_equations() {
    for kind in [MassKind::Lumped, MassKind::Consistent] {
        let Setup {
            model,
            x,
            density: impulses,
            direction,
        } = setup(kind);
        let rods = model.rods();
        let right: Vec<f64> = x.iter().map(|x| 0.9 * x).collect();
        let (mass, scale) = (2.0, 0.4);
        // Momentum rows: mass M x - G(x)^T L + scale dV/dx, with respect to x and L.
        let momentum = |x: &[f64], impulses: &[f64]| {
            let mut g = vec![0.0; x.len()];
            model.apply_mass(x, &mut g);
            g.iter_mut().for_each(|g| *g *= mass);
            let negative: Vec<f64> = impulses.iter().map(|l| -l).collect();
            rods.apply_transpose_add(x, &negative, &mut g);
            for (g, p) in g.iter_mut().zip(potential_gradient(&model, x)) {
                *g += scale * p;
            }
            model.clear_pinned(&mut g);
            g
        };
        let other: Vec<f64> = impulses.iter().map(|l| 1.0 - l * l).collect();
        let mut want = difference(&x, &direction, |x| momentum(x, &impulses));
        // Linear in the impulses.
        for (w, (up, down)) in want.iter_mut().zip(
            momentum(&x, &other)
                .iter()
                .zip(momentum(&x, &vec![0.0; other.len()])),
        ) {
            *w += up - down;
        }
        let want_rods = difference(&right, &direction, |x| rods.residual(x));
        let negative: Vec<f64> = impulses.iter().map(|l| -l).collect();
        let mut matrix = SaddleMatrix::new(&model).expect("small");
        let memories = model.memories();
        let system = System {
            mass,
            density: &negative,
            left: &x,
            right: &right,
            potentials: Some((&memories, 0.0, &x, scale)),
            constraints: &[],
        };
        let (got, got_rods) = matrix.product(&model, &system, &direction, &other);
        let error = got
            .iter()
            .zip(&want)
            .chain(got_rods.iter().zip(&want_rods))
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(error < 1e-8, "{kind:?}: {error:e}");
        // And the solver inverts that matrix.
        let (mut momentum, mut lengths) = (got, got_rods);
        let mut effort = crate::report::effort::SolverEffort::default();
        matrix
            .solve(
                &model,
                &system,
                &mut momentum,
                &mut lengths,
                &mut [],
                &mut effort,
            )
            .expect("regular");
        for (solved, given) in momentum.iter().zip(&direction) {
            assert!((solved - given).abs() < 1e-9);
        }
        for (solved, given) in lengths.iter().zip(&other) {
            assert!((solved - given).abs() < 1e-9);
        }
    }
}
