//! Values without sense.

use isosheet_scenes::{SceneFile, StartingPoint};
use std::path::Path;

/// Scenes that use most keys and need no file.
const VARIED: &str = "version = 1
[sheet]
mesh = { annulus = { inner = 0.1, outer = 0.2, segments = 8, rings = 2 } }
thickness = 1e-4
isometry = { elastic = { stiffness = 1000.0, poisson = 0.3, limit = 0.2 } }
bending = { plate = { rigidity = 1e-3 } }
damping = 1.0
placement = { position = [0, 0, 1], turn = { axis = [0, 0, 1], angle = 45 } }
start = { perturbation = 0.01, seed = 3 }
[[crease]]
at = { ends = [[0, 8]] }
stiffness = 0.1
angle = { sine = { mean = 1, amplitude = 2, frequency = 3, phase = 4 } }
[[support]]
at = { nearest = [[0.2, 0, 1]] }
hold = { moving_pin = { z = { keyframes = { keys = [[0, 0], [1, 0.1]] } },
    rotation = { centre = [0, 0, 0], axis = [0, 0, 1], angle = { ramp = { to = 5, begin = 0, end = 1 } } } } }
[[support]]
at = { box = { min = [-1, -1, 0], max = [-0.1, 1, 2] } }
hold = { surface = { shape = { plane = { point = [0, 0, 1], normal = [0, 0, 1] } } } }
[[obstacle]]
shape = { capsule = { radius = 0.1, length = 0.1 } }
pose = { position = [0, 0, 0.5], turn = { axis = [1, 0, 0], angle = 30 } }
motion = { x = 0.01, rotation = { centre = [0, 0, 0], axis = [0, 0, 1], angle = 3 } }
friction = 0.1
[contact]
self_contact = true
friction = 0.2
activation = 1e-3
stiffness = 1e-3
rest_speed = 1e-3
[forces]
gravity = [0, 0, -9.81]
[[forces.load]]
at = \"boundary\"
direction = [1, 0, 0]
size = 0.001
[[forces.acceleration]]
direction = [1, 0, 0]
size = 1
[air]
density = 1.2
normal = 1.1
tangential = 0.01
wind = [{ sine = { mean = 2, amplitude = 1, frequency = 0.5 } }, 1, 0]
[method]
step = 0.01
strain_tolerance = 1e-10
max_iterations = 50
rod_stiffness = 1e5
min_fraction = 0.1
[stop]
time = 2
rest = { speed = 1e-3, duration = 0.1 }
support_force = 10
";

/// Shapes by formula.
const FORMULAS: &str = "version = 1
[sheet]
mesh = { polygon_rings = { outline = { regular = { sides = 5, radius = 0.2 } }, rings = 2 } }
mass = 0.01
start = { perturbation = 0.1, seed = 1 }
[[support]]
at = { vertices = [0] }
[[obstacle]]
shape = { prism = { outline = [[1, 0], [0, 1], [-1, -1]], height = 0.2 } }
pose = { position = [0, 0, -2] }
[[obstacle]]
shape = { frame = { outer = 0.5, opening = 0.2, bottom = -1.2, top = -1.1 } }
[[obstacle]]
shape = { wall = { line = [[0, -3], [1, -3], [1, -4]], corner_radius = 0.25, width = 0.4 } }
[forces]
gravity = [0, 0, -9.81]
[method]
step = 0.001
";

/// Motion in a chart.
const CHART: &str = "version = 1
[sheet]
mesh = { polygon_rings = { outline = { regular = { sides = 5, radius = 0.2 } }, rings = 2 } }
mass = 0.01
start = { perturbation = 0.1, seed = 1 }
[[support]]
at = { vertices = [0] }
[forces]
gravity = [0, 0, -9.81]
[method]
integrator = \"chart\"
step = 0.001
[method.chart]
scheme = \"forward_euler\"
substep = { adaptive = { tolerance = 1e-4, min = 1e-6, max = 0.001 } }
";

/// The ways to the numbers of a scene, as keys of edits.
fn numbers(value: &toml::Value, key: &str, found: &mut Vec<String>) {
    let below = |name: &str| match key {
        "" => name.to_owned(),
        key => format!("{key}.{name}"),
    };
    match value {
        toml::Value::Integer(_) | toml::Value::Float(_) => found.push(key.to_owned()),
        toml::Value::Array(entries) => {
            for (k, entry) in entries.iter().enumerate() {
                numbers(entry, &below(&k.to_string()), found);
            }
        }
        toml::Value::Table(entries) => {
            for (name, entry) in entries {
                numbers(entry, &below(name), found);
            }
        }
        _ => {}
    }
}

/// Whatever number is replaced by whatever value: a step is taken and is finite, or an error says what to do.
#[test]
fn no_value_makes_it_panic_or_gives_nan() {
    // The smallest meshes, and few attempts at steps that cannot be taken.
    let small = ["sheet.mesh.square.level=0", "method.min_fraction=0.2"].map(str::to_owned);
    let kinds: [(&str, &[String]); 5] = [
        (StartingPoint::Drape.text(), &small),
        (StartingPoint::Fold.text(), &small[1..]),
        (VARIED, &small[1..]),
        (FORMULAS, &[]),
        (CHART, &[]),
    ];
    let values = [
        "0",
        "-1",
        "nan",
        "inf",
        "1e300",
        "1e-300",
        "9223372036854775807",
    ];
    let (mut accepted, mut refused) = (0, 0);
    for (text, edits) in kinds {
        let path = Path::new("test.toml");
        let base = SceneFile::parse(text.into(), path, edits).unwrap();
        base.build().unwrap().start().map(|_| ()).unwrap();
        let mut keys = Vec::new();
        numbers(&toml::from_str(text).unwrap(), "", &mut keys);
        for (key, value) in keys.iter().flat_map(|k| values.map(|v| (k, v))) {
            let edit = format!("{key}={value}");
            let edits = [edits, std::slice::from_ref(&edit)].concat();
            let scene = SceneFile::parse(text.into(), path, &edits);
            let run = scene.and_then(|scene| Ok((scene.build()?.start()?, scene)));
            match run {
                Ok((mut run, scene)) => {
                    accepted += 1;
                    if let Ok(report) = run.step(scene.scene().method.step) {
                        assert!(report.hamiltonian().is_finite(), "{edit}: {report:?}");
                        assert!(run.state().x.iter().all(|c| c.is_finite()), "{edit}");
                    }
                }
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().len() > 60, "{edit}: {error}");
                }
            }
        }
    }
    assert!(accepted > 150 && refused > 300, "{accepted}, {refused}");
}
