//! The octagonal sheet of Fig. 15.

use std::f64::consts::{FRAC_PI_4, FRAC_PI_8};

use super::delaunay::{relaxed, subdivide};
use super::error::{GenerateError, check_size};
use crate::Sheet;

/// A regular octagon with exactly 244 vertices and 440 faces, the counts of Liu, Tang and Joneja 2007, Fig.
/// 15.
///
/// Any triangulated disk with 46 boundary edges and 198 interior vertices has these counts; the paper does
/// not say more of its mesh. Here the two vertical sides are cut into 5 parts and the others into 6; inside
/// lies a lattice of equilateral triangles, smoothed a little towards the sides, and the triangulation is the
/// Delaunay one. All but 14 interior vertices have degree 6. `radius` (metres) is that of the circumscribed
/// circle about the origin. Boundary vertices come first, counter-clockwise from the angle pi/8.
///
/// # Errors
/// [`GenerateError::Size`] for a radius that is not positive.
pub fn octagon_244(radius: f64) -> Result<Sheet, GenerateError> {
    const SIDE_PARTS: [usize; 8] = [6, 6, 6, 5, 6, 6, 6, 5];
    /// Edge of the lattice for radius 1; any value from 0.1168 to 0.1177 leaves 198 points with the clearance
    /// below.
    const SPACING: f64 = 0.1172;
    /// Lattice points keep this part of the spacing from the sides.
    const CLEARANCE: f64 = 0.8;
    /// More rounds make the triangles at the sides worse again.
    const ROUNDS: usize = 2;
    check_size("radius", radius)?;
    let corner = |k: usize| {
        let (s, c) = (FRAC_PI_8 + FRAC_PI_4 * k as f64).sin_cos();
        [c, s]
    };
    let mut points = Vec::with_capacity(244);
    for (k, &parts) in SIDE_PARTS.iter().enumerate() {
        subdivide(&mut points, corner(k), corner(k + 1), parts);
    }
    let boundary = points.len();
    let normals: Vec<[f64; 2]> = (0..8)
        .map(|k| {
            let (s, c) = (FRAC_PI_4 * f64::from(k)).sin_cos();
            [c, s]
        })
        .collect();
    let reach = FRAC_PI_8.cos() - CLEARANCE * SPACING;
    for j in -12i32..=12 {
        for i in -20i32..=20 {
            // The origin is the middle of a lattice edge, so the lattice has the two mirror lines of the side
            // parts.
            let x = SPACING * (f64::from(i) + 0.5 + 0.5 * f64::from(j));
            let y = SPACING * 0.75f64.sqrt() * f64::from(j);
            if normals.iter().all(|n| n[0] * x + n[1] * y < reach) {
                points.push([x, y]);
            }
        }
    }
    let unit = relaxed(points, boundary, ROUNDS)?;
    Ok(unit.map_positions(|p| p.map(|c| radius * c))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octagon_of_figure_15() {
        let s = octagon_244(0.5).unwrap();
        let t = s.topology();
        t.check_invariants();
        assert_eq!(
            (t.vertex_count(), t.face_count(), t.edge_count()),
            (244, 440, 683)
        );
        assert_eq!(
            (t.boundary_edge_count(), t.interior_vertex_count()),
            (46, 198)
        );
        assert!((s.area() - 8f64.sqrt() * 0.25).abs() < 1e-13);
        // Good triangles: normalised shape ratio 4 sqrt(3) A / sum l^2 (1 when equilateral).
        for f in t.face_ids() {
            let squares: f64 = t
                .face_edges(f)
                .iter()
                .map(|e| s.lengths()[e.index()].powi(2))
                .sum();
            let quality = 4.0 * 3f64.sqrt() * s.face_areas()[f.index()] / squares;
            assert!(quality > 0.75, "{f}: {quality}");
        }
        let (min, max) = s
            .lengths()
            .iter()
            .fold((f64::MAX, 0.0f64), |(a, b), &l| (a.min(l), b.max(l)));
        assert!(max / min < 2.1, "edges from {min} to {max}");
    }
}
