//! How soft a sheet is, by mesh level: what the paper says of Figs. 11 and 12 by eye.

use super::crumple::PAPER_SHEET;
use super::{Effort, Picture, Table, mean, nearest, whole_percent};
use crate::draw::{Axis, Chart, Charts, Marker, Series, mesh_name, palette};
use crate::report::{columns, extremes};
use crate::runs::{self, FigureScene, Member};
use anyhow::{Result, ensure};
use isosheet_mesh::Dof;
use serde_json::{Value, json};

/// Falls of each mesh: they settle in different folds, so one says little.
const MEMBERS: u64 = 8;

/// Random displacement at the start of a fall, mean edge lengths: two hundredths of a millimetre on M^3.
const BUMP: f64 = 1e-3;

/// Time at which the first moments of the fall are compared, seconds: a plate has sunk by a twentieth of the
/// side then, and every sheet is still far from its first swing.
const EARLY: f64 = 0.05;

/// Frame of the first moments, seconds: the three curves are so close that frames of 1/60 s would blur them.
const FINE: f64 = 1.0 / 2000.0;

/// The plot and the table that go with Fig. 12.
pub(super) struct Softness {
    pub(super) picture: Picture,
    pub(super) table: Table,
    pub(super) facts: Value,
}

/// The falls of one mesh.
struct Level {
    level: u32,
    sheet: String,
    vertices: usize,
    faces: usize,
    internal: i64,
    falls: Vec<Member>,
    /// Time and freedom of the fall: how far the centre of mass is between that of the rigid plate (0) and
    /// free fall (1).
    freedom: Vec<[f64; 2]>,
}

/// Rods and paper.
const SHEETS: [Option<&str>; 2] = [None, Some(PAPER_SHEET)];

/// A scene with rods in it, or the same of a material.
fn of_sheet(scene: FigureScene, material: Option<&str>) -> Result<FigureScene> {
    material.map_or(Ok(scene.clone()), |name| scene.made_of(name))
}

/// The freedom of the fall from 0.03 s to 0.12 s.
fn freedom(level: u32, material: Option<&str>) -> Result<Vec<[f64; 2]>> {
    let edits = [
        format!("sheet.mesh.square.level={level}"),
        "contact.self_contact=false".to_owned(),
        format!("method.step={FINE:?}"),
        runs::for_frames(240, FINE),
    ];
    let scene = of_sheet(FigureScene::of("fig12", "fall", &edits)?, material)?;
    let (sheet, plate, free) = (
        runs::fall(&scene)?,
        runs::plate_fall(&scene)?,
        runs::free_fall(&scene)?,
    );
    // From 0.03 s: before that the limits differ by less than the error of the steps allows to divide by.
    Ok((60..sheet.len())
        .map(|k| {
            [
                sheet[k][0],
                (sheet[k][1] - plate[k][1]) / (free[k][1] - plate[k][1]),
            ]
        })
        .collect())
}

impl Level {
    fn name(&self) -> String {
        mesh_name(self.level)
    }

    fn early(&self) -> f64 {
        let at = nearest(self.freedom.iter().map(|p| p[0]), EARLY);
        self.freedom.get(at).map_or(f64::NAN, |p| p[1])
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
            freedom: freedom(level, material)?,
        });
    }
    // The rods come first, from the coarsest mesh to the finest.
    let ends = [0, levels.len() - 1].map(|k| mean(&all[k].values(bending)));
    ensure!(
        effort == Effort::Quick || ends[0] < ends[1],
        "the total bending of rods does not grow with the mesh: {ends:?}"
    );
    let alt =
        "How freely the sheet falls in its first moments, and its total bending, by mesh level";
    Ok(Softness {
        picture: Picture::svg("fig12-softness", &plots(&all), alt),
        table: table(&all),
        facts: Value::Array(
            all.iter()
                .map(|l| json!({ "level": l.level, "sheet": l.sheet, "freedom": l.early(), "freedom_at": EARLY, "bump": BUMP, "falls": l.falls }))
                .collect(),
        ),
    })
}

fn plots(all: &[Level]) -> Charts {
    let size = [140.0, 118.0];
    let sheets = all.chunk_by(|a, b| a.sheet == b.sheet);
    let mut charts = Vec::new();
    let mut series = Vec::new();
    for (levels, (colour, marker, aside)) in sheets.zip([
        (palette::VERMILION, Marker::Disc, -0.07),
        (palette::BLUE, Marker::Square, 0.07),
    ]) {
        let sheet = &levels[0].sheet;
        let x = Axis::linear(&format!("time (s), {sheet}"), [0.03, 0.12]);
        let y = Axis::linear("freedom of the fall", [0.0, 1.0]);
        let freedom = levels.iter().flat_map(freedom_series).collect();
        charts.push(Chart::new(x, y, size, freedom));
        let bar = |l: &Level| {
            let values = l.values(bending);
            let [low, high] = extremes(values.iter().copied()).unwrap_or_default();
            [f64::from(l.level) + aside, low, mean(&values), high]
        };
        let bars: Vec<[f64; 4]> = levels.iter().map(bar).collect();
        let means = bars.iter().map(|b| [b[0], b[2]]).collect();
        series.push(Series {
            bars,
            ..Series::line(sheet, colour, means).marked(marker)
        });
    }
    let top = series.iter().flat_map(|s| &s.bars).map(|b| b[3]);
    let top = 1.1 * top.fold(0.0, f64::max);
    let last = all.last().map_or(0, |l| l.level);
    let ticks = (0..=last).map(|l| (f64::from(l), mesh_name(l)));
    charts.push(Chart::new(
        Axis::named("mesh", [-0.25, f64::from(last) + 0.25], ticks.collect()),
        Axis::linear("total bending (rad · side)", [0.0, top]),
        size,
        series,
    ));
    Charts::row(charts)
}

fn bending(fall: &Member) -> f64 {
    fall.mean_bending
}

/// A line with few symbols, and its entry of the legend.
fn freedom_series(l: &Level) -> [Series; 3] {
    let looks = [
        (palette::ORANGE, Marker::Diamond),
        (palette::VERMILION, Marker::Square),
        (palette::GREEN, Marker::Triangle),
        (palette::BLUE, Marker::Disc),
    ];
    let (colour, marker) = looks[l.level as usize % looks.len()];
    let marked = l.freedom.iter().skip(20).step_by(40).copied();
    [
        Series::line("", colour, l.freedom.clone()),
        Series::dots("", colour, marker, marked.collect()),
        Series::line(&l.name(), colour, Vec::new()).marked(marker),
    ]
}

/// What the table shows.
const ABOUT: &str = "\
    Softness by mesh. Freedom of the fall, soon after the sheet was let go from exactly flat: how far its centre of mass has sunk, \
    between the same masses welded to a rigid plate and free fall. The other columns: mean (range) of falls that start flat but for random \
    displacements of a small part of an edge. Total bending, averaged over the run: sum of edge length (in sides) times fold angle, which does not depend \
    on how many edges share a bend. Width: largest horizontal distance at the end. Depth of the centre of mass at the end, in sides: it \
    depends on the folds in which a sheet happens to come to rest, more than on the mesh. The last rows are for \
    comparison: the limits of the fall, and the depth that no unstretchable sheet passes.";

fn table(all: &[Level]) -> Table {
    let range = |l: &Level, digits: usize, f: fn(&Member) -> f64| {
        let v = l.values(f);
        let (mean, [low, high]) = (mean(&v), extremes(v.into_iter()).unwrap_or_default());
        format!("{mean:.digits$} ({low:.digits$}–{high:.digits$})")
    };
    let early = format!("freedom of the fall at {EARLY} s");
    let falls = format!("falls, displaced by up to {:.1} % of an edge", 100.0 * BUMP);
    let mut table = Table::of(
        ABOUT,
        all,
        columns! { l;
            "mesh" => l.name(),
            "sheet" => l.sheet.as_str(),
            "V/F" => format!("{}/{}", l.vertices, l.faces),
            "internal DOF of rods" => l.internal.to_string(),
            &early => whole_percent(l.early()),
            "total bending" => range(l, 2, bending),
            "width" => range(l, 2, |m| m.shape.extent),
            "depth of the centre" => range(l, 3, |m| m.shape.centre_depth),
            &falls => l.falls.len(),
        },
    );
    let depth = |depth: f64| (7, format!("{depth:.4}"));
    let freedom = |part: f64| (4, whole_percent(part));
    table.push_some("rigid plate", &[freedom(0.0), depth(runs::PLATE)]);
    table.push_some("free fall", &[freedom(1.0)]);
    table.push_some("deepest unstretchable", &[depth(runs::LIMIT)]);
    table
}
