//! What is feared: sheets that are torn or pass through bodies where they fall or hang by points.

use super::Findings;
use super::meshes::vertices;
use super::model::{Model, Plate, Tried};
use super::records::Records;
use super::scene::Scene;
use crate::draw::Charts;
use crate::report::{Bound, Cell, Cost, Finding, Table, extremes};
use crate::runs::Plan;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_mesh::{Sheet, generate};
use nalgebra::Isometry3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::fmt;

pub(super) const ABOUT: &str = "Random sheets of 80 g/m² and about 0.3 m (squares, irregular squares, disks; 25 to 127 vertices; flexural rigidity from 1e-5 to 3e-3 N m) fall from 5 cm on a fixed ball, box or capsule, \
    with friction 0.3 at the body and 0.2 at the sheet itself, for 0.8 s with damping 0.5/s. Banners: squares of 1 m, 80 g/m² and 5e-4 N m, start flat and horizontal, held at two neighbouring corners or at all four, for 2 s with damping 2/s. \
    The default method in steps of 1/60 s. Measured over all accepted steps: the largest strain of an edge and the smallest gap.";

/// Mass per area, kg/m2, and flexural rigidity of the banners, N m.
const DENSITY: f64 = 0.08;
const RIGIDITY: f64 = super::isometry::PAPER_RIGIDITY;

/// Size of the sheets that fall, and how far they fall, metres.
const SIZE: f64 = 0.3;
const FALL: f64 = 0.05;

const STEP: f64 = 1.0 / 60.0;

/// A scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Job {
    /// A sheet that falls on a body, with its seed.
    Fall(u64),
    /// A square by its level of refinement, held at so many corners.
    Banner { level: u32, corners: usize },
}

impl fmt::Display for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fall(_) => f.write_str("fall"),
            Self::Banner { level, corners } => write!(f, "banner M^{level}, {corners} corners"),
        }
    }
}

/// A falling sheet: flat at z = 0 above the body.
struct Falling {
    sheet: Sheet,
    rigidity: f64,
    body: Obstacle,
}

fn falling(seed: u64) -> Result<Falling> {
    let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
    let sheet = match seed % 3 {
        0 => generate::isotropic_square(rng.random_range(1..=2), SIZE)?,
        1 => {
            let spacing = rng.random_range(0.1..0.2) * SIZE;
            generate::delaunay_square(SIZE, spacing, rng.random())?
        }
        _ => {
            let disk = generate::disk(rng.random_range(3..=6), 0.5 * SIZE)?;
            disk.map_positions(|[x, y, z]| [x + 0.5 * SIZE, y + 0.5 * SIZE, z])?
        }
    };
    let rigidity = 10f64.powf(rng.random_range(-5.0..-2.5));
    let (shape, top) = match rng.random_range(0..3) {
        0 => (Shape::Sphere { radius: 0.08 }, 0.08),
        1 => {
            let half = [0.08, 0.06, 0.03];
            (Shape::Cuboid { half }, half[2])
        }
        _ => {
            let (half_length, radius) = (0.1, 0.03);
            let shape = Shape::Capsule {
                half_length,
                radius,
            };
            (shape, half_length + radius)
        }
    };
    let aside = rng.random_range(-0.03..0.03);
    let middle = 0.5 * SIZE;
    let pose = Isometry3::translation(middle + aside, middle, -top - FALL);
    let body = Obstacle::fixed(shape, pose)?;
    Ok(Falling {
        sheet,
        rigidity,
        body,
    })
}

/// A plate without clamps and creases.
fn plate(rigidity: f64) -> Plate<'static> {
    Plate {
        density: DENSITY,
        rigidity,
        clamped: &[],
        creases: &[],
    }
}

type Feared = Tried<Job, ()>;

fn measure(model: Model, job: Job, patience: f64) -> Result<Feared> {
    let (sheet, scene, duration) = match job {
        Job::Fall(seed) => {
            let Falling {
                sheet,
                rigidity,
                body,
            } = falling(seed)?;
            let model = model.sheet(&sheet, plate(rigidity))?;
            let model = model.with_gravity().with_damping(0.5)?;
            let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))?
                .with_body(body, Coefficients::equal(0.3))?
                .with_self_contact(Coefficients::equal(0.2))?;
            let scene = Scene::flat(model, &sheet).touching(contacts);
            (sheet, scene, 0.8)
        }
        Job::Banner { level, corners } => {
            let sheet = generate::isotropic_square(level, 1.0)?;
            let lowest = if corners == 2 { 0.5 } else { -1.0 };
            let held = vertices(&sheet, |[x, y, _]| {
                let is_end = |c: f64| (c - 0.5).abs() > 0.5 - 1e-9;
                is_end(x) && is_end(y) && y > lowest
            });
            let model = model.sheet(&sheet, plate(RIGIDITY))?;
            let model = model.with_gravity().with_damping(2.0)?.with_pins(&held)?;
            let scene = Scene::flat(model, &sheet);
            (sheet, scene, 2.0)
        }
    };
    let (course, _) = scene.run(&Plan::new(STEP, duration).within(patience))?;
    Ok(Tried {
        model,
        job,
        vertices: sheet.topology().vertex_count(),
        course,
        measured: (),
    })
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let mut jobs: Vec<Job> = (0..effort.quick_or(3, 30)).map(Job::Fall).collect();
    for &level in effort.quick_or(&[1][..], &[1, 2, 3]) {
        jobs.extend([2, 4].map(|corners| Job::Banner { level, corners }));
    }
    let patience = effort.quick_or(5.0, 120.0);
    let mut all: Vec<Feared> = Vec::new();
    for model in Model::ALL {
        let run = |job: &Job| measure(model, *job, patience);
        all.extend(records.runs(&model.to_string(), &jobs, run)?);
    }
    let targets = Model::ALL.into_iter().flat_map(|model| {
        let of: Vec<&Feared> = all.iter().filter(|f| f.model == model).collect();
        let ended = of.iter().filter(|f| f.course.is_good()).count();
        let strains: Vec<Option<f64>> = of.iter().map(|f| Some(f.course.strain)).collect();
        let gaps: Vec<Option<f64>> = of.iter().filter_map(|f| f.course.gap).map(Some).collect();
        let name = model.to_string();
        [
            Finding::worst(
                name.clone(),
                "part of the scenes that reach the end",
                Bound::AtLeast(1.0),
                &[Some(ended as f64 / of.len() as f64)],
            ),
            Finding::worst(
                name.clone(),
                "largest strain of an edge",
                Bound::AtMost(0.01),
                &strains,
            ),
            Finding::worst(name, "smallest gap, m", Bound::Above(0.0), &gaps),
        ]
    });
    let targets = targets.collect();
    let findings = Findings {
        tables: vec![summary(&all)],
        files: vec![table(&all)],
        remarks: Vec::new(),
        targets,
    };
    Ok((findings, None))
}

/// A row for every model and kind of scene.
fn summary(all: &[Feared]) -> Table {
    let mut kinds: Vec<String> = Vec::new();
    for feared in all {
        let kind = feared.job.to_string();
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let rows: Vec<(String, Model)> = kinds
        .into_iter()
        .flat_map(|kind| Model::ALL.map(|model| (kind.clone(), model)))
        .collect();
    let of = |row: &(String, Model)| -> Vec<&Feared> {
        let is_of = |f: &&Feared| f.model == row.1 && f.job.to_string() == row.0;
        all.iter().filter(is_of).collect()
    };
    Table::of(
        "Falls and banners: the worst of all runs, and means of the cost",
        &rows,
        &[
            ("scene", &|r| r.0.clone().into()),
            ("model", &|r| r.1.to_string().into()),
            ("runs", &|r| of(r).len().into()),
            ("reach the end", &|r| {
                of(r).iter().filter(|f| f.course.is_good()).count().into()
            }),
            ("largest strain of an edge", &|r| {
                extremes(of(r).iter().map(|f| f.course.strain))
                    .map(|e| e[1])
                    .into()
            }),
            ("smallest gap, m", &|r| {
                extremes(of(r).iter().filter_map(|f| f.course.gap))
                    .map(|e| e[0])
                    .into()
            }),
            ("factorisations per step", &|r| {
                let mut cost = Cost::default();
                of(r).iter().for_each(|f| cost.add_run(&f.course.cost));
                cost.factorisations_per_step().into()
            }),
            ("CPU seconds per simulated second", &|r| {
                let of = of(r);
                let cpu: f64 = of.iter().map(|f| f.course.cost.cpu).sum();
                (cpu / of.iter().map(|f| f.course.time).sum::<f64>()).into()
            }),
        ],
    )
    .named("fear")
}

fn table(all: &[Feared]) -> Table {
    Table::of(
        "Every fall and banner",
        all,
        &[
            ("scene", &|f| f.job.to_string().into()),
            ("seed", &|f| match f.job {
                Job::Fall(seed) => (seed as usize).into(),
                Job::Banner { .. } => Cell::Missing,
            }),
            ("V", &|f| f.vertices.into()),
            ("model", &|f| f.model.to_string().into()),
            ("ending", &|f| f.course.ending.name().into()),
            ("largest strain of an edge", &|f| f.course.strain.into()),
            ("smallest gap, m", &|f| f.course.gap.into()),
            ("factorisations", &|f| f.course.cost.factorisations.into()),
            ("most in a step", &|f| f.course.worst.into()),
            ("CPU seconds", &|f| f.course.cost.cpu.into()),
            ("message", &|f| f.course.ending.message().into()),
        ],
    )
    .named("fear-all")
}
