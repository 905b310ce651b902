//! Path data.

use isosheet_mesh::plane::{EllipticArc, PlaneCurve};
use std::f64::consts::{PI, TAU};
use svgtypes::{PathParser, PathSegment};

type Point = [f64; 2];

/// The curves of the sub-paths of path data, `most` at most.
///
/// # Errors
/// What is wrong. (A program that shows drawings leaves out the rest of the path: here it would be lost to
/// the sheet.)
pub(super) fn sub_paths(data: &str, most: usize) -> Result<Vec<Vec<PlaneCurve>>, String> {
    let mut pen = Drawn::default();
    for (count, segment) in PathParser::from(data).enumerate() {
        if count > 2 * most {
            return Err(format!(
                "`d` has more than {count} commands, and a file of this length may have no more"
            ));
        }
        let segment = segment.map_err(|e| format!("`d` is no path data: {e}"))?;
        pen.draw(segment);
    }
    pen.paths.retain(|path| !path.is_empty());
    Ok(pen.paths)
}

/// A path that is being drawn.
#[derive(Default)]
struct Drawn {
    paths: Vec<Vec<PlaneCurve>>,
    /// Where the sub-path began, and where the pen is.
    first: Point,
    at: Point,
    /// The last control point of the segment before, if it was a cubic or a quadratic curve.
    cubic: Option<Point>,
    quadratic: Option<Point>,
}

impl Drawn {
    fn draw(&mut self, segment: PathSegment) {
        let start = match segment.is_abs() {
            true => [0.0; 2],
            false => self.at,
        };
        let place = |x: f64, y: f64| [start[0] + x, start[1] + y];
        let (cubic, quadratic) = (self.cubic.take(), self.quadratic.take());
        let mirrored = |control: Option<Point>| match control {
            Some([x, y]) => [2.0 * self.at[0] - x, 2.0 * self.at[1] - y],
            None => self.at,
        };
        match segment {
            PathSegment::MoveTo { x, y, .. } => {
                self.at = place(x, y);
                self.first = self.at;
                self.paths.push(Vec::new());
            }
            PathSegment::LineTo { x, y, .. } => self.line(place(x, y)),
            PathSegment::HorizontalLineTo { x, .. } => self.line([start[0] + x, self.at[1]]),
            PathSegment::VerticalLineTo { y, .. } => self.line([self.at[0], start[1] + y]),
            PathSegment::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
                ..
            } => {
                self.cubic([place(x1, y1), place(x2, y2), place(x, y)]);
            }
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                self.cubic([mirrored(cubic), place(x2, y2), place(x, y)]);
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => {
                self.quadratic(place(x1, y1), place(x, y));
            }
            PathSegment::SmoothQuadratic { x, y, .. } => {
                self.quadratic(mirrored(quadratic), place(x, y));
            }
            PathSegment::EllipticalArc {
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
                ..
            } => {
                let to = place(x, y);
                let turn = x_axis_rotation.to_radians();
                let bulge = [large_arc, sweep];
                match elliptic_arc(self.at, to, [rx, ry], turn, bulge) {
                    Some(arc) => self.push(PlaneCurve::Arc(arc), to),
                    None => self.line(to),
                }
            }
            PathSegment::ClosePath { .. } => {
                self.line(self.first);
                // What follows without a move begins a new sub-path here.
                self.paths.push(Vec::new());
            }
        }
    }

    fn line(&mut self, to: Point) {
        self.push(PlaneCurve::Line([self.at, to]), to);
    }

    fn cubic(&mut self, [p, q, to]: [Point; 3]) {
        self.push(PlaneCurve::Cubic([self.at, p, q, to]), to);
        self.cubic = Some(q);
    }

    fn quadratic(&mut self, control: Point, to: Point) {
        let near = |end: Point| [0, 1].map(|k| (end[k] + 2.0 * control[k]) / 3.0);
        self.push(
            PlaneCurve::Cubic([self.at, near(self.at), near(to), to]),
            to,
        );
        self.quadratic = Some(control);
    }

    fn push(&mut self, curve: PlaneCurve, to: Point) {
        if curve != PlaneCurve::Line([to, to])
            && let Some(path) = self.paths.last_mut()
        {
            path.push(curve);
        }
        self.at = to;
    }
}

/// The arc from one point to another on an ellipse with these half-axes, which is turned by an angle; `bulge`
/// says whether it is the larger one, and whether its angles ascend. `None` where it is a straight line.
fn elliptic_arc(
    from: Point,
    to: Point,
    radii: [f64; 2],
    turn: f64,
    [large, ascending]: [bool; 2],
) -> Option<EllipticArc> {
    let [rx, ry] = radii.map(f64::abs);
    if rx == 0.0 || ry == 0.0 || from == to {
        return None;
    }
    let (sin, cos) = turn.sin_cos();
    let axes = [[cos, sin], [-sin, cos]];
    // In the frame of the axes, about the middle of the chord.
    let half = [0, 1].map(|k| 0.5 * (from[k] - to[k]));
    let [x, y] = axes.map(|a| a[0] * half[0] + a[1] * half[1]);
    // Half-axes that are too short for the chord grow as needed.
    let grow = ((x / rx).powi(2) + (y / ry).powi(2)).sqrt().max(1.0);
    let [rx, ry] = [grow * rx, grow * ry];
    let [u, v] = [x / rx, y / ry];
    let square = u * u + v * v;
    let sign = if large == ascending { -1.0 } else { 1.0 };
    let away = sign * ((1.0 - square).max(0.0) / square).sqrt();
    // The centre on the unit circle, where the ends are (u, v) and (-u, -v).
    let [p, q] = [away * v, -away * u];
    let begin = (v - q).atan2(u - p);
    let end = (-v - q).atan2(-u - p);
    let swept = match ascending {
        true => (end - begin).rem_euclid(TAU),
        false => -(begin - end).rem_euclid(TAU),
    };
    // Half a turn may be rounded to nothing on either side.
    let swept = if swept == 0.0 {
        if ascending { PI } else { -PI }
    } else {
        swept
    };
    let scaled = [axes[0].map(|c| rx * c), axes[1].map(|c| ry * c)];
    let centre = [0, 1].map(|k| 0.5 * (from[k] + to[k]) + p * scaled[0][k] + q * scaled[1][k]);
    Some(EllipticArc {
        centre,
        axes: scaled,
        angles: [begin, begin + swept],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(p: Point, q: Point) -> bool {
        (p[0] - q[0]).hypot(p[1] - q[1]) < 1e-12
    }

    /// Every choice of the flags gives an arc between the ends on the ellipse, and they are four different
    /// ones whose angles add up to whole turns in pairs.
    #[test]
    fn arcs_have_their_ends_and_flags() {
        let (from, to, radii, turn) = ([1.0, 2.0], [2.5, 2.2], [2.0, 1.0], 0.4);
        let mut swept = Vec::new();
        for bulge in [[false, false], [false, true], [true, false], [true, true]] {
            let arc = elliptic_arc(from, to, radii, turn, bulge).unwrap();
            let curve = PlaneCurve::Arc(arc);
            assert!(
                near(curve.point(0.0), from) && near(curve.point(1.0), to),
                "{bulge:?}"
            );
            let angle = arc.angles[1] - arc.angles[0];
            assert_eq!(angle > 0.0, bulge[1]);
            assert_eq!(angle.abs() > PI, bulge[0]);
            swept.push(angle.abs());
        }
        assert!((swept[0] + swept[2] - TAU).abs() < 1e-12);
        assert!((swept[1] + swept[3] - TAU).abs() < 1e-12);
        // Radii that are too small make half an ellipse.
        let arc = elliptic_arc([0.0, 0.0], [2.0, 0.0], [0.5, 0.5], 0.0, [false, true]).unwrap();
        let middle = PlaneCurve::Arc(arc).point(0.5);
        assert!(near(middle, [1.0, -1.0]), "{middle:?}");
    }

    #[test]
    fn relative_smooth_and_closed_paths() {
        let paths = sub_paths(
            "m1 1 h2 v3 z l1 0 M5 5 c0 1 1 2 2 2 s2 -1 2 -2 q1 1 2 0 t2 0",
            100,
        );
        let paths = paths.unwrap();
        assert_eq!(paths.len(), 3);
        assert_eq!(paths[0].len(), 3);
        assert_eq!(paths[0][2], PlaneCurve::Line([[3.0, 4.0], [1.0, 1.0]]));
        assert_eq!(paths[1], [PlaneCurve::Line([[1.0, 1.0], [2.0, 1.0]])]);
        let [
            PlaneCurve::Cubic(a),
            PlaneCurve::Cubic(b),
            ..,
            PlaneCurve::Cubic(d),
        ] = paths[2][..]
        else {
            panic!("{:?}", paths[2]);
        };
        assert_eq!((a[2], b[1]), ([6.0, 7.0], [8.0, 7.0]));
        assert_eq!((d[0], d[3]), ([11.0, 5.0], [13.0, 5.0]));
        // The control point of the second quadratic curve is mirrored: (10, 6) to (12, 4).
        assert!(near(d[1], [(11.0 + 24.0) / 3.0, (5.0 + 8.0) / 3.0]));
        assert_eq!(sub_paths("", 0), Ok(Vec::new()));
        for broken in ["M0 0 L1 0 L nonsense", "M0 0 L1", "M0 0 V nan", "L1 1"] {
            let message = sub_paths(broken, 100).unwrap_err();
            assert!(message.starts_with("`d` is no path data"), "{message}");
        }
    }
}
