//! Fig. 4: isotropic refinement.

use super::{Made, Table, caption, style, svg};
use crate::draw::{
    Drawing, Stroke, TEXT, column, flat_edges, flat_faces, mesh_name, palette, plan, row,
};
use anyhow::{Result, ensure};
use isosheet_mesh::generate::isotropic_square;
use isosheet_mesh::{Dof, Sheet, VertexId};
use std::collections::BTreeSet;

const SIDE: f64 = 104.0;

pub(super) fn make() -> Result<Made> {
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    let head = [
        "level",
        "rectangles",
        "their edges E",
        "4 E − 8 F + 3",
        "DOF",
        "DOF by Lemma 2",
    ];
    let mut table = Table::new("Counted on the meshes (F: rectangles)", &head);
    let mut last = None;
    for level in 0..4 {
        let sheet = isotropic_square(level, 1.0)?;
        let t = sheet.topology();
        let dof = Dof::of(t);
        let rectangles = Rectangles::of(&sheet);
        let (faces, edges) = (rectangles.cells.len() as i64, rectangles.edges.len() as i64);
        ensure!(
            t.face_count() as i64 == 8 * faces && dof.total == 4 * edges - 8 * faces + 3,
            "the rectangles of level {level} do not give the triangles"
        );
        if let Some(before) = last {
            ensure!(
                dof.total == 2 * before - 3,
                "Lemma 2 fails at level {level}"
            );
        }
        table.push(vec![
            level.into(),
            (faces as f64).into(),
            (edges as f64).into(),
            ((4 * edges - 8 * faces + 3) as f64).into(),
            (dof.total as f64).into(),
            last.map(|before: i64| (2 * before - 3) as f64).into(),
        ]);
        last = Some(dof.total);
        let mut top = rectangles.draw(&sheet);
        let words = [
            format!("{faces} rectangle{}", if faces == 1 { "" } else { "s" }),
            format!("{edges} edges"),
        ];
        caption(&mut top, [0.5 * SIDE, -7.0], TEXT, &words);
        upper.push(top);
        let mut bottom = Drawing::new();
        flat_faces(&mut bottom, &sheet, SIDE, |_| style::FACE);
        let thin = Stroke::new(palette::INK, if level < 3 { 0.7 } else { 0.45 });
        flat_edges(&mut bottom, &sheet, SIDE, |_| Some(thin));
        let words = [
            format!(
                "{}: V/F = {}/{}",
                mesh_name(level),
                t.vertex_count(),
                t.face_count()
            ),
            format!("DOF = {} = 6 + {}", dof.total, dof.internal),
        ];
        caption(&mut bottom, [0.5 * SIDE, -7.0], TEXT, &words);
        lower.push(bottom);
    }
    let gap = 14.0;
    let all = column(&[row(&upper, gap), row(&lower, gap)], 12.0);
    let alt = "Four levels of the isotropic square, as rectangles and as triangles";
    Ok(Made {
        title: "Isotropic refinement",
        paper: "Rectangles (upper row) are split in four at each level and cut into eight triangles each (lower row); Lemma 2 \
                says that the DOF double less three.",
        here: "The rectangles are read off the triangle meshes: they are the stars of the vertices with both grid coordinates odd.",
        tables: vec![table],
        pictures: svg(4, &all, alt),
        ..Made::default()
    })
}

/// The rectangles of an isotropic square: stars of vertices in the middle of eight triangles that share no
/// triangle.
struct Rectangles {
    /// Their corners in order.
    cells: Vec<[VertexId; 4]>,
    /// Their edges, as ordered pairs of corners.
    edges: BTreeSet<[VertexId; 2]>,
}

impl Rectangles {
    fn of(sheet: &Sheet) -> Self {
        let t = sheet.topology();
        let per_row = (t.vertex_count() as f64).sqrt().round() as usize;
        let odd = |v: &VertexId| v.index() % per_row % 2 == 1 && v.index() / per_row % 2 == 1;
        let mut edges = BTreeSet::new();
        let mut cells = Vec::new();
        for v in t.vertex_ids().filter(odd) {
            let p = sheet.position(v);
            let mut corners = t.neighbours(v).filter(|w| {
                let q = sheet.position(*w);
                q[0] != p[0] && q[1] != p[1]
            });
            if let [Some(a), Some(b), Some(c), Some(d)] = [(); 4].map(|()| corners.next()) {
                cells.push([a, b, c, d]);
                for [x, y] in [[a, b], [b, c], [c, d], [d, a]] {
                    edges.insert([x.min(y), x.max(y)]);
                }
            }
        }
        Self { cells, edges }
    }

    fn draw(&self, sheet: &Sheet) -> Drawing {
        let mut d = Drawing::new();
        let place = plan(sheet, SIDE);
        for cell in &self.cells {
            d.polygon(&cell.map(&place), palette::SKY.tint(0.75));
        }
        for edge in &self.edges {
            d.line(&edge.map(&place), style::EDGE);
        }
        d
    }
}
