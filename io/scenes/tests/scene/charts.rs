//! Scenes whose motion is computed in a chart.

use crate::parse;
use isosheet_charts::{ChartOptions, ChartStepControl};
use isosheet_coords::{CartesianChart, Choice, RodSystem};
use isosheet_dynamics::Simulation;
use isosheet_scenes::SceneFile;
use std::path::Path;

/// A sheet that hangs from a corner, slightly crumpled at the start.
const HANGING: &str = "version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
start = { perturbation = 0.1, seed = 1 }
[[support]]
at = { vertices = [20] }
[forces]
gravity = [0, 0, -9.8]
[method]
integrator = \"chart\"
step = 0.01
";

fn scene(edits: &[&str]) -> SceneFile {
    let edits: Vec<String> = edits.iter().map(|e| (*e).to_owned()).collect();
    let scene = SceneFile::parse(HANGING.into(), Path::new("test.toml"), &edits);
    scene.unwrap_or_else(|e| panic!("{e}"))
}

/// The bits of the engine, called by hand; and of a run that was continued from a checkpoint.
#[test]
fn a_scene_in_a_chart_is_the_simulation_that_it_says() {
    let scene = scene(&["method.chart.substep.fixed=5e-4"]);
    let mut of_scene = scene.build().unwrap().start().unwrap();
    let made = scene.build().unwrap();
    let system = RodSystem::new(&made.sheet, &made.model.pins()).unwrap();
    let chart = CartesianChart::new(system, Choice::Auto, &made.start.x).unwrap();
    let options = ChartOptions {
        method: isosheet_charts::ChartMethod::RungeKutta4,
        control: ChartStepControl::Fixed(5e-4),
        ..ChartOptions::default()
    };
    let mut by_hand =
        isosheet_charts::in_chart(made.model, made.start, Box::new(chart), options).unwrap();
    let mut resumed = None;
    for k in 0..10 {
        let report = of_scene.step(0.01).unwrap();
        assert_eq!(report, by_hand.step(0.01).unwrap());
        if let Some(resumed) = &mut resumed {
            let resumed: &mut Simulation = resumed;
            assert_eq!(report, resumed.step(0.01).unwrap());
            assert_eq!(of_scene.state(), resumed.state());
        }
        if k == 4 {
            let checkpoint = of_scene.checkpoint();
            resumed = Some(scene.build().unwrap().resume(checkpoint).unwrap());
        }
    }
    assert_eq!(of_scene.state(), by_hand.state());
    // It is the fall of the sheet: energy is kept, and the sheet has fallen.
    let report = of_scene.step(0.01).unwrap();
    assert!(
        report.energy_drift.abs() < 1e-9 && report.kinetic > 1e-4,
        "{report:?}"
    );
}

/// The adaptive step keeps each change of the energy below its tolerance.
#[test]
fn the_paper_s_adaptive_step_bounds_the_change_of_the_energy() {
    let scheme =
        "method.chart={scheme=\"forward_euler\",equations=\"reformed\",positions=\"projected\"}";
    let step = "method.chart.substep={adaptive={tolerance=1e-6,min=1e-7,max=0.01}}";
    let mut run = scene(&[scheme, step]).build().unwrap().start().unwrap();
    let mut substeps = 0;
    for _ in 0..5 {
        let report = run.step(0.01).unwrap();
        substeps += report.substeps;
        assert!(
            report.energy_drift.abs() <= 1e-6 * substeps as f64,
            "{report:?}"
        );
    }
    assert!(substeps > 5, "{substeps}");
}

/// Where there is no chart, the scene says which key is to blame.
#[test]
fn what_a_chart_cannot_do_is_refused_at_its_key() {
    let refused = |scene: &SceneFile| {
        let error = scene.build().and_then(|s| s.start()).err();
        error.expect("refused").to_string()
    };
    let flat = scene(&[
        "sheet.start.perturbation=0",
        "method.chart.coordinates=front",
    ]);
    let text = refused(&flat);
    assert!(
        text.contains("coordinates") && text.contains("the state is flat"),
        "{text}"
    );
    let wrong = [
        (
            "method.fallback=implicit_euler",
            "a chart has no `fallback`",
        ),
        ("method.chart={positions=\"linear\"}", "full equations"),
        (
            "method.chart.substep={adaptive={tolerance=1e-6,min=1,max=0.1}}",
            "at most `max`",
        ),
        ("method.integrator=bdf2", "no chart"),
        (
            "sheet.isometry={elastic={stiffness=1000}}",
            "needs rigid rods",
        ),
    ];
    for (edit, part) in wrong {
        let chart = "method.chart.solver=sparse".to_owned();
        let path = Path::new("test.toml");
        let error = SceneFile::parse(HANGING.into(), path, &[chart, edit.to_owned()]);
        let text = error.expect_err("refused").to_string();
        assert!(text.contains(part), "{edit}: {text}");
    }
    let lonely = HANGING.replace("\"chart\"", "\"bdf2\"");
    assert!(parse(&lonely).is_ok());
}
