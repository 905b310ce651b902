use super::*;
use crate::{Coefficients, ContactOptions, Contacts, Keyframe};
use isosheet_dynamics::{
    AxisRotation, Method, Profile, RigidDisplacement, SheetModel, Simulation, State,
};
use isosheet_mesh::{MassKind, generate};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Rate at which the distance of a resting point `p` changes because the body moves, metres per second: minus
/// the body's velocity along the normal at the closest point.
fn distance_rate(body: &Obstacle, t: f64, p: &Vector3<f64>) -> f64 {
    let d = body.signed_distance(t, p);
    -d.normal.dot(&body.velocity(t, &d.closest(p)))
}

fn moving(shape: Shape, pose: &[f64; 6], end: &[f64; 6]) -> Obstacle {
    let key = |t, p: &[f64; 6]| Keyframe {
        t,
        pose: Isometry3::new(
            Vector3::new(p[0], p[1], p[2]),
            Vector3::new(p[3], p[4], p[5]),
        ),
    };
    Obstacle::new(shape, vec![key(0.0, pose), key(1.0, end)]).unwrap()
}

fn pose() -> impl Strategy<Value = [f64; 6]> {
    proptest::array::uniform6(-1.0..1.0_f64)
}

/// Sizes from a micrometre to a kilometre.
fn sizes() -> impl Strategy<Value = f64> {
    (-6.0..3.0_f64).prop_map(|p| 10.0_f64.powf(p))
}

proptest! {
    #![proptest_config(isosheet_random::cases(1000))]

    #[test]
    fn derivatives_match_differences(is_round: bool, lengths in proptest::array::uniform3(0.2..1.0_f64), size in sizes(), p in proptest::array::uniform3(-1.0..1.0_f64), a in pose(), t in 0.0..1.0_f64) {
        let mut place = a;
        place[..3].iter_mut().for_each(|c| *c *= size);
        let half = lengths.map(|length| size * length);
        let shape = match is_round {
            true => Shape::Capsule { radius: half[0], half_length: half[1] },
            false => Shape::Cuboid { half },
        };
        let body = moving(shape, &place, &[0.0; 6]);
        let centre = body.motion().pose(t).translation.vector;
        let p = centre + 2.0 * size * Vector3::from(p);
        let at = body.signed_distance(t, &p);
        // The gradient jumps on the medial axis, the Hessian where the nearest feature changes.
        let steady = (0..6).all(|k| {
            let mut q = p;
            q[k / 2] += if k % 2 == 0 { 1e-3 } else { -1e-3 } * size;
            let d = body.signed_distance(t, &q);
            (d.hessian - at.hessian).norm() * size < 0.1 && (d.normal - at.normal).norm() < 0.1
        });
        if steady {
            let h = 1e-6 * size;
            for k in 0..3 {
                let shifted = |d: f64| body.signed_distance(t, &(p + d * Vector3::ith(k, 1.0)));
                let (up, down) = (shifted(h), shifted(-h));
                let slope = (up.value - down.value) / (2.0 * h);
                prop_assert!((slope - at.normal[k]).abs() < 1e-6);
                let turn = (up.normal - down.normal) / (2.0 * h);
                prop_assert!((turn - at.hessian.column(k)).norm() * size < 1e-5);
            }
            let h = 1e-5;
            let at = |t: f64| body.signed_distance(t, &p).value;
            let t = t.clamp(2.0 * h, 1.0 - 2.0 * h);
            let rate = (at(t + h) - at(t - h)) / (2.0 * h);
            prop_assert!((rate - distance_rate(&body, t, &p)).abs() < 1e-6 * size);
        }
        prop_assert!((at.normal.norm() - 1.0).abs() < 1e-12);
        // The closest point is on the surface.
        prop_assert!(body.signed_distance(t, &at.closest(&p)).value.abs() < 1e-12 * size);
    }

    #[test]
    fn placed_vertices_move_with_the_body(a in pose(), b in pose(), t in 0.0..1.0_f64) {
        let shape = Shape::Cuboid { half: [0.3, 0.4, 0.5] };
        let body = moving(shape, &a, &b);
        let g = body.shape().contact_geometry(3).unwrap().unwrap();
        let mut placed = g.positions.clone();
        body.place(t, &g.positions, &mut placed);
        for q in placed.as_chunks::<3>().0 {
            prop_assert!(body.signed_distance(t, &Vector3::from(*q)).value.abs() < 1e-14);
        }
    }
}

#[test]
fn what_is_wrong_with_shape_or_motion_is_named() {
    let sphere = Obstacle::at(Shape::Sphere { radius: -1.0 }, [0.0; 3]);
    assert!(matches!(
        sphere,
        Err(ObstacleError::Shape(ShapeError::Length {
            name: "radius",
            ..
        }))
    ));
    let mut pose = Isometry3::identity();
    pose.translation.vector.x = f64::NAN;
    assert!(matches!(
        Obstacle::fixed(Shape::HalfSpace, pose),
        Err(ObstacleError::Motion(MotionError::NotFinite { .. }))
    ));
}

/// A table that sinks and turns about its own centre.
fn sinking() -> RigidDisplacement {
    let ramp = |to: f64| Profile::Ramp {
        from: 0.0,
        to,
        begin: 0.0,
        end: 0.4,
    };
    let pose = Isometry3::translation(0.1, 0.1, -0.0505);
    RigidDisplacement {
        pose,
        z: ramp(-0.03),
        rotation: Some(AxisRotation {
            centre: pose.translation.vector.into(),
            axis: [0.2, 1.0, 0.4],
            angle: ramp(0.5),
        }),
        ..RigidDisplacement::default()
    }
}

#[test]
fn distance_rates_of_profiles_and_functions_match_differences() {
    let shape = Shape::Sphere { radius: 0.3 };
    let swing = RigidDisplacement {
        x: Profile::Sine {
            mean: 0.1,
            amplitude: 0.2,
            frequency: 0.7,
            phase: 0.3,
        },
        ..sinking()
    };
    let profile = RigidProfile::from(swing.clone());
    let function = move |t: f64| profile.kinematics(t).pose;
    let (p, t, h) = (Vector3::new(0.6, 0.2, 0.3), 0.21, 1e-4);
    for body in [
        Obstacle::new(shape.clone(), swing).unwrap(),
        Obstacle::new(shape, function).unwrap(),
    ] {
        let at = |s: f64| body.signed_distance(t + s * h, &p).value;
        let rate = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
        let found = distance_rate(&body, t, &p);
        assert!((rate - found).abs() < 1e-9, "{rate} {found}");
    }
}

/// A sheet on a table, with friction, after 0.1 s.
fn carried(motion: impl Into<RigidMotion>) -> Vec<f64> {
    let sheet = generate::isotropic_square(1, 0.2).unwrap();
    let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)
        .unwrap()
        .with_gravity();
    let half = [0.06, 0.06, 0.05];
    let table = Obstacle::new(Shape::Cuboid { half }, motion).unwrap();
    let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
        .and_then(|c| c.with_body(table, Coefficients::equal(0.5)))
        .unwrap();
    let start = State::at_rest(sheet.positions().to_vec());
    let method = Method::ImplicitEuler(Default::default());
    let mut run = Simulation::new(model, start, method).unwrap();
    run = run.with_contact(contacts).unwrap();
    for _ in 0..10 {
        assert!(run.step(0.01).unwrap().gap.unwrap() > 0.0);
    }
    run.state().x.clone()
}

#[test]
fn bodies_by_profiles_carry_the_sheet_as_bodies_by_keyframes_and_functions() {
    let exact = carried(sinking());
    let profile = RigidProfile::from(sinking());
    let keys = [0.0, 0.4].map(|t| Keyframe {
        t,
        pose: profile.kinematics(t).pose,
    });
    let others = [
        carried(keys.to_vec()),
        carried(move |t: f64| profile.kinematics(t).pose),
    ];
    let sunk = exact
        .iter()
        .skip(2)
        .step_by(3)
        .fold(0.0, |m: f64, z| m.min(*z));
    assert!(sunk < -1e-3, "sunk by {sunk} m");
    for other in others {
        let differences = exact.iter().zip(&other).map(|(a, b)| (a - b).abs());
        let error = differences.fold(0.0, f64::max);
        assert!(error < 1e-9, "off by {error:e} m");
    }
}

#[test]
fn an_obstacle_is_where_arrays_say() {
    let ball = Shape::Sphere { radius: 0.5 };
    let (place, quarter) = ([0.1, -0.2, 0.3], [0.0, 0.0, 0.25 * TAU]);
    let space = |body: &Obstacle| {
        let mut out = [0.0; 3];
        body.place(2.0, &[1.0, 0.0, 0.0], &mut out);
        Vector3::from(out)
    };
    let at = Obstacle::at(ball.clone(), place).unwrap();
    assert!((space(&at) - Vector3::new(1.1, -0.2, 0.3)).norm() < 1e-15);
    let turned = RigidDisplacement::turned(place, quarter);
    let turned = Obstacle::new(ball.clone(), turned).unwrap();
    assert!((space(&turned) - Vector3::new(0.1, 0.8, 0.3)).norm() < 1e-15);
    let nowhere = Obstacle::at(ball, [0.0, f64::NAN, 0.0]);
    assert!(matches!(nowhere, Err(ObstacleError::Motion(_))));
}
