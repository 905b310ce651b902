//! Hard scenes of contact, every frame searched for intersections by brute force.

use crate::watch::Watch;
use isosheet_collide::{
    Coefficients, ContactOptions, Contacts, Keyframe, Obstacle, Shape, TriangleSurface,
};
use isosheet_dynamics::{Method, SheetModel, Simulation, State, StepReport};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// Side of the square sheets, metres.
const SIDE: f64 = 0.2;

/// A scene while it runs.
struct Scene {
    simulation: Simulation,
    watch: Watch,
    /// The distance at which contact begins to act, metres.
    activation: f64,
}

impl Scene {
    /// `model` from `state` against `bodies` and itself, with one coefficient of friction.
    fn new(model: SheetModel, state: State, bodies: Vec<Obstacle>, mu: f64) -> Self {
        let options = ContactOptions::for_sheet(&model);
        let mut contacts = Contacts::new(&model, options)
            .and_then(|c| c.with_self_contact(Coefficients::equal(mu)))
            .expect("valid");
        for body in bodies {
            contacts = contacts
                .with_body(body, Coefficients::equal(mu))
                .expect("valid");
        }
        let watch = Watch::new(&model, &contacts);
        watch.frame(state.t, &state.x);
        let simulation = Simulation::new(model, state, Method::default()).expect("valid");
        let simulation = simulation.with_contact(contacts).expect("nothing touches");
        Self {
            simulation,
            watch,
            activation: options.activation,
        }
    }

    /// Runs to time `end` in steps of `h`, with a look at every frame.
    fn run(&mut self, end: f64, h: f64, mut look: impl FnMut(&StepReport, &[f64])) {
        let steps = ((end - self.simulation.state().t) / h).round() as usize;
        for _ in 0..steps {
            let report = self.watch.step(&mut self.simulation, h);
            look(&report, &self.simulation.state().x);
        }
    }

    fn x(&self) -> &[f64] {
        &self.simulation.state().x
    }
}

fn model(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 3.5e-3, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
}

fn square(level: u32) -> Sheet {
    generate::isotropic_square(level, SIDE).expect("valid")
}

/// A half-space whose boundary goes through `point` and whose outward normal is `normal`.
fn wall(point: [f64; 3], normal: [f64; 3]) -> Isometry3<f64> {
    let n = Vector3::from(normal);
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), &n)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI));
    Isometry3::from_parts(point.into(), turn)
}

/// A body that moves from one pose to another between two times.
fn mover(shape: Shape, from: Isometry3<f64>, to: Isometry3<f64>, [t0, t1]: [f64; 2]) -> Obstacle {
    let keys = vec![Keyframe { t: t0, pose: from }, Keyframe { t: t1, pose: to }];
    Obstacle::new(shape, keys).expect("valid")
}

/// A half-space that closes in along its normal by `distance` metres within `t` seconds.
fn closing(point: [f64; 3], normal: [f64; 3], distance: f64, t: f64) -> Obstacle {
    let from = wall(point, normal);
    let to = Translation3::from(Vector3::from(normal) * distance) * from;
    mover(Shape::HalfSpace, from, to, [0.0, t])
}

/// Smallest and largest coordinate along an axis.
fn extent(x: &[f64], axis: usize) -> [f64; 2] {
    let along = x.iter().skip(axis).step_by(3);
    along.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], c| {
        [a.min(*c), b.max(*c)]
    })
}

const H: f64 = 1.0 / 240.0;

#[test]
fn a_sheet_is_crumpled_between_closing_plates() {
    // From exactly flat; two opposite sides to half the width.
    let sheet = square(2);
    let margin = 1e-3;
    let bodies = vec![
        Obstacle::fixed(Shape::HalfSpace, wall([0.0, 0.0, -margin], [0.0, 0.0, 1.0]))
            .expect("valid"),
        closing([-margin, 0.0, 0.0], [1.0, 0.0, 0.0], 0.25 * SIDE, 0.3),
        closing(
            [SIDE + margin, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            0.25 * SIDE,
            0.3,
        ),
    ];
    let model = model(&sheet).with_damping(2.0).expect("valid");
    let mut scene = Scene::new(
        model,
        State::at_rest(sheet.positions().to_vec()),
        bodies,
        0.2,
    );
    scene.run(0.35, H, |_, _| ());
    let [low, high] = extent(scene.x(), 0);
    // The plates end 0.5 SIDE + 2 margin apart. The folds fill the space between them except for the reach
    // of the barrier, and the sides that the plates do not touch keep their length.
    let room = 0.5 * SIDE + 2.0 * margin;
    assert!(
        (0.93 * room..room).contains(&(high - low)),
        "from {low} to {high} m of {room} m"
    );
    let [left, right] = extent(scene.x(), 1);
    assert!(
        (right - left - SIDE).abs() < 0.01 * SIDE,
        "from {left} to {right} m"
    );
    let [bottom, _] = extent(scene.x(), 2);
    assert!((-margin..0.0).contains(&bottom), "lowest point {bottom} m");
}

#[test]
fn a_sheet_is_crumpled_from_four_sides() {
    let sheet = square(2);
    let margin = 1e-3;
    let distance = 0.2 * SIDE;
    let ceiling = 0.8 * SIDE;
    let bodies = vec![
        Obstacle::fixed(Shape::HalfSpace, wall([0.0, 0.0, -margin], [0.0, 0.0, 1.0]))
            .expect("valid"),
        Obstacle::fixed(
            Shape::HalfSpace,
            wall([0.0, 0.0, ceiling], [0.0, 0.0, -1.0]),
        )
        .expect("valid"),
        closing([-margin, 0.0, 0.0], [1.0, 0.0, 0.0], distance, 0.3),
        closing([SIDE + margin, 0.0, 0.0], [-1.0, 0.0, 0.0], distance, 0.3),
        closing([0.0, -margin, 0.0], [0.0, 1.0, 0.0], distance, 0.3),
        closing([0.0, SIDE + margin, 0.0], [0.0, -1.0, 0.0], distance, 0.3),
    ];
    let model = model(&sheet).with_damping(2.0).expect("valid");
    let mut scene = Scene::new(
        model,
        State::at_rest(sheet.positions().to_vec()),
        bodies,
        0.2,
    );
    // Steps that resolve how the flat sheet buckles when the plates arrive: with four times as long ones the
    // height that it jumps to depends on whether that step is divided.
    scene.run(0.35, 0.25 * H, |_, _| ());
    // The plates are 0.6 SIDE + 2 margin apart. They have pushed the sheet together along both axes, and it
    // is as wide as half of the space at least: folds that stand away from a plate are shorter than that.
    let room = 0.6 * SIDE + 2.0 * margin;
    for axis in [0, 1] {
        let [low, high] = extent(scene.x(), axis);
        assert!(
            (0.5 * room..room).contains(&(high - low)),
            "from {low} to {high} m of {room} m along axis {axis}"
        );
    }
    // It has nowhere to go but up, by more than it was away from what it touches.
    let [bottom, top] = extent(scene.x(), 2);
    assert!((-margin..0.0).contains(&bottom), "lowest point {bottom} m");
    assert!((margin..ceiling).contains(&top), "highest point {top} m");
}

#[test]
fn a_strip_is_folded_into_ten_layers() {
    let (panels, cells, length, width) = (10, 2, 0.06, 0.04);
    let flat = generate::strip(
        panels * cells,
        panels as f64 * length,
        width,
        generate::Diagonals::Rising,
    )
    .expect("valid");
    let (sin, cos) = 0.3_f64.sin_cos();
    let margin = 1e-3;
    let zigzag = |s: f64| {
        let panel = (s / length + 1e-9).floor().min(panels as f64 - 1.0);
        let rest = s - panel * length;
        let along = if panel % 2.0 == 0.0 {
            rest
        } else {
            length - rest
        };
        [along * cos, s * sin + margin]
    };
    let x: Vec<f64> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| {
            let [x, z] = zigzag(p[0]);
            [x, p[1], z]
        })
        .collect();
    let height = panels as f64 * length * sin + 2.0 * margin;
    let end = 0.012;
    let bodies = vec![
        Obstacle::fixed(Shape::HalfSpace, Isometry3::identity()).expect("valid"),
        closing([0.0, 0.0, height], [0.0, 0.0, -1.0], height - end, 0.4),
    ];
    let model = model(&flat).with_damping(2.0).expect("valid");
    let mut scene = Scene::new(model, State::at_rest(x), bodies, 0.3);
    scene.run(0.5, H, |_, _| ());
    // Ten layers, one over the other.
    let stride = panels * cells + 1;
    let middle = |p: usize| {
        let i = p * cells + cells / 2;
        let z = |v: usize| scene.x()[3 * v + 2];
        0.5 * (z(i) + z(i + stride))
    };
    let heights: Vec<f64> = (0..panels).map(middle).collect();
    assert!(heights.windows(2).all(|w| w[0] < w[1]), "{heights:?}");
    assert!(heights[panels - 1] < end);
    let [low, high] = extent(scene.x(), 0);
    assert!(high - low < 2.0 * length, "{low} to {high}");
}

/// A closed torus about the z axis.
fn torus(major: f64, minor: f64, [around, across]: [u32; 2]) -> Shape {
    let mut x = Vec::new();
    let mut faces = Vec::new();
    for i in 0..around {
        let (s, c) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
        for j in 0..across {
            let (u, w) = (TAU * f64::from(j) / f64::from(across)).sin_cos();
            let r = major + minor * w;
            x.extend([r * c, r * s, minor * u]);
            let v = |i: u32, j: u32| (i % around) * across + j % across;
            faces.push([v(i, j), v(i + 1, j), v(i + 1, j + 1)]);
            faces.push([v(i, j), v(i + 1, j + 1), v(i, j + 1)]);
        }
    }
    Shape::Surface(Arc::new(TriangleSurface::new(&x, &faces).expect("closed")))
}

#[test]
fn a_sheet_is_pulled_through_a_ring() {
    let sheet = square(2);
    let n = 9;
    let middle = VertexId((n * n / 2) as u32);
    let x: Vec<f64> = sheet
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| [p[0] - 0.5 * SIDE, p[1] - 0.5 * SIDE, 0.0])
        .collect();
    let ring = Obstacle::fixed(
        torus(0.09, 0.02, [16, 6]),
        Isometry3::translation(0.0, 0.0, 0.025),
    )
    .expect("valid");
    let speed = 0.25;
    let model = model(&sheet)
        .with_moving_pin(middle, move |t| [0.0, 0.0, speed * t])
        .and_then(|m| m.with_damping(2.0))
        .expect("valid");
    let mut scene = Scene::new(model, State::at_rest(x), vec![ring], 0.1);
    scene.run(0.85, 2.0 * H, |_, _| ());
    let [low, _] = extent(scene.x(), 2);
    assert!(
        low > 0.045,
        "the last vertex is at {low} m, the ring ends at 0.045 m"
    );
}

#[test]
fn a_strip_is_pulled_through_a_ring() {
    let (width, hole, thick) = (0.05, 0.03, 0.01);
    let flat = generate::strip(24, 0.3, width, generate::Diagonals::UnionJack).expect("valid");
    // Hangs below the ring; drawn up by a corner, which goes to the axis first.
    let places = flat.positions().as_chunks::<3>().0.iter();
    let x = places
        .flat_map(|p| [0.0, p[1] - 0.5 * width, -p[0]])
        .collect();
    let ring = torus(hole + thick, thick, [16, 6]);
    let ring = Obstacle::fixed(ring, Isometry3::translation(0.0, 0.0, 0.02)).expect("valid");
    let path = move |t: f64| [0.0, 0.5 * width * ((t / 0.1).min(1.0) - 1.0), 0.25 * t];
    let model = model(&flat)
        .with_moving_pin(VertexId(0), path)
        .and_then(|m| m.with_damping(2.0))
        .expect("valid");
    let mut scene = Scene::new(model, State::at_rest(x), vec![ring], 0.1);
    scene.run(1.6, 2.0 * H, |_, _| ());
    let [low, _] = extent(scene.x(), 2);
    assert!(
        low > 0.03,
        "the last vertex is at {low} m, the ring ends at 0.03 m"
    );
}

#[test]
fn a_sheet_is_crumpled_between_closing_spheres() {
    // Without gravity, from exactly flat: the spheres pass each other with a small gap between them, and
    // the sheet goes round both.
    let (radius, margin) = (0.06, 2e-3);
    for (between, mu) in [(0.01, 0.0), (0.004, 0.2), (0.003, 0.3)] {
        let sheet = square(2);
        let ball = |side: f64| {
            let at = |height: f64| {
                let aside = side * (radius + 0.5 * between);
                Isometry3::translation(0.5 * SIDE + aside, 0.5 * SIDE, side * height)
            };
            mover(
                Shape::Sphere { radius },
                at(radius + margin),
                at(0.0),
                [0.0, 0.4],
            )
        };
        let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)
            .and_then(|m| m.with_damping(2.0))
            .expect("valid");
        let start = State::at_rest(sheet.positions().to_vec());
        let mut scene = Scene::new(model, start, vec![ball(1.0), ball(-1.0)], mu);
        scene.run(0.45, H, |_, _| ());
        let ([left, right], [low, high]) = (extent(scene.x(), 0), extent(scene.x(), 2));
        // A sheet that is turned by the spheres but not wrapped round them keeps its width to a few percent.
        // Round-off decides whether it folds along its sides or along a diagonal.
        assert!(right - left < 0.9 * SIDE, "from {left} to {right} m");
        // The outer parts, each half as long as the sheet, stand on end, one upwards and one downwards, by
        // more than half of their length; no two points are further apart than the diagonal.
        assert!(high - low < 2.0_f64.sqrt() * SIDE, "from {low} to {high} m");
        assert!(
            low < -0.25 * SIDE && high > 0.25 * SIDE,
            "from {low} to {high} m"
        );
        // The spheres have to push: contact acts below the distance of activation.
        let (gap, activation) = (scene.watch.gap, scene.activation);
        assert!(gap < activation, "{gap} m of {activation} m");
    }
}

#[test]
fn a_strip_is_wrapped_round_a_cylinder_and_unrolled() {
    let (radius, width, length, cells) = (0.03, 0.04, 0.3, 24);
    let flat =
        generate::strip(cells, length, width, generate::Diagonals::UnionJack).expect("valid");
    // The axis is y; the strip hangs down from its first rung beside the cylinder.
    let lift = 1.5e-3;
    let x: Vec<f64> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| [radius + lift, p[1], -p[0]])
        .collect();
    let turn_y = |a: f64| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), a);
    let lie = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    // One and a quarter turns up and over, and back.
    let (half, turns) = (0.8, 1.25 * TAU);
    let angle = move |t: f64| -turns * (1.0 - (1.0 - t / half).abs()).max(0.0);
    let keys = (0..=20).map(|k| {
        let t = 2.0 * half * f64::from(k) / 20.0;
        let pose = Isometry3::from_parts(
            Vector3::new(0.0, 0.5 * width, 0.0).into(),
            turn_y(angle(t)) * lie,
        );
        Keyframe { t, pose }
    });
    let roll = Obstacle::new(
        Shape::Cylinder {
            radius,
            half_height: width,
        },
        keys.collect::<Vec<_>>(),
    )
    .expect("valid");
    let pin = move |y: f64| {
        move |t: f64| {
            let p = turn_y(angle(t)) * Vector3::new(radius + lift, 0.0, 0.0);
            [p.x, y, p.z]
        }
    };
    let model = model(&flat)
        .with_moving_pin(VertexId(0), pin(0.0))
        .and_then(|m| m.with_moving_pin(VertexId(cells as u32 + 1), pin(width)))
        .and_then(|m| m.with_damping(2.0))
        .expect("valid");
    let mut scene = Scene::new(model, State::at_rest(x), vec![roll], 0.3);
    let wound = |x: &[f64]| extent(x, 2)[0];
    scene.run(half, H, |_, _| ());
    let up = wound(scene.x());
    scene.run(2.0 * half + 0.2, H, |_, _| ());
    let down = wound(scene.x());
    // One and a quarter turns round the cylinder, each over the layer below, take up 0.236 m or more. What is
    // left of 0.3 m, 0.064 m or less, hangs from a height of no more than the radius. What is wound is below
    // the cylinder.
    assert!((-0.064..-radius).contains(&up), "wound up to {up} m");
    // Once unrolled the sheet hangs from the pins at the height of the axis with nearly all of its length.
    assert!(
        (-length..-0.9 * length).contains(&down),
        "unrolled to {down} m"
    );
}

#[test]
fn a_sheet_is_thrown_at_an_edge() {
    // 10 m/s: four centimetres a step, twice the bar's thickness.
    let sheet = square(2);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.25 * PI);
    let half = 0.01;
    let top = half * 2.0_f64.sqrt();
    let bar = Shape::Cuboid {
        half: [half, 0.15, half],
    };
    let pose = Isometry3::from_parts([0.52 * SIDE, 0.5 * SIDE, -top - 0.03].into(), turn);
    let bar = Obstacle::fixed(bar, pose).expect("valid");
    let mut start = State::at_rest(sheet.positions().to_vec());
    start
        .v
        .iter_mut()
        .skip(2)
        .step_by(3)
        .for_each(|v| *v = -10.0);
    let mut scene = Scene::new(model(&sheet), start, vec![bar], 0.2);
    // The middle lies a fiftieth of the side beside the edge, and can hang below it by no more than that.
    scene.run(0.05, H, |report, x| {
        let z = x[3 * 40 + 2];
        assert!(
            z > -0.03 - 0.02 * SIDE,
            "the middle is at {z} m, below the edge, at t = {}",
            report.t
        );
    });
}

#[test]
fn a_thin_punch_at_10_m_per_s_does_not_tunnel() {
    let sheet = square(2);
    let shape = Shape::Cuboid {
        half: [0.03, 0.03, 1e-3],
    };
    let at = |z: f64| Isometry3::translation(0.5 * SIDE, 0.5 * SIDE, z);
    // Its top is 1 mm below the sheet; it moves 0.1 m in 10 ms.
    let punch = mover(shape, at(-2e-3), at(0.098), [0.0, 0.01]);
    let mut scene = Scene::new(
        model(&sheet),
        State::at_rest(sheet.positions().to_vec()),
        vec![punch],
        0.2,
    );
    scene.run(0.05, H, |report, x| {
        let top = -1e-3 + 10.0 * report.t.min(0.01);
        let z = x[3 * 40 + 2];
        assert!(
            z > top,
            "the middle is at {z} m, the punch at {top} m at t = {}",
            report.t
        );
    });
}
