//! Regular outlines, and polygons in rings within any outline that is seen from the origin.

use super::error::{GenerateError, check_count, check_size};
use super::round::rings_about_centre;
use crate::Sheet;
use std::f64::consts::TAU;

/// The corners of a regular polygon about the origin, counter-clockwise, `[x, y]` in metres: corner k is at
/// the angle `2 pi (k + 1/2) / sides`, so that the x axis leads through the middle of a side. `radius`
/// (metres) is that of the circumscribed circle.
///
/// ```
/// use isosheet_mesh::generate::regular_outline;
///
/// let square = regular_outline(4, 2_f64.sqrt())?;
/// assert!(square.iter().flatten().all(|c| (c.abs() - 1.0).abs() < 1e-15));
/// # Ok::<(), isosheet_mesh::generate::GenerateError>(())
/// ```
///
/// # Errors
/// [`GenerateError`] for fewer than three sides or a radius that is not positive.
pub fn regular_outline(sides: usize, radius: f64) -> Result<Vec<[f64; 2]>, GenerateError> {
    check_count("sides", sides, 3)?;
    check_size("radius", radius)?;
    let corner = |k: usize| {
        let (sin, cos) = (TAU * (k as f64 + 0.5) / sides as f64).sin_cos();
        [radius * cos, radius * sin]
    };
    Ok((0..sides).map(corner).collect())
}

/// The polygon with the given corners (metres) in concentric rings of triangles about the origin.
///
/// Ring r of 1 ..= `rings` is the outline scaled by r / rings with r edges on each side, so that the lines
/// from the origin to the corners are edges and each of the n sectors is cut into rings^2 similar triangles:
/// V = 1 + n rings (rings + 1) / 2, F = n rings^2. Vertex 0 is the origin; each ring begins on the line to
/// corner 0.
///
/// # Errors
/// [`GenerateError::Outline`] for fewer than three corners, or an outline that does not run counter-clockwise
/// round the origin once, with every side less than half a turn wide; [`GenerateError::Count`] for no ring.
pub fn polygon_rings(outline: &[[f64; 2]], rings: usize) -> Result<Sheet, GenerateError> {
    check_seen_from_origin(outline)?;
    let n = outline.len();
    rings_about_centre(n, rings, |r, side, k| {
        let (a, b) = (outline[side], outline[(side + 1) % n]);
        let (size, s) = (r as f64 / rings as f64, k as f64 / r as f64);
        [0, 1].map(|axis| size * (a[axis] + s * (b[axis] - a[axis])))
    })
}

/// Whether the corners run counter-clockwise round the origin once.
fn check_seen_from_origin(outline: &[[f64; 2]]) -> Result<(), GenerateError> {
    let n = outline.len();
    let fault = |corner, problem| Err(GenerateError::Outline { corner, problem });
    if n < 3 {
        return fault(n, "an outline has at least three corners");
    }
    let mut turned = 0.0;
    for (k, a) in outline.iter().enumerate() {
        let b = outline[(k + 1) % n];
        let (sin, cos) = (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
        // Not a number is no turn either.
        if !(sin.is_finite() && sin > 0.0) {
            return fault(
                k,
                "the side that begins here does not run counter-clockwise round the origin",
            );
        }
        turned += sin.atan2(cos);
    }
    if turned > 1.5 * TAU {
        return fault(0, "the outline runs round the origin more than once");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_on_the_circle_and_sides_upright() {
        for sides in [3, 4, 8, 13] {
            let corners = regular_outline(sides, 2.0).unwrap();
            assert_eq!(corners.len(), sides);
            assert!(
                corners
                    .iter()
                    .all(|c| (c[0].hypot(c[1]) - 2.0).abs() < 1e-15)
            );
            let (first, last) = (corners[0], corners[sides - 1]);
            assert!((first[0] - last[0]).abs() < 1e-14 && (first[1] + last[1]).abs() < 1e-14);
        }
        assert!(regular_outline(2, 1.0).is_err() && regular_outline(3, f64::NAN).is_err());
    }

    #[test]
    fn rings_fill_the_polygon_and_have_its_corner_lines() {
        let outline = regular_outline(8, 2.0).unwrap();
        let sheet = polygon_rings(&outline, 5).unwrap();
        let t = sheet.topology();
        assert_eq!((t.vertex_count(), t.face_count()), (1 + 8 * 15, 8 * 25));
        assert!((sheet.area() - 8.0 * 2.0 * (TAU / 8.0).sin()).abs() < 1e-12);
        let hem = t.vertex_ids().filter(|v| t.is_boundary_vertex(*v)).count();
        assert_eq!(hem, 40);
        // Five edges from the middle to each corner.
        let along = |p: [f64; 3]| {
            let mut corners = outline.iter();
            corners.any(|c| (p[0] * c[1] - p[1] * c[0]).abs() < 1e-12)
        };
        let lines = t.edges().iter().map(|e| e.map(|v| sheet.position(v)));
        let radial = lines
            .filter(|[p, q]| along(*p) && along(*q) && (p[0] * q[1] - p[1] * q[0]).abs() < 1e-12);
        assert_eq!(radial.count(), 40);
    }

    #[test]
    fn outlines_that_the_origin_does_not_see_are_refused() {
        let clockwise = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]];
        let aside = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]];
        let twice: Vec<[f64; 2]> = (0..6)
            .map(|k| (TAU * 2.0 * f64::from(k) / 6.0 + 0.1 * f64::from(k / 3)).sin_cos())
            .map(|(s, c)| [c, s])
            .collect();
        let unknown = [[1.0, 0.0], [0.0, f64::NAN], [-1.0, -1.0]];
        for outline in [&clockwise[..], &aside, &twice, &unknown, &clockwise[..2]] {
            let refused = polygon_rings(outline, 2);
            assert!(
                matches!(refused, Err(GenerateError::Outline { .. })),
                "{outline:?}"
            );
        }
    }
}
