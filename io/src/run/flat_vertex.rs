//! Vertices at which a crease pattern does not fold flat.

use crate::scene::FoldTargets;
use isosheet_dynamics::FLAT;
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{EdgeId, Sheet, VertexId, fold_angle};
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

/// A condition for the creases of a vertex inside a sheet, all of which fold by 180 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlatFoldingLaw {
    /// Maekawa's theorem: mountains and valleys differ by two in number.
    Maekawa {
        /// Number of mountains.
        mountains: usize,
        /// Number of valleys.
        valleys: usize,
    },
    /// Kawasaki's theorem: the angles between creases, taken by turns, add up to 180 degrees twice.
    Kawasaki {
        /// The two sums, degrees.
        sums: [f64; 2],
    },
}

/// Sums of angles that differ by no more from 180 degrees are 180 degrees: creases that are so far from their
/// angles are closed.
const CLOSED: f64 = 1.0;

impl UnfoldableVertex {
    /// Those of a flat sheet whose creases are driven to targets, of which `assignments` say what other edges
    /// do: an edge of which they say nothing folds freely.
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
            let (mut angles, mut directions) = (Vec::new(), Vec::new());
            for &e in edges {
                match target[e.index()] {
                    Some(angle) => {
                        angles.push(angle);
                        directions.push(direction(sheet, v, e));
                    }
                    None if stays_flat(e) => {}
                    None => return None,
                }
            }
            let folds_whole = |angle: &f64| (angle.abs() - PI).abs() < CLOSED.to_radians();
            if angles.is_empty() || !angles.iter().all(folds_whole) {
                return None;
            }
            broken(&angles, directions)
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

/// The theorem that creases break by their fold angles or by their directions, radians.
fn broken(angles: &[f64], mut directions: Vec<f64>) -> Option<FlatFoldingLaw> {
    let mountains = angles.iter().filter(|angle| **angle < 0.0).count();
    let valleys = angles.len() - mountains;
    if mountains.abs_diff(valleys) != 2 {
        return Some(FlatFoldingLaw::Maekawa { mountains, valleys });
    }
    directions.sort_by(f64::total_cmp);
    let mut sums = [0.0; 2];
    for k in 0..directions.len() {
        let next = directions[(k + 1) % directions.len()];
        sums[k % 2] += (next - directions[k]).rem_euclid(2.0 * PI).to_degrees();
    }
    ((sums[0] - 180.0).abs() > CLOSED).then_some(FlatFoldingLaw::Kawasaki { sums })
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

impl fmt::Display for FlatFoldingLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Maekawa { mountains, valleys } => write!(
                f,
                "it has {mountains} mountains and {valleys} valleys, whose numbers have to differ by 2 (Maekawa)"
            ),
            Self::Kawasaki { sums: [a, b] } => write!(
                f,
                "the angles between its creases add up to {a:.1} and {b:.1} degrees by turns, which have to be 180 \
                 (Kawasaki)"
            ),
        }
    }
}
