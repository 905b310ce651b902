//! Elimination orders for saddle-point matrices.

/// Moves every multiplier of a saddle-point matrix behind the last of its own unknowns.
///
/// `base` is any fill-reducing order (`base[k]` is eliminated k-th) of a matrix
/// `[A G^T; G 0]` whose unknowns `0..primal` are primal and the rest multipliers;
/// `adjacency[i]` lists the neighbours of unknown `i`. With `A` positive definite and `G`
/// of full rank, every pivot of `L D L^T` in the returned order has a known sign (positive
/// for primal unknowns, negative for multipliers), so no pivoting is needed
/// (Bridson, "An ordering method for the direct solution of saddle-point matrices", 2007).
pub fn delay_multipliers(base: &[usize], adjacency: &[Vec<u32>], primal: usize) -> Vec<usize> {
    let mut waiting_for: Vec<usize> = adjacency
        .iter()
        .enumerate()
        .map(|(i, list)| {
            if i < primal {
                0
            } else {
                list.iter().filter(|&&j| (j as usize) < primal).count()
            }
        })
        .collect();
    let mut passed = vec![false; base.len()];
    let mut order = Vec::with_capacity(base.len());
    for &i in base {
        if i >= primal {
            passed[i] = true;
            if waiting_for[i] == 0 {
                order.push(i);
            }
            continue;
        }
        order.push(i);
        for &j in &adjacency[i] {
            let j = j as usize;
            if j >= primal {
                waiting_for[j] -= 1;
                if waiting_for[j] == 0 && passed[j] {
                    order.push(j);
                }
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multipliers_follow_their_unknowns() {
        // Unknowns 0..3 primal; multiplier 3 couples 0 and 1, multiplier 4 couples 1 and 2.
        let adjacency = vec![vec![3], vec![3, 4], vec![4], vec![0, 1], vec![1, 2]];
        let order = delay_multipliers(&[3, 0, 4, 1, 2], &adjacency, 3);
        assert_eq!(order, [0, 1, 3, 2, 4]);
    }
}
