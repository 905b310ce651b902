//! Entities as curves.

use super::groups::Record;
use super::spline;
use isosheet_files::DataError;
use isosheet_mesh::plane::{EllipticArc, PlaneCurve};
use std::f64::consts::TAU;

/// An entity with its vertices, if these are records of their own.
pub(super) struct Entity<'a, 'b> {
    pub(super) record: &'b Record<'a>,
    pub(super) vertices: &'b [&'b Record<'a>],
}

const EXPLODE: &str = "explode it to lines and arcs before the export";

impl Entity<'_, '_> {
    /// Its curves in units of the file; `None` for an entity that is no line.
    pub(super) fn curves(&self) -> Result<Option<Vec<PlaneCurve>>, DataError> {
        let r = self.record;
        let curves = match r.kind {
            "LINE" => vec![PlaneCurve::Line([r.point(10)?, r.point(11)?])],
            "CIRCLE" => vec![self.seen(circle(r, [0.0, TAU])?)?],
            "ARC" => {
                let [from, to] = [r.needed(50)?, r.needed(51)?].map(f64::to_radians);
                vec![self.seen(circle(r, [from, from + turn(from, to)])?)?]
            }
            "ELLIPSE" => vec![self.ellipse()?],
            "LWPOLYLINE" => self.all_seen(polyline(&light_vertices(r)?, r.flags(70)? & 1 == 1))?,
            "POLYLINE" => {
                let flags = r.flags(70)?;
                if flags & (16 | 64) != 0 {
                    return Ok(None);
                }
                self.all_seen(polyline(&self.heavy_vertices()?, flags & 1 == 1))?
            }
            "SPLINE" => self.spline()?,
            _ => return Ok(None),
        };
        Ok(Some(curves))
    }

    /// A curve in the coordinates of the entity as it is seen from above: from below it is mirrored.
    fn seen(&self, curve: PlaneCurve) -> Result<PlaneCurve, DataError> {
        let [x, y, z] = [
            self.record.number(210)?.unwrap_or(0.0),
            self.record.number(220)?.unwrap_or(0.0),
            self.record.number(230)?.unwrap_or(1.0),
        ];
        if x.abs() + y.abs() > 1e-6 {
            return Err(self.refused("does not lie in the plane of the drawing"));
        }
        Ok(match z > 0.0 {
            true => curve,
            false => curve.transformed([[-1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]),
        })
    }

    fn all_seen(&self, curves: Vec<PlaneCurve>) -> Result<Vec<PlaneCurve>, DataError> {
        curves.into_iter().map(|c| self.seen(c)).collect()
    }

    fn refused(&self, what: &str) -> DataError {
        let Record { kind, line, .. } = self.record;
        DataError::new(format!("line {line}: {kind} {what}"), EXPLODE).at(*line)
    }

    fn ellipse(&self) -> Result<PlaneCurve, DataError> {
        let r = self.record;
        let [x, y] = r.point(11)?;
        let ratio = r.needed(40)?;
        // The other half-axis is a quarter of a turn further as seen from where its normal points to.
        let side = r.number(230)?.unwrap_or(1.0).signum() * ratio;
        let from = r.number(41)?.unwrap_or(0.0);
        let to = r.number(42)?.unwrap_or(TAU);
        Ok(PlaneCurve::Arc(EllipticArc {
            centre: r.point(10)?,
            axes: [[x, y], [-side * y, side * x]],
            angles: [from, from + turn(from, to)],
        }))
    }

    fn heavy_vertices(&self) -> Result<Vec<Vertex>, DataError> {
        let mut vertices = Vec::new();
        for vertex in self.vertices {
            // Control points of a spline are not on the line.
            if vertex.flags(70)? & 16 == 0 {
                vertices.push((vertex.point(10)?, vertex.number(42)?.unwrap_or(0.0)));
            }
        }
        Ok(vertices)
    }

    fn spline(&self) -> Result<Vec<PlaneCurve>, DataError> {
        let r = self.record;
        let weights = r.numbers(41)?;
        if weights.windows(2).any(|w| w[0] != w[1]) {
            return Err(self.refused("has weights"));
        }
        let (x, y) = (r.numbers(10)?, r.numbers(20)?);
        let points: Vec<[f64; 2]> = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
        let degree = usize::try_from(r.flags(71)?).unwrap_or(0);
        let curves = spline::curves(degree, &r.numbers(40)?, &points);
        curves.ok_or_else(|| {
            self.refused("has no degree from 1 to 3 with the control points and knots for it")
        })
    }
}

/// A corner of a polyline, and the bulge of the side that begins there: the tangent of a quarter of its
/// angle.
type Vertex = ([f64; 2], f64);

fn circle(r: &Record<'_>, angles: [f64; 2]) -> Result<PlaneCurve, DataError> {
    let (centre, radius) = (r.point(10)?, r.needed(40)?);
    Ok(PlaneCurve::Arc(EllipticArc::circular(
        centre, radius, angles,
    )))
}

/// How far it is from one angle counter-clockwise to another, a whole turn if they are the same.
fn turn(from: f64, to: f64) -> f64 {
    match (to - from).rem_euclid(TAU) {
        0.0 => TAU,
        turn => turn,
    }
}

fn light_vertices(r: &Record<'_>) -> Result<Vec<Vertex>, DataError> {
    let mut vertices: Vec<Vertex> = Vec::new();
    for &(code, text) in &r.groups {
        match (code, vertices.last_mut()) {
            (10, _) => vertices.push(([r.parse(10, text)?, 0.0], 0.0)),
            (20, Some(vertex)) => vertex.0[1] = r.parse(20, text)?,
            (42, Some(vertex)) => vertex.1 = r.parse(42, text)?,
            _ => {}
        }
    }
    Ok(vertices)
}

fn polyline(vertices: &[Vertex], closed: bool) -> Vec<PlaneCurve> {
    let n = vertices.len();
    let sides = if closed { n } else { n.saturating_sub(1) };
    let mut curves = Vec::new();
    for k in 0..sides {
        let ((p, bulge), (q, _)) = (vertices[k], vertices[(k + 1) % n]);
        if p == q {
            continue;
        }
        if bulge == 0.0 {
            curves.push(PlaneCurve::Line([p, q]));
            continue;
        }
        let away = (1.0 - bulge * bulge) / (4.0 * bulge);
        let centre = [
            0.5 * (p[0] + q[0]) - away * (q[1] - p[1]),
            0.5 * (p[1] + q[1]) + away * (q[0] - p[0]),
        ];
        let radius = (p[0] - centre[0]).hypot(p[1] - centre[1]);
        let from = (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let angles = [from, from + 4.0 * bulge.atan()];
        curves.push(PlaneCurve::Arc(EllipticArc::circular(
            centre, radius, angles,
        )));
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arcs of bulges begin and end at their corners, and are as high as the bulge says: half of the chord
    /// times it.
    #[test]
    fn bulges_are_arcs() {
        for bulge in [0.2, 1.0, -0.5, 2.0] {
            let [p, q] = [[1.0, 2.0], [4.0, 3.0]];
            let curves = polyline(&[(p, bulge), (q, 0.0)], false);
            let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12;
            assert!(
                near(curves[0].point(0.0), p) && near(curves[0].point(1.0), q),
                "{bulge}"
            );
            let height = 0.5 * bulge;
            // A positive bulge is on the right of the way.
            let top = [2.5 + height * 1.0, 2.5 - height * 3.0];
            assert!(near(curves[0].point(0.5), top), "{bulge}");
        }
    }
}
