//! What the symmetric factorisations share: the view of a pattern and its symbolic analysis.

use super::error::LinalgError;
use super::pattern::Pattern;
use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams, cholesky as ch};

/// Adjacent supernodes are merged up to so many columns in all, if so large a part of the entries of both is
/// zero. With faer's limits (4, 16, 48 and any number of columns; 1, 0.8, 0.1 and 0.05) faer's numerical
/// factorisations of 243 and 867 unknowns take 6 to 8 % longer, of 3267 and 12 675 unknowns as long as with
/// these; solves are 5 % faster.
const MERGED: [(usize, f64); 4] = [(18, 1.0), (36, 0.5), (72, 0.2), (usize::MAX, 0.1)];

/// The pattern as faer sees it.
pub(super) fn view(p: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    SymbolicSparseColMatRef::new_checked(p.rows(), p.cols(), p.col_ptr(), None, p.row_idx())
}

/// Symbolic Cholesky analysis of a lower triangle in the given elimination order.
pub(super) fn analyse(
    pattern: &Pattern,
    order: &[usize],
) -> Result<ch::SymbolicCholesky<usize>, LinalgError> {
    let n = pattern.cols();
    let params = ch::CholeskySymbolicParams {
        // faer's automatic choice takes the simplicial code too often: up to five times slower.
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        supernodal_params: SymbolicSupernodalParams {
            relax: Some(&MERGED),
        },
        ..Default::default()
    };
    let mut inverse = vec![usize::MAX; n];
    for (k, &i) in order.iter().enumerate() {
        inverse[i] = k;
    }
    let ordering = ch::SymmetricOrdering::Custom(PermRef::new_checked(order, &inverse, n));
    ch::factorize_symbolic_cholesky(view(pattern), Side::Lower, ordering, params).map_err(|e| {
        LinalgError::Symbolic {
            order: n,
            reason: format!("{e:?}"),
        }
    })
}
