//! Obstacles and supports that are led through poses of six degrees of freedom.

use crate::parse;
use isosheet_scenes::{FramePose, Key, LiveScene, SceneFileError, Target};

/// A sheet with a clamp that a tool holds, whose frame is at its edge, and a box above it.
const HELD: &str = r#"
    version = 1
    [sheet]
    mesh = { rectangle = { width = 0.2, height = 0.1, columns = 4, rows = 2 } }
    material = "office paper"
    [[support]]
    at = { box = { min = [0, 0, 0], max = [0, 0.1, 0] } }
    hold = { moving_clamp = { poses = { keys = [{ position = [0.01, 0.05, 0.02] }] } } }
    [[obstacle]]
    shape = { box = { size = [0.04, 0.06, 0.02] } }
    pose = { position = [0.1, 0.05, 0.3], turn = { axis = [0, 0, 1], angle = 90 } }
    [forces]
    gravity = [0, 0, -9.81]
    [method]
    step = 0.01
"#;

const CLAMP: &str = "support[0].hold.moving_clamp";

fn live(text: &str) -> LiveScene {
    let file = parse(text).unwrap_or_else(|e| panic!("{e}"));
    LiveScene::start(file).unwrap_or_else(|e| panic!("{e}"))
}

fn key(text: &str) -> Key {
    text.parse().expect("a key")
}

fn pose(position: [f64; 3], orientation: [f64; 4]) -> Target {
    let pose = FramePose {
        position,
        orientation,
    };
    pose.into()
}

/// The matrix of a rotation by a unit quaternion `w, x, y, z`, written out.
fn matrix([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

/// Where the matrix and the shift take a point.
fn placed(matrix: [[f64; 3]; 3], p: [f64; 3], shift: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| shift[k] + (0..3).map(|j| matrix[k][j] * p[j]).sum::<f64>())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// A tool turns by an angle about an axis of no coordinate while it moves: at half of the time its held
/// vertices are at half of the way, turned by half of the angle (the formula of Rodrigues), and at the end
/// where the matrix of the quaternion takes them.
#[test]
fn a_tool_carries_what_it_holds_through_poses() {
    let mut live = live(HELD);
    let (axis, angle) = ([2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], 0.3_f64);
    let quaternion = |angle: f64| {
        let (sin, cos) = (0.5 * angle).sin_cos();
        [cos, sin * axis[0], sin * axis[1], sin * axis[2]]
    };
    let (from, to) = ([0.01, 0.05, 0.02], [0.012, 0.047, 0.03]);
    live.drive(&[(key(CLAMP), pose(to, quaternion(angle)))], 0.2)
        .expect("a pose");
    let rest = live.facts().sheet.positions().to_vec();
    let held: Vec<usize> = (0..rest.len() / 3).filter(|v| rest[3 * v] == 0.0).collect();
    assert_eq!(held.len(), 3);
    for (part, steps) in [(0.5, 10), (1.0, 10), (1.0, 3)] {
        for _ in 0..steps {
            live.step(0.01).unwrap_or_else(|e| panic!("{e}"));
        }
        let shift = std::array::from_fn(|k| from[k] + part * (to[k] - from[k]));
        for v in &held {
            let at = |x: &[f64]| [x[3 * v], x[3 * v + 1], x[3 * v + 2]];
            let arm = std::array::from_fn(|k| at(&rest)[k] - from[k]);
            let want = placed(matrix(quaternion(part * angle)), arm, shift);
            let is = at(&live.simulation().state().x);
            assert!(distance(is, want) < 1e-14, "{v}: {is:?}, {want:?}");
        }
    }
}

/// The pose of an obstacle is its own, from one control step to the next.
#[test]
fn an_obstacle_is_where_its_pose_says() {
    let mut live = live(HELD);
    let key = key("obstacle[0].motion");
    let half = 0.5_f64.sqrt();
    // The quarter turn of the scene, further ones about other axes, and the other sign of the same rotation.
    for (k, q) in [
        [half, 0.0, 0.0, half],
        [0.5, 0.5, 0.5, 0.5],
        [-0.8, 0.0, -0.6, 0.0],
        [0.48, 0.6, 0.0, 0.64],
    ]
    .into_iter()
    .enumerate()
    {
        let position = [0.1 + 0.01 * k as f64, 0.05, 0.3];
        let until = live.simulation().state().t + 0.01;
        live.drive(&[(key.clone(), pose(position, q))], until)
            .unwrap_or_else(|e| panic!("{e}"));
        live.step(0.01).unwrap_or_else(|e| panic!("{e}"));
        let body = live.facts().obstacles[0].motion().pose(until);
        let corner = [0.02, -0.03, 0.01];
        let is = (body * nalgebra::Point3::from(corner)).coords.into();
        let want = placed(matrix(q), corner, position);
        assert!(distance(is, want) < 1e-14, "{k}: {is:?}, {want:?}");
    }
    let text = &live.file().text().text;
    let again = parse(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(again.scene(), live.file().scene(), "{text}");
}

/// Displacements go on where a pose took over from them.
#[test]
fn a_pose_goes_on_from_displacements() {
    let text = HELD.replace(
        "poses = { keys = [{ position = [0.01, 0.05, 0.02] }] }",
        "z = { ramp = { to = 0.01, end = 0.05 } }",
    );
    let mut live = live(&text);
    for _ in 0..5 {
        live.step(0.01).unwrap_or_else(|e| panic!("{e}"));
    }
    // The frame is that of space at the start.
    let target = pose([0.0, 0.0, 0.01], [1.0, 0.0, 0.0, 0.0]);
    live.drive(&[(key(CLAMP), target)], 0.1).expect("a pose");
    for _ in 0..5 {
        live.step(0.01).unwrap_or_else(|e| panic!("{e}"));
        assert!((live.simulation().state().x[2] - 0.01).abs() < 1e-15);
    }
}

/// What is no pose is refused at the number that is to blame, and nothing has changed.
#[test]
fn wrong_poses_are_refused() {
    let mut live = live(HELD);
    let at = [0.1, 0.05, 0.3];
    let still = [1.0, 0.0, 0.0, 0.0];
    let single = [0.5_f32.sqrt(), 0.0, 0.0, 0.5_f32.sqrt()].map(f64::from);
    let quarter = [0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt()];
    for (target, until, place, says) in [
        (
            pose([f64::NAN, 0.0, 0.0], still),
            1.0,
            "keys[1].position[0]",
            "nan",
        ),
        (
            pose(at, [f64::INFINITY, 0.0, 0.0, 0.0]),
            1.0,
            "keys[1].orientation[0]",
            "inf",
        ),
        (
            pose(at, [0.0; 4]),
            1.0,
            "keys[1].orientation",
            "by -1 from 1",
        ),
        (
            pose(at, [1.0, 0.0, 0.0, 0.01]),
            1.0,
            "keys[1].orientation",
            "by 5e-5 from 1",
        ),
        (pose(at, quarter), 0.0, "keys[1]", "come after"),
        // By half a turn against the quarter turn of the scene.
        (
            pose(at, [quarter[0], 0.0, 0.0, -quarter[3]]),
            1.0,
            "keys[1]",
            "half a turn",
        ),
    ] {
        let before = live.file().clone();
        let Err(SceneFileError::Scene(error)) =
            live.drive(&[(key("obstacle[0].motion"), target)], until)
        else {
            panic!("{place} is no error of the scene");
        };
        let place = format!("obstacle[0].motion.poses.{place}");
        assert_eq!(error.problems()[0].key.to_string(), place, "{error}");
        assert!(error.to_string().contains(says), "{error}");
        assert_eq!(*live.file(), before);
    }
    // Single precision is enough.
    live.drive(&[(key("obstacle[0].motion"), pose(at, single))], 1.0)
        .unwrap_or_else(|e| panic!("{e}"));
    for wrong in [
        "obstacle[0].motion.z",
        "support[0].hold",
        "obstacle[1].motion",
    ] {
        let error = live.drive(&[(key(wrong), pose(at, still))], 2.0);
        assert!(
            matches!(&error, Err(SceneFileError::Edit(e)) if e.to_string().contains("no rigid motion")),
            "{error:?}"
        );
    }
    let both = HELD.replace("poses = {", "x = 1.0, poses = {");
    let error = parse(&both).map(drop).unwrap_err().to_string();
    assert!(error.contains("in place of `x`"), "{error}");
}

/// From the second time on nothing is built anew for what is driven: the bits agree with a simulation that
/// is.
#[test]
fn what_is_led_has_the_bits_of_what_is_built_anew() {
    let pins = HELD.replace(
        "moving_clamp = { poses = { keys = [{ position = [0.01, 0.05, 0.02] }] } }",
        "moving_pin = {}",
    );
    let sliding = HELD
        .replace(
            "moving_clamp = { poses",
            "sliding_clamp = { direction = [0, 1, 0], motion = { poses",
        )
        .replace("0.02] }] } } }", "0.02] }] } } } }");
    let tool = |k: usize| {
        let angle = 0.02 * (k + 1) as f64;
        pose(
            [0.01, 0.05, 0.02 + 0.002 * k as f64],
            [angle.cos(), 0.0, angle.sin(), 0.0],
        )
    };
    for (text, driven, target) in [
        (HELD, CLAMP, &tool as &dyn Fn(usize) -> Target),
        (&sliding, "support[0].hold.sliding_clamp.motion", &tool),
        (&pins, "support[0].hold.moving_pin", &tool),
        (&pins, "support[0].hold.moving_pin.z", &|k| {
            (0.001 * k as f64).into()
        }),
    ] {
        let (mut led, mut anew) = (live(text), live(text));
        for k in 0..4 {
            let until = led.simulation().state().t + 0.02;
            let box_at = pose([0.1, 0.05, 0.3 - 0.01 * k as f64], [0.5, 0.5, 0.5, 0.5]);
            let targets = [
                (key(driven), target(k)),
                (key("obstacle[0].motion"), box_at),
            ];
            led.drive(&targets, until)
                .unwrap_or_else(|e| panic!("{driven}: {e}"));
            anew.drive(&targets, until)
                .unwrap_or_else(|e| panic!("{driven}: {e}"));
            let checkpoint = anew.simulation().checkpoint();
            anew = LiveScene::resume(anew.file().clone(), checkpoint).expect("the same scene");
            for _ in 0..2 {
                let reports = [&mut led, &mut anew].map(|one| one.step(0.01).expect("a step"));
                assert_eq!(reports[0], reports[1], "{driven}");
            }
            assert_eq!(
                led.simulation().checkpoint(),
                anew.simulation().checkpoint(),
                "{driven}"
            );
            assert_eq!(led.file(), anew.file());
        }
    }
}

/// A hand that jumps farther in a step than the sheet is large is told, with its speed and one that is below
/// that.
#[test]
fn what_moves_too_fast_is_told() {
    let clamp =
        "hold = { moving_clamp = { poses = { keys = [{ position = [0.01, 0.05, 0.02] }] } } }";
    let text = HELD.replace(clamp, "hold = { moving_clamp = {} }");
    let mut live = live(&text);
    live.drive(&[(key("support[0].hold.moving_clamp.z"), 1e4.into())], 0.01)
        .expect("a function of time");
    let error = live.step(0.01).map(drop).unwrap_err().to_string();
    // The diagonal of 0.2 m x 0.1 m, and that in a step.
    for says in [
        "`support[0].hold.moving_clamp` moves by 10000 m in a step of 0.01 s, at 1e6 m/s, and the sheet is 0.224 m across",
        "below 22.4 m/s",
        "`method.step` below 2.24e-7 s",
    ] {
        assert!(error.contains(says), "{error}");
    }
}

/// Obstacles have the names of the scene in messages.
#[test]
fn messages_have_the_names_of_obstacles() {
    let named = HELD.replace("shape = {", "name = \"punch\"\n    shape = {");
    let touching = named.replace("position = [0.1, 0.05, 0.3]", "position = [0.1, 0.05, 0.0]");
    let start = |text: &str| LiveScene::start(parse(text).expect("a scene")).map(drop);
    let error = start(&touching).unwrap_err();
    assert!(
        error.to_string().contains("the obstacle `punch` touches"),
        "{error}"
    );
    assert_eq!(error.problems()[0].key.to_string(), "obstacle[0]");
    let unnamed = start(&touching.replace("name = \"punch\"", "")).unwrap_err();
    assert!(
        unnamed.to_string().contains("the obstacle touches"),
        "{unnamed}"
    );
    let mut live = live(&named);
    live.drive(&[(key("obstacle[0].motion.z"), (-1e4).into())], 0.01)
        .expect("a function of time");
    let error = live.step(0.01).map(drop).unwrap_err().to_string();
    assert!(error.contains("`punch` moves by 10000 m"), "{error}");
}
