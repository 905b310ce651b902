//! Fig. 2: external and internal degrees of freedom.

use super::sketch::{PLACED, Sketch, captioned};
use super::{Made, degrees, measured, rows, style, svg};
use crate::draw::spatial::arc;
use crate::draw::{Stroke, palette};
use anyhow::Result;
use isosheet_coords::EulerParameters;
use isosheet_mesh::{Dof, Sheet};

/// Fold of the pair that is drawn.
const FOLD: f64 = 0.9;

pub(super) fn make() -> Result<Made> {
    let a = [0.0, 0.0, 0.0];
    let b = [1.0, 0.0, 0.0];
    let left = [0.55, 0.85, 0.0];
    let right = [0.42, -0.8, 0.0];
    let one = Sheet::new([a, b, left].concat(), &[[0, 1, 2]])?;
    let two = Sheet::new([a, b, left, right].concat(), &[[0, 1, 2], [0, 3, 1]])?;
    let sketch = || Sketch::seen(-24.0, 34.0, 108.0);
    let (mut single, mut pair) = (sketch(), sketch());
    single.face([a, b, left], style::FACE);
    // The far face turns about the common edge; its rest place is drawn as a ghost.
    let turned = EulerParameters::about(&[1.0, 0.0, 0.0], FOLD).rotate(&left);
    let foot = [left[0], 0.0, 0.0];
    let ghost = pair.view.project_all(&[a, left, b]);
    pair.drawing.polygon(&ghost, palette::PALE.alpha(0.35));
    pair.drawing.line(&ghost, style::GHOST.dashed());
    pair.face([a, right, b], style::FACE);
    pair.blue_face([a, b, turned], 1.0);
    pair.line(&[a, b], Stroke::new(PLACED, 1.4));
    let path = arc(&foot, &[0.0, left[1], 0.0], &[0.0, 0.0, left[1]], FOLD);
    pair.arrow(&path, PLACED);
    let mut lines = Vec::new();
    for sheet in [&one, &two] {
        let t = sheet.topology();
        let dof = Dof::of(t);
        lines.push(vec![
            format!(
                "V = {}, E = {}, F = {}",
                t.vertex_count(),
                t.edge_count(),
                t.face_count()
            ),
            format!("DOF = 3V − E = {}", dof.total),
            format!("{} external, {} internal", dof.external, dof.internal),
        ]);
    }
    let all = captioned(vec![single.drawing, pair.drawing], &lines, 60.0);
    let alt = "One triangle, and two triangles folding about their common edge";
    Ok(Made {
        title: "External and internal degrees of freedom",
        paper: "A single triangle only moves rigidly (six external degrees of freedom); two triangles with a common edge have \
                a seventh, internal one: the fold about that edge.",
        here: "The arrow is the path of the far vertex when the one internal coordinate grows from flat to the fold that is drawn.",
        tables: vec![measured(rows! {
            "fold that is drawn" => degrees(FOLD),
        })],
        pictures: svg(2, &all, alt),
        ..Made::default()
    })
}
