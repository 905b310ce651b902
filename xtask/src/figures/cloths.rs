//! The scenes of Figs. 14 and 15: cloths on tables, with everything but the shapes alike.

use super::Effort;
use super::folds::Outline;
use crate::runs::FigureScene;
use anyhow::{Context as _, Result, bail};
use isosheet_scenes as scene;

/// A scene of a cloth, cut short where the effort is small.
fn cloth(file: &str, name: &str, edits: Vec<String>, effort: Effort) -> Result<FigureScene> {
    let mut edits = edits;
    if effort == Effort::Quick {
        edits.push("stop.time=0.13333333333333333".to_owned());
    }
    FigureScene::of(file, name, &edits)
}

/// The scene of Fig. 14 on M^level.
pub(super) fn rectangle(level: u32, effort: Effort) -> Result<FigureScene> {
    let cells = 2 << level;
    let edits = ["columns", "rows"].map(|key| format!("sheet.mesh.rectangle.{key}={cells}"));
    cloth("fig14", &format!("drape-m{level}"), edits.to_vec(), effort)
}

/// The scene of Fig. 14 on an irregular mesh.
pub(super) fn irregular(effort: Effort) -> Result<FigureScene> {
    let coarse = vec!["sheet.mesh.polygon.spacing=0.15".to_owned()];
    let edits = effort.quick_or(coarse, Vec::new());
    cloth("fig14-irregular", "drape-irregular", edits, effort)
}

/// The scene of Fig. 15 with the paper's counts.
pub(super) fn octagon(effort: Effort) -> Result<FigureScene> {
    cloth("fig15", "drape-octagon", Vec::new(), effort)
}

/// The edits that give cloth and table another number of sides.
fn sides(mesh: &str, sides: u32) -> Vec<String> {
    let keys = [&format!("sheet.mesh.{mesh}"), "obstacle[0].shape.prism"];
    let edit = |key: &str| format!("{key}.outline.regular.sides={sides}");
    keys.map(edit).to_vec()
}

/// A polygon with an irregular mesh.
pub(super) fn polygon(name: &str, n: u32, spacing: f64, effort: Effort) -> Result<FigureScene> {
    let mut edits = sides("polygon", n);
    edits.push(format!("sheet.mesh.polygon.spacing={spacing:?}"));
    cloth("fig15-irregular", name, edits, effort)
}

/// A polygon with a mesh of rings.
pub(super) fn ringed(n: u32, rings: u32, effort: Effort) -> Result<FigureScene> {
    let mut edits = sides("polygon_rings", n);
    edits.push(format!("sheet.mesh.polygon_rings.rings={rings}"));
    cloth(
        "fig15-rings",
        &format!("drape-{n}-gon-rings"),
        edits,
        effort,
    )
}

/// Outlines of cloth and table, and the height of the start above the table, metres.
pub(super) struct Layout {
    pub(super) cloth: Outline,
    pub(super) table: Outline,
    pub(super) drop: f64,
}

impl Layout {
    pub(super) fn of(scene: &scene::Scene) -> Result<Self> {
        let cloth = match &scene.sheet[0].mesh {
            scene::Mesh::Rectangle { width, height, .. } => {
                Outline::rectangle(0.5 * width, 0.5 * height)
            }
            scene::Mesh::Polygon { outline, .. } | scene::Mesh::PolygonRings { outline, .. } => {
                Outline::of(outline.corners())
            }
            scene::Mesh::Octagon { radius } => {
                Outline::of(scene::Outline::regular(8, *radius).corners())
            }
            other => bail!("no outline is known of {other:?}"),
        };
        let table = scene.obstacle.first().context("a table")?;
        let (table_outline, height) = match &table.shape {
            scene::ShapeKey::Box { size } => {
                (Outline::rectangle(0.5 * size[0], 0.5 * size[1]), size[2])
            }
            scene::ShapeKey::Prism { outline, height } => (Outline::of(outline.corners()), *height),
            other => bail!("no outline is known of {other:?}"),
        };
        Ok(Self {
            cloth,
            table: table_outline,
            drop: -table.pose.position[2] - 0.5 * height,
        })
    }
}
