//! Kinematics against differences, motions by profiles against the same motions by functions, and refusals.

use super::*;
use nalgebra::{Isometry3, Point3};
use proptest::prelude::*;

fn vector() -> impl Strategy<Value = [f64; 3]> {
    proptest::array::uniform3(-1.0..1.0_f64)
}

fn pose() -> impl Strategy<Value = Isometry3<f64>> {
    (vector(), vector()).prop_map(|(p, turn)| Isometry3::new(p.into(), turn.into()))
}

/// A profile without kinks.
fn smooth() -> impl Strategy<Value = Profile> {
    (-1.0..1.0_f64, -1.0..1.0_f64, -0.5..0.5_f64, -3.0..3.0_f64).prop_map(
        |(mean, amplitude, frequency, phase)| Profile::Sine {
            mean,
            amplitude,
            frequency,
            phase,
        },
    )
}

fn displacements(
    profile: impl Strategy<Value = Profile> + Clone,
) -> impl Strategy<Value = RigidDisplacement> {
    let axes = (profile.clone(), profile.clone(), profile.clone());
    let rotation = (vector(), vector(), profile).prop_map(|(centre, axis, angle)| AxisRotation {
        centre,
        axis,
        angle,
    });
    (pose(), axes, proptest::option::of(rotation)).prop_map(|(pose, (x, y, z), rotation)| {
        RigidDisplacement {
            pose,
            x,
            y,
            z,
            rotation,
        }
    })
}

fn key(t: f64, translation: [f64; 3], turn: [f64; 3]) -> Keyframe {
    let pose = Isometry3::new(Vector3::from(translation), Vector3::from(turn));
    Keyframe { t, pose }
}

/// First and second derivative by five-point differences.
fn differences(at: impl Fn(f64) -> Vector3<f64>, t: f64) -> [Vector3<f64>; 2] {
    let h = 1e-3;
    let [a, b, c, d, e] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| at(t + k * h));
    [
        (a - 8.0 * b + 8.0 * d - e) / (12.0 * h),
        (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / (12.0 * h * h),
    ]
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    #[test]
    fn rigid_kinematics_match_differences(
        motion in displacements(smooth().boxed()), p in vector(), t in -1.0..1.0_f64
    ) {
        let exact = RigidMotion::from(motion.clone());
        let profile = RigidProfile::from(motion);
        let custom = RigidMotion::from(move |t: f64| profile.kinematics(t).pose);
        let body = Point3::from(p);
        let at = |t: f64| (exact.pose(t) * body).coords;
        let [velocity, acceleration] = differences(at, t);
        for (motion, tolerance) in [(&exact, 1e-7), (&custom, 1e-6)] {
            let now = motion.kinematics(t, 0.03);
            prop_assert!((now.pose.inverse() * exact.pose(t)).translation.vector.norm() < 1e-14);
            let error = (now.velocity_at(&at(t)) - velocity).norm();
            prop_assert!(error < tolerance, "velocity off by {error:e}");
            let error = (now.acceleration_at(&at(t)) - acceleration).norm();
            prop_assert!(error < 100.0 * tolerance, "acceleration off by {error:e}");
        }
    }

    #[test]
    fn velocity_between_keyframes_is_the_rate_of_the_pose(
        a in vector(), b in vector(), c in vector(), d in vector(), p in vector(), s in 0.01..0.99_f64
    ) {
        let keys = vec![key(1.0, a, c), key(3.0, b, d)];
        let motion = RigidMotion::from(keys.clone());
        prop_assert_eq!(motion.validate(), Ok(()));
        let t = 1.0 + 2.0 * s;
        let at = |t: f64| (motion.pose(t) * Point3::from(p)).coords;
        let [velocity, acceleration] = differences(at, t);
        let now = motion.kinematics(t, 1.0);
        prop_assert!((velocity - now.velocity_at(&at(t))).norm() < 1e-10);
        prop_assert!((acceleration - now.acceleration_at(&at(t))).norm() < 1e-7);
        for (k, t) in [(0, 1.0), (1, 3.0), (0, -5.0), (1, 9.0)] {
            let error = (at(t) - (keys[k].pose * Point3::from(p)).coords).norm();
            prop_assert!(error < 1e-14);
        }
        prop_assert_eq!(motion.kinematics(9.0, 1.0).velocity_at(&at(9.0)), Vector3::zeros());
    }

    #[test]
    fn point_motions_match_differences(
        offset in vector(), x in smooth(), y in smooth(), z in smooth(), t in -1.0..1.0_f64
    ) {
        let profile = PointProfile { offset, x, y, z };
        let exact = PointMotion::from(profile.clone());
        let custom = PointMotion::from(move |t: f64| profile.position(t));
        let [velocity, acceleration] = differences(|t| exact.position(t).into(), t);
        for motion in [exact, custom] {
            prop_assert!((motion.velocity(t, 0.03) - velocity).norm() < 1e-7);
            prop_assert!((motion.acceleration(t, 0.03) - acceleration).norm() < 1e-5);
        }
    }
}

#[test]
fn a_quarter_turn_is_halved() {
    let turn = [0.0, 0.0, std::f64::consts::FRAC_PI_2];
    let motion = RigidMotion::from(vec![
        key(0.0, [0.0; 3], [0.0; 3]),
        key(2.0, [4.0, 0.0, 0.0], turn),
    ]);
    let p = (motion.pose(1.0) * Point3::new(1.0, 0.0, 0.0)).coords;
    let r = 0.5_f64.sqrt();
    assert!((p - Vector3::new(2.0 + r, r, 0.0)).norm() < 1e-15);
    assert!(!motion.is_fixed());
    assert!(RigidProfile::fixed(motion.pose(1.0)).is_fixed());
}

/// A wheel of radius `r` that turns by `w t` and moves on by `r w t` does not slip where it touches the
/// ground.
#[test]
fn a_rolling_wheel_rests_where_it_touches_the_ground() {
    let (r, angle) = (0.3, 5.0);
    let ramp = |to: f64| Profile::Ramp {
        from: 0.0,
        to,
        begin: 0.0,
        end: 2.0,
    };
    let wheel = RigidDisplacement {
        pose: Isometry3::translation(0.0, 0.0, r),
        x: ramp(r * angle),
        rotation: Some(AxisRotation {
            centre: [0.0, 0.0, r],
            axis: [0.0, 2.0, 0.0],
            angle: ramp(angle),
        }),
        ..RigidDisplacement::default()
    };
    let t = 1.3;
    let now = RigidMotion::from(wheel).kinematics(t, 1.0);
    let x = r * angle * t / 2.0;
    let centre = Vector3::new(x, 0.0, r);
    assert!((now.pose.translation.vector - centre).norm() < 1e-15);
    let ground = now.velocity_at(&Vector3::new(x, 0.0, 0.0));
    assert!(ground.norm() < 1e-15, "{ground}");
    let top = now.velocity_at(&Vector3::new(x, 0.0, 2.0 * r));
    assert!((top - Vector3::new(r * angle, 0.0, 0.0)).norm() < 1e-14);
}

#[test]
fn unusable_motions_are_named() {
    let zero = [0.0; 3];
    let refused = |keys: Vec<Keyframe>| RigidMotion::from(keys).validate().unwrap_err();
    assert_eq!(refused(Vec::new()), MotionError::Empty);
    let (index, t) = (1, 0.0);
    let previous = 0.0;
    assert_eq!(
        refused(vec![key(t, zero, zero), key(t, zero, zero)]),
        MotionError::Order { index, t, previous }
    );
    assert_eq!(
        refused(vec![key(t, [f64::NAN, 0.0, 0.0], zero)]),
        MotionError::Keyframe { index: 0, t }
    );
    let half = [0.0, std::f64::consts::PI, 0.0];
    assert_eq!(
        refused(vec![key(0.0, zero, zero), key(1.0, zero, half)]),
        MotionError::HalfTurn { index, t: 1.0 }
    );
    let rotation = |axis: [f64; 3], centre: [f64; 3], angle: f64| {
        let angle = angle.into();
        let motion = RigidDisplacement {
            rotation: Some(AxisRotation {
                centre,
                axis,
                angle,
            }),
            ..RigidDisplacement::default()
        };
        RigidMotion::from(motion).validate()
    };
    let up = [0.0, 0.0, 1.0];
    assert_eq!(rotation(up, zero, 1.0), Ok(()));
    assert_eq!(rotation(zero, zero, 1.0), Err(MotionError::NoAxis));
    for wrong in [
        rotation([f64::NAN; 3], zero, 1.0),
        rotation(up, [f64::INFINITY; 3], 1.0),
        rotation(up, zero, f64::NAN),
    ] {
        assert!(wrong.is_err());
    }
    let fixed = RigidProfile::fixed(Isometry3::translation(0.0, f64::NAN, 0.0));
    assert!(matches!(
        fixed.validate(),
        Err(MotionError::NotFinite { .. })
    ));
}
