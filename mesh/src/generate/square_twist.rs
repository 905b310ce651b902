//! The square twist.

use super::error::{GenerateError, check_angle, check_order, check_size};
use super::origami::{FoldAssignment, FoldPattern};
use crate::Sheet;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

/// The square twist, flat: a sheet with the given side (metres) about the origin, and in its middle a
/// square with the side `square` (metres), turned counter-clockwise by `angle` (radians). From every side
/// of the square a pleat leads to the edge of the sheet: two creases along an axis, from the ends of the
/// side.
///
/// Vertex c is corner c of the inner square, c = 0 to 3 counter-clockwise from the lower left (before the
/// turn); vertices 4 + 3 c to 6 + 3 c are on the edge of the sheet: the ends of the creases from the
/// corners c and c + 1 that belong to side c, and the corner of the sheet after these. The sides of the
/// square are mountains. Of a pleat, the crease at which it makes an acute angle with the side is a valley
/// and the other one a mountain (Kawasaki and Yoshida, *Crystallographic flat origamis*, Mem. Fac. Sci.
/// Kyushu Univ. A 42, 1988; Silverberg et al., *Origami structures with a critical transition to
/// bistability arising from hidden degrees of freedom*, Nature Materials 14, 2015).
///
/// The sectors at a corner are `pi/2, pi/2 - angle, pi/2, pi/2 + angle`, so that the corner can be folded
/// flat. Between flat and folded flat the panels have to bend; each is cut in two along its shorter
/// diagonal, and these cuts are flat edges.
///
/// # Errors
/// [`GenerateError`] for a length that is not positive, a square whose diagonal is not shorter than the
/// side of the sheet, or an angle that is not between 0 and pi/2.
pub fn square_twist(side: f64, square: f64, angle: f64) -> Result<FoldPattern, GenerateError> {
    check_size("side", side)?;
    check_size("square", square)?;
    check_angle("angle", angle, [0.0, FRAC_PI_2])?;
    check_order(("square", square), ("side / sqrt(2)", side / SQRT_2))?;
    let (half, radius) = (0.5 * side, square / SQRT_2);
    // The lower left corner, and quarter turns of it.
    let (sine, cosine) = (angle - 3.0 * FRAC_PI_4).sin_cos();
    let first = [radius * cosine, radius * sine];
    let mut points = vec![first, turned(first, 1), turned(first, 2), turned(first, 3)];
    let second = points[1];
    for c in 0..4 {
        let below = [[first[0], -half], [second[0], -half], [half, -half]];
        points.extend(below.map(|p| turned(p, c)));
    }
    let mut panels = vec![[0, 1, 2, 3]];
    let mut creases = Vec::new();
    for c in 0..4 {
        let (this, next) = (c, (c + 1) % 4);
        let edge = [4 + 3 * c, 5 + 3 * c, 6 + 3 * c, 4 + 3 * next];
        panels.push([edge[0], edge[1], next, this]);
        panels.push([edge[1], edge[2], edge[3], next]);
        creases.push((this, next, FoldAssignment::Mountain));
        creases.push((this, edge[0], FoldAssignment::Mountain));
        creases.push((next, edge[1], FoldAssignment::Valley));
    }
    let mut faces = Vec::with_capacity(2 * panels.len());
    for panel in panels {
        let [p, q, r, s] = panel.map(|v| points[v]);
        let [a, b, c, d] = panel.map(|v| v as u32);
        if distance2(p, r) <= distance2(q, s) {
            faces.extend([[a, b, c], [a, c, d]]);
        } else {
            faces.extend([[a, b, d], [b, c, d]]);
        }
    }
    let positions = points.iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect();
    let sheet = Sheet::new(positions, &faces)?;
    Ok(FoldPattern::new(sheet, &creases))
}

/// A point after quarter turns about the origin.
fn turned([x, y]: [f64; 2], quarters: usize) -> [f64; 2] {
    match quarters {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

fn distance2([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c) * (a - c) + (b - d) * (b - d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VertexId;
    use crate::tests::flat_folding::check_flat_folding;

    #[test]
    fn counts_lengths_and_flat_folding() {
        for angle in [0.05, 0.5, FRAC_PI_4, 1.2, 1.5] {
            let (side, square) = (0.2, 0.06);
            let p = square_twist(side, square, angle).unwrap();
            let t = p.sheet.topology();
            assert_eq!((t.vertex_count(), t.face_count()), (16, 18));
            assert!((p.sheet.area() - side * side).abs() < 1e-15);
            assert_eq!(check_flat_folding(&p, |_| true), 4);
            let flat = p.assignments.iter().filter(|a| **a == FoldAssignment::Flat);
            assert_eq!(flat.count(), 9, "one for each panel");
            // The width of a pleat is that of its side as seen along the pleat.
            let x = |k: usize| p.sheet.position(VertexId::from_index(k))[0];
            assert!((x(5) - x(4) - square * angle.cos()).abs() < 1e-15);
            let edge = t.find_edge(VertexId(0), VertexId(1)).unwrap();
            assert!((p.sheet.lengths()[edge.index()] - square).abs() < 1e-15);
        }
    }

    /// The smallest sector at a corner is between creases that fold to different sides: with one fold between
    /// creases of a kind the larger sectors beside it would meet (Kawasaki's lemma of big, little, big).
    #[test]
    fn the_smallest_sector_is_between_unlike_creases() {
        let p = square_twist(0.2, 0.06, 0.6).unwrap();
        let t = p.sheet.topology();
        let sign = |a: usize, b: usize| {
            let [a, b] = [a, b].map(VertexId::from_index);
            p.assignment(t.find_edge(a, b).unwrap()).sign()
        };
        for c in 0..4 {
            let next = (c + 1) % 4;
            assert_eq!(sign(next, c), -sign(next, 5 + 3 * c));
        }
    }

    #[test]
    fn bad_arguments_are_refused() {
        let error = square_twist(1.0, 0.71, 0.5).unwrap_err();
        assert!(
            matches!(
                error,
                GenerateError::Order {
                    small: "square",
                    ..
                }
            ),
            "{error}"
        );
        assert!(square_twist(1.0, 0.5, 1.6).is_err());
        assert!(square_twist(f64::NAN, 0.5, 0.5).is_err());
        assert!(square_twist(1.0, -0.5, 0.5).is_err());
    }
}
