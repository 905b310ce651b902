//! Fig. 13: a square die punches a sheet of metal upwards.

use super::play::play;
use super::sequence::{View, choose, sequence};
use super::{Context, Made, Picture, Play, RenderEffort};
use crate::draw::{Axis, Legend, Line, Plot, Series, palette};
use crate::runs::{self, SelfContact, Stamping};
use anyhow::Result;
use serde_json::json;

/// The scene of the figure.
pub(super) fn scene(effort: RenderEffort) -> Stamping {
    Stamping {
        name: "stamping".into(),
        level: if effort == RenderEffort::Full { 3 } else { 1 },
        side: 0.5,
        weight: 3.9,
        die: 0.09,
        opening: 0.14,
        holder: 0.03,
        clearance: 0.03,
        speed: 0.03,
        stroke: 0.07,
        activation: 3e-3,
        stiffness: 3e-3,
        friction: 0.1,
        contact: SelfContact::Friction(0.1),
        damping: 2.0,
        frame: 1.0 / 60.0,
        frames: if effort == RenderEffort::Full { 144 } else { 8 },
    }
}

/// Strokes of the pictures as parts of the whole.
const STROKES: [f64; 6] = [0.0, 0.3, 0.5, 0.7, 0.85, 1.0];

/// How the run is shown. The holders would hide the sheet.
const VIEW: View<'static> = View {
    azimuth: -58.0,
    elevation: 30.0,
    distance: 3.0,
    columns: 3,
    pins: &[],
    bodies: &[runs::DIE, runs::DIE + 1],
    depth: 0.03,
};

/// The page that plays a run.
pub(super) fn page(figure: u8, scene: &Stamping, context: &Context<'_>) -> Result<Play> {
    let label = match scene.contact {
        SelfContact::None => "stamping, the sheet passing through itself",
        SelfContact::Friction(_) => "stamping",
    };
    play(figure, label, scene, &VIEW, context)
}

pub(super) fn make(context: &Context<'_>) -> Result<Made> {
    let scene = scene(context.effort);
    let run = runs::ensure(context.store, &scene)?;
    let trajectory = runs::trajectory(context.store, &scene)?;
    let forces = runs::forces(context.store, &scene, runs::DIE)?;
    let full = scene.stroke / scene.speed;
    // The sheet presses the die down.
    let curve: Vec<[f64; 2]> = forces
        .iter()
        .filter(|f| f[0] <= full)
        .map(|f| [1e3 * scene.speed * f[0], -f[3]])
        .collect();
    let peak = curve.iter().map(|p| p[1]).fold(0.0, f64::max);
    let weight = 9.8 * scene.weight * scene.side * scene.side;
    let frames = choose(&trajectory, &STROKES.map(|s| s * full));
    let image = sequence(&scene, &trajectory, &frames, &VIEW, context.effort)?;
    let alt = "Force of the sheet on the die over its stroke";
    Ok(Made {
        title: "Sheet metal stamping",
        paper: "A square die punches a sheet (M³, 289/512) upwards; the sequence shows how the buckled developable surface is formed.",
        measured: format!(
            "A blank of {:.1} m and {:.1} kg/m² (half a millimetre of steel) lies on a frame with a square opening of {:.0} mm; a die of {:.0} mm rises through it at \
             {:.0} mm/s. Holding: friction {} on all tools, weight, and four holders (not drawn) {:.0} mm wide above the middles of the frame's \
             sides, {:.0} mm above it. An isometric sheet can move under these: it draws in at the sides, and the corners are free to buckle. A clamped \
             boundary could not draw in at all. Over the stroke of {:.0} mm the force on the die grows from nothing to at most {peak:.1} N; the blank weighs {weight:.1} N. \
             {}/{} vertices/faces, {} frames of 1/60 s, {} rejected sub-steps, {:.1} s of wall time per simulated second, largest strain {:.0e}, \
             smallest gap {}. The holding conditions of the paper are not known.",
            scene.side,
            scene.weight,
            2e3 * scene.opening,
            2e3 * scene.die,
            1e3 * scene.speed,
            scene.friction,
            2e3 * scene.holder,
            1e3 * scene.clearance,
            1e3 * scene.stroke,
            run.vertices,
            run.faces,
            run.frames,
            run.rejected,
            run.slowness(),
            run.max_strain,
            super::gap(run.smallest_gap),
        ),
        pictures: vec![
            Picture {
                file: "fig13.png".into(),
                alt: "A square die rises through the opening of a frame and punches the sheet that lies on it".into(),
                bytes: image,
            },
            Picture {
                file: "fig13-force.svg".into(),
                alt: alt.into(),
                bytes: plot(&curve, weight, 1e3 * scene.stroke, peak).draw().to_svg(alt)?.into_bytes(),
            },
        ],
        pages: vec![page(13, &scene, context)?],
        tables: Vec::new(),
        facts: json!({ "run": run, "peak_force": peak, "weight": weight, "stroke_mm_and_force_n": curve }),
    })
}

fn plot(curve: &[[f64; 2]], weight: f64, stroke: f64, peak: f64) -> Plot {
    let top = 1.1 * peak.max(weight);
    Plot {
        x: Axis::round("stroke (mm)", [0.0, stroke], 5),
        y: Axis::round("force on the die (N)", [0.0, top], 5),
        size: [230.0, 130.0],
        series: vec![
            Series {
                name: "force".into(),
                points: curve.to_vec(),
                colour: palette::BLUE,
                marker: None,
                line: Line::Solid,
            },
            Series {
                name: "weight".into(),
                points: vec![[0.0, weight], [stroke, weight]],
                colour: palette::GREY,
                marker: None,
                line: Line::Dashed,
            },
        ],
        legend: Legend::Right,
    }
}
