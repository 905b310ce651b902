//! Fig. 1: refinement by the 1-4 split.

use super::{Made, Table, caption, style, svg};
use crate::draw::{Drawing, Stroke, TEXT, flat_edges, flat_faces, palette, row};
use anyhow::{Result, ensure};
use isosheet_mesh::generate::{anisotropic_grid, split_1_4};
use isosheet_mesh::{Dof, EdgeId, Sheet};

const SIDE: f64 = 104.0;

pub(super) fn make() -> Result<Made> {
    let mut sheets = vec![anisotropic_grid(1, 1, 1.0, 1.0)?];
    for k in 0..3 {
        sheets.push(split_1_4(&sheets[k])?);
    }
    let mut panels = Vec::new();
    let head = [
        "split",
        "V",
        "E",
        "F",
        "boundary edges",
        "DOF",
        "DOF by Lemma 1",
    ];
    let mut table = Table::new("Counted on the meshes", &head);
    for (k, sheet) in sheets.iter().enumerate() {
        let t = sheet.topology();
        let dof = Dof::of(t).total;
        let boundary = t.boundary_edge_count();
        let mut lemma = None;
        if k > 0 {
            let before = sheets[k - 1].topology();
            let expected = Dof::of(before).total + before.boundary_edge_count() as i64;
            ensure!(
                dof == expected,
                "Lemma 1 fails at step {k}: {dof} instead of {expected}"
            );
            lemma = Some(expected as f64);
        }
        table.push(vec![
            k.into(),
            t.vertex_count().into(),
            t.edge_count().into(),
            t.face_count().into(),
            boundary.into(),
            (dof as f64).into(),
            lemma.into(),
        ]);
        let coarser = k.checked_sub(1).map(|j| &sheets[j]);
        let mut d = panel(sheet, coarser);
        let counts = format!(
            "V = {}, E = {}, F = {}",
            t.vertex_count(),
            t.edge_count(),
            t.face_count()
        );
        let freedom = format!("DOF = {dof}, B = {boundary}");
        caption(&mut d, [0.5 * SIDE, -7.0], TEXT, &[counts, freedom]);
        panels.push(d);
    }
    let all = row(&panels, 14.0);
    let alt = "A square of two triangles and three successive 1-4 splits of it";
    Ok(Made {
        title: "Refinement by the 1–4 split",
        paper: "A mesh is refined by splitting every triangle into four; Lemma 1 says that each step adds as many degrees of \
                freedom as the coarser mesh has boundary edges.",
        here: "The split is applied three times to two triangles; new edges are blue.",
        pictures: svg(1, &all, alt),
        tables: vec![table],
        ..Made::default()
    })
}

/// The sheet; edges that are not part of an edge of the coarser sheet are blue.
fn panel(sheet: &Sheet, coarser: Option<&Sheet>) -> Drawing {
    let mut d = Drawing::new();
    flat_faces(&mut d, sheet, SIDE, |_| style::FACE);
    // The split keeps the old vertices and puts vertex V + e in the middle of edge e: halves of old edges
    // have an old end.
    let old = coarser.map_or(usize::MAX, |c| c.topology().vertex_count());
    let is_new = |e: EdgeId| {
        sheet.topology().edges()[e.index()]
            .iter()
            .all(|v| v.index() >= old)
    };
    let new = Stroke::new(palette::BLUE, 0.7);
    flat_edges(&mut d, sheet, SIDE, |e| is_new(e).then_some(new));
    flat_edges(&mut d, sheet, SIDE, |e| (!is_new(e)).then_some(style::EDGE));
    let r = 1.3;
    for v in sheet.topology().vertex_ids() {
        let p = sheet.position(v);
        let colour = if v.index() >= old {
            palette::BLUE
        } else {
            palette::INK
        };
        d.disc(
            [SIDE * p[0], SIDE * p[1]],
            r,
            colour,
            Stroke::new(colour, 0.2),
        );
    }
    d
}
