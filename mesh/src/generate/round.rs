//! Sheets with a centre: disks, fans, annuli.

use std::f64::consts::TAU;

use super::error::{GenerateError, check_count, check_faces, check_order, check_size};
use crate::Sheet;

/// A flat disk about the origin: the triangulation of a hexagon of `rings` rings, with each ring on a circle.
///
/// V = 1 + 3 rings (rings + 1), F = 6 rings^2; 6 rings vertices lie on the circle of radius `radius`
/// (metres).
///
/// # Errors
/// [`GenerateError`] for no ring or a radius that is not positive.
pub fn disk(rings: usize, radius: f64) -> Result<Sheet, GenerateError> {
    check_size("radius", radius)?;
    rings_about_centre(6, rings, |r, side, k| {
        let (s, c) = (TAU * (side as f64 + k as f64 / r as f64) / 6.0).sin_cos();
        let scale = radius * r as f64 / rings as f64;
        [scale * c, scale * s]
    })
}

/// Triangles in rings about vertex 0, the origin. Vertex k of `side` on ring r is at `place(r, side, k)`, 0
/// <= k < r.
pub(super) fn rings_about_centre(
    sides: usize,
    rings: usize,
    place: impl Fn(usize, usize, usize) -> [f64; 2],
) -> Result<Sheet, GenerateError> {
    check_count("rings", rings, 1)?;
    check_faces(sides as u128 * (rings as u128).pow(2))?;
    let mut positions = vec![0.0; 3];
    for r in 1..=rings {
        for side in 0..sides {
            for k in 0..r {
                let [x, y] = place(r, side, k);
                positions.extend([x, y, 0.0]);
            }
        }
    }
    // Ring r starts after the centre and the smaller rings.
    let index = |r: usize, side: usize, k: usize| -> u32 {
        if r == 0 {
            return 0;
        }
        (1 + sides * r * (r - 1) / 2 + (side * r + k) % (sides * r)) as u32
    };
    let mut faces = Vec::with_capacity(sides * rings * rings);
    for r in 1..=rings {
        for side in 0..sides {
            for k in 0..r {
                let (outer, next, inner) = (
                    index(r, side, k),
                    index(r, side, k + 1),
                    index(r - 1, side, k),
                );
                faces.push([outer, next, inner]);
                if k + 1 < r {
                    faces.push([next, index(r - 1, side, k + 1), inner]);
                }
            }
        }
    }
    Ok(Sheet::new(positions, &faces)?)
}

/// A flat fan: `triangles` equal isosceles triangles with legs `radius` (metres) about a common apex at the
/// origin, together `opening` radians wide, starting on the x axis.
///
/// The apex is vertex 0 and lies on the boundary; use [`polygon_rings`](super::polygon_rings) with one ring
/// for a closed wheel.
///
/// # Errors
/// [`GenerateError`] for no triangle, a size that is not positive, an opening of 2 pi or more (the ends would
/// meet), or a triangle of pi or more.
pub fn fan(triangles: usize, radius: f64, opening: f64) -> Result<Sheet, GenerateError> {
    check_count("triangles", triangles, 1)?;
    check_size("radius", radius)?;
    check_size("opening", opening)?;
    check_faces(triangles as u128)?;
    let limit = TAU.min(std::f64::consts::PI * triangles as f64);
    let largest = "the largest angle that this many triangles can fan out";
    check_order(("opening", opening), (largest, limit))?;
    let mut positions = vec![0.0; 3];
    for k in 0..=triangles {
        let (s, c) = (opening * k as f64 / triangles as f64).sin_cos();
        positions.extend([radius * c, radius * s, 0.0]);
    }
    let faces: Vec<[u32; 3]> = (1..=triangles as u32).map(|k| [0, k, k + 1]).collect();
    Ok(Sheet::new(positions, &faces)?)
}

/// A flat ring about the origin between the radii `inner` and `outer` (metres).
///
/// `rings` + 1 circles of `segments` vertices each; every second circle is turned by half a segment, so that
/// the 2 segments rings triangles are isosceles. chi = 0, two boundary loops.
///
/// # Errors
/// [`GenerateError`] for fewer than three segments, no ring, or radii that are not positive and ascending.
pub fn annulus(
    segments: usize,
    rings: usize,
    inner: f64,
    outer: f64,
) -> Result<Sheet, GenerateError> {
    check_count("segments", segments, 3)?;
    check_count("rings", rings, 1)?;
    check_size("inner", inner)?;
    check_size("outer", outer)?;
    check_faces(2 * segments as u128 * rings as u128)?;
    check_order(("inner", inner), ("outer", outer))?;
    let mut positions = Vec::with_capacity(3 * segments * (rings + 1));
    for r in 0..=rings {
        let radius = inner + (outer - inner) * r as f64 / rings as f64;
        for k in 0..segments {
            let (s, c) = (TAU * (k as f64 + 0.5 * (r % 2) as f64) / segments as f64).sin_cos();
            positions.extend([radius * c, radius * s, 0.0]);
        }
    }
    let index = |r: usize, k: usize| (r * segments + k % segments) as u32;
    let mut faces = Vec::with_capacity(2 * segments * rings);
    for r in 0..rings {
        for k in 0..segments {
            let (a, b) = (index(r, k), index(r, k + 1));
            let (c, d) = (index(r + 1, k), index(r + 1, k + 1));
            if r % 2 == 0 {
                // Outer vertex k lies half a segment ahead of inner vertex k.
                faces.extend([[a, c, b], [b, c, d]]);
            } else {
                faces.extend([[a, c, d], [a, d, b]]);
            }
        }
    }
    Ok(Sheet::new(positions, &faces)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VertexId;
    use crate::generate::{polygon_rings, regular_outline};

    /// Every face turned counter-clockwise, and the areas add up to `area`.
    fn check_flat(s: &Sheet, area: f64) {
        s.topology().check_invariants();
        let mut total = 0.0;
        for f in s.topology().faces() {
            let [a, b, c] = f.map(|v| s.position(v));
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(twice > 0.0);
            total += 0.5 * twice;
        }
        assert!((total - area).abs() < 1e-12 * area);
        assert!((s.area() - area).abs() < 1e-12 * area);
    }

    #[test]
    fn polygons_and_disks() {
        for (sides, rings) in [(3, 1), (3, 4), (4, 2), (5, 3), (6, 4), (8, 5)] {
            let outline = regular_outline(sides, 2.0).unwrap();
            let s = polygon_rings(&outline, rings).unwrap();
            check_flat(&s, 2.0 * sides as f64 * (TAU / sides as f64).sin());
            let t = s.topology();
            assert_eq!(t.vertex_count(), 1 + sides * rings * (rings + 1) / 2);
            assert_eq!(t.face_count(), sides * rings * rings);
            assert_eq!(t.boundary_edge_count(), sides * rings);
            assert_eq!(t.degree(VertexId(0)), sides);
        }
        let s = disk(5, 1.5).unwrap();
        check_flat(&s, 0.5 * 1.5 * 1.5 * 30.0 * (TAU / 30.0).sin());
        assert_eq!(
            (s.topology().vertex_count(), s.topology().face_count()),
            (91, 150)
        );
    }

    #[test]
    fn fans_and_annuli() {
        let s = fan(5, 2.0, 4.0).unwrap();
        check_flat(&s, 5.0 * 2.0 * (0.8f64).sin());
        assert!(s.topology().is_boundary_vertex(VertexId(0)));
        for (segments, rings) in [(3, 1), (5, 2), (12, 3)] {
            let s = annulus(segments, rings, 0.75, 1.0).unwrap();
            let t = s.topology();
            assert_eq!((t.euler_characteristic(), t.boundary_loops().len()), (0, 2));
            assert_eq!(t.face_count(), 2 * segments * rings);
            if segments == 12 {
                let polygon = |r: f64| 6.0 * r * r * (TAU / 12.0).sin();
                check_flat(&s, polygon(1.0) - polygon(0.75));
            }
        }
    }

    #[test]
    fn misuse_is_refused() {
        assert!(matches!(
            disk(0, 1.0),
            Err(GenerateError::Count { name: "rings", .. })
        ));
        assert!(matches!(
            disk(1, f64::INFINITY),
            Err(GenerateError::Size { .. })
        ));
        assert!(matches!(
            annulus(8, 1, 1.0, 1.0),
            Err(GenerateError::Order { .. })
        ));
        assert!(matches!(fan(2, 1.0, TAU), Err(GenerateError::Order { .. })));
        assert!(matches!(fan(1, 1.0, 3.5), Err(GenerateError::Order { .. })));
    }
}
