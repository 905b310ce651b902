//! Condition number of the mass matrix `C = J^T M J` of a chart.
//!
//! The condition number is the product of the largest eigenvalue of C and the largest eigenvalue of
//! its inverse, each computed on its own: C from J, and the inverse from saddle-point solves,
//! `C^-1 p = S v`, which never meet the chart's ill-conditioning. The product is therefore meaningful
//! far beyond 1e16, where the eigenvalues of C alone would be noise.

use crate::assignment::AssignmentOptions;
use crate::cartesian_chart::{CartesianChart, Choice};
use crate::chart::{Chart, ChartError};
use crate::front_chart::FrontChart;
use crate::linearised::Linearised;
use crate::saddle::{SaddlePoint, apply_mass};
use crate::system::RodSystem;
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId, generate};
use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Largest dimension for which [`mass_condition`] computes eigenvalues; above it estimates.
const DENSE_LIMIT: usize = 200;

/// Power iterations of the estimate. It approaches the largest eigenvalue from below; twenty steps
/// are within a factor of two for any spectrum of a few hundred eigenvalues from a random start.
const POWER_STEPS: usize = 20;

/// Condition number of C for a chart at a state: exact up to dimension 200, the estimate of
/// [`mass_condition_estimate`] above.
///
/// # Errors
/// [`ChartError::Linalg`] or [`ChartError::Row`] at states where the chart is singular.
pub fn mass_condition(
    system: &RodSystem,
    chart: &dyn Chart,
    mass: &MassMatrix,
    x: &[f64],
) -> Result<f64, ChartError> {
    if chart.dimension() > DENSE_LIMIT {
        return mass_condition_estimate(system, chart, mass, x);
    }
    let n = chart.dimension();
    let mut linear = Linearised::new(system, chart.pattern())?;
    let jacobian = chart.jacobian(system, &mut linear, x)?;
    let c = mass_matrix(system, mass, &jacobian);
    let mut saddle = SaddlePoint::new(system, mass)?;
    saddle.factorize(system, x)?;
    let mut rows = vec![0.0; chart.pattern().len()];
    chart.rows(x, &mut rows)?;
    let mut inverse = DMatrix::zeros(n, n);
    let mut unit = vec![0.0; n];
    let mut apply = Inverse::new(system);
    for (k, mut column) in inverse.column_iter_mut().enumerate() {
        unit[k] = 1.0;
        apply.apply(&mut saddle, chart, &rows, &unit, column.as_mut_slice())?;
        unit[k] = 0.0;
    }
    Ok(largest_eigenvalue(c) * largest_eigenvalue(inverse))
}

/// Estimate of the condition number of C by power iteration on C and on its inverse; a lower bound,
/// usually within a factor of two. Two sparse factorisations and about eighty solves.
///
/// # Errors
/// As [`mass_condition`].
pub fn mass_condition_estimate(
    system: &RodSystem,
    chart: &dyn Chart,
    mass: &MassMatrix,
    x: &[f64],
) -> Result<f64, ChartError> {
    let n = chart.dimension();
    let mut linear = Linearised::new(system, chart.pattern())?;
    chart.linearise(system, &mut linear, x)?;
    let mut saddle = SaddlePoint::new(system, mass)?;
    saddle.factorize(system, x)?;
    let rows = linear.rows().to_vec();
    let mut v = vec![0.0; system.unknowns()];
    let mut w = vec![0.0; system.unknowns()];
    let mut mu = vec![0.0; system.equations()];
    let largest = power(n, |q, out| {
        linear.push(q, &mut v)?;
        apply_mass(system, mass, &v, &mut w);
        Ok(linear.pull(&w, &mut mu, out)?)
    })?;
    let mut apply = Inverse::new(system);
    let inverse = power(n, |p, out| apply.apply(&mut saddle, chart, &rows, p, out))?;
    Ok(largest * inverse)
}

/// The dense matrix `C = J^T M J`: the coefficients `c_jk` of Liu, Tang and Joneja 2007, Sec. 4.1.
#[must_use]
pub fn mass_matrix(system: &RodSystem, mass: &MassMatrix, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product: DMatrix<f64> = DMatrix::zeros(jacobian.nrows(), jacobian.ncols());
    for (column, mut out) in jacobian.column_iter().zip(product.column_iter_mut()) {
        apply_mass(system, mass, column.as_slice(), out.as_mut_slice());
    }
    let c = jacobian.tr_mul(&product);
    // Symmetric up to rounding; made exactly so.
    (&c + c.transpose()) * 0.5
}

/// `C^-1 p = S v` through the saddle-point matrix.
struct Inverse {
    force: Vec<f64>,
    zero: Vec<f64>,
    v: Vec<f64>,
    mu: Vec<f64>,
}

impl Inverse {
    fn new(system: &RodSystem) -> Self {
        Self {
            force: vec![0.0; system.unknowns()],
            zero: vec![0.0; system.equations()],
            v: vec![0.0; system.unknowns()],
            mu: vec![0.0; system.equations()],
        }
    }

    fn apply(
        &mut self,
        saddle: &mut SaddlePoint,
        chart: &dyn Chart,
        rows: &[f64],
        p: &[f64],
        out: &mut [f64],
    ) -> Result<(), ChartError> {
        self.force.fill(0.0);
        chart.pattern().add_transpose(rows, p, &mut self.force);
        saddle.solve(&self.force, &self.zero, &mut self.v, &mut self.mu)?;
        chart.pattern().apply(rows, &self.v, out);
        Ok(())
    }
}

fn largest_eigenvalue(a: DMatrix<f64>) -> f64 {
    a.symmetric_eigenvalues()
        .iter()
        .fold(0.0, |m: f64, l| m.max(l.abs()))
}

fn power(
    n: usize,
    mut apply: impl FnMut(&[f64], &mut [f64]) -> Result<(), ChartError>,
) -> Result<f64, ChartError> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut a: Vec<f64> = (0..n).map(|_| rng.random_range(-1.0..1.0)).collect();
    let mut b = vec![0.0; n];
    let mut eigenvalue = 0.0;
    for _ in 0..POWER_STEPS {
        let size = a.iter().map(|v| v * v).sum::<f64>().sqrt();
        a.iter_mut().for_each(|v| *v /= size);
        apply(&a, &mut b)?;
        eigenvalue = b.iter().map(|v| v * v).sum::<f64>().sqrt();
        std::mem::swap(&mut a, &mut b);
    }
    Ok(eigenvalue)
}

/// The bent states of [`condition_table`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BentState {
    /// Flat, with uniform noise of a tenth of the grid spacing out of plane (fixed seed; lengths are taken
    /// from the noisy state).
    Noise,
    /// On a cylinder of radius 0.4 of the side, rulings at 27 degrees to the x axis.
    Cylinder,
}

/// The charts of [`condition_table`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableChart {
    /// Front propagation from the corner vertex 0, pinned.
    FrontCorner,
    /// Front propagation from the centre vertex, pinned.
    FrontCentre,
    /// Selected Cartesian coordinates, corner vertex pinned.
    Cartesian,
}

/// One line of [`condition_table`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConditionRow {
    /// Level k of the union-jack square M^k.
    pub level: u32,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of faces.
    pub faces: usize,
    /// The state.
    pub state: BentState,
    /// The chart.
    pub chart: TableChart,
    /// Condition number of C.
    pub condition: f64,
}

/// Condition numbers of the mass matrix for three charts on bent union-jack squares of side 1 with
/// lumped masses, which compares coordinates assigned by fronts with selected Cartesian ones.
///
/// # Errors
/// [`ChartError`] when a chart is singular, which these states do not cause.
pub fn condition_table(
    levels: impl IntoIterator<Item = u32>,
) -> Result<Vec<ConditionRow>, ChartError> {
    let mut table = Vec::new();
    for level in levels {
        let sheet = generate::isotropic_square(level, 1.0)?;
        let mass = MassMatrix::from_density(&sheet, 1.0, MassKind::Lumped)?;
        for state in [BentState::Noise, BentState::Cylinder] {
            let x = bent_square(&sheet, level, state);
            for chart in [
                TableChart::FrontCorner,
                TableChart::FrontCentre,
                TableChart::Cartesian,
            ] {
                table.push(ConditionRow {
                    level,
                    vertices: sheet.topology().vertex_count(),
                    faces: sheet.topology().face_count(),
                    state,
                    chart,
                    condition: table_entry(&sheet, &mass, &x, chart)?,
                });
            }
        }
    }
    Ok(table)
}

fn table_entry(
    sheet: &Sheet,
    mass: &MassMatrix,
    x: &[f64],
    chart: TableChart,
) -> Result<f64, ChartError> {
    let pin = match chart {
        TableChart::FrontCentre => VertexId((sheet.topology().vertex_count() / 2) as u32),
        TableChart::FrontCorner | TableChart::Cartesian => VertexId(0),
    };
    let system = RodSystem::new(sheet, &[pin])?;
    let chart: Box<dyn Chart> = match chart {
        TableChart::Cartesian => Box::new(CartesianChart::new(system.clone(), Choice::Auto, x)?),
        TableChart::FrontCorner | TableChart::FrontCentre => {
            let options = AssignmentOptions {
                pins: vec![pin],
                ..Default::default()
            };
            Box::new(FrontChart::new(sheet, &options, x)?)
        }
    };
    mass_condition(&system, chart.as_ref(), mass, x)
}

/// A bent state of the union-jack square M^`level` of side 1, as [`condition_table`] uses it.
#[must_use]
pub fn bent_square(sheet: &Sheet, level: u32, state: BentState) -> Vec<f64> {
    let mut x = sheet.positions().to_vec();
    match state {
        BentState::Noise => {
            let spacing = 0.5f64.powi(level as i32 + 1);
            let mut rng = ChaCha8Rng::seed_from_u64(7);
            for z in x.iter_mut().skip(2).step_by(3) {
                *z = 0.1 * spacing * rng.random_range(-1.0..1.0);
            }
        }
        BentState::Cylinder => {
            let radius = 0.4;
            let (s, c) = 27f64.to_radians().sin_cos();
            for p in x.chunks_exact_mut(3) {
                let (along, across) = (c * p[0] + s * p[1], c * p[1] - s * p[0]);
                let angle = across / radius;
                let bent = radius * angle.sin();
                p[0] = c * along - s * bent;
                p[1] = s * along + c * bent;
                p[2] = radius * (1.0 - angle.cos());
            }
        }
    }
    x
}
