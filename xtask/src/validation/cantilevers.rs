//! Strips that are clamped at one end and loaded at the other.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, material, with_plate};
use crate::runs::meshes::vertices;
use anyhow::Result;
use isosheet_dynamics::{LineClamp, PlateBending, PlateEdges, RigidDisplacement, SheetModel};
use nalgebra::{Isometry3, Rotation3, Translation3, Vector3};
use std::f64::consts::TAU;

/// Table 1.
pub(super) const END_SHEAR: Experiment = Experiment {
    name: "end-shear",
    title: "Cantilever under end shear",
    source: "Sze, Liu and Lo 2004, table 1",
    about: "A strip of 10 x 1 x 0.1, E = 1.2e6, Poisson's ratio 0, clamped at one end, under a force across the \
            other of P = 4 at most: how far the end moves back (u) and aside (w).",
    quantities: || {
        let parts = SHEAR.iter().flat_map(|(part, u, w)| {
            [
                Quantity::new(format!("u at {part} P"), *u),
                Quantity::new(format!("w at {part} P"), *w),
            ]
        });
        parts.collect()
    },
    measure: end_shear,
};

/// Parts of the load, and `u` and `w`.
const SHEAR: [(f64, f64, f64); 3] = [
    (0.25, 0.563, 3.015),
    (0.5, 1.604, 4.933),
    (1.0, 3.286, 6.698),
];

fn end_shear(job: Job) -> Result<Measured> {
    let length = 10.0;
    let strip = job.cantilever([length, 1.0])?;
    let material = material(100.0, 0.0, 0.1);
    let tip = Line::at(&strip.sheet, 0, length);
    let mut rest = Rest::new(&strip.sheet, length, length * length / 10.0);
    let mut values = Vec::new();
    for (part, ..) in SHEAR {
        let model = SheetModel::of_material(&strip.sheet, &material)
            .clamped(&strip.clamp)
            .build()?;
        let load = tip.load(4.0 * part, [0.0, 0.0, 1.0])?;
        rest.under(model.with_force(load))?;
        let [u, w] = [0, 2].map(|k| tip.moved(&strip.sheet, &rest.x, k));
        values.extend([-u, w]);
    }
    Ok(Measured::at_rest(&rest, values))
}

/// A circle.
pub(super) const END_MOMENT: Experiment = Experiment {
    name: "end-moment",
    title: "Cantilever under end moment",
    source: "Exact: an arc of a circle (Sze, Liu and Lo 2004, section 3.2)",
    about: "A strip of 12 x 1 x 0.1, E = 1.2e6, Poisson's ratio 0, clamped at one end; the slope of the other, whose             vertices are free, is turned: how far that end moves back (u) and aside (w), parts of the length, and the             moment over that of the arc.",
    quantities: || {
        let of = |turns: &f64| {
            let angle = TAU * turns;
            [
                Quantity::of_scale(
                    format!("u after {turns} turns"),
                    1.0 - angle.sin() / angle,
                    1.0,
                ),
                Quantity::of_scale(
                    format!("w after {turns} turns"),
                    (1.0 - angle.cos()) / angle,
                    1.0,
                ),
                Quantity::new(format!("moment after {turns} turns"), 1.0),
            ]
        };
        TURNS.iter().flat_map(of).collect()
    },
    measure: end_moment,
};

const TURNS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// Of a turn, between states of rest.
const PART_OF_TURN: f64 = 0.125;

fn end_moment(job: Job) -> Result<Measured> {
    let [length, width] = [12.0, 1.0];
    let strip = job.cantilever([length, width])?;
    let sheet = &strip.sheet;
    let material = material(100.0, 0.0, 0.1);
    let tip = Line::at(sheet, 0, length);
    let mut rest = Rest::new(sheet, length, length * length / 10.0);
    let (mut values, mut turned) = (Vec::new(), 0.0);
    for turns in TURNS {
        let mut moment = 0.0;
        while turned < turns {
            turned += PART_OF_TURN;
            let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), -TAU * turned);
            let end = LineClamp {
                vertices: vertices(sheet, |[x, ..]| x > length - 1e-9),
                positions: sheet.positions().to_vec(),
                motion: RigidDisplacement {
                    pose: Isometry3::from_parts(Translation3::identity(), turn.into()),
                    ..RigidDisplacement::default()
                }
                .into(),
            };
            let edges = PlateEdges {
                pinned: &strip.clamp,
                clamps: &[end],
                ..PlateEdges::default()
            };
            let plate = PlateBending::held(sheet, &material, &edges)?;
            let model = with_plate(sheet, &material, &strip.clamp, plate)?;
            rest.then(model, |simulation| {
                moment = simulation.clamp_moments()[0][1];
            })?;
        }
        let [u, w] = [0, 2].map(|k| tip.moved(sheet, &rest.x, k) / length);
        let exact = material.rigidity * width * TAU * turns / length;
        values.extend([-u, w, moment.abs() / exact]);
    }
    Ok(Measured::at_rest(&rest, values))
}

/// Tip of a narrow strip.
pub(super) const NARROW: Experiment = Experiment {
    name: "narrow-strip",
    title: "Tip of a narrow steel strip",
    source: "Beam theory, P L^3 / (3 E I)",
    about: "A strip fifty times as long as wide and a hundredth as thick as wide, clamped at one end, under a small \
            force at the other. A beam is free to curve across, so that its stiffness is E I, not that of a plate; \
            the clamp, which forbids that, takes up to 0.6 % away.",
    quantities: || {
        let of = |poisson: &f64| Quantity::new(format!("tip, Poisson's ratio {poisson}"), 1.0);
        POISSON.iter().map(of).collect()
    },
    measure: narrow,
};

const POISSON: [f64; 3] = [0.0, 0.3, 0.5];

fn narrow(job: Job) -> Result<Measured> {
    let [length, width] = [1.0, 0.02];
    let strip = job.cantilever([length, width])?;
    let tip = Line::at(&strip.sheet, 0, length);
    let deflection = 1e-3 * length;
    let mut rest = Rest::new(&strip.sheet, deflection, 1.0);
    let mut values = Vec::new();
    for poisson in POISSON {
        let material = material(1.0, poisson, 0.01 * width);
        let model = SheetModel::of_material(&strip.sheet, &material)
            .clamped(&strip.clamp)
            .build()?;
        let stiffness = 3.0 * (1.0 - poisson * poisson) * width / length.powi(3);
        let load = tip.load(stiffness * deflection, [0.0, 0.0, 1.0])?;
        rest.under(model.with_force(load))?;
        values.push(tip.mean(&rest.x, 2) / deflection);
    }
    Ok(Measured::at_rest(&rest, values))
}
