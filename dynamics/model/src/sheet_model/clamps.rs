//! Clamps that no line of edges runs along.

use crate::SheetModel;
use isosheet_materials::vectors::point;
use isosheet_mesh::{FaceId, VertexId};
use nalgebra::Vector3;

/// A clamp of a sheet of rods that no line of edges of the mesh runs along, see
/// [`SheetModel::clamps_across_the_mesh`].
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ClampAcrossMesh {
    /// The clamped vertices beside the free part of the sheet, which are not on one line.
    pub edge: Vec<VertexId>,
}

/// Distance of a vertex from a line, relative to the length of the line, up to which the vertex is on the
/// line. It allows for the round-off of meshes from files with six digits.
const OFF_LINE: f64 = 1e-5;

impl SheetModel {
    /// The clamps of a sheet of rods along which the sheet cannot fold, at positions `x` (`3V`, metres).
    ///
    /// A clamp is a set of faces, connected by edges, all of whose vertices are pinned, be it that the pins
    /// rest or move. A sheet of rods folds along lines of edges only: at a clamp it can do so where the
    /// pinned vertices that have free neighbours are on one line. Elsewhere the sheet next to the clamp
    /// cannot move, and most such sheets lock ([`StepError::Locked`](crate::StepError::Locked)). The check is
    /// geometric and takes a time proportional to the size of the mesh. It errs on both sides: a sheet may
    /// fold along a line of edges further away, and rods may lock elsewhere. `docs/troubleshooting.md` of the
    /// repository says how often.
    ///
    /// Elastic sheets have none.
    ///
    /// # Panics
    /// If the length of `x` is not three times the number of vertices.
    pub fn clamps_across_the_mesh(&self, x: &[f64]) -> Vec<ClampAcrossMesh> {
        assert_eq!(x.len(), self.coordinate_count(), "length of the positions");
        let topology = self.topology();
        let is_of_rods = |f: FaceId| topology.face_edges(f).iter().all(|e| self.is_rod(*e));
        let is_clamped = |f: &[VertexId; 3]| f.iter().all(|v| self.is_pinned(*v));
        let mut in_clamp = vec![false; topology.vertex_count()];
        for (face, corners) in topology.face_ids().zip(topology.faces()) {
            if is_clamped(corners) && is_of_rods(face) {
                corners.iter().for_each(|v| in_clamp[v.index()] = true);
            }
        }
        let clamps = parts(self, |v| in_clamp[v.index()]);
        let free = parts(self, |v| !self.is_pinned(v));
        let mut found = Vec::new();
        for clamp in 0..count(&clamps) {
            for side in 0..count(&free) {
                let is_beside = |v: VertexId| {
                    let mut near = topology.neighbours(v);
                    clamps[v.index()] == Some(clamp) && near.any(|n| free[n.index()] == Some(side))
                };
                let edge: Vec<VertexId> = topology.vertex_ids().filter(|v| is_beside(*v)).collect();
                if !is_straight(&edge, x) {
                    found.push(ClampAcrossMesh { edge });
                }
            }
        }
        found
    }
}

/// Of each vertex of a kind the number of the part that it is connected with by edges between such vertices.
fn parts(model: &SheetModel, is_such: impl Fn(VertexId) -> bool) -> Vec<Option<usize>> {
    let topology = model.topology();
    let mut part = vec![None; topology.vertex_count()];
    let mut number = 0;
    for first in topology.vertex_ids() {
        if !is_such(first) || part[first.index()].is_some() {
            continue;
        }
        part[first.index()] = Some(number);
        let mut open = vec![first];
        while let Some(v) = open.pop() {
            for n in topology.neighbours(v) {
                if is_such(n) && part[n.index()].is_none() {
                    part[n.index()] = Some(number);
                    open.push(n);
                }
            }
        }
        number += 1;
    }
    part
}

/// The number of parts.
fn count(parts: &[Option<usize>]) -> usize {
    parts.iter().flatten().max().map_or(0, |last| last + 1)
}

/// Whether vertices are on one line.
fn is_straight(vertices: &[VertexId], x: &[f64]) -> bool {
    let Some(first) = vertices.first() else {
        return true;
    };
    let from = |v: &VertexId| point(x, *v) - point(x, *first);
    let furthest = vertices.iter().map(from).fold(Vector3::zeros(), |a, b| {
        if b.norm_squared() > a.norm_squared() {
            b
        } else {
            a
        }
    });
    let length = furthest.norm();
    let off = |v: &VertexId| from(v).cross(&furthest).norm() > OFF_LINE * length * length;
    !vertices.iter().any(off)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, Sheet, generate};

    fn pinned(sheet: &Sheet, is_pin: impl Fn([f64; 3]) -> bool) -> SheetModel {
        let vertices = sheet.topology().vertex_ids();
        let pins: Vec<VertexId> = vertices.filter(|v| is_pin(sheet.position(*v))).collect();
        SheetModel::new(sheet, 0.1, MassKind::Lumped)
            .and_then(|m| m.with_pins(&pins))
            .unwrap()
    }

    #[test]
    fn clamps_along_lines_of_the_mesh_are_none() {
        let sheet = generate::anisotropic_grid(8, 8, 1.0, 1.0).unwrap();
        let x = sheet.positions();
        let clamps = |is_pin: &dyn Fn([f64; 3]) -> bool| {
            pinned(&sheet, is_pin).clamps_across_the_mesh(x).len()
        };
        assert_eq!(clamps(&|p| p[0] < 0.2), 0);
        // In the middle, with a free part on both sides, and at both ends.
        assert_eq!(clamps(&|p| (p[0] - 0.5).abs() < 0.2), 0);
        assert_eq!(clamps(&|p| (p[0] - 0.5).abs() > 0.3), 0);
        // One line of vertices clamps no face, and neither do single vertices.
        assert_eq!(clamps(&|p| p[0] < 0.01 || p[1] < 0.01), 0);
        // An angle, and a square in the middle.
        assert_eq!(clamps(&|p| p[0] < 0.2 || p[1] < 0.2), 1);
        assert_eq!(
            clamps(&|p| (p[0] - 0.5).abs() < 0.2 && (p[1] - 0.5).abs() < 0.2),
            1
        );
        // All of the sheet.
        assert_eq!(clamps(&|_| true), 0);
    }

    #[test]
    fn clamps_across_the_mesh_are_found_wherever_the_sheet_is() {
        let sheet = generate::delaunay_square(1.0, 0.15, 3).unwrap();
        let model = pinned(&sheet, |p| p[0] + 0.4 * p[1] < 0.3);
        let found = model.clamps_across_the_mesh(sheet.positions());
        assert_eq!(found.len(), 1);
        for v in &found[0].edge {
            assert!(model.is_pinned(*v));
            let mut near = model.topology().neighbours(*v);
            assert!(near.any(|n| !model.is_pinned(n)));
        }
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.1, -0.4);
        let chunks = sheet.positions().as_chunks::<3>().0.iter();
        let turned: Vec<f64> = chunks
            .flat_map(|p| <[f64; 3]>::from(turn * Vector3::from(*p) * 1e3))
            .collect();
        assert_eq!(model.clamps_across_the_mesh(&turned), found);
        // Elastic sheets bend along any line.
        let elasticity = isosheet_materials::ElasticSheet::new(&sheet, 1e3, 0.3).unwrap();
        let elastic = model.with_elastic_sheet(elasticity).unwrap();
        assert_eq!(elastic.clamps_across_the_mesh(sheet.positions()), []);
    }
}
