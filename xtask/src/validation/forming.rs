//! The energy that forms a sheet.

use super::experiment::{Experiment, Job, Measured, Quantity};
use anyhow::Result;
use cpu_time::ThreadTime;
use isosheet_scenes::{LiveScene, SceneFile};
use std::path::Path;

/// A strip that is bent beyond its yield by a clamp that turns.
pub(super) const FORMED: Experiment = Experiment {
    name: "forming",
    title: "Work that forms a strip",
    source: "Conservation of the energy",
    about: "A strip of aluminium sheet, 0.2 m long, is bent round a mandrel of a radius of 20 mm by a clamp that turns with \
            it by 108 degrees, and yields: the energy stored and dissipated over the work of the supports and the \
            mandrel, in steps of 1/50 s (4), 1/100 s (8) and 1/200 s (16). Meshes make no difference.",
    quantities: || vec![Quantity::new("(stored + dissipated) / work", 1.0)],
    measure: formed,
};

const SCENE: &str = r#"
version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.02, columns = 40, rows = 2 } }
material = "aluminium sheet"
yield = {}
damping = 30.0
placement = { position = [0.0, -0.01, 0.0] }

[[obstacle]]
shape = { cylinder = { radius = 0.02, height = 0.04 } }
pose = { position = [0, 0, -0.0205], turn = { axis = [1, 0, 0], angle = 90 } }
motion.rotation = { centre = [0, 0, -0.0205], axis = [0, 1, 0], angle = { ramp = { to = -108, end = 0.8 } } }

[[obstacle]] # keeps the tail down
shape = { box = { size = [0.3, 0.04, 0.01] } }
pose = { position = [0.16, 0, 0.0055] }

[[support]]
at = { half_space = { point = [1e-6, 0, 0], normal = [-1, 0, 0] } }
hold.moving_clamp.rotation = { centre = [0, 0, -0.0205], axis = [0, 1, 0], angle = { ramp = { to = -108, end = 0.8 } } }

[contact]
self_contact = true
"#;

/// Seconds.
const END: f64 = 0.8;

fn formed(job: Job) -> Result<Measured> {
    let begun = ThreadTime::now();
    let mut measured = Measured::default();
    let file = SceneFile::parse(SCENE.to_owned(), Path::new("forming.toml"), &[])?;
    let mut live = LiveScene::start(file)?;
    let steps = (12.5 * job.across as f64 * END).round() as usize;
    let mut part = 0.0;
    for _ in 0..steps {
        let report = live.step(END / steps as f64)?;
        measured.factorisations += report.factorisations;
        part = 1.0 + report.energy_drift / report.work;
    }
    measured.values.push(part);
    measured.vertices = live.simulation().model().topology().vertex_count();
    measured.cpu = begun.elapsed().as_secs_f64();
    Ok(measured)
}
