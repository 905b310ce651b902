//! Vertices that cannot move because rods to fixed ones hold them.

use crate::SheetModel;
use crate::sheet_model::PINNED;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// Slack of a line, relative to its length, that counts as none: the tolerance of the lengths. (Twice the
/// slack is the square of the slope that is left.)
const NO_SLACK: f64 = 1e-12;
/// Sine of the angle between the directions from one fixed neighbour to two others from which the three are
/// not on a line: a length error moves the vertex by a thousand times as much at most.
const OFF_LINE: f64 = 1e-3;

/// Free vertices that cannot move, found by three rules that are applied until nothing changes. Vertices
/// found count as fixed for the others.
///
/// 1. A vertex with three fixed neighbours that are not on a line: its rods leave two places.
/// 2. A straight line of rods from a fixed vertex to another one: the edge of a banner that hangs by both
///    ends.
/// 3. A straight line of rods from a fixed vertex `u` to a vertex whose rods to fixed neighbours leave a
///    sphere or a circle, if no other point of that is as close to `u`: it could turn about its neighbours,
///    but the line is not long enough. (On a sphere this is rule 2.)
///
/// At such vertices the length constraints leave displacements to first order and no motion to second
/// order, which stalls every method; as pins they cost nothing. These are stresses of small frameworks that
/// block the infinitesimal flexes (Connelly and Whiteley, SIAM J. Discrete Math. 9, 1996); large flat
/// patches may be immobile as a whole without being found.
///
/// `x`: positions, `3V`, metres. Vertices of elastic sheets are not among them.
///
/// # Panics
/// If the length of `x` is not three times the number of vertices.
pub fn immobile_vertices(model: &SheetModel, x: &[f64]) -> Vec<VertexId> {
    assert_eq!(x.len(), model.coordinate_count(), "length of the positions");
    let mut search = Search::new(model, x);
    loop {
        let before = search.found.len();
        for v in model.topology().vertex_ids() {
            search.fix_between_neighbours(v);
        }
        for start in model.topology().vertex_ids() {
            if search.fixed[start.index()] {
                search.fix_along_lines(start);
            }
        }
        if search.found.len() == before {
            return search.found;
        }
    }
}

struct Search<'a> {
    model: &'a SheetModel,
    x: &'a [f64],
    fixed: Vec<bool>,
    /// With supports that these rules do not know, or edges that are no rods.
    other: Vec<bool>,
    found: Vec<VertexId>,
}

/// A straight line of rods from a fixed vertex.
struct TautLine {
    start: VertexId,
    /// Metres.
    length: f64,
    /// Its free vertices, the last one included.
    vertices: Vec<VertexId>,
}

impl<'a> Search<'a> {
    fn new(model: &'a SheetModel, x: &'a [f64]) -> Self {
        let mut fixed: Vec<bool> = model.free_index().iter().map(|i| *i == PINNED).collect();
        let mut other = vec![false; fixed.len()];
        for v in model.moving_pins() {
            (fixed[v], other[v]) = (false, true);
        }
        for c in model.constraints() {
            other[c.vertex().index()] = true;
        }
        let topology = model.topology();
        for (edge, ends) in topology.edge_ids().zip(topology.edges()) {
            if !model.is_rod(edge) {
                for v in ends {
                    (fixed[v.index()], other[v.index()]) = (false, true);
                }
            }
        }
        Self {
            model,
            x,
            fixed,
            other,
            found: Vec::new(),
        }
    }

    fn at(&self, v: VertexId) -> Vector3<f64> {
        Vector3::from_column_slice(&self.x[3 * v.index()..3 * v.index() + 3])
    }

    fn is_free(&self, v: VertexId) -> bool {
        !self.fixed[v.index()] && !self.other[v.index()]
    }

    fn fix(&mut self, v: VertexId) {
        if !self.fixed[v.index()] {
            self.fixed[v.index()] = true;
            self.found.push(v);
        }
    }

    fn fixed_neighbours(&self, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        let neighbours = self.model.topology().neighbours(v);
        neighbours.filter(|n| self.fixed[n.index()])
    }

    /// Rule 1.
    fn fix_between_neighbours(&mut self, v: VertexId) {
        if !self.is_free(v) {
            return;
        }
        let mut places = self.fixed_neighbours(v).map(|n| self.at(n));
        let (Some(first), Some(second)) = (places.next(), places.next()) else {
            return;
        };
        let axis = (second - first).normalize();
        let is_off = |p: Vector3<f64>| {
            let d = p - first;
            axis.cross(&d).norm() > OFF_LINE * d.norm()
        };
        if places.any(is_off) {
            drop(places);
            self.fix(v);
        }
    }

    /// Rules 2 and 3.
    fn fix_along_lines(&mut self, start: VertexId) {
        let topology = self.model.topology();
        let firsts: Vec<VertexId> = topology.neighbours(start).collect();
        for first in firsts {
            let mut line = TautLine {
                start,
                length: 0.0,
                vertices: Vec::new(),
            };
            let mut next = Some(first);
            while let Some(v) = next
                && line.vertices.len() < topology.vertex_count()
            {
                let from = line.vertices.last().copied().unwrap_or(start);
                line.length += (self.at(v) - self.at(from)).norm();
                if !self.other[v.index()] && self.fixed[v.index()] {
                    line.vertices.iter().for_each(|v| self.fix(*v));
                    break;
                }
                if !self.is_free(v) {
                    break;
                }
                line.vertices.push(v);
                if self.is_taut(&line) {
                    line.vertices.iter().for_each(|v| self.fix(*v));
                    break;
                }
                next = self.ahead(&line, v);
            }
        }
    }

    /// The neighbour of the last vertex of a line that continues it straight.
    fn ahead(&self, line: &TautLine, last: VertexId) -> Option<VertexId> {
        let origin = self.at(line.start);
        let is_straight = |next: &VertexId| {
            let longer = line.length + (self.at(*next) - self.at(last)).norm();
            (self.at(*next) - origin).norm() >= (1.0 - NO_SLACK) * longer
        };
        self.model.topology().neighbours(last).find(is_straight)
    }

    /// Whether the line is just long enough to reach the places that the fixed neighbours of its last vertex
    /// leave for that vertex (rule 3).
    fn is_taut(&self, line: &TautLine) -> bool {
        let Some(&last) = line.vertices.last() else {
            return false;
        };
        let before = line.vertices.iter().rev().nth(1).unwrap_or(&line.start);
        let mut others = self
            .fixed_neighbours(last)
            .filter(|n| n != before)
            .map(|n| self.at(n));
        let Some(centre) = others.next() else {
            return false;
        };
        let (u, w) = (self.at(line.start) - centre, self.at(last) - centre);
        let closest = match others.next() {
            // A sphere.
            None => (u.norm() - w.norm()).abs(),
            // A circle. (More neighbours are on its axis.)
            Some(second) => {
                let axis = (second - centre).normalize();
                let (along, radius) = split(&w, &axis);
                let (start_along, start_radius) = split(&u, &axis);
                if start_radius.dot(&radius) <= 0.0 {
                    return false;
                }
                (along - start_along).hypot(radius.norm() - start_radius.norm())
            }
        };
        let is_unique = u.norm() > NO_SLACK * line.length;
        is_unique && closest >= (1.0 - NO_SLACK) * line.length
    }
}

/// The part of a vector along a unit vector, and the rest.
fn split(v: &Vector3<f64>, axis: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let along = v.dot(axis);
    (along, v - along * axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, generate};

    fn fixed(pins: &[u32], change: impl Fn(&mut [f64])) -> Vec<u32> {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let pins: Vec<VertexId> = pins.iter().map(|v| VertexId(*v)).collect();
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped)
            .and_then(|m| m.with_pins(&pins))
            .unwrap();
        let mut x = sheet.positions().to_vec();
        change(&mut x);
        let mut found: Vec<u32> = immobile_vertices(&model, &x).iter().map(|v| v.0).collect();
        found.sort_unstable();
        found
    }

    #[test]
    fn lines_between_pins_are_fixed() {
        // Five by five vertices in rows.
        assert_eq!(fixed(&[0, 4], |_| ()), [1, 2, 3]);
        assert_eq!(fixed(&[0, 24], |_| ()), [6, 12, 18]);
        assert_eq!(fixed(&[0, 3], |_| ()), [1, 2]);
        // A knight's move is no line of rods.
        assert_eq!(fixed(&[0, 11], |_| ()), [0_u32; 0]);
        assert_eq!(fixed(&[0], |_| ()), [0_u32; 0]);
        // The border first, and everything inside between its vertices.
        assert_eq!(fixed(&[0, 4, 20, 24], |_| ()).len(), 21);
    }

    #[test]
    fn lines_with_slack_are_not() {
        let lift = |z: f64| move |x: &mut [f64]| x[3 * 2 + 2] = z;
        assert_eq!(fixed(&[0, 4], lift(1e-5)), [0_u32; 0]);
        assert_eq!(fixed(&[0, 4], lift(1e-8)), [1, 2, 3]);
    }

    /// A side of the square, and the next vertex of the side beside it: vertex 6 has three fixed neighbours,
    /// 8 could turn about the pinned side, but for the line 6-7-8, and 7 is on that line then.
    #[test]
    fn a_line_to_a_vertex_that_could_turn_is_fixed() {
        assert_eq!(fixed(&[0, 1, 2, 3, 4, 5], |_| ()), [6, 7, 8]);
        // The same when the pinned side is folded off the rest of the sheet.
        let turn = |x: &mut [f64]| {
            for p in x.chunks_mut(3) {
                (p[1], p[2]) = (0.6 * p[1], 0.8 * p[1]);
            }
        };
        assert_eq!(fixed(&[0, 1, 2, 3, 4, 5], turn), [6, 7, 8]);
    }

    #[test]
    fn a_fold_beside_fixed_vertices_sets_others_free() {
        // Beyond vertex 6 the sheet is lifted: the line 6-7-8 is no longer straight.
        let lift = |x: &mut [f64]| x[3 * 7 + 2] = 1e-3;
        assert_eq!(fixed(&[0, 1, 2, 3, 4, 5], lift), [6]);
    }

    #[test]
    fn other_supports_are_left_alone() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let moving = SheetModel::new(&sheet, 1.0, MassKind::Lumped)
            .and_then(|m| m.with_pins(&[VertexId(0)]))
            .and_then(|m| m.with_moving_pin(VertexId(4), |_| [1.0, 0.0, 0.0]))
            .unwrap();
        assert!(immobile_vertices(&moving, sheet.positions()).is_empty());
    }
}
