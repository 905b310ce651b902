//! Elliptic integrals and functions by the arithmetic-geometric mean (Abramowitz and Stegun, 16.4,
//! 17.6).

/// Arithmetic-geometric mean.
pub fn agm(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// Complete elliptic integral of the first kind K(m), parameter `m = k^2 < 1`.
pub fn complete_k(m: f64) -> f64 {
    std::f64::consts::FRAC_PI_2 / agm(1.0, (1.0 - m).sqrt())
}

/// Complete elliptic integral of the second kind E(m), parameter `0 <= m = k^2 < 1`.
pub(crate) fn complete_e(m: f64) -> f64 {
    let (mut a, mut b, mut c) = (1.0, (1.0 - m).sqrt(), m.sqrt());
    let (mut sum, mut power) = (0.5 * m, 0.5);
    while c > 1e-16 {
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        power *= 2.0;
        sum += power * c * c;
    }
    complete_k(m) * (1.0 - sum)
}

/// Jacobi functions `(sn, cn, dn)` of argument `u` and parameter `m = k^2`, `0 <= m < 1`.
pub fn jacobi(u: f64, m: f64) -> (f64, f64, f64) {
    let (mut a, mut b, mut c) = (vec![1.0], (1.0 - m).sqrt(), vec![m.sqrt()]);
    while c[c.len() - 1] > 1e-16 {
        let last = a[a.len() - 1];
        c.push(0.5 * (last - b));
        a.push(0.5 * (last + b));
        b = (last * b).sqrt();
    }
    let n = a.len() - 1;
    let mut phi = 2.0_f64.powi(n as i32) * a[n] * u;
    for k in (1..=n).rev() {
        phi = 0.5 * (phi + (c[k] / a[k] * phi.sin()).asin());
    }
    let (sn, cn) = phi.sin_cos();
    (sn, cn, (1.0 - m * sn * sn).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values() {
        // Abramowitz and Stegun, table 17.1, m = 0.5.
        assert!((complete_k(0.5) - 1.854_074_677_301_372).abs() < 1e-14);
        assert!((complete_e(0.5) - 1.350_643_881_047_675).abs() < 1e-14);
        let quarter = complete_k(0.5);
        let (sn, cn, dn) = jacobi(quarter, 0.5);
        assert!((sn - 1.0).abs() < 1e-14 && cn.abs() < 1e-14);
        assert!((dn - 0.5_f64.sqrt()).abs() < 1e-14);
        // sn' = cn dn, by central differences.
        let h = 1e-5;
        let slope = (jacobi(0.7 + h, 0.3).0 - jacobi(0.7 - h, 0.3).0) / (2.0 * h);
        let (_, cn, dn) = jacobi(0.7, 0.3);
        assert!((slope - cn * dn).abs() < 1e-10);
    }
}
