//! What the symmetric factorisations share: the view of a pattern and its symbolic analysis.

use super::error::LinalgError;
use super::pattern::Pattern;
use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::{SupernodalThreshold, cholesky as ch};

/// The pattern as faer sees it.
pub(super) fn view(p: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    SymbolicSparseColMatRef::new_checked(p.rows(), p.cols(), p.col_ptr(), None, p.row_idx())
}

/// Symbolic Cholesky analysis of a lower triangle, in the given elimination order or in faer's
/// approximate-minimum-degree order.
pub(super) fn analyse(
    pattern: &Pattern,
    order: Option<&[usize]>,
) -> Result<ch::SymbolicCholesky<usize>, LinalgError> {
    let n = pattern.cols();
    let params = ch::CholeskySymbolicParams {
        // faer's automatic choice takes the simplicial code too often: up to five times slower.
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    let inverse: Vec<usize>;
    let ordering = match order {
        None => ch::SymmetricOrdering::Amd,
        Some(forward) => {
            let mut inv = vec![usize::MAX; n];
            for (k, &i) in forward.iter().enumerate() {
                inv[i] = k;
            }
            inverse = inv;
            ch::SymmetricOrdering::Custom(PermRef::new_checked(forward, &inverse, n))
        }
    };
    ch::factorize_symbolic_cholesky(view(pattern), Side::Lower, ordering, params).map_err(|e| {
        LinalgError::Symbolic {
            order: n,
            reason: format!("{e:?}"),
        }
    })
}
