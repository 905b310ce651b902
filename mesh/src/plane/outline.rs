//! Which lines of a drawing bound the sheet.

use super::error::{Gap, PlaneError};
use super::graph::PlaneGraph;
use super::near;
use super::net::{Net, Segment};
use super::vec2::{Point, cross, sub};
use spade::Triangulation;
use std::collections::BTreeSet;

/// What a line does to the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The sheet ends here, or is cut.
    Cut,
    /// The sheet has edges along it.
    Crease,
}

/// What bounds the sheet.
pub(super) struct Outline {
    /// What each piece does.
    pub(super) roles: Vec<Role>,
    /// Which pieces bound the sheet or lie on it.
    pub(super) keep: Vec<bool>,
    /// The pieces of creases that were made cuts.
    pub(super) closing: Vec<usize>,
    /// The area of the sheet, square metres.
    pub(super) area: f64,
}

impl Outline {
    /// The outline of a drawing.
    ///
    /// # Errors
    /// [`PlaneError`] if it is open or bounds no area.
    pub(super) fn new(graph: &PlaneGraph, roles: &[Role]) -> Result<Self, PlaneError> {
        let mut net = Net::new(graph, &vec![true; roles.len()], f64::INFINITY)?;
        let (mut roles, mut closing) = (roles.to_vec(), Vec::new());
        let (mut depths, mut keep, gaps) = bounded(graph, &net, &roles);
        if !gaps.is_empty() {
            closing = beside_outside(&net, &roles);
            for &piece in &closing {
                roles[piece] = Role::Cut;
            }
            let open;
            (depths, keep, open) = bounded(graph, &net, &roles);
            if !open.is_empty() {
                return Err(PlaneError::Open { gaps });
            }
        }
        let inside: Vec<bool> = depths.iter().map(|d| d % 2 == 1).collect();
        net.mark_sides(&inside);
        let twice_area = |f: [Point; 3]| cross(sub(f[1], f[0]), sub(f[2], f[0]));
        let faces = net
            .triangles
            .inner_faces()
            .filter(|f| inside[f.fix().index()]);
        let corners = faces.map(|f| f.vertices().map(|v| net.point(v.index() as u32)));
        let area: f64 = corners.map(|f| 0.5 * twice_area(f)).sum();
        if area <= 0.0 {
            return Err(PlaneError::NoOutline);
        }
        Ok(Self {
            roles,
            keep,
            closing,
            area,
        })
    }
}

/// How many cuts lie between each face and the outside, which pieces bound the sheet or lie on it, and the
/// open ends of its outline.
fn bounded(graph: &PlaneGraph, net: &Net, roles: &[Role]) -> (Vec<u32>, Vec<bool>, Vec<Gap>) {
    let depths = net.depths(|s| roles[s.piece] == Role::Cut);
    let mut keep = vec![false; roles.len()];
    let mut stray = vec![false; roles.len()];
    for segment in net.segments.values() {
        let [left, right] = net.faces_at(segment).map(|f| depths[f]);
        keep[segment.piece] |= left % 2 == 1 || right % 2 == 1;
        stray[segment.piece] |= roles[segment.piece] == Role::Cut && left == 0 && right == 0;
    }
    let gaps = open_ends(graph, roles, &stray);
    (depths, keep, gaps)
}

/// The pieces of creases that have the outside of all lines on one side alone.
fn beside_outside(net: &Net, roles: &[Role]) -> Vec<usize> {
    let depths = net.depths(|_| true);
    let is_beside = |segment: &&Segment| {
        let [left, right] = net.faces_at(segment).map(|f| depths[f] == 0);
        left != right && roles[segment.piece] == Role::Crease
    };
    let pieces = net.segments.values().filter(is_beside).map(|s| s.piece);
    pieces.collect::<BTreeSet<usize>>().into_iter().collect()
}

/// The ends of cut lines outside of the sheet where no other cut line goes on.
fn open_ends(graph: &PlaneGraph, roles: &[Role], stray: &[bool]) -> Vec<Gap> {
    let mut meeting = vec![0; graph.nodes.len()];
    for (piece, role) in graph.pieces.iter().zip(roles) {
        if *role == Role::Cut {
            for node in piece.nodes {
                meeting[node] += 1;
            }
        }
    }
    let pieces = graph.pieces.iter().zip(stray).filter(|(_, stray)| **stray);
    let nodes = pieces
        .flat_map(|(p, _)| p.nodes)
        .filter(|n| meeting[*n] == 1);
    let ends: Vec<Point> = nodes.map(|n| graph.nodes[n]).collect();
    let widths = near::gaps(&ends).into_iter();
    let gaps = ends.iter().zip(widths);
    let mut gaps: Vec<Gap> = gaps.map(|(at, width)| Gap { at: *at, width }).collect();
    gaps.sort_by(|a, b| a.width.total_cmp(&b.width));
    gaps
}

#[cfg(test)]
mod tests {
    use super::super::curve::PlaneCurve;
    use super::*;

    fn path(corners: &[Point]) -> Vec<PlaneCurve> {
        let sides = corners.windows(2);
        sides.map(|p| PlaneCurve::Line([p[0], p[1]])).collect()
    }

    /// A tab of 80 by 20 on the crease at the end of a panel of 100 by 50: the crease is the outline beside
    /// the tab.
    #[test]
    fn creases_close_an_outline() {
        let mut curves = path(&[[0.0, 0.5], [0.0, 0.0], [1.0, 0.0], [1.0, 0.5]]);
        curves.extend(path(&[[0.1, 0.5], [0.1, 0.7], [0.9, 0.7], [0.9, 0.5]]));
        curves.push(PlaneCurve::Line([[0.0, 0.5], [1.0, 0.5]]));
        let outline = |curves: &[PlaneCurve]| {
            let graph = PlaneGraph::new(curves, 1e-6).unwrap();
            let pieces = graph.pieces.iter();
            let role = |crease| if crease { Role::Crease } else { Role::Cut };
            let roles: Vec<Role> = pieces.map(|p| role(p.sources == [6])).collect();
            let outline = Outline::new(&graph, &roles);
            (graph, outline)
        };
        let (graph, closed) = outline(&curves);
        let closed = closed.unwrap();
        assert!((closed.area - 0.66).abs() < 1e-12, "{}", closed.area);
        assert_eq!(closed.closing.len(), 2);
        let lengths = closed.closing.iter().map(|k| graph.pieces[*k].length());
        assert!((lengths.sum::<f64>() - 0.2).abs() < 1e-12);
        // Where the tab is open at its end, the crease behind it does not close it.
        curves[4] = PlaneCurve::Line([[0.1, 0.7], [0.5, 0.7]]);
        let open = outline(&curves).1.map(|outline| outline.area);
        assert!(matches!(open, Err(PlaneError::Open { .. })), "{open:?}");
    }
}
