use super::*;
use crate::{Coefficients, ContactOptions, Contacts, Keyframe};
use isosheet_dynamics::{Method, SheetModel, Simulation, State, Support};
use isosheet_geometry::TriangleSurface;
use isosheet_mesh::{MassKind, Sheet, generate};
use nalgebra::Isometry3;
use std::f64::consts::PI;
use std::sync::Arc;

const G: f64 = 9.8;

fn pose() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(0.1, -0.2, 0.3), Vector3::new(0.4, 0.7, -0.2))
}

/// Two triangles in the plane `z = -tan(slope) x`, normals upwards.
fn ramp(slope: f64) -> TriangleSurface {
    let fall = slope.tan();
    let x = [
        -1.0, -1.0, fall, 1.0, -1.0, -fall, 1.0, 1.0, -fall, -1.0, 1.0, fall,
    ];
    TriangleSurface::new(&x, &[[0, 1, 2], [0, 2, 3]]).unwrap()
}

fn tetrahedron() -> TriangleSurface {
    let x = [
        0.0, 0.0, 0.5, 0.5, 0.0, -0.3, -0.3, 0.5, -0.3, -0.3, -0.5, -0.3,
    ];
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    TriangleSurface::new(&x, &faces).unwrap()
}

fn shapes() -> Vec<Shape> {
    vec![
        Shape::HalfSpace,
        Shape::Cuboid {
            half: [0.2, 0.15, 0.1],
        },
        Shape::Sphere { radius: 0.2 },
        Shape::Cylinder {
            radius: 0.15,
            half_height: 0.2,
        },
        Shape::Capsule {
            radius: 0.1,
            half_length: 0.2,
        },
        Shape::Surface(Arc::new(tetrahedron())),
        Shape::Surface(Arc::new(ramp(0.3))),
    ]
}

#[test]
fn derivatives_of_levels_are_those_of_their_differences() {
    let h = 1e-6;
    for shape in shapes() {
        let shape = Level(shape);
        for i in 0..200 {
            let a = f64::from(i);
            let p = Vector3::new((1.3 * a).sin(), (2.1 * a).cos(), (0.7 * a).sin()) * 0.6;
            // Half of the points on the surface itself, where a constrained vertex is.
            let at = shape.at(&p);
            let p = if i % 2 == 0 {
                p
            } else {
                p - at.level * at.gradient
            };
            let at = shape.at(&p);
            let ends = |k: usize| {
                let mut d = Vector3::zeros();
                d[k] = h;
                [shape.at(&(p + d)), shape.at(&(p - d))]
            };
            // Across a sharp edge, and where the closest feature changes, there is no derivative.
            let smooth = (0..3).flat_map(ends).all(|e| {
                (e.gradient - at.gradient).norm() < 100.0 * h
                    && (e.hessian - at.hessian).norm() < 1e-2
            });
            if !smooth {
                continue;
            }
            for k in 0..3 {
                let [up, down] = ends(k);
                let slope = (up.level - down.level) / (2.0 * h);
                assert!(
                    (slope - at.gradient[k]).abs() < 1e-8,
                    "{:?} at {p:?}: {slope} against {}",
                    shape,
                    at.gradient[k]
                );
                let turn = (up.gradient - down.gradient) / (2.0 * h);
                let error = (turn - at.hessian.column(k)).norm();
                assert!(error < 1e-5, "{shape:?} at {p:?}: {error:e}");
            }
        }
    }
}

#[test]
fn constraints_move_as_their_bodies_do() {
    let keys = [(0.0, Isometry3::identity()), (1.0, pose())]
        .map(|(t, pose)| Keyframe { t, pose })
        .to_vec();
    let body = Obstacle::new(Shape::Sphere { radius: 0.2 }, keys).unwrap();
    let fixed = Obstacle::fixed(Shape::Sphere { radius: 0.2 }, pose()).unwrap();
    let p = Vector3::new(0.3, 0.2, 0.5);
    assert!(body.constraint(VertexId(0), Side::On).moves());
    assert!(!fixed.constraint(VertexId(0), Side::On).moves());
    for t in [0.0, 0.4, 1.0] {
        for b in [&body, &fixed] {
            let found = b.constraint(VertexId(0), Side::On).violation(t, &p);
            let want = b.signed_distance(t, &p).value.abs();
            assert!((found - want).abs() < 1e-15, "{found} {want}");
        }
    }
}

fn slide(x: Vec<f64>, body: &Obstacle, slope: f64) {
    for method in [
        Method::default(),
        Method::EnergyMomentum(Default::default()),
    ] {
        let name = format!("{method:?}");
        let sheet = Sheet::new(x.clone(), &[[0, 1, 2]]).unwrap();
        let mut model = SheetModel::new(&sheet, 0.3, MassKind::Lumped).unwrap();
        for v in 0..3 {
            model = model
                .with_constraint(body.constraint(VertexId(v), Side::On))
                .unwrap();
        }
        let model = model.with_acceleration([0.0, 0.0, -G]);
        let mut run = Simulation::new(model, State::at_rest(x.clone()), method).unwrap();
        let (h, steps) = (1e-3, 300);
        for _ in 0..steps {
            let report = run.step(h).unwrap();
            assert!(report.violation.unwrap() < 1e-11, "{name}");
        }
        let t = h * f64::from(steps);
        let moved = 0.5 * G * slope.sin() * t * t;
        for v in 0..3 {
            let want = Vector3::new(slope.cos(), 0.0, -slope.sin()) * moved;
            let found = Vector3::from_fn(|k, _| run.state().x[3 * v + k] - x[3 * v + k]);
            let error = (found - want).norm() / moved;
            assert!(error < 3e-4, "{name}: vertex {v} off by {error:e}");
        }
        let push: Vector3<f64> = run.reactions().iter().map(|r| r.force).sum();
        let want = Vector3::new(slope.sin(), 0.0, slope.cos()) * 0.3 * G * slope.cos();
        let error = (push - want).norm() / want.norm();
        assert!(error < 1e-3, "{name}: force off by {error:e}");
    }
}

/// A triangle slides down a plane of two faces, over the edge between them.
#[test]
fn a_triangle_slides_down_faces_at_g_sin() {
    let slope = 0.4_f64;
    let on = |u: f64, y: f64| [u * slope.cos(), y, -u * slope.sin()];
    let x = [on(-0.3, 0.01), on(-0.1, 0.03), on(-0.2, -0.2)].concat();
    let ramp = Shape::Surface(Arc::new(ramp(slope)));
    slide(
        x,
        &Obstacle::fixed(ramp, Isometry3::identity()).unwrap(),
        slope,
    );
}

/// A triangle hangs by its three corners from the inside of an inclined capsule and slides along it.
#[test]
fn a_triangle_slides_along_a_capsule_at_g_sin() {
    let (slope, radius, half_length) = (0.4_f64, 0.2, 2.0);
    // The axis runs downhill.
    let turn = Vector3::y() * (0.5 * PI + slope);
    let capsule = Shape::Capsule {
        radius,
        half_length,
    };
    let body = Obstacle::fixed(capsule, Isometry3::new(Vector3::zeros(), turn)).unwrap();
    let on = |u: f64, angle: f64| {
        let (s, c) = angle.sin_cos();
        let (y, n) = (radius * s, -radius * c);
        [
            u * slope.cos() + n * slope.sin(),
            y,
            -u * slope.sin() + n * slope.cos(),
        ]
    };
    let x = [on(0.0, 0.0), on(0.3, -0.6), on(0.3, 0.6)].concat();
    slide(x, &body, slope);
}

/// A sheet with one corner moved along a path, the opposite corner on a ball, and a floor below: lengths, gap
/// and supports are kept, and the floor carries weight.
#[test]
fn a_moving_corner_a_ball_and_a_floor_hold_together() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let n = sheet.positions().len() / 3;
    let height = 0.15;
    let x: Vec<f64> = sheet
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|p| [p[0], p[1], height])
        .collect();
    let corner = |a: f64, b: f64| {
        let at = (0..n).find(|&v| (x[3 * v] - a).hypot(x[3 * v + 1] - b) < 1e-9);
        VertexId(at.unwrap() as u32)
    };
    let (moving, fixed) = (corner(0.0, 0.0), corner(1.0, 1.0));
    let radius = 0.3;
    let centre = Isometry3::translation(1.0, 1.0, height - radius);
    let ball = Obstacle::fixed(Shape::Sphere { radius }, centre).unwrap();
    let path = move |t: f64| {
        let s = 0.15 * (1.0 - (3.0 * t).cos());
        [s, s, height + 0.5 * s]
    };
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
        .unwrap()
        .with_gravity()
        .with_moving_pin(moving, path)
        .unwrap()
        .with_constraint(ball.constraint(fixed, Side::On))
        .unwrap();
    let floor = Obstacle::fixed(Shape::HalfSpace, Isometry3::identity()).unwrap();
    let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
        .unwrap()
        .with_body(floor, Coefficients::equal(0.2))
        .unwrap();
    let mass = 0.1;
    let mut run = Simulation::new(
        model,
        State::at_rest(x),
        Method::ImplicitEuler(Default::default()),
    )
    .unwrap()
    .with_contact(contacts)
    .unwrap();
    let h = 1.0 / 120.0;
    let mut loads = 0.0_f64;
    for _ in 0..60 {
        let report = run.step(h).unwrap();
        assert!(report.gap.unwrap() > 0.0);
        assert!(report.strain < 1e-10 && report.violation.unwrap() < 1e-10);
        let t = run.state().t;
        let at = 3 * moving.0 as usize;
        assert_eq!(run.state().x[at..at + 3], path(t));
        let supports = run.reactions();
        assert_eq!(supports.len(), 2);
        assert!(supports.iter().any(|r| r.support == Support::Pin(moving)));
        let pushed = -run.body_loads()[0].force;
        loads = loads.max(pushed.z);
    }
    assert!(loads > 0.1 * mass * G, "the floor carries only {loads} N");
}
