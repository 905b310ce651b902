//! A film that is peeled off.

use crate::parse;
use isosheet_formats::{EventChange, EventKind};
use isosheet_scenes::LiveScene;

const STIFFNESS: f64 = 0.3;
const STRENGTH: f64 = 6e-4;
const CELL: f64 = 0.0025;
const STEP: f64 = 0.01;
const RIGIDITY: f64 = 1e-4;
const WIDTH: f64 = 0.01;

/// A strip of film, 10 mm by 150 mm, that is glued to a plate which is held everywhere. Its end is drawn
/// upwards and is free to follow the front.
fn scene() -> String {
    let sheet = |name: &str| {
        format!(
            "[[sheet]]
            name = \"{name}\"
            mesh = {{ rectangle = {{ width = 0.15, height = {WIDTH}, columns = 60, rows = 4 }} }}
            density = 0.05
            damping = 0.5
            isometry = {{ elastic = {{ stiffness = 1e4, poisson = 0.0, limit = 0.05 }} }}
            bending = {{ plate = {{ rigidity = {RIGIDITY}, poisson = 0.0 }} }}\n"
        )
    };
    let all: Vec<String> = (10..61 * 5)
        .filter(|v| v % 61 >= 10)
        .map(|v| v.to_string())
        .collect();
    let all = all.join(", ");
    format!(
        "version = 1
        {}{}
        [[support]]\nsheet = \"plate\"\nat = \"all\"
        [[support]]\nsheet = \"film\"\nat = {{ box = {{ min = [-1, -1, -1], max = [0.0001, 1, 1] }} }}
        hold = {{ surface = {{ shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }},
            motion = {{ z = {{ ramp = {{ to = 0.1, end = 5 }} }} }} }} }}
        [[glue]]\nsheets = [\"film\", \"plate\"]
        first = {{ vertices = [{all}] }}\nsecond = {{ vertices = [{all}] }}
        stiffness = {STIFFNESS}\nuntil = {{ force = {STRENGTH} }}
        [method]\nstep = {STEP}\n",
        sheet("film"),
        sheet("plate")
    )
}

/// Rows of pairs tear one after the other from the end. Per length the pairs take `n f^2 / (2 k a)`, which is
/// the force of a film that is drawn off at a right angle and cannot stretch. The force rises until the next
/// row tears: then the edge of the bond is less than a row ahead of its springs, where the film, a beam on a
/// foundation of `n k / a`, is away from the plate by at most the factor `1 + a (n k / (4 D b a))^(1/4)`, of
/// which the energy has the square.
#[test]
fn a_film_is_peeled_off_by_the_force_of_its_fracture_energy() {
    let text = scene();
    let file = parse(&text).unwrap_or_else(|e| panic!("{e}"));
    let mut scene = LiveScene::start(file).expect("starts");
    let (mut torn, mut forces) = (0, Vec::new());
    while torn < 26 * 5 {
        scene.step(STEP).unwrap_or_else(|e| panic!("{e}"));
        for event in scene.events() {
            torn += event.pairs.expect("of a seam");
            assert_eq!(
                (event.on, event.change),
                (EventKind::Glue, EventChange::Torn)
            );
            let force = event.force.expect("of a seam");
            assert!(force >= STRENGTH, "{event:?}");
        }
        // From here on the film that is off is steep.
        if torn >= 15 * 5 {
            forces.push(scene.support_forces()[1][2]);
        }
    }
    let n = 5.0;
    let energy = n * STRENGTH * STRENGTH / (2.0 * STIFFNESS * CELL);
    let decay = (n * STIFFNESS / (4.0 * RIGIDITY * WIDTH * CELL)).powf(0.25);
    let mean = forces.iter().sum::<f64>() / forces.len() as f64;
    let most = energy * (1.0 + CELL * decay).powi(2);
    assert!((energy..most).contains(&mean), "{energy} {mean} {most}");
    // The front is straight, and what is ahead of it holds.
    let points = scene.positions();
    let z = |column: usize, row: usize| points[3 * (61 * row + column) + 2];
    for row in 0..5 {
        assert!((0..36).all(|column| z(column, row) > z(column + 1, row)));
        assert!((36..61).all(|column| z(column, row) < STRENGTH / STIFFNESS));
    }
}
