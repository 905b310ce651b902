//! Recordings of simulations whose steps a program takes.

use isosheet_formats::LoadKind;
use isosheet_mesh::VertexId;
use isosheet_runs::{
    EndReason, ExistingRun, Recorder, RecorderOptions, Recording, RecordingEnd, RunError,
    extend_folder, resume_folder, simulate,
};
use isosheet_scenes::{FramePose, Key, LiveScene, SceneFile, Target};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// A corner is let go of at 0.04 s; frames are taken every third step.
const SCENE: &str = r#"
version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
material = "office paper"
[[support]]
at = { vertices = [20] }
[[support]]
at = { vertices = [4] }
until = 0.04
[[measure]]
name = "height"
at = { vertices = [4] }
quantity = "z"
[[obstacle]]
shape = "half_space"
pose = { position = [0, 0, -0.05] }
[forces]
gravity = [0, 0, -9.81]
[method]
step = 0.01
[stop]
time = 0.05
"#;

fn scene(edits: &[&str]) -> SceneFile {
    let edits: Vec<String> = edits.iter().map(|edit| (*edit).to_owned()).collect();
    SceneFile::parse(SCENE.into(), Path::new("scene.toml"), &edits).unwrap()
}

/// A recording of so many steps.
fn record(file: &SceneFile, folder: &Path, steps: usize) -> Recording {
    let mut live = LiveScene::start(file.clone()).unwrap();
    let mut recorder = Recorder::begin(&mut live, folder, &RecorderOptions::default()).unwrap();
    for _ in 0..steps {
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        recorder.step(&mut live, 0.01, go_on).unwrap();
    }
    recorder.finish(&live, RecordingEnd::Program).unwrap()
}

#[test]
fn a_recording_has_the_files_of_a_run() {
    // By time, by a force at a support, and where something is let go of in the last step.
    let scenes = [
        scene(&[]),
        scene(&["stop.time=0.5", "stop.support_force=1e-6"]),
        scene(&["stop.time=0.04"]),
    ];
    for file in &scenes {
        let folder = tempfile::tempdir().unwrap();
        let [run, recorded] = ["run", "recorded"].map(|name| folder.path().join(name));
        simulate(file, &run, &mut |_: &_| ControlFlow::Continue(())).unwrap();
        let steps = Recording::read(&run).unwrap().history.len() - 1;
        let recording = record(file, &recorded, steps);
        for name in [
            "history.csv",
            "loads.csv",
            "measures.csv",
            "events.csv",
            "frames.bin",
            "scene.toml",
        ] {
            let [a, b] = [&run, &recorded].map(|folder| fs::read(folder.join(name)).unwrap());
            assert!(a == b, "{name}");
        }
        let mut summary = Recording::read(&run).unwrap().summary.unwrap();
        summary.wall_time = recording.summary.as_ref().unwrap().wall_time;
        assert_eq!(recording.summary, Some(summary));
    }
}

#[test]
fn the_forces_at_the_end_are_those_of_the_last_step() {
    // A support has been released before that step.
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    simulate(&scene(&[]), &run, &mut |_: &_| ControlFlow::Continue(())).unwrap();
    let recording = Recording::read(&run).unwrap();
    let last = recording.history.last().unwrap().t;
    let loads = recording.loads.iter();
    let loads = loads.filter(|load| load.t == last && load.on == LoadKind::Support);
    let loads: Vec<[f64; 3]> = loads.map(|load| load.force).collect();
    assert_eq!(recording.summary.unwrap().ending.supports, loads);
    assert_eq!(loads[1], [0.0; 3]);
}

#[test]
fn a_frame_of_the_end_alone_is_taken_back_where_the_loop_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let file = scene(&[]);
    let times = |steps: usize| {
        let folder = folder.path().join(steps.to_string());
        let times = record(&file, &folder, steps).trajectory.times().to_vec();
        assert_eq!(Recording::read(&folder).unwrap().trajectory.times(), times);
        let steps = times.iter().map(|t| (100.0 * t).round() as u64);
        steps.collect::<Vec<u64>>()
    };
    assert_eq!(times(4), [0, 3, 4]);
    assert_eq!(times(5), [0, 3, 5]);
    assert_eq!(times(6), [0, 3, 6]);
    assert_eq!(times(7), [0, 3, 6, 7]);
}

#[test]
fn a_hand_and_an_error_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut live = LiveScene::start(scene(&[])).unwrap();
    let options = RecorderOptions::default();
    let mut recorder = Recorder::begin(&mut live, folder.path(), &options).unwrap();
    live.hold(VertexId(12)).unwrap();
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    recorder.step(&mut live, 0.01, go_on).unwrap();
    let recording = recorder.finish(&live, RecordingEnd::Error).unwrap();
    let summary = recording.summary.unwrap();
    assert_eq!(summary.ending.reason, EndReason::Error);
    let [hand] = &summary.control[..] else {
        panic!("{:?}", summary.control)
    };
    assert_eq!(
        (hand.what.as_str(), hand.times, hand.in_scene),
        ("a hand", 1, false)
    );
    // A run that is there stays, unless it is to be deleted.
    let taken = Recorder::begin(&mut live, folder.path(), &options);
    assert!(matches!(taken.err(), Some(RunError::Taken { .. })));
    let options = RecorderOptions {
        existing: ExistingRun::Delete,
        ..options
    };
    assert!(Recorder::begin(&mut live, folder.path(), &options).is_ok());
}

/// A program that was killed may have been about to change something: the scene alone is another run.
#[test]
fn a_recording_that_has_not_ended_is_not_continued() {
    for steps in [0, 3] {
        let folder = tempfile::tempdir().unwrap();
        let file = scene(&[]);
        let mut live = LiveScene::start(file.clone()).unwrap();
        let options = RecorderOptions::default();
        let mut recorder = Recorder::begin(&mut live, folder.path(), &options).unwrap();
        for _ in 0..steps {
            let go_on = &mut |_: &_| ControlFlow::Continue(());
            recorder.step(&mut live, 0.01, go_on).unwrap();
        }
        drop(recorder);
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        for again in [
            simulate(&file, folder.path(), go_on),
            resume_folder(folder.path(), go_on),
            extend_folder(folder.path(), 0.1, go_on),
        ] {
            assert!(matches!(again.err(), Some(RunError::Recorded { .. })));
        }
        assert_eq!(Recording::read(folder.path()).unwrap().summary, None);
    }
}

/// What a program drove is in the scene of the recording, with the times at which it changed abruptly, so
/// that the motion is made again: a pin in parts of three steps each, a load by a sine that is replaced
/// half-way, and an obstacle by poses.
#[test]
fn a_recording_that_was_driven_makes_the_motion_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = scene(&[
        "support[0].hold={ moving_pin = {} }",
        r#"forces.load=[{ at = { vertices = [12] }, direction = [1, 0, 0],
            size = { sine = { amplitude = 1e-3, frequency = 5 } } }]"#,
        "stop.time=0.12",
    ]);
    let mut live = LiveScene::start(file).unwrap();
    let first = folder.path().join("first");
    let mut recorder = Recorder::begin(&mut live, &first, &RecorderOptions::default()).unwrap();
    let key = |text: &str| text.parse::<Key>().unwrap();
    for part in 0..4_u8 {
        let end = 0.03 * f64::from(part + 1);
        let to = Target::Value(0.004 * f64::from(part % 2));
        let mut targets = vec![(key("support[0].hold.moving_pin.z"), to)];
        if part == 2 {
            targets.push((key("forces.load[0].size"), Target::Value(0.0)));
            let lifted = FramePose {
                position: [0.0, 0.0, -0.04],
                orientation: [1.0, 0.0, 0.0, 0.0],
            };
            targets.push((key("obstacle[0].motion"), Target::Pose(lifted)));
        }
        live.drive(&targets, end).unwrap();
        for _ in 0..3 {
            let go_on = &mut |_: &_| ControlFlow::Continue(());
            recorder.step(&mut live, 0.01, go_on).unwrap();
        }
    }
    let recorded = recorder.finish(&live, RecordingEnd::Program).unwrap();
    let control = &recorded.summary.as_ref().unwrap().control;
    assert!(control.iter().all(|change| change.in_scene), "{control:?}");

    let again = SceneFile::read(&first.join("scene.toml"), &[]).unwrap();
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let second = folder.path().join("second");
    simulate(&again, &second, go_on).unwrap();
    let ends = [recorded, Recording::read(&second).unwrap()].map(|run| {
        let last = run.trajectory.len() - 1;
        run.trajectory.frame(last).unwrap().to_vec()
    });
    let distances = ends[0].iter().zip(&ends[1]).map(|(a, b)| (a - b).abs());
    // The tolerance of the solver on forces; a method that begins anew at each keyframe is 1e-4 m off.
    assert!(distances.fold(0.0, f64::max) < 1e-9);
}
