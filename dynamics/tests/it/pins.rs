//! Pins that move by profiles and by functions.

use isosheet_dynamics::{
    Method, ModelError, MotionError, PointMotion, PointProfile, Profile, SheetModel, Simulation,
    State, leave_flat,
};
use isosheet_mesh::{MassKind, VertexId, generate};

#[test]
fn a_pin_with_an_unusable_motion_is_named() {
    let sheet = generate::isotropic_square(0, 1.0).unwrap();
    let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
    let bad = PointProfile {
        y: f64::NAN.into(),
        ..PointProfile::default()
    };
    let error = model.with_moving_pin(VertexId(1), bad).unwrap_err();
    assert!(
        matches!(error, ModelError::Motion { vertex: VertexId(1), source: MotionError::Profile { name, .. } } if name.ends_with('y')),
        "{error}"
    );
}

/// A small sheet that hangs by a shaken corner: the end of half a second.
fn shaken(method: Method, motion: impl Into<PointMotion>) -> State {
    let sheet = generate::isotropic_square(0, 0.2).unwrap();
    let mut x = sheet.positions().to_vec();
    let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Consistent)
        .unwrap()
        .with_gravity()
        .with_moving_pin(VertexId(0), motion)
        .unwrap();
    leave_flat(&model, &mut x, 0.02, 1).unwrap();
    let mut run = Simulation::new(model, State::at_rest(x), method).unwrap();
    for _ in 0..100 {
        run.step(2e-3).unwrap();
    }
    run.state().clone()
}

#[test]
fn pins_by_profiles_move_as_pins_by_functions() {
    let sheet = generate::isotropic_square(0, 0.2).unwrap();
    let shake = PointProfile {
        offset: sheet.position(VertexId(0)),
        x: Profile::SmoothStep {
            from: 0.0,
            to: 0.03,
            begin: 0.02,
            end: 0.15,
        },
        z: Profile::Sine {
            mean: 0.0,
            amplitude: 0.01,
            frequency: 3.0,
            phase: 0.0,
        },
        ..PointProfile::default()
    };
    for method in [
        Method::default(),
        Method::EnergyMomentum(Default::default()),
        Method::Rattle(Default::default()),
    ] {
        let name = format!("{method:?}");
        let exact = shaken(method.clone(), shake.clone());
        let profile = shake.clone();
        let custom = shaken(method, move |t| profile.position(t));
        let moved = exact.x[2] - sheet.positions()[2];
        assert!(moved.abs() > 1e-4, "{name}: the pin moved by {moved} m");
        let error = |a: &[f64], b: &[f64]| {
            let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            differences.fold(0.0, f64::max)
        };
        // Velocities by differences are good to 1e-8 of their change in a step.
        let (dx, dv) = (error(&exact.x, &custom.x), error(&exact.v, &custom.v));
        assert!(
            dx < 1e-9 && dv < 1e-7,
            "{name}: off by {dx:e} m, {dv:e} m/s"
        );
    }
}
