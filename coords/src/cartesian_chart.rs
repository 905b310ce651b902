//! A well-conditioned chart: Cartesian coordinates of well-chosen vertices.

use crate::chart::{Chart, ChartError};
use crate::linearised::Linearised;
use crate::newton::newton;
use crate::realise::{check, check_length};
use crate::row_pattern::RowPattern;
use crate::select::{Selection, eliminate, exchange, pivoted_qr};
use crate::system::RodSystem;
use isosheet_mesh::VertexId;

/// How a [`CartesianChart`] chooses its coordinates.
///
/// Condition numbers of C at the noise / cylinder states of [`crate::condition_table`], measured:
///
/// | mesh | pivoted QR | elimination | with exchanges |
/// |---|---|---|---|
/// | M^2 | 1.3e2 / 9.6e1 | 1.3e2 / 9.6e1 | 1.3e2 / 9.6e1 |
/// | M^3 | 5.5e2 / 4.5e2 | 5.2e2 / 5.3e2 | 5.2e2 / 5.3e2 |
/// | M^4 | | 2.1e3 / 1.7e3 | 2.1e3 / 1.7e3 |
/// | M^5 | | 8.4e3 / 8.6e3 | 8.3e3 / 8.6e3 |
/// | M^6 | | 3.4e4 / 3.2e4 | |
///
/// The condition grows like the number of faces, and the sparse elimination is as good as the dense
/// factorisation at a hundredth of its cost (M^3: 1.5 ms against 190 ms; M^6: 2.6 s).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// [`Choice::PivotedQr`] up to 300 unknowns, [`Choice::Exchange`] above, and
    /// [`Choice::Elimination`] where J would have more than 32 million entries.
    #[default]
    Auto,
    /// Dense QR factorisation of G with column pivoting: the pivot columns are the dependent
    /// unknowns, the others the coordinates. Cubic in the number of unknowns.
    PivotedQr,
    /// Sparse elimination of G^T with partial pivoting for a first choice, then exchanges of one coordinate
    /// for one dependent unknown while an entry of J = dx/dq is larger than 1.2 (a volume-maximising basis).
    /// The elimination alone usually satisfies this bound but does not guarantee it; few exchanges are
    /// needed. Forms J, unknowns x n, as a dense matrix.
    Exchange,
    /// The sparse elimination alone.
    Elimination,
}

/// Largest number of unknowns for which [`Choice::Auto`] takes the dense factorisation.
const DENSE_LIMIT: usize = 300;

/// Largest size of J (entries) for which [`Choice::Auto`] forms it; 256 MB.
const EXCHANGE_LIMIT: usize = 32_000_000;

/// Exchanges stop when no entry of J is larger. At 1 round-off would cause endless exchanges; at 1.2 every
/// exchange grows the volume by a fifth, so that their number is bounded by a multiple of n.
const EXCHANGE_BOUND: f64 = 1.2;

/// Chart of n of the free unknowns, selected at a reference state so that the derivatives of the others with
/// respect to them are small.
///
/// The coordinates are values in metres; rows of S are unit rows and do not change. Positions are found
/// by Newton's method on `[c(x); S x - q]`. The selection serves a neighbourhood of its reference state;
/// as the sheet moves on the condition number grows and [`Chart::rebased`] selects anew.
#[derive(Clone, Debug)]
pub struct CartesianChart {
    system: RodSystem,
    choice: Choice,
    selection: Vec<u32>,
    pattern: RowPattern,
}

impl CartesianChart {
    /// Select coordinates at the state `reference`.
    ///
    /// # Errors
    /// [`ChartError::RankDeficient`] where the length equations are dependent (flat states),
    /// [`ChartError::System`] when the pins leave no degree of freedom, [`ChartError::Realise`] for a
    /// malformed state, [`ChartError::Linalg`].
    pub fn new(system: RodSystem, choice: Choice, reference: &[f64]) -> Result<Self, ChartError> {
        system.check_freedom()?;
        let mut chart = Self {
            system,
            choice,
            selection: Vec::new(),
            pattern: RowPattern::new(),
        };
        chart.select(reference)?;
        Ok(chart)
    }

    /// The selected unknowns, ascending.
    #[must_use]
    pub fn selection(&self) -> &[u32] {
        &self.selection
    }

    /// Vertex and axis (0, 1, 2 for x, y, z) of each coordinate.
    pub fn components(&self) -> impl Iterator<Item = (VertexId, usize)> + '_ {
        self.selection.iter().map(|u| {
            (
                self.system.free_vertices()[*u as usize / 3],
                *u as usize % 3,
            )
        })
    }

    fn full_index(&self, k: usize) -> usize {
        let u = self.selection[k] as usize;
        3 * self.system.free_vertices()[u / 3].index() + u % 3
    }

    fn take(&mut self, mut selection: Vec<u32>) {
        selection.sort_unstable();
        self.pattern = RowPattern::new();
        for u in &selection {
            self.pattern.push([*u]);
        }
        self.selection = selection;
    }
}

impl Chart for CartesianChart {
    fn system(&self) -> &RodSystem {
        &self.system
    }

    fn dimension(&self) -> usize {
        self.selection.len()
    }

    fn pattern(&self) -> &RowPattern {
        &self.pattern
    }

    fn rows(&self, _x: &[f64], values: &mut [f64]) -> Result<(), ChartError> {
        check_length("values", values.len(), self.selection.len())?;
        values.fill(1.0);
        Ok(())
    }

    fn rows_rate(&self, _x: &[f64], _v: &[f64], values: &mut [f64]) -> Result<(), ChartError> {
        check_length("values", values.len(), self.selection.len())?;
        values.fill(0.0);
        Ok(())
    }

    fn coordinates(&self, x: &[f64], q: &mut [f64]) -> Result<(), ChartError> {
        check_length("x", x.len(), 3 * self.system.vertex_count())?;
        check_length("q", q.len(), self.selection.len())?;
        for (k, value) in q.iter_mut().enumerate() {
            *value = x[self.full_index(k)];
        }
        Ok(())
    }

    fn difference(&self, q1: &[f64], q0: &[f64], out: &mut [f64]) {
        for (o, (a, b)) in out.iter_mut().zip(q1.iter().zip(q0)) {
            *o = a - b;
        }
    }

    fn realise(
        &self,
        linear: &mut Linearised,
        q: &[f64],
        near: &[f64],
        x: &mut [f64],
    ) -> Result<(), ChartError> {
        check("near", near, 3 * self.system.vertex_count())?;
        check_length("x", x.len(), near.len())?;
        x.copy_from_slice(near);
        newton(self, linear, q, x)?;
        Ok(())
    }

    fn margin(&self, x: &[f64]) -> Result<f64, ChartError> {
        check("x", x, 3 * self.system.vertex_count())?;
        Ok(1.0)
    }

    fn rebased(&self, x: &[f64]) -> Result<Box<dyn Chart>, ChartError> {
        let mut chart = self.clone();
        chart.select(x)?;
        Ok(Box::new(chart))
    }
}

impl CartesianChart {
    /// Selects the coordinates at the state x.
    fn select(&mut self, x: &[f64]) -> Result<(), ChartError> {
        check("x", x, 3 * self.system.vertex_count())?;
        let choice = match self.choice {
            Choice::Auto if self.system.unknowns() <= DENSE_LIMIT => Choice::PivotedQr,
            Choice::Auto if self.system.unknowns() * self.system.dof() <= EXCHANGE_LIMIT => {
                Choice::Exchange
            }
            Choice::Auto => Choice::Elimination,
            other => other,
        };
        let Selection { independent, rank } = match choice {
            Choice::PivotedQr => pivoted_qr(&self.system, x),
            _ => eliminate(&self.system, x),
        };
        if rank < self.system.equations() {
            return Err(ChartError::RankDeficient {
                equations: self.system.equations(),
                rank,
            });
        }
        self.take(independent);
        if choice == Choice::Exchange {
            let mut linear = Linearised::new(&self.system, &self.pattern)?;
            self.linearise(&self.system, &mut linear, x)?;
            let mut jacobian = linear.jacobian()?;
            let mut selection = self.selection.clone();
            exchange(&mut jacobian, &mut selection, EXCHANGE_BOUND);
            self.take(selection);
        }
        Ok(())
    }
}
