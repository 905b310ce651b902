use super::super::ordering::{Ordering, elimination_order};
use super::super::symbolic::analyse;
use super::*;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;

/// The matrices of square grids, one beside the other, whose nodes have `block` unknowns each.
fn grids(sides: &[u32], block: u32) -> (Pattern, Vec<f64>) {
    let (mut entries, mut first) = (Vec::new(), 0);
    for side in sides {
        let at = |i: u32, j: u32| first + i * side + j;
        for i in 0..*side {
            for j in 0..*side {
                for (k, l) in [(i, j), (i + 1, j), (i, j + 1)] {
                    if k < *side && l < *side {
                        entries.push((at(k, l), at(i, j)));
                    }
                }
            }
        }
        first += side * side;
    }
    let in_block = |&(r, c): &(u32, u32)| {
        let rows = (0..block).flat_map(move |a| (0..block).map(move |b| (a, b)));
        rows.map(move |(a, b)| (block * r + a, block * c + b))
            .filter(|(r, c)| r >= c)
    };
    let entries: Vec<(u32, u32)> = entries.iter().flat_map(in_block).collect();
    let n = (first * block) as usize;
    let (pattern, slots) = Pattern::from_entries(n, n, &entries);
    let mut values = vec![0.0; pattern.len()];
    for (&(r, c), slot) in entries.iter().zip(slots) {
        values[slot as usize] = if r == c {
            5.1 * f64::from(block)
        } else {
            -f64::from(r + 3 * c).sin()
        };
    }
    (pattern, values)
}

/// Its factor as a dense matrix in the order of elimination, by columns, with that order.
fn dense(
    pattern: &Pattern,
    values: &[f64],
    ordering: Ordering,
    block: u32,
) -> (Vec<f64>, Vec<usize>) {
    let order = elimination_order(pattern, block as usize, ordering);
    let symbolic = analyse(pattern, Some(&order)).unwrap();
    let (SymbolicCholeskyRaw::Supernodal(supernodal), Some(perm)) =
        (symbolic.raw(), symbolic.perm())
    else {
        panic!("supernodal, with an order");
    };
    let mut fronts = Multifrontal::new(pattern, perm, supernodal).expect("a postorder");
    let mut factor = vec![f64::NAN; symbolic.len_val()];
    // Twice, so that what the first time leaves behind is seen.
    for _ in 0..2 {
        fronts.factorise(values, &mut factor).unwrap();
    }
    let n = pattern.cols();
    let mut full = vec![0.0; n * n];
    for front in &fronts.plan.fronts {
        let below = supernodal.supernode(
            supernodal
                .supernode_begin()
                .iter()
                .position(|&b| b == front.start)
                .unwrap(),
        );
        let rows: Vec<usize> = (front.start..front.start + front.columns)
            .chain(below.pattern().iter().copied())
            .collect();
        for j in 0..front.columns {
            let column = &factor[front.values.start + j * rows.len()..][..rows.len()];
            for i in j..rows.len() {
                full[(front.start + j) * n + rows[i]] = column[i];
            }
        }
    }
    (full, perm.arrays().0.to_vec())
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
            let (factor, order) = dense(&pattern, &values, ordering, block);
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
    let order = elimination_order(&pattern, 3, Ordering::NestedDissection);
    let symbolic = analyse(&pattern, Some(&order)).unwrap();
    let (SymbolicCholeskyRaw::Supernodal(supernodal), Some(perm)) =
        (symbolic.raw(), symbolic.perm())
    else {
        panic!("supernodal, with an order");
    };
    let mut fronts = Multifrontal::new(&pattern, perm, supernodal).expect("a postorder");
    assert!(fronts.plan.operations > WORTH_SHARING && fronts.plan.subtrees.len() > 1);
    let mut on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let mut factor = vec![0.0; symbolic.len_val()];
        pool.install(|| fronts.factorise(&values, &mut factor))
            .unwrap();
        factor.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let one = on(1);
    for threads in [2, 3, 5] {
        assert!(on(threads) == one, "{threads} threads");
    }
}

#[test]
fn the_first_bad_pivot_is_named_whatever_the_number_of_threads() {
    let (pattern, mut values) = grids(&[80], 3);
    let order = elimination_order(&pattern, 3, Ordering::NestedDissection);
    let symbolic = analyse(&pattern, Some(&order)).unwrap();
    let (SymbolicCholeskyRaw::Supernodal(supernodal), Some(perm)) =
        (symbolic.raw(), symbolic.perm())
    else {
        panic!("supernodal, with an order");
    };
    let mut fronts = Multifrontal::new(&pattern, perm, supernodal).expect("a postorder");
    let mut factor = vec![0.0; symbolic.len_val()];
    for place in [19_000, 700, 100] {
        let j = perm.arrays().0[place];
        values[pattern.col_ptr()[j]] = -1.0;
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let result = pool.install(|| fronts.factorise(&values, &mut factor));
            assert_eq!(result, Err(place), "{threads} threads");
        }
    }
}
