//! Generalised minimal residuals (Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 1986).

use isosheet_materials::vectors::dot;

/// Most vectors of a Krylov space.
const MOST: usize = 80;

/// How a solution was found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Solved {
    /// What is left of the preconditioned residual, relative to the right-hand side.
    pub(crate) residual: f64,
    pub(crate) iterations: usize,
}

/// A linear system with what it is preconditioned by.
pub(crate) trait System {
    /// `A z`.
    fn apply(&mut self, z: &[f64], out: &mut [f64]);

    /// `P^-1 z`, in place.
    fn precondition(&mut self, z: &mut [f64]);
}

/// Solves `A z = b` until the preconditioned residual is a part `tolerance` of the
/// preconditioned right-hand side, or round-off hides it, in so many iterations at most. Sizes are measured
/// with `weights`.
pub(crate) fn solve(
    system: &mut impl System,
    b: &[f64],
    weights: &[f64],
    tolerance: f64,
    most: usize,
    z: &mut [f64],
) -> Solved {
    let n = b.len();
    let norm = |v: &[f64]| {
        let squares = v.iter().zip(weights).map(|(v, w)| w * v * v);
        squares.sum::<f64>().sqrt()
    };
    let mut rhs = b.to_vec();
    system.precondition(&mut rhs);
    let goal = tolerance * norm(&rhs);
    z.copy_from_slice(&rhs);
    let mut iterations = 0;
    let mut image = vec![0.0; n];
    let mut last = f64::INFINITY;
    loop {
        system.apply(z, &mut image);
        let mut r: Vec<f64> = b.iter().zip(&image).map(|(b, i)| b - i).collect();
        system.precondition(&mut r);
        let size = norm(&r);
        let relative = if goal > 0.0 {
            size / goal * tolerance
        } else {
            0.0
        };
        // A cycle that did not halve what was left ran into round-off.
        let is_stuck = size > 0.5 * last;
        last = size;
        if size <= goal || iterations >= most || is_stuck || !size.is_finite() {
            let residual = relative;
            return Solved {
                residual,
                iterations,
            };
        }
        r.iter_mut().for_each(|r| *r /= size);
        let mut basis = vec![r];
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut turns: Vec<[f64; 2]> = Vec::new();
        let mut rest = vec![size];
        while iterations < most && basis.len() <= MOST {
            iterations += 1;
            let k = basis.len() - 1;
            system.apply(&basis[k], &mut image);
            let mut next = image.clone();
            system.precondition(&mut next);
            let mut column = Vec::with_capacity(k + 2);
            for own in &basis {
                let weighted: Vec<f64> = own.iter().zip(weights).map(|(o, w)| o * w).collect();
                let part = dot(&weighted, &next);
                next.iter_mut().zip(own).for_each(|(n, o)| *n -= part * o);
                column.push(part);
            }
            let length = norm(&next);
            for (i, [c, s]) in turns.iter().enumerate() {
                let (a, b) = (column[i], column[i + 1..].first().copied().unwrap_or(0.0));
                (column[i], column[i + 1]) = (c * a + s * b, c * b - s * a);
            }
            let hypot = column[k].hypot(length);
            let [c, s] = [column[k] / hypot, length / hypot];
            column[k] = hypot;
            turns.push([c, s]);
            rest.push(-s * rest[k]);
            rest[k] *= c;
            columns.push(column);
            let is_done = rest[k + 1].abs() <= 0.5 * goal;
            if is_done || length == 0.0 || !length.is_finite() {
                break;
            }
            next.iter_mut().for_each(|n| *n /= length);
            basis.push(next);
        }
        let count = columns.len();
        let mut y = rest[..count].to_vec();
        for i in (0..count).rev() {
            for j in i + 1..count {
                y[i] -= columns[j][i] * y[j];
            }
            y[i] /= columns[i][i];
        }
        for (y, own) in y.iter().zip(&basis) {
            z.iter_mut().zip(own).for_each(|(z, o)| *z += y * o);
        }
        if iterations >= most {
            system.apply(z, &mut image);
            let mut r: Vec<f64> = b.iter().zip(&image).map(|(b, i)| b - i).collect();
            system.precondition(&mut r);
            let residual = norm(&r) / goal * tolerance;
            return Solved {
                residual,
                iterations,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix without symmetry, preconditioned by its diagonal.
    struct Small;

    impl System for Small {
        fn apply(&mut self, z: &[f64], out: &mut [f64]) {
            for i in 0..z.len() {
                let before = if i > 0 { z[i - 1] } else { 0.0 };
                out[i] = (2.0 + i as f64) * z[i] - 0.7 * before;
            }
        }

        fn precondition(&mut self, z: &mut [f64]) {
            for (i, z) in z.iter_mut().enumerate() {
                *z /= 2.0 + i as f64;
            }
        }
    }

    #[test]
    fn a_system_without_symmetry_is_solved() {
        let expected: Vec<f64> = (0..30).map(|i| (f64::from(i)).sin()).collect();
        let mut b = vec![0.0; 30];
        Small.apply(&expected, &mut b);
        let mut z = vec![0.0; 30];
        let solved = solve(&mut Small, &b, &[1.0; 30], 1e-13, 100, &mut z);
        assert!(solved.residual <= 1e-13 && solved.iterations < 31);
        for (found, expected) in z.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12);
        }
    }
}
