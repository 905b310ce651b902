//! Lengths that change by themselves, against a sheet with other lengths, and in motion.

use isosheet_dynamics::{
    At, Checkpoint, ElasticSheet, ElasticSheetError, LimitError, Limited, Method, Potential,
    Profile, Remembering, SheetModel, Simulation, SimulationError, State, StepError, StepReport,
    Support,
};
use isosheet_mesh::{Advice, MassKind, Sheet, generate};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STIFFNESS: f64 = 3e5;
const LENGTH: f64 = 0.2;
const WIDTH: f64 = 0.05;

fn strip() -> Sheet {
    generate::anisotropic_grid(8, 2, LENGTH, WIDTH).unwrap()
}

/// Swells by the part `s` until the time 0.5 s.
fn until(s: f64) -> Profile {
    Profile::SmoothStep {
        from: 0.0,
        to: s,
        begin: 0.0,
        end: 0.5,
    }
}

/// A strip that swells, of Poisson's ratio zero; where `held`, both of its ends are.
fn model(swelling: Profile, held: &[f64]) -> SheetModel {
    let sheet = strip();
    let elastic = ElasticSheet::new(&sheet, STIFFNESS, 0.0).unwrap();
    let elastic = elastic.with_swelling(swelling).unwrap();
    let pins = sheet.vertices_where(|[x, _, _]| held.iter().any(|h| (x - h).abs() < 1e-9));
    SheetModel::new(&sheet, 0.08 * sheet.area(), MassKind::Lumped)
        .and_then(|model| model.with_pins(&pins))
        .and_then(|model| model.with_elastic_sheet(elastic))
        .and_then(|model| model.with_damping(20.0))
        .unwrap()
}

fn start(model: SheetModel) -> Simulation {
    let at_rest = State::at_rest(strip().positions().to_vec());
    Simulation::new(model, at_rest, Method::default()).unwrap()
}

const STEP: f64 = 1.0 / 60.0;

/// After a second in equal steps.
fn ran(model: SheetModel, steps: usize) -> (Simulation, StepReport) {
    let mut run = start(model);
    let step = 1.0 / steps as f64;
    let report = (0..steps).map(|_| run.step(step).unwrap()).last();
    (run, report.unwrap())
}

/// Energy, forces, stiffness (by forces of second order), strains and safe parts equal a sheet that is made
/// with these lengths. The energy of an area is `E h e^2 / 2` of smaller strains `e` there, and of a larger
/// area.
#[test]
fn a_swollen_sheet_is_one_with_longer_edges() {
    let sheet = strip();
    for s in [-0.15, -0.002, 0.03, 0.2] {
        let scaled = |d: &f64| (1.0 + s) * d;
        let longer: Vec<f64> = sheet.positions().iter().map(scaled).collect();
        let longer = Sheet::from_topology(sheet.topology().clone(), longer).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut moved = |size: f64| -> Vec<f64> {
            let x = longer.positions().iter();
            x.map(|p| p + rng.random_range(-size..size)).collect()
        };
        let (x, end) = (moved(1e-4), moved(2e-3));
        let dx: Vec<f64> = end.iter().zip(&x).map(|(a, b)| a - b).collect();
        let ramp = Profile::Ramp {
            from: 0.0,
            to: 2.0 * s,
            begin: 1.0,
            end: 3.0,
        };
        let at = At::new(2.0, &x);
        let found = [(&sheet, ramp), (&longer, 0.0.into())].map(|(sheet, swelling)| {
            let of_area = sheet.area() / strip().area();
            let elastic = ElasticSheet::new(sheet, of_area * STIFFNESS, 0.3).unwrap();
            let elastic = elastic.with_swelling(swelling).unwrap();
            let mut numbers: Vec<f64> = elastic.strains(at).collect();
            let most = numbers.iter().copied().fold(0.0, f64::max);
            // The barrier acts from half the limit on.
            let elastic = elastic.with_limit(1.2 * most).unwrap();
            let mut memory = elastic.memory();
            memory[0] = 10.0 / of_area;
            let own = at.with_memory(&memory);
            numbers.push(elastic.safe_part(own, &dx));
            numbers.extend(elastic.face_energies(own));
            let mut gradient = vec![0.0; x.len()];
            elastic.add_gradient(own, &mut gradient);
            numbers.extend(&gradient);
            let is_curved = elastic.add_second_order(own, &dx, 1.0, &mut gradient);
            assert!(is_curved);
            numbers.extend(gradient);
            numbers
        });
        let [found, expected] = found;
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-8 * (1.0 + b.abs()), "{s}: {a} {b}");
        }
    }
}

/// A strip that is held at both ends and shrinks pulls with the force `E h w (s - s^2 / 2)`, and what it
/// stores is the work of shrinking.
#[test]
fn a_held_strip_that_shrinks_pulls_at_its_supports() {
    let s = -0.002;
    let (run, report) = ran(model(until(s), &[0.0, LENGTH]), 60);
    let strain = 0.5 * (1.0 - (1.0_f64 + s).powi(2));
    let expected = STIFFNESS * WIDTH * strain;
    let held = run.reactions();
    let mut pulls = [0.0; 2];
    for reaction in held {
        let Support::Pin(v) = reaction.support else {
            unreachable!("pins alone");
        };
        let end = usize::from(strip().position(v)[0] > 0.5 * LENGTH);
        pulls[end] += reaction.force.x;
    }
    for (found, expected) in pulls.iter().zip([-expected, expected]) {
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }
    let least = 0.5 * STIFFNESS * strain * strain * LENGTH * WIDTH;
    assert!(report.potential > least, "{} {least}", report.potential);
    let rest = report.energy_drift.abs();
    assert!(
        rest < 1e-3 * report.potential,
        "{rest} {}",
        report.potential
    );
}

/// It keeps its shape, scaled, without strain, forces and energy, and no work is done on it.
#[test]
fn a_free_sheet_swells_without_stress() {
    for s in [-0.05, 0.02] {
        let (run, report) = ran(model(until(s), &[]), 60);
        let all = 0.5 * STIFFNESS * s * s * LENGTH * WIDTH;
        assert!(run.energy() < 1e-9 * all, "{s}: {}", run.energy());
        assert!(report.energy_drift.abs() < 1e-6 * all, "{s}: {report:?}");
        let edges = run.model().edges();
        let x = run.state().vertex_positions();
        for (ends, length) in edges.edges().iter().zip(edges.lengths()) {
            let [a, b] = ends.map(|v| Vector3::from(x[v]));
            let (found, expected) = ((a - b).norm(), (1.0 + s) * length);
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
    }
}

#[test]
fn a_resumed_sheet_that_swells_goes_on_bit_for_bit() {
    let sheet = || model(until(-0.004), &[0.0]);
    let bits = |run: &Simulation| {
        let State { x, v, .. } = run.state();
        x.iter().chain(v).map(|n| n.to_bits()).collect::<Vec<_>>()
    };
    let (mut whole, mut first) = (start(sheet()), start(sheet()));
    for _ in 0..20 {
        whole.step(STEP).unwrap();
    }
    for _ in 0..10 {
        first.step(STEP).unwrap();
    }
    let bytes = first.checkpoint().to_bytes().unwrap();
    let kept = Checkpoint::from_bytes(&bytes).unwrap();
    let mut second = Simulation::resume(sheet(), None, kept).unwrap();
    for _ in 0..10 {
        second.step(STEP).unwrap();
    }
    assert_eq!(bits(&second), bits(&whole));
}

/// A swelling of zero at all times changes no bit.
#[test]
fn a_sheet_that_does_not_swell_moves_as_one_without_a_swelling() {
    let without = {
        let sheet = strip();
        let elastic = ElasticSheet::new(&sheet, STIFFNESS, 0.0).unwrap();
        let pins = sheet.vertices_where(|[x, _, _]| x.abs() < 1e-9);
        SheetModel::new(&sheet, 0.08 * sheet.area(), MassKind::Lumped)
            .and_then(|model| model.with_pins(&pins))
            .and_then(|model| model.with_elastic_sheet(elastic))
            .and_then(|model| model.with_damping(20.0))
            .unwrap()
    };
    let ends = [without, model(until(0.0), &[0.0])].map(|model| {
        let mut run = start(model.with_gravity());
        for _ in 0..10 {
            run.step(STEP).unwrap();
        }
        run.state().clone()
    });
    assert_eq!(ends[0], ends[1]);
}

/// The error of the first step that is refused.
fn refused(model: SheetModel) -> StepError {
    let mut run = start(model);
    let error = (0..120).find_map(|_| run.step(STEP).err());
    let error = error.expect("a step is refused");
    assert!(run.state().x.iter().all(|x| x.is_finite()));
    match error {
        StepError::StepTooSmall { cause, .. } => *cause,
        other => other,
    }
}

#[test]
fn what_a_sheet_cannot_follow_is_refused() {
    // More than the limit of the strain at once.
    let jump = Profile::Ramp {
        from: 0.0,
        to: 0.05,
        begin: 0.1,
        end: 0.1 + 1e-9,
    };
    // Held, and shrinking by more than that.
    for model in [model(jump, &[]), model(until(-0.05), &[0.0, LENGTH])] {
        let error = refused(model);
        let StepError::Limit(LimitError::SwellingBeyondLimit { strain, limit, .. }) = error else {
            panic!("{error:?}");
        };
        assert!(strain >= limit, "{strain} {limit}");
        assert!(error.advice().unwrap().contains("slowly"));
    }
    // Beyond what it is made for.
    let error = refused(model(until(0.5), &[]));
    let StepError::Limit(LimitError::Swelling { part, .. }) = error else {
        panic!("{error:?}");
    };
    assert!(part > ElasticSheet::SWELLING[1] && part < 0.25, "{part}");
    assert!(error.advice().is_some());
    let started = |s: f64| {
        let at_rest = State::at_rest(strip().positions().to_vec());
        let run = Simulation::new(model(s.into(), &[]), at_rest, Method::default());
        run.err().expect("the start is refused")
    };
    let error = started(0.05);
    assert!(
        matches!(
            error,
            SimulationError::Start(StepError::BeyondStrainLimit { .. })
        ),
        "{error:?}"
    );
    for bad in [-1.0, -3.0, 0.21] {
        let error = started(bad);
        assert!(
            matches!(error, SimulationError::Start(StepError::Limit(LimitError::Swelling { part, .. })) if part == bad),
            "{error:?}"
        );
    }
    let elastic = ElasticSheet::new(&strip(), STIFFNESS, 0.0).unwrap();
    let error = elastic.with_swelling(f64::NAN).unwrap_err();
    assert!(matches!(error, ElasticSheetError::Profile(_)), "{error}");
}
