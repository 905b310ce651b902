//! What has no derivative, and what cannot be differentiated.

use crate::problems::as_meshed;
use crate::support::bdf2;
use isosheet_adjoint::{
    AdjointError, AdjointOptions, Branches, Kept, OfState, Plan, Run, Scene, SceneError, Share,
    StepEvent, coordinate,
};
use isosheet_dynamics::{
    At, EnergyMomentumOptions, Fallback, Force, HessianSink, ImplicitOptions, Material, Method,
    Potential, RattleOptions, SheetModel, State, StepControl, Yield,
};
use isosheet_mesh::{Advice, EdgeId, MassKind, Sheet, VertexId, generate};
use nalgebra::{Matrix3, Vector3};
use std::ops::ControlFlow;

/// A force that does not say how it depends on positions.
#[derive(Debug)]
struct Silent;

impl Force for Silent {
    fn add_force(&self, _t: f64, x: &[f64], _v: &[f64], force: &mut [f64]) {
        force[2] -= 0.01 * x[2];
    }
}

fn curved() -> Result<Sheet, SceneError> {
    let square = generate::isotropic_square(1, 0.1)?;
    Ok(square.map_positions(|[x, y, _]| [x, y, 2.0 * x * x - y * (y - 0.02)])?)
}

fn rods(p: &[f64]) -> Result<SheetModel, SceneError> {
    let model = SheetModel::new(&curved()?, 4e-3, MassKind::Lumped)?;
    Ok(model
        .with_acceleration([0.0, 0.0, -p[0]])
        .with_pins(&[VertexId(0)])?)
}

fn scene(model: SheetModel) -> Result<Scene, SceneError> {
    Ok(Scene::new(
        model,
        State::at_rest(curved()?.positions().to_vec()),
    ))
}

fn plan() -> Plan {
    Plan::steps(bdf2(), 5e-3, 3)
}

#[test]
fn a_silent_force_is_refused_or_passed_by() {
    let family = |p: &[f64]| scene(rods(p)?.with_force(Silent));
    let loss = coordinate(20, 2, 3);
    let run = Run::record(&family, &[9.8], plan(), AdjointOptions::default()).expect("a run");
    let error = run
        .gradient(&loss)
        .expect_err("a force without a derivative");
    assert!(matches!(error, AdjointError::NoDerivative { t, .. } if (t - 0.015).abs() < 1e-12));
    assert!(error.to_string().contains("Silent"), "{error}");
    assert!(error.advice().is_some());
    let options = AdjointOptions {
        branches: Branches::PassBy,
        ..AdjointOptions::default()
    };
    let run = Run::record(&family, &[9.8], plan(), options).expect("a run");
    let gradient = run.gradient(&loss).expect("a gradient");
    assert_eq!(gradient.passed_by.len(), 3);
    assert!(gradient.passed_by[0].what.contains("Silent"));
}

#[test]
fn a_sheet_that_yields_is_refused() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(8, 2, 0.16, 0.04)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
        let model = SheetModel::of_material(&sheet, &Material::office_paper())
            .clamped(&clamp)
            .yielding(Yield::perfect(1e-4))
            .build()?
            .with_acceleration([0.0, 0.0, -p[0]]);
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(Method::default(), 2e-2, 6);
    let run = Run::record(&family, &[9.8], plan, AdjointOptions::default()).expect("a run");
    let error = run.gradient(&coordinate(8, 2, 6)).expect_err("it yields");
    assert!(
        matches!(error, AdjointError::NoDerivative { .. }),
        "{error}"
    );
    assert!(error.to_string().contains("remembers"), "{error}");
}

#[test]
fn methods_without_accepted_steps_are_refused() {
    let family = |p: &[f64]| scene(rods(p)?);
    let plan = Plan::steps(Method::Rattle(RattleOptions::default()), 1e-4, 2);
    let refused = Run::record(&family, &[9.8], plan, AdjointOptions::default());
    assert!(matches!(
        refused.err(),
        Some(AdjointError::Method { number: 0 })
    ));
}

#[test]
fn other_sheets_are_refused() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let model = rods(p)?;
        scene(match p[0] > 9.8 {
            true => model.with_pins(&[VertexId(4)])?,
            false => model,
        })
    };
    let run = Run::record(&family, &[9.8], plan(), AdjointOptions::default()).expect("a run");
    let error = run
        .gradient(&coordinate(20, 2, 3))
        .expect_err("another sheet");
    assert!(
        matches!(error, AdjointError::OtherSheet { number: 0, .. }),
        "{error}"
    );
}

#[test]
fn scenes_that_cannot_be_built_are_named() {
    let family = |p: &[f64]| match p[0] > 9.8 {
        true => Err("too heavy".into()),
        false => scene(rods(p)?),
    };
    let run = Run::record(&family, &[9.8], plan(), AdjointOptions::default()).expect("a run");
    let error = run.gradient(&coordinate(20, 2, 3)).expect_err("no scene");
    assert!(
        matches!(
            error,
            AdjointError::Scene {
                number: Some(0),
                ..
            }
        ),
        "{error}"
    );
    let refused = Run::record(&family, &[10.0], plan(), AdjointOptions::default());
    let error = refused.err().expect("no scene");
    assert!(
        matches!(error, AdjointError::Scene { number: None, .. }),
        "{error}"
    );
}

#[test]
fn numbers_that_cannot_be_changed_are_refused() {
    let family = |_: &[f64]| scene(rods(&[9.8])?);
    let number = [f64::INFINITY];
    let run = Run::record(&family, &number, plan(), AdjointOptions::default()).expect("a run");
    let error = run.gradient(&coordinate(20, 2, 3)).expect_err("no number");
    assert!(
        matches!(error, AdjointError::Number { number: 0, .. }),
        "{error}"
    );
}

#[test]
fn losses_of_other_states_are_refused() {
    let family = |p: &[f64]| scene(rods(p)?);
    let run = Run::record(&family, &[9.8], plan(), AdjointOptions::default()).expect("a run");
    let loss = |n: usize, _: &State| {
        let of = OfState::zeros(5);
        (n == 3).then_some(Share::of_state(0.0, of))
    };
    let error = run.gradient(&loss).expect_err("another length");
    assert!(
        matches!(
            error,
            AdjointError::LossLength {
                step: 3,
                found: 5,
                ..
            }
        ),
        "{error}"
    );
    assert!(error.advice().is_some());
}

/// Parts that are made again from their checkpoints give the same bits.
#[test]
fn checkpoints_change_nothing() {
    let family = |p: &[f64]| scene(rods(p)?);
    let loss = coordinate(20, 2, 7);
    let plan = Plan::steps(bdf2(), 5e-3, 7);
    let gradient = |kept| {
        let options = AdjointOptions {
            kept,
            ..AdjointOptions::default()
        };
        let run = Run::record(&family, &[9.8], plan.clone(), options).expect("a run");
        run.gradient(&loss).expect("a gradient")
    };
    let all = gradient(Kept::All);
    for checkpoints in [1, 3, 7] {
        let again = gradient(Kept::Between { checkpoints });
        assert_eq!(again.value, all.value);
        assert_eq!(again.of_numbers, all.of_numbers);
        assert_eq!(again.of_start, all.of_start);
    }
}

/// A scene that is another one each time it is built is found out.
#[test]
fn runs_that_cannot_be_repeated_are_refused() {
    let count = std::sync::atomic::AtomicUsize::new(0);
    let family = |p: &[f64]| {
        let built = count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        scene(rods(&[p[0] + built as f64])?)
    };
    let options = AdjointOptions {
        kept: Kept::Between { checkpoints: 2 },
        ..AdjointOptions::default()
    };
    let run = Run::record(&family, &[9.8], plan(), options).expect("a run");
    let error = run
        .gradient(&coordinate(20, 2, 3))
        .expect_err("another run");
    let expected = matches!(
        error,
        AdjointError::NotRepeated { .. } | AdjointError::Start(_)
    );
    assert!(expected, "{error}");
}

/// The unstable potential `-k (sum z)^2 / 2` of the heights of the vertices of a triangle.
#[derive(Debug)]
struct Unstable(f64);

impl Unstable {
    fn sum(at: At<'_>) -> f64 {
        at.x.iter().skip(2).step_by(3).sum()
    }
}

impl Potential for Unstable {
    fn energy(&self, at: At<'_>) -> f64 {
        -0.5 * self.0 * Self::sum(at).powi(2)
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        for g in gradient.iter_mut().skip(2).step_by(3) {
            *g -= self.0 * Self::sum(at);
        }
    }

    fn add_hessian(&self, _at: At<'_>, hessian: &mut dyn HessianSink) {
        let block = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, -self.0));
        for k in 0..3 {
            hessian.add_vertex(VertexId(k), &block);
            hessian.add_edge(EdgeId(k), &block);
        }
    }
}

/// At a branch the matrix of a step is singular: here that of three masses `m` at once, less `3 h^2 k = m`.
#[test]
fn branches_are_refused() {
    let (m, h) = (1e-3, 0.5);
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let corners = [0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0];
        let sheet = Sheet::new(corners.to_vec(), &[[0, 1, 2]])?;
        let model = SheetModel::new(&sheet, 3.0 * m, MassKind::Lumped)?
            .with_potential(Unstable(p[0] * m / (3.0 * h * h)));
        Ok(as_meshed(model, &sheet))
    };
    let method = Method::ImplicitEuler(ImplicitOptions::default());
    let plan = Plan::steps(method, h, 1);
    let gradient = |part: f64| {
        let run = Run::record(&family, &[part], plan.clone(), AdjointOptions::default());
        run.expect("a run").gradient(&coordinate(0, 2, 1))
    };
    let error = gradient(1.0).expect_err("a branch");
    assert!(
        matches!(error, AdjointError::Unsolved { t, residual } if t == h && residual > 1e-6),
        "{error}"
    );
    assert!(error.advice().is_some());
    // Below it a mean height at the start grows to `1 / (1 - 3 h^2 k / m)` of it.
    let of_start = gradient(0.9).expect("a gradient").of_start.x;
    let of_heights: f64 = of_start.iter().skip(2).step_by(3).sum();
    assert!((of_heights - 10.0).abs() < 1e-6, "{of_start:?}");
}

/// A flat loaded sheet of rods that a conservative method cannot leave: the fallback does, and is a branch.
#[test]
fn fallbacks_are_refused_or_named() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::isotropic_square(1, 0.21)?;
        let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
            .with_acceleration([0.0, 0.0, -p[0]])
            .with_pins(&[VertexId(20)])?;
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan {
        method: Method::EnergyMomentum(EnergyMomentumOptions::default()),
        control: StepControl {
            fallback: Fallback::ImplicitEuler(ImplicitOptions::default()),
            ..StepControl::default()
        },
        steps: vec![1.0 / 60.0],
    };
    let run = Run::record(&family, &[9.8], plan, AdjointOptions::default()).expect("a run");
    let error = run.gradient(&coordinate(0, 2, 1)).expect_err("a fallback");
    let expected = matches!(
        error,
        AdjointError::Event {
            event: StepEvent::Fallback,
            ..
        }
    );
    assert!(expected, "{error}");
    assert!(error.to_string().contains("fallback"), "{error}");
}

/// Whoever watches may end a run, and the way back over it; losses that are no numbers are refused.
#[test]
fn what_is_ended_and_what_is_no_number() {
    let family = |p: &[f64]| scene(rods(p)?);
    let options = AdjointOptions::default;
    let ends = &mut || ControlFlow::Break(());
    let ended = Run::record_watched(&family, &[9.8], plan(), options(), ends);
    assert!(matches!(ended.err(), Some(AdjointError::Interrupted)));
    let run = Run::record(&family, &[9.8], plan(), options()).expect("a run");
    let ended = run.gradient_watched(&coordinate(20, 2, 3), ends);
    assert!(matches!(ended.err(), Some(AdjointError::Interrupted)));
    let loss = |n: usize, state: &State| {
        (n == 2).then(|| Share::of_state(f64::NAN, OfState::zeros(state.x.len())))
    };
    let error = run.gradient(&loss).expect_err("no number");
    assert!(
        matches!(error, AdjointError::LossValue { step: 2, .. }),
        "{error}"
    );
}
