//! The air in a step of a method that minimises.

use crate::model::air::{Face, FaceDrag, centroid};
use crate::step::report::StepError;
use crate::vectors::add;
use crate::{HessianSink, SheetModel, State};
use nalgebra::Vector3;

/// The incremental potential of the drag of the air in a step that makes velocities of positions by `x = y +
/// h v`,
///
/// ```text
/// R(x) = h sum_f (n_f |u_n|^3 + t_f |u_t|^3) / 3,   u = w - (x_c - y_c) / h,
/// ```
///
/// with the centroids `x_c`, `y_c` of the faces and the factors `n_f`, `t_f` of [`FaceDrag`]. Its gradient is
/// minus the force at the velocities `v` at the end of the step. Normals and wind `w` are those at the end of
/// the step at the positions that the velocities at its start lead to, which leaves a second-order method its
/// order. With fixed normals `R` is convex, and in air at rest the force takes energy from the sheet,
/// whatever the normals are.
#[derive(Debug, Default)]
pub(crate) struct AirStep {
    faces: Vec<FaceInStep>,
    /// `y`, `3V`, metres.
    rest: Vec<f64>,
    /// The effective step `h`, seconds.
    h: f64,
    /// Positions that the velocities at the start lead to (`3V`, metres); afterwards forces (newtons).
    scratch: Vec<f64>,
}

#[derive(Debug)]
struct FaceInStep {
    face: Face,
    drag: FaceDrag,
    /// Velocity of the air, metres per second.
    wind: Vector3<f64>,
}

impl AirStep {
    /// Begins a step of `span` seconds and the effective step `h` (seconds) in the air of a model, if there
    /// is any; `rest` gives the coordinates of `y`.
    ///
    /// # Errors
    /// [`StepError::NonFiniteForce`] if the wind at the end of the step is not finite.
    pub(crate) fn begin(
        &mut self,
        model: &SheetModel,
        start: &State,
        (span, h): (f64, f64),
        rest: impl Fn(usize) -> f64,
    ) -> Result<(), StepError> {
        self.faces.clear();
        let Some(on_faces) = model.air_on_faces() else {
            return Ok(());
        };
        self.h = h;
        let t = start.t + span;
        let ahead = |(x, v): (&f64, &f64)| x + span * v;
        self.scratch.clear();
        self.scratch.extend(start.x.iter().zip(&start.v).map(ahead));
        model.place_pins(t, &mut self.scratch);
        self.rest.clear();
        self.rest.extend((0..start.x.len()).map(rest));
        for face in &on_faces.faces {
            let wind = on_faces.wind_at(face, t, &self.scratch);
            if let Some(&value) = wind.iter().find(|w| !w.is_finite()) {
                let vertex = face.vertices[0];
                return Err(StepError::NonFiniteForce { vertex, value, t });
            }
            let drag = face.drag(&self.scratch);
            self.faces.push(FaceInStep {
                face: *face,
                drag,
                wind,
            });
        }
        Ok(())
    }

    /// The faces with the velocity of the air relative to them.
    fn relative(&self, x: &[f64]) -> impl Iterator<Item = (&FaceInStep, Vector3<f64>)> {
        self.faces.iter().map(move |f| {
            let moved = centroid(x, f.face.vertices) - centroid(&self.rest, f.face.vertices);
            (f, f.wind - moved / self.h)
        })
    }

    /// The incremental potential, joules.
    pub(crate) fn energy(&self, x: &[f64]) -> f64 {
        let potentials = self.relative(x).map(|(f, u)| f.drag.potential(&u));
        self.h * potentials.sum::<f64>()
    }

    /// Adds `scale` times the gradient, newtons: minus the force of the air, at pinned vertices too.
    pub(crate) fn add_gradient(&self, x: &[f64], scale: f64, gradient: &mut [f64]) {
        for (f, u) in self.relative(x) {
            let share = -scale / 3.0 * f.drag.force(&u);
            for v in f.face.vertices {
                add(gradient, v, &share);
            }
        }
    }

    /// Adds `scale` times the Hessian, newtons per metre: positive semidefinite.
    pub(crate) fn add_hessian(&self, x: &[f64], scale: f64, hessian: &mut dyn HessianSink) {
        // Each of two corners moves the centroid by a third.
        let scale = scale / (9.0 * self.h);
        for (f, u) in self.relative(x) {
            let block = scale * f.drag.derivative(&u);
            for v in f.face.vertices {
                hessian.add_vertex(v, &block);
            }
            for e in f.face.edges {
                hessian.add_edge(e, &block);
            }
        }
    }

    /// Work of the air at the free vertices in the step from `start` to positions `x`, joules: of implicit
    /// Euler with the force at the end, which balances the energy but for what the method dissipates; of a
    /// two-step formula by the trapezoidal rule with the force at the start, at the order of the formula.
    pub(crate) fn work(
        &mut self,
        model: &SheetModel,
        start: &State,
        formula: Formula,
        x: &[f64],
    ) -> f64 {
        let mut force = std::mem::take(&mut self.scratch);
        force.fill(0.0);
        self.add_gradient(x, -1.0, &mut force);
        if let (Formula::TwoStep, Some(on_faces)) = (formula, model.air_on_faces()) {
            on_faces.add_force(start.t, &start.x, &start.v, &mut force);
            force.iter_mut().for_each(|f| *f *= 0.5);
        }
        model.clear_pinned(&mut force);
        let moved = x.iter().zip(&start.x).map(|(x, x0)| x - x0);
        let work = force.iter().zip(moved).map(|(f, dx)| f * dx).sum();
        self.scratch = force;
        work
    }
}

/// How far back the formula of a step reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Formula {
    /// To its start: implicit Euler.
    OneStep,
    /// To the step before: BDF2.
    TwoStep,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Air;
    use isosheet_mesh::{EdgeId, MassKind, Sheet, VertexId, generate};
    use nalgebra::{DMatrix, Matrix3};

    const SPAN: f64 = 0.02;
    const H: f64 = 2.0 / 3.0 * SPAN;

    /// A whole matrix.
    struct Dense<'a>(DMatrix<f64>, &'a SheetModel);

    impl Dense<'_> {
        fn add(&mut self, a: usize, b: usize, block: &Matrix3<f64>) {
            let mut view = self.0.fixed_view_mut::<3, 3>(3 * a, 3 * b);
            view += block;
        }
    }

    impl HessianSink for Dense<'_> {
        fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
            self.add(v.index(), v.index(), block);
        }

        fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
            let [a, b] = self.1.rods().edges()[e.index()];
            self.add(a, b, block);
            self.add(b, a, &block.transpose());
        }

        fn add_pair(&mut self, _: VertexId, _: VertexId, _: &Matrix3<f64>) {
            panic!("the air couples the corners of faces alone");
        }
    }

    /// A crumpled sheet in motion in a wind, its step, and positions at the end.
    fn scene() -> (SheetModel, State, AirStep, Vec<f64>) {
        let flat = generate::isotropic_square(0, 0.4).unwrap();
        let wave = |size: f64, i: usize| size * (1.7 * i as f64).sin();
        let x: Vec<f64> = flat
            .positions()
            .iter()
            .enumerate()
            .map(|(i, x)| x + wave(0.03, i))
            .collect();
        let sheet = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
        let air = Air {
            tangential: 0.4,
            wind: [1.0, -0.5, 2.0].into(),
            ..Air::default()
        };
        let model = SheetModel::new(&sheet, 0.02, MassKind::Lumped).unwrap();
        let model = model.with_air(air).unwrap();
        let v: Vec<f64> = (0..x.len()).map(|i| wave(1.3, 3 * i + 1)).collect();
        let start = State::moving(x.clone(), v);
        let mut step = AirStep::default();
        let rest = |i: usize| x[i] + wave(2e-3, 2 * i);
        step.begin(&model, &start, (SPAN, H), rest).unwrap();
        let end = x
            .iter()
            .enumerate()
            .map(|(i, x)| x + wave(0.02, i + 5))
            .collect();
        (model, start, step, end)
    }

    #[test]
    fn the_gradient_is_the_derivative_of_the_energy() {
        let (_, _, step, x) = scene();
        let mut gradient = vec![0.0; x.len()];
        step.add_gradient(&x, 1.0, &mut gradient);
        let largest = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
        for (i, g) in gradient.iter().enumerate() {
            let energy = |d: f64| {
                let mut x = x.clone();
                x[i] += d;
                step.energy(&x)
            };
            let slope = (energy(1e-6) - energy(-1e-6)) / 2e-6;
            assert!((slope - g).abs() < 1e-7 * largest, "{i}: {slope} {g}");
        }
    }

    #[test]
    fn the_hessian_is_the_derivative_of_the_gradient_and_semidefinite() {
        let (model, _, step, x) = scene();
        let n = x.len();
        let mut hessian = Dense(DMatrix::zeros(n, n), &model);
        step.add_hessian(&x, 1.0, &mut hessian);
        let hessian = hessian.0;
        let gradient = |i: usize, d: f64| {
            let (mut x, mut gradient) = (x.clone(), vec![0.0; n]);
            x[i] += d;
            step.add_gradient(&x, 1.0, &mut gradient);
            gradient
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
        let (model, start, mut step, _) = scene();
        let rest = |i: usize| start.x[i] + (SPAN - H) * start.v[i];
        step.begin(&model, &start, (SPAN, H), rest).unwrap();
        let x: Vec<f64> = start
            .x
            .iter()
            .zip(&start.v)
            .map(|(x, v)| x + SPAN * v)
            .collect();
        let (mut implicit, mut explicit) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        step.add_gradient(&x, -1.0, &mut implicit);
        model.add_applied_force(SPAN, &x, &start.v, &mut explicit);
        let error = implicit.iter().zip(&explicit).map(|(a, b)| (a - b).abs());
        assert!(error.fold(0.0, f64::max) < 1e-15);
    }
}
