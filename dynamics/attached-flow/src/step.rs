//! The attached flow as a term of a damped step.

use super::Attached;
use super::wake::Past;
use isosheet_dynamics::term::{
    BlockSink, Exchange, Formula, HessianPart, ImplicitForce, Iterate, Lagging, StepStart, Term,
    Value,
};
use isosheet_dynamics::{Force, StepError};
use isosheet_materials::vectors::{add, dot, largest_norm};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::sync::Arc;

/// Part of the largest force by which forces may differ from the flow at the end of the step before they are
/// renewed.
const SETTLED: f64 = 1e-3;
/// Part of the largest force by which forces may differ from the flow at the end of a step; beyond it the
/// step is refused.
const UNSETTLED: f64 = 0.05;

impl Force for Attached {
    /// The force depends on the wake, and is that of the term.
    fn add_force(&self, _t: f64, _x: &[f64], _v: &[f64], _force: &mut [f64]) {}
}

impl ImplicitForce for Attached {
    fn needs_minimising(&self) -> bool {
        true
    }

    fn term(&self, _free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(FlowStep {
            attached: self.clone(),
            start: FlowStart::default(),
            past: None,
            lagged: Lagged::default(),
        })
    }
}

/// The forces of the flow in a step that makes velocities of positions by `x = r + h v`: the circulation
/// follows from the velocities by the equations of [`Flow`](super::flow::Flow), its rate of change by the
/// formula of the method, and both make forces. At lagged positions `y` they are, to first order,
///
/// ```text
/// f(x) = f(y) + J d,   U(x) = -((f + g) . d + d . S d / 2),   d = x - y,   S = (J + J^T) / 2,
/// ```
///
/// where the derivative `J` is that by the velocities. Most of it is the mass of the air that moves along
/// with the sheet, `-m / h^2`, which has an energy; the part without one, `g = (J - S) d`, lags behind, and
/// so do the place of the lattice and the velocity along it, until `U` has the forces of the end of the step.
#[derive(Debug)]
struct FlowStep {
    attached: Attached,
    start: FlowStart,
    past: Option<Past>,
    lagged: Lagged,
}

/// What a step starts from.
#[derive(Debug, Default)]
struct FlowStart {
    /// Time at its end, seconds.
    t: f64,
    /// Effective step, seconds.
    h: f64,
    /// Positions at the start, `3V`, metres.
    x: Vec<f64>,
    /// `r`, `3V`, metres.
    rest: Vec<f64>,
    /// `g` of `dGamma/dt = (Gamma - g) / h`.
    circulation: Vec<f64>,
    /// Forces at the start, `3V`, newtons.
    force: Vec<f64>,
}

/// Forces on the vertices of the lattice, three values for each.
#[derive(Debug, Default)]
struct Lagged {
    /// `y`, metres.
    at: Vec<f64>,
    /// `f`, newtons.
    force: Vec<f64>,
    /// What has been taken for `(J - S) d`, newtons, and by how much that was wrong, the last one at the end.
    without_energy: Vec<[Vec<f64>; 2]>,
    /// `(J - S) d` as it is taken now.
    taken: Vec<f64>,
    /// `J`, newtons per metre, by rows.
    derivative: Vec<f64>,
    /// Minus the mass of the air that moves along, divided by the square of the step, by rows.
    mass: Vec<f64>,
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn flat(vectors: &[Vector3<f64>]) -> Vec<f64> {
    vectors.iter().flatten().copied().collect()
}

impl Lagged {
    /// `K d` for a matrix `K` by rows.
    fn product(matrix: &[f64], d: &[f64]) -> Vec<f64> {
        matrix
            .chunks_exact(d.len())
            .map(|row| dot(row, d))
            .collect()
    }

    /// `S d`.
    fn symmetric_product(&self, d: &[f64]) -> Vec<f64> {
        let order = d.len();
        let mut sum = Self::product(&self.derivative, d);
        for (row, value) in self.derivative.chunks_exact(order).zip(d) {
            for (sum, entry) in sum.iter_mut().zip(row) {
                *sum += entry * value;
            }
        }
        sum.iter_mut().for_each(|s| *s *= 0.5);
        sum
    }

    /// `f + g`.
    fn constant(&self) -> Vec<f64> {
        sum(&self.force, &self.taken)
    }

    /// `f + g + S d`.
    fn forces(&self, x: &[f64]) -> Vec<f64> {
        let d = difference(x, &self.at);
        sum(&self.constant(), &self.symmetric_product(&d))
    }

    /// By how much `g` is not `(J - S) d`.
    fn lag(&self, x: &[f64]) -> Vec<f64> {
        let d = difference(x, &self.at);
        let whole = Self::product(&self.derivative, &d);
        let lag = difference(&whole, &self.symmetric_product(&d));
        difference(&lag, &self.taken)
    }

    /// Takes another `g`, from what the last ones were wrong by (Anderson, J. ACM 12, 1965).
    fn extrapolate(&mut self, lag: Vec<f64>) {
        let taken = std::mem::take(&mut self.taken);
        let now = [taken, lag];
        let steps: Vec<[Vec<f64>; 2]> = self
            .without_energy
            .iter()
            .map(|before| [0, 1].map(|k| difference(&now[k], &before[k])))
            .collect();
        self.taken = sum(&now[0], &now[1]);
        let columns: Vec<DVector<f64>> = steps
            .iter()
            .map(|[_, lag]| DVector::from_column_slice(lag))
            .collect();
        if !columns.is_empty() {
            let matrix = DMatrix::from_columns(&columns);
            let right = DVector::from_column_slice(&now[1]);
            let small = 1e-10 * matrix.norm();
            let shares = matrix.svd(true, true).solve(&right, small);
            for (step, share) in steps.iter().zip(shares.iter().flatten()) {
                let back = sum(&step[0], &step[1]);
                let pairs = self.taken.iter_mut().zip(&back);
                pairs.for_each(|(g, b)| *g -= share * b);
            }
        }
        self.without_energy.push(now);
    }
}

impl FlowStep {
    /// The coordinates of the vertices of the lattice.
    fn own(&self, x: &[f64]) -> Vec<f64> {
        let vertices = &self.attached.air.lattice.vertices;
        let rows = vertices
            .iter()
            .map(|v| &x[3 * v.index()..3 * v.index() + 3]);
        rows.flatten().copied().collect()
    }

    fn velocities(&self, x: &[f64]) -> Vec<f64> {
        let moved = x.iter().zip(&self.start.rest);
        moved.map(|(x, r)| (x - r) / self.start.h).collect()
    }

    /// The forces of the flow at positions at the end of the step.
    fn exact(&self, x: &[f64]) -> Result<Vec<f64>, StepError> {
        let air = &self.attached.air;
        let past = self.past.as_ref().expect("the step has begun");
        let v = self.velocities(x);
        let t = self.start.t;
        let flow = air
            .flow(past, t, x)
            .map_err(|source| StepError::Linalg { t, source })?;
        let circulation = air.circulation(&flow, &v);
        let edges = air.edge_forces(&flow.shape, self.start.t, &v);
        let rate = self.rate(&circulation);
        Ok(flat(&air.forces(&flow.shape, &edges, &circulation, &rate)))
    }

    fn rate(&self, circulation: &[f64]) -> Vec<f64> {
        let pairs = circulation.iter().zip(&self.start.circulation);
        pairs.map(|(c, g)| (c - g) / self.start.h).collect()
    }

    /// Lags behind at positions (`3V`, metres).
    fn lag(&mut self, x: &[f64]) -> Result<(), StepError> {
        let air = &self.attached.air;
        let past = self.past.as_ref().expect("the step has begun");
        let h = self.start.h;
        let v = self.velocities(x);
        let t = self.start.t;
        let flow = air
            .flow(past, t, x)
            .map_err(|source| StepError::Linalg { t, source })?;
        let circulation = air.circulation(&flow, &v);
        let edges = air.edge_forces(&flow.shape, self.start.t, &v);
        let rate = self.rate(&circulation);
        let force = flat(&air.forces(&flow.shape, &edges, &circulation, &rate));
        let lattice = &air.lattice;
        let (count, order) = (lattice.faces.len(), 3 * lattice.vertices.len());
        let columns = air.circulation_derivative(&flow);
        let rows: Vec<f64> = (0..count * order)
            .map(|k| columns[count * (k % order) + k / order])
            .collect();
        let mut derivative = vec![0.0; order * order];
        let mut mass = vec![0.0; order * order];
        let add_row = |matrix: &mut [f64], node: usize, force: &Vector3<f64>, face: usize| {
            let of_face = &rows[order * face..order * (face + 1)];
            for (v, weight) in lattice.weights(node) {
                for k in 0..3 {
                    let factor = weight * force[k] / h;
                    if factor != 0.0 {
                        let row = &mut matrix[order * (3 * v + k)..][..order];
                        row.iter_mut()
                            .zip(of_face)
                            .for_each(|(r, c)| *r += factor * c);
                    }
                }
            }
        };
        for (face, corners) in lattice.faces.iter().enumerate() {
            let force = air.rate_force(&flow.shape, face) / h;
            for node in corners {
                add_row(&mut mass, *node, &force, face);
            }
        }
        derivative.copy_from_slice(&mass);
        for (edge, force) in lattice.edges.iter().zip(&edges) {
            for node in edge.ends {
                add_row(&mut derivative, node, force, edge.left);
                if let Some(right) = edge.right {
                    add_row(&mut derivative, node, &-force, right);
                }
            }
        }
        self.lagged = Lagged {
            at: self.own(x),
            taken: vec![0.0; order],
            without_energy: Vec::new(),
            force,
            derivative,
            mass,
        };
        Ok(())
    }

    /// By how much the forces at an iterate differ from the flow, as a part of the largest: to first order,
    /// and where that has settled whole.
    fn error(&self, x: &[f64], settled: f64) -> f64 {
        let here = self.own(x);
        let forces = self.lagged.forces(&here);
        let error = largest_norm(&self.lagged.lag(&here)) / largest_norm(&forces);
        if error > settled {
            return error;
        }
        self.exact(x)
            .map_or(f64::INFINITY, |exact| relative(&forces, &exact))
    }

    /// Forces and their places, `3V` of the model.
    fn spread(&self, forces: &[f64], scale: f64, out: &mut [f64]) {
        let vertices = &self.attached.air.lattice.vertices;
        for (v, f) in vertices.iter().zip(forces.as_chunks::<3>().0) {
            add(out, *v, &(scale * Vector3::from(*f)));
        }
    }
}

/// The largest difference of two lists of forces, as a part of the largest force.
fn relative(a: &[f64], b: &[f64]) -> f64 {
    let size = largest_norm(b);
    let error = largest_norm(&difference(a, b));
    if error > 0.0 { error / size } else { error }
}

impl Term for FlowStep {
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        let attached = self.attached.clone();
        let past = attached.past(step.memories);
        let (last, before) = (&past.circulations[0], &past.circulations[1]);
        let back = step.back;
        let circulation = last.iter().zip(before);
        let state = step.state;
        let shape = attached.air.lattice.shape(&state.x);
        let edges = attached.air.edge_forces(&shape, state.t, &state.v);
        let force = attached.air.forces(&shape, &edges, last, &past.rate);
        self.start = FlowStart {
            t: step.t(),
            h: step.h,
            x: state.x.clone(),
            rest: step.rest.to_vec(),
            circulation: circulation.map(|(c, c0)| c + back * (c - c0)).collect(),
            force: flat(&force),
        };
        self.past = Some(past.carried(&attached.air.wind, step.span));
        self.lag(step.ahead)?;
        let bad = self.lagged.force.iter().position(|f| !f.is_finite());
        match bad {
            None => Ok(()),
            Some(i) => Err(StepError::NonFiniteForce {
                vertex: attached.air.lattice.vertices[i / 3],
                value: self.lagged.force[i],
                t: step.t(),
            }),
        }
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        let [before, now] =
            [&self.start.x[..], at.x].map(|x| difference(&self.own(x), &self.lagged.at));
        let moved = difference(&now, &before);
        let middle: Vec<f64> = sum(&now, &before).iter().map(|d| 0.5 * d).collect();
        let mean = sum(
            &self.lagged.constant(),
            &self.lagged.symmetric_product(&middle),
        );
        let parts = mean.iter().zip(&moved).map(|(f, d)| f * d);
        Value {
            energy: -parts.clone().sum::<f64>(),
            size: parts.map(f64::abs).sum(),
            round_off: 0.0,
        }
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        let forces = self.lagged.forces(&self.own(at.x));
        self.spread(&forces, -scale, out);
    }

    fn add_hessian(&mut self, _at: Iterate<'_>, part: HessianPart, sink: &mut dyn BlockSink) {
        let matrix = match part {
            HessianPart::Full => &self.lagged.derivative,
            HessianPart::PositiveSemidefinite => &self.lagged.mass,
            HessianPart::Certain => return,
        };
        let vertices = &self.attached.air.lattice.vertices;
        let order = 3 * vertices.len();
        let entry = |i: usize, j: usize| -0.5 * (matrix[order * i + j] + matrix[order * j + i]);
        for a in 0..vertices.len() {
            for b in 0..=a {
                let block = Matrix3::from_fn(|i, j| entry(3 * a + i, 3 * b + j));
                sink.add(vertices[a].0, vertices[b].0, &block);
            }
        }
    }

    fn append_couplings(&mut self, _at: Iterate<'_>, out: &mut Vec<[u32; 2]>) {
        let vertices = &self.attached.air.lattice.vertices;
        for (k, a) in vertices.iter().enumerate() {
            out.extend(vertices[k + 1..].iter().map(|b| [a.0, b.0]));
        }
    }

    fn renew(&mut self, at: Iterate<'_>, settled: Lagging) -> bool {
        let settled = settled.loads.min(SETTLED);
        let here = self.own(at.x);
        let forces = self.lagged.forces(&here);
        let lag = self.lagged.lag(&here);
        if largest_norm(&lag) > settled * largest_norm(&forces) {
            // To first order: the place of the lattice stays.
            self.lagged.extrapolate(lag);
            return true;
        }
        match self.exact(at.x) {
            Ok(exact) if relative(&forces, &exact) <= settled => false,
            _ => self.lag(at.x).is_ok(),
        }
    }

    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        let error = self.error(at.x, UNSETTLED);
        if error.is_nan() || error > UNSETTLED {
            return Err(StepError::UnsettledLoads {
                t: step.state.t,
                h: step.span,
                error,
            });
        }
        let here = self.own(at.x);
        let moved = difference(&here, &self.own(&self.start.x));
        let mut force = self.lagged.forces(&here);
        if step.formula == Formula::TwoStep {
            let pairs = force.iter_mut().zip(&self.start.force);
            pairs.for_each(|(f, f0)| *f = 0.5 * (*f + f0));
        }
        Ok(Exchange::driven(dot(&force, &moved)))
    }
}
