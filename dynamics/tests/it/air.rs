//! Air that is no air.

use isosheet_dynamics::{Air, Method, SheetModel, Simulation, State, StepError};
use isosheet_mesh::{MassKind, generate};

/// A wind that is not finite ends the step with the time and a vertex, whenever it becomes so.
#[test]
fn a_broken_wind_is_named() {
    let sheet = generate::isotropic_square(0, 1.0).expect("valid");
    for bad_from in [0.0, 0.015] {
        let wind = move |_: [f64; 3], t: f64| [0.0, 0.0, if t < bad_from { 1.0 } else { f64::NAN }];
        let air = Air {
            wind: wind.into(),
            ..Air::default()
        };
        let start = State::at_rest(sheet.positions().to_vec());
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
        let model = model.with_air(air).expect("valid");
        let mut run = Simulation::new(model, start, Method::default()).expect("valid");
        let error = (0..10).find_map(|_| run.step(0.01).err()).expect("refused");
        let cause = match error {
            StepError::StepTooSmall { cause, .. } => *cause,
            other => other,
        };
        assert!(
            matches!(cause, StepError::NonFiniteForce { .. }),
            "{cause:?}"
        );
        assert!(run.state().t <= bad_from);
    }
}
