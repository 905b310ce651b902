//! Elastic sheets: the limit of rigid rods, contact, supports, checkpoints.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::constraint::{Plane, Side};
use isosheet_dynamics::{
    CheckpointError, ElasticSheet, ImplicitOptions, Method, PlateBending, SheetModel, Simulation,
    SimulationError, State, VertexConstraint,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::Isometry3;

const STEP: f64 = 1.0 / 120.0;

fn sheet() -> Sheet {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    generate::delaunay(&outline, 0.15, 4).expect("valid")
}

/// Paper, heavier than usual: it weighs 0.1 kg.
fn paper(sheet: &Sheet, pins: &[VertexId]) -> SheetModel {
    SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .expect("positive mass")
        .with_gravity()
        .with_damping(2.0)
        .expect("positive rate")
        .with_pins(pins)
        .expect("vertices of the sheet")
        .with_potential(PlateBending::clamped(sheet, 5e-3, pins).expect("rigidity"))
        .with_elastic_sheet(ElasticSheet::new(sheet, 3e5, 0.3).expect("stiffness"))
        .expect("its own sheet")
}

/// A hanging ladder of rods, which has a motion of rods: the distance from it is of first order in the
/// compliance.
#[test]
fn rigid_rods_are_the_limit_to_first_order_in_the_compliance() {
    let ladder = generate::ladder(5, 0.1, 0.1).expect("valid");
    let tilted: Vec<f64> = ladder
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| [p[0], 0.8 * p[1], 0.6 * p[1]])
        .collect();
    let run = |stiffness: Option<f64>| {
        let mut model = SheetModel::new(&ladder, 0.1, MassKind::Lumped)
            .expect("positive mass")
            .with_acceleration([0.0, -9.8, 0.0])
            .with_pins(&[VertexId(0), VertexId(1)])
            .expect("vertices");
        if let Some(k) = stiffness {
            let elasticity = ElasticSheet::new(&ladder, k, 0.0).expect("stiffness");
            model = model.with_elastic_sheet(elasticity).expect("its own sheet");
        }
        let options = ImplicitOptions {
            tolerance: Some(1e-12),
            ..ImplicitOptions::default()
        };
        let method = Method::ImplicitEuler(options);
        let start = State::at_rest(tilted.clone());
        let mut run = Simulation::new(model, start, method).expect("starts");
        for _ in 0..20 {
            run.step(0.01).expect("runs");
        }
        run.state().x.clone()
    };
    let rods = run(None);
    let errors = [1e4, 1e5, 1e6].map(|k| {
        let x = run(Some(k));
        x.iter()
            .zip(&rods)
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log10();
        assert!((order - 1.0).abs() < 0.1, "{errors:?}");
    }
}

/// Clamped along a line that is no line of the mesh, on a ball and touching itself on the way: no step is
/// refused, every gap is positive, and the energy balance closes within what the method loses.
#[test]
fn an_elastic_sheet_drapes_without_penetration() {
    let sheet = sheet();
    let mut model = paper(&sheet, &[]);
    model = model
        .with_constraint(VertexConstraint::on_surface(
            VertexId(0),
            Plane::new([0.0, 0.0, -0.2], [0.0, 0.0, 1.0]).expect("normal"),
            Side::Outside,
        ))
        .expect("vertex");
    let ball = Obstacle::fixed(
        Shape::Sphere { radius: 0.25 },
        Isometry3::translation(0.5, 0.5, -0.26),
    )
    .expect("radius");
    let options = ContactOptions::for_sheet(&model);
    let contacts = Contacts::new(&model, options)
        .expect("options")
        .with_body(ball, Coefficients::equal(0.3))
        .expect("body")
        .with_self_contact(Coefficients::equal(0.2))
        .expect("coefficients");
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default())
        .expect("starts")
        .with_contact(contacts)
        .expect("apart");
    let energy = run.energy();
    for _ in 0..60 {
        let report = run.step(STEP).expect("runs");
        let gap = report.gap.expect("a scene with contact");
        assert!(gap > 0.0, "{gap}");
        assert!(report.strain < 5e-3, "{}", report.strain);
    }
    assert!(run.energy() < energy);
    let corner = run.state().x[2];
    assert!(corner > -0.2 - 1e-9 && corner < -0.1, "{corner}");
}

#[test]
fn a_resumed_elastic_sheet_goes_on_bit_for_bit() {
    let sheet = sheet();
    let pins: Vec<_> = sheet
        .topology()
        .vertex_ids()
        .filter(|v| sheet.position(*v)[0] + 0.4 * sheet.position(*v)[1] < 0.35)
        .collect();
    let start = || {
        let state = State::at_rest(sheet.positions().to_vec());
        Simulation::new(paper(&sheet, &pins), state, Method::default()).expect("starts")
    };
    super::checkpoint::compare("elastic", start, || paper(&sheet, &pins));
    // A model of rods is another sheet.
    let checkpoint = start().checkpoint();
    let rods = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .expect("positive mass")
        .with_pins(&pins)
        .expect("vertices");
    let refused = Simulation::resume(rods, None, checkpoint).err();
    assert!(
        matches!(
            refused,
            Some(SimulationError::Checkpoint(
                CheckpointError::OtherSheet { .. }
            ))
        ),
        "{refused:?}"
    );
}
