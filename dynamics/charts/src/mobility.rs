//! Closure equations: supports beyond the pins that a chart eliminates.
//!
//! A chart x(q) keeps the edge lengths and the pins it was built with. Whatever else holds vertices (further
//! pins, fixed or moving, curves, surfaces) are equations `Phi(x(q), t) = 0`, and Hamilton's equations get
//! multipliers,
//!
//! ```text
//! qdot = dH/dp,   pdot = -dH/dq + Q + K^T lambda,   K = N J,   N = dPhi/dx.
//! ```
//!
//! Differentiated twice in time (index reduction), `Phi` determines them: with the velocity term
//! `gamma = v^T (d2Phi/dx2) v + 2 (d2Phi/dx dt) v + d2Phi/dt2`,
//!
//! ```text
//! N P N^T lambda = -(N a + gamma),   P = J C^-1 J^T,
//! ```
//!
//! `a` the accelerations without the multipliers. P is the same in every chart: the velocities that impulses
//! on the vertices cause where the rods hold, one solve with the saddle-point matrix,
//!
//! ```text
//! [ M  G^T ] [ P f ]   [ f ]
//! [ G   0  ] [ mu  ] = [ 0 ].
//! ```
//!
//! So neither `a` nor the small matrix `D = N P N^T` lose digits to an ill-conditioned chart. Dependent
//! equations (two pins at the ends of one rod) are met by least squares: D is inverted on its range.

mod projection;

use super::{ChartDynamicsError, ChartMechanics};
use isosheet_coords::SaddlePoint;
use isosheet_dynamics::Support;
use isosheet_dynamics::engine::Balance;
use isosheet_materials::vectors::point;
use isosheet_mesh::VertexId;
use nalgebra::{DMatrix, DVector, Matrix2x3, SymmetricEigen, Vector2, Vector3};

/// Eigenvalues of D, scaled to unit vertex masses so that they are at most one for each row, that count as
/// zero. The saddle-point solve leaves about 1e-14; a closure within 1e-5 radians of a dead point has 1e-10.
const RANK_TOLERANCE: f64 = 1e-11;

/// One scalar closure equation; its gradient is zero but at one vertex.
#[derive(Debug, Clone, Copy)]
struct Row {
    support: Support,
    vertex: VertexId,
    /// First unknown of the vertex; `None` if the chart pins it.
    unknown: Option<usize>,
    gradient: Vector3<f64>,
    /// Metres.
    value: f64,
    /// What a violation is relative to: the shortest rod at the vertex, metres.
    length: f64,
}

impl Row {
    /// `N v` on the unknowns.
    fn apply(&self, v: &[f64]) -> f64 {
        self.unknown.map_or(0.0, |u| {
            self.gradient.dot(&Vector3::from_column_slice(&v[u..u + 3]))
        })
    }

    /// `out += N^T l` on the unknowns.
    fn push(&self, l: f64, out: &mut [f64]) {
        if let Some(u) = self.unknown {
            for k in 0..3 {
                out[u + k] += l * self.gradient[k];
            }
        }
    }
}

/// How a sheet gives way where rods and closures hold, at a state.
pub(super) struct Mobility {
    saddle: SaddlePoint,
    /// Pins of the model that are free in the chart, and where they are at the start.
    pins: Vec<(VertexId, Vector3<f64>)>,
    /// Whether there are closure equations.
    closed: bool,
    rows: Vec<Row>,
    frames: Vec<Matrix2x3<f64>>,
    /// `P N^T`, a column for each row.
    response: Vec<Vec<f64>>,
    /// Of D, on its range.
    inverse: DMatrix<f64>,
    rank: usize,
    mu: Vec<f64>,
    no_rates: Vec<f64>,
}

impl Mobility {
    /// For the model and chart of a mechanics, with the fixed pins where they are at `x`.
    pub(super) fn new(mechanics: &ChartMechanics, x: &[f64]) -> Result<Self, ChartDynamicsError> {
        let (model, system) = (mechanics.model(), mechanics.system());
        let pins: Vec<_> = model
            .pins()
            .into_iter()
            .filter(|v| system.unknown(*v).is_some())
            .map(|v| (v, point(x, v)))
            .collect();
        Ok(Self {
            saddle: SaddlePoint::new(system, model.mass())?,
            closed: !(pins.is_empty() && model.constraints().is_empty()),
            pins,
            rows: Vec::new(),
            frames: Vec::new(),
            response: Vec::new(),
            inverse: DMatrix::zeros(0, 0),
            rank: 0,
            mu: vec![0.0; system.equations()],
            no_rates: vec![0.0; system.equations()],
        })
    }

    /// Positions of the fixed pins of the model that are free in the chart.
    pub(super) fn pin_positions(&self) -> Vec<Vector3<f64>> {
        self.pins.iter().map(|(_, x)| *x).collect()
    }

    /// Sets the positions of the fixed pins of the model that are free in the chart.
    pub(super) fn set_pin_positions(&mut self, positions: &[Vector3<f64>]) {
        for ((_, x), kept) in self.pins.iter_mut().zip(positions) {
            *x = *kept;
        }
    }

    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    /// The closure equations at a state.
    fn place(&mut self, mechanics: &ChartMechanics, t: f64, x: &[f64]) {
        let (model, system) = (mechanics.model(), mechanics.system());
        self.rows.clear();
        self.frames.clear();
        for &(vertex, start) in &self.pins {
            let target = model
                .pin_motion(vertex)
                .map_or(start, |m| m.position(t).into());
            let off = point(x, vertex) - target;
            for k in 0..3 {
                self.rows.push(Row {
                    support: Support::Pin(vertex),
                    vertex,
                    unknown: system.unknown(vertex),
                    gradient: Vector3::ith(k, 1.0),
                    value: off[k],
                    length: model.shortest_edge(vertex.index()),
                });
            }
        }
        for (index, c) in model.constraints().iter().enumerate() {
            let vertex = c.vertex();
            let local = c.at(t, &point(x, vertex));
            let frame = local.independent();
            let (gradients, values) = (frame * local.jacobian, frame * local.value);
            for k in 0..c.equation_count() {
                self.rows.push(Row {
                    support: Support::Constraint { index, vertex },
                    vertex,
                    unknown: system.unknown(vertex),
                    gradient: gradients.row(k).transpose(),
                    value: values[k],
                    length: model.shortest_edge(vertex.index()),
                });
            }
            self.frames.push(frame);
        }
    }

    /// Everything at a state.
    pub(super) fn at(
        &mut self,
        mechanics: &ChartMechanics,
        t: f64,
        x: &[f64],
    ) -> Result<(), ChartDynamicsError> {
        self.place(mechanics, t, x);
        self.factorize(mechanics, x)
    }

    /// The matrices that belong to the rows as placed.
    fn factorize(
        &mut self,
        mechanics: &ChartMechanics,
        x: &[f64],
    ) -> Result<(), ChartDynamicsError> {
        let (model, system) = (mechanics.model(), mechanics.system());
        self.saddle.factorize(system, x)?;
        let m = self.rows.len();
        if m == 0 {
            return Ok(());
        }
        self.response
            .resize_with(m, || vec![0.0; system.unknowns()]);
        let mut force = vec![0.0; system.unknowns()];
        for (row, column) in self.rows.iter().zip(&mut self.response) {
            force.fill(0.0);
            row.push(1.0, &mut force);
            self.saddle
                .solve(&force, &self.no_rates, column, &mut self.mu)?;
        }
        let root = DVector::from_iterator(
            m,
            self.rows
                .iter()
                .map(|r| model.mass().vertex[r.vertex.index()].sqrt()),
        );
        let scaled = DMatrix::from_fn(m, m, |i, j| {
            let both =
                self.rows[i].apply(&self.response[j]) + self.rows[j].apply(&self.response[i]);
            0.5 * both * root[i] * root[j]
        });
        let SymmetricEigen {
            eigenvalues,
            eigenvectors,
        } = SymmetricEigen::new(scaled);
        self.rank = eigenvalues.iter().filter(|e| **e > RANK_TOLERANCE).count();
        let inverted = eigenvalues.map(|e| if e > RANK_TOLERANCE { 1.0 / e } else { 0.0 });
        let left = DMatrix::from_diagonal(&root) * eigenvectors;
        self.inverse = &left * DMatrix::from_diagonal(&inverted) * left.transpose();
        Ok(())
    }

    /// Multipliers that make good what the closure equations lack, `D lambda = -lack`.
    fn multipliers(&self, lack: impl Iterator<Item = f64>) -> DVector<f64> {
        if self.rows.is_empty() {
            return DVector::zeros(0);
        }
        let lack = DVector::from_iterator(self.rows.len(), lack);
        -(&self.inverse * lack)
    }

    /// `v += P N^T lambda`.
    fn give_way(&self, lambda: &DVector<f64>, v: &mut [f64]) {
        for (l, column) in lambda.iter().zip(&self.response) {
            for (v, c) in v.iter_mut().zip(column) {
                *v += l * c;
            }
        }
    }

    /// Changes velocities `v` (full) to the nearest in the mass metric that keep the closures: the change, on
    /// the unknowns. Motions are differentiated over parts of the time `span`. At the state of
    /// [`Mobility::at`].
    pub(super) fn velocity_change(
        &self,
        mechanics: &ChartMechanics,
        (t, span): (f64, f64),
        x: &[f64],
        v: &[f64],
    ) -> Vec<f64> {
        let system = mechanics.system();
        let rates = self.rates(mechanics, (t, span), x);
        let mut change = vec![0.0; system.unknowns()];
        system.gather(v, &mut change);
        let lambda = self.multipliers(
            self.rows
                .iter()
                .zip(&rates)
                .map(|(r, rate)| r.apply(&change) + rate),
        );
        change.fill(0.0);
        self.give_way(&lambda, &mut change);
        change
    }

    /// `dPhi/dt` at fixed positions, metres per second.
    fn rates(&self, mechanics: &ChartMechanics, (t, span): (f64, f64), x: &[f64]) -> Vec<f64> {
        let model = mechanics.model();
        if !model.has_drives() {
            return vec![0.0; self.rows.len()];
        }
        let mut v = vec![0.0; x.len()];
        model.set_pin_velocities(t, span, &mut v);
        let mut rates = Vec::with_capacity(self.rows.len());
        for &(vertex, _) in &self.pins {
            rates.extend(point(&v, vertex).iter().map(|c| -c));
        }
        let own = model.constraint_rates(t, span, x);
        for ((c, frame), rate) in model.constraints().iter().zip(&self.frames).zip(own) {
            rates.extend((frame * rate).iter().take(c.equation_count()));
        }
        rates
    }

    /// The velocity term gamma, metres per second squared: the second derivative of `Phi` on the straight
    /// path from `x` with velocity `v`.
    fn bends(
        &self,
        mechanics: &ChartMechanics,
        (t, span): (f64, f64),
        x: &[f64],
        v: &[f64],
    ) -> Vec<f64> {
        let model = mechanics.model();
        let mut bends = Vec::with_capacity(self.rows.len());
        for &(vertex, _) in &self.pins {
            let motion = model.pin_motion(vertex);
            let bend = motion.map_or(Vector3::zeros(), |m| -m.acceleration(t, span));
            bends.extend(bend.iter());
        }
        for (c, frame) in model.constraints().iter().zip(&self.frames) {
            let (p, u) = (point(x, c.vertex()), point(v, c.vertex()));
            let bend = frame * c.second_rate(t, span, &p, &u);
            bends.extend(bend.iter().take(c.equation_count()));
        }
        bends
    }

    /// Accelerations on the unknowns, and the forces `N^T lambda` of the closures. At the state of
    /// [`Mobility::at`].
    fn accelerations(
        &mut self,
        mechanics: &mut ChartMechanics,
        (t, span): (f64, f64),
        x: &[f64],
        v: &[f64],
    ) -> Result<Accelerations, ChartDynamicsError> {
        let unknowns = mechanics.system().unknowns();
        let mut force = vec![0.0; unknowns];
        mechanics.add_forces(t, x, v, &mut force);
        // G a = -G(v) v.
        let mut rate = vec![0.0; mechanics.system().equations()];
        mechanics.system().apply(v, v, &mut rate);
        rate.iter_mut().for_each(|r| *r = -*r);
        let mut a = vec![0.0; unknowns];
        self.saddle.solve(&force, &rate, &mut a, &mut self.mu)?;
        let bends = self.bends(mechanics, (t, span), x, v);
        let lambda = self.multipliers(
            self.rows
                .iter()
                .zip(&bends)
                .map(|(row, bend)| row.apply(&a) + bend),
        );
        Ok(Accelerations {
            force,
            rate,
            a,
            lambda,
        })
    }

    /// Forces `N^T lambda` of the closures on the vertices (full), newtons. At the state of [`Mobility::at`].
    pub(super) fn closure_forces(
        &mut self,
        mechanics: &mut ChartMechanics,
        time: (f64, f64),
        x: &[f64],
        v: &[f64],
    ) -> Result<Vec<f64>, ChartDynamicsError> {
        let lambda = self.accelerations(mechanics, time, x, v)?.lambda;
        let mut force = vec![0.0; mechanics.system().unknowns()];
        for (row, l) in self.rows.iter().zip(&lambda) {
            row.push(*l, &mut force);
        }
        let mut full = vec![0.0; x.len()];
        mechanics.system().scatter(&force, &mut full);
        Ok(full)
    }

    /// The forces of all supports. At the state of [`Mobility::at`].
    pub(super) fn balance(
        &mut self,
        mechanics: &mut ChartMechanics,
        (t, span): (f64, f64),
        x: &[f64],
        v: &[f64],
        balance: &mut Balance,
    ) -> Result<(), ChartDynamicsError> {
        let Accelerations {
            mut force,
            rate,
            mut a,
            lambda,
        } = self.accelerations(mechanics, (t, span), x, v)?;
        for (row, l) in self.rows.iter().zip(&lambda) {
            row.push(*l, &mut force);
        }
        self.saddle.solve(&force, &rate, &mut a, &mut self.mu)?;
        let (model, system) = (mechanics.model(), mechanics.system());
        let mut full = vec![0.0; x.len()];
        system.scatter(&a, &mut full);
        if !balance.begin(model, |i| full[i]) {
            return Ok(());
        }
        balance.add_potentials(model, mechanics.memories(), (t, x), 1.0);
        balance.add_applied(model, t, x, v, 1.0);
        let mut rods = vec![0.0; model.rods().len()];
        for (edge, mu) in system.edges().zip(&self.mu) {
            rods[edge.index()] = *mu;
        }
        balance.add_rods(model, x, &rods, 1.0);
        let mut first = 3 * self.pins.len();
        let loads = model
            .constraints()
            .iter()
            .zip(&self.frames)
            .map(|(c, frame)| {
                let rows = first..first + c.equation_count();
                first = rows.end;
                let mut own = Vector2::zeros();
                let mut force = Vector3::zeros();
                for (k, i) in rows.enumerate() {
                    own[k] = lambda[i];
                    force += lambda[i] * self.rows[i].gradient;
                }
                (-frame.tr_mul(&own), force)
            });
        balance.add_loads(loads);
        balance.finish(model);
        Ok(())
    }
}

struct Accelerations {
    /// Potential and applied forces.
    force: Vec<f64>,
    /// `-G(v) v`.
    rate: Vec<f64>,
    /// Without the multipliers.
    a: Vec<f64>,
    lambda: DVector<f64>,
}
