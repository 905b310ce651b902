//! Rank-revealing selection of independent unknowns of the length equations.

use crate::system::RodSystem;
use nalgebra::DMatrix;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Pivots below this fraction of the largest entry of their row of G count as zero.
///
/// In a sheet folded by a small angle t the smallest singular value of G is about t times the largest. A
/// state folded by less than 1e-9 is therefore refused as flat; at that angle about seven digits of the
/// Jacobian are right.
const RANK_TOLERANCE: f64 = 1e-9;

/// Result of a selection.
pub(crate) struct Selection {
    /// The unknowns that are left as coordinates.
    pub(crate) independent: Vec<u32>,
    /// Numerical rank of G.
    pub(crate) rank: usize,
}

/// Dense QR of G with column pivoting: dependent unknowns are the pivot columns.
pub(crate) fn pivoted_qr(system: &RodSystem, x: &[f64]) -> Selection {
    let mut g: DMatrix<f64> = DMatrix::zeros(system.equations(), system.unknowns());
    for ((e, u), value) in system.jacobian_entries().zip(system.jacobian_values(x)) {
        g[(e as usize, u as usize)] = value;
    }
    let mut order: DMatrix<f64> = DMatrix::from_fn(1, system.unknowns(), |_, u| u as f64);
    let qr = g.col_piv_qr();
    qr.p().permute_columns(&mut order);
    let r = qr.unpack_r();
    let first = r[(0, 0)].abs();
    let rank = (0..system.equations())
        .take_while(|&i| r[(i, i)].abs() > RANK_TOLERANCE * first)
        .count();
    Selection {
        independent: order
            .iter()
            .skip(system.equations())
            .map(|u| *u as u32)
            .collect(),
        rank,
    }
}

/// Sparse left-looking elimination of G^T, one rod after the other, each pivoting on its largest
/// remaining unknown. Multipliers are at most 1 in size.
///
/// Rods are taken in breadth-first order over the mesh, which keeps the fill within a front.
pub(crate) fn eliminate(system: &RodSystem, x: &[f64]) -> Selection {
    let order = breadth_first(system);
    let unknowns = system.unknowns();
    let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); system.equations()];
    for ((e, u), value) in system.jacobian_entries().zip(system.jacobian_values(x)) {
        rows[e as usize].push((u, value));
    }
    // Step that pivoted on an unknown, and the columns of L below their pivots.
    let mut step_of: Vec<Option<u32>> = vec![None; unknowns];
    let mut lower: Vec<Vec<(u32, f64)>> = Vec::with_capacity(rows.len());
    let mut dense = vec![0.0; unknowns];
    let mut present = vec![false; unknowns];
    let mut pending: BinaryHeap<Reverse<(u32, u32)>> = BinaryHeap::new();
    let mut rank = 0;
    for e in order {
        let mut touched: Vec<u32> = Vec::new();
        let mut size: f64 = 0.0;
        for &(u, value) in &rows[e as usize] {
            dense[u as usize] = value;
            present[u as usize] = true;
            touched.push(u);
            size = size.max(value.abs());
            if let Some(k) = step_of[u as usize] {
                pending.push(Reverse((k, u)));
            }
        }
        while let Some(Reverse((k, u))) = pending.pop() {
            let factor = dense[u as usize];
            if factor == 0.0 {
                continue;
            }
            for &(w, l) in &lower[k as usize] {
                if !present[w as usize] {
                    present[w as usize] = true;
                    touched.push(w);
                    if let Some(j) = step_of[w as usize] {
                        pending.push(Reverse((j, w)));
                    }
                }
                dense[w as usize] -= factor * l;
            }
        }
        let mut pivot: Option<u32> = None;
        for &u in &touched {
            let better = pivot.is_none_or(|p| dense[u as usize].abs() > dense[p as usize].abs());
            if step_of[u as usize].is_none() && better {
                pivot = Some(u);
            }
        }
        match pivot {
            Some(p) if dense[p as usize].abs() > RANK_TOLERANCE * size => {
                let inverse = 1.0 / dense[p as usize];
                step_of[p as usize] = Some(lower.len() as u32);
                lower.push(
                    touched
                        .iter()
                        .filter(|u| step_of[**u as usize].is_none() && dense[**u as usize] != 0.0)
                        .map(|u| (*u, dense[*u as usize] * inverse))
                        .collect(),
                );
                rank += 1;
            }
            _ => {}
        }
        for u in touched {
            dense[u as usize] = 0.0;
            present[u as usize] = false;
        }
    }
    Selection {
        independent: (0..unknowns as u32)
            .filter(|u| step_of[*u as usize].is_none())
            .collect(),
        rank,
    }
}

/// Rods in breadth-first order of their later end, started at a vertex far from the middle.
fn breadth_first(system: &RodSystem) -> Vec<u32> {
    let count = system.vertex_count();
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); count];
    for rod in system.rods() {
        let [a, b] = rod.ends;
        neighbours[a.index()].push(b.0);
        neighbours[b.index()].push(a.0);
    }
    let mut number = vec![u32::MAX; count];
    let mut queue: Vec<u32> = Vec::with_capacity(count);
    for root in 0..count {
        if number[root] != u32::MAX {
            continue;
        }
        let mut head = queue.len();
        number[root] = head as u32;
        queue.push(root as u32);
        while head < queue.len() {
            for &w in &neighbours[queue[head] as usize] {
                if number[w as usize] == u32::MAX {
                    number[w as usize] = queue.len() as u32;
                    queue.push(w);
                }
            }
            head += 1;
        }
    }
    let mut order: Vec<u32> = (0..system.equations() as u32).collect();
    order.sort_by_key(|e| {
        let [a, b] = system.rods()[*e as usize].ends.map(|v| number[v.index()]);
        (a.max(b), a.min(b))
    });
    order
}

/// Exchange coordinates for dependent unknowns while an entry of J = dx/dq exceeds `bound`: the
/// unknown with the largest entry becomes the coordinate in the place of that entry's column.
///
/// `jacobian` is unknowns x n with unit rows at the selected unknowns; both are updated. Returns the
/// number of exchanges.
pub(crate) fn exchange(jacobian: &mut DMatrix<f64>, selection: &mut [u32], bound: f64) -> usize {
    let n = selection.len();
    let mut count = 0;
    // Each exchange multiplies the volume by at least `bound`; the cap only guards against rounding.
    while count < 100 * n {
        let (mut best, mut row, mut column) = (bound, usize::MAX, 0);
        for k in 0..n {
            for (i, value) in jacobian.column(k).iter().enumerate() {
                if value.abs() > best {
                    (best, row, column) = (value.abs(), i, k);
                }
            }
        }
        if row == usize::MAX {
            break;
        }
        // The old coordinate k satisfies dx_row = sum_j J_row,j dq_j: solve for dq_k.
        let pivot = jacobian[(row, column)];
        let pivot_row: Vec<f64> = jacobian.row(row).iter().copied().collect();
        let old = jacobian.column(column).clone_owned();
        for k in 0..n {
            let factor = pivot_row[k] / pivot;
            if k == column {
                jacobian.column_mut(k).copy_from(&(&old / pivot));
            } else if factor != 0.0 {
                jacobian.column_mut(k).axpy(-factor, &old, 1.0);
                jacobian[(row, k)] = 0.0;
            }
        }
        jacobian[(row, column)] = 1.0;
        selection[column] = row as u32;
        count += 1;
    }
    count
}

/// Gaussian elimination with complete pivoting: for each row eliminated the column of its pivot.
/// Stops at pivots below 1e-10 of the first one, where the rows count as dependent.
pub(crate) fn pivot_columns(a: &mut DMatrix<f64>) -> Vec<usize> {
    let (rows, columns) = a.shape();
    let mut free: Vec<usize> = (0..rows).collect();
    let mut pivots = Vec::new();
    let mut first = 0.0;
    while !free.is_empty() {
        let (mut best, mut place, mut column) = (0.0, 0, 0);
        for (i, &r) in free.iter().enumerate() {
            for c in 0..columns {
                if a[(r, c)].abs() > best {
                    (best, place, column) = (a[(r, c)].abs(), i, c);
                }
            }
        }
        if pivots.is_empty() {
            first = best;
        }
        if best <= 1e-10 * first || best == 0.0 {
            break;
        }
        let pivot = free.swap_remove(place);
        for &r in &free {
            let factor = a[(r, column)] / a[(pivot, column)];
            if factor != 0.0 {
                for c in 0..columns {
                    a[(r, c)] -= factor * a[(pivot, c)];
                }
                a[(r, column)] = 0.0;
            }
        }
        pivots.push(column);
    }
    pivots
}
