//! Sheets at rest against closed forms and the balance of forces.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Keyframe, Obstacle, Shape};
use isosheet_dynamics::{
    Driver, ImplicitOptions, Method, Reaction, SheetModel, Simulation, State, StepControl,
    StepError, Support, Unsatisfiable,
};
use isosheet_mesh::{MassKind, VertexId, generate};
use isosheet_tests::{Catenary, max_difference};
use nalgebra::{Isometry3, Vector3};

const G: f64 = 9.8;

fn tight() -> ImplicitOptions {
    ImplicitOptions {
        tolerance: Some(1e-12),
        ..Default::default()
    }
}

fn speed(state: &State) -> f64 {
    state.v.iter().fold(0.0, |m, v| m.max(v.abs()))
}

#[test]
fn a_hanging_strip_is_a_discrete_catenary() {
    // Implicit steps rest where the forces balance.
    let (bound, force_bound) = (1e-12, 1e-10);
    for method in [Method::Bdf2(tight()), Method::ImplicitEuler(tight())] {
        for (rods, slack) in [(5, 0.7), (8, 0.7), (8, 0.95), (12, 0.4)] {
            let length = 0.1;
            let span = slack * length * f64::from(rods);
            let strip = Catenary {
                rods: rods as usize,
                length,
                span,
                gravity: G,
            };
            let (exact, pull) = strip.exact();
            let model = strip.model().with_damping(10.0).expect("valid");
            let start = strip.start();
            assert!(
                max_difference(&start.x, &exact) > 1e-3 * span,
                "an arc is none"
            );
            let mut simulation = Simulation::new(model, start, method.clone()).expect("valid");
            for _ in 0..600 {
                simulation.step(1.0 / 60.0).expect("accepted");
            }
            let error = max_difference(&simulation.state().x, &exact) / length;
            // Each end carries half of the inner vertices of its chain and itself.
            let lift = 0.5 * f64::from(rods + 1) * strip.vertex_weight();
            let load = pull.hypot(lift);
            let mut off = 0.0_f64;
            for reaction in simulation.reactions() {
                let Support::Pin(VertexId(v)) = reaction.support else {
                    panic!("{}", reaction.support);
                };
                let outwards = if v % (rods + 1) == 0 { -pull } else { pull };
                let want = Vector3::new(outwards, 0.0, lift);
                off = off.max((reaction.force - want).norm() / load);
            }
            assert!(
                error < bound && off < force_bound,
                "{method:?}: {error:e} {off:e}"
            );
        }
    }
}

/// A ball in a hammock. The ball is a body whose position is prescribed; what is in equilibrium with it is
/// the sheet, at rest. A ball of weight `W` that is free to move up and down rests at the height at which
/// the load of the sheet on it is `W`. This height is found by a search, in which every trial lowers or
/// lifts the ball from the previous state of rest.
struct Hammock {
    state: State,
    ball: f64,
}

const STRIP: Catenary = Catenary {
    rods: 8,
    length: 0.1,
    span: 0.6,
    gravity: G,
};
const RADIUS: f64 = 0.1;

/// The sheet at rest with the ball at a height.
struct Rest {
    load: Vector3<f64>,
    reactions: Vec<Reaction>,
}

impl Hammock {
    fn new() -> Self {
        let (x, _) = STRIP.exact();
        let lowest = x.iter().skip(2).step_by(3).fold(0.0, |a: f64, z| a.min(*z));
        Self {
            state: State::at_rest(x),
            ball: lowest + RADIUS + 0.02,
        }
    }

    /// Moves the ball's centre to the height `to` and waits for rest.
    fn place(&mut self, to: f64) -> Rest {
        let model = STRIP.model().with_damping(10.0).expect("valid");
        let at = |z: f64| Isometry3::translation(0.5 * STRIP.span, 0.15, z);
        let t = self.state.t;
        let keys = vec![
            Keyframe {
                t,
                pose: at(self.ball),
            },
            Keyframe {
                t: t + 0.2,
                pose: at(to),
            },
        ];
        let ball = Obstacle::new(Shape::Sphere { radius: RADIUS }, keys).expect("valid");
        let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
            .and_then(|c| c.with_body(ball, Coefficients::FRICTIONLESS))
            .expect("valid");
        let simulation = Simulation::new(model, self.state.clone(), Method::Bdf2(tight()));
        let mut simulation = simulation
            .expect("valid")
            .with_contact(contacts)
            .expect("nothing touches");
        for step in 0..400 {
            let report = simulation.step(1.0 / 60.0).expect("accepted");
            assert!(report.gap.expect("contact") > 0.0 && report.strain < 1e-10);
            if step > 15 && speed(simulation.state()) < 1e-10 {
                break;
            }
        }
        self.state = simulation.state().clone();
        self.ball = to;
        Rest {
            load: simulation.body_loads()[0].force,
            reactions: simulation.reactions(),
        }
    }
}

#[test]
fn a_ball_rests_in_a_hammock_that_hangs_by_its_pins() {
    let own = 18.0 * STRIP.vertex_weight();
    let weight = 2.0 * own;
    let mut hammock = Hammock::new();
    let mut worst = 0.0_f64;
    let mut trial = |hammock: &mut Hammock, z: f64| {
        let rest = hammock.place(z);
        let pins: Vector3<f64> = rest.reactions.iter().map(|r| r.force).sum();
        // Pins, the ball's push (minus the load on it) and the weight of the sheet.
        let left = pins - rest.load - Vector3::new(0.0, 0.0, own);
        worst = worst.max(left.norm() / (own + rest.load.norm()));
        (rest.load.z - weight, pins.z)
    };
    // Down until the load is more than the weight, then the false position of Dowell and Jarratt (Illinois).
    let mut above = (hammock.ball, -weight);
    let mut below = loop {
        let z = hammock.ball - 0.01;
        let (excess, _) = trial(&mut hammock, z);
        if excess > 0.0 {
            break (z, excess);
        }
        above = (z, excess);
    };
    let mut side = 0;
    let lift = loop {
        let z = (above.0 * below.1 - below.0 * above.1) / (below.1 - above.1);
        let (excess, lift) = trial(&mut hammock, z);
        if excess.abs() < 1e-7 * weight {
            break lift;
        }
        if excess > 0.0 {
            below = (z, excess);
            if side == 1 {
                above.1 *= 0.5;
            }
            side = 1;
        } else {
            above = (z, excess);
            if side == -1 {
                below.1 *= 0.5;
            }
            side = -1;
        }
    };
    assert!((lift / (weight + own) - 1.0).abs() < 1e-6, "{lift} N");
    assert!(worst < 1e-6, "{worst:e}");
}

/// The upper edge of a banner is a straight line of rods between two pins: it cannot move, and its vertices
/// are fixed as the pins are.
#[test]
fn a_banner_hangs_by_two_corners() {
    for level in 0..=1 {
        for method in [
            Method::Bdf2(Default::default()),
            Method::ImplicitEuler(Default::default()),
        ] {
            let sheet = generate::isotropic_square(level, 0.2).expect("valid");
            let n = (1 << (level + 1)) + 1;
            let corners = [VertexId(n * (n - 1)), VertexId(n * n - 1)];
            let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)
                .and_then(|m| m.with_pins(&corners))
                .and_then(|m| m.with_gravity().with_damping(5.0))
                .expect("valid");
            let start = sheet.positions().to_vec();
            let mut simulation =
                Simulation::new(model, State::at_rest(start.clone()), method).expect("valid");
            for _ in 0..240 {
                let report = simulation.step(1.0 / 60.0).expect("accepted");
                assert!(report.strain < 1e-11, "{}", report.strain);
            }
            let x = &simulation.state().x;
            let edge = 3 * (n * (n - 1)) as usize;
            assert_eq!(x[edge..], start[edge..]);
            // Straight down, and its weight on the edge.
            let lowest = x.iter().skip(2).step_by(3).fold(0.0_f64, |m, z| m.min(*z));
            assert!((lowest / -0.2 - 1.0).abs() < 1e-3, "{lowest} m");
            let reactions = simulation.reactions();
            assert_eq!(reactions.len(), n as usize);
            let lift: f64 = reactions.iter().map(|r| r.force.z).sum();
            assert!((lift / (3.5e-3 * 9.8) - 1.0).abs() < 1e-2, "{lift} N");
        }
    }
}

/// Two opposite corners of a square sheet are the ends of a straight line of rods; one of them is pulled
/// outwards.
#[test]
fn a_straight_line_of_rods_does_not_give() {
    let pull = 0.5;
    for level in 0..3 {
        for method in [
            Method::Bdf2(Default::default()),
            Method::ImplicitEuler(Default::default()),
        ] {
            let run = |unsatisfiable| {
                let sheet = generate::isotropic_square(level, 0.2).expect("valid");
                let corner = VertexId(sheet.topology().vertex_count() as u32 - 1);
                let [x, y, z] = sheet.position(corner);
                let along = pull * 0.5_f64.sqrt();
                let outwards = move |t: f64| [x + along * t, y + along * t, z];
                let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)
                    .and_then(|m| m.with_pins(&[VertexId(0)]))
                    .and_then(|m| m.with_moving_pin(corner, outwards))
                    .expect("valid");
                let start = State::at_rest(sheet.positions().to_vec());
                let control = StepControl {
                    unsatisfiable,
                    ..Default::default()
                };
                let simulation = Simulation::new(model, start, method.clone()).expect("valid");
                (corner, simulation.with_control(control).expect("valid"))
            };
            let h = 0.01;
            let (corner, mut simulation) = run(Unsatisfiable::Refuse);
            let error = simulation.step(h).expect_err("beyond taut");
            let StepError::Unsatisfiable { t, infeasibility } = error else {
                panic!("M{level}: {error}");
            };
            assert_eq!(infeasibility.by, Driver::Support(Support::Pin(corner)));
            assert!(
                t < 0.1 * h && (infeasibility.distance / (pull * h) - 1.0).abs() < 0.05,
                "{infeasibility:?}"
            );
            let (_, mut simulation) = run(Unsatisfiable::StopTaut);
            let report = simulation.step(h).expect("stops");
            assert!(
                report.taut.is_some() && report.t < 0.1 * h && report.strain < 2e-12,
                "{report:?}"
            );
        }
    }
}
