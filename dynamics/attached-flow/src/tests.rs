//! Lift, added mass and their growth against closed forms of wing theory.

use super::*;
use isosheet_dynamics::Wind;
use isosheet_mesh::generate::{Diagonals, grid};
use isosheet_mesh::{MassKind, Sheet};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// A plate with its chord along x in air of unit density, its trailing edge at the end of the chord.
struct Plate {
    sheet: Sheet,
    air: InAir,
    chord: f64,
    span: f64,
}

impl Plate {
    fn new([columns, rows]: [usize; 2], [chord, span]: [f64; 2], wind: [f64; 3]) -> Self {
        let sheet = grid(columns, rows, chord, span, Diagonals::UnionJack).expect("a grid");
        let topology = sheet.topology();
        let at_end = |v: isosheet_mesh::VertexId| sheet.position(v)[0] > chord - 1e-9;
        let trailing: Vec<EdgeId> = topology
            .edge_ids()
            .filter(|e| topology.edges()[e.index()].iter().all(|v| at_end(*v)))
            .collect();
        let lengths = isosheet_mesh::LengthConstraints::new(&sheet);
        let faces: Vec<FaceId> = topology.face_ids().collect();
        let lattice = Lattice::new(topology, lengths.lengths(), &faces, &trailing).expect("valid");
        Self {
            air: InAir {
                lattice,
                density: 1.0,
                wind: Wind::from(wind),
            },
            sheet,
            chord,
            span,
        }
    }

    fn start(&self, rows: usize) -> Past {
        let edge = self
            .air
            .lattice
            .edge(&self.air.lattice.shape(self.sheet.positions()));
        let none = vec![0.0; self.air.lattice.faces.len()];
        Past::at_start(Size::of(&self.air.lattice, rows), 0.0, none, &edge)
    }

    /// Force on the plate at rest at the end of a step, and the wake after it.
    fn step(&self, past: &Past, span: f64) -> (Vector3<f64>, Past) {
        let x = self.sheet.positions();
        let rest = vec![0.0; x.len()];
        let past = past.carried(&self.air.wind, span);
        let t = past.times[0] + span;
        let flow = self.air.flow(&past, t, x).expect("a flow");
        let circulation = self.air.circulation(&flow, &rest);
        let edges = self.air.edge_forces(&flow.shape, t, &rest);
        let shape = flow.shape.clone();
        let past = flow.settled(t, circulation);
        let forces = self
            .air
            .forces(&shape, &edges, &past.circulations[0], &past.rate);
        (forces.iter().sum(), past)
    }

    /// Lift of the steady flow, which has a wake without an end, as a part of `rho U^2 S / 2`.
    fn steady_lift(&self) -> f64 {
        let (_, past) = self.step(&self.start(2), 1e6 * self.chord);
        let steady = vec![0.0; past.rate.len()];
        let x = self.sheet.positions();
        let shape = self.air.lattice.shape(x);
        let edges = self.air.edge_forces(&shape, 0.0, &vec![0.0; x.len()]);
        let forces = self
            .air
            .forces(&shape, &edges, &past.circulations[0], &steady);
        2.0 * forces.iter().sum::<Vector3<f64>>().z / (self.chord * self.span)
    }
}

fn inclined(angle: f64) -> [f64; 3] {
    [angle.cos(), 0.0, angle.sin()]
}

impl Plate {
    /// Derivative of the coefficient of lift by the angle of attack, in steady flow.
    fn lift_slope(cells: [usize; 2], aspect: f64) -> f64 {
        let angle = 0.01;
        Self::new(cells, [1.0, aspect], inclined(angle)).steady_lift() / angle
    }

    /// Mass of the air that a plate moves which is accelerated across, without a wake.
    fn added_mass(cells: [usize; 2], size: [f64; 2]) -> f64 {
        let plate = Self::new(cells, size, [0.0; 3]);
        let x = plate.sheet.positions();
        let across = [0.0, 0.0, 1.0].repeat(x.len() / 3);
        let flow = plate.air.flow(&plate.start(2), 0.0, x).expect("a flow");
        let rate = plate.air.circulation(&flow, &across);
        let edges = plate.air.edge_forces(&flow.shape, 0.0, &across);
        let forces = plate.air.forces(&flow.shape, &edges, &rate, &rate);
        -forces.iter().sum::<Vector3<f64>>().z
    }
}

/// Jones (NACA Report 835, 1946) for slender wings; Tuck (J. Austral. Math. Soc. B 35, 1993) for the square
/// one; Helmbold (1942), within a twentieth of lifting surfaces, for long ones.
#[test]
fn lift_is_that_of_wing_theory() {
    let helmbold = |aspect: f64| 2.0 * PI * aspect / (2.0 + (4.0 + aspect * aspect).sqrt());
    for (cells, aspect, exact, within) in [
        ([8, 8], 0.2, 0.1 * PI, 0.01),
        ([8, 8], 1.0, 1.460, 0.01),
        ([6, 12], 4.0, helmbold(4.0), 0.07),
        ([6, 24], 20.0, helmbold(20.0), 0.05),
    ] {
        let found = Plate::lift_slope(cells, aspect);
        let error = found / exact - 1.0;
        assert!(
            error.abs() < within,
            "aspect ratio {aspect}: {found} {exact}"
        );
    }
}

/// Of a square and of a plate ten times as long as wide, as parts of `pi a^2 b / 4` (DNV-RP-H103, 2011, Table
/// A-2, by Patton 1965). The error falls by half with the size of faces.
#[test]
fn the_added_mass_of_plates_is_that_of_tables() {
    for (size, exact) in [
        ([1.0, 1.0], 0.579),
        ([1.0, 0.1], 0.947),
        ([0.1, 1.0], 0.947),
    ] {
        let width = f64::min(size[0], size[1]);
        let cylinder = PI / 4.0 * width * size[0] * size[1];
        let [coarse, fine] = [4, 8].map(|n| Plate::added_mass([n, n], size) / cylinder);
        assert!(coarse < fine && fine < exact, "{coarse} {fine} {exact}");
        let limit = 2.0 * fine - coarse;
        assert!((limit / exact - 1.0).abs() < 0.02, "{limit} {exact}");
    }
}

/// The lift of a long plate that is set in motion at once: half of it at first, two thirds after a chord
/// (Wagner 1925, by the formula of Jones, NACA Report 681, 1940).
#[test]
fn lift_grows_by_the_function_of_wagner() {
    let plate = Plate::new([6, 4], [1.0, 50.0], inclined(0.01));
    let steady = plate.steady_lift();
    let mut past = plate.start(20);
    for step in 1..=36 {
        let (force, next) = plate.step(&past, 1.0 / 12.0);
        past = next;
        let semichords = f64::from(step) / 6.0;
        if semichords < 1.0 {
            continue;
        }
        let wagner = 1.0 - 0.165 * (-0.0455 * semichords).exp() - 0.335 * (-0.3 * semichords).exp();
        let found = 2.0 * force.z / 50.0 / steady;
        assert!(
            (found - wagner).abs() < 0.01,
            "{semichords}: {found} {wagner}"
        );
    }
}

#[test]
fn wind_along_a_plate_does_nothing() {
    let plate = Plate::new([4, 4], [1.0, 2.0], [3.0, 0.4, 0.0]);
    let mut past = plate.start(4);
    for _ in 0..8 {
        let (force, next) = plate.step(&past, 0.2);
        past = next;
        assert!(force.norm() < 1e-12, "{force}");
    }
}

#[test]
fn flows_that_cannot_be_are_refused() {
    let sheet = grid(2, 2, 1.0, 1.0, Diagonals::UnionJack).expect("a grid");
    let topology = sheet.topology();
    let rim = |is_rim: bool| {
        let mut edges = topology.edge_ids();
        let edge = edges.find(|e| topology.is_boundary_edge(*e) == is_rim);
        edge.expect("there are both")
    };
    let flow = AttachedFlow {
        faces: topology.face_ids().collect(),
        trailing: vec![rim(true)],
        rows: 4,
    };
    let refused = |flow: &AttachedFlow| {
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).expect("mass");
        flow.around(model, Air::default()).err()
    };
    let face = FaceId(99);
    let (faces, edge) = (vec![face], rim(false));
    let many = vec![FaceId(0); AttachedFlow::MOST_FACES + 1];
    let flow = || flow.clone();
    assert_eq!(refused(&flow()), None);
    for (flow, error) in [
        (
            AttachedFlow { faces, ..flow() },
            AttachedFlowError::NoSuchFace {
                face,
                face_count: 8,
            },
        ),
        (
            AttachedFlow {
                faces: many,
                ..flow()
            },
            AttachedFlowError::TooManyFaces {
                faces: AttachedFlow::MOST_FACES + 1,
                most: AttachedFlow::MOST_FACES,
            },
        ),
        (
            AttachedFlow {
                trailing: Vec::new(),
                ..flow()
            },
            AttachedFlowError::NoTrailingEdge,
        ),
        (
            AttachedFlow {
                trailing: vec![edge],
                ..flow()
            },
            AttachedFlowError::NotAtRim { edge },
        ),
        (
            AttachedFlow { rows: 1, ..flow() },
            AttachedFlowError::Rows { rows: 1 },
        ),
        (
            AttachedFlow {
                rows: usize::MAX,
                ..flow()
            },
            AttachedFlowError::Rows { rows: usize::MAX },
        ),
    ] {
        assert_eq!(refused(&flow), Some(error));
    }
}
