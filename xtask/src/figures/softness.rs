//! How sheets that are held at a corner fall, by mesh: what the paper says of Figs. 11 and 12 by eye.

use super::crumple::{self, PAPER_SHEET};
use super::{FigureRow, Table, rows};
use crate::draw::{Axis, Chart, mesh_name};
use crate::report::columns;
use crate::runs::{
    Ensemble, Hanging, PLATE, Run, SheetShape, Spread, about_ensembles, members, spreads,
};
use crate::store::Store;
use anyhow::{Result, ensure};
use isosheet_mesh::Dof;
use serde::{Deserialize, Serialize};

/// What is measured of a fall.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Fall {
    /// The shape at the end.
    shape: SheetShape,
    /// Total bending averaged over the run, radians times sides.
    bending: f64,
}

impl Fall {
    fn of(run: &Run) -> Result<Self> {
        let hanging = Hanging::of(&run.scene)?;
        let shapes = run.frames().skip(1).map(|x| SheetShape::of(&hanging, x));
        let shapes = shapes.collect::<Result<Vec<_>>>()?;
        let bending: f64 = shapes.iter().map(|s| s.bending).sum();
        Ok(Self {
            shape: SheetShape::of(&hanging, run.end())?,
            bending: bending / shapes.len().max(1) as f64,
        })
    }
}

/// The falls of rods and of paper on one mesh.
pub(super) struct Falls {
    pub(super) level: u32,
    /// The runs that are shown.
    pub(super) runs: [Run; 2],
    pub(super) falls: [Ensemble<Fall>; 2],
}

/// A sheet whose total bending at the end is less than this part of that of rods is not crumpled.
const CRUMPLED: f64 = 0.1;

impl Falls {
    /// Makes them on M^level.
    pub(super) fn of(level: u32, store: &Store) -> Result<Self> {
        let rods = crumple::scene(level, store.effort)?;
        let paper = rods.made_of(PAPER_SHEET)?;
        let runs = [Run::of(store, rods)?, Run::of(store, paper)?];
        let fall = |run| Ensemble::of(store, run, members(store.effort), Fall::of);
        let falls = [fall(&runs[0])?, fall(&runs[1])?];
        Ok(Self { level, runs, falls })
    }

    /// What the figures say of rods and of paper.
    pub(super) fn check(&self) -> Result<()> {
        let [rods, paper] = self.falls.each_ref().map(|f| f.median(at_end));
        ensure!(
            paper < CRUMPLED * rods,
            "paper crumples, too: its total bending is {paper:.2}, and that of rods {rods:.2}, rad times the side"
        );
        Ok(())
    }

    /// What is measured of the falls of one sheet.
    pub(super) fn rows(&self, sheet: usize) -> Vec<FigureRow> {
        let all = &self.falls[sheet];
        rows! {
            "runs of the ensemble" => all.len().to_string(),
            "depth of the centre of mass at the end, sides" => {
                let depth = all.spread(|f| f.shape.centre_depth).text(|d| format!("{d:.3}"));
                format!("{depth} (a rigid plate: {PLATE:.3})")
            },
            "total bending at the end, rad times the side" => all.spread(at_end).text(|b| format!("{b:.2}")),
        }
    }
}

fn at_end(fall: &Fall) -> f64 {
    fall.shape.bending
}

fn bending(fall: &Fall) -> f64 {
    fall.bending
}

/// Checks that rods bend more on each of the finer meshes than on each of the coarser ones.
pub(super) fn check(all: &[Falls]) -> Result<()> {
    let bent: Vec<f64> = all.iter().map(|f| f.falls[0].median(bending)).collect();
    let (coarser, finer) = bent.split_at(bent.len() / 2);
    let is_more = |fine: &f64| coarser.iter().all(|coarse| fine > coarse);
    ensure!(
        finer.iter().all(is_more),
        "the total bending of rods does not grow with the mesh: {bent:?}"
    );
    Ok(())
}

/// What the table shows.
const ABOUT: &str = "\
    Softness by mesh. Total bending, averaged over the run: sum of edge length (in sides) times fold angle, which does not depend on how \
    many edges share a bend. Width: largest horizontal distance at the end. Depth of the centre of mass at the end, in sides (a rigid \
    plate: 0.707): it depends on the folds in which a sheet happens to come to rest, more than on the mesh.";

/// The falls of all meshes.
pub(super) fn table(all: &[Falls]) -> Table {
    let each = all.iter().flat_map(|f| [(f, 0), (f, 1)]);
    let text = |spread: Spread, digits: usize| spread.text(|v| format!("{v:.digits$}"));
    Table::of(
        format!("{ABOUT} {}", about_ensembles()),
        each,
        columns! { row;
            "mesh" => mesh_name(row.0.level),
            "sheet" => row.0.runs[row.1].scene.sheet_name(),
            "V/F" => row.0.runs[row.1].summary.mesh(),
            "internal DOF of rods" => Dof::of(row.0.runs[row.1].sheet.topology()).internal.to_string(),
            "total bending" => text(row.0.falls[row.1].spread(bending), 2),
            "width, sides" => text(row.0.falls[row.1].spread(|f| f.shape.extent), 2),
            "depth of the centre" => text(row.0.falls[row.1].spread(|f| f.shape.centre_depth), 3),
            "runs" => row.0.falls[row.1].len(),
        },
    )
}

/// Total bending by mesh.
pub(super) fn plot(all: &[Falls]) -> Chart {
    let of = |k: usize, name: &str| {
        // Side by side, so that no bar hides another.
        let beside = 0.1 * (k as f64 - 0.5);
        let place = |f: &Falls| (f64::from(f.level) + beside, f.falls[k].spread(bending));
        spreads(k, name, all.iter().map(place))
    };
    let series = vec![of(0, "rods"), of(1, PAPER_SHEET)];
    let top = series.iter().flat_map(|s| &s.bars).map(|bar| bar[1]);
    let top = 1.05 * top.fold(0.1, f64::max);
    let ticks = all.iter().map(|f| (f64::from(f.level), mesh_name(f.level)));
    let last = all.last().map_or(1.0, |f| f64::from(f.level));
    let x = Axis::named("mesh", [-0.3, last + 0.3], ticks.collect());
    let y = Axis::linear("total bending (rad × side)", [0.0, top]);
    Chart::new(x, y, [190.0, 130.0], series)
}
