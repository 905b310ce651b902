//! Fig. 12, and after: a sheet of paper that has been crumpled is pressed flat and let go. Marks that stay do
//! not let it lie flat again.

use super::balance::{self, Balance};
use super::show::View;
use super::{
    Effort, FigureRow, Picture, Play, Table, caption, compared, course, height, of_ensembles, rows,
};
use crate::draw::{
    Anchor, Colour, Drawing, Stroke, TEXT, Vertical, Viewpoint, flat_edges, flat_faces, palette,
    row,
};
use crate::runs::{Ensemble, FigureScene, Run};
use crate::store::Store;
use anyhow::{Result, ensure};
use serde::{Deserialize, Serialize};
use std::slice;

/// Times of the pictures, seconds: before, between six plates, freed, pressed flat, and at the end.
const TIMES: [f64; 5] = [0.0, 1.2, 1.6, 2.5, 4.0];

/// How the runs are shown, without the plates.
const VIEW: View = View {
    from: Viewpoint {
        azimuth: -62.0,
        elevation: 24.0,
        distance: 0.7,
        depth: 0.0,
    },
    columns: 5,
    pins: Vec::new(),
    bodies: &[],
};

/// What Fig. 12 says of marks that stay.
pub(super) struct Lasting {
    pub(super) pictures: Vec<Picture>,
    pub(super) pages: Vec<Play>,
    pub(super) tables: Vec<Table>,
}

/// The numbers of a sheet that was crumpled and pressed flat.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Facts {
    /// Its height above its lowest point when it is pressed, and at the end, metres.
    pressed: f64,
    height: f64,
    /// Dissipated by yielding, joules.
    dissipated: f64,
    /// What the energy balance lacks at the end, joules.
    drift: f64,
    /// Of a sheet that yields.
    marks: Option<PlasticMarks>,
}

/// Where the plastic curvature of a sheet lies.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct PlasticMarks {
    /// The largest one, 1/m.
    largest: f64,
    /// The smallest part of the area that carries half of the integral of the square of the plastic
    /// curvature.
    half: f64,
}

/// Sizes of the plastic curvatures of all faces at the end of a run (1/m), none of a sheet that does not
/// yield.
fn curvatures(run: &Run) -> Option<Vec<f64>> {
    let last = run.trajectory.len() - 1;
    let principal = run.trajectory.plastic_curvatures(last)?;
    let faces = principal.as_chunks::<2>().0.iter();
    Some(faces.map(|[a, b]| a.hypot(*b)).collect())
}

impl PlasticMarks {
    fn of(run: &Run) -> Option<Self> {
        let sizes = curvatures(run)?;
        let areas = run.sheet.face_areas();
        let mut faces: Vec<(f64, f64)> = sizes.iter().copied().zip(areas.iter().copied()).collect();
        faces.sort_by(|a, b| b.0.total_cmp(&a.0));
        let half = 0.5 * faces.iter().map(|(k, area)| k * k * area).sum::<f64>();
        let (mut carried, mut area) = (0.0, 0.0);
        for (k, part) in &faces {
            if carried >= half {
                break;
            }
            carried += k * k * part;
            area += part;
        }
        Some(Self {
            largest: faces.first().map_or(0.0, |face| face.0),
            half: area / run.sheet.area(),
        })
    }
}

impl Facts {
    fn of(run: &Run) -> Self {
        let times = run.trajectory.times();
        let at = |t: f64| {
            let frame = times.partition_point(|time| *time < t - 1e-9);
            let x = run.trajectory.frame(frame.min(times.len() - 1));
            height(x.unwrap_or_default())
        };
        Self {
            pressed: at(TIMES[3]),
            height: at(TIMES[4]),
            dissipated: run.summary.energy.plastic,
            drift: run.summary.energy.drift,
            marks: PlasticMarks::of(run),
        }
    }

    /// The part of the area that carries half of the squared plastic curvature; all of it without marks.
    fn half(&self) -> f64 {
        self.marks.map_or(1.0, |m| m.half)
    }

    fn largest(&self) -> f64 {
        self.marks.map_or(0.0, |m| m.largest)
    }
}

/// A run, and what was measured of it and of its neighbours.
struct Crumpled {
    label: String,
    run: Run,
    all: Ensemble<Facts>,
}

impl Crumpled {
    fn of(store: &Store, label: &str, scene: FigureScene) -> Result<Self> {
        let run = Run::of(store, scene)?;
        let cells: usize = run.scene.value("/sheet/mesh/rectangle/columns")?;
        Ok(Self {
            label: format!("{label}, {cells} × {cells} cells"),
            all: Ensemble::of(store, &run, MEMBERS, |run| Ok(Facts::of(run)))?,
            run,
        })
    }

    fn rows(&self) -> Vec<FigureRow> {
        let millimetres = |value: fn(&Facts) -> f64| {
            let spread = self.all.spread(value);
            spread.text(|length| format!("{:.2}", 1e3 * length))
        };
        let of_marks = |value: fn(&Facts) -> f64, show: fn(f64) -> String| {
            let yields = self.run.scene.scene().sheet[0].yields();
            yields.map_or("–".into(), |_| self.all.spread(value).text(show))
        };
        let millijoules = |energy: f64| format!("{:.1}", 1e3 * energy);
        let mut rows = rows! {
            "runs of the ensemble" => self.all.len().to_string(),
            "height when it is pressed, mm" => millimetres(|f| f.pressed),
            "height at the end, mm" => millimetres(|f| f.height),
            "dissipated by yielding, mJ" => self.all.spread(|f| f.dissipated).text(millijoules),
            "error of the energy balance, mJ" => self.all.spread(|f| f.drift).text(millijoules),
            "largest plastic curvature, 1/m" => of_marks(Facts::largest, |k| format!("{k:.0}")),
            "part of the area with half of the squared plastic curvature" =>
                of_marks(Facts::half, |part| format!("{:.1} %", 100.0 * part)),
        };
        rows.extend(course(&self.run.summary));
        rows
    }

    /// The flat sheet, darker where its bends stay; `full` is the curvature of the darkest colour, 1/m.
    fn map(&self, full: f64) -> Drawing {
        let mut drawing = Drawing::new();
        let (sheet, sizes) = (&self.run.sheet, curvatures(&self.run).unwrap_or_default());
        let scale = 200.0 / sheet.area().sqrt();
        flat_faces(&mut drawing, sheet, scale, |f| {
            let size = sizes.get(f.index()).copied().unwrap_or_default();
            shade(size / full)
        });
        flat_edges(&mut drawing, sheet, scale, |e| {
            let is_rim = sheet.topology().is_boundary_edge(e);
            is_rim.then(|| Stroke::new(palette::GREY, 0.6))
        });
        let below = drawing.bounds();
        let at = [below.centre()[0], below.min[1] - 6.0];
        caption(&mut drawing, at, TEXT, slice::from_ref(&self.label));
        drawing
    }
}

/// The colour of a part of the largest plastic curvature.
fn shade(part: f64) -> Colour {
    palette::WHITE.mix(palette::VERMILION, part.min(1.0))
}

/// The bar that says which colour is which plastic curvature, up to `full` (1/m), as high as the maps.
fn colour_bar(full: f64) -> Drawing {
    const STRIPS: u32 = 64;
    let (width, height) = (10.0, 200.0);
    let mut drawing = Drawing::new();
    let rectangle = |low: f64, high: f64| [[0.0, low], [width, low], [width, high], [0.0, high]];
    for k in 0..STRIPS {
        let [low, high] = [k, k + 1].map(|k| height * f64::from(k) / f64::from(STRIPS));
        drawing.polygon(&rectangle(low, high), shade(low / height));
    }
    drawing.outline(&rectangle(0.0, height), Stroke::new(palette::GREY, 0.6));
    for part in [0.0, 0.5, 1.0] {
        let at = [width + 4.0, part * height];
        let unit = if part == 1.0 { " per m" } else { "" };
        let text = format!("{:.0}{unit}", part * full);
        drawing.text(
            at,
            &text,
            TEXT,
            Anchor::Start,
            Vertical::Centre,
            palette::INK,
        );
    }
    drawing
}

/// Cells along a side of the coarser and of the finer sheet; the elastic one is as fine as the finer.
fn cells(effort: Effort) -> [usize; 2] {
    effort.quick_or([6, 8], [16, 24])
}

/// The scene with so many cells along each side.
fn scene(cells: usize, effort: Effort) -> Result<FigureScene> {
    let mesh = ["columns", "rows"].map(|key| format!("sheet.mesh.rectangle.{key}={cells}"));
    let mut edits = mesh.to_vec();
    if effort == Effort::Quick {
        edits.push("stop.time=0.2".to_owned());
    }
    FigureScene::of("fig12-marks", &format!("crumple-marks-{cells}"), &edits)
}

/// Members of the ensembles, of which a run takes half a minute and more.
const MEMBERS: usize = 3;

/// Factors by which steps are shorter of the runs whose balance of energy is compared.
const FACTORS: [u32; 2] = [1, 4];

/// Makes the runs.
pub(super) fn make(store: &Store) -> Result<Lasting> {
    let effort = store.effort;
    let [coarse, fine] = cells(effort);
    let [coarse, fine] = [scene(coarse, effort)?, scene(fine, effort)?];
    let springs = fine.without_yield("crumple-marks-elastic")?;
    let springs = Crumpled::of(store, "never yields", springs)?;
    let coarse = Crumpled::of(store, "yields", coarse)?;
    let stays = Crumpled::of(store, "yields", fine)?;
    let all = [&springs, &coarse, &stays];
    if effort != Effort::Quick {
        check(all)?;
    }
    let factors = effort.quick_or(&FACTORS[..1], &FACTORS);
    let balance = Balance::by_step(store, &coarse.label, &coarse.run.scene, factors)?;
    let ends = all.map(|c| (c.label.clone(), &c.run));
    let shown = [&coarse, &stays].map(|c| Facts::of(&c.run).largest());
    let full = shown.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let maps = row(&[coarse.map(full), stays.map(full), colour_bar(full)], 14.0);
    let sequence = "Paper that yields is crumpled between six plates, which are not drawn, freed, pressed flat and let go";
    let left =
        "The sheets at the end: elastic paper lies flat, paper that yields stands on its marks";
    let crescents =
        "Where plastic curvature stays, in the flat sheet: at folds and around their corners";
    let page = |c: &Crumpled| VIEW.play(&c.run, effort, 12, &format!("pressed flat, {}", c.label));
    Ok(Lasting {
        pictures: vec![
            VIEW.picture(&stays.run, effort, ["fig12-yields.png", sequence], &TIMES)?,
            VIEW.ends(&ends, effort, ["fig12-released.png", left])?,
            Picture::svg("fig12-plastic", &maps, crescents),
        ],
        pages: vec![page(&springs)?, page(&stays)?],
        tables: vec![
            of_ensembles(compared(
                &all.map(|c| &c.label[..]),
                &all.map(Crumpled::rows),
            )),
            balance::table(&balance),
        ],
    })
}

/// What the figure shows of the springy sheet, of the coarser one that yields and of the finer one.
fn check([springs, coarse, stays]: [&Crumpled; 3]) -> Result<()> {
    let [flat, low, high] = [springs, coarse, stays].map(|c| c.all.median(|f| f.height));
    let pressed = stays.all.median(|f| f.pressed);
    ensure!(
        flat < pressed && pressed < high,
        "marks do not stay: the sheet that yields is {high:e} m high at the end, the elastic one {flat:e} m"
    );
    ensure!(
        low < high,
        "the height does not grow with the mesh: {low:e} m and {high:e} m"
    );
    // Where bends were spread evenly, half of the area would carry half of the integral.
    let half = stays.all.median(Facts::half);
    ensure!(
        half > 0.0 && half < 0.25,
        "marks are not localised: half of the squared plastic curvature takes {half} of the area"
    );
    Ok(())
}
