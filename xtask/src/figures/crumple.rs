//! Figs. 11 and 12: a sheet of paper held at a corner falls and crumples.

use super::show::View;
use super::softness::{self, Falls};
use super::{Effort, FigureRow, Made, Picture, Play, compared, course, of_ensembles, rows};
use crate::draw::{Charts, Viewpoint, mesh_name};
use crate::runs::{self, FigureScene, Hanging, Run};
use crate::store::Store;
use anyhow::Result;
use std::ops::Range;

/// What elastic sheets are made of.
pub(super) const PAPER_SHEET: &str = "office paper";

/// Times of the pictures, seconds. The fall takes the first third of a second; then the sheet swings,
/// crumples and comes to rest.
const TIMES: [f64; 10] = [0.0, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.6, 8.0];

/// The scene of the figure with mesh M^level, with contact of the sheet with itself.
pub(super) fn scene(level: u32, effort: Effort) -> Result<FigureScene> {
    let mut edits = Vec::new();
    let file = if level == 1 { "fig11" } else { "fig12" };
    if level != 1 && level != 2 {
        edits.push(format!("sheet.mesh.square.level={level}"));
    }
    if effort == Effort::Quick {
        edits.push("stop.time=0.2".to_owned());
    }
    FigureScene::of(file, &format!("crumple-m{level}-contact"), &edits)
}

/// Meshes of the table of Fig. 12.
fn levels(effort: Effort) -> Range<u32> {
    effort.quick_or(0..3, 0..4)
}

pub(super) fn make(figure: u8, level: u32, store: &Store) -> Result<Made> {
    let levels = match figure {
        11 => level..level + 1,
        _ => levels(store.effort),
    };
    let all: Vec<Falls> = levels.map(|l| Falls::of(l, store)).collect::<Result<_>>()?;
    // Of ensembles: a single fall says little.
    if store.effort == Effort::Full {
        all.iter().try_for_each(Falls::check)?;
        softness::check(&all)?;
    }
    // The mesh of the paper's figure and finer ones.
    let shown: Vec<&Falls> = all.iter().filter(|f| f.level >= level).collect();
    let file = |kind: &str| format!("fig{figure:02}{kind}.png");
    let mut made = Made {
        title: ["Crumpled paper, M¹", "Crumpled paper, M²"][level as usize - 1],
        paper: PAPER[level as usize - 1],
        here: HERE[level as usize - 1],
        ..Made::default()
    };
    for falls in &shown {
        let finer = match falls.level > level {
            true => format!("-m{}", falls.level),
            false => String::new(),
        };
        for (run, kind) in falls.runs.iter().zip(["", "-elastic"]) {
            let file = file(&format!("{finer}{kind}"));
            made.pictures.push(picture(&file, run, store.effort)?);
            made.pages.push(page(figure, run, store.effort)?);
        }
    }
    for falls in shown.iter().take(1) {
        let columns = [0, 1].map(|k| describe(falls, k));
        let [rods, paper] = columns;
        let table = compared(&["rods", PAPER_SHEET], &[rods?, paper?]);
        made.tables.push(of_ensembles(table));
    }
    if figure == 12 {
        let alt = "Total bending of falling sheets by mesh, of rods and of paper";
        let plot = Charts::from(softness::plot(&all));
        let plot = Picture::svg("fig12-softness", &plot, alt);
        made.pictures.push(plot);
        made.tables.push(softness::table(&all));
    }
    Ok(made)
}

const PAPER: [&str; 2] = [
    "A piece of paper modelled by M¹ is held at its left-upper corner, falls and crumples.",
    "The same with the finer mesh M², which looks softer, as more degrees of freedom let it be; crumpling leaves very localised \
     marks with a typical crescent shape (Amar and Pomeau).",
];

const HERE: [&str; 2] = [
    "A square of office paper falls from exactly flat and horizontal (the side that was above is bright, the other one dark), first as \
     rods, which do not resist bending and crumple, then as an elastic sheet, which bends as office paper does and does not crumple.",
    "The crescent marks of which the paper speaks do not come of its model, in which nothing of a bend stays: \
     rods, which do not resist bending, crumple as they fall, in the median more on M² and M³ (which is not in the paper) than on coarser \
     meshes, and an elastic sheet of office paper does not. (Bends stay where a sheet yields, docs/materials.md.)",
];

/// What was measured of the falls of one sheet.
fn describe(falls: &Falls, sheet: usize) -> Result<Vec<FigureRow>> {
    let run = &falls.runs[sheet];
    let (scene, s) = (&run.scene, &run.summary);
    let (hanging, mass) = (Hanging::of(scene)?, runs::mass(scene)?);
    let mut rows = rows! {
        "sheet" => format!(
            "{:.0} mm, {:.0} g/m² ({:.2} g), lumped masses", 1e3 * hanging.side,
            1e3 * mass / hanging.sheet.area(), 1e3 * mass
        ),
        "method" => format!(
            "BDF2, damping {:.0}/s, friction with itself {}", scene.scene().sheet[0].damping, scene.scene().contact.friction
        ),
    };
    rows.extend(course(s));
    rows.extend(rows! {
        "kinetic energy at the end, of the potential energy released" => format!("{:.0e}", s.motion_left),
    });
    rows.extend(falls.rows(sheet));
    Ok(rows)
}

/// How a run is shown, and the level of its mesh.
fn view(run: &Run) -> Result<(View, u32)> {
    let hanging = Hanging::of(&run.scene)?;
    let view = View {
        from: Viewpoint {
            azimuth: -62.0,
            elevation: 17.0,
            distance: 6.0 * hanging.side,
            depth: 0.0,
        },
        columns: 5,
        pins: vec![hanging.pin],
        bodies: &[],
    };
    Ok((view, hanging.level))
}

/// The page that plays a run.
fn page(figure: u8, run: &Run, effort: Effort) -> Result<Play> {
    let (view, level) = view(run)?;
    let level = mesh_name(level);
    let label = format!("crumpled paper, {level}, {}", run.scene.sheet_name());
    view.play(run, effort, figure, &label)
}

/// The sequence of a run.
fn picture(file: &str, run: &Run, effort: Effort) -> Result<Picture> {
    let (view, level) = view(run)?;
    let sheet = run.scene.sheet_name();
    let alt = format!(
        "A sheet of paper held at its left-upper corner falls from flat, mesh M{level}, {sheet}"
    );
    view.picture(run, effort, [file, &alt], &TIMES)
}
