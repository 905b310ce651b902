//! Sheets in still and in moving air.

use crate::scenes::{bumped, gap, methods};
use isosheet_dynamics::{
    Air, Force, Method, PlateBending, PointMotion, Profile, SheetModel, Simulation, State, Wind,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::Vector3;

/// Side of a square card, metres, and its mass, kilograms.
const SIDE: f64 = 0.2;
const MASS: f64 = 3.2e-3;
const GRAVITY: f64 = 9.8;
/// Length of a step, seconds.
const STEP: f64 = 1.0 / 60.0;

/// A card of two faces that lies flat.
fn card() -> Sheet {
    let corners = [[0.0, 0.0], [SIDE, 0.0], [SIDE, SIDE], [0.0, SIDE]];
    let x = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect();
    Sheet::new(x, &[[0, 1, 2], [0, 2, 3]]).expect("valid")
}

fn model(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, MASS, MassKind::Lumped).expect("valid")
}

fn wind(wind: impl Into<Wind>) -> Air {
    let wind = wind.into();
    Air {
        wind,
        ..Air::default()
    }
}

/// The sheet of a model in still air.
fn in_still_air(model: SheetModel) -> SheetModel {
    model.with_air(Air::default()).expect("valid")
}

fn at_rest(sheet: &Sheet) -> State {
    State::at_rest(sheet.positions().to_vec())
}

fn start(model: SheetModel, state: State, method: Method) -> Simulation {
    Simulation::new(model, state, method).expect("valid")
}

/// The mean velocity of the vertices.
fn mean_velocity(run: &Simulation) -> Vector3<f64> {
    let momentum = run.model().linear_momentum(&run.state().v);
    Vector3::from(momentum) / run.model().mass().total()
}

/// Terminal speed of the falling card in air of a density, `sqrt(2 m g / (rho A c_n))`.
fn terminal_speed(density: f64) -> f64 {
    let normal = Air::default().normal;
    (2.0 * MASS * GRAVITY / (density * SIDE * SIDE * normal)).sqrt()
}

/// Error of the speed of the card after a fall of 0.15 s in so many steps, against `v tanh(g t / v)`, and the
/// energy error over the energy that was released.
fn fall_errors(method: &Method, steps: usize) -> [f64; 2] {
    let sheet = card();
    let model = in_still_air(model(&sheet).with_gravity());
    let mut run = start(model, at_rest(&sheet), method.clone());
    let end = 0.15;
    let mut drift = 0.0;
    for _ in 0..steps {
        let report = run.step(end / steps as f64).expect("accepted");
        assert_eq!(report.rejected, 0);
        drift = report.energy_drift / -report.work;
    }
    let terminal = terminal_speed(1.2);
    let want = terminal * (GRAVITY * end / terminal).tanh();
    // It reaches nine tenths of the terminal speed.
    assert!((0.85..0.95).contains(&(want / terminal)), "{want}");
    [(-mean_velocity(&run)[2] - want).abs(), drift.abs()]
}

#[test]
fn a_flat_card_approaches_its_terminal_speed_at_the_order_of_the_method() {
    for (name, method) in methods() {
        let errors = [32, 64, 128].map(|steps| fall_errors(&method, steps));
        let order = |k: usize| (errors[1][k] / errors[2][k]).log2();
        // RATTLE foretells velocities at the end of a step to second order: its composition, of fourth order
        // where no force depends on velocities, is of third order here.
        let want = match name {
            "implicit Euler" => 1.0,
            "RATTLE composition" => 3.0,
            _ => 2.0,
        };
        assert!((order(0) - want).abs() < 0.3, "{name}: {errors:?}");
        assert!(errors[2][0] < 0.02, "{name}: {errors:?}");
        match name {
            "BDF2" => assert!((order(1) - 2.0).abs() < 0.3, "{name}: {errors:?}"),
            "energy-momentum" => assert!(errors[2][1] < 1e-9, "{name}: {errors:?}"),
            _ => assert!(errors[2][1] < 0.1, "{name}: {errors:?}"),
        }
    }
}

/// The drag of a flat card that falls flat, in air of a density, as an explicit force.
#[derive(Debug)]
struct ExplicitDrag {
    density: f64,
}

impl Force for ExplicitDrag {
    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], force: &mut [f64]) {
        let factor = 0.5 * self.density * SIDE * SIDE * Air::default().normal;
        let speed = (v[2] + v[5] + v[8] + v[11]) / 4.0;
        for (corner, share) in [1.0, 0.5, 1.0, 0.5].into_iter().enumerate() {
            force[3 * corner + 2] -= share / 3.0 * factor * speed.abs() * speed;
        }
    }
}

/// In a fluid a hundred times as dense as air the relaxation takes a fifteenth of a step: the implicit drag
/// sinks at the terminal speed, an explicit one overshoots it again and again.
#[test]
fn a_stiff_drag_is_stable() {
    let sheet = card();
    let density = 120.0;
    let terminal = terminal_speed(density);
    let heavy = || model(&sheet).with_gravity();
    let air = Air {
        density,
        ..Air::default()
    };
    let methods = [Method::default(), Method::ImplicitEuler(Default::default())];
    for method in methods {
        let implicit = heavy().with_air(air.clone()).expect("valid");
        let mut run = start(implicit, at_rest(&sheet), method.clone());
        for step in 0..30 {
            let report = run.step(STEP).expect("accepted");
            assert_eq!(report.rejected, 0, "step {step}");
            let speed = -mean_velocity(&run)[2];
            assert!(
                speed > 0.0 && speed < 1.2 * terminal,
                "step {step}: {speed} m/s"
            );
        }
        let speed = -mean_velocity(&run)[2];
        assert!((speed / terminal - 1.0).abs() < 1e-9, "{speed} m/s");
        let explicit = heavy().with_force(ExplicitDrag { density });
        let mut run = start(explicit, at_rest(&sheet), method);
        let overshoots = (0..30).any(|_| match run.step(STEP) {
            Ok(report) => report.rejected > 0 || mean_velocity(&run)[2].abs() > 2.0 * terminal,
            Err(_) => true,
        });
        assert!(overshoots, "{} m/s", mean_velocity(&run)[2]);
    }
}

/// A card that slides in its own plane: `dv/dt = -k v^2` with `k = rho A c_t / (2 m)`, hence `v = v0 / (1 + k
/// v0 t)`.
#[test]
fn friction_alone_brakes_a_sliding_card() {
    let sheet = generate::isotropic_square(1, SIDE).expect("valid");
    let air = Air {
        normal: 0.0,
        tangential: 0.5,
        ..Air::default()
    };
    let k = 0.5 * air.density * SIDE * SIDE * air.tangential / MASS;
    let v = [3.0, -4.0, 0.0].repeat(sheet.positions().len() / 3);
    let state = State::moving(sheet.positions().to_vec(), v);
    let model = model(&sheet).with_air(air).expect("valid");
    let mut run = start(model, state, Method::default());
    for _ in 0..400 {
        run.step(1e-3).expect("accepted");
    }
    let speed = 5.0 / (1.0 + k * 5.0 * 0.4);
    let want = Vector3::new(0.6, -0.8, 0.0) * speed;
    let found = mean_velocity(&run);
    assert!((found - want).norm() < 1e-4 * speed, "{found}: {want}");
    assert!(speed < 3.0, "{speed} m/s");
}

/// In the frame of the wind a sheet moves as in still air.
#[test]
fn a_sheet_that_moves_with_the_wind_feels_still_air() {
    let sheet = bumped(1, 0.05);
    let x = sheet.positions();
    let spin = |i: usize| [0.7, -0.4, 0.2][i % 3] * (x[3 * (i / 3) + (i + 1) % 3] - 0.5);
    let along = [3.0, -1.0, 2.0];
    for (name, method) in methods() {
        let run = |along: [f64; 3]| {
            let v: Vec<f64> = (0..x.len()).map(|i| spin(i) + along[i % 3]).collect();
            let model = SheetModel::new(&sheet, 0.05, MassKind::Lumped).expect("valid");
            let model = model.with_air(wind(along)).expect("valid");
            let mut run = start(model, State::moving(x.to_vec(), v), method.clone());
            let mut work = 0.0;
            for _ in 0..20 {
                work = run.step(2.5e-3).expect("accepted").work;
            }
            (run.state().clone(), work)
        };
        let (still, work) = run([0.0; 3]);
        let (mut moving, _) = run(along);
        for (i, x) in moving.x.iter_mut().enumerate() {
            *x -= along[i % 3] * moving.t;
        }
        let error = gap(&still.x, &moving.x);
        assert!(error < 1e-8, "{name}: {error:e} m");
        assert!(work < -1e-5, "{name}: the air took {work} J");
    }
    // Without any relative motion there is no force at all, bit for bit.
    let model = model(&sheet).with_air(wind(along)).expect("valid");
    let state = State::moving(x.to_vec(), along.repeat(x.len() / 3));
    let mut run = start(model, state, Method::default());
    let report = run.step(STEP).expect("accepted");
    assert!(report.work.abs() < 1e-20, "{} J", report.work);
}

/// A stiff sheet that is hinged at an edge turns until it is along the wind, from either side.
#[test]
fn a_weathervane_turns_into_the_wind() {
    let flat = generate::isotropic_square(1, SIDE).expect("valid");
    for angle in [1.0_f64, -1.0] {
        let (s, c) = angle.sin_cos();
        let turn = |p: &[f64; 3]| [c * p[0], s * p[0], p[1]];
        let x = flat.positions().as_chunks::<3>().0.iter().flat_map(turn);
        let sheet = Sheet::new(x.collect(), &flat.face_indices()).expect("valid");
        let t = sheet.topology();
        let is_hinge = |v: &VertexId| sheet.position(*v)[0].abs() < 1e-9;
        let hinge: Vec<_> = t.vertex_ids().filter(is_hinge).collect();
        assert_eq!(hinge.len(), 5);
        let model = model(&sheet)
            .with_potential(PlateBending::new(&sheet, 1e-2).expect("valid"))
            .with_pins(&hinge)
            .and_then(|m| m.with_damping(2.0))
            .expect("valid")
            .with_air(wind([4.0, 0.0, 0.0]))
            .expect("valid");
        let mut run = start(model, at_rest(&sheet), Method::default());
        for _ in 0..180 {
            let report = run.step(STEP).expect("accepted");
            assert_eq!(report.substeps, 1, "no step has to be divided");
        }
        let points = run.state().x.as_chunks::<3>().0;
        let sideways = points.iter().fold(0.0_f64, |m, p| m.max(p[1].abs()));
        assert!(sideways < 0.03 * SIDE, "{sideways} m");
        let downstream = points.iter().fold(0.0_f64, |m, p| m.max(p[0]));
        assert!(downstream > 0.999 * SIDE, "{downstream} m");
    }
}

/// The drag of a wind on a sheet at rest, from its definition.
fn drag(sheet: &Sheet, x: &[f64], wind: [f64; 3]) -> Vector3<f64> {
    let at = |v: u32| Vector3::from(x.as_chunks::<3>().0[v as usize]);
    let face = |[a, b, c]: [u32; 3]| {
        let area = 0.5 * (at(b) - at(a)).cross(&(at(c) - at(a)));
        let n = area.normalize();
        let w = Vector3::from(wind);
        let across = w.dot(&n);
        let along = w - across * n;
        let Air {
            density,
            normal,
            tangential,
            ..
        } = Air::default();
        let pressures = normal * across.abs() * across * n + tangential * along.norm() * along;
        0.5 * density * area.norm() * pressures
    };
    sheet.face_indices().into_iter().map(face).sum()
}

/// At rest the forces of the pins balance the weight and the drag.
#[test]
fn supports_bear_the_drag() {
    let sheet = bumped(1, 0.05);
    let mass = 0.05;
    let breeze = [0.5, 1.0, 0.2];
    let model = SheetModel::new(&sheet, mass, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_potential(PlateBending::new(&sheet, 1e-3).expect("valid"))
        .with_pins(&[VertexId(20), VertexId(24)])
        .and_then(|m| m.with_damping(8.0))
        .expect("valid")
        .with_air(wind(breeze))
        .expect("valid");
    let mut run = start(model, at_rest(&sheet), Method::default());
    for _ in 0..600 {
        run.step(STEP).expect("accepted");
    }
    let supports: Vector3<f64> = run.reactions().iter().map(|r| r.force).sum();
    let drag = drag(&sheet, &run.state().x, breeze);
    let weight = Vector3::new(0.0, 0.0, -mass * GRAVITY);
    let left = supports + weight + drag;
    assert!(drag.norm() > 0.05 * weight.norm(), "{drag}");
    assert!(left.norm() < 1e-4 * drag.norm(), "{left}");
}

/// A triangle that is towed at its base at a constant speed trails behind: the pins do the work that the air
/// takes.
#[test]
fn towing_costs_the_work_of_the_drag() {
    let x = vec![0.0, 0.0, 0.0, 0.0, SIDE, 0.0, -SIDE, 0.5 * SIDE, 0.0];
    let sheet = Sheet::new(x, &[[0, 1, 2]]).expect("valid");
    let speed = 5.0;
    let tow = |y: f64| PointMotion::from(move |t: f64| [speed * t, y, 0.0]);
    for (name, method) in methods() {
        let model = in_still_air(model(&sheet))
            .with_moving_pin(VertexId(0), tow(0.0))
            .and_then(|m| m.with_moving_pin(VertexId(1), tow(SIDE)))
            .expect("valid");
        let state = State::moving(sheet.positions().to_vec(), [speed, 0.0, 0.0].repeat(3));
        let mut run = start(model, state, method.clone());
        let mut report = run.step(5e-3).expect("accepted");
        for _ in 0..40 {
            report = run.step(5e-3).expect("accepted");
        }
        let air = Air::default();
        let drag = 0.25 * air.density * SIDE * SIDE * air.tangential * speed * speed;
        let supports: Vector3<f64> = run.reactions().iter().map(|r| r.force).sum();
        assert!(
            (supports[0] / drag - 1.0).abs() < 1e-6,
            "{name}: {supports}"
        );
        // What the pins give the air takes.
        let passed = drag * speed * report.t;
        assert!(
            report.work.abs() < 1e-6 * passed,
            "{name}: {} J",
            report.work
        );
        assert!(report.energy_drift.abs() < 1e-6 * passed, "{name}");
    }
}

/// A sheet that flutters in gusts: the work of the air closes the energy balance, and no step is refused on
/// its account.
#[test]
fn the_work_of_gusts_closes_the_energy_balance() {
    let sheet = bumped(1, 0.05);
    let gusts = Profile::Sine {
        mean: 4.0,
        amplitude: 3.0,
        frequency: 2.0,
        phase: 0.0,
    };
    let run = |method: Method, steps: usize| {
        let air = wind([gusts.clone(), 0.5.into(), 0.0.into()]);
        let model = SheetModel::new(&sheet, 0.05, MassKind::Lumped)
            .expect("valid")
            .with_pins(&[VertexId(20)])
            .expect("valid")
            .with_air(air)
            .expect("valid");
        let mut run = start(model, at_rest(&sheet), method);
        let (mut report, mut refused) = (None, 0);
        for _ in 0..steps {
            let step = run.step(0.4 / steps as f64).expect("accepted");
            refused += step.rejected;
            report = Some(step);
        }
        (report.expect("steps were taken"), refused)
    };
    for (name, method) in methods() {
        let (report, _) = run(method, 160);
        assert!(report.work > 0.02, "{name}: {} J", report.work);
        let bound = match name {
            "energy-momentum" => 1e-9,
            "RATTLE" | "RATTLE composition" => 0.05,
            _ => 0.3,
        };
        assert!(
            report.energy_drift.abs() < bound * report.work,
            "{name}: {}",
            report.energy_drift
        );
    }
    let (_, refused) = run(Method::default(), 24);
    assert_eq!(refused, 0, "steps of 1/60 s");
}

/// Air without density acts as no air, bit for bit.
#[test]
fn air_without_density_is_none() {
    let sheet = bumped(1, 0.05);
    let run = |air: Option<Air>| {
        let mut model = model(&sheet).with_gravity();
        if let Some(air) = air {
            model = model.with_air(air).expect("valid");
        }
        let model = model.with_pins(&[VertexId(20)]).expect("exists");
        let mut run = start(model, at_rest(&sheet), Method::default());
        for _ in 0..30 {
            run.step(STEP).expect("accepted");
        }
        run.state().clone()
    };
    let vacuum = Air {
        density: 0.0,
        wind: [3.0, 0.0, 1.0].into(),
        ..Air::default()
    };
    assert_eq!(run(Some(vacuum)), run(None));
}
