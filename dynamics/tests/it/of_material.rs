//! Models that are made of a material.

use isosheet_dynamics::{Material, Method, PlateBending, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, generate};

fn strip() -> Sheet {
    generate::anisotropic_grid(8, 2, 0.2, 0.05).unwrap()
}

/// A state after some steps under gravity.
fn moved(sheet: &Sheet, model: SheetModel) -> State {
    let start = State::at_rest(sheet.positions().to_vec());
    let model = model.with_gravity();
    let mut simulation = Simulation::new(model, start, Method::default()).unwrap();
    for _ in 0..5 {
        simulation.step(1.0 / 60.0).unwrap();
    }
    simulation.state().clone()
}

#[test]
fn a_model_of_a_material_moves_as_the_one_that_is_built_of_its_parts() {
    let sheet = strip();
    let clamp = sheet.vertices_where(|[x, _, _]| x < 0.03);
    let steel = Material::aluminium_foil();
    let yields = steel.yields.unwrap().in_layers(2);
    let plate = PlateBending::clamped(&sheet, &steel, &clamp);
    let plate = plate.and_then(|p| p.with_yield(&sheet, yields)).unwrap();
    let elastic = steel.elastic_sheet(&sheet, &plate).unwrap();
    let by_hand = SheetModel::new(&sheet, steel.density * sheet.area(), MassKind::Lumped)
        .and_then(|m| m.with_pins(&clamp))
        .map(|m| m.with_potential(plate))
        .and_then(|m| m.with_elastic_sheet(elastic))
        .unwrap();
    let (first, second) = clamp.split_at(2);
    let model = SheetModel::of_material(&sheet, &steel)
        .clamped(first)
        .clamped(second)
        .yielding(yields)
        .build()
        .unwrap();
    assert_eq!(model.pins(), clamp);
    let (expected, found) = (moved(&sheet, by_hand), moved(&sheet, model));
    let lowest = expected.vertex_positions().iter().map(|p| p[2]);
    assert!(lowest.fold(0.0, f64::min) < -1e-3, "it hangs");
    for (a, b) in expected.x.iter().zip(&found.x) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}
