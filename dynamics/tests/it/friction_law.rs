//! Laws of friction from outside: a plate on a plane against closed forms, wrong laws, checkpoints.

use isosheet_dynamics::contact::{
    ActiveContact, BodyMotion, BodyPlace, Coefficients, Contact, ContactError, ContactKey,
    ContactKind, ContactLaws, Coulomb, Friction, FrictionError, FrictionLaw, FrictionLawFault,
    JointMotion, StepMotion, StepSpan, Stiffness,
};
use isosheet_dynamics::nalgebra::{Isometry3, Vector3};
use isosheet_dynamics::{
    Checkpoint, CheckpointError, ImplicitOptions, Method, SheetModel, Simulation, SimulationError,
    State, StepError, check_friction_law,
};
use isosheet_mesh::{MassKind, Sheet};
use std::f64::consts::E;

const G: f64 = 9.8;
/// Activation distance, metres, and stiffness, joules, of the barrier.
const ACTIVATION: f64 = 1e-3;
const STIFFNESS: f64 = 1e-3;

/// A plane `z = 0` that moves along x at a speed, metres per second.
struct Plane {
    speed: f64,
    laws: ContactLaws,
}

impl Plane {
    fn new(friction: Friction) -> Self {
        let laws = ContactLaws {
            stiffness: Stiffness::Joules(STIFFNESS),
            bodies: vec![friction],
            ..ContactLaws::frictionless(ACTIVATION)
        };
        Self { speed: 0.0, laws }
    }
}

impl Contact for Plane {
    fn laws(&self) -> &ContactLaws {
        &self.laws
    }

    fn body_motions(&self, span: StepSpan, out: &mut Vec<BodyMotion>) {
        let pose = |t: f64| Isometry3::translation(self.speed * t, 0.0, 0.0);
        let motion = StepMotion::new(pose(span.t0), pose(span.t0 + span.h));
        out.push(BodyMotion {
            material: motion,
            surface: motion,
        });
    }

    fn query(&mut self, motion: JointMotion<'_>, pairs: &mut Vec<ContactKey>) -> f64 {
        (0..motion.x.len() / 3).fold(1.0, |part: f64, v| {
            pairs.push(ContactKey {
                body: Some(0),
                kind: ContactKind::Vertex,
                pair: [v as u32, 0],
            });
            let (gap, rise) = (motion.x[3 * v + 2], motion.dx[3 * v + 2]);
            match -rise > 0.9 * gap {
                true => part.min(0.9 * gap / -rise),
                false => part,
            }
        })
    }

    fn evaluate(
        &self,
        pairs: &[ContactKey],
        x: &[f64],
        _: &[BodyPlace],
        out: &mut Vec<ActiveContact>,
    ) {
        for key in pairs {
            let v = key.pair[0];
            let [x, y, gap] = x.as_chunks::<3>().0[v as usize];
            if gap < ACTIVATION {
                out.push(ActiveContact {
                    key: *key,
                    vertices: [v; 4],
                    weights: [1.0, 0.0, 0.0, 0.0],
                    normal: Vector3::z(),
                    gap,
                    closest: Vector3::new(x, y, 0.0),
                    parallel: None,
                    rolling: None,
                    round: [None; 2],
                });
            }
        }
    }

    fn check_start(&mut self, _: &SheetModel, _: &State) -> Result<(), ContactError> {
        Ok(())
    }
}

fn plate() -> Sheet {
    let corners = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.05, 0.08, 0.0];
    Sheet::new(corners, &[[0, 1, 2]]).expect("a triangle")
}

fn model() -> SheetModel {
    let model = SheetModel::new(&plate(), 0.2, MassKind::Lumped);
    model.expect("valid").with_gravity()
}

/// The plate at the gap at which the barrier carries its weight, with a speed along x, metres per second.
fn start(speed: f64) -> State {
    let weight = model().mass().vertex[0] * G;
    let force = |gap: f64| {
        let z = (gap / ACTIVATION).powi(2);
        let slope = 2.0 * (1.0 - z) * z.ln() - (1.0 - z).powi(2) / z;
        -STIFFNESS * slope * 2.0 * gap / ACTIVATION.powi(2)
    };
    let [mut low, mut high] = [1e-3 * ACTIVATION, ACTIVATION];
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if force(middle) > weight {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    let lifted = plate().map_positions(|[x, y, _]| [x, y, low]);
    State {
        v: [speed, 0.0, 0.0].repeat(3),
        ..State::at_rest(lifted.expect("rigid").positions().to_vec())
    }
}

fn on(plane: Plane, speed: f64, method: Method) -> Result<Simulation, SimulationError> {
    Simulation::new(model(), start(speed), method)?.with_contact(plane)
}

fn sliding(law: impl FrictionLaw + 'static, speed: f64) -> Simulation {
    let plane = Plane::new(Friction::law(law));
    on(plane, speed, Method::default()).expect("a law")
}

/// The speed along x after `count` steps of `h` seconds.
fn speed_after(mut run: Simulation, count: usize, h: f64) -> f64 {
    for _ in 0..count {
        run.step(h).expect("accepted");
    }
    run.state().v[0]
}

/// `mu = c v` with `c` in seconds per metre.
#[derive(Debug)]
struct Viscous(f64);

impl FrictionLaw for Viscous {
    fn coefficient(&self, v: f64) -> f64 {
        self.0 * v
    }

    fn integral(&self, v: f64) -> f64 {
        0.5 * self.0 * v * v
    }

    fn slope(&self, _: f64) -> f64 {
        self.0
    }
}

/// A curve like Stribeck's: dry friction, which rises from rest, more of it at low speeds, and viscous
/// friction, `mu = a (1 - exp(-v/e)) + b (v/s) exp(1 - v/s) + c v`.
#[derive(Debug, Clone, Copy)]
struct Stribeck {
    a: f64,
    b: f64,
    c: f64,
    e: f64,
    s: f64,
}

const STRIBECK: Stribeck = Stribeck {
    a: 0.1,
    b: 0.3,
    c: 0.2,
    e: 1e-3,
    s: 0.05,
};

impl FrictionLaw for Stribeck {
    fn coefficient(&self, v: f64) -> f64 {
        let Self { a, b, c, e, s } = *self;
        -a * (-v / e).exp_m1() + b * (v / s) * E * (-v / s).exp() + c * v
    }

    fn integral(&self, v: f64) -> f64 {
        let Self { a, b, c, e, s } = *self;
        let at_low_speeds = s - (v + s) * (-v / s).exp();
        a * (v + e * (-v / e).exp_m1()) + b * E * at_low_speeds + 0.5 * c * v * v
    }

    fn slope(&self, v: f64) -> f64 {
        let Self { a, b, c, e, s } = *self;
        a / e * (-v / e).exp() + b / s * E * (1.0 - v / s) * (-v / s).exp() + c
    }
}

/// Viscous friction stops a plate by `v = v0 exp(-c g t)`.
#[test]
fn viscous_friction_leaves_the_method_its_order() {
    let (c, v0, t) = (2.0, 0.5, 0.1);
    let expected = v0 * f64::exp(-c * G * t);
    let methods = [
        (Method::default(), 2.0, 1e-3),
        (Method::ImplicitEuler(ImplicitOptions::default()), 1.0, 0.03),
    ];
    for (method, order, largest) in methods {
        let errors = [40, 80, 160].map(|count| {
            let plane = Plane::new(Friction::law(Viscous(c)));
            let run = on(plane, v0, method.clone()).expect("a law");
            (speed_after(run, count, t / count as f64) / expected - 1.0).abs()
        });
        assert!(errors[1] < largest, "{errors:?}");
        for pair in errors.windows(2) {
            let found = (pair[0] / pair[1]).log2();
            assert!((found - order).abs() < 0.15, "order {found}, {errors:?}");
        }
    }
}

/// A belt takes a plate along by `v = w (1 - exp(-c g t))`.
#[test]
fn a_belt_takes_a_plate_along_and_works() {
    let (c, w, t) = (2.0, 0.3, 0.1);
    let plane = Plane {
        speed: w,
        ..Plane::new(Friction::law(Viscous(c)))
    };
    let mut run = on(plane, 0.0, Method::default()).expect("a law");
    let (mut heat, mut work) = (0.0, 0.0);
    for _ in 0..200 {
        let report = run.step(t / 200.0).expect("accepted");
        (heat, work) = (report.friction, report.work);
    }
    let left = f64::exp(-c * G * t);
    let (speed, expected) = (run.state().v[0], w * (1.0 - left));
    assert!((speed / expected - 1.0).abs() < 1e-3, "{speed} {expected}");
    // The belt does the work m w v; what is not kinetic energy is heat.
    let mass = 0.2;
    assert!((work / (mass * w * expected) - 1.0).abs() < 0.02, "{work}");
    let kinetic = 0.5 * mass * expected * expected;
    assert!((heat / (work - kinetic) - 1.0).abs() < 0.02, "{heat}");
    let load = run.body_loads()[0].force;
    let force = -c * (w - speed) * mass * G;
    assert!((load.x / force - 1.0).abs() < 1e-2, "{load} {force}");
}

/// A plate decelerates by `g mu(v)` on the falling branch and beyond it, and comes down the whole curve.
#[test]
fn a_plate_comes_down_the_curve_of_stribeck() {
    let speeds = [0.0, 1e-4, 1e-3, 0.01, 0.05, 0.1, 0.3, 1.0];
    check_friction_law(&STRIBECK, &speeds).expect("a law");
    assert!(STRIBECK.slope(0.1) < 0.0 && STRIBECK.slope(0.5) > 0.0);
    for v in [0.03, 0.1, 0.5] {
        let h = 1e-4;
        let after = speed_after(sliding(STRIBECK, v), 4, h);
        let middle = STRIBECK.coefficient(0.5 * (v + after));
        let found = (v - after) / (4.0 * h);
        assert!(
            (found / (G * middle) - 1.0).abs() < 1e-2,
            "at {v} m/s {found}"
        );
    }
    let (t, count) = (0.2, 20_000);
    let mut expected = 0.5;
    for _ in 0..count {
        let h = t / f64::from(count);
        let half = expected - 0.5 * h * G * STRIBECK.coefficient(expected);
        expected -= h * G * STRIBECK.coefficient(half);
    }
    let errors = [50, 100, 200].map(|count| {
        let found = speed_after(sliding(STRIBECK, 0.5), count, t / count as f64);
        (found / expected - 1.0).abs()
    });
    assert!(errors[2] < 1e-3, "{errors:?}");
    assert!((errors[1] / errors[2]).log2() > 1.7, "{errors:?}");
}

/// Coulomb's law through the same door: with speeds in metres per second it stops a plate as coefficients do.
#[test]
fn coulombs_law_from_outside_is_that_of_coefficients() {
    let law = Coulomb::new(0.3, 0.2, 1e-4).expect("valid");
    let mut plane = Plane::new(
        Coefficients {
            rest: 0.3,
            sliding: 0.2,
        }
        .into(),
    );
    plane.laws.rest_speed = 1e-4;
    let by_coefficients = on(plane, 0.5, Method::default()).expect("valid");
    let [a, b] = [sliding(law, 0.5), by_coefficients].map(|run| speed_after(run, 50, 1e-3));
    assert!((a - b).abs() < 1e-7, "{a} {b}");
    assert!((a - (0.5 - 0.2 * G * 0.05)).abs() < 1e-5, "{a}");
}

/// Viscous friction with a fault above a speed.
#[derive(Debug)]
struct Faulty {
    from: f64,
    coefficient: f64,
    integral: f64,
}

impl FrictionLaw for Faulty {
    fn coefficient(&self, v: f64) -> f64 {
        v * if v > self.from { self.coefficient } else { 1.0 }
    }

    fn integral(&self, v: f64) -> f64 {
        0.5 * v * v * if v > self.from { self.integral } else { 1.0 }
    }

    fn slope(&self, v: f64) -> f64 {
        if v > self.from { self.coefficient } else { 1.0 }
    }
}

#[test]
fn wrong_laws_are_named() {
    let faulty = |coefficient: f64, integral: f64| Faulty {
        from: 0.1,
        coefficient,
        integral,
    };
    for (coefficient, integral) in [(f64::NAN, 1.0), (1.0, f64::NAN), (-1.0, -1.0)] {
        let law = faulty(coefficient, integral);
        assert_eq!(check_friction_law(&law, &[0.0, 0.05]), Ok(()));
        let checked = check_friction_law(&law, &[0.0, 0.2]).expect_err("wrong at 0.2 m/s");
        let mut run = sliding(law, 0.3);
        let found = run.step(1e-3).expect_err("wrong at 0.3 m/s");
        let StepError::FrictionLaw { error, .. } = found else {
            panic!("{coefficient} {integral}: {found}");
        };
        for error in [&checked, &*error] {
            let text = error.to_string();
            assert!(
                text.starts_with("the law of friction `Faulty` cannot be used: at "),
                "{text}"
            );
        }
        let faults = [checked, *error].map(|error| match error {
            FrictionError::Law { fault, .. } => std::mem::discriminant(&fault),
            other => panic!("{other}"),
        });
        assert_eq!(faults[0], faults[1], "{coefficient} {integral}");
    }
    // Derivatives are compared with differences where somebody asks for it, or no step is found.
    let fault = |law: &dyn FrictionLaw| match check_friction_law(law, &[0.2]) {
        Err(FrictionError::Law { fault, .. }) => fault,
        other => panic!("{other:?}"),
    };
    let found = fault(&faulty(1.0, -1.0));
    assert!(
        matches!(found, FrictionLawFault::Integral(part) if part > 1.9),
        "{found}"
    );
    let found = fault(&Steep);
    assert!(
        matches!(found, FrictionLawFault::Slope(part) if (part - 0.5).abs() < 1e-6),
        "{found}"
    );
}

/// Viscous friction whose slope is twice what it should be.
#[derive(Debug)]
struct Steep;

impl FrictionLaw for Steep {
    fn coefficient(&self, v: f64) -> f64 {
        v
    }

    fn integral(&self, v: f64) -> f64 {
        0.5 * v * v
    }

    fn slope(&self, _: f64) -> f64 {
        2.0
    }
}

/// A coefficient that is a number at rest, and one that falls there.
#[derive(Debug)]
struct AtRest(f64, f64);

impl FrictionLaw for AtRest {
    fn coefficient(&self, v: f64) -> f64 {
        self.0 + self.1 * v
    }

    fn integral(&self, v: f64) -> f64 {
        self.0 * v + 0.5 * self.1 * v * v
    }

    fn slope(&self, _: f64) -> f64 {
        self.1
    }
}

#[test]
fn laws_that_are_wrong_at_rest_are_refused_at_the_start() {
    let refused = |law: AtRest| {
        let error = on(Plane::new(Friction::law(law)), 0.1, Method::default()).err();
        match error.expect("refused") {
            SimulationError::Contact(ContactError::Friction(FrictionError::Law {
                fault, ..
            })) => fault,
            other => panic!("{other}"),
        }
    };
    assert_eq!(refused(AtRest(0.2, 0.0)), FrictionLawFault::Rest(0.2));
    assert_eq!(refused(AtRest(0.0, -1.0)), FrictionLawFault::Falls(-1.0));
    let infinite = refused(AtRest(0.0, f64::INFINITY));
    assert!(
        matches!(infinite, FrictionLawFault::NotFinite { .. }),
        "{infinite}"
    );
}

/// What a law says goes on bit for bit from a checkpoint, with the loads of the step before; and coefficients
/// do not take its place.
#[test]
fn a_law_goes_on_from_a_checkpoint() {
    let plane = || Plane::new(Friction::law(STRIBECK));
    let mut run = sliding(STRIBECK, 0.2);
    for _ in 0..10 {
        run.step(1e-3).expect("accepted");
    }
    let bytes = run.checkpoint().to_bytes().expect("encoded");
    let read = || Checkpoint::from_bytes(&bytes).expect("decoded");
    let mut resumed = Simulation::resume(model(), Some(Box::new(plane())), read()).expect("same");
    assert_eq!(run.body_loads(), resumed.body_loads());
    assert_eq!(run.contact_forces(), resumed.contact_forces());
    for _ in 0..10 {
        let reports = [&mut run, &mut resumed].map(|r| r.step(1e-3).expect("accepted").friction);
        assert_eq!(reports[0].to_bits(), reports[1].to_bits());
        assert_eq!(run.state(), resumed.state());
    }
    let mut other = Plane::new(Coefficients::equal(0.3).into());
    other.laws.rest_speed = 1e-3;
    let refused = Simulation::resume(model(), Some(Box::new(other)), read()).err();
    assert!(
        matches!(
            refused,
            Some(SimulationError::Checkpoint(CheckpointError::Friction))
        ),
        "{refused:?}"
    );
}
