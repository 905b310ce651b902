//! A film that is peeled off.

use crate::parse;
use isosheet_io::scene::LiveScene;

const STIFFNESS: f64 = 0.3;
const STRENGTH: f64 = 3e-4;
const CELL: f64 = 0.0025;
const SPEED: f64 = 0.05;

/// A strip of film, 10 mm by 100 mm, that is glued to a plate which is held everywhere. Its end is drawn upwards
/// and is free to follow the front.
fn scene() -> String {
    let sheet = |name: &str| {
        format!(
            "[[sheet]]
            name = \"{name}\"
            mesh = {{ rectangle = {{ width = 0.1, height = 0.01, columns = 40, rows = 4 }} }}
            density = 0.05
            damping = 1.0
            isometry = {{ elastic = {{ stiffness = 1e4, poisson = 0.0, limit = 0.05 }} }}
            bending = {{ plate = {{ rigidity = 1e-5, poisson = 0.0 }} }}\n"
        )
    };
    let all: Vec<String> = (10..41 * 5)
        .filter(|v| v % 41 >= 10)
        .map(|v| v.to_string())
        .collect();
    let all = all.join(", ");
    format!(
        "version = 1
        {}{}
        [[support]]\nsheet = \"plate\"\nat = \"all\"
        [[support]]\nsheet = \"film\"\nat = {{ box = {{ min = [-1, -1, -1], max = [0.0001, 1, 1] }} }}
        hold = {{ surface = {{ shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }},
            motion = {{ z = {{ ramp = {{ to = 0.1, end = 2 }} }} }} }} }}
        [[glue]]\nsheets = [\"film\", \"plate\"]
        first = {{ vertices = [{all}] }}\nsecond = {{ vertices = [{all}] }}
        stiffness = {STIFFNESS}\nuntil = {{ force = {STRENGTH} }}
        [method]\nstep = 0.005\n",
        sheet("film"),
        sheet("plate")
    )
}

#[test]
fn a_film_is_peeled_off_by_the_force_of_its_fracture_energy() {
    let text = scene();
    let mut scene =
        LiveScene::start(parse(&text).unwrap_or_else(|e| panic!("{e}"))).expect("starts");
    let (mut torn, mut forces) = (0, Vec::new());
    while torn < 24 * 5 && scene.simulation().state().t < 1.9 {
        scene.step(0.005).unwrap_or_else(|e| panic!("{e}"));
        let force = scene.support_forces()[1];
        torn += scene.events().iter().filter_map(|e| e.pairs).sum::<usize>();
        eprintln!(
            "{:.3} {torn} {:?} {:?}",
            scene.simulation().state().t,
            force,
            scene.events().first().map(|e| e.force)
        );
        forces.push(force[2]);
    }
    let nominal = 5.0 * STRENGTH * STRENGTH / (2.0 * STIFFNESS) / CELL;
    eprintln!("{nominal} {} {SPEED}", forces.len());
}
