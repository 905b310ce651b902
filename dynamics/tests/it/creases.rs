//! Creases that are driven, and creases that yield, in motion.

use isosheet_dynamics::{
    At, CreaseSpring, CreaseSprings, Method, Potential, SheetModel, Simulation, SimulationError,
    State, Yield,
};
use isosheet_mesh::{EdgeId, MassKind, Sheet, Topology, VertexId, fold_angle};

/// Steps of a millisecond: until its fastest moment.
const DRIVEN: usize = 500;

/// The rest angle that is driven, radians.
fn ramp(t: f64) -> f64 {
    1.2 * t * t * (3.0 - 2.0 * t)
}

/// Two triangles folded along their edge by a driven spring against one of equal stiffness that is at rest
/// when flat: the final angle, the work of the drive and the energy that is missing.
fn driven(method: Method) -> [f64; 3] {
    let sheet = Sheet::new(
        vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.1, 0.1, 0.0, 0.0, 0.1, 0.0],
        &[[0, 1, 2], [0, 2, 3]],
    )
    .expect("a square");
    let t = sheet.topology();
    let edge = t.find_edge(VertexId(0), VertexId(2)).expect("the diagonal");
    let rests = [ramp.into(), 0.0.into()];
    let springs = rests.map(|rest| CreaseSpring {
        edge,
        stiffness: 1e-2,
        rest,
        yields: None,
        in_series: None,
    });
    let springs = CreaseSprings::new(t, springs.into()).expect("interior");
    let model = SheetModel::new(&sheet, 1e-3, MassKind::Lumped)
        .expect("valid")
        .with_potential(springs);
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, method).expect("valid");
    let mut report = run.step(1e-3).expect("accepted");
    for _ in 1..DRIVEN {
        report = run.step(1e-3).expect("accepted");
    }
    let angle = fold_angle(run.model().topology(), &run.state().x, edge).expect("interior");
    [angle, report.work, report.energy_drift]
}

#[test]
fn the_work_of_the_drive_closes_the_energy_balance() {
    // Half of the rest angle is the static balance, and what the two springs then store the work; kinetic
    // energy and inertia change both by a thousandth.
    let half = 0.5 * ramp(1e-3 * DRIVEN as f64);
    let exact = 0.5 * 2.0 * 1e-2 * half * half;
    for (method, bound) in [
        (Method::EnergyMomentum(Default::default()), 1e-5),
        (Method::Bdf2(Default::default()), 1e-3),
    ] {
        let [angle, work, drift] = driven(method.clone());
        assert!((angle - half).abs() < 1e-2, "{method:?}: {angle} rad");
        assert!((work - exact).abs() < 1e-2 * exact, "{method:?}: {work} J");
        assert!(
            drift.abs() < bound * exact,
            "{method:?}: {drift:e} J of {work:e} J"
        );
    }
}

const STIFFNESS: f64 = 1e-2;

const YIELD: Yield = Yield {
    moment: 2e-3,
    hardening: 1e-3,
    layers: 1,
};

/// Two triangles of a square and the edge between them.
fn hinge() -> (Sheet, EdgeId) {
    let x = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.1, 0.1, 0.0, 0.0, 0.1, 0.0];
    let sheet = Sheet::new(x, &[[0, 1, 2], [0, 2, 3]]).expect("a square");
    let edge = sheet.topology().find_edge(VertexId(0), VertexId(2));
    let edge = edge.expect("the diagonal");
    (sheet, edge)
}

fn spring(edge: EdgeId) -> CreaseSpring {
    CreaseSpring {
        edge,
        stiffness: STIFFNESS,
        rest: 0.0.into(),
        yields: Some(YIELD),
        in_series: None,
    }
}

/// The largest moment on a crease, newton metres.
const LARGEST: f64 = 3e-3;

/// A moment that folds an edge of a sheet: up to the largest one, and back to nothing.
#[derive(Debug)]
struct Moment(Topology, EdgeId);

impl Moment {
    fn at(t: f64) -> f64 {
        LARGEST * (1.0 - (5.0 * t - 1.0).abs()).max(0.0)
    }

    fn angle(&self, x: &[f64]) -> f64 {
        fold_angle(&self.0, x, self.1).expect("interior")
    }
}

impl Potential for Moment {
    fn energy(&self, At { t, x, .. }: At<'_>) -> f64 {
        -Self::at(t) * self.angle(x)
    }

    /// By differences of the angle, of which 1e-9 is missing.
    fn add_gradient(&self, At { t, x, .. }: At<'_>, gradient: &mut [f64]) {
        for (i, g) in gradient.iter_mut().enumerate() {
            let [up, down] = [1e-6, -1e-6].map(|d| {
                let mut moved = x.to_vec();
                moved[i] += d;
                self.angle(&moved)
            });
            *g -= Self::at(t) * (up - down) / 2e-6;
        }
    }

    fn is_driven(&self) -> bool {
        true
    }
}

/// A crease that is pressed and let go stays folded at what yielding has left.
#[test]
fn a_pressed_crease_stays_folded() {
    let run = |h: f64| {
        let (sheet, edge) = hinge();
        let springs = CreaseSprings::new(sheet.topology(), vec![spring(edge)]).expect("interior");
        let model = SheetModel::new(&sheet, 1e-7, MassKind::Lumped)
            .and_then(|m| m.with_potential(springs).with_damping(5.0))
            .expect("valid")
            .with_potential(Moment(sheet.topology().clone(), edge));
        let start = State::at_rest(sheet.positions().to_vec());
        let run = Simulation::new(model, start, Method::Bdf2(Default::default()));
        let mut run = run.unwrap_or_else(|e| panic!("{e}"));
        let mut report = run.step(h).expect("accepted");
        for _ in 1..(0.6 / h).round() as usize {
            report = run.step(h).expect("accepted");
        }
        let angle = fold_angle(sheet.topology(), &run.state().x, edge).expect("interior");
        (angle, report)
    };
    // Its moment is M_y + H p at the largest load.
    let expected = (LARGEST - YIELD.moment) / YIELD.hardening;
    let lost = YIELD.moment * expected;
    let found = [4e-3, 2e-3].map(run);
    for (angle, report) in &found {
        assert!(
            (angle - expected).abs() < 5e-3 * expected,
            "{angle} {expected}"
        );
        assert!((report.plastic - lost).abs() < 5e-3 * lost, "{report:?}");
        assert!(report.energy_drift.abs() < 0.02 * report.work, "{report:?}");
    }
}

#[test]
fn methods_that_do_not_minimise_are_refused() {
    let (sheet, edge) = hinge();
    for method in [
        Method::EnergyMomentum(Default::default()),
        Method::Rattle(Default::default()),
    ] {
        let springs = CreaseSprings::new(sheet.topology(), vec![spring(edge)]).expect("interior");
        let model = SheetModel::new(&sheet, 1e-3, MassKind::Lumped).expect("valid");
        let start = State::at_rest(sheet.positions().to_vec());
        let refused = Simulation::new(model.with_potential(springs), start, method);
        assert_eq!(refused.err(), Some(SimulationError::Plastic));
    }
}
