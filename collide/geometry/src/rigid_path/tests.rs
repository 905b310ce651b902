use super::*;
use crate::Shape;
use proptest::prelude::*;

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    /// The path of a point as seen from a body bends no more than is said.
    #[test]
    fn bends_are_bounded(
        pose in proptest::array::uniform6(-1.0..1.0_f64), shift in proptest::array::uniform3(-1.0..1.0_f64),
        turn in proptest::array::uniform3(-1.5..1.5_f64), x in proptest::array::uniform3(-1.0..1.0_f64),
        dx in proptest::array::uniform3(-1.0..1.0_f64), s in 0.0..0.9_f64,
    ) {
        let v = |a: [f64; 3]| Vector3::from(a);
        let start = Isometry3::new(Vector3::new(pose[0], pose[1], pose[2]), Vector3::new(pose[3], pose[4], pose[5]));
        let end = Isometry3::from_parts(
            (start.translation.vector + v(shift)).into(),
            UnitQuaternion::from_scaled_axis(v(turn)) * start.rotation,
        );
        let whole = RigidPath::new(&start, v(shift), v(turn));
        let rest = RigidPath::new(&whole.pose_at(s), (1.0 - s) * v(shift), (1.0 - s) * v(turn));
        prop_assert!((rest.pose_at(1.0).to_matrix() - end.to_matrix()).norm() < 1e-12);
        let course = rest.course(&v(x), &v(dx));
        let at = |t: f64| {
            let p = nalgebra::Point3::from(v(x) + t * v(dx));
            whole.pose_at(s + t * (1.0 - s)).inverse_transform_point(&p).coords
        };
        prop_assert!((rest.now(&course) - at(0.0)).norm() < 1e-14);
        let velocity = (at(1e-6) - at(-1e-6)) / 2e-6;
        for k in 1..=10 {
            let t = f64::from(k) / 10.0;
            let error = (at(t) - at(0.0) - t * velocity).norm();
            prop_assert!(error <= 0.5 * course.bend * t * t + 1e-8, "{} of {}", error, course.bend);
            prop_assert!((at(t) - at(0.0)).norm() <= course.reach(&rest) + 1e-12);
        }
    }
}

/// Above the middle of a slab that turns, a point at rest moves along the slab at first and meets it
/// nevertheless: only the bend of its path says so.
#[test]
fn a_point_above_a_turning_slab_is_met() {
    let slab = Shape::Cuboid {
        half: [1.0, 1.0, 0.1],
    };
    let turning = RigidPath::new(&Isometry3::identity(), Vector3::zeros(), 0.5 * Vector3::y());
    let course = turning.course(&Vector3::new(0.0, 0.0, 0.101), &Vector3::zeros());
    let t = turning.advance(&CcdOptions::default(), &[course], 1.0, |[p]| {
        let d = slab.signed_distance(p);
        (d.normal, d.normal.dot(p) - d.value)
    });
    let met = |gap: f64| ((0.1 + gap) / 0.101_f64).acos() / 0.5;
    assert!(t < met(0.0) && t > met(2e-4), "{t} {}", met(0.0));
}
