//! Sheets at rest that are left alone.

use super::meshes::vertices;
use super::model::{Model, PAPER, Plate};
use super::runs::{Ran, Records, samples};
use super::scene::{DAMPING, REST, Scene};
use crate::report::Table;
use crate::runs::Plan;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_mesh::Sheet;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_tests::max_difference;
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};

const STEP: f64 = 1.0 / 60.0;

/// Longest time until rest, and how long the run goes on, seconds.
const UNTIL: f64 = 30.0;
const BEYOND: f64 = 10.0;

/// Strip, side of the square, radius of the ball, metres.
const STRIP: [f64; 2] = [0.1, 0.025];
const SIDE: f64 = 0.2;
const BALL: f64 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Strip,
    Draped,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Job {
    scene: Kind,
    #[serde(rename = "squares across")]
    across: usize,
}

/// What is measured of a sheet that was left alone.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Left {
    #[serde(rename = "at rest after, s")]
    rest: Option<f64>,
    #[serde(rename = "drift, m")]
    drift: Option<f64>,
}

impl Job {
    fn sheet(self) -> Result<Sheet> {
        let n = self.across;
        Ok(match self.scene {
            Kind::Strip => generate::grid(4 * n, n, STRIP[0], STRIP[1], Diagonals::UnionJack)?,
            Kind::Draped => generate::grid(n, n, SIDE, SIDE, Diagonals::UnionJack)?,
        })
    }

    fn scene(self, model: Model, sheet: &Sheet) -> Result<Scene> {
        let end = match self.scene {
            Kind::Strip => 1.01 * STRIP[1] / self.across as f64,
            Kind::Draped => -1.0,
        };
        let clamped = &vertices(sheet, |[x, ..]| x < end)[..];
        let model = model
            .sheet(sheet, Plate { clamped, ..PAPER })?
            .with_gravity()
            .with_damping(DAMPING)?
            .with_pins(clamped)?;
        if self.scene == Kind::Strip {
            return Ok(Scene::new(model, sheet));
        }
        let options = ContactOptions::for_sheet(&model);
        let pose = Isometry3::translation(0.5 * SIDE, 0.5 * SIDE, -BALL - 0.005);
        let ball = Obstacle::fixed(Shape::Sphere { radius: BALL }, pose)?;
        let contacts = Contacts::new(&model, options)?.with_body(ball, Coefficients::equal(0.3))?;
        Ok(Scene::new(model, sheet).touching(contacts))
    }
}

fn measure(model: Model, job: Job, patience: f64) -> Result<(Ran, Left)> {
    let sheet = job.sheet()?;
    let until = Plan::new(STEP, UNTIL).within(patience).until_rest(REST);
    let (course, rested) = job.scene(model, &sheet)?.run(&until)?;
    if !course.is_good() {
        return Ok((Ran::of(model, &sheet, &course), Left::default()));
    }
    // The same run again, as runs are deterministic, and on.
    let rest = course.time;
    let whole = Plan::new(STEP, rest + BEYOND).within(patience);
    let (course, end) = job.scene(model, &sheet)?.run(&whole)?;
    let ran = Ran::of(model, &sheet, &course);
    let drift = ran.if_good(max_difference(&end.x, &rested.x));
    let rest = Some(rest);
    Ok((ran, Left { rest, drift }))
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let sizes: &[[usize; 2]] = effort.quick_or(&[[2, 4]], &[[2, 4], [4, 8], [8, 16]]);
    let mut jobs = Vec::new();
    for &[strip, draped] in sizes {
        for (scene, across) in [(Kind::Strip, strip), (Kind::Draped, draped)] {
            jobs.push(Job { scene, across });
        }
    }
    let patience = effort.quick_or(5.0, 120.0);
    samples(&records.of_models(&jobs, |model, job| measure(model, *job, patience))?)
}
