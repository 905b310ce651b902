//! Surfaces made by formula.

use super::{SurfaceError, TriangleSurface};
use std::f64::consts::PI;

/// Largest turn between two segments of a rounded corner, radians: the segments of a quarter turn are 16, and
/// their middles are `radius (1 - cos(pi / 64))`, 0.12 % of the radius, inside the arc.
const ARC_STEP: f64 = PI / 32.0;

impl TriangleSurface {
    /// An upright prism with its middle at the origin: a convex outline in the xy plane, counter-clockwise,
    /// and a height along z (metres).
    ///
    /// # Errors
    /// [`SurfaceError::Line`] for an outline that is not convex or not counter-clockwise,
    /// [`SurfaceError::Length`] for a height that is not positive.
    pub fn prism(outline: &[[f64; 2]], height: f64) -> Result<Self, SurfaceError> {
        check_length("height", height)?;
        check_convex(outline)?;
        let n = outline.len() as u32;
        let mut positions = Vec::with_capacity(6 * outline.len());
        for z in [0.5 * height, -0.5 * height] {
            positions.extend(outline.iter().flat_map(|p| [p[0], p[1], z]));
        }
        let mut faces = Vec::with_capacity(4 * outline.len());
        for k in 1..n - 1 {
            faces.extend([[0, k, k + 1], [n, n + k + 1, n + k]]);
        }
        for k in 0..n {
            let next = (k + 1) % n;
            faces.extend([[k, n + k, n + next], [k, n + next, next]]);
        }
        Self::new(&positions, &faces)
    }

    /// A square plate with a square opening about the z axis: sides of plate and opening along x and y, and
    /// the heights of its lower and upper face (metres).
    ///
    /// # Errors
    /// [`SurfaceError::Length`] for a length that is not positive, an opening that leaves nothing of the
    /// plate, or an upper face that is not above the lower one.
    pub fn frame(outer: f64, opening: f64, [bottom, top]: [f64; 2]) -> Result<Self, SurfaceError> {
        check_length("outer", outer)?;
        check_length("opening", opening)?;
        check_length("outer less opening", outer - opening)?;
        check_length("top less bottom", top - bottom)?;
        // Vertex 8 level + 4 ring + corner: below and above, outside and inside, counter-clockwise.
        let corners = [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]];
        let ring = |side: f64, z: f64| corners.map(|[x, y]| [side * x, side * y, z]);
        let rings = [bottom, top].map(|z| [outer, opening].map(|side| ring(side, z)));
        let positions = rings.as_flattened().as_flattened().as_flattened();
        let vertex = |level: u32, ring: u32, corner: u32| 8 * level + 4 * ring + corner % 4;
        let quad = |k: u32, [a, b]: [[u32; 2]; 2]| {
            let at = |[level, ring]: [u32; 2], corner: u32| vertex(level, ring, corner);
            let [p, q, r, s] = [at(a, k), at(a, k + 1), at(b, k + 1), at(b, k)];
            [[p, q, r], [p, r, s]]
        };
        // Level and ring of the two sides of each strip: above, below, outside, inside.
        let strips = [
            [[1, 0], [1, 1]],
            [[0, 1], [0, 0]],
            [[0, 0], [1, 0]],
            [[1, 1], [0, 1]],
        ];
        let faces: Vec<[u32; 3]> = (0..4)
            .flat_map(|k| strips.into_iter().flat_map(move |strip| quad(k, strip)))
            .collect();
        Self::new(positions, &faces)
    }

    /// A thin wall, with two sides: a line of points `[x, z]` (metres) swept along y over a width (metres)
    /// with its middle at y = 0.
    ///
    /// # Errors
    /// [`SurfaceError::Line`] for fewer than two points or two equal neighbours, [`SurfaceError::Length`] for
    /// a width that is not positive.
    pub fn wall(line: &[[f64; 2]], width: f64) -> Result<Self, SurfaceError> {
        check_length("width", width)?;
        check_line(line)?;
        let y = 0.5 * width;
        let strip = line.iter().flat_map(|[x, z]| [*x, -y, *z, *x, y, *z]);
        let positions: Vec<f64> = strip.collect();
        let faces: Vec<[u32; 3]> = (0..line.len() as u32 - 1)
            .flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]])
            .collect();
        Self::new(&positions, &faces)
    }
}

/// A line through points with its corners replaced by arcs of a radius (metres) that touch both sides, in
/// segments that turn by at most pi/32. With the radius 0 the line itself.
///
/// # Errors
/// [`SurfaceError::Line`] for fewer than two points, two equal neighbours, or a side too short for the arcs
/// at its ends; [`SurfaceError::Length`] for a radius that is negative or not finite.
pub fn rounded_line(points: &[[f64; 2]], radius: f64) -> Result<Vec<[f64; 2]>, SurfaceError> {
    check_line(points)?;
    if radius == 0.0 {
        return Ok(points.to_vec());
    }
    check_length("corner_radius", radius)?;
    let last = points.len() - 1;
    let mut line = vec![points[0]];
    // Part of the side before a corner that the arc at its beginning takes.
    let mut taken = 0.0;
    for k in 1..=last {
        let (u, length) = direction(points[k - 1], points[k]);
        let mut part = 0.0;
        if k < last {
            let (v, _) = direction(points[k], points[k + 1]);
            let turn = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
            part = radius * (0.5 * turn.abs()).tan();
            if turn != 0.0 {
                arc(&mut line, points[k], u, turn, radius, part);
            }
        }
        // Round-off may leave a side between two arcs less than nothing.
        if taken + part > (1.0 + 8.0 * f64::EPSILON) * length {
            let problem = "the side that begins here is too short for the arcs at its ends";
            let index = k - 1;
            return Err(SurfaceError::Line { index, problem });
        }
        taken = part;
    }
    line.push(points[last]);
    Ok(line)
}

/// The points of the arc at a corner that is reached in the direction `u`, that turns by `turn` (positive to
/// the left) and that begins `before` the corner.
fn arc(
    line: &mut Vec<[f64; 2]>,
    corner: [f64; 2],
    u: [f64; 2],
    turn: f64,
    radius: f64,
    before: f64,
) {
    let signed = radius.copysign(turn);
    let begin = [corner[0] - before * u[0], corner[1] - before * u[1]];
    let centre = [begin[0] - signed * u[1], begin[1] + signed * u[0]];
    let segments = (turn.abs() / ARC_STEP - 1e-9).ceil().max(1.0);
    for k in 0..=segments as u32 {
        let (sin, cos) = (turn * f64::from(k) / segments).sin_cos();
        line.push([
            centre[0] + signed * (u[1] * cos + u[0] * sin),
            centre[1] + signed * (u[1] * sin - u[0] * cos),
        ]);
    }
}

/// Unit vector and distance from one point to another.
fn direction(a: [f64; 2], b: [f64; 2]) -> ([f64; 2], f64) {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    let length = x.hypot(y);
    ([x / length, y / length], length)
}

fn check_length(name: &'static str, value: f64) -> Result<(), SurfaceError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(SurfaceError::Length { name, value })
    }
}

fn check_line(points: &[[f64; 2]]) -> Result<(), SurfaceError> {
    let fault = |index, problem| Err(SurfaceError::Line { index, problem });
    if let Some(index) = points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        return fault(index, "a coordinate is not finite");
    }
    if points.len() < 2 {
        return fault(points.len(), "a line has at least two points");
    }
    match points.windows(2).position(|w| w[0] == w[1]) {
        Some(index) => fault(index, "the next point is the same"),
        None => Ok(()),
    }
}

/// Whether an outline turns left at every corner, once round in all.
fn check_convex(outline: &[[f64; 2]]) -> Result<(), SurfaceError> {
    check_line(outline)?;
    let (n, mut turned) = (outline.len(), 0.0);
    for index in 0..n {
        let [a, b, c] = [0, 1, 2].map(|k| outline[(index + k) % n]);
        let ((u, _), (v, _)) = (direction(a, b), direction(b, c));
        let turn = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
        // Not a number is no turn either.
        if !(turn > 0.0 && turn < PI) {
            let problem = "the outline does not turn left at the next point; give a convex outline, \
                           counter-clockwise";
            return Err(SurfaceError::Line { index, problem });
        }
        turned += turn;
    }
    if turned > 3.0 * PI {
        let problem = "the outline runs round more than once";
        return Err(SurfaceError::Line { index: 0, problem });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, TAU};

    fn volume(surface: &TriangleSurface) -> f64 {
        assert!(surface.is_closed());
        let at = |v: u32| surface.positions()[v as usize];
        let faces = surface.mesh().faces().iter();
        let part = |f: &[u32; 3]| at(f[0]).cross(&at(f[1])).dot(&at(f[2])) / 6.0;
        faces.map(part).sum()
    }

    fn area(surface: &TriangleSurface) -> f64 {
        let at = |v: u32| surface.positions()[v as usize];
        let faces = surface.mesh().faces().iter();
        faces
            .map(|f| 0.5 * (at(f[1]) - at(f[0])).cross(&(at(f[2]) - at(f[0]))).norm())
            .sum()
    }

    #[test]
    fn a_prism_has_its_volume_and_points_outwards() {
        let hexagon: Vec<[f64; 2]> = (0..6)
            .map(|k| (FRAC_PI_3 * f64::from(k)).sin_cos())
            .map(|(s, c)| [c, s])
            .collect();
        let prism = TriangleSurface::prism(&hexagon, 1.0).unwrap();
        assert!((volume(&prism) - 1.5 * 3_f64.sqrt()).abs() < 1e-12);
        assert!(prism.positions().iter().all(|p| p.z.abs() == 0.5));
        let reversed: Vec<_> = hexagon.iter().rev().copied().collect();
        let dented = [[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]];
        for outline in [&reversed[..], &dented, &hexagon[..2]] {
            let refused = TriangleSurface::prism(outline, 1.0);
            assert!(
                matches!(refused, Err(SurfaceError::Line { .. })),
                "{refused:?}"
            );
        }
        assert!(TriangleSurface::prism(&hexagon, 0.0).is_err());
    }

    #[test]
    fn a_frame_has_its_volume_and_lies_between_its_faces() {
        let frame = TriangleSurface::frame(0.6, 0.28, [-0.5, -0.2]).unwrap();
        let exact = 0.3 * (0.6_f64.powi(2) - 0.28_f64.powi(2));
        assert!((volume(&frame) - exact).abs() < 1e-15);
        assert!(frame.positions().iter().all(|p| p.z == -0.2 || p.z == -0.5));
        let refused = [
            (0.2, 0.2, [0.0, 0.1]),
            (0.2, -0.1, [0.0, 0.1]),
            (0.2, 0.1, [0.0, 0.0]),
            (0.2, 0.1, [0.0, f64::NAN]),
        ];
        for (outer, opening, heights) in refused {
            assert!(TriangleSurface::frame(outer, opening, heights).is_err());
        }
    }

    #[test]
    fn a_wall_has_the_area_of_its_line_times_its_width() {
        let line = [[0.0, 0.0], [0.3, 0.4], [0.3, 1.4]];
        let wall = TriangleSurface::wall(&line, 0.2).unwrap();
        assert!(!wall.is_closed());
        assert!((area(&wall) - 0.2 * 1.5).abs() < 1e-15);
        assert!(TriangleSurface::wall(&line[..1], 0.2).is_err());
    }

    /// A quarter turn to the right and one by 60 degrees to the left: points on the circles, tangents at the
    /// ends, and the length of the path of chords.
    #[test]
    fn rounded_corners_are_arcs_that_touch_both_sides() {
        let (sin, cos) = FRAC_PI_3.sin_cos();
        let radius = 0.1;
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, -1.0], [1.0 + sin, -1.0 - cos]];
        let line = rounded_line(&points, radius).unwrap();
        // 16 segments for 90 degrees, 11 for 60, the points at both ends.
        assert_eq!(line.len(), 2 + 17 + 12);
        for p in &line[1..18] {
            assert!(((p[0] - 0.9).hypot(p[1] + 0.1) - radius).abs() < 1e-15);
        }
        let length: f64 = line.windows(2).map(|w| direction(w[0], w[1]).1).sum();
        let cut = [FRAC_PI_2, FRAC_PI_3].map(|turn| 2.0 * radius * (0.5 * turn).tan());
        let chords = [(FRAC_PI_2, 16.0), (FRAC_PI_3, 11.0)]
            .map(|(turn, n): (f64, f64)| n * 2.0 * radius * (0.5 * turn / n).sin());
        let exact = 3.0 - cut.iter().sum::<f64>() + chords.iter().sum::<f64>();
        assert!((length - exact).abs() < 1e-14, "{length} {exact}");
        let turns = line.windows(3).map(|w| {
            let ((u, _), (v, _)) = (direction(w[0], w[1]), direction(w[1], w[2]));
            (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1])
        });
        assert!(turns.map(f64::abs).fold(0.0, f64::max) <= ARC_STEP + 1e-12);
        assert_eq!(rounded_line(&points, 0.0).unwrap(), points);
    }

    #[test]
    fn sides_too_short_for_their_arcs_are_refused() {
        let step = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [2.0, 0.3]];
        assert!(rounded_line(&step, 0.15).is_ok());
        let refused = rounded_line(&step, 0.16);
        assert!(
            matches!(refused, Err(SurfaceError::Line { index: 1, .. })),
            "{refused:?}"
        );
        for radius in [-0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                rounded_line(&step, radius),
                Err(SurfaceError::Length { .. })
            ));
        }
        let circle: Vec<[f64; 2]> = (0..12)
            .map(|k| (TAU * 2.0 * f64::from(k) / 12.0).sin_cos())
            .map(|(s, c)| [c, s])
            .collect();
        assert!(TriangleSurface::prism(&circle, 1.0).is_err());
    }
}
