//! Figs. 11 and 12: a sheet of paper held at a corner falls and crumples.

use super::marks::{self, Marks};
use super::play::play;
use super::sequence::{View, choose, sequence};
use super::{Context, Made, Picture, Play, RenderEffort};
use crate::runs::{self, FigureScene, Hanging, RunSummary, Shape};
use anyhow::{Context as _, Result};
use isosheet_io::scene::Integrator;
use isosheet_mesh::VertexId;
use serde_json::json;

/// Times of the pictures, seconds. The fall takes the first third of a second; then the sheet swings,
/// crumples and comes to rest.
const TIMES: [f64; 10] = [0.0, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.6, 8.0];

/// The scene of the figure with mesh M^level, with contact of the sheet with itself.
pub(super) fn scene(level: u32, effort: RenderEffort) -> Result<FigureScene> {
    let mut edits = Vec::new();
    let file = if level == 1 { "fig11" } else { "fig12" };
    if level != 1 && level != 2 {
        edits.push(format!("sheet.mesh.square.level={level}"));
    }
    if effort == RenderEffort::Quick {
        edits.push("stop.time=0.2".to_owned());
    }
    FigureScene::of(file, &format!("crumple-m{level}-contact"), &edits)
}

/// The same passing through itself.
pub(super) fn without_contact(level: u32, effort: RenderEffort) -> Result<FigureScene> {
    scene(level, effort)?.without_self_contact(&format!("crumple-m{level}"))
}

pub(super) fn make(figure: u8, level: u32, context: &Context<'_>) -> Result<Made> {
    let scene = scene(level, context.effort)?;
    let summary = runs::ensure(context.store, &scene)?;
    let free = runs::ensure(context.store, &without_contact(level, context.effort)?)?;
    let file = format!("fig{figure:02}.png");
    let mut pictures = vec![picture(file, &scene, context)?];
    let mut pages = vec![page(figure, &scene, context)?];
    let mut measured = describe(&scene, &summary, &free, context)?;
    let (mut tables, mut facts) = (
        Vec::new(),
        json!({ "run": summary, "without_contact": free }),
    );
    if figure == 12 {
        if context.effort == RenderEffort::Full {
            let finer = self::scene(3, context.effort)?;
            runs::ensure(context.store, &finer)?;
            pictures.push(picture("fig12-m3.png".into(), &finer, context)?);
            pages.push(page(figure, &finer, context)?);
            measured += " Below it the same with M³, which the paper does not show, and what softer means in numbers.";
        }
        let part = super::softness::make(context, without_contact)?;
        pictures.push(part.picture);
        tables.push(part.table);
        let all = concentration(context)?;
        let alt = "How much of the fold angles the sharpest edges carry over time, and how many of the final marks are there already";
        pictures.push(Picture {
            file: "fig12-marks.svg".into(),
            alt: alt.into(),
            bytes: marks::plot(&all).to_svg(alt)?.into_bytes(),
        });
        tables.push(marks::table(&all));
        measured += " Permanent marks: the model has neither bending stiffness nor memory, so that no fold is permanent by itself; what it \
                     shows is where folds gather and whether they stay there (last plot and table). ";
        measured += &marks::crescents(&all);
        facts["softness"] = part.facts;
        facts["marks"] = json!(all);
    }
    Ok(Made {
        title: if level == 1 {
            "Crumpled paper, M¹"
        } else {
            "Crumpled paper, M²"
        },
        paper: if level == 1 {
            "A piece of paper modelled by M¹ is held at its left-upper corner, falls and crumples."
        } else {
            "The same with the finer mesh M², which looks softer, as more degrees of freedom let it be. Crumpling leaves very localised marks \
             with a typical crescent shape (Amar and Pomeau)."
        },
        measured,
        pictures,
        pages,
        tables,
        facts,
    })
}

/// The concentration of folds in the runs of M^1 to M^3.
fn concentration(context: &Context<'_>) -> Result<Vec<Marks>> {
    let levels: &[(u32, &str)] = match context.effort {
        RenderEffort::Full => &[(1, "M¹"), (2, "M²"), (3, "M³")],
        RenderEffort::Quick => &[(1, "M¹"), (2, "M²")],
    };
    let of = |&(level, name): &(u32, &str)| {
        let scene = scene(level, context.effort)?;
        runs::ensure(context.store, &scene)?;
        let trajectory = runs::trajectory(context.store, &scene)?;
        Ok(Marks::of(name, &scene.sheet()?, &trajectory))
    };
    levels.iter().map(of).collect()
}

fn describe(
    scene: &FigureScene,
    s: &RunSummary,
    free: &RunSummary,
    context: &Context<'_>,
) -> Result<String> {
    let (hanging, mass) = (Hanging::of(scene)?, runs::mass(scene)?);
    let end = match context.effort {
        RenderEffort::Full => {
            let trajectory = runs::trajectory(context.store, scene)?;
            let last = trajectory
                .frame(trajectory.len() - 1)
                .context("last frame")?;
            let shape = Shape::of(&hanging, last)?;
            format!(
                "At the end the kinetic energy is {:.0e} of the potential energy released; the centre of mass hangs {:.3} sides below \
                 the pin (a rigid plate: {:.3}).",
                s.motion_left,
                shape.centre_depth,
                runs::PLATE
            )
        }
        RenderEffort::Quick => "Cut short.".to_owned(),
    };
    Ok(format!(
        "A square of office paper, {:.0} mm, {:.0} g/m² ({:.2} g), lumped masses, {} with velocity damping {:.0}/s, contact of the sheet \
         with itself with friction {}, {:.1} s from exactly flat and horizontal; {} frames of 1/60 s with {} rejected steps; largest \
         edge strain {:.0e}, smallest gap {}. Warm: the side that was above; blue: below. {:.2} s of wall time per simulated second, \
         {:.1} times that of the sheet that may pass through itself. {end}",
        1e3 * hanging.side,
        1e3 * mass / hanging.sheet.area(),
        1e3 * mass,
        method_name(scene.scene().method.integrator),
        scene.scene().sheet.damping,
        scene.scene().contact.friction,
        s.time,
        s.frames,
        s.rejected,
        s.max_strain,
        super::gap(s.smallest_gap),
        s.slowness(),
        s.slowness() / free.slowness().max(1e-12),
    ))
}

/// The integrator in words.
pub(super) fn method_name(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::ImplicitEuler => "implicit Euler",
        Integrator::Bdf2 => "BDF2",
        Integrator::Projection => "projection",
        Integrator::EnergyMomentum => "energy-momentum",
        Integrator::Rattle => "RATTLE",
        Integrator::RattleComposition => "fourth-order RATTLE",
        Integrator::Chart => "system coordinates",
    }
}

/// How a run is shown.
fn view(side: f64, pins: &[VertexId]) -> View<'_> {
    View {
        azimuth: -62.0,
        elevation: 17.0,
        distance: 6.0 * side,
        columns: 5,
        pins,
        bodies: &[],
        depth: 0.0,
    }
}

/// The page that plays a run.
pub(super) fn page(figure: u8, scene: &FigureScene, context: &Context<'_>) -> Result<Play> {
    let contact = if scene.scene().contact.self_contact {
        ""
    } else {
        ", passing through itself"
    };
    let Hanging {
        level, side, pin, ..
    } = Hanging::of(scene)?;
    let level = ["M⁰", "M¹", "M²", "M³"][level as usize];
    let label = format!("crumpled paper, {level}{contact}");
    play(figure, &label, scene, &view(side, &[pin]), context)
}

/// The sequence of a run that has been made.
fn picture(file: String, scene: &FigureScene, context: &Context<'_>) -> Result<Picture> {
    let Hanging {
        level, side, pin, ..
    } = Hanging::of(scene)?;
    let trajectory = runs::trajectory(context.store, scene)?;
    let frames = choose(&trajectory, &TIMES);
    Ok(Picture {
        file,
        alt: format!(
            "A sheet of paper held at its left-upper corner falls from flat and crumples, mesh M{level}"
        ),
        bytes: sequence(
            scene,
            &trajectory,
            &frames,
            &view(side, &[pin]),
            context.effort,
        )?,
    })
}
