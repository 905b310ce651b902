//! How soft a sheet is, by mesh level: what the paper says of Figs. 11 and 12 by eye.

use super::crumple::PAPER_SHEET;
use super::{Effort, Picture, Table, mean};
use crate::draw::{Axis, Chart, Charts, Marker, Series, mesh_name, palette};
use crate::report::{columns, extremes};
use crate::runs::{self, FigureScene, Member};
use anyhow::{Result, ensure};
use isosheet_mesh::Dof;

/// Falls of each mesh: they settle in different folds, so one says little.
const MEMBERS: u64 = 8;

/// Random displacement at the start of a fall, mean edge lengths: two hundredths of a millimetre on M^3.
const BUMP: f64 = 1e-3;

/// The plot and the table that go with Fig. 12.
pub(super) struct Softness {
    pub(super) picture: Picture,
    pub(super) table: Table,
}

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
pub(super) fn make(
    effort: Effort,
    fall: fn(u32, Effort) -> Result<FigureScene>,
) -> Result<Softness> {
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
    let alt = "The total bending of the falling sheet, by mesh level";
    Ok(Softness {
        picture: Picture::svg("fig12-softness", &plot(&all), alt),
        table: table(&all),
    })
}

/// The total bending over the level of the mesh: means, and bars with the range.
fn plot(all: &[Level]) -> Charts {
    let looks = [
        (palette::VERMILION, Marker::Disc, -0.07),
        (palette::BLUE, Marker::Square, 0.07),
    ];
    let sheets = all.chunk_by(|a, b| a.sheet == b.sheet).zip(looks);
    let series = sheets.map(|(levels, (colour, marker, aside))| {
        let bar = |l: &Level| {
            let values = l.values(bending);
            let [low, high] = extremes(values.iter().copied()).unwrap_or_default();
            [f64::from(l.level) + aside, low, mean(&values), high]
        };
        let bars: Vec<[f64; 4]> = levels.iter().map(bar).collect();
        let means = bars.iter().map(|b| [b[0], b[2]]).collect();
        Series {
            bars,
            ..Series::line(&levels[0].sheet, colour, means).marked(marker)
        }
    });
    let series: Vec<Series> = series.collect();
    let top = series.iter().flat_map(|s| &s.bars).map(|b| b[3]);
    let top = 1.1 * top.fold(0.0, f64::max);
    let last = all.last().map_or(0, |l| l.level);
    let ticks = (0..=last).map(|l| (f64::from(l), mesh_name(l)));
    let x = Axis::named("mesh", [-0.25, f64::from(last) + 0.25], ticks.collect());
    let y = Axis::linear("total bending (rad · side)", [0.0, top]);
    Chart::new(x, y, [140.0, 118.0], series).into()
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
