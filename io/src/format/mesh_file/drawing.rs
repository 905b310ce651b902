//! Reading drawings of crease patterns: SVG, CP and OPX files.

use super::error::{Located, Location};
use super::faces::Polyhedron;
use super::{EdgeAssignment, MeshFile, MeshFormat, MeshOptions};
use crate::format::DataError;
use crate::format::mesh_file::pattern::{self, Planar, Segment};
use std::collections::BTreeMap;

/// Reads a drawing. Its faces are what its lines enclose, in the plane z = 0 as seen on the screen; points that are
/// within the tolerance for welding of each other are one.
pub(super) fn parse(
    bytes: &[u8],
    format: MeshFormat,
    options: &MeshOptions,
) -> Result<MeshFile, Located> {
    let plain = |e: DataError| (None, e.into());
    let segments = segments(bytes, format)?;
    let planar = pattern::of_segments(&segments, options.weld).map_err(plain)?;
    let mut polyhedron = Polyhedron::default();
    for p in &planar.points {
        polyhedron.push_vertex(*p).map_err(plain)?;
    }
    for (k, face) in planar.faces.iter().enumerate() {
        polyhedron.push_face(face.iter().copied(), Location::Face(k));
    }
    let mut mesh = polyhedron.assemble(options)?;
    mesh.take_edges(planar);
    mesh.cut_along_outlines_inside();
    mesh.drop_unreferenced();
    mesh.separate_cuts();
    Ok(mesh)
}

fn segments(bytes: &[u8], format: MeshFormat) -> Result<Vec<Segment>, Located> {
    let plain = |e: DataError| (None, e.into());
    match format {
        MeshFormat::Opx => pattern::opx::parse(bytes).map_err(plain),
        MeshFormat::Svg => pattern::svg::parse(bytes).map_err(plain),
        _ => pattern::cp::parse(bytes).map_err(|(line, e)| (Some(Location::Line(line)), e.into())),
    }
}

impl MeshFile {
    /// Takes the edges of a drawing, and what reading it changed; diagonals of its faces stay flat.
    pub(super) fn take_edges(&mut self, planar: Planar) {
        self.changes.divided_lines = planar.divided;
        self.changes.loose_lines = planar.loose;
        self.changes.double_lines = planar.double;
        self.creases = planar.edges;
        self.add_diagonals();
    }

    /// Makes cuts of the edges that are drawn as the outline and have the sheet on both sides.
    fn cut_along_outlines_inside(&mut self) {
        let mut sides = BTreeMap::new();
        for &[a, b, c] in &self.faces {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                *sides.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
            }
        }
        for crease in &mut self.creases {
            let [a, b] = crease.ends;
            let is_inside = sides.get(&[a.min(b), a.max(b)]) == Some(&2);
            if crease.assignment == EdgeAssignment::Boundary && is_inside {
                crease.assignment = EdgeAssignment::Cut;
            }
        }
    }
}
