//! Vertices at which a crease pattern does not fold flat.

use isosheet_dynamics::FLAT;
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{EdgeId, FlatCrease, FlatFoldingLaw, Sheet, VertexId, fold_angle};
use isosheet_scenes::FoldTargets;
use std::f64::consts::PI;
use std::fmt;

/// A vertex whose creases are all meant to fold by 180 degrees, and at which no sheet does that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnfoldableVertex {
    /// The vertex.
    pub vertex: VertexId,
    /// Where it is in the rest shape, metres.
    pub at: [f64; 2],
    /// What stands against it.
    pub violates: FlatFoldingLaw,
}

/// Angles and sums of them that differ by no more, degrees, are equal: creases that are so far from their
/// angles are closed.
const CLOSED: f64 = 1.0;

impl UnfoldableVertex {
    /// The unfoldable vertices of a flat sheet whose creases are driven to targets, of which `assignments`
    /// say what other edges do: an edge of which they say nothing folds freely.
    pub(super) fn all(
        sheet: &Sheet,
        targets: &FoldTargets,
        assignments: Option<&[Option<FoldAssignment>]>,
    ) -> Vec<Self> {
        let t = sheet.topology();
        let mut target: Vec<Option<f64>> = vec![None; t.edge_count()];
        for (e, angle) in &targets.creases {
            target[e.index()] = Some(*angle);
        }
        let stays_flat = |e: EdgeId| {
            let known = assignments.and_then(|all| all[e.index()]);
            known == Some(FoldAssignment::Flat)
        };
        let is_flat =
            |e: EdgeId| fold_angle(t, sheet.positions(), e).is_none_or(|a| a.abs() < FLAT);
        let law = |v: VertexId| {
            let edges = t.vertex_edges(v);
            if t.is_boundary_vertex(v) || !edges.iter().all(|e| is_flat(*e)) {
                return None;
            }
            let (mut angles, mut creases) = (Vec::new(), Vec::new());
            for &e in edges {
                match target[e.index()] {
                    Some(angle) => {
                        angles.push(angle);
                        creases.push(FlatCrease {
                            direction: direction(sheet, v, e),
                            is_mountain: angle < 0.0,
                        });
                    }
                    None if stays_flat(e) => {}
                    None => return None,
                }
            }
            let folds_whole = |angle: &f64| (angle.abs() - PI).abs() < CLOSED.to_radians();
            if angles.is_empty() || !angles.iter().all(folds_whole) {
                return None;
            }
            FlatFoldingLaw::broken(&creases, CLOSED.to_radians())
        };
        let vertices = (0..t.vertex_count()).map(VertexId::from_index);
        let found = vertices.filter_map(|v| {
            let [x, y, _] = sheet.position(v);
            law(v).map(|violates| Self {
                vertex: v,
                at: [x, y],
                violates,
            })
        });
        found.collect()
    }
}

/// The direction of an edge from a vertex, radians from the x axis.
fn direction(sheet: &Sheet, v: VertexId, e: EdgeId) -> f64 {
    let ends = sheet.topology().edges()[e.index()];
    let other = if ends[0] == v { ends[1] } else { ends[0] };
    let [p, q] = [v, other].map(|v| sheet.position(v));
    (q[1] - p[1]).atan2(q[0] - p[0])
}

/// The vertex, its place, and why.
impl fmt::Display for UnfoldableVertex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.at;
        write!(
            f,
            "vertex {} at ({x:.3}, {y:.3}) m does not fold flat: {}",
            self.vertex.0, self.violates
        )
    }
}
