//! Forces of velocities that are stiff at some vertices alone.

use isosheet_dynamics::{Force, Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, VertexId, generate};

/// A dashpot at each vertex, newton seconds per metre.
#[derive(Debug)]
struct Dashpots(f64);

impl Force for Dashpots {
    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], force: &mut [f64]) {
        force.iter_mut().zip(v).for_each(|(f, v)| *f -= self.0 * v);
    }
}

/// A sheet of 3.5 g in all hangs by a corner. Its corners have a ninth of the mass of a vertex inside, so
/// that dashpots are too stiff for them long before they are for the sheet. It is never faster than one that
/// falls freely, and dashpots take energy.
#[test]
fn dashpots_never_drive_a_sheet() {
    let sheet = generate::isotropic_square(1, 0.2).expect("a square");
    let (mass, g) = (3.5e-3, 9.8);
    for c in [0.01, 0.05, 0.1, 0.2, 0.3] {
        let model = SheetModel::new(&sheet, mass, MassKind::Lumped)
            .expect("a model")
            .with_gravity()
            .with_pins(&[VertexId(0)])
            .expect("a pin")
            .with_force(Dashpots(c));
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::new(model, start, Method::default()).expect("a simulation");
        for _ in 0..10 {
            let report = run.step(1.0 / 60.0).expect("accepted");
            let free = 0.5 * mass * (g * report.t).powi(2);
            assert!(report.kinetic < free, "{c}: {} J of {free}", report.kinetic);
            assert!(report.work < 0.0, "{c}: {} J", report.work);
        }
    }
}
