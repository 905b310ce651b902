//! Sheets that are isometric in weak form: tolerance, orders, balances, supports, contact, checkpoints, and
//! the heavy elastica.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_coords::FrontChart;
use isosheet_coords::assignment::{AssignmentOptions, Degenerate};
use isosheet_dynamics::chart::{ChartDynamicsError, ChartOptions};
use isosheet_dynamics::constraint::{Plane, Side};
use isosheet_dynamics::{
    Checkpoint, CheckpointError, CreaseSprings, ImplicitOptions, Membrane, Method, PlateBending,
    PointProfile, Profile, SheetModel, Simulation, SimulationError, State, StepReport, Support,
    VertexConstraint, WeakIsometry, project_positions,
};
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use nalgebra::{Isometry3, Vector3};

const STEP: f64 = 1.0 / 60.0;
const GRAVITY: f64 = 9.8;
/// What the default options promise.
const TOLERANCE: f64 = 1e-12;

fn irregular(spacing: f64) -> Sheet {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    generate::delaunay(&outline, spacing, 4).expect("valid")
}

fn vertices(sheet: &Sheet, test: impl Fn([f64; 3]) -> bool) -> Vec<VertexId> {
    let all = sheet.topology().vertex_ids();
    all.filter(|v| test(sheet.position(*v))).collect()
}

/// A sheet of the given mass (kilograms) and rigidity (newton metres), with gravity.
fn plate(sheet: &Sheet, mass: f64, rigidity: f64, clamp: &[VertexId]) -> SheetModel {
    SheetModel::new(sheet, mass, MassKind::Lumped)
        .expect("positive mass")
        .with_acceleration([0.0, 0.0, -GRAVITY])
        .with_pins(clamp)
        .expect("vertices of the sheet")
        .with_potential(PlateBending::clamped(sheet, rigidity, clamp).expect("rigidity"))
        .with_weak_isometry(WeakIsometry::of_plate(sheet, rigidity).expect("flat"))
        .expect("the same sheet")
}

fn start(model: SheetModel, sheet: &Sheet, method: Method) -> Simulation {
    let state = State::at_rest(sheet.positions().to_vec());
    Simulation::new(model, state, method).expect("starts")
}

/// Takes steps, every one of which has to satisfy the equations.
fn advance(run: &mut Simulation, steps: usize, h: f64) -> Vec<StepReport> {
    let mut reports = Vec::new();
    for _ in 0..steps {
        let report = run.step(h).expect("runs");
        let x = &run.state().x;
        assert!(report.constrained_strain <= TOLERANCE, "{report:?}");
        assert_eq!(report.constrained_strain, run.model().constrained_strain(x));
        assert_eq!(report.strain, run.model().rods().max_strain(x));
        reports.push(report);
    }
    reports
}

fn methods(options: &ImplicitOptions) -> [Method; 2] {
    [
        Method::Bdf2(options.clone()),
        Method::ImplicitEuler(options.clone()),
    ]
}

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// Exactly flat at the start, hanging by a corner that moves, with a vertex on a plane and another that may
/// not pass a plane.
#[test]
fn every_step_satisfies_the_equations() {
    let sheet = generate::isotropic_square(2, 1.0).expect("valid");
    for method in methods(&ImplicitOptions::default()) {
        let lift = PointProfile {
            offset: sheet.position(VertexId(72)),
            z: Profile::Sine {
                mean: 0.0,
                amplitude: 0.05,
                frequency: 2.0,
                phase: 0.0,
            },
            ..PointProfile::default()
        };
        let across = Plane::new([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]).expect("normal");
        let floor = Plane::new([0.0, 0.0, -0.1], [0.0, 0.0, 1.0]).expect("normal");
        let model = plate(&sheet, 0.1, 5e-3, &[])
            .with_moving_pin(VertexId(72), lift)
            .and_then(|m| {
                let sliding = VertexConstraint::on_surface(VertexId(80), across, Side::On);
                m.with_constraint(sliding)
            })
            .and_then(|m| {
                let resting = VertexConstraint::on_surface(VertexId(0), floor, Side::Outside);
                m.with_constraint(resting)
            })
            .expect("vertices");
        let mut run = start(model, &sheet, method);
        let reports = advance(&mut run, 45, STEP);
        let x = &run.state().x;
        assert!((x[3 * 80 + 1] - 1.0).abs() < 1e-9 && x[2] > -0.1 - 1e-9);
        let strain = reports.iter().fold(0.0_f64, |m, r| m.max(r.strain));
        assert!((1e-3..0.2).contains(&strain), "{strain}");
        let factorisations: usize = reports.iter().map(|r| r.factorisations).sum();
        assert!(factorisations < 45 * 12, "{factorisations}");
    }
}

/// The equations couple vertices that nothing else couples here: hinges instead of a plate.
#[test]
fn hinges_bend_a_sheet_without_a_plate() {
    let sheet = generate::isotropic_square(1, 0.2).expect("valid");
    let model = SheetModel::new(&sheet, 3e-3, MassKind::Consistent)
        .expect("positive mass")
        .with_pins(&[VertexId(0), VertexId(1), VertexId(5)])
        .expect("vertices")
        .with_damping(5.0)
        .expect("rate")
        .with_potential(CreaseSprings::bending(&sheet, 1e-3).expect("rigidity"))
        .with_acceleration([0.0, 0.0, -GRAVITY])
        .with_weak_isometry(WeakIsometry::new(&sheet, 40.0).expect("flat"))
        .expect("the same sheet");
    let mut run = start(model, &sheet, Method::default());
    advance(&mut run, 60, STEP);
    let tip = run.state().x[3 * 24 + 2];
    // (The diagonal of the square has 0.28 m.)
    assert!((-0.28..-1e-2).contains(&tip), "{tip}");
}

/// A strip that swings about its clamp, well resolved by the mesh.
fn swing(method: &Method, steps: usize) -> (Vec<f64>, f64) {
    let sheet = generate::grid(10, 2, 0.3, 0.06, Diagonals::UnionJack).expect("valid");
    let clamp = vertices(&sheet, |[x, ..]| x < 0.035);
    let mut run = start(plate(&sheet, 1.5e-3, 5e-4, &clamp), &sheet, method.clone());
    let end = 0.12;
    let reports = advance(&mut run, steps, end / steps as f64);
    let drift = reports.last().map_or(0.0, |r| r.energy_drift);
    (run.state().x.clone(), drift)
}

/// The error of the positions against a run with steps an eighth of the smallest, and the energy that is
/// lost.
#[test]
fn methods_keep_their_orders() {
    let options = ImplicitOptions {
        tolerance: 1e-12,
        ..ImplicitOptions::default()
    };
    for (method, least, most) in [
        (Method::Bdf2(options.clone()), 1.7, 2.4),
        (Method::ImplicitEuler(options.clone()), 0.85, 1.15),
    ] {
        let (exact, _) = swing(&Method::Bdf2(options.clone()), 3200);
        let runs = [100, 200, 400].map(|steps| swing(&method, steps));
        let errors = runs.each_ref().map(|(x, _)| {
            let differences = x.iter().zip(&exact).map(|(a, b)| (a - b).abs());
            differences.fold(0.0, f64::max)
        });
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((least..most).contains(&order), "{method:?}: {errors:?}");
        }
        let drifts = runs.map(|(_, drift)| drift);
        // Both methods lose energy, and less with shorter steps.
        assert!(drifts.iter().all(|d| *d < 0.0), "{method:?}: {drifts:?}");
        for pair in drifts.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(order > least, "{method:?}: {drifts:?}");
        }
    }
}

/// Reactions, weight and the rate of change of the momentum add up to nothing, and the work of a pin that is
/// lifted is the energy that the sheet gains and the method loses.
#[test]
fn reactions_balance_the_change_of_momentum() {
    let sheet = irregular(0.3);
    let corner = VertexId(0);
    let lift = PointProfile {
        offset: sheet.position(corner),
        z: Profile::SmoothStep {
            from: 0.0,
            to: 0.05,
            begin: 0.0,
            end: 0.3,
        },
        ..PointProfile::default()
    };
    let options = ImplicitOptions {
        tolerance: 1e-12,
        ..ImplicitOptions::default()
    };
    let model = plate(&sheet, 0.1, 5e-3, &[])
        .with_moving_pin(corner, lift)
        .expect("vertex");
    let mut run = start(model, &sheet, Method::ImplicitEuler(options));
    let h = 5e-3;
    for _ in 0..40 {
        let before = run.model().linear_momentum(&run.state().v);
        advance(&mut run, 1, h);
        let after = run.model().linear_momentum(&run.state().v);
        let forces: Vector3<f64> = run.reactions().iter().map(|r| r.force).sum();
        let rate = (Vector3::from(after) - Vector3::from(before)) / h;
        let weight = Vector3::new(0.0, 0.0, -0.1 * GRAVITY);
        let left = (forces + weight - rate).norm();
        assert!(left < 1e-6 * weight.norm(), "{left}");
    }
}

/// Pins that move apart stretch a strip of the length `l` and the width `b` to `s l` as its membrane does:
/// evenly, with the energy `k b l E^2 / 2` and the force `k b E s` for `E = (s^2 - 1) / 2`.
#[test]
fn pins_that_move_apart_stretch_a_strip_evenly() {
    let (length, width, stiffness, stretch) = (0.3, 0.06, 40.0, 1.02);
    let sheet = strip(0.4);
    let sheet = sheet
        .map_positions(|[x, y, z]| [(x + 0.03) * length / 0.33, y, z])
        .expect("stretched");
    let mut model = SheetModel::new(&sheet, 1.5e-3, MassKind::Consistent)
        .expect("positive mass")
        .with_damping(5.0)
        .expect("rate")
        .with_weak_isometry(WeakIsometry::new(&sheet, stiffness).expect("flat"))
        .expect("the same sheet");
    let (left, right) = (
        vertices(&sheet, |[x, ..]| x < 1e-9),
        vertices(&sheet, |[x, ..]| x > length - 1e-9),
    );
    for v in left.iter().chain(&right) {
        let place = sheet.position(*v);
        let end = if place[0] > 0.1 {
            (stretch - 1.0) * length
        } else {
            0.0
        };
        let motion = PointProfile {
            offset: place,
            x: Profile::SmoothStep {
                from: 0.0,
                to: end,
                begin: 0.0,
                end: 1.0,
            },
            ..PointProfile::default()
        };
        model = model.with_moving_pin(*v, motion).expect("vertex");
    }
    let options = ImplicitOptions {
        tolerance: 1e-12,
        ..ImplicitOptions::default()
    };
    let mut run = start(model, &sheet, Method::ImplicitEuler(options));
    let reports = advance(&mut run, 40, 0.1);
    for (p, rest) in run
        .state()
        .x
        .as_chunks::<3>()
        .0
        .iter()
        .zip(sheet.positions().as_chunks::<3>().0)
    {
        let exact = [stretch * rest[0], rest[1], 0.0];
        let distance = (0..3).fold(0.0_f64, |m, k| m.max((p[k] - exact[k]).abs()));
        assert!(distance < 1e-7, "{distance}");
    }
    let strain = 0.5 * (stretch * stretch - 1.0);
    let energy = 0.5 * stiffness * width * length * strain * strain;
    let last = reports.last().expect("steps");
    assert!((last.potential / energy - 1.0).abs() < 1e-6);
    let forces = run.reactions().into_iter().filter(|r| match r.support {
        Support::Pin(v) => right.contains(&v),
        Support::Constraint { .. } => false,
    });
    let force: f64 = forces.map(|r| r.force.x).sum();
    let exact = stiffness * width * strain * stretch;
    assert!((force / exact - 1.0).abs() < 1e-5, "{force} {exact}");
}

/// A quarter of the sheet clamped flat, along lines that are no lines of the mesh.
#[test]
fn clamped_quarters_hang() {
    for (degrees, seed) in [(10.0_f64, 1), (35.0, 2), (75.0, 3)] {
        for rigidity in [5e-2, 5e-4] {
            let sheet = generate::delaunay_square(1.0, 0.15, seed).expect("valid");
            let (s, c) = degrees.to_radians().sin_cos();
            let along = |v: &VertexId| {
                let [x, y, _] = sheet.position(*v);
                c * x + s * y
            };
            let mut clamp: Vec<_> = sheet.topology().vertex_ids().collect();
            clamp.sort_by(|a, b| along(a).total_cmp(&along(b)));
            clamp.truncate(clamp.len() / 4);
            let model = plate(&sheet, 0.1, rigidity, &clamp)
                .with_damping(2.0)
                .expect("rate");
            let mut run = start(model, &sheet, Method::default());
            let reports = advance(&mut run, 60, STEP);
            let heights = run.state().x.as_chunks::<3>().0.iter().map(|p| p[2]);
            let lowest = heights.fold(f64::INFINITY, f64::min);
            assert!(lowest < -0.1, "{lowest}");
            let factorisations: usize = reports.iter().map(|r| r.factorisations).sum();
            assert!(factorisations < 60 * 10, "{factorisations}");
            // The bend at the clamp is resolved by the stiff sheet alone.
            let strain = reports.iter().fold(0.0_f64, |m, r| m.max(r.strain));
            let most = if rigidity > 1e-2 { 0.05 } else { 0.6 };
            assert!(strain < most, "{rigidity}: {strain}");
        }
    }
}

/// Onto a ball with friction, one corner on a floor, touching itself on the way.
#[test]
fn a_sheet_drapes_without_penetration() {
    let sheet = irregular(0.15);
    let floor = Plane::new([0.0, 0.0, -0.2], [0.0, 0.0, 1.0]).expect("normal");
    let corner = VertexConstraint::on_surface(VertexId(0), floor, Side::Outside);
    let model = plate(&sheet, 0.1, 5e-3, &[])
        .with_damping(2.0)
        .expect("rate")
        .with_constraint(corner)
        .expect("vertex");
    let ball = Obstacle::fixed(
        Shape::Sphere { radius: 0.25 },
        Isometry3::translation(0.5, 0.5, -0.26),
    )
    .expect("radius");
    let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
        .expect("options")
        .with_body(ball, Coefficients::equal(0.3))
        .expect("body")
        .with_self_contact(Coefficients::equal(0.2))
        .expect("coefficients");
    let mut run = start(model, &sheet, Method::default())
        .with_contact(contacts)
        .expect("apart");
    let energy = run.energy();
    for report in advance(&mut run, 90, 0.5 * STEP) {
        let gap = report.gap.expect("a scene with contact");
        assert!(gap > 0.0, "{gap}");
    }
    assert!(run.energy() < energy);
    let corner = run.state().x[2];
    assert!(corner > -0.2 - 1e-9 && corner < -0.1, "{corner}");
}

#[test]
fn a_resumed_sheet_goes_on_bit_for_bit() {
    let sheet = irregular(0.2);
    let clamp = vertices(&sheet, |[x, y, _]| x + 0.4 * y < 0.35);
    let begin = || start(plate(&sheet, 0.1, 5e-3, &clamp), &sheet, Method::default());
    let (mut whole, mut first) = (begin(), begin());
    advance(&mut whole, 24, STEP);
    advance(&mut first, 12, STEP);
    let bytes = first.checkpoint().to_bytes().expect("encoded");
    let checkpoint = || Checkpoint::from_bytes(&bytes).expect("decoded");
    let model = plate(&sheet, 0.1, 5e-3, &clamp);
    let mut second = Simulation::resume(model, None, checkpoint()).expect("the same model");
    advance(&mut second, 12, STEP);
    assert_eq!(bits(&second.state().x), bits(&whole.state().x));
    assert_eq!(bits(&second.state().v), bits(&whole.state().v));
    // Rods and elastic sheets are other models.
    let rods = || {
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("positive mass");
        model.with_pins(&clamp).expect("vertices")
    };
    let elastic = rods().with_membrane(Membrane::new(&sheet, 1.0, 0.0).expect("stiffness"));
    for other in [rods(), elastic] {
        let refused = Simulation::resume(other, None, checkpoint()).err();
        let is_other = |e: &SimulationError| {
            matches!(
                e,
                SimulationError::Checkpoint(CheckpointError::OtherSheet { .. })
            )
        };
        assert!(refused.as_ref().is_some_and(is_other), "{refused:?}");
    }
}

#[test]
fn charts_are_refused() {
    let flat = generate::isotropic_square(1, 1.0).expect("valid");
    let corner = VertexId(20);
    let bent = flat
        .map_positions(|[x, y, _]| [x, y, 0.05 * (3.0 * x).sin() * (2.0 * y).cos()])
        .expect("no degenerate face");
    let options = AssignmentOptions {
        pins: vec![corner],
        degenerate: Degenerate::Assign,
        ..Default::default()
    };
    let chart = FrontChart::new(&bent, &options, bent.positions()).expect("folded");
    let model = plate(&flat, 0.1, 5e-4, &[corner]);
    let mut x = bent.positions().to_vec();
    project_positions(&model, &mut x, TOLERANCE).expect("near");
    let state = State::at_rest(x);
    let refused = Simulation::in_chart(model, state, Box::new(chart), ChartOptions::default());
    let error = refused.err();
    assert!(
        matches!(
            error,
            Some(SimulationError::Chart(ChartDynamicsError::Elastic))
        ),
        "{error:?}"
    );
}

/// An upright strip of the height `l`, clamped at its foot, falls over by its own weight where `q l^3 / d` is
/// above 7.837 (A. G. Greenhill, Proc. Cambridge Philos. Soc. 4, 1881), with `q` the weight per area and the
/// rigidity `d`.
#[test]
fn upright_strips_buckle_at_the_load_of_greenhill() {
    let (height, rigidity) = (0.3, 5e-4);
    let flat = generate::grid(2, 10, 0.06, height, Diagonals::UnionJack).expect("valid");
    let fallen = |load: f64, h: f64, slope: f64| {
        let clamp = vertices(&flat, |[_, y, _]| y < 0.035);
        let mass = load * rigidity / height.powi(3) / GRAVITY * flat.area();
        let model = SheetModel::new(&flat, mass, MassKind::Lumped)
            .expect("positive mass")
            .with_acceleration([0.0, -GRAVITY, 0.0])
            .with_damping(2.0)
            .and_then(|m| m.with_pins(&clamp))
            .expect("vertices")
            .with_potential(PlateBending::clamped(&flat, rigidity, &clamp).expect("rigidity"))
            .with_weak_isometry(WeakIsometry::of_plate(&flat, rigidity).expect("flat"))
            .expect("the same sheet");
        let mut x = flat.positions().to_vec();
        for p in x.as_chunks_mut::<3>().0 {
            p[2] = slope * (p[1] - 0.03).max(0.0).powi(2) / height;
        }
        project_positions(&model, &mut x, TOLERANCE).expect("near");
        let method = Method::ImplicitEuler(ImplicitOptions::default());
        let mut run = Simulation::new(model, State::at_rest(x), method).expect("starts");
        advance(&mut run, 60, h);
        let heights = run.state().x.as_chunks::<3>().0.iter().map(|p| p[2].abs());
        heights.fold(0.0, f64::max)
    };
    // The part that is free is 0.9 of the height: 7.837 / 0.9^3 = 10.75.
    let stable = fallen(9.5, 0.5, 1e-3);
    assert!(stable < 1e-5, "{stable}");
    let unstable = fallen(12.0, 0.5, 1e-3);
    assert!(unstable > 0.05, "{unstable}");
    // A strip that stands exactly upright has to be brought off the saddle of the incremental potential.
    let exact = fallen(40.0, 0.5, 0.0);
    assert!(exact > 0.05, "{exact}");
}

/// How far the free end of a heavy strip of length `l` (metres) hangs below its clamp, for the weight per
/// area `q` (newtons per square metre) and the rigidity `d` (newton metres):
/// `d theta'' = -q (l - s) cos theta`, `theta(0) = 0`, `theta'(l) = 0`, with the slope `theta` below the
/// horizontal, by the classical Runge-Kutta method and bisection for the curvature at the clamp.
fn elastica(l: f64, q: f64, d: f64) -> f64 {
    const STEPS: usize = 2000;
    let h = l / STEPS as f64;
    let rates = |s: f64, y: [f64; 3]| [y[1], -q / d * (l - s) * y[0].cos(), y[0].sin()];
    let shoot = |curvature: f64| {
        let mut y = [0.0, curvature, 0.0];
        for i in 0..STEPS {
            let s = i as f64 * h;
            let along = |y: [f64; 3], r: [f64; 3], h: f64| [0, 1, 2].map(|k| y[k] + h * r[k]);
            let a = rates(s, y);
            let b = rates(s + 0.5 * h, along(y, a, 0.5 * h));
            let c = rates(s + 0.5 * h, along(y, b, 0.5 * h));
            let e = rates(s + h, along(y, c, h));
            y = [0, 1, 2].map(|k| y[k] + h / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + e[k]));
        }
        y
    };
    let (mut low, mut high) = (0.0, 0.5 * q * l * l / d);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shoot(middle)[1] > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    shoot(low)[2]
}

/// A strip with eight squares across, clamped over its part up to x = 0. Its mesh lines are turned by up to
/// `turn` (radians) in swirls along the strip: rotations that depend on the distance from a point alone keep
/// areas.
fn strip(turn: f64) -> Sheet {
    let (width, radius) = (0.06, 0.03);
    let grid = generate::grid(44, 8, 0.33, width, Diagonals::UnionJack).expect("valid");
    grid.map_positions(|[x, y, z]| {
        let x = x - 0.03;
        for swirl in 0..5 {
            let middle = [radius * (1.0 + 2.0 * f64::from(swirl)), 0.5 * width];
            let [dx, dy] = [x - middle[0], y - middle[1]];
            let squared = (dx * dx + dy * dy) / (radius * radius);
            if squared < 1.0 {
                let (s, c) = (turn * (1.0 - squared).powi(2)).sin_cos();
                return [middle[0] + c * dx - s * dy, middle[1] + s * dx + c * dy, z];
            }
        }
        [x, y, z]
    })
    .expect("rotations keep areas")
}

#[test]
fn heavy_strips_are_the_elastica_on_turned_meshes() {
    let density = 0.08;
    for rigidity in [5e-3, 5e-4] {
        let exact = elastica(0.3, density * GRAVITY, rigidity);
        for turn in [0.0, 0.4] {
            let sheet = strip(turn);
            let clamp = vertices(&sheet, |[x, ..]| x < 1e-9);
            let model = plate(&sheet, density * sheet.area(), rigidity, &clamp)
                .with_damping(4.0)
                .expect("rate");
            let method = Method::ImplicitEuler(ImplicitOptions::default());
            let mut run = start(model, &sheet, method);
            advance(&mut run, 60, 0.05);
            let tip = vertices(&sheet, |[x, ..]| x > 0.3 - 1e-9);
            let heights = tip.iter().map(|v| run.state().x[3 * v.index() + 2]);
            let drop = -heights.sum::<f64>() / tip.len() as f64;
            let error = drop / exact - 1.0;
            assert!(error.abs() < 0.02, "{rigidity} {turn}: {drop} {exact}");
        }
    }
}
