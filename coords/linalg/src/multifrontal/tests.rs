use super::super::ordering::{Ordering, elimination_order};
use super::super::symbolic::analyse;
use super::super::testing::grids;
use super::plan::WORTH_SHARING;
use super::*;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};

/// A matrix with its symbolic analysis.
struct Analysed {
    pattern: Pattern,
    symbolic: SymbolicCholesky<usize>,
}

impl Analysed {
    fn new(pattern: Pattern, block: u32, ordering: Ordering) -> Self {
        let order = elimination_order(&pattern, block as usize, ordering);
        let symbolic = analyse(&pattern, &order).unwrap();
        Self { pattern, symbolic }
    }

    fn supernodal(&self) -> &SymbolicSupernodalCholesky<usize> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(supernodal) => supernodal,
            SymbolicCholeskyRaw::Simplicial(_) => panic!("no supernodes"),
        }
    }

    fn perm(&self) -> PermRef<'_, usize> {
        self.symbolic.perm().expect("an order was given")
    }

    fn fronts(&self) -> Multifrontal {
        Multifrontal::new(&self.pattern, self.perm(), self.supernodal()).expect("a postorder")
    }

    /// Room for a factor, without values.
    fn factor(&self) -> Vec<f64> {
        vec![f64::NAN; self.symbolic.len_val()]
    }
}

fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

/// The factor as a dense matrix in the order of elimination, by columns.
fn dense(matrix: &Analysed, values: &[f64]) -> Vec<f64> {
    let (mut fronts, mut factor) = (matrix.fronts(), matrix.factor());
    // Twice, so that what the first time leaves behind is seen.
    for _ in 0..2 {
        fronts.factorise(values, &mut factor).unwrap();
    }
    let n = matrix.pattern.cols();
    let mut full = vec![0.0; n * n];
    for (s, front) in fronts.plan.fronts.iter().enumerate() {
        let below = matrix.supernodal().supernode(s).pattern();
        let rows: Vec<usize> = (front.start..front.start + front.columns)
            .chain(below.iter().copied())
            .collect();
        for j in 0..front.columns {
            let column = &factor[front.values.start + j * rows.len()..][..rows.len()];
            for i in j..rows.len() {
                full[(front.start + j) * n + rows[i]] = column[i];
            }
        }
    }
    full
}

#[test]
fn the_factor_times_its_transpose_is_the_matrix() {
    let cases: [(&[u32], u32); 6] = [
        (&[1], 1),
        (&[2], 3),
        (&[7], 1),
        (&[6], 2),
        (&[9], 3),
        (&[5, 1, 4], 3),
    ];
    for (sides, block) in cases {
        for ordering in [Ordering::MinimumDegree, Ordering::NestedDissection] {
            let (pattern, values) = grids(sides, block);
            let analysed = Analysed::new(pattern, block, ordering);
            let factor = dense(&analysed, &values);
            let (pattern, order) = (&analysed.pattern, analysed.perm().arrays().0);
            let n = pattern.cols();
            let mut matrix = vec![0.0; n * n];
            for j in 0..n {
                for k in pattern.col_ptr()[j]..pattern.col_ptr()[j + 1] {
                    let i = pattern.row_idx()[k];
                    matrix[j * n + i] = values[k];
                    matrix[i * n + j] = values[k];
                }
            }
            for a in 0..n {
                for b in 0..n {
                    let product: f64 = (0..n).map(|k| factor[k * n + a] * factor[k * n + b]).sum();
                    let error = (product - matrix[order[a] * n + order[b]]).abs();
                    assert!(
                        error < 1e-13 * f64::from(block),
                        "{sides:?}, {block}: {a}, {b}: {error}"
                    );
                }
            }
        }
    }
}

/// Subtrees are factorised by as many threads as there are.
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (pattern, values) = grids(&[80, 12], 3);
    let matrix = Analysed::new(pattern, 3, Ordering::NestedDissection);
    let mut fronts = matrix.fronts();
    assert!(fronts.plan.operations > WORTH_SHARING && fronts.plan.subtrees.len() > 1);
    let mut on = |threads: usize| {
        let mut factor = vec![0.0; matrix.symbolic.len_val()];
        on_threads(threads, || fronts.factorise(&values, &mut factor)).unwrap();
        factor.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let one = on(1);
    for threads in [2, 3, 5] {
        assert!(on(threads) == one, "{threads} threads");
    }
}

/// Solutions solve the system, with the same bits for any number of threads.
#[test]
fn solutions_have_the_same_bits_on_any_number_of_threads() {
    let (pattern, values) = grids(&[80, 12], 3);
    let matrix = Analysed::new(pattern, 3, Ordering::NestedDissection);
    let (mut fronts, mut factor) = (matrix.fronts(), matrix.factor());
    fronts.factorise(&values, &mut factor).unwrap();
    let order = matrix.perm().arrays().0;
    let b: Vec<f64> = (0..order.len()).map(|i| (i as f64).sin()).collect();
    let mut on = |threads: usize| {
        let mut x = b.clone();
        on_threads(threads, || fronts.solve(order, &factor, &mut x));
        x
    };
    let one = on(1);
    let mut residual = b.clone();
    matrix
        .pattern
        .sub_symmetric_product(&values, &one, &mut residual);
    assert!(residual.iter().all(|r| r.abs() < 1e-13));
    for threads in [2, 3, 5] {
        assert!(
            on(threads)
                .iter()
                .map(|x| x.to_bits())
                .eq(one.iter().map(|x| x.to_bits()))
        );
    }
}

#[test]
fn the_first_bad_pivot_is_named_whatever_the_number_of_threads() {
    let (pattern, mut values) = grids(&[80], 3);
    let matrix = Analysed::new(pattern, 3, Ordering::NestedDissection);
    let (mut fronts, mut factor) = (matrix.fronts(), matrix.factor());
    for place in [19_000, 700, 100] {
        let j = matrix.perm().arrays().0[place];
        values[matrix.pattern.col_ptr()[j]] = -1.0;
        for threads in [1, 2] {
            let result = on_threads(threads, || fronts.factorise(&values, &mut factor));
            assert_eq!(result, Err(place), "{threads} threads");
        }
    }
}
