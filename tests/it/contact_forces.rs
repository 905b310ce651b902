//! Forces of contact and gaps at the vertices, against statics, balances of momentum and distances.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{
    ElasticSheet, ImplicitOptions, Method, SheetModel, Simulation, State, StepControl,
};
use isosheet_geometry::distance::{edge_edge, point_triangle};
use isosheet_mesh::{MassKind, Sheet, generate};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

const G: f64 = 9.8;
const MASS: f64 = 0.1;
const STEP: f64 = 1.0 / 240.0;

fn vectors(values: &[f64]) -> impl Iterator<Item = Vector3<f64>> + '_ {
    values.as_chunks::<3>().0.iter().map(|p| Vector3::from(*p))
}

fn forces(simulation: &Simulation) -> Vec<f64> {
    simulation.contact_forces().expect("contact")
}

fn total(values: &[f64]) -> Vector3<f64> {
    vectors(values).sum()
}

/// Sum of the moments about the origin, newton metres.
fn moment(x: &[f64], forces: &[f64]) -> Vector3<f64> {
    vectors(x)
        .zip(vectors(forces))
        .map(|(x, f)| x.cross(&f))
        .sum()
}

fn tight() -> ImplicitOptions {
    ImplicitOptions {
        tolerance: Some(1e-12),
        ..Default::default()
    }
}

/// A tilted plane that falls along x by the angle `slope` (radians).
fn plane(slope: f64) -> Isometry3<f64> {
    Isometry3::rotation(Vector3::new(0.0, slope, 0.0))
}

/// A rigid plate of three rods at a height of `gap` above a plane with friction.
fn plate(slope: f64, friction: f64, gap: f64, method: Method) -> Simulation {
    let flat = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.05, 0.08, 0.0];
    let sheet = Sheet::new(flat, &[[0, 1, 2]]).expect("a triangle");
    let model = SheetModel::new(&sheet, MASS, MassKind::Lumped).expect("valid");
    let model = model.with_gravity().with_damping(20.0).expect("valid");
    let pose = plane(slope);
    let place =
        |p: &[f64; 3]| -> [f64; 3] { (pose * (Point3::from(*p) + Vector3::z() * gap)).into() };
    let x = sheet.positions().as_chunks::<3>().0.iter().flat_map(place);
    let start = State::at_rest(x.collect());
    let body = Obstacle::fixed(Shape::HalfSpace, pose).expect("valid");
    let options = ContactOptions {
        // Damping takes the momentum of the creep, and friction replaces it.
        rest_speed: 1e-7,
        ..ContactOptions::for_sheet(&model)
    };
    let contacts = Contacts::new(&model, options)
        .and_then(|c| c.with_body(body, Coefficients::equal(friction)))
        .expect("valid");
    Simulation::new(model, start, method)
        .and_then(|s| s.with_contact(contacts))
        .expect("nothing touches")
}

#[test]
fn a_plate_on_an_incline_is_carried_by_normal_forces_and_friction() {
    for slope in [0.0, 0.3_f64] {
        for method in [Method::Bdf2(tight()), Method::ImplicitEuler(tight())] {
            let mut run = plate(slope, 0.5, 5e-4, method);
            for _ in 0..600 {
                run.step(STEP).expect("accepted");
            }
            let frame = plane(slope);
            let (down, normal) = (frame * Vector3::x(), frame * Vector3::z());
            let sum = total(&forces(&run));
            let weight = MASS * G;
            // The force on the sheet is up the slope and away from the plane.
            let along = (sum.dot(&down) + weight * slope.sin()).abs();
            let across = (sum.dot(&normal) - weight * slope.cos()).abs();
            assert!(along < 1e-6 * weight, "{slope}: {along}");
            assert!(across < 1e-6 * weight, "{slope}: {across}");
            assert!(sum.y.abs() < 1e-6 * weight);
            // Three vertices of equal mass around the centre of mass share the normal force.
            for force in vectors(&forces(&run)) {
                let share = weight * slope.cos() / 3.0;
                assert!((force.dot(&normal) / share - 1.0).abs() < 1e-3, "{force}");
            }
        }
    }
}

/// A square of 0.5 m over a floor at zero and a ball, tilted, with or without rigid rods.
fn falling(is_elastic: bool, friction: f64, method: Method) -> Simulation {
    let flat = generate::isotropic_square(1, 0.5).expect("valid");
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.4);
    let place = |p: &[f64; 3]| -> [f64; 3] {
        (turn * Point3::from(*p) + Vector3::new(0.0, 0.0, 0.3)).into()
    };
    let x: Vec<f64> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(place)
        .collect();
    let model = SheetModel::new(&flat, MASS, MassKind::Lumped).expect("valid");
    let mut model = model.with_gravity();
    if is_elastic {
        let elasticity = ElasticSheet::new(&flat, 200.0, 0.3).expect("valid");
        model = model.with_elastic_sheet(elasticity).expect("its own sheet");
    }
    let floor = Obstacle::fixed(Shape::HalfSpace, Isometry3::identity()).expect("valid");
    let ball = Shape::Sphere { radius: 0.05 };
    let ball = Obstacle::fixed(ball, Isometry3::translation(0.2, 0.2, 0.06)).expect("valid");
    let mu = Coefficients::equal(friction);
    let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
        .and_then(|c| c.with_body(floor, mu))
        .and_then(|c| c.with_body(ball, mu))
        .and_then(|c| c.with_self_contact(mu))
        .expect("valid");
    // Forces belong to whole steps.
    let control = StepControl {
        min_fraction: 1.0,
        ..StepControl::default()
    };
    Simulation::new(model, State::at_rest(x), method)
        .and_then(|s| s.with_control(control)?.with_contact(contacts))
        .expect("nothing touches")
}

fn momentum(simulation: &Simulation) -> Vector3<f64> {
    simulation
        .model()
        .linear_momentum(&simulation.state().v)
        .into()
}

/// Largest difference of the rate of change of the momentum and the sum of weight and contact forces,
/// relative to the largest force of contact.
fn imbalance(mut run: Simulation) -> f64 {
    let (mut worst, mut largest, mut flights) = (0.0_f64, 0.0_f64, 0);
    for _ in 0..120 {
        let before = momentum(&run);
        let report = run.step(STEP).expect("accepted");
        let rate = (momentum(&run) - before) / STEP;
        let found = forces(&run);
        let bodies: Vector3<f64> = run.body_loads().iter().map(|l| l.force).sum();
        assert!((total(&found) + bodies).norm() < 1e-12 * (1.0 + bodies.norm()));
        if report.gap == Some(f64::INFINITY) {
            assert!(found.iter().all(|f| *f == 0.0), "in flight");
            flights += 1;
        }
        if report.substeps == 1 {
            let size: f64 = vectors(&found).map(|f| f.norm()).sum();
            let sum = total(&found) - Vector3::new(0.0, 0.0, MASS * G);
            worst = worst.max((rate - sum).norm());
            largest = largest.max(size);
        }
    }
    assert!(
        flights > 20 && largest > 5.0 * MASS * G,
        "{flights} {largest}"
    );
    worst / largest
}

#[test]
fn momentum_changes_by_weight_and_contact_in_flight_and_impact() {
    for friction in [0.0, 0.4] {
        let euler = || Method::ImplicitEuler(tight());
        // An elastic sheet ends a step where its forces balance. Rigid rods end it with a projection, after
        // which the forces of contact are others to second order.
        let elastic = imbalance(falling(true, friction, euler()));
        let rigid = imbalance(falling(false, friction, euler()));
        assert!(elastic < 1e-6, "{friction}: {elastic:.2e}");
        assert!(rigid < 1e-2, "{friction}: {rigid:.2e}");
    }
}

/// A square of 0.2 m in free flight, folded in the middle, whose halves swing towards each other.
fn closing(friction: f64) -> Simulation {
    let flat = generate::isotropic_square(1, 0.2).expect("valid");
    let (angle, rate) = (0.15_f64, 3.0);
    let (mut x, mut v) = (Vec::new(), Vec::new());
    for p in flat.positions().as_chunks::<3>().0 {
        // Both halves beside the fold at x = 0.1, which is a line of the mesh, stand upright but for `angle`.
        let (side, arm) = ((p[0] - 0.1).signum(), (p[0] - 0.1).abs());
        // Not opposite to each other: no vertex meets a vertex.
        let shift = if side > 0.0 { 0.0 } else { 0.1 * arm };
        let angle = angle + shift;
        x.extend([side * arm * angle.sin(), p[1], arm * angle.cos()]);
        v.extend([
            -side * rate * arm * angle.cos(),
            0.0,
            rate * arm * angle.sin(),
        ]);
    }
    let sheet = Sheet::new(x.clone(), &flat.face_indices()).expect("valid");
    let model = SheetModel::new(&sheet, MASS, MassKind::Lumped).expect("valid");
    let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
        .and_then(|c| c.with_self_contact(Coefficients::equal(friction)))
        .expect("valid");
    let start = State { t: 0.0, x, v };
    Simulation::new(model, start, Method::default())
        .and_then(|s| s.with_contact(contacts))
        .expect("nothing touches")
}

#[test]
fn a_sheet_pushes_itself_by_forces_and_moments_that_cancel() {
    for friction in [0.0, 0.5] {
        let mut run = closing(friction);
        let mut pressed = 0;
        for _ in 0..700 {
            run.step(1e-4).expect("accepted");
            let found = forces(&run);
            let size: f64 = vectors(&found).map(|f| f.norm()).sum();
            pressed += usize::from(size > 1e-3);
            assert!(total(&found).norm() <= 1e-13 * size, "{}", total(&found));
            if friction == 0.0 {
                let turning = moment(&run.state().x, &found).norm();
                assert!(turning <= 1e-12 * 0.2 * size, "{turning} {size}");
            }
            assert!(run.body_loads().is_empty());
        }
        assert!(pressed > 10, "{pressed}");
    }
}

/// Smallest distance of each vertex, and of the edges and faces at it, from all faces and edges of the sheet
/// without a common vertex, by all pairs; at most `reach`.
fn gaps_of_all_pairs(simulation: &Simulation, reach: f64) -> Vec<f64> {
    let (topology, x) = (simulation.model().topology(), &simulation.state().x);
    let place = |v: usize| Vector3::from_column_slice(&x[3 * v..3 * v + 3]);
    let mut gaps = vec![reach; x.len() / 3];
    let mut note = |vertices: [usize; 4], distance: f64| {
        for v in vertices {
            gaps[v] = gaps[v].min(distance);
        }
    };
    for v in 0..x.len() / 3 {
        for face in topology.faces() {
            let [a, b, c] = face.map(|v| v.index());
            if ![a, b, c].contains(&v) {
                let vertices = [v, a, b, c];
                note(vertices, point_triangle(&vertices.map(place)).distance());
            }
        }
    }
    for (k, one) in topology.edges().iter().enumerate() {
        for other in &topology.edges()[k + 1..] {
            if !one.iter().any(|v| other.contains(v)) {
                let vertices = [one[0], one[1], other[0], other[1]].map(|v| v.index());
                note(vertices, edge_edge(&vertices.map(place)).distance());
            }
        }
    }
    gaps
}

#[test]
fn gaps_of_a_sheet_to_itself_are_those_of_all_pairs() {
    let mut run = closing(0.0);
    let reach = ContactOptions::for_sheet(run.model()).activation;
    let mut partly = 0;
    for _ in 0..1400 {
        let report = run.step(5e-5).expect("accepted");
        let gaps = run.vertex_gaps().expect("contact");
        let expected = gaps_of_all_pairs(&run, reach);
        for (v, (gap, expected)) in gaps.iter().zip(&expected).enumerate() {
            assert!(
                (gap - expected).abs() < 1e-12 * reach,
                "{v}: {gap} {expected}"
            );
        }
        let least = gaps.iter().copied().fold(reach, f64::min);
        assert_eq!(least, report.gap.expect("contact").min(reach));
        let near = gaps.iter().filter(|gap| **gap < reach).count();
        partly += usize::from(0 < near && near < gaps.len());
    }
    assert!(partly > 5, "{partly}");
}

#[test]
fn gaps_from_a_plane_are_heights_less_the_thickness() {
    let flat = generate::isotropic_square(1, 0.2).expect("valid");
    let (thickness, activation) = (2e-3, 1e-3);
    // Heights of 2.1 mm to 3.3 mm: the last ones are out of reach.
    let lifted = |p: &[f64; 3]| [p[0], p[1], 2.1e-3 + 6e-3 * p[0]];
    let x: Vec<f64> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(lifted)
        .collect();
    let sheet = Sheet::new(x.clone(), &flat.face_indices()).expect("valid");
    let model = SheetModel::new(&sheet, MASS, MassKind::Lumped).expect("valid");
    let options = ContactOptions {
        thickness,
        activation,
        ..ContactOptions::for_sheet(&model)
    };
    let floor = Obstacle::fixed(Shape::HalfSpace, Isometry3::identity()).expect("valid");
    let contacts = Contacts::new(&model, options)
        .and_then(|c| c.with_body(floor, Coefficients::equal(0.3)))
        .expect("valid");
    let run = Simulation::new(model, State::at_rest(x.clone()), Method::default()).expect("valid");
    assert_eq!((run.contact_forces(), run.vertex_gaps()), (None, None));
    let run = run.with_contact(contacts).expect("nothing touches");
    let (gaps, forces) = (run.vertex_gaps().expect("contact"), forces(&run));
    for (v, gap) in gaps.iter().enumerate() {
        let expected = (x[3 * v + 2] - thickness).min(activation);
        assert!((gap - expected).abs() < 1e-15, "{v}: {gap} {expected}");
        // The barrier pushes where there is a contact, along the normal: no step has been taken.
        assert_eq!(forces[3 * v + 2] > 0.0, *gap < activation, "{v}");
        assert_eq!(forces[3 * v..3 * v + 2], [0.0; 2]);
    }
}
