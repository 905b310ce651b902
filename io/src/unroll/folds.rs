//! What the edges of an unrolled sheet do when it is folded.

use isosheet_coords::Unrolled;
use isosheet_formats::{EdgeAssignment, FileCrease, MeshFile};
use isosheet_mesh::{CreasePattern, EdgeId, FaceId, Sheet, fold_angle};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Angles below are round-off of files.
const FLAT: f64 = CreasePattern::TOLERANCE;

/// An edge inside of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fold {
    /// The edge of the flat sheet.
    pub(super) edge: EdgeId,
    pub(super) assignment: EdgeAssignment,
    /// Its fold angle, radians within -pi and pi, positive for a valley; where it is known.
    pub(super) angle: Option<f64>,
    /// Whether it is drawn as a crease.
    pub(super) is_crease: bool,
    /// Whether it folds by more than coordinates with seven digits can say: [`round_off`].
    pub(super) is_bent: bool,
}

impl Fold {
    /// By how much it folds, radians.
    pub(super) fn size(&self) -> f64 {
        self.angle.map_or(0.0, f64::abs)
    }
}

/// The folds of all edges inside of the pieces. Angles come from the mesh in space. Where it is flat, and at
/// faces that lie on each other, they come from its file. Creases are folds of at least
/// `crease` radians, and all edges that the file names mountains, valleys or unassigned.
pub(super) fn folds(
    mesh: &MeshFile,
    origins: &[u32],
    given: &Sheet,
    unrolled: &Unrolled,
    crease: f64,
) -> Vec<Fold> {
    let key = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let known = mesh.creases.iter().map(|c| (key(c.ends), c));
    let known: HashMap<[u32; 2], &FileCrease> = known.collect();
    let (t, flat) = (given.topology(), unrolled.flat.topology());
    let size = given
        .positions()
        .iter()
        .fold(0.0_f64, |m, c| m.max(c.abs()));
    let inside = flat.edge_ids().filter(|e| !flat.is_boundary_edge(*e));
    let fold = |edge: EdgeId| {
        let own = unrolled.given_edge(t, edge)?;
        let angle = fold_angle(t, given.positions(), own)?;
        let ends = t.edges()[own.index()].map(|v| origins[v.index()]);
        let named = known.get(&key(ends)).filter(|c| {
            use EdgeAssignment::{Mountain, Unassigned, Valley};
            matches!(c.assignment, Mountain | Valley | Unassigned)
        });
        let (assignment, angle) = match named {
            Some(c) if angle.abs() < FLAT => (c.assignment, c.angle),
            Some(c) if angle.abs() > PI - FLAT => match c.assignment {
                EdgeAssignment::Mountain => (EdgeAssignment::Mountain, Some(-angle.abs())),
                EdgeAssignment::Valley => (EdgeAssignment::Valley, Some(angle.abs())),
                _ => of_angle(angle),
            },
            _ => of_angle(angle),
        };
        let is_bent = angle.is_some_and(|a| a.abs() > round_off(given, own, size));
        Some(Fold {
            edge,
            assignment,
            angle,
            is_crease: named.is_some() || is_bent && angle.is_some_and(|a| a.abs() >= crease),
            is_bent,
        })
    };
    inside.filter_map(fold).collect()
}

/// The fold angle, radians, that coordinates with seven digits leave open at an edge of a mesh whose largest
/// coordinate is `size`, metres: a corner is known to `1e-7 size`, and tilts its face by this over the
/// altitude of the face.
fn round_off(sheet: &Sheet, e: EdgeId, size: f64) -> f64 {
    let faces = sheet.topology().edge_faces(e).into_iter().flatten();
    let altitude = |f: FaceId| 2.0 * sheet.face_areas()[f.index()] / sheet.lengths()[e.index()];
    let tilts = faces.map(|f| 1e-7 * size / altitude(f));
    tilts.sum::<f64>().max(FLAT)
}

fn of_angle(angle: f64) -> (EdgeAssignment, Option<f64>) {
    match angle {
        a if a.abs() < FLAT => (EdgeAssignment::Flat, Some(0.0)),
        a if a < 0.0 => (EdgeAssignment::Mountain, Some(a)),
        a => (EdgeAssignment::Valley, Some(a)),
    }
}

/// The flat sheet as a mesh with its folds.
pub(super) fn pattern(unrolled: &Unrolled, folds: &[Fold]) -> MeshFile {
    let flat = &unrolled.flat;
    let edges = flat.topology().edges();
    let crease = |fold: &Fold| {
        let ends = edges[fold.edge.index()].map(|v| v.0);
        FileCrease::new(ends, fold.assignment, fold.angle)
    };
    MeshFile::of_frame(
        flat.positions().to_vec(),
        flat.face_indices(),
        folds.iter().map(crease).collect(),
    )
}
