//! Fig. 13: a square die punches a sheet of metal upwards.

use super::show::View;
use super::{Effort, FigureRow, Made, Picture, Play, compared, course, of_ensembles, rows};
use crate::draw::{Axis, Chart, Charts, Series, Viewpoint, palette};
use crate::runs::{Ensemble, FigureScene, Run, Spread, members, spreads};
use crate::store::Store;
use anyhow::{Result, ensure};
use serde::{Deserialize, Serialize};

/// What the elastic blank is made of.
const METAL: &str = "steel sheet";

/// The scene that the paper shows, cut short and with a coarse mesh where the effort is small.
pub(super) fn scene(effort: Effort) -> Result<FigureScene> {
    let quick = ["sheet.mesh.square.level=1", "stop.time=0.13333333333333333"];
    let edits = effort.quick_or(&quick[..], &[]).iter();
    let edits: Vec<String> = edits.map(|e| (*e).to_owned()).collect();
    FigureScene::of("fig13", "stamping", &edits)
}

/// Steel presses the die by this factor more than rods do, at least.
const HARDER: f64 = 10.0;

/// The numbers of the die and the frame among the bodies; the holders follow.
const DIE: usize = 0;
const FRAME: usize = 1;

/// Strokes of the pictures as parts of the whole.
const STROKES: [f64; 6] = [0.0, 0.3, 0.5, 0.7, 0.85, 1.0];

/// How the run is shown. The holders would hide the sheet.
const VIEW: View = View {
    from: Viewpoint {
        azimuth: -58.0,
        elevation: 30.0,
        distance: 3.0,
        depth: 0.03,
    },
    columns: 3,
    pins: Vec::new(),
    bodies: &[DIE, FRAME],
};

/// The page that plays a run.
fn page(run: &Run, effort: Effort) -> Result<Play> {
    let label = format!("stamping, {}", run.scene.sheet_name());
    VIEW.play(run, effort, 13, &label)
}

/// A sheet that has been punched.
struct Punched {
    run: Run,
    stroke: Stroke,
    all: Ensemble<Curve>,
    /// The weight of the sheet, newtons.
    weight: f64,
}

/// How the die moves.
#[derive(Clone, Copy, Debug)]
struct Stroke {
    /// The whole stroke, metres, and the time that it takes, seconds.
    length: f64,
    time: f64,
}

/// Stroke (mm) and force on the die (N).
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Curve(Vec<[f64; 2]>);

impl Curve {
    fn of(run: &Run, stroke: Stroke) -> Self {
        // The sheet presses the die down.
        let forces = run.forces(DIE).into_iter().filter(|f| f[0] <= stroke.time);
        let per_second = 1e3 * stroke.length / stroke.time;
        Self(forces.map(|f| [per_second * f[0], -f[3]]).collect())
    }

    fn peak(&self) -> f64 {
        self.0.iter().map(|p| p[1]).fold(0.0, f64::max)
    }

    /// The largest force in a part of the stroke, mm.
    fn peak_within(&self, [from, to]: [f64; 2]) -> f64 {
        let within = self.0.iter().filter(|p| p[0] > from && p[0] <= to);
        within.map(|p| p[1]).fold(0.0, f64::max)
    }
}

/// Parts of the stroke for each of which the chart shows the largest force.
const PARTS: u32 = 14;

impl Punched {
    fn of(store: &Store, scene: FigureScene) -> Result<Self> {
        let run = Run::of(store, scene)?;
        let rise = |key: &str| {
            let key = format!("/obstacle/0/motion/z/ramp/{key}");
            run.scene.value::<f64>(&key)
        };
        let stroke = Stroke {
            length: rise("to")? - rise("from")?,
            time: rise("end")? - rise("begin")?,
        };
        let curve = |run: &Run| Ok(Curve::of(run, stroke));
        Ok(Self {
            all: Ensemble::of(store, &run, members(store.effort), curve)?,
            weight: 9.8 * run.scene.scene().sheet[0].areal_density() * run.sheet.area(),
            stroke,
            run,
        })
    }

    /// The largest force on the die, newtons.
    fn peak(&self) -> Spread {
        self.all.spread(Curve::peak)
    }

    fn picture(&self, file: &str, effort: Effort) -> Result<Picture> {
        let sheet = self.run.scene.sheet_name();
        let alt = format!(
            "A square die rises through the opening of a frame and punches the sheet that lies on it, {sheet}"
        );
        let times = STROKES.map(|s| s * self.stroke.time);
        VIEW.picture(&self.run, effort, [file, &alt], &times)
    }

    fn rows(&self) -> Result<Vec<FigureRow>> {
        let scene = &self.run.scene;
        let value = |key: &str| scene.value::<f64>(key);
        // The bottom of the holders above the top of the frame.
        let thickness = value("/obstacle/2/shape/box/size/2")?;
        let bottom = value("/obstacle/2/pose/position/2")? - 0.5 * thickness;
        let clearance = bottom - value("/obstacle/1/shape/frame/top")?;
        let millimetres = |length: f64| format!("{:.0} mm", 1e3 * length);
        let blank = format!(
            "{:.1} m wide, {:.1} kg/m² (half a millimetre of steel)",
            self.run.sheet.area().sqrt(),
            scene.scene().sheet[0].areal_density()
        );
        let Stroke { length, time } = self.stroke;
        let motion = [length / time, length].map(millimetres);
        let holders = [value("/obstacle/2/shape/box/size/1")?, clearance].map(millimetres);
        let mut rows = rows! {
            "blank" => blank,
            "opening of the frame" => millimetres(value("/obstacle/1/shape/frame/opening")?),
            "width of the die" => millimetres(value("/obstacle/0/shape/box/size/0")?),
            "speed and stroke of the die" => motion.join("/s, "),
            "width of the holders, and their height above the frame" => holders.join(", "),
            "friction on all tools" => scene.scene().obstacle[DIE].friction.to_string(),
            "largest force on the die, N" => self.peak().text(|f| format!("{f:.1}")),
            "runs of the ensemble" => self.all.len().to_string(),
            "weight of the blank" => format!("{:.1} N", self.weight),
        };
        rows.extend(course(&self.run.summary));
        Ok(rows)
    }

    /// Its force on the die over the stroke: of the run that is shown, and of the ensemble.
    fn plot(&self) -> Chart {
        let stroke = 1e3 * self.stroke.length;
        let x = Axis::linear("stroke (mm)", [0.0, stroke]);
        let label = format!("force on the die (N), {}", self.run.scene.sheet_name());
        let top = self.peak().range[1].max(self.weight);
        let y = Axis::linear(&label, [0.0, 1.1 * top]);
        let part = |k: u32| stroke * f64::from(k) / f64::from(PARTS);
        let largest = (0..PARTS).map(|k| {
            let ends = [part(k), part(k + 1)];
            let force = self.all.spread(|curve| curve.peak_within(ends));
            (0.5 * (ends[0] + ends[1]), force)
        });
        let shown = Curve::of(&self.run, self.stroke).0;
        let series = vec![
            Series::line("shown run", palette::SKY, shown),
            spreads(
                0,
                &format!("{} runs, largest by parts", self.all.len()),
                largest,
            ),
            Series::guide("weight", vec![[0.0, self.weight], [stroke, self.weight]]),
        ];
        Chart::new(x, y, [165.0, 132.0], series)
    }
}

pub(super) fn make(store: &Store) -> Result<Made> {
    let effort = store.effort;
    let rods = scene(effort)?;
    let steel = Punched::of(store, rods.made_of(METAL)?)?;
    let rods = Punched::of(store, rods)?;
    let peaks = [&steel, &rods].map(|punched| punched.peak().median);
    ensure!(
        effort == Effort::Quick || peaks[0] > HARDER * peaks[1],
        "steel and rods press the die with up to {peaks:?} N"
    );
    let alt = "Force of the sheet on the die over its stroke";
    let plot = Charts::row([rods.plot(), steel.plot()]);
    Ok(Made {
        title: "Sheet metal stamping",
        paper: "A square die punches a sheet (M³, 289/512) upwards; the sequence shows how the buckled developable surface is formed.",
        here: "Four holders above the sides of the frame, which are not drawn, let the blank draw in at the sides and buckle at the \
               corners; the holding conditions of the paper are not known. The first sequence is of rods, the second of an elastic steel sheet, \
               which bends as half a millimetre of steel does and never yields: it presses the die far more than rods do.",
        tables: vec![of_ensembles(compared(
            &["rods", METAL],
            &[rods.rows()?, steel.rows()?],
        ))],
        pictures: vec![
            rods.picture("fig13.png", effort)?,
            steel.picture("fig13-elastic.png", effort)?,
            Picture::svg("fig13-force", &plot, alt),
        ],
        pages: vec![page(&rods.run, effort)?, page(&steel.run, effort)?],
    })
}
