//! Scenes that change while they are simulated.

use crate::parse;
use isosheet_dynamics::{Checkpoint, StepError};
use isosheet_mesh::VertexId;
use isosheet_scenes::{
    Edit, HoldError, Key, LiveScene, Mesh, ProfileKey, SceneFile, SceneFileError,
};
use std::path::Path;

/// A square that hangs by a corner, which can be moved, and has a crease along its middle line and a load.
const HANGING: &str = r#"
    version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 1 } }
    density = 0.08
    [[crease]]
    at = { line = { from = [0, 0.1, 0], to = [0.2, 0.1, 0] } }
    stiffness = 1e-3
    angle = { sine = { amplitude = 30, frequency = 1 } }
    [[support]]
    at = { vertices = [20] }
    hold = { moving_pin = { z = { sine = { amplitude = 0.01, frequency = 2 } } } }
    [[forces.load]]
    at = { vertices = [0] }
    direction = [1, 0, 0]
    size = 0
    [forces]
    gravity = [0, 0, -9.81]
    [method]
    step = 0.01
"#;

fn live(text: &str) -> LiveScene {
    let file = parse(text).unwrap_or_else(|e| panic!("{e}"));
    LiveScene::start(file).unwrap_or_else(|e| panic!("{e}"))
}

fn key(text: &str) -> Key {
    text.parse().expect("a key")
}

fn edit(text: &str) -> Edit {
    text.parse().expect("an edit")
}

fn step(live: &mut LiveScene, count: usize) {
    for _ in 0..count {
        live.step(0.01).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Position of vertex 20.
fn pin(live: &LiveScene) -> &[f64] {
    &live.simulation().state().x[60..63]
}

#[test]
fn a_driven_pin_begins_where_it_is_and_ends_where_it_is_sent() {
    let mut live = live(HANGING);
    step(&mut live, 3);
    let start = live.facts().sheet.positions()[62];
    let before = 0.01 * (std::f64::consts::TAU * 2.0 * live.simulation().state().t).sin();
    assert!((pin(&live)[2] - start - before).abs() < 1e-15);
    live.drive(&[(key("support[0].hold.moving_pin.z"), 0.05.into())], 0.05)
        .expect("a function of time");
    step(&mut live, 1);
    assert!((pin(&live)[2] - start - 0.5 * (before + 0.05)).abs() < 1e-15);
    step(&mut live, 2);
    assert!((pin(&live)[2] - start - 0.05).abs() < 1e-15);
    step(&mut live, 1);
    assert!((pin(&live)[2] - start - 0.05).abs() < 1e-15);
}

/// The angle is driven in degrees, from its present value: the energy does not jump.
#[test]
fn angles_are_driven_from_where_they_are() {
    let mut live = live(HANGING);
    step(&mut live, 4);
    let before = live.simulation().energy();
    live.drive(&[(key("crease[0].angle"), 90.0.into())], 1.0)
        .expect("a function of time");
    let after = live.simulation().energy();
    assert!(
        (after - before).abs() < 1e-12 * before.abs(),
        "{before} J, {after} J"
    );
    let text = &live.file().text().text;
    assert!(
        text.contains("to = 90.0") && text.contains("end = 1.0"),
        "{text}"
    );
}

#[test]
fn a_change_of_nothing_leaves_every_bit() {
    let (mut left, mut changed) = (live(HANGING), live(HANGING));
    for _ in 0..3 {
        step(&mut left, 1);
        step(&mut changed, 1);
        changed
            .change(&[edit("forces.gravity=[0, 0, -9.81]")])
            .expect("the same");
    }
    assert_eq!(left.simulation().state(), changed.simulation().state());
}

/// A scene that was changed is resumed with the changed scene, bit for bit.
#[test]
fn a_changed_scene_is_resumed_bit_for_bit() {
    let mut live = live(HANGING);
    step(&mut live, 2);
    live.change(&[edit("forces.load[0].size=0.01"), edit("sheet.damping=1")])
        .expect("a change");
    live.drive(
        &[(key("support[0].hold.moving_pin.x"), (-0.02).into())],
        0.1,
    )
    .expect("a change");
    step(&mut live, 1);
    let bytes = live.simulation().checkpoint().to_bytes().expect("bytes");
    let checkpoint = Checkpoint::from_bytes(&bytes).expect("a checkpoint");
    let mut resumed = LiveScene::resume(live.file().clone(), checkpoint).expect("the scene");
    step(&mut live, 3);
    step(&mut resumed, 3);
    assert_eq!(live.simulation().state(), resumed.simulation().state());
    assert_eq!(live.support_forces(), resumed.support_forces());
}

/// What cannot be changed is refused with the key that is to blame, and nothing has changed.
#[test]
fn what_cannot_change_is_refused() {
    let mut live = live(HANGING);
    step(&mut live, 2);
    for (changed, at) in [
        ("method.integrator=implicit_euler", "method"),
        ("sheet.start.perturbation=0.1", "sheet.start"),
        (
            "sheet.mesh={ disk = { radius = 0.1, rings = 2 } }",
            "sheet.mesh",
        ),
        ("support[0].hold.moving_pin.z=0", "support[0].hold"),
        ("sheet.density=-1", "sheet.density"),
        ("sheet.density=0.1", ""),
        ("contact.self_contact=true", "contact"),
    ] {
        let before = (live.file().clone(), live.simulation().checkpoint());
        let Err(SceneFileError::Scene(error)) = live.change(&[edit(changed)]) else {
            panic!("{changed} is no error of the scene");
        };
        assert_eq!(error.problems()[0].key.to_string(), at, "{error}");
        // Nobody who changes a scene knows of the checkpoint by which the simulation goes on.
        assert!(!error.to_string().contains("checkpoint"), "{error}");
        assert_eq!(
            (live.file().clone(), live.simulation().checkpoint()),
            before
        );
    }
    for wrong in ["support[0].hold.pin.z", "sheet.mesh", "forces.load[1].size"] {
        let error = live
            .drive(&[(key(wrong), 1.0.into())], 1.0)
            .expect_err("no function of time");
        assert!(
            error
                .to_string()
                .contains(&format!("no function of time at `{wrong}`")),
            "{error}"
        );
    }
    let past = live
        .drive(&[(key("crease[0].angle"), 1.0.into())], 0.0)
        .expect_err("it is over");
    assert!(
        past.to_string().contains("crease[0].angle.ramp.end") || past.to_string().contains("end")
    );
}

#[test]
fn a_step_that_fails_names_error_and_key() {
    let mut live = live(HANGING);
    let failed = live.step(-1.0).expect_err("no step");
    assert_eq!(failed.step, Some(StepError::StepSize { h: -1.0, t: 0.0 }));
    assert!(failed.to_string().contains("step size"), "{failed}");
}

#[test]
fn a_run_ends_with_a_short_step() {
    let mut live = live(HANGING);
    let mut lengths = Vec::new();
    while let Some(h) = live.next_step(0.035) {
        lengths.push(h);
        live.step(h).expect("accepted");
    }
    assert_eq!(lengths[..3], [0.01; 3]);
    assert!(
        lengths.len() == 4 && (lengths[3] - 0.005).abs() < 1e-15,
        "{lengths:?}"
    );
}

/// Triangles in the scene are the mesh that has them.
#[test]
fn triangles_are_a_mesh() {
    let square = parse(HANGING).expect("a scene");
    let sheet = square.scene().sheet[0]
        .mesh
        .sheet(Path::new("."))
        .expect("a mesh");
    let triangles = Mesh::Triangles {
        vertices: sheet.positions().as_chunks::<3>().0.to_vec(),
        faces: sheet.face_indices(),
    };
    let mut scene = square.scene().clone();
    scene.sheet[0].mesh = triangles;
    let text = toml::to_string(&scene).expect("TOML");
    let (mut generated, mut given) = (live(HANGING), live(&text));
    step(&mut generated, 2);
    step(&mut given, 2);
    assert_eq!(generated.simulation().state(), given.simulation().state());
    scene.sheet[0].mesh = Mesh::Triangles {
        vertices: vec![[0.0; 3]; 3],
        faces: vec![[0, 1, 5]],
    };
    let error = scene.build(Path::new(".")).expect_err("no mesh");
    assert_eq!(
        error.problems()[0].key.to_string(),
        "sheet.mesh.triangles.faces"
    );
}

/// Holding a vertex and letting go of it without a step in between changes no bit.
#[test]
fn a_hand_that_does_nothing_leaves_no_trace() {
    let [mut one, mut other] = [live(HANGING), live(HANGING)];
    step(&mut one, 3);
    step(&mut other, 3);
    other.hold(VertexId(3)).expect("a vertex that moves");
    other.let_go().expect("the same scene");
    other.let_go().expect("nothing is held");
    step(&mut one, 3);
    step(&mut other, 3);
    assert_eq!(
        one.simulation().checkpoint(),
        other.simulation().checkpoint()
    );
}

/// The weight of a sheet that hangs from a hand stretches the spring by a hundredth of its diagonal.
#[test]
fn a_hand_holds_the_weight_of_a_sheet() {
    let mut live = live(
        r#"
        version = 1
        [sheet]
        mesh = { square = { side = 0.3, level = 1 } }
        density = 0.08
        damping = 20
        [forces]
        gravity = [0, 0, -9.80665]
        "#,
    );
    let vertex = VertexId(0);
    let hand = live.hold(vertex).expect("a vertex that moves");
    step(&mut live, 1200);
    let x = &live.simulation().state().x;
    let stretch = hand[2] - x[3 * vertex.index() + 2];
    assert!((stretch - 0.003 * 2.0_f64.sqrt()).abs() < 1e-5, "{stretch}");
    // The energy of the spring, k d^2 / 2, is gone with it, as work.
    let before = live.simulation().energy();
    live.let_go().expect("the same scene");
    let released = before - live.simulation().energy();
    // Standard gravity times the mass over the stretch under the whole weight.
    let stiffness = 0.3 * 0.3 * 0.08 * 9.80665 / (0.003 * 2.0_f64.sqrt());
    let want = 0.5 * stiffness * stretch * stretch;
    assert!((released - want).abs() < 1e-3 * want, "{released}, {want}");
    assert!(live.hand().is_none());
}

/// A hand is led and a crease is driven at the same time; what both do is work.
#[test]
fn a_scene_changes_while_a_vertex_is_held() {
    let mut live = live(HANGING);
    let start = live.hold(VertexId(0)).expect("a vertex that moves");
    live.lead([start[0], start[1], start[2] + 0.02], 0.05)
        .expect("finite");
    step(&mut live, 2);
    live.drive(&[(key("crease[0].angle"), 45.0.into())], 0.1)
        .expect("a function of time");
    assert_eq!(live.hand().map(|(vertex, _)| vertex), Some(VertexId(0)));
    step(&mut live, 8);
    let height = live.simulation().state().x[2] - start[2];
    assert!((height - 0.02).abs() < 0.005, "{height}");
}

#[test]
fn pins_and_vertices_that_there_are_not_cannot_be_held() {
    let mut live = live(HANGING);
    step(&mut live, 1);
    let before = live.simulation().checkpoint();
    let held = live.hold(VertexId(20)).map(drop);
    assert!(
        matches!(
            held,
            Err(HoldError::Held {
                vertex: VertexId(20)
            })
        ),
        "{held:?}"
    );
    let held = live.hold(VertexId(25)).map(drop);
    assert!(matches!(held, Err(HoldError::Hand(_))), "{held:?}");
    assert_eq!(live.simulation().checkpoint(), before);
}

/// The length of a step is what is wrong with a step of a wrong length; a smaller one is no remedy.
#[test]
fn lengths_of_steps_are_positive() {
    let mut live = live(HANGING);
    for h in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        let said = live.step(h).unwrap_err().to_string();
        assert!(
            said.contains("the step size is") && said.contains("positive finite"),
            "{said}"
        );
        assert!(!said.contains("smaller"), "{said}");
    }
}

/// The text of a scene that was changed is that of the scene as it is, with its comments: what was changed
/// stands in its place, also where the text has left out what it is in.
#[test]
fn the_text_of_a_changed_scene_is_that_of_the_scene() {
    let text = HANGING.replace("[forces]\n", "[forces] # on earth\n") + "[air]\ndensity = 1\n";
    let mut live = live(&text);
    step(&mut live, 1);
    live.drive(
        &[
            (key("air.wind[1]"), 2.0.into()),
            (key("crease[0].angle"), 20.0.into()),
        ],
        1.0,
    )
    .expect("functions of time");
    live.change(&[
        edit("forces.gravity=[0, 0, 1]"),
        edit("contact.friction=0.5"),
    ])
    .expect("a change");
    live.drive(&[(key("air.wind[1]"), 3.0.into())], 2.0)
        .expect("a function of time");
    let changed = live.file();
    let text = &changed.text().text;
    assert!(text.contains("[forces] # on earth"), "{text}");
    assert_eq!(parse(text).expect("a scene").scene(), changed.scene());
    let ProfileKey::Course(course) = &changed.scene().air.as_ref().expect("air").wind[1] else {
        panic!("{text}");
    };
    assert!(format!("{course:?}").contains("to: 3.0"), "{course:?}");
}

/// An obstacle that a change puts elsewhere would have passed through what is on its way; one that moves on
/// from where it is meets the sheet.
#[test]
fn obstacles_do_not_jump() {
    let mut live = live(
        "version = 1\n[sheet]\nmesh = { square = { side = 0.2, level = 1 } }\ndensity = 0.08\n\
         [[obstacle]]\nshape = { box = { size = [1, 1, 0.01] } }\npose = { position = [0, 0, -0.02] }\n",
    );
    step(&mut live, 1);
    for (changed, at) in [
        ("obstacle[0].pose.position=[0, 0, 0.2]", "obstacle[0]"),
        ("obstacle[0].motion.z=0.2", "obstacle[0]"),
        (
            "obstacle[0].pose.turn={ axis = [1, 0, 0], angle = 180 }",
            "obstacle[0]",
        ),
        (
            "obstacle[0].shape={ box = { size = [9, 9, 0.01] } }",
            "obstacle[0].shape",
        ),
    ] {
        let before = (live.file().clone(), live.simulation().checkpoint());
        let Err(SceneFileError::Scene(error)) = live.change(&[edit(changed)]) else {
            panic!("{changed} is no error of the scene");
        };
        assert_eq!(error.problems()[0].key.to_string(), at, "{error}");
        assert_eq!(
            (live.file().clone(), live.simulation().checkpoint()),
            before
        );
    }
    live.change(&[
        edit("obstacle[0].friction=0.5"),
        edit("obstacle[0].motion.z={ smooth_step = { to = 0.1, begin = 0.01, end = 0.2 } }"),
    ])
    .expect("an obstacle that goes on from where it is");
    live.drive(&[(key("obstacle[0].motion.z"), 0.05.into())], 0.1)
        .expect("the same");
    step(&mut live, 10);
    let lowest = live
        .simulation()
        .state()
        .x
        .iter()
        .skip(2)
        .step_by(3)
        .fold(f64::INFINITY, |l, z| l.min(*z));
    assert!(lowest > 0.03, "the box lifts the sheet: {lowest} m");
}

/// A simulation goes on with the meshes that it has, wherever their files are now.
#[test]
fn a_scene_changes_without_its_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = folder.path().join("sheet.obj");
    let faces = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    std::fs::write(&mesh, faces).expect("a file");
    let text = "version = 1\n[sheet]\nmesh = { file = { path = \"sheet.obj\" } }\n";
    let file = SceneFile::parse(text.into(), &folder.path().join("scene.toml"), &[]);
    let mut live = LiveScene::start(file.expect("a scene")).expect("a simulation");
    std::fs::remove_file(&mesh).expect("a file");
    live.change(&[edit("forces.gravity=[0, 0, -2]")])
        .expect("no file is read");
    step(&mut live, 10);
    live.hold(VertexId(0)).expect("no file is read");
    let height = live.simulation().state().x[2];
    assert!((height + 0.01).abs() < 1e-3, "{height}");
}
