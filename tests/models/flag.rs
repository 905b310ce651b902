//! A flag in a wind along it: a clamped elastic plate with attached flow.

use isosheet_attached_flow::AttachedFlow;
use isosheet_dynamics::{
    Air, ElasticSheet, Method, PlateBending, PlateStiffness, SheetModel, Simulation, State,
};
use isosheet_mesh::{EdgeId, FaceId, MassKind, MassMatrix, VertexId, generate};
use nalgebra::{Complex, DMatrix};

/// A plate of length and rigidity one (per length of its width), in air of density one.
#[derive(Debug, Clone, Copy)]
pub struct Flag {
    /// Height across the wind, in lengths.
    pub height: f64,
    /// Mass of an area of the plate.
    pub mass: f64,
    /// Speed of the wind.
    pub wind: f64,
}

impl Flag {
    /// The flag at rest but for a small velocity, with cells along the wind and across it.
    ///
    /// # Panics
    /// If it cannot be made.
    pub fn simulation(self, cells: [usize; 2]) -> Simulation {
        let (model, start) = self.model(cells);
        Simulation::new(model, start, Method::default()).expect("a simulation")
    }

    /// Model and start of [`Flag::simulation`].
    ///
    /// # Panics
    /// If it cannot be made.
    pub fn model(self, [columns, rows]: [usize; 2]) -> (SheetModel, State) {
        let cell = 1.0 / columns as f64;
        // A column more is within the clamp.
        let sheet = generate::grid(
            columns + 1,
            rows,
            1.0 + cell,
            self.height,
            generate::Diagonals::UnionJack,
        )
        .expect("a grid");
        let at = |v: VertexId| sheet.position(v)[0] - cell;
        let topology = sheet.topology();
        let clamp: Vec<VertexId> = topology.vertex_ids().filter(|v| at(*v) < 1e-9).collect();
        let stiffness = PlateStiffness {
            rigidity: 1.0,
            poisson: 0.0,
        };
        let plate = PlateBending::clamped(&sheet, stiffness, &clamp).expect("a plate");
        let elastic = ElasticSheet::new(&sheet, 1e4, 0.0)
            .expect("elastic")
            .beside(&sheet, &plate);
        let is_free = |f: &FaceId| topology.faces()[f.index()].iter().any(|v| at(*v) > 1e-9);
        let is_end = |e: &EdgeId| {
            topology.edges()[e.index()]
                .iter()
                .all(|v| at(*v) > 1.0 - 1e-9)
        };
        let flow = AttachedFlow {
            faces: topology.face_ids().filter(is_free).collect(),
            trailing: topology.edge_ids().filter(is_end).collect(),
            rows: AttachedFlow::ROWS,
        };
        let air = Air {
            density: 1.0,
            tangential: 0.0,
            wind: [self.wind, 0.0, 0.0].into(),
            ..Air::default()
        };
        let mass = MassMatrix::from_density(&sheet, self.mass, MassKind::Lumped).expect("mass");
        let model = SheetModel::with_mass(&sheet, mass)
            .and_then(|m| m.with_pins(&clamp))
            .map(|m| m.with_potential(plate))
            .and_then(|m| m.with_elastic_sheet(elastic))
            .expect("a model");
        let model = flow.around(model, air).expect("a flow");
        let push = |v: VertexId| 1e-4 * at(v).max(0.0).powi(2);
        let v = topology.vertex_ids().flat_map(|v| [0.0, 0.0, push(v)]);
        let start = State::moving(sheet.positions().to_vec(), v.collect());
        (model, start)
    }

    /// Growth rate of the largest deflections of the free end, over the last two of some periods of the mode
    /// that
    /// [`slender`] expects, with so many steps a period.
    ///
    /// # Panics
    /// If a step fails.
    pub fn growth(self, cells: [usize; 2], steps: usize, periods: usize) -> f64 {
        let period = std::f64::consts::TAU / slender(self).frequency;
        let mut run = self.simulation(cells);
        let mut largest = Vec::new();
        for _ in 0..periods {
            let mut most: f64 = 0.0;
            for _ in 0..steps {
                run.step(period / steps as f64).expect("a step");
                most = most.max(deflection(&run).abs());
            }
            largest.push(most);
        }
        (largest[periods - 1] / largest[periods - 3]).ln() / (2.0 * period)
    }
}

/// Mean deflection of the free end.
fn deflection(run: &Simulation) -> f64 {
    let points = run.state().x.as_chunks::<3>().0;
    let far = points.iter().map(|p| p[0]).fold(0.0, f64::max);
    let end = points.iter().filter(|p| p[0] > far - 1e-3);
    let end: Vec<f64> = end.map(|p| p[2]).collect();
    end.iter().sum::<f64>() / end.len() as f64
}

/// A growth rate and an angular frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Growth rate.
    pub growth: f64,
    /// Angular frequency.
    pub frequency: f64,
}

/// Modes of a clamped beam in the method of Galerkin.
const MODES: usize = 8;

/// The mode that grows fastest of a slender flag, whose air moves along in slices (Lighthill, J. Fluid Mech.
/// 9, 1960): with the mass of the plate `m` and of the air `M = pi H^2 / 4` per length,
///
/// ```text
/// B w'''' + m w_tt + M (d/dt + U d/dx)^2 w = 0,
/// ```
///
/// the equation of a pipe that conveys a fluid (Gregory and Paidoussis, Proc. R. Soc. A 293, 1966).
pub fn slender(flag: Flag) -> Mode {
    let air = std::f64::consts::PI * flag.height * flag.height / 4.0;
    let (plate, rigidity, wind) = (flag.mass * flag.height, flag.height, flag.wind);
    let roots: Vec<f64> = (0..MODES).map(root).collect();
    let points = 4000;
    let (mut gyroscopic, mut follower) =
        (DMatrix::zeros(MODES, MODES), DMatrix::zeros(MODES, MODES));
    for p in 0..points {
        let x = (p as f64 + 0.5) / f64::from(points);
        let shapes: Vec<[f64; 3]> = roots.iter().map(|r| shape(*r, x)).collect();
        for i in 0..MODES {
            for j in 0..MODES {
                gyroscopic[(i, j)] += shapes[i][0] * shapes[j][1] / f64::from(points);
                follower[(i, j)] += shapes[i][0] * shapes[j][2] / f64::from(points);
            }
        }
    }
    let bending = DMatrix::from_fn(MODES, MODES, |i, j| {
        if i == j {
            rigidity * roots[i].powi(4)
        } else {
            0.0
        }
    });
    let mass = plate + air;
    let stiffness = (bending + air * wind * wind * follower) / mass;
    let damping = 2.0 * air * wind * gyroscopic / mass;
    let mut first_order = DMatrix::zeros(2 * MODES, 2 * MODES);
    first_order
        .view_mut((0, MODES), (MODES, MODES))
        .fill_with_identity();
    first_order
        .view_mut((MODES, 0), (MODES, MODES))
        .copy_from(&-stiffness);
    first_order
        .view_mut((MODES, MODES), (MODES, MODES))
        .copy_from(&-damping);
    let values = first_order.complex_eigenvalues();
    let fastest = values
        .iter()
        .fold(Complex::new(f64::NEG_INFINITY, 0.0), |best, value| {
            if value.re > best.re { *value } else { best }
        });
    Mode {
        growth: fastest.re,
        frequency: fastest.im.abs(),
    }
}

/// The wind at which a slender flag begins to flutter.
pub fn slender_threshold(flag: Flag) -> f64 {
    let (mut below, mut above) = (0.0, 100.0 / flag.height.sqrt());
    // (Below the first threshold every mode decays.)
    let mut wind = 0.0;
    let step = above / 400.0;
    while wind < above {
        wind += step;
        if slender(Flag { wind, ..flag }).growth > 1e-9 {
            (below, above) = (wind - step, wind);
            break;
        }
    }
    for _ in 0..40 {
        let wind = 0.5 * (below + above);
        match slender(Flag { wind, ..flag }).growth > 1e-9 {
            true => above = wind,
            false => below = wind,
        }
    }
    0.5 * (below + above)
}

/// Roots of `cos r cosh r = -1`.
fn root(number: usize) -> f64 {
    let mut r = (number as f64 + 0.5) * std::f64::consts::PI;
    for _ in 0..50 {
        r -= (r.cos() + 1.0 / r.cosh()) / (-r.sin() - r.sinh() / r.cosh().powi(2));
    }
    r
}

/// A mode of a clamped beam with its first two derivatives.
fn shape(r: f64, x: f64) -> [f64; 3] {
    // cosh and sinh by exponentials, which cancel for high modes.
    let s = (r.cosh() + r.cos()) / (r.sinh() + r.sin());
    let (grow, fall) = (
        (1.0 - s) / 2.0 * (r * x).exp(),
        (1.0 + s) / 2.0 * (-r * x).exp(),
    );
    let (sin, cos) = (r * x).sin_cos();
    [
        grow + fall - cos + s * sin,
        r * (grow - fall + sin + s * cos),
        r * r * (grow + fall + cos - s * sin),
    ]
}
