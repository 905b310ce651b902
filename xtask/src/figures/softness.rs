//! How soft a sheet is, by mesh level: what the paper says of Figs. 11 and 12 by eye.

use super::crumple::PAPER_SHEET;
use super::{Effort, Table, mean};
use crate::draw::mesh_name;
use crate::report::{columns, extremes};
use crate::runs::{self, FigureScene, Member};
use anyhow::{Result, ensure};
use isosheet_mesh::Dof;

/// Falls of each mesh: they settle in different folds, so one says little.
const MEMBERS: u64 = 8;

/// Random displacement at the start of a fall, mean edge lengths: two hundredths of a millimetre on M^3.
const BUMP: f64 = 1e-3;

/// The falls of one mesh.
struct Level {
    level: u32,
    sheet: String,
    vertices: usize,
    faces: usize,
    internal: i64,
    falls: Vec<Member>,
}

/// Rods and paper.
const SHEETS: [Option<&str>; 2] = [None, Some(PAPER_SHEET)];

/// A scene with rods in it, or the same of a material.
fn of_sheet(scene: FigureScene, material: Option<&str>) -> Result<FigureScene> {
    material.map_or(Ok(scene.clone()), |name| scene.made_of(name))
}

impl Level {
    fn name(&self) -> String {
        mesh_name(self.level)
    }

    fn values(&self, f: impl Fn(&Member) -> f64) -> Vec<f64> {
        self.falls.iter().map(f).collect()
    }
}

/// Measures the falls of the scenes that `fall` gives for each level.
pub(super) fn make(effort: Effort, fall: fn(u32, Effort) -> Result<FigureScene>) -> Result<Table> {
    let (levels, members) = effort.quick_or((0..2, 2), (0..4, MEMBERS));
    let mut all = Vec::new();
    for (level, material) in SHEETS
        .iter()
        .flat_map(|m| levels.clone().map(move |l| (l, *m)))
    {
        let scene = of_sheet(fall(level, effort)?, material)?;
        let sheet = scene.sheet()?;
        let t = sheet.topology();
        all.push(Level {
            level,
            sheet: scene.sheet_name().to_owned(),
            vertices: t.vertex_count(),
            faces: t.face_count(),
            internal: Dof::of(t).internal,
            falls: runs::ensemble(&scene, BUMP, members)?,
        });
    }
    // The rods come first, from the coarsest mesh to the finest.
    let ends = [0, levels.len() - 1].map(|k| mean(&all[k].values(bending)));
    ensure!(
        effort == Effort::Quick || ends[0] < ends[1],
        "the total bending of rods does not grow with the mesh: {ends:?}"
    );
    Ok(table(&all))
}

fn bending(fall: &Member) -> f64 {
    fall.mean_bending
}

/// What the table shows.
const ABOUT: &str = "\
    Softness by mesh: mean (range) of falls that start flat but for random displacements of a small part of an edge. Total bending, \
    averaged over the run: sum of edge length (in sides) times fold angle, which does not depend on how many edges share a bend. Width: \
    largest horizontal distance at the end. Depth of the centre of mass at the end, in sides (a rigid plate: 0.707): it depends on the \
    folds in which a sheet happens to come to rest, more than on the mesh.";

fn table(all: &[Level]) -> Table {
    let range = |l: &Level, digits: usize, f: fn(&Member) -> f64| {
        let v = l.values(f);
        let (mean, [low, high]) = (mean(&v), extremes(v.into_iter()).unwrap_or_default());
        format!("{mean:.digits$} ({low:.digits$}–{high:.digits$})")
    };
    let falls = format!("falls, displaced by up to {:.1} % of an edge", 100.0 * BUMP);
    Table::of(
        ABOUT,
        all,
        columns! { l;
            "mesh" => l.name(),
            "sheet" => l.sheet.as_str(),
            "V/F" => format!("{}/{}", l.vertices, l.faces),
            "internal DOF of rods" => l.internal.to_string(),
            "total bending" => range(l, 2, bending),
            "width" => range(l, 2, |m| m.shape.extent),
            "depth of the centre" => range(l, 3, |m| m.shape.centre_depth),
            &falls => l.falls.len(),
        },
    )
}
