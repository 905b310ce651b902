//! The air as a term of a damped step: its derivatives, and its force.

use super::*;
use crate::State;
use crate::term::Formula;
use isosheet_materials::hessian::{CouplingSink, HessianSink};
use isosheet_materials::potential::Memories;
use isosheet_mesh::{MassKind, Sheet, generate};
use nalgebra::DMatrix;

const SPAN: f64 = 0.02;
const H: f64 = 2.0 / 3.0 * SPAN;

/// A whole matrix.
struct Dense<'a>(DMatrix<f64>, &'a SheetModel);

impl HessianSink for Dense<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.add(v.0, v.0, block);
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        let [a, b] = self.1.topology().edges()[e.index()];
        self.add(a.0, b.0, block);
    }

    fn add_pair(&mut self, _: VertexId, _: VertexId, _: &Matrix3<f64>) {
        panic!("the air couples the corners of faces alone");
    }
}

impl CouplingSink for Dense<'_> {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        let [i, j] = [a, b].map(|v| 3 * v as usize);
        let mut view = self.0.fixed_view_mut::<3, 3>(i, j);
        view += block;
        if a != b {
            let mut view = self.0.fixed_view_mut::<3, 3>(j, i);
            view += block.transpose();
        }
    }
}

/// A crumpled sheet in motion in a wind.
struct Scene {
    model: SheetModel,
    start: State,
    memories: Memories,
    /// Positions that the velocities lead to.
    ahead: Vec<f64>,
    /// Positions at the end.
    end: Vec<f64>,
}

fn wave(size: f64, i: usize) -> f64 {
    size * (1.7 * i as f64).sin()
}

impl Scene {
    fn new() -> Self {
        let flat = generate::isotropic_square(0, 0.4).unwrap();
        let x = flat.positions().iter().enumerate();
        let x: Vec<f64> = x.map(|(i, x)| x + wave(0.03, i)).collect();
        let sheet = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
        let air = Air {
            tangential: 0.4,
            wind: [1.0, -0.5, 2.0].into(),
            ..Air::default()
        };
        let model = SheetModel::new(&sheet, 0.02, MassKind::Lumped).unwrap();
        let model = model.with_air(air).unwrap();
        let v: Vec<f64> = (0..x.len()).map(|i| wave(1.3, 3 * i + 1)).collect();
        let ahead = x.iter().zip(&v).map(|(x, v)| x + SPAN * v).collect();
        let end = x.iter().enumerate();
        let end = end.map(|(i, x)| x + wave(0.02, i + 5)).collect();
        Self {
            memories: model.memories(),
            start: State::moving(x, v),
            model,
            ahead,
            end,
        }
    }

    /// The term of the air in a step that makes velocities by `x1 = rest + H v1`.
    fn term(&self, rest: impl Fn(usize) -> f64) -> Box<dyn Term> {
        let rest: Vec<f64> = (0..self.end.len()).map(rest).collect();
        let free = vec![true; self.end.len() / 3];
        let force = self.model.implicit_forces().next().expect("air");
        let mut term = force.term(free.into());
        let step = StepStart {
            state: &self.start,
            memories: &self.memories,
            span: SPAN,
            sliding_time: SPAN,
            h: H,
            formula: Formula::TwoStep,
            back: 0.0,
            before: None,
            rest: &rest,
            prediction: &self.ahead,
            ahead: &self.ahead,
        };
        term.begin(&step).expect("a wind that is finite");
        term
    }

    /// The term of the air in a step that makes velocities by `x1 = rest + H v1` with a history: `rest` is
    /// not the start.
    fn term_with_history(&self) -> Box<dyn Term> {
        self.term(|i| self.start.x[i] + wave(2e-3, 2 * i))
    }

    fn at<'a>(&'a self, x: &'a [f64]) -> Iterate<'a> {
        Iterate {
            t: SPAN,
            x,
            memories: &self.memories,
        }
    }

    fn gradient(&self, term: &mut dyn Term, x: &[f64]) -> Vec<f64> {
        let mut gradient = vec![0.0; x.len()];
        term.add_gradient(self.at(x), 1.0, &mut gradient);
        gradient
    }
}

#[test]
fn the_gradient_is_the_derivative_of_the_energy() {
    let scene = Scene::new();
    let (mut term, x) = (scene.term_with_history(), &scene.end);
    let gradient = scene.gradient(&mut *term, x);
    let largest = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    for (i, g) in gradient.iter().enumerate() {
        let mut energy = |d: f64| {
            let mut x = x.clone();
            x[i] += d;
            term.value(scene.at(&x)).energy
        };
        let slope = (energy(1e-6) - energy(-1e-6)) / 2e-6;
        assert!((slope - g).abs() < 1e-7 * largest, "{i}: {slope} {g}");
    }
}

#[test]
fn the_hessian_is_the_derivative_of_the_gradient_and_semidefinite() {
    let scene = Scene::new();
    let (mut term, x) = (scene.term_with_history(), &scene.end);
    let n = x.len();
    let mut hessian = Dense(DMatrix::zeros(n, n), &scene.model);
    term.add_hessian(scene.at(x), HessianPart::Full, &mut hessian);
    let hessian = hessian.0;
    let mut gradient = |i: usize, d: f64| {
        let mut x = x.clone();
        x[i] += d;
        scene.gradient(&mut *term, &x)
    };
    for i in 0..n {
        let (up, down) = (gradient(i, 1e-6), gradient(i, -1e-6));
        for j in 0..n {
            let slope = (up[j] - down[j]) / 2e-6;
            let error = (slope - hessian[(j, i)]).abs();
            assert!(error < 1e-6 * hessian.amax(), "{i} {j}: {slope}");
        }
    }
    let least = hessian.symmetric_eigenvalues().min();
    assert!(least > -1e-12, "eigenvalue {least}");
}

/// Where the sheet goes on as it began, the force at the end is that of the air at the end.
#[test]
fn the_force_of_a_uniform_motion_is_explicit() {
    let scene = Scene::new();
    let State { x, v, .. } = &scene.start;
    let mut term = scene.term(|i| x[i] + (SPAN - H) * v[i]);
    let implicit = scene.gradient(&mut *term, &scene.ahead);
    let mut explicit = vec![0.0; x.len()];
    let model = &scene.model;
    model.add_applied_force(SPAN, &scene.ahead, v, &mut explicit);
    let error = implicit.iter().zip(&explicit).map(|(a, b)| (a + b).abs());
    assert!(error.fold(0.0, f64::max) < 1e-15);
}
