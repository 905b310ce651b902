//! Random scenes with bodies: nothing passes through anything, by a check that knows no distances.

use crate::parse;
use isosheet_geometry::{ContactMesh, crossings};
use isosheet_scenes::LiveScene;
use proptest::prelude::*;
use std::fmt::Write;

#[derive(Clone, Debug)]
struct RandomBody {
    shape: usize,
    size: f64,
    density: f64,
    turn: [f64; 4],
    velocity: [f64; 3],
    rate: f64,
}

#[derive(Clone, Debug)]
struct RandomScene {
    bodies: Vec<RandomBody>,
    made_of: usize,
    held: usize,
    friction: f64,
    rows: usize,
    seed: u64,
}

fn bodies() -> impl Strategy<Value = Vec<RandomBody>> {
    let numbers = (0..4_usize, 0.012..0.04_f64, 2.0..4.0_f64);
    let turn = prop::array::uniform4(-1.0..1.0_f64);
    let velocity = [-0.5..0.5_f64, -0.5..0.5_f64, -1.0..0.2_f64];
    let one = (numbers, turn, velocity, -720.0..720.0_f64);
    let one = one.prop_map(
        |((shape, size, density), turn, velocity, rate)| RandomBody {
            shape,
            size,
            // From foam to metal.
            density: 10.0_f64.powf(density),
            turn,
            velocity,
            rate,
        },
    );
    prop::collection::vec(one, 1..4)
}

fn scenes() -> impl Strategy<Value = RandomScene> {
    let sheet = (
        0..3_usize,
        0..3_usize,
        0.0..0.6_f64,
        4..8_usize,
        0..1000_u64,
    );
    (bodies(), sheet).prop_map(
        |(bodies, (made_of, held, friction, rows, seed))| RandomScene {
            bodies,
            made_of,
            held,
            friction,
            rows,
            seed,
        },
    )
}

impl RandomScene {
    /// Bodies above each other over a sheet over a floor.
    fn text(&self) -> String {
        let made_of = [
            "material = \"cotton\"",
            "material = \"office paper\"",
            "density = 0.1",
        ][self.made_of];
        let edge = |x: f64, side: f64| {
            format!(
                "[[support]]\nat = {{ half_space = {{ point = [{x}, 0, 0], normal = [{side}, 0, 0] }} }}\n"
            )
        };
        // Rods lock where they are held along a line.
        let held = match self.held {
            _ if self.made_of == 2 => String::new(),
            0 => String::new(),
            1 => edge(1e-6, -1.0),
            _ => edge(1e-6, -1.0) + &edge(0.199_999, 1.0),
        };
        let mut text = format!(
            "version = 1
            [sheet]
            mesh = {{ polygon = {{ outline = [[0, 0], [0.2, 0], [0.2, 0.2], [0, 0.2]], spacing = {}, seed = {} }} }}
            {made_of}
            damping = 2
            {held}
            [contact]
            friction = {}
            self_contact = true
            [[obstacle]]
            shape = {{ box = {{ size = [20, 20, 0.1] }} }}
            pose = {{ position = [0, 0, -0.15] }}
            friction = {}
            [forces]
            gravity = [0, 0, -9.81]\n",
            0.2 / self.rows as f64,
            self.seed,
            self.friction,
            self.friction,
        );
        let mut height = 0.01;
        for body in &self.bodies {
            let size = body.size;
            let shape = match body.shape {
                0 => format!(
                    "box = {{ size = [{size}, {}, {}] }}",
                    0.7 * size,
                    1.3 * size
                ),
                1 => format!("sphere = {{ radius = {size} }}"),
                2 => format!("cylinder = {{ radius = {size}, height = {size} }}"),
                _ => format!("capsule = {{ radius = {}, length = {size} }}", 0.5 * size),
            };
            let [x, y, z, angle] = body.turn;
            let [u, v, w] = body.velocity;
            // No shape reaches further than this from its centre.
            let reach = 1.2 * size;
            writeln!(
                text,
                "[[body]]
                shape = {{ {shape} }}
                sides = 8
                density = {}
                pose = {{ position = [0.1, 0.1, {}], turn = {{ axis = [{x}, {y}, {}], angle = {} }} }}
                velocity = [{u}, {v}, {w}]
                spin = {{ axis = [{y}, {}, {x}], rate = {} }}",
                body.density,
                height + reach,
                z.abs() + 0.1,
                180.0 * angle,
                z.abs() + 0.1,
                body.rate
            )
            .unwrap();
            height += 2.0 * reach + 0.002;
        }
        text
    }
}

/// Steps of a run: two thirds of a second, in which all have landed.
const STEPS: usize = 40;

proptest! {
    #![proptest_config(isosheet_random::cases(6))]

    #[test]
    fn random_bodies_and_sheets_pass_through_nothing(scene in scenes()) {
        let text = scene.text();
        let file = parse(&text).unwrap_or_else(|e| panic!("{e}"));
        let mut live = LiveScene::start(file).unwrap_or_else(|e| panic!("{e}"));
        let mesh = ContactMesh::from_topology(live.facts().sheet.topology());
        for k in 0..STEPS {
            let step = live.step(1.0 / 60.0);
            let report = step.unwrap_or_else(|e| panic!("step {k}: {e}\n{text}"));
            prop_assert!(report.gap.is_none_or(|gap| gap > 0.0), "step {k}\n{text}");
            let x = live.positions();
            let lowest = x.iter().skip(2).step_by(3).fold(f64::INFINITY, |m, z| m.min(*z));
            prop_assert!(lowest > -0.1, "step {k}: {lowest} below the floor\n{text}");
            let found = crossings(&mesh, &x);
            prop_assert!(found.is_empty(), "step {k}: {found:?}\n{text}");
        }
    }
}
