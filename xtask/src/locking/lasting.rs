//! Sheets at rest that are left alone.

use super::Findings;
use super::meshes::vertices;
use super::model::{Model, Plate, Tried, at_most};
use super::records::Records;
use super::scene::Scene;
use crate::draw::Charts;
use crate::report::Table;
use crate::runs::Plan;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_mesh::Sheet;
use isosheet_mesh::generate::{self, Diagonals};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use std::fmt;

pub(super) const ABOUT: &str = "Paper (80 g/m², 5e-4 N m) by the default method in steps of 1/60 s with damping 4/s, until no vertex is faster than 1e-5 m/s, and then for another 10 s. \
    Strip: 100 mm x 25 mm, the first column of squares clamped, hanging. Draped: a square of 0.2 m on a ball of radius 0.1 m with friction 0.3, at its middle. \
    Measured: whether the whole time is simulated, and the largest distance of a vertex at the end from where it was at rest.";

/// Mass per area (kg/m2), flexural rigidity (N m), rate of damping (1/s).
const DENSITY: f64 = 0.08;
const RIGIDITY: f64 = super::isometry::PAPER_RIGIDITY;
const DAMPING: f64 = 4.0;

const STEP: f64 = 1.0 / 60.0;

/// The sheet is at rest when no vertex is faster, metres per second.
const REST: f64 = 1e-5;

/// Longest time until rest, and how long the run goes on, seconds.
const UNTIL: f64 = 30.0;
const BEYOND: f64 = 10.0;

/// Strip, side of the square, radius of the ball, metres.
const STRIP: [f64; 2] = [0.1, 0.025];
const SIDE: f64 = 0.2;
const BALL: f64 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Kind {
    Strip,
    Draped,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Job {
    kind: Kind,
    /// Squares across.
    across: usize,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Strip => "strip",
            Self::Draped => "draped",
        })
    }
}

impl Job {
    fn sheet(self) -> Result<Sheet> {
        let n = self.across;
        Ok(match self.kind {
            Kind::Strip => generate::grid(4 * n, n, STRIP[0], STRIP[1], Diagonals::UnionJack)?,
            Kind::Draped => generate::grid(n, n, SIDE, SIDE, Diagonals::UnionJack)?,
        })
    }

    fn scene(self, model: Model, sheet: &Sheet) -> Result<Scene> {
        let cell = STRIP[1] / self.across as f64;
        let clamp = match self.kind {
            Kind::Strip => vertices(sheet, |[x, ..]| x < 1.01 * cell),
            Kind::Draped => Vec::new(),
        };
        let plate = Plate {
            density: DENSITY,
            rigidity: RIGIDITY,
            clamped: &clamp,
            creases: &[],
        };
        let model = model
            .sheet(sheet, plate)?
            .with_gravity()
            .with_damping(DAMPING)?
            .with_pins(&clamp)?;
        if self.kind == Kind::Strip {
            return Ok(Scene::flat(model, sheet));
        }
        let options = ContactOptions::for_sheet(&model);
        let pose = Isometry3::translation(0.5 * SIDE, 0.5 * SIDE, -BALL - 0.005);
        let ball = Obstacle::fixed(Shape::Sphere { radius: BALL }, pose)?;
        let contacts = Contacts::new(&model, options)?.with_body(ball, Coefficients::equal(0.3))?;
        Ok(Scene::flat(model, sheet).touching(contacts))
    }
}

/// What is measured of a sheet that was left alone.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Left {
    /// When it came to rest, seconds.
    rest: Option<f64>,
    /// Largest distance of a vertex from where it was then, metres.
    drift: Option<f64>,
}

type Alone = Tried<Job, Left>;

fn measure(model: Model, job: Job, patience: f64) -> Result<Alone> {
    let sheet = job.sheet()?;
    let until = Plan::new(STEP, UNTIL).within(patience).until_rest(REST);
    let (course, rested) = job.scene(model, &sheet)?.run(&until)?;
    let tried = |course, measured| Tried {
        model,
        job,
        vertices: sheet.topology().vertex_count(),
        course,
        measured,
    };
    if !course.is_good() {
        return Ok(tried(
            course,
            Left {
                rest: None,
                drift: None,
            },
        ));
    }
    // The same run again, as runs are deterministic, and on.
    let rest = course.time;
    let whole = Plan::new(STEP, rest + BEYOND).within(patience);
    let (course, end) = job.scene(model, &sheet)?.run(&whole)?;
    let pairs = end
        .x
        .as_chunks::<3>()
        .0
        .iter()
        .zip(rested.x.as_chunks::<3>().0);
    let distances = pairs.map(|(a, b)| {
        let square: f64 = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum();
        square.sqrt()
    });
    let drift = course.is_good().then(|| distances.fold(0.0, f64::max));
    Ok(tried(
        course,
        Left {
            rest: Some(rest),
            drift,
        },
    ))
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let sizes: &[[usize; 2]] = effort.quick_or(&[[2, 4]], &[[2, 4], [4, 8], [8, 16]]);
    let jobs: Vec<Job> = sizes
        .iter()
        .flat_map(|&[strip, draped]| {
            let kinds = [(Kind::Strip, strip), (Kind::Draped, draped)];
            kinds.map(|(kind, across)| Job { kind, across })
        })
        .collect();
    let mut all: Vec<Alone> = Vec::new();
    let patience = effort.quick_or(5.0, 120.0);
    for model in Model::ALL {
        let run = |job: &Job| measure(model, *job, patience);
        all.extend(records.runs(&model.to_string(), &jobs, run)?);
    }
    let targets = Model::ALL.map(|model| {
        let of = all.iter().filter(|a| a.model == model);
        let drifts: Vec<Option<f64>> = of.map(|a| a.measured.drift).collect();
        // What the speed at which a sheet is called at rest allows within the time.
        at_most(
            model,
            "drift within 10 s after rest, m",
            REST * BEYOND,
            &drifts,
        )
    });
    let table = Table::of(
        "Sheets that are left alone for 10 s after they came to rest",
        &all,
        &[
            ("scene", &|a| a.job.kind.to_string().into()),
            ("squares across", &|a| a.job.across.into()),
            ("V", &|a| a.vertices.into()),
            ("model", &|a| a.model.to_string().into()),
            ("ending", &|a| a.course.ending.name().into()),
            ("at rest after, s", &|a| a.measured.rest.into()),
            ("drift, m", &|a| a.measured.drift.into()),
            ("speed left, m/s", &|a| a.course.speed.into()),
            ("factorisations per step", &|a| {
                a.course.cost.factorisations_per_step().into()
            }),
            ("most in a step", &|a| a.course.worst.into()),
            ("message", &|a| a.course.ending.message().into()),
        ],
    );
    let findings = Findings {
        tables: vec![table.named("lasting")],
        targets: targets.to_vec(),
        ..Findings::default()
    };
    Ok((findings, None))
}
