//! Fig. 13: a square die punches a sheet of metal upwards.

use super::show::View;
use super::{Effort, Made, Picture, Play, course, measured};
use crate::draw::{Axis, Chart, Charts, Series, palette};
use crate::runs::{FigureScene, Run};
use crate::store::Store;
use anyhow::Result;
use serde_json::json;

/// The scene of the figure.
pub(super) fn scene(effort: Effort) -> Result<FigureScene> {
    let quick = ["sheet.mesh.square.level=1", "stop.time=0.13333333333333333"];
    let edits = effort.quick_or(quick.map(str::to_owned).to_vec(), Vec::new());
    FigureScene::of("fig13", "stamping", &edits)
}

/// The numbers of the die and the frame among the bodies; the holders follow.
const DIE: usize = 0;
const FRAME: usize = 1;

/// Strokes of the pictures as parts of the whole.
const STROKES: [f64; 6] = [0.0, 0.3, 0.5, 0.7, 0.85, 1.0];

/// How the run is shown. The holders would hide the sheet.
const VIEW: View = View {
    azimuth: -58.0,
    elevation: 30.0,
    distance: 3.0,
    columns: 3,
    pins: Vec::new(),
    bodies: &[DIE, FRAME],
    depth: 0.03,
};

/// The page that plays a run.
pub(super) fn page(figure: u8, run: &Run, effort: Effort) -> Result<Play> {
    let label = if run.scene.scene().contact.self_contact {
        "stamping"
    } else {
        "stamping, the sheet passing through itself"
    };
    VIEW.play(run, effort, figure, label)
}

pub(super) fn make(store: &Store) -> Result<Made> {
    let whole = Run::of(store, scene(store.effort)?)?;
    let (scene, run) = (whole.scene.scene(), &whole.summary);
    let (density, blank, forces) = (scene.sheet.areal_density(), &whole.sheet, whole.forces(DIE));
    let value = |key: &str| whole.scene.value::<f64>(key);
    let rise = |key: &str| value(&format!("/obstacle/0/motion/z/ramp/{key}"));
    let stroke = rise("to")? - rise("from")?;
    let full = rise("end")? - rise("begin")?;
    let speed = stroke / full;
    // The bottom of the holders above the top of the frame.
    let thickness = value("/obstacle/2/shape/box/size/2")?;
    let bottom = value("/obstacle/2/pose/position/2")? - 0.5 * thickness;
    let clearance = bottom - value("/obstacle/1/shape/frame/top")?;
    // The sheet presses the die down.
    let curve: Vec<[f64; 2]> = forces
        .iter()
        .filter(|f| f[0] <= full)
        .map(|f| [1e3 * speed * f[0], -f[3]])
        .collect();
    let peak = curve.iter().map(|p| p[1]).fold(0.0, f64::max);
    let weight = 9.8 * density * blank.area();
    let pressed =
        "A square die rises through the opening of a frame and punches the sheet that lies on it";
    let times = STROKES.map(|s| s * full);
    let plot = plot(&curve, weight, 1e3 * stroke, peak);
    let alt = "Force of the sheet on the die over its stroke";
    let millimetres = |length: f64| format!("{:.0} mm", 1e3 * length);
    let mut rows = vec![
        (
            "blank",
            format!(
                "{:.1} m wide, {density:.1} kg/m² (half a millimetre of steel)",
                blank.area().sqrt()
            ),
        ),
        (
            "opening of the frame",
            millimetres(value("/obstacle/1/shape/frame/opening")?),
        ),
        (
            "width of the die",
            millimetres(value("/obstacle/0/shape/box/size/0")?),
        ),
        (
            "speed and stroke of the die",
            format!("{}/s, {}", millimetres(speed), millimetres(stroke)),
        ),
        (
            "width of the holders, and their height above the frame",
            format!(
                "{}, {}",
                millimetres(value("/obstacle/2/shape/box/size/1")?),
                millimetres(clearance)
            ),
        ),
        (
            "friction on all tools",
            scene.obstacle[DIE].friction.to_string(),
        ),
        ("largest force on the die", format!("{peak:.1} N")),
        ("weight of the blank", format!("{weight:.1} N")),
    ];
    rows.extend(course(run));
    Ok(Made {
        title: "Sheet metal stamping".into(),
        paper: "A square die punches a sheet (M³, 289/512) upwards; the sequence shows how the buckled developable surface is formed.".into(),
        here: "Four holders above the sides of the frame, which are not drawn, let the blank draw in at the sides and buckle at the \
               corners; the holding conditions of the paper are not known."
            .into(),
        tables: vec![measured(rows)],
        pictures: vec![
            VIEW.picture(&whole, store.effort, ["fig13.png", pressed], &times)?,
            Picture::svg("fig13-force", &plot, alt),
        ],
        pages: vec![page(13, &whole, store.effort)?],
        facts: json!({ "run": run, "peak_force": peak, "weight": weight, "stroke_mm_and_force_n": curve }),
    })
}

fn plot(curve: &[[f64; 2]], weight: f64, stroke: f64, peak: f64) -> Charts {
    let x = Axis::linear("stroke (mm)", [0.0, stroke]);
    let y = Axis::linear("force on the die (N)", [0.0, 1.1 * peak.max(weight)]);
    let series = vec![
        Series::line("force", palette::BLUE, curve.to_vec()),
        Series::guide("weight", vec![[0.0, weight], [stroke, weight]]),
    ];
    Chart::new(x, y, [230.0, 130.0], series).into()
}
