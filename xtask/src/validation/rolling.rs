//! Rigid bodies that roll down a plane without sliding.

use super::experiment::{Experiment, Job, Measured, Quantity};
use anyhow::Result;
use cpu_time::ThreadTime;
use isosheet_scenes::{LiveScene, SceneFile};
use std::path::Path;

/// Balls, capsules and cylinders.
pub(super) const ROLLING: Experiment = Experiment {
    name: "rolling",
    title: "Bodies that roll down a plane",
    source: "g sin a / (1 + I / (m r^2))",
    about: "A sphere, a capsule and a cylinder across the slope, of the radius 0.2 m, roll down a plane with friction for \
            half a second: the acceleration of the centre over g sin a, on slopes of 1/20 and 3/10, in steps of 1/60 s (4), \
            1/120 s (8) and 1/240 s (16). Meshes make no difference.",
    quantities: || {
        let of = |body: &Roller| {
            SLOPES.map(|slope| Quantity::new(format!("{}, slope {slope}", body.name), body.part()))
        };
        ROLLERS.iter().flat_map(of).collect()
    },
    measure: rolled,
};

/// Tangents of slopes.
const SLOPES: [f64; 2] = [0.05, 0.3];

/// Metres.
const RADIUS: f64 = 0.2;
const LENGTH: f64 = 0.5;

/// A body that rolls.
struct Roller {
    name: &'static str,
    shape: &'static str,
    /// `I / r^2` of a cylinder of unit mass and of two half balls, and whether the body has these parts.
    has: [bool; 2],
}

const ROLLERS: [Roller; 3] = [
    Roller {
        name: "sphere",
        shape: "sphere = { radius = 0.2 }",
        has: [false, true],
    },
    Roller {
        name: "capsule",
        shape: "capsule = { radius = 0.2, length = 0.5 }",
        has: [true, true],
    },
    Roller {
        name: "cylinder",
        shape: "cylinder = { radius = 0.2, height = 0.5 }",
        has: [true, false],
    },
];

impl Roller {
    /// The acceleration over `g sin a`: a cylinder has `I = m r^2 / 2`, a ball `2/5 m r^2`.
    fn part(&self) -> f64 {
        let volumes = [RADIUS * RADIUS * LENGTH, 4.0 / 3.0 * RADIUS.powi(3)];
        let parts = volumes.into_iter().zip(self.has).zip([0.5, 0.4]);
        let [mass, inertia] = parts
            .filter(|((_, has), _)| *has)
            .fold([0.0; 2], |[mass, inertia], ((volume, _), moment)| {
                [mass + volume, inertia + moment * volume]
            });
        1.0 / (1.0 + inertia / mass)
    }
}

fn rolled(job: Job) -> Result<Measured> {
    let begun = ThreadTime::now();
    let mut measured = Measured::default();
    // 15 steps a second for each of so many squares.
    let step = 1.0 / (15.0 * job.across as f64);
    for body in &ROLLERS {
        for slope in SLOPES {
            let (g, angle) = (9.81, slope.atan());
            let down = g * angle.sin();
            let scene = format!(
                "version = 1\nsheet = {{ mesh = {{ square = {{ side = 0.1, level = 0 }} }}, placement = {{ position = [5, 5, 5] }} }}\n\
                 support = [{{ at = \"all\" }}]\n\
                 obstacle = [{{ shape = \"half_space\", friction = 0.8 }}]\n\
                 contact = {{ activation = 1e-3 }}\n\
                 forces = {{ gravity = [{down}, 0, {}] }}\n\
                 [[body]]\nshape = {{ {} }}\ndensity = 500\n\
                 pose = {{ position = [0, 0, {}], turn = {{ axis = [1, 0, 0], angle = 90 }} }}\n",
                -g * angle.cos(),
                body.shape,
                RADIUS + 5e-4,
            );
            let file = SceneFile::parse(scene, Path::new("rolling.toml"), &[])?;
            let mut live = LiveScene::start(file)?;
            // It settles in the first half.
            let count = (0.25 / step).round() as usize;
            let mut speeds = [0.0; 2];
            for speed in &mut speeds {
                for _ in 0..count {
                    measured.factorisations += live.step(step)?.factorisations;
                }
                let [x, ..] = live.facts().bodies[0].centre(&live.simulation().state().v);
                *speed = x;
            }
            let acceleration = (speeds[1] - speeds[0]) / (count as f64 * step);
            measured.values.push(acceleration / down);
            measured.vertices = live.simulation().model().topology().vertex_count();
        }
    }
    measured.cpu = begun.elapsed().as_secs_f64();
    Ok(measured)
}
