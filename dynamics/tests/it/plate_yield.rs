//! Plates that could yield and do not.

use isosheet_dynamics::{
    Method, PlateBending, PlateStiffness, SheetModel, Simulation, State, Yield,
};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};

const RIGIDITY: f64 = 2.0;

const STIFFNESS: PlateStiffness = PlateStiffness {
    rigidity: RIGIDITY,
    poisson: 0.3,
};

/// An irregular mesh.
fn sheet() -> Sheet {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.8], [0.0, 0.8]];
    generate::delaunay(&outline, 0.2, 4).expect("valid")
}

/// What does not yield costs nothing: the same bits as without.
#[test]
fn a_plate_below_its_yield_moves_as_one_that_never_yields() {
    let sheet = sheet();
    let run = |plate: PlateBending| {
        let pins = [VertexId(0), VertexId(1)];
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .expect("mass")
            .with_gravity()
            .with_pins(&pins)
            .expect("vertices")
            .with_potential(plate);
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run =
            Simulation::new(model, start, Method::Bdf2(Default::default())).expect("valid");
        for _ in 0..5 {
            run.step(0.01).expect("accepted");
        }
        run.state().x.clone()
    };
    let hard = Yield::perfect(1e6);
    let elastic = PlateBending::new(&sheet, STIFFNESS).expect("rigidity");
    let yielding = PlateBending::new(&sheet, STIFFNESS).expect("rigidity");
    let yielding = yielding.with_yield(&sheet, hard).expect("valid");
    assert_eq!(run(elastic), run(yielding));
}
