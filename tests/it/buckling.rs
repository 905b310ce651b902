//! Strips of paper pushed at one end.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape, Stiffness};
use isosheet_dynamics::{
    CreaseSprings, ImplicitOptions, Method, SheetModel, Simulation, State, Support,
};
use isosheet_mesh::generate::{Diagonals, grid};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use nalgebra::Isometry3;
use std::f64::consts::PI;

const LENGTH: f64 = 0.06;
const WIDTH: f64 = 0.04;
const RIGIDITY: f64 = 5e-4;

/// A strip along x from 0 to [`LENGTH`] with two cells across.
fn strip(cells: usize) -> Sheet {
    grid(cells, 2, LENGTH, WIDTH, Diagonals::UnionJack).expect("valid")
}

fn rung(cells: usize, i: usize) -> [VertexId; 3] {
    [0, 1, 2].map(|j| VertexId::from_index(i + j * (cells + 1)))
}

/// The strip at rest as a tent: folded up at the second rung, folded down half way between there and the
/// rung `end`, and folded up again at `end`. A flat strip, which cannot give way, is singular; this one is
/// not.
fn tent(sheet: &Sheet, cells: usize, end: usize, slope: f64) -> Vec<f64> {
    let step = LENGTH / cells as f64;
    let mut line = vec![[0.0, 0.0], [step, 0.0]];
    for i in 1..cells {
        let angle = match i {
            i if i >= end => 0.0,
            i if 2 * i < end + 1 => slope,
            _ => -slope,
        };
        let [x, z] = line[i];
        line.push([x + step * angle.cos(), z + step * angle.sin()]);
    }
    let points = sheet.positions().as_chunks::<3>().0.iter();
    let place = |p: &[f64; 3]| {
        let [x, z] = line[(p[0] / step).round() as usize];
        [x, p[1], z]
    };
    points.flat_map(place).collect()
}

/// Paper of 80 g/m2 that bends.
fn paper(sheet: &Sheet) -> SheetModel {
    let bending = CreaseSprings::bending(sheet, RIGIDITY).expect("valid");
    SheetModel::new(sheet, 0.08 * sheet.area(), MassKind::Lumped)
        .and_then(|m| m.with_potential(bending).with_damping(20.0))
        .expect("valid")
}

/// Rods stiffer than the bending, which resists a step much more than inertia does.
fn method() -> Method {
    Method::Bdf2(ImplicitOptions {
        stiffness: 1e5,
        ..ImplicitOptions::default()
    })
}

/// Force along x on the first two rungs.
fn push(run: &Simulation, cells: usize) -> f64 {
    let nip = [rung(cells, 0), rung(cells, 1)].concat();
    let reactions = run.reactions().into_iter();
    let held = reactions.filter(|r| matches!(r.support, Support::Pin(v) if nip.contains(&v)));
    held.map(|r| r.force.x).sum()
}

#[test]
fn a_strip_jams_between_walls_without_touching() {
    let cells = 13;
    let sheet = strip(cells);
    let start = tent(&sheet, cells, cells, 0.1);
    let edge = start[3 * cells];
    let mut model = paper(&sheet);
    for v in [rung(cells, 0), rung(cells, 1)].concat() {
        let [x, y, z] = sheet.position(v);
        model = model
            .with_moving_pin(v, move |t| [x + 0.05 * t, y, z])
            .expect("exists");
    }
    let options = ContactOptions {
        activation: 8e-4,
        stiffness: Stiffness::Joules(2e-6),
        ..ContactOptions::for_sheet(&model)
    };
    let mut contacts = Contacts::new(&model, options).expect("valid");
    let wall = |half: [f64; 3], x: f64, z: f64| {
        let pose = Isometry3::translation(x, 0.5 * WIDTH, z);
        Obstacle::fixed(Shape::Cuboid { half }, pose).expect("valid")
    };
    // A channel of 10 mm, closed a millimetre before the leading edge.
    for body in [
        wall([0.2, 0.05, 0.01], 0.0, -0.015),
        wall([0.2, 0.05, 0.01], 0.0, 0.015),
        wall([0.01, 0.05, 0.004], edge + 0.011, 0.0),
    ] {
        contacts = contacts
            .with_body(body, Coefficients::equal(0.3))
            .expect("valid");
    }
    let mut run = Simulation::new(model, State::at_rest(start), method())
        .and_then(|r| r.with_contact(contacts))
        .expect("valid");
    let before = run.energy();
    let mut largest: f64 = 0.0;
    for step in 0..80 {
        let report = run
            .step(2.5e-3)
            .unwrap_or_else(|e| panic!("step {step}: {e}"));
        assert!(report.strain < 1e-10, "strain {:e}", report.strain);
        assert!(report.gap.is_some_and(|g| g > 0.0), "gap {:?}", report.gap);
        largest = largest.max(push(&run, cells));
        if step == 79 {
            // What the nip has paid for is stored in bending or lost.
            let stored = report.hamiltonian() - before;
            // Which buckle it snaps into depends on the step. The work of the jamming pins is that of the
            // trapezoidal rule, which errs where their force jumps as the strip snaps: by less than the
            // smallest of what the balance is made of, but for the damping of a slow motion.
            let parts = [stored, report.friction];
            let least = parts.into_iter().fold(f64::INFINITY, f64::min);
            assert!(least > 0.0 && report.dissipated > 0.0, "{report:?}");
            assert!(
                report.work > report.friction + report.dissipated,
                "{report:?}"
            );
            assert!(report.energy_drift.abs() < least, "{report:?}");
        }
    }
    // The walls let it buckle, and hold the buckle: it carries more than a free strip that is clamped at both
    // ends, 4 pi^2 D w / L^2, and less than it takes to buckle into two such waves, four times as much (Chai,
    // 1998).
    let bends = LENGTH * (1.0 - 1.5 / cells as f64);
    let clamped = 4.0 * RIGIDITY * WIDTH * (PI / bends).powi(2);
    assert!(
        (clamped..4.0 * clamped).contains(&largest),
        "{largest} N against {clamped} N"
    );
}
