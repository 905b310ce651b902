//! Sheets that are not flat without stress.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, material};
use crate::runs::meshes::{vertices, with_line};
use anyhow::Result;
use isosheet_dynamics::{Curl, Curvature, MaterialDirection, Profile, SheetModel};
use std::f64::consts::{PI, TAU};

const POISSON: f64 = 0.3;

/// Natural curvature over the length of the strip.
const ALPHA: f64 = 2.0;

/// Curls.
pub(super) const CURLED: Experiment = Experiment {
    name: "natural-curvature",
    title: "Sheets with natural curvature",
    source: "Timoshenko 1925; Bartels, Bonito and Nochetto 2017 (bilayers)",
    about: "A strip four times as long as wide, clamped at one end, with the natural curvature alpha = 2 / L along it, \
            or in both directions (Poisson's ratio 0.3): its curvature over alpha, by the place of its end. The second \
            is 1 + nu where the strip is wide against its thickness, here a hundred-thousandth of the length.",
    quantities: || {
        vec![
            Quantity::new("along, curvature / alpha", 1.0),
            Quantity::new("both directions, curvature / alpha", 1.0 + POISSON),
        ]
    },
    measure: curled,
};

fn curled(job: Job) -> Result<Measured> {
    let strip = job.cantilever([1.0, 0.25])?;
    let material = material(1.0, POISSON, 1e-5);
    let tip = Line::at(&strip.sheet, 0, 1.0);
    let mut all = Measured::default();
    for across in [0.0, ALPHA] {
        let curl = Curl {
            direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
            curvature: Curvature {
                along: ALPHA,
                across,
                twist: 0.0,
            }
            .into(),
            profile: Profile::Ramp {
                from: 0.0,
                to: 1.0,
                begin: 0.0,
                end: 10.0,
            },
        };
        let model = SheetModel::of_material(&strip.sheet, &material);
        let model = model.clamped(&strip.clamp).curled(curl).build()?;
        let mut rest = Rest::new(&strip.sheet, 1.0, 1.0);
        rest.under(model)?;
        // The chord of an arc has half the slope of its end.
        let [x, z] = [0, 2].map(|k| tip.mean(&rest.x, k));
        let curvature = 2.0 * z.atan2(x);
        all.add(Measured::at_rest(&rest, vec![curvature / ALPHA]));
    }
    Ok(all)
}

/// Radius and width of the ring, and how far it is opened.
const RADIUS: f64 = 1.0;
const WIDTH: f64 = 0.5;
const OPENING: f64 = 1e-2;

/// A ring.
pub(super) const RING: Experiment = Experiment {
    name: "split-ring",
    title: "Ring with a slit",
    source: "Bending of curved beams, 3 pi P R^3 / (E I) (Timoshenko, Strength of Materials)",
    about: "A ring of the radius R and the width R / 2 that is round without stress, Poisson's ratio 0, clamped on one \
            side of its slit: how far a force along the other side opens it.",
    quantities: || vec![Quantity::new("opening E I / (3 pi P R^3)", 1.0)],
    measure: ring,
};

fn ring(job: Job) -> Result<Measured> {
    let arc = TAU * RADIUS;
    let cell = WIDTH / job.across as f64;
    // The clamp overlaps the other end in space: nothing touches here.
    let flat = job.mesh.rectangle([-cell, 0.0], [arc, WIDTH], cell)?;
    let flat = with_line(&flat, 0.0, cell)?;
    let clamp = vertices(&flat, |[x, ..]| x < 1e-9);
    let round = |[x, y, _]: [f64; 3]| {
        let (s, c) = (x / RADIUS).sin_cos();
        [RADIUS * s, y, RADIUS * (1.0 - c)]
    };
    let sheet = flat.map_positions(round)?;
    let end = Line::at(&flat, 0, arc);
    let force = OPENING * WIDTH / (3.0 * PI * RADIUS.powi(3));
    let material = material(1.0, 0.0, 0.01);
    let model = SheetModel::of_material(&sheet, &material);
    let model = model.clamped(&clamp).curved().build()?;
    let mut rest = Rest::new(&sheet, OPENING, arc * arc);
    rest.under(model.with_force(end.load(force, [-1.0, 0.0, 0.0])?))?;
    let opened = -end.moved(&sheet, &rest.x, 0);
    Ok(Measured::at_rest(&rest, vec![opened / OPENING]))
}
