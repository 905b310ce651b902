//! Derivatives against differences, and closest points against their definition.

use super::*;
use isosheet_motion::Profile;
use isosheet_motion::{AxisRotation, RigidDisplacement, RigidProfile};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

fn turned() -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(0.1, -0.2, 0.3),
        UnitQuaternion::from_euler_angles(0.4, -0.7, 1.1),
    )
}

fn samples() -> Vec<(&'static str, VertexConstraint)> {
    let id = VertexId(0);
    let knots = [
        [0.0, 0.0, 0.0],
        [0.4, 0.3, 0.1],
        [0.9, -0.1, 0.5],
        [1.2, 0.6, 0.2],
    ];
    let field = SignedDistanceField(|p: &Vector3<f64>| SurfacePoint {
        level: p.z - 0.2 * p.x * p.y,
        gradient: Vector3::new(-0.2 * p.y, -0.2 * p.x, 1.0),
        hessian: Matrix3::new(0.0, -0.2, 0.0, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0),
    });
    let surface = |s: Box<dyn Surface>, side| VertexConstraint {
        vertex: id,
        shape: Locus::Surface(s, side),
        motion: None,
    };
    let curve = |c: Box<dyn Curve>| VertexConstraint {
        vertex: id,
        shape: Locus::Curve(c),
        motion: None,
    };
    let mut all = Vec::new();
    let plane = Plane::new([0.1, 0.2, 0.3], [1.0, -2.0, 0.5]).expect("valid");
    let sphere = Sphere::new([0.1, 0.2, -0.3], 0.4).expect("valid");
    let cylinder = Cylinder::new([0.1, 0.2, -0.3], [1.0, 1.0, 0.3], 0.4).expect("valid");
    all.push(("plane", surface(Box::new(plane), Side::On)));
    all.push(("sphere", surface(Box::new(sphere.clone()), Side::On)));
    all.push(("in sphere", surface(Box::new(sphere), Side::Inside)));
    all.push(("cylinder", surface(Box::new(cylinder), Side::Outside)));
    all.push(("field", surface(Box::new(field), Side::On)));
    let line = Line::new([0.1, 0.2, -0.3], [1.0, 1.0, 0.3]).expect("valid");
    let circle = Circle::new([0.1, 0.2, -0.3], [1.0, 1.0, 0.3], 0.7).expect("valid");
    all.push(("line", curve(Box::new(line))));
    all.push(("circle", curve(Box::new(circle))));
    all.push((
        "polyline",
        curve(Box::new(Polyline::new(&knots, 0.1).expect("valid"))),
    ));
    all.push((
        "spline",
        curve(Box::new(Spline::open(&knots).expect("valid"))),
    ));
    all.push((
        "loop",
        curve(Box::new(Spline::closed(&knots).expect("valid"))),
    ));
    for k in 0..all.len() {
        let (name, c) = &all[k];
        let shape = match &c.shape {
            Locus::Surface(..) => continue,
            Locus::Curve(_) => *name,
        };
        if shape == "circle" {
            let circle = Circle::new([0.1, 0.2, -0.3], [1.0, 1.0, 0.3], 0.7).expect("valid");
            all.push((
                "moved circle",
                VertexConstraint::on_curve(id, circle).moving(|_| turned()),
            ));
        }
    }
    let cylinder = Cylinder::new([0.1, 0.2, -0.3], [1.0, 1.0, 0.3], 0.4).expect("valid");
    let moved = VertexConstraint::on_surface(id, cylinder, Side::On).moving(|_| turned());
    all.push(("moved cylinder", moved));
    all
}

#[test]
fn derivatives_are_those_of_the_values() {
    let h = 1e-6;
    let w = v(0.7, -0.4, 1.3);
    for (name, c) in samples() {
        for p in [
            v(0.31, 0.14, 0.12),
            v(0.72, 0.21, 0.33),
            v(0.53, 0.32, 0.27),
        ] {
            let at = c.at(0.0, &p);
            let bent = at.hessian(&w);
            for k in 0..3 {
                let mut d = Vector3::zeros();
                d[k] = h;
                let (up, down) = (c.at(0.0, &(p + d)), c.at(0.0, &(p - d)));
                let slope = (up.value - down.value) / (2.0 * h);
                let error = (slope - at.jacobian.column(k)).norm();
                assert!(error < 1e-8, "{name} at {p:?}: Jacobian {error:e}");
                let turn = (up.jacobian - down.jacobian).tr_mul(&w) / (2.0 * h);
                let error = (turn - bent.column(k)).norm();
                assert!(error < 1e-7, "{name} at {p:?}: Hessian {error:e}");
            }
        }
    }
}

#[test]
fn closest_points_are_closest_and_stationary() {
    for (name, c) in samples() {
        let Locus::Curve(curve) = &c.shape else {
            continue;
        };
        for i in 0..60 {
            let a = f64::from(i);
            let p = v((1.3 * a).sin(), (2.1 * a).cos(), (0.7 * a).sin());
            let at = curve.closest(&p);
            let r = p - at.position;
            let slip = at.first.normalize().dot(&r).abs();
            assert!(slip < 1e-12, "{name} at {p:?}: {slip:e}");
            // A point of the curve is its own closest point.
            let own = curve.closest(&at.position);
            assert!((own.position - at.position).norm() < 1e-13, "{name}");
        }
    }
}

#[test]
fn splines_pass_through_their_points_with_continuous_curvature() {
    let points = [
        [0.0, 0.0, 0.0],
        [0.4, 0.3, 0.1],
        [0.9, -0.1, 0.5],
        [1.2, 0.6, 0.2],
    ];
    for spline in [Spline::open(&points), Spline::closed(&points)] {
        let spline = spline.expect("valid");
        for p in points {
            let p = Vector3::from(p);
            assert!((spline.closest(&p).position - p).norm() < 1e-14);
        }
    }
}

#[test]
fn degenerate_shapes_are_refused() {
    assert!(Plane::new([0.0; 3], [0.0; 3]).is_err());
    assert!(Sphere::new([0.0; 3], -1.0).is_err());
    assert!(Circle::new([f64::NAN, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0).is_err());
    assert!(Spline::open(&[[0.0; 3], [0.0; 3]]).is_err());
    let corner = Polyline::new(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], 2.0);
    assert_eq!(
        corner,
        Err(ConstraintError::Corner {
            point: 1,
            radius: 2.0,
            largest: 1.0 / (std::f64::consts::FRAC_PI_4).tan()
        })
    );
}

/// Rates of moved curves and surfaces, at fixed and at moving points.
#[test]
fn rates_are_differences_in_time() {
    let swing = |phase: f64| Profile::Sine {
        mean: 0.1,
        amplitude: 0.2,
        frequency: 0.4,
        phase,
    };
    let motion = RigidDisplacement {
        pose: turned(),
        x: swing(0.0),
        y: swing(1.0),
        z: swing(2.0),
        rotation: Some(AxisRotation {
            centre: [0.2, -0.1, 0.4],
            axis: [0.5, 1.0, -0.3],
            angle: swing(3.0),
        }),
    };
    // Short, so that no closest point passes a knot of a spline, where the fourth derivative jumps.
    let (h, t) = (2e-4, 0.7);
    let u = v(0.4, -0.8, 0.5);
    for (name, mut c) in samples() {
        let profile = RigidProfile::from(motion.clone());
        let function = RigidMotion::from(move |t: f64| profile.kinematics(t).pose);
        for motion in [RigidMotion::from(motion.clone()), function] {
            c.motion = Some(motion);
            for p in [v(0.31, 0.14, 0.12), v(0.72, 0.21, 0.33)] {
                let at = |s: f64| c.at(t + s * h, &p).value;
                let rate = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
                let error = (rate - c.rate(t, 0.05, &p)).norm();
                assert!(error < 1e-8, "{name} at {p:?}: rate {error:e}");
                let at = |s: f64| c.at(t + s * h, &(p + s * h * u)).value;
                let near = at(1.0) + at(-1.0);
                let far = at(2.0) + at(-2.0);
                let second = (16.0 * near - far - 30.0 * at(0.0)) / (12.0 * h * h);
                let error = (second - c.second_rate(t, 0.05, &p, &u)).norm();
                assert!(error < 1e-5, "{name} at {p:?}: second rate {error:e}");
            }
        }
    }
}

#[test]
fn a_constraint_with_an_unusable_motion_is_refused() {
    let sheet = isosheet_mesh::generate::isotropic_square(0, 1.0).expect("valid");
    let mass = isosheet_mesh::MassKind::Lumped;
    let model = crate::SheetModel::new(&sheet, 1.0, mass).expect("valid");
    let plane = Plane::new([0.0; 3], [0.0, 0.0, 1.0]).expect("valid");
    let plane = VertexConstraint::on_surface(VertexId(2), plane, Side::On);
    let error = model.with_constraint(plane.moving(Vec::new())).err();
    let vertex = VertexId(2);
    let source = MotionError::Empty;
    assert_eq!(error, Some(crate::ModelError::Motion { vertex, source }));
}
