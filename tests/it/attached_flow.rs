//! Attached flow: flags that flutter, and a wing that glides.

use isosheet_attached_flow::AttachedFlow;
use isosheet_dynamics::{
    Air, ElasticSheet, Method, PlateBending, PlateStiffness, RattleOptions, SheetModel, Simulation,
    SimulationError, State,
};
use isosheet_mesh::{EdgeId, MassKind, MassMatrix, Sheet, VertexId, generate};
use isosheet_tests::flag::{Flag, slender_threshold};
use std::f64::consts::PI;

/// A flag whose mass and that of its air have a ratio of four to one.
fn flag() -> Flag {
    let height = 0.1;
    let air = PI * height / 4.0;
    Flag {
        height,
        mass: 4.0 * air,
        wind: 0.0,
    }
}

/// Of pipes that convey a fluid, with the speed in units of `sqrt(B / M) / L`: Gregory and Paidoussis, Proc.
/// R. Soc. A 293, 1966, read off their Fig. 2 to one part in fifty.
#[test]
fn the_theory_of_slender_flags_is_that_of_pipes() {
    for (share, published) in [(0.1, 4.75), (0.2, 5.6), (0.5, 9.3)] {
        let Flag { height, mass, .. } = flag();
        let air = mass / 4.0;
        let flag = Flag {
            mass: air * (1.0 - share) / share,
            ..flag()
        };
        let speed = slender_threshold(flag) * air.sqrt();
        assert!(
            (speed / published - 1.0).abs() < 0.02,
            "{height} {share}: {speed}"
        );
    }
}

/// Flutter begins at the wind of the theory of slender bodies: below it a flag comes to rest, above it a
/// small deflection grows, and the growth rate is zero within 15 %.
#[test]
fn a_slender_flag_flutters_in_the_wind_of_the_theory() {
    let threshold = slender_threshold(flag());
    let growth = |part: f64| {
        let wind = part * threshold;
        Flag { wind, ..flag() }.growth([10, 2], 50, 6)
    };
    let [below, at, above] = [0.8, 1.0, 1.2].map(growth);
    assert!(below < 0.0 && above > 0.0, "{below} {at} {above}");
    assert!(below < at && at < above, "{below} {at} {above}");
    let zero = match at > 0.0 {
        true => 1.0 - 0.2 * at / (at - below),
        false => 1.0 - 0.2 * at / (above - at),
    };
    assert!((zero - 1.0).abs() < 0.15, "{zero}");
}

/// A rectangular wing of stiff paper with a bent-up rear edge and ballast at the front.
struct Glider {
    chord: f64,
    span: f64,
    /// Angle by which the last quarter of the chord is bent up.
    bend: f64,
    /// Kilograms.
    ballast: f64,
}

const GRAVITY: f64 = 9.81;
const TANGENTIAL: f64 = 0.02;

impl Glider {
    fn aspect(&self) -> f64 {
        self.span / self.chord
    }

    /// Flies from level attitude towards -x.
    fn simulation(&self, is_attached: bool, [ahead, down]: [f64; 2]) -> (Simulation, f64) {
        let flat = generate::grid(8, 6, self.chord, self.span, generate::Diagonals::UnionJack);
        let hinge = 0.75 * self.chord;
        let sheet = flat.expect("a grid").map_positions(|[x, y, z]| {
            let behind = (x - hinge).max(0.0);
            [
                x - behind * (1.0 - self.bend.cos()),
                y,
                z + behind * self.bend.sin(),
            ]
        });
        let sheet: Sheet = sheet.expect("bent");
        let topology = sheet.topology();
        let x = |v: VertexId| sheet.position(v)[0];
        let rear = topology.vertex_ids().map(x).fold(0.0, f64::max);
        let is_rear = |e: &EdgeId| {
            topology.edges()[e.index()]
                .iter()
                .all(|v| x(*v) > rear - 1e-9)
        };
        let nose: Vec<VertexId> = topology.vertex_ids().filter(|v| x(*v) < 1e-9).collect();
        let stiffness = PlateStiffness {
            rigidity: 0.1,
            poisson: 0.0,
        };
        let plate = PlateBending::new(&sheet, stiffness)
            .expect("a plate")
            .curved(&sheet);
        let elastic = ElasticSheet::new(&sheet, 1e4, 0.0).expect("elastic");
        let mut mass = MassMatrix::from_density(&sheet, 0.08, MassKind::Lumped).expect("mass");
        for v in &nose {
            mass.vertex[v.index()] += self.ballast / nose.len() as f64;
        }
        let weight = GRAVITY * mass.vertex.iter().sum::<f64>();
        let air = Air {
            tangential: TANGENTIAL,
            ..Air::default()
        };
        let model = SheetModel::with_mass(&sheet, mass)
            .map(|m| {
                m.with_acceleration([0.0, 0.0, -GRAVITY])
                    .with_potential(plate)
            })
            .and_then(|m| m.with_elastic_sheet(elastic))
            .expect("a model");
        let model = match is_attached {
            false => model.with_air(air).expect("air"),
            true => {
                let flow = AttachedFlow {
                    faces: topology.face_ids().collect(),
                    trailing: topology.edge_ids().filter(is_rear).collect(),
                    rows: 40,
                };
                flow.around(model, air).expect("a flow")
            }
        };
        let v = [-ahead, 0.0, -down].repeat(topology.vertex_count());
        let start = State::moving(sheet.positions().to_vec(), v);
        let run = Simulation::new(model, start, Method::default()).expect("a simulation");
        (run, weight)
    }
}

/// Mean position of the vertices.
fn place(run: &Simulation) -> [f64; 3] {
    let points = run.state().x.as_chunks::<3>().0;
    [0, 1, 2].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64)
}

/// A glider comes down by the ratio of its lift and drag. Its wing has the lift of Helmbold, a bent-up flap
/// of a quarter of the chord takes 0.61 of its angle off (Glauert, "Aerofoil and airscrew theory", 1926), and
/// as the suction of the sharp leading edge is lost, the drag of lift is that of a force across the wing.
/// With all of that suction the ratio would be that of an elliptic wing. In separated flow it dives.
#[test]
fn a_wing_glides_by_its_lift() {
    let glider = Glider {
        chord: 0.2,
        span: 0.6,
        bend: 0.05,
        ballast: 0.022,
    };
    let fly = |is_attached: bool, from: f64, until: f64| {
        let (mut run, weight) = glider.simulation(is_attached, [3.6, 0.5]);
        let step = 0.02;
        let mut begin = [0.0; 3];
        while run.state().t < until - 0.5 * step {
            if (run.state().t - from).abs() < 0.5 * step {
                begin = place(&run);
            }
            run.step(step).expect("a step");
        }
        let end = place(&run);
        let [ahead, down] = [0, 2].map(|k| (begin[k] - end[k]) / (until - from));
        (ahead, down, weight)
    };
    // A whole swing, between two of its fastest points.
    let (ahead, down, weight) = fly(true, 2.0, 4.8);
    let area = glider.chord * glider.span;
    let (aspect, friction) = (glider.aspect(), TANGENTIAL);
    let lift = 2.0 * weight / (1.2 * (ahead * ahead + down * down) * area);
    let slope = 2.0 * PI * aspect / (2.0 + (4.0 + aspect * aspect).sqrt());
    let angle = lift / slope + 0.61 * glider.bend;
    let without_suction = lift / (friction + lift * angle.tan());
    let with_suction = lift / (friction + lift * lift / (PI * aspect));
    let ratio = ahead / down;
    assert!(
        (ratio / without_suction - 1.0).abs() < 0.15,
        "{ratio} {without_suction}"
    );
    assert!(ratio < with_suction, "{ratio} {with_suction}");
    let (ahead, down, _) = fly(false, 1.0, 2.0);
    assert!(down > 3.0 * ahead, "{ahead} {down}");
}

#[test]
fn methods_that_do_not_minimise_refuse_the_wake() {
    let sheet = generate::isotropic_square(1, 0.2).expect("a square");
    let topology = sheet.topology();
    let flow = AttachedFlow {
        faces: topology.face_ids().collect(),
        trailing: topology
            .edge_ids()
            .filter(|e| topology.is_boundary_edge(*e))
            .take(2)
            .collect(),
        rows: 4,
    };
    let model = SheetModel::new(&sheet, 0.01, MassKind::Lumped).expect("mass");
    let model = flow.around(model, Air::default()).expect("a flow");
    let start = State::at_rest(sheet.positions().to_vec());
    let refused = Simulation::new(model, start, Method::Rattle(RattleOptions::default()));
    assert_eq!(refused.err(), Some(SimulationError::NeedsMinimising));
}
