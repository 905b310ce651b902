//! Figs. 11 and 12: a sheet of paper held at a corner falls and crumples.

use super::show::View;
use super::{Effort, FigureRow, Made, Picture, Play, compared, course, rows};
use crate::draw::{Viewpoint, mesh_name};
use crate::runs::{self, FigureScene, Hanging, Run, SheetShape};
use crate::store::Store;
use anyhow::{Result, ensure};

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

/// The same passing through itself.
fn without_contact(level: u32, effort: Effort) -> Result<FigureScene> {
    scene(level, effort)?.without_self_contact(&format!("crumple-m{level}"))
}

/// The same with an elastic sheet of paper.
fn elastic(level: u32, effort: Effort) -> Result<FigureScene> {
    scene(level, effort)?.made_of(PAPER_SHEET)
}

pub(super) fn make(figure: u8, level: u32, store: &Store) -> Result<Made> {
    let run = Run::of(store, scene(level, store.effort)?)?;
    let elastic = Run::of(store, elastic(level, store.effort)?)?;
    let columns = [describe(&run)?, describe(&elastic)?];
    let [rods_bent, paper_bent] = [end_shape(&run)?.bending, end_shape(&elastic)?.bending];
    ensure!(
        store.effort == Effort::Quick || paper_bent < CRUMPLED * rods_bent,
        "paper crumples, too: its total bending is {paper_bent:.2}, and that of rods {rods_bent:.2}, rad times the side"
    );
    let file = |kind: &str| format!("fig{figure:02}{kind}.png");
    let mut made = Made {
        title: ["Crumpled paper, M¹", "Crumpled paper, M²"][level as usize - 1],
        paper: PAPER[level as usize - 1],
        here: HERE[level as usize - 1],
        pictures: vec![
            picture(&file(""), &run, store.effort)?,
            picture(&file("-elastic"), &elastic, store.effort)?,
        ],
        pages: vec![
            page(figure, &run, store.effort)?,
            page(figure, &elastic, store.effort)?,
        ],
        tables: vec![compared(&["rods", PAPER_SHEET], &columns)],
    };
    if figure == 12 {
        add_softness_and_marks(&mut made, store)?;
    }
    Ok(made)
}

/// A sheet with less than this part of the total bending of rods at the end is not crumpled.
const CRUMPLED: f64 = 0.1;

const PAPER: [&str; 2] = [
    "A piece of paper modelled by M¹ is held at its left-upper corner, falls and crumples.",
    "The same with the finer mesh M², which looks softer, as more degrees of freedom let it be; crumpling leaves very localised \
     marks with a typical crescent shape (Amar and Pomeau).",
];

const HERE: [&str; 2] = [
    "A square of office paper falls from exactly flat and horizontal (the side that was above is warm, the other one blue), first as \
     rods, which do not resist bending and crumple, then as an elastic sheet, which bends as office paper does and does not crumple.",
    "The crescent marks of which the paper speaks do not come of its model, in which nothing of a bend stays: \
     rods, which do not resist bending, crumple as they fall, the more the finer their mesh is (M³ is not in the paper), and an elastic \
     sheet of office paper does not. In the last pictures office paper that yields (docs/materials.md) is crumpled between six plates, \
     pressed to a height of 1.5 mm and let go: it stands on its marks, which take a small part of its area, at a height that grows with \
     finer meshes and has not converged, while elastic paper lies flat again.",
];

/// What Fig. 12 has beside Fig. 11: a finer mesh, softness by mesh, and marks.
fn add_softness_and_marks(made: &mut Made, store: &Store) -> Result<()> {
    if store.effort != Effort::Quick {
        for (file, scene) in [
            ("fig12-m3.png", scene as Scenes),
            ("fig12-m3-elastic.png", elastic),
        ] {
            let finer = Run::of(store, scene(3, store.effort)?)?;
            made.pictures.push(picture(file, &finer, store.effort)?);
            made.pages.push(page(12, &finer, store.effort)?);
        }
    }
    let softness = super::softness::make(store.effort, without_contact)?;
    made.tables.push(softness);
    let lasting = super::lasting::make(store)?;
    made.pictures.extend(lasting.pictures);
    made.pages.extend(lasting.pages);
    made.tables.push(lasting.table);
    Ok(())
}

/// The scene of each level of the mesh.
type Scenes = fn(u32, Effort) -> Result<FigureScene>;

fn end_shape(run: &Run) -> Result<SheetShape> {
    SheetShape::of(&Hanging::of(&run.scene)?, run.end())
}

/// What was measured of a run.
fn describe(run: &Run) -> Result<Vec<FigureRow>> {
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
    let shape = SheetShape::of(&hanging, run.end())?;
    rows.extend(rows! {
        "kinetic energy at the end, of the potential energy released" => format!("{:.0e}", s.motion_left),
        "depth of the centre of mass at the end" =>
            format!("{:.3} sides (a rigid plate: {:.3})", shape.centre_depth, runs::PLATE),
        "total bending at the end" => format!("{:.2} rad times the side", shape.bending),
    });
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
