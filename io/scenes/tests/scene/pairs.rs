//! Friction of pairs of sheets, bodies and obstacles, which are named.

use crate::bodies::{G, live, play, problem};
use isosheet_scenes::LiveScene;

/// The slope of a plane, radians.
const SLOPE: f64 = 0.3;

/// Friction at which nothing slides down the slope, and one at which everything does.
const FRICTION: [f64; 2] = [0.9, 0.1];

/// What slides along a plane that is tilted by the direction of gravity, on which friction is large but for
/// the pairs.
fn tilted(rest: &str, pairs: &[[&str; 2]]) -> LiveScene {
    let [rest_friction, pair_friction] = FRICTION;
    let pairs: String = pairs
        .iter()
        .map(|names| format!("[[contact.pair]]\nsheets = {names:?}\nfriction = {pair_friction}\n"))
        .collect();
    live(&format!(
        "version = 1\n{rest}\
         [[obstacle]]\nname = \"plane\"\nshape = \"half_space\"\nfriction = {rest_friction}\n\
         [forces]\ngravity = [{}, 0, {}]\n\
         [contact]\nself_contact = true\nactivation = 2e-4\nfriction = {rest_friction}\n{pairs}\
         [method]\nstep = 0.005\n",
        G * SLOPE.sin(),
        -G * SLOPE.cos()
    ))
}

fn small_sheet(name: &str, y: f64, z: f64) -> String {
    format!(
        "[[sheet]]\nname = \"{name}\"\nmaterial = \"steel sheet\"\nmesh = {{ square = {{ side = 0.05, level = 0 }} }}\n\
         placement = {{ position = [0, {y:?}, {z:?}] }}\n"
    )
}

fn box_of_steel(name: &str, y: f64, z: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nshape = {{ box = {{ size = [0.05, 0.05, 0.02] }} }}\ndensity = 7800\n\
         pose = {{ position = [0.0251, {y:?}, {z:?}] }}\n"
    )
}

/// Checks that points slide as far as those do that start at rest, with the friction of pairs, or stay.
fn check(live: &mut LiveScene, sliding: &[usize], staying: &[usize]) {
    let x = |live: &LiveScene, v: usize| live.positions()[3 * v];
    let all = [sliding, staying].concat();
    let before: Vec<f64> = all.iter().map(|v| x(live, *v)).collect();
    let duration = 0.25;
    play(live, duration);
    let acceleration = G * (SLOPE.sin() - FRICTION[1] * SLOPE.cos());
    let exact = 0.5 * acceleration * duration * duration;
    for (v, before) in all.into_iter().zip(before) {
        let slid = x(live, v) - before;
        match sliding.contains(&v) {
            true => assert!((slid / exact - 1.0).abs() < 0.05, "{v}: {slid} and {exact}"),
            false => assert!(slid.abs() < 1e-3, "{v}: {slid}"),
        }
    }
}

#[test]
fn a_sheet_slides_on_the_obstacle_of_its_pair_and_another_one_stays() {
    let z = 1.9e-4;
    let sheets = small_sheet("slides", 0.0, z) + &small_sheet("stays", 0.2, z);
    for names in [["slides", "plane"], ["plane", "slides"]] {
        check(&mut tilted(&sheets, &[names]), &[0], &[9]);
    }
}

#[test]
fn a_body_slides_on_the_obstacle_of_its_pair_and_another_one_stays() {
    let z = 0.01 + 1.9e-4;
    let scene = small_sheet("aside", 1.0, 1.9e-4)
        + &box_of_steel("slides", 0.0, z)
        + &box_of_steel("stays", 0.2, z);
    check(&mut tilted(&scene, &[["slides", "plane"]]), &[9], &[0, 17]);
}

#[test]
fn a_body_slides_on_the_sheet_of_its_pair_and_another_one_stays() {
    let sheet = "[[sheet]]\nname = \"below\"\nmaterial = \"steel sheet\"\n\
        mesh = { rectangle = { width = 0.4, height = 0.4, columns = 8, rows = 8 } }\n\
        placement = { position = [-0.1, -0.1, 0.1] }\n[[support]]\nsheet = \"below\"\nat = \"all\"\n";
    let z = 0.11 + 1.9e-4;
    let scene =
        sheet.to_owned() + &box_of_steel("slides", 0.003, z) + &box_of_steel("stays", 0.2, z);
    check(&mut tilted(&scene, &[["slides", "below"]]), &[81], &[89]);
}

#[test]
fn pairs_that_cannot_be_are_refused_with_the_cause() {
    let floor = |name: &str| format!("[[obstacle]]\nname = \"{name}\"\nshape = \"half_space\"\n");
    let pair = |first: &str, second: &str| {
        format!(
            "[contact]\nself_contact = true\n[[contact.pair]]\nsheets = [\"{first}\", \"{second}\"]\nfriction = 0.1\n"
        )
    };
    let wall = floor("wall") + "pose = { position = [0, 0, -1] }\n";
    let sheet = small_sheet("sheet", 0.0, 0.1);
    let cases = [
        (
            floor("floor") + &wall + &pair("floor", "wall"),
            [
                "contact.pair[0].sheets",
                "obstacles do not meet one another",
            ],
        ),
        (
            floor("floor") + &pair("sheet", "flor"),
            [
                "contact.pair[0].sheets[1]",
                "no sheet, body or obstacle has the name `flor`",
            ],
        ),
        (
            floor("sheet"),
            ["obstacle[0].name", "has the name `sheet`, too"],
        ),
        (
            floor("wall") + &wall,
            ["obstacle[1].name", "has the name `wall`, too"],
        ),
    ];
    for (scene, said) in cases {
        let text = problem(&format!("version = 1\n{sheet}{scene}"));
        assert!(said.iter().all(|part| text.contains(part)), "{text}");
    }
}
