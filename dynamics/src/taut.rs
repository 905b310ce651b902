//! Vertices that are fixed because straight lines of rods run through them from pin to pin.

use crate::SheetModel;
use crate::model::PINNED;
use isosheet_mesh::VertexId;
use nalgebra::Vector3;

/// Slack of a line, relative to its length, that counts as none: the tolerance of the lengths. (Twice the
/// slack is the square of the slope that is left.)
const NO_SLACK: f64 = 1e-12;

/// Free vertices that cannot move because they are on a straight line of rods between two pins at rest, or
/// between such vertices: the edge of a banner that hangs by both ends. There the length constraints are
/// independent of each other and yet leave no motion to second order, which stalls every method; as pins they
/// cost nothing.
///
/// `x`: positions, `3V`, metres.
pub(crate) fn vertices_on_taut_lines(model: &SheetModel, x: &[f64]) -> Vec<VertexId> {
    let topology = model.topology();
    let mut fixed: Vec<bool> = model.free_index().iter().map(|i| *i == PINNED).collect();
    let mut other = vec![false; fixed.len()];
    for v in model.moving_pins() {
        (fixed[v], other[v]) = (false, true);
    }
    for c in model.constraints() {
        other[c.vertex().index()] = true;
    }
    let at = |v: VertexId| Vector3::from_column_slice(&x[3 * v.index()..3 * v.index() + 3]);
    // A line of more rods than this has been round the sheet.
    let longest = topology.vertex_count();
    let mut found = Vec::new();
    let mut from: Vec<VertexId> = topology.vertex_ids().filter(|v| fixed[v.index()]).collect();
    while let Some(start) = from.pop() {
        let origin = at(start);
        let starts = topology.neighbours(start).filter(|v| !other[v.index()]);
        for first in starts {
            let (mut line, mut last, mut length) = (Vec::new(), first, (at(first) - origin).norm());
            while !fixed[last.index()] && line.len() < longest {
                line.push(last);
                let ahead = topology.neighbours(last).find_map(|next| {
                    let longer = length + (at(next) - at(last)).norm();
                    let straight = (at(next) - origin).norm() >= (1.0 - NO_SLACK) * longer;
                    straight.then_some((next, longer))
                });
                match ahead {
                    Some((next, longer)) if !other[next.index()] => (last, length) = (next, longer),
                    _ => {
                        line.clear();
                        break;
                    }
                }
            }
            // (An empty line: a rod between two pins.)
            if fixed[last.index()] {
                for v in line {
                    fixed[v.index()] = true;
                    found.push(v);
                    from.push(v);
                }
            }
        }
    }
    found
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
        let mut found: Vec<u32> = vertices_on_taut_lines(&model, &x)
            .iter()
            .map(|v| v.0)
            .collect();
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

    #[test]
    fn other_supports_are_left_alone() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let moving = SheetModel::new(&sheet, 1.0, MassKind::Lumped)
            .and_then(|m| m.with_pins(&[VertexId(0)]))
            .and_then(|m| m.with_moving_pin(VertexId(4), |_| [1.0, 0.0, 0.0]))
            .unwrap();
        assert!(vertices_on_taut_lines(&moving, sheet.positions()).is_empty());
    }
}
