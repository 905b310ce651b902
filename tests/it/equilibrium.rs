//! Searches for equilibria against closed forms.

use isosheet_dynamics::{ImplicitOptions, Method, Simulation, StepError, StepReport};
use isosheet_mesh::Sheet;
use isosheet_scenes::SceneFile;
use isosheet_tests::{Catenary, Elastica, HangingStrip, buckled, max_difference};
use std::f64::consts::TAU;
use std::path::Path;

/// The scene at rest, and the report of its last step.
fn rest(scene: String) -> Result<(Sheet, Simulation, StepReport), StepError> {
    let file = SceneFile::parse(scene, Path::new("scene.toml"), &[]).unwrap();
    let (scene, keys) = file.scene().at_rest();
    let steps = (scene.stop.time / scene.method.step).round() as usize;
    let h = scene.method.step;
    let setup = file.changed(scene, keys).unwrap().build().unwrap();
    let sheet = setup.sheet.clone();
    let mut run = setup.start().unwrap();
    let mut last = run.step(h)?;
    for _ in 1..steps {
        last = run.step(h)?;
    }
    Ok((sheet, run, last))
}

/// A strip of a material without Poisson's effect, clamped at one end, with its length (metres) and gravity
/// (m/s2).
fn strip(length: f64, gravity: f64) -> String {
    let width = 0.1 * length;
    format!(
        "version = 1
         sheet.mesh.rectangle = {{ width = {length}, height = {width}, columns = 80, rows = 2 }}
         sheet.material = {{ youngs = {YOUNGS}, thickness = {THICKNESS}, density = {DENSITY}, poisson = 0 }}
         forces.gravity = [0, 0, -{gravity}]
         stop.time = 1
         [[support]]
         at = {{ box = {{ min = [-1, -1, -1], max = [1e-9, 1, 1] }} }}
         hold = \"clamp\""
    )
}

const YOUNGS: f64 = 4e9;
const THICKNESS: f64 = 1e-4;
const DENSITY: f64 = 800.0;
const RIGIDITY: f64 = YOUNGS * THICKNESS * THICKNESS * THICKNESS / 12.0;

/// The mesh has 80 squares along the strip, and its errors are of second order: a part of 1/6400 of some
/// size.
const MESH: f64 = 5e-3;

#[test]
fn a_clamped_strip_hangs_as_the_heavy_elastica() {
    for length in [0.05, 0.15, 0.3] {
        let (sheet, run, _) = rest(strip(length, 9.81)).unwrap();
        let elastica = Elastica {
            length,
            rigidity: RIGIDITY,
            weight: 9.81 * THICKNESS * DENSITY,
        };
        let points = sheet.positions().as_chunks::<3>().0.iter();
        let ends = points.zip(run.state().x.as_chunks::<3>().0);
        let ends = ends.filter(|(rest, _)| rest[0] > length * (1.0 - 1e-9));
        let lowest = ends.map(|(_, x)| -x[2]).fold(0.0, f64::max);
        let error = lowest / elastica.drop() - 1.0;
        assert!(error.abs() < MESH, "{length}: {error}");
    }
}

#[test]
fn the_lowest_frequency_is_that_of_a_cantilever() {
    let length = 0.1;
    let (_, _, report) = rest(strip(length, 0.0)).unwrap();
    // The least root of `cos b cosh b = -1`.
    let root = 1.875_104_068_7_f64;
    let exact = root * root / TAU / (length * length) * (RIGIDITY / (THICKNESS * DENSITY)).sqrt();
    let error = report.lowest_frequency.unwrap() / exact - 1.0;
    assert!(error.abs() < MESH, "{error}");
}

#[test]
fn a_strip_that_is_exactly_flat_buckles() {
    let distance = 0.7;
    let scene = format!(
        "version = 1
         sheet.mesh.rectangle = {{ width = 1, height = 0.25, columns = 40, rows = 4 }}
         sheet.density = 0.1
         sheet.isometry.elastic = {{ stiffness = 1e5, poisson = 0 }}
         sheet.bending.plate = {{ rigidity = 1e-2, poisson = 0 }}
         stop.time = 1
         method.step = 0.1
         [[support]]
         at = {{ box = {{ min = [-1, -1, -1], max = [0.026, 1, 1] }} }}
         [[support]]
         at = {{ box = {{ min = [0.974, -1, -1], max = [2, 1, 1] }} }}
         hold = {{ moving_pin = {{ x = {{ ramp = {{ to = -{}, end = 1 }} }} }} }}",
        (1.0 - distance) * 0.95
    );
    let (_, run, report) = rest(scene).unwrap();
    let highest = run.state().x.as_chunks::<3>().0.iter();
    let highest = highest.map(|x| x[2].abs()).fold(0.0, f64::max);
    // Between the clamps are 38 squares.
    let [energy, height] = buckled(distance);
    let error = highest / (0.95 * height) - 1.0;
    assert!(error.abs() < 0.02, "height {highest} {height}: {error}");
    let energy = energy * 1e-2 * 0.25 / 0.95;
    let error = report.potential / energy - 1.0;
    assert!(error.abs() < 0.04, "energy {}: {error}", report.potential);
}

#[test]
fn rods_rest_where_their_forces_balance() {
    let strip = Catenary {
        rods: 8,
        length: 0.1,
        span: 0.6,
        gravity: 9.8,
    };
    let method = Method::Equilibrium(ImplicitOptions::default());
    let mut run = Simulation::new(strip.model(), strip.start(), method.clone()).unwrap();
    run.step(1.0).unwrap();
    // Forces are left of a millionth.
    let error = max_difference(&run.state().x, &strip.exact().0);
    assert!(error < 1e-6 * strip.length, "{error}");

    let hanging = HangingStrip {
        rows: 6,
        spacing: 0.1,
        gravity: 9.8,
        amplitude: 1e-2,
        mode: 0,
    };
    let mut run = Simulation::new(hanging.model(), hanging.start(), method).unwrap();
    let frequency = run.step(1.0).unwrap().lowest_frequency.unwrap();
    let error = TAU * frequency / hanging.frequency() - 1.0;
    assert!(error.abs() < 1e-3, "{error}");
}

/// What carries a sheet that lies on a table is its weight, to the tolerance of the forces.
#[test]
fn friction_holds_a_sheet_on_a_table() {
    let scene = "version = 1
         sheet.mesh.square = { side = 0.3, level = 3 }
         sheet.material = \"office paper\"
         sheet.start.perturbation = 1e-3
         forces.gravity = [0, 0, -9.81]
         stop.time = 1
         [[obstacle]]
         shape.cylinder = { radius = 0.1, height = 0.1 }
         pose.position = [0.15, 0.15, -0.051]
         friction = 0.3";
    let (_, run, report) = rest(scene.into()).unwrap();
    let mass = run.model().mass().row_sums(run.model().topology());
    let weight = 9.81 * mass.iter().sum::<f64>();
    let load = run.obstacle_forces()[0];
    let off = (load[2] + weight).hypot(load[0]).hypot(load[1]) / weight;
    assert!(off < 1e-4, "{load:?} {weight}");
    let lowest = run.state().x.as_chunks::<3>().0.iter();
    let lowest = lowest.map(|x| x[2]).fold(0.0, f64::min);
    assert!(lowest < 0.0, "{lowest}");
    assert!(report.lowest_frequency.is_some());
}

fn refusal(scene: String) -> String {
    let found = rest(scene).map(|_| ());
    found.expect_err("there is none").to_string()
}

#[test]
fn what_has_no_equilibrium_is_refused() {
    let falling = "version = 1
         sheet.mesh.square = { side = 0.1, level = 2 }
         sheet.material = \"newsprint\"
         forces.gravity = [0, 0, -9.81]
         stop.time = 1";
    let error = refusal(falling.into());
    assert!(error.contains("nothing stops it"), "{error}");
    // Its middle sags until its ends slip off the blocks, after steps of very different lengths.
    let slipping = "version = 1
         sheet.mesh.rectangle = { width = 0.4, height = 0.05, columns = 40, rows = 5 }
         sheet.material = \"polycarbonate film\"
         sheet.start = { perturbation = 1e-3, seed = 1 }
         forces.gravity = [0, 0, -9.81]
         stop.time = 1
         [[obstacle]]
         shape.box.size = [0.06, 0.2, 0.02]
         pose.position = [0.03, 0.025, -0.0105]
         friction = 0.4
         [[obstacle]]
         shape.box.size = [0.06, 0.2, 0.02]
         pose.position = [0.37, 0.025, -0.0105]
         friction = 0.4";
    let error = refusal(slipping.into());
    assert!(error.contains("nothing stops it"), "{error}");
    let windy = strip(0.05, 9.81).replace("[[support]]", "air.wind = [1, 0, 0]\n[[support]]");
    let error = refusal(windy);
    assert!(error.contains("wind"), "{error}");
}
