//! A disk that is pushed into a ring: the developable cone.

use super::disks::{Disk, DiskJob, RADIUS, arcs, rim};
use super::model::{Model, PAPER, Plate};
use super::nudge::{Nudge, Ring};
use super::runs::{Ran, Records, Sample, samples};
use super::scene::{DAMPING, run, until_rest};
use crate::report::Table;
use crate::runs::Plan;
use crate::runs::meshes::{nearest, vertices};
use anyhow::Result;
use isosheet_dynamics::{PointProfile, Profile, SheetModel};
use isosheet_mesh::Sheet;
use isosheet_tests::implicit_euler;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Depth, metres.
const DEPTH: f64 = 0.1 * RADIUS;

/// How long the centre moves, and when the forces that choose the place of the fold are gone, seconds.
const MOVING: f64 = 2.0;
const NUDGED: f64 = 2.5;

/// Stiffness of the ring at a vertex over `D / R^2`: the forces at the ends of the fold, about 10 D / R,
/// press them by 1e-4 R into the ring, a thousandth of the depth.
const STIFF: f64 = 1e5;

/// The nudge in total over `D / R`: some part of the force that the centre needs, 24 D / R.
const NUDGE: f64 = 3.0;

/// Lifts above the ring, as parts of the depth, that end a fold and that make one.
const ENDS: f64 = 0.02;
const FOLDS: f64 = 0.1;

/// What is measured; errors at rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Cone {
    pub(super) folds: usize,
    /// Degrees over which the rim is above the ring.
    #[serde(rename = "sector, degrees")]
    pub(super) sector: f64,
    #[serde(rename = "lift / d")]
    lift: f64,
    /// Elastic energy over `D (d / R)^2`, and the part of it that is in the plane.
    #[serde(rename = "energy / (D (d/R)²)")]
    pub(super) energy: f64,
    #[serde(rename = "in the plane")]
    pub(super) membrane: f64,
    #[serde(rename = "other folds")]
    others: Option<f64>,
    #[serde(rename = "error of the sector")]
    sector_error: Option<f64>,
    #[serde(rename = "error of the energy")]
    energy_error: Option<f64>,
}

fn model(of: Model, sheet: &Sheet, plate: Plate<'_>) -> Result<SheetModel> {
    let tip = nearest(sheet, [0.0; 2]);
    let motion = PointProfile {
        offset: sheet.position(tip),
        z: Profile::SmoothStep {
            from: 0.0,
            to: -DEPTH,
            begin: 0.0,
            end: MOVING,
        },
        ..PointProfile::default()
    };
    let nudged = vertices(sheet, |[x, y, _]| {
        x.hypot(y) > 0.97 * RADIUS && y.atan2(x).abs() < 0.05 * TAU
    });
    let force = NUDGE * PAPER.rigidity / RADIUS / nudged.len().max(1) as f64;
    let nudge = Nudge {
        forces: nudged.into_iter().map(|v| (v, force)).collect(),
        end: NUDGED,
    };
    let ring = Ring {
        rim: rim(sheet).into_iter().map(|(_, v)| v).collect(),
        stiffness: STIFF * PAPER.rigidity / (RADIUS * RADIUS),
    };
    let sheet = of.sheet(sheet, plate)?.with_damping(DAMPING)?;
    let sheet = sheet.with_potential(ring).with_potential(nudge);
    Ok(sheet.with_moving_pin(tip, motion)?)
}

fn measure(of: Model, force: f64, job: DiskJob, plan: &Plan) -> Result<(Ran, Cone)> {
    let sheet = job.sheet()?;
    let plate = Plate { force, ..PAPER };
    let (course, end) = run(
        of,
        model(of, &sheet, plate)?,
        &sheet,
        implicit_euler(),
        plan,
    )?;
    let ran = Ran::of(of, &sheet, &course);
    let unit = PAPER.rigidity * (DEPTH / RADIUS).powi(2);
    let energy = of.energy(&sheet, plate, &end.x)? / unit;
    let bending = of.bending_energy(&sheet, plate, &end.x)? / unit;
    let lift =
        |(angle, v): (f64, isosheet_mesh::VertexId)| [angle, end.x[3 * v.index() + 2] / DEPTH];
    let lifts: Vec<[f64; 2]> = rim(&sheet).into_iter().map(lift).collect();
    let arcs = arcs(&lifts, ENDS);
    let folds = arcs.iter().filter(|arc| arc.height > FOLDS).count();
    let cone = Cone {
        folds,
        sector: arcs.iter().map(|arc| arc.angle.to_degrees()).sum(),
        lift: lifts.iter().map(|l| l[1]).fold(0.0, f64::max),
        energy,
        membrane: energy - bending,
        others: ran.if_good((folds as f64 - 1.0).abs()),
        sector_error: None,
        energy_error: None,
    };
    Ok((ran, cone))
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let jobs = DiskJob::all(effort);
    let finest = DiskJob {
        mesh: Disk::Delaunay1,
        rings: 2 * jobs.last().map_or(1, |job| job.rings),
    };
    let plan = until_rest(effort.quick_or(2.0, 20.0));
    let beside = |model: Model| {
        records.runs(&format!("reference, {model}"), &[finest], |&job| {
            let (ran, measured) = measure(model, PAPER.force, job, &plan)?;
            Ok(Sample { job, ran, measured })
        })
    };
    let reference = beside(Model::Material)?;
    let mut all =
        records.of_models(&jobs, |model, job| measure(model, PAPER.force, *job, &plan))?;
    all.extend(beside(Model::Elastic)?);
    if let [
        Sample {
            ran,
            measured: exact,
            ..
        },
    ] = &reference[..]
        && ran.is_good == 1
    {
        for Sample { ran, measured, .. } in &mut all {
            measured.sector_error = ran.if_good((measured.sector / exact.sector - 1.0).abs());
            measured.energy_error = ran.if_good((measured.energy / exact.energy - 1.0).abs());
        }
    }
    all.extend(reference);
    samples(&all)
}

/// The disk on the irregular mesh with another force of the slack.
pub(super) fn with_force(
    model: Model,
    force: f64,
    rings: usize,
    plan: &Plan,
) -> Result<(Ran, Cone)> {
    let mesh = Disk::Delaunay1;
    measure(model, force, DiskJob { mesh, rings }, plan)
}
