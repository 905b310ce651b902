//! Numerical Cholesky factorisation by the multifrontal method (Duff and Reid, ACM Trans. Math. Softw. 9,
//! 1983; Liu, SIAM Review 34, 1992), on the threads of rayon's current pool.
//!
//! Each supernode of the factor, a *front*, is assembled from values of the matrix and from the updates of
//! its children in the elimination tree, is eliminated by dense kernels, and leaves an update to its parent.
//! faer's factorisation, which gathers updates from all descendants, takes 1.5 to 3 times as long for
//! matrices of 75 to 12 675 unknowns of sheets.

mod plan;
mod shared;
mod triangular;
mod trunk;

use super::dense;
use super::pattern::Pattern;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use plan::{Front, Plan, Subtree, WORTH_SHARING};
use pulp::{Arch, Simd, WithSimd};
use shared::{FrontValues, Job};
use triangular::Factor;

/// The plan of a factorisation, with working memory.
pub(super) struct Multifrontal {
    plan: Plan,
    updates: Vec<f64>,
    /// Inverses of the diagonal entries of the factor, in elimination order.
    inverses: Vec<f64>,
    /// A right-hand side in elimination order.
    rhs: Vec<f64>,
    /// Room for triangular solves.
    locals: Vec<f64>,
}

impl Multifrontal {
    /// The plan; nothing if the supernodes are in no postorder of the elimination tree.
    pub(super) fn new(
        pattern: &Pattern,
        perm: PermRef<'_, usize>,
        symbolic: &SymbolicSupernodalCholesky<usize>,
    ) -> Option<Self> {
        let plan = Plan::new(pattern, perm, symbolic)?;
        Some(Self {
            updates: vec![0.0; plan.room],
            inverses: vec![0.0; pattern.cols()],
            rhs: vec![0.0; pattern.cols()],
            locals: vec![0.0; plan.locals],
            plan,
        })
    }

    /// Multiplications of a factorisation, without square roots and divisions.
    pub(super) fn operations(&self) -> f64 {
        self.plan.operations
    }

    /// Whether subtrees are shared among threads, where there are several.
    pub(super) fn is_shared(&self) -> bool {
        self.plan.operations >= WORTH_SHARING
    }

    /// Sets `factor` to the Cholesky factor of the matrix with the given values. The result does not depend
    /// on the number of threads.
    ///
    /// # Errors
    /// The place in the order of elimination of an unknown whose pivot is not positive, the same for any
    /// number of threads.
    pub(super) fn factorise(&mut self, values: &[f64], factor: &mut [f64]) -> Result<(), usize> {
        let plan = &self.plan;
        let numbers = Numbers { plan, values };
        Branches(numbers).run_all(plan, [factor, &mut self.updates])?;
        Arch::new().dispatch(Trunk {
            numbers,
            factor,
            updates: &mut self.updates,
        })?;
        triangular::invert_diagonal(plan, factor, &mut self.inverses);
        Ok(())
    }

    /// Solves `A x = b` in place with the factor of the last factorisation; `order[k]` is the unknown that is
    /// eliminated k-th. The result does not depend on the number of threads.
    pub(super) fn solve(&mut self, order: &[usize], factor: &[f64], b: &mut [f64]) {
        for (x, &i) in self.rhs.iter_mut().zip(order) {
            *x = b[i];
        }
        let factor = Factor {
            plan: &self.plan,
            values: factor,
            inverses: &self.inverses,
        };
        triangular::solve(factor, &mut self.rhs, &mut self.locals);
        for (x, &i) in self.rhs.iter().zip(order) {
            b[i] = *x;
        }
    }
}

/// A matrix to be factorised.
#[derive(Clone, Copy)]
struct Numbers<'a> {
    plan: &'a Plan,
    values: &'a [f64],
}

/// Elimination of the subtrees, each with its columns of the factor and with its updates.
struct Branches<'a>(Numbers<'a>);

impl Job<2> for Branches<'_> {
    type Error = usize;

    fn begins(&self, subtree: &Subtree) -> [usize; 2] {
        [subtree.values.start, subtree.updates.start]
    }

    fn run(&self, subtree: &Subtree, [factor, updates]: [FrontValues<'_>; 2]) -> Result<(), usize> {
        Arch::new().dispatch(Branch {
            numbers: self.0,
            subtree,
            factor,
            updates,
        })
    }
}

impl Numbers<'_> {
    /// Sets the columns of a front and its update. `others` are the updates before and after its own.
    #[inline(always)]
    fn eliminate<S: Simd>(
        self,
        simd: S,
        front: &Front,
        panel: &mut [f64],
        update: &mut [f64],
        others: Others<'_>,
        square: impl FnOnce((&[f64], usize), (&mut [f64], usize)),
    ) -> Result<(), usize> {
        let plan = self.plan;
        panel.fill(0.0);
        for &[place, k] in &plan.entries[front.entries.clone()] {
            panel[place as usize] = self.values[k as usize];
        }
        let height = front.columns + front.rows;
        let children = || {
            plan.children[front.children.clone()].iter().map(|&c| {
                let child = &plan.fronts[c as usize];
                let places = &plan.places[child.places.clone()];
                let within = places.partition_point(|&p| (p as usize) < front.columns);
                (others.update_of(child), places, within)
            })
        };
        for (values, places, within) in children() {
            for j in 0..within {
                let target = &mut panel[places[j] as usize * height..][..height];
                add(column(values, places, j), &places[j..], 0, target);
            }
        }
        dense::factorise(simd, panel, height).map_err(|j| front.start + j)?;
        square((panel, height), (update, front.rows));
        for (values, places, within) in children() {
            for j in within..places.len() {
                let to = places[j] as usize - front.columns;
                let target = &mut update[to * front.rows..][..front.rows];
                add(
                    column(values, places, j),
                    &places[j..],
                    front.columns,
                    target,
                );
            }
        }
        Ok(())
    }
}

/// Column `j` of the update of a front whose rows have the given places, from the diagonal on.
#[inline(always)]
fn column<'a>(values: &'a [f64], places: &[u32], j: usize) -> &'a [f64] {
    &values[j * places.len()..][j..places.len()]
}

/// Adds values to those at the given places, counted from `first`.
#[inline(always)]
fn add(values: &[f64], places: &[u32], first: usize, target: &mut [f64]) {
    for (value, &place) in values.iter().zip(places) {
        target[place as usize - first] += value;
    }
}

/// The updates before a place of the array of all updates, and those from another place on.
#[derive(Clone, Copy)]
struct Others<'a> {
    start: usize,
    before: &'a [f64],
    end: usize,
    after: &'a [f64],
}

impl Others<'_> {
    #[inline(always)]
    fn update_of(&self, child: &Front) -> &[f64] {
        let size = child.rows * child.rows;
        if child.update < self.end {
            &self.before[child.update - self.start..][..size]
        } else {
            &self.after[child.update - self.end..][..size]
        }
    }
}

/// Elimination of a subtree.
struct Branch<'a> {
    numbers: Numbers<'a>,
    subtree: &'a Subtree,
    factor: FrontValues<'a>,
    updates: FrontValues<'a>,
}

impl WithSimd for Branch<'_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let (first, factor) = self.factor;
        let (start, updates) = self.updates;
        for front in &self.numbers.plan.fronts[self.subtree.fronts.clone()] {
            let panel = &mut factor[front.values.start - first..front.values.end - first];
            let (before, work) = updates.split_at_mut(front.work - start);
            let size = front.rows * front.rows;
            let others = Others {
                start,
                before,
                end: front.work,
                after: &[],
            };
            let square = |panel: (&[f64], usize), (out, size): (&mut [f64], usize)| {
                dense::square(simd, panel, (out, size), 0..size);
            };
            self.numbers
                .eliminate(simd, front, panel, &mut work[..size], others, square)?;
            let work = front.work - start;
            if front.work != front.update {
                updates.copy_within(work..work + size, front.update - start);
            }
        }
        Ok(())
    }
}

/// Elimination of the fronts above all subtrees.
struct Trunk<'a> {
    numbers: Numbers<'a>,
    factor: &'a mut [f64],
    updates: &'a mut [f64],
}

impl WithSimd for Trunk<'_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let plan = self.numbers.plan;
        for &s in &plan.trunk {
            let front = &plan.fronts[s as usize];
            let (before, rest) = self.updates.split_at_mut(front.update);
            let (update, after) = rest.split_at_mut(front.rows * front.rows);
            let others = Others {
                start: 0,
                before,
                end: front.update + update.len(),
                after,
            };
            let panel = &mut self.factor[front.values.clone()];
            self.numbers
                .eliminate(simd, front, panel, update, others, trunk::square)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
