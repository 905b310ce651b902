//! The area of a triangle from the lengths of its sides.

/// The area of a triangle with sides of the given lengths, in any order.
///
/// Heron's formula in the form of W. Kahan, "Miscalculating area and angles of a needle-like triangle"
/// (2014): with the sides sorted, `a >= b >= c`,
///
/// `area = sqrt((a + (b + c)) (c - (a - b)) (c + (a - b)) (a + (b - c))) / 4`,
///
/// where the parentheses matter. The result has almost all digits for every triangle that the lengths make,
/// however thin; the altitude over the longest side is `2 area / a`. Lengths that make no triangle have the
/// area 0 (`a > b + c`, which rounding can bring about in a thin triangle), and a length that is not a number
/// gives an area that is not a number.
///
/// Units: the square of the unit of the lengths. Lengths have to be between 1e-70 and 1e70, as in a
/// [`Sheet`](crate::Sheet), so that the product of four of them is in the range of `f64`.
///
/// ```
/// assert_eq!(isosheet_mesh::area_from_lengths([3.0, 5.0, 4.0]), 6.0);
/// ```
pub fn area_from_lengths(mut lengths: [f64; 3]) -> f64 {
    lengths.sort_by(f64::total_cmp);
    let [c, b, a] = lengths;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    if product <= 0.0 {
        return 0.0;
    }
    0.25 * product.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Right and isosceles triangles, whose areas are known without Heron's formula.
    #[test]
    fn closed_forms_of_compact_triangles() {
        let equilateral = 0.25 * 3.0_f64.sqrt();
        assert!((area_from_lengths([1.0; 3]) - equilateral).abs() < 1e-16);
        for order in [[5.0, 12.0, 13.0], [12.0, 13.0, 5.0], [13.0, 5.0, 12.0]] {
            assert_eq!(area_from_lengths(order), 30.0);
        }
        for size in [1e-70, 1e69] {
            let area = area_from_lengths([3.0 * size, 4.0 * size, 5.0 * size]);
            assert!((area / (6.0 * size * size) - 1.0).abs() < 1e-14);
        }
    }

    /// An isosceles triangle of base `2^-k` and sides 1 has the area `b sqrt((2 - b) (2 + b)) / 4`; Heron's
    /// formula with the half perimeter has lost half of the digits at `k = 26`.
    #[test]
    fn needles_keep_their_digits() {
        for k in 0..50 {
            let base = 0.5_f64.powi(k);
            let exact = 0.25 * base * ((2.0 - base) * (2.0 + base)).sqrt();
            let area = area_from_lengths([1.0, base, 1.0]);
            assert!((area / exact - 1.0).abs() < 1e-15, "base 2^-{k}: {area:e}");
        }
        // An apex close to the middle of a base 2: altitude sqrt((1 + u)^2 - 1) with equal sides 1 + u.
        let half = 0.5_f64.powi(30);
        let area = area_from_lengths([1.0 + half, 1.0 + half, 2.0]);
        let exact = (half * (2.0 + half)).sqrt();
        assert!((area / exact - 1.0).abs() < 1e-15, "{area:e} {exact:e}");
    }

    #[test]
    fn lengths_that_make_no_triangle() {
        assert_eq!(area_from_lengths([1.0, 2.0, 3.0]), 0.0);
        assert_eq!(area_from_lengths([1.0, 1.0, 3.0]), 0.0);
        assert!(area_from_lengths([1.0, f64::NAN, 1.0]).is_nan());
    }
}
