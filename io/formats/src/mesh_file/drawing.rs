//! Reading drawings of crease patterns: SVG, CP and OPX files.

use super::error::{Located, Location};
use super::faces::Polyhedron;
use super::{EdgeAssignment, MeshFile, MeshFormat, MeshOptions};
use crate::mesh_file::pattern::{self, FileUnit, PatternLines, Planar};
use isosheet_files::DataError;
use std::collections::BTreeMap;

/// Reads a drawing. Its faces are what its lines enclose, in the plane z = 0 as seen on the screen; points
/// that are within the tolerance for welding of each other are one.
pub(super) fn parse(
    bytes: &[u8],
    format: MeshFormat,
    options: &MeshOptions,
) -> Result<MeshFile, Located> {
    let plain = |e: DataError| (None, e.into());
    let lines = lines(bytes, format)?;
    let planar = pattern::of_segments(&lines.segments, options.weld);
    let planar = planar.and_then(|planar| planar.closed(unit(format)));
    let planar = planar.map_err(plain)?;
    let mut polyhedron = Polyhedron::default();
    for p in &planar.points {
        polyhedron.push_vertex(*p).map_err(plain)?;
    }
    for (k, face) in planar.faces.iter().enumerate() {
        polyhedron.push_face(face.iter().copied(), Location::Face(k));
    }
    let mut mesh = polyhedron.assemble(options)?;
    mesh.take_edges(planar);
    mesh.in_metres = lines.in_metres;
    mesh.drawn = lines.drawn;
    mesh.changes.other_lines = lines.of_other_colours;
    mesh.left_out = lines.left_out;
    mesh.cut_along_outlines_inside();
    mesh.drop_unreferenced();
    mesh.separate_cuts();
    Ok(mesh)
}

fn lines(bytes: &[u8], format: MeshFormat) -> Result<PatternLines, Located> {
    let plain = |e: DataError| (None, e.into());
    let segments = match format {
        MeshFormat::Svg => return pattern::svg::parse(bytes).map_err(plain),
        MeshFormat::Opx => pattern::opx::parse(bytes).map_err(plain)?,
        _ => {
            pattern::cp::parse(bytes).map_err(|(line, e)| (Some(Location::Line(line)), e.into()))?
        }
    };
    Ok(PatternLines {
        segments,
        ..PatternLines::default()
    })
}

/// How a format writes coordinates: SVG files are told in millimetres, and in the others y points downwards.
fn unit(format: MeshFormat) -> FileUnit {
    match format {
        MeshFormat::Svg => FileUnit {
            along: [1e3, 1e3],
            name: " mm",
        },
        _ => FileUnit {
            along: [1.0, -1.0],
            ..FileUnit::SAME
        },
    }
}

impl MeshFile {
    /// Takes the edges of a drawing, and what reading it changed; diagonals of its faces stay flat.
    pub(super) fn take_edges(&mut self, planar: Planar) {
        self.changes.divided_lines = planar.divided;
        self.changes.loose_lines = planar.loose;
        self.changes.loose_cuts = planar.loose_cuts;
        self.changes.double_lines = planar.double;
        self.changes.contradicting_lines = planar.contradicting;
        self.creases = planar.edges;
        self.add_diagonals();
    }

    /// Makes cuts of the edges that are drawn as the outline and have the sheet on both sides.
    fn cut_along_outlines_inside(&mut self) {
        let inside: Vec<usize> = self.boundaries_inside().collect();
        for k in inside {
            self.creases[k].assignment = EdgeAssignment::Cut;
        }
    }

    /// The numbers of the edges that are named boundary and have the sheet on both sides.
    pub(super) fn boundaries_inside(&self) -> impl Iterator<Item = usize> {
        let mut sides = BTreeMap::new();
        for &[a, b, c] in &self.faces {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                *sides.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
            }
        }
        let creases = self.creases.iter().enumerate();
        let inside = creases.filter(move |(_, crease)| {
            let [a, b] = crease.ends;
            let is_inside = sides.get(&[a.min(b), a.max(b)]) == Some(&2);
            crease.assignment == EdgeAssignment::Boundary && is_inside
        });
        inside.map(|(k, _)| k)
    }
}
