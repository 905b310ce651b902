//! No accepted motion passes anything.

use super::*;
use isosheet_geometry::{Candidates, crossings, crossings_between};
use proptest::prelude::*;

/// Whether the sheet passes through the body or is inside it at progress `s` of the step.
fn passes(step: &Step, x: &[f64], s: f64) -> bool {
    let contacts = &step.contacts;
    let body = &contacts.bodies[0];
    let pose = step.bodies.list()[0].surface.pose(s);
    let shape = body.obstacle().shape();
    let solid = shape.is_solid();
    if solid {
        for p in x.as_chunks::<3>().0 {
            let local = pose.inverse_transform_point(&(*p).into()).coords;
            let distance = shape.signed_distance(&local).value;
            if distance.is_nan() || distance <= 0.0 {
                return true;
            }
        }
    }
    let Some(geometry) = shape.contact_geometry(contacts.options.segments).unwrap() else {
        return false;
    };
    let mut places = geometry.positions.clone();
    for p in places.as_chunks_mut::<3>().0 {
        *p = (pose * nalgebra::Point3::from(*p)).coords.into();
    }
    !crossings_between(&contacts.mesh, x, &geometry.mesh, &places).is_empty()
        || !crossings_between(&geometry.mesh, &places, &contacts.mesh, x).is_empty()
}

proptest! {
    #![proptest_config(isosheet_random::cases(24))]

    /// Bodies of all kinds shot at and turned against a sheet that is thrown about: whatever part of
    /// the joint motion is accepted, nothing is passed at any time of it.
    #[test]
    fn accepted_motions_pass_nothing(
        which in 0..7_usize,
        throws in proptest::collection::vec(proptest::collection::vec(-1.0..1.0_f64, 75), 4),
        turn in proptest::array::uniform3(-1.5..1.5_f64),
        shift in proptest::array::uniform3(-0.4..0.4_f64),
        size in 0.001..0.3_f64,
    ) {
        let sheet = sheet(1);
        let model = model(&sheet);
        let (name, shape) = shapes().swap_remove(which);
        let from = Isometry3::identity();
        let up = Vector3::from(shift) + Vector3::new(0.0, 0.0, 0.6);
        let to = Isometry3::new(up, Vector3::from(turn));
        let mut x = waves(&sheet, top(&shape, &from) + 0.01, 0.05);
        let contacts = Contacts::new(&model, options(&model, 0.005)).unwrap()
            .with_body(moving(shape, from, to, 0.02), Coefficients::FRICTIONLESS).unwrap();
        let mut step = Step::begin(contacts, &model, 0.02, &x);
        let mut cut = 0;
        for throw in &throws {
            let dx: Vec<f64> = throw.iter().map(|d| size * d).collect();
            let s0 = step.s;
            let a = step.query(&x, &dx);
            cut += usize::from(a < 1.0);
            for k in 0..=8 {
                let b = a * f64::from(k) / 8.0;
                let y: Vec<f64> = x.iter().zip(&dx).map(|(x, d)| x + b * d).collect();
                let s = s0 + b * (1.0 - s0);
                prop_assert!(!passes(&step, &y, s), "{} at {} of {}", name, b, a);
            }
            for i in 0..x.len() {
                x[i] += a * dx[i];
            }
            step.advance(a);
            let gap = step.gap(&x);
            prop_assert!(gap > 0.0, "{}: gap {}", name, gap);
            prop_assert!(step.energy(&x).is_finite());
        }
        prop_assert!(cut > 0 || step.s == 1.0);
    }

    /// A sheet thrown at itself.
    #[test]
    fn a_sheet_passes_not_itself(
        throws in proptest::collection::vec(proptest::collection::vec(-1.0..1.0_f64, 75), 4),
        size in 0.01..0.5_f64, thickness in 0.0..0.005_f64,
    ) {
        let sheet = sheet(1);
        let model = model(&sheet);
        let mut x = waves(&sheet, 0.0, 0.05);
        let options = ContactOptions { thickness, ..options(&model, 0.01) };
        let contacts = Contacts::new(&model, options).unwrap()
            .with_self_contact(Coefficients::FRICTIONLESS).unwrap();
        let mut step = Step::begin(contacts, &model, 0.02, &x);
        for throw in &throws {
            let dx: Vec<f64> = throw.iter().map(|d| size * d).collect();
            let a = step.query(&x, &dx);
            for k in 1..=8 {
                let b = a * f64::from(k) / 8.0;
                let y: Vec<f64> = x.iter().zip(&dx).map(|(x, d)| x + b * d).collect();
                prop_assert!(crossings(&step.contacts.mesh, &y).is_empty());
                // The pairs found belong to the whole motion.
                let gap = step.gap(&y);
                prop_assert!(gap > 0.0);
                let all = every_gap(&step.contacts, &y);
                prop_assert!((gap.min(0.01) - all.min(0.01)).abs() < 1e-12, "{} {}", gap, all);
            }
            for i in 0..x.len() {
                x[i] += a * dx[i];
            }
        }
    }
}

/// Smallest gap of the sheet with itself over all pairs.
fn every_gap(contacts: &Contacts, x: &[f64]) -> f64 {
    let mesh = &contacts.mesh;
    let mut all = Candidates::default();
    for v in 0..mesh.vertex_count() as u32 {
        for (f, face) in (0..).zip(mesh.faces()) {
            if !face.contains(&v) {
                all.vertex_face.push([v, f]);
            }
        }
    }
    for (e, edge) in (0..).zip(mesh.edges()) {
        for (g, other) in (0..).zip(mesh.edges()) {
            if e < g && !edge.iter().any(|v| other.contains(v)) {
                all.edge_edge.push([e, g]);
            }
        }
    }
    all.smallest_distance(mesh, x) - contacts.options.thickness
}

/// A die at 10 m/s, a millimetre below a sheet, and steps of a sixtieth of a second.
#[test]
fn a_fast_punch_does_not_tunnel() {
    let sheet = sheet(2);
    let model = model(&sheet);
    for (name, shape) in shapes() {
        let from = Isometry3::identity();
        let gap = 1e-3;
        let x = waves(&sheet, top(&shape, &from) + gap, 1e-5);
        let h = 1.0 / 60.0;
        let to = nalgebra::Translation3::new(0.0, 0.0, 10.0 * h) * from;
        let contacts = Contacts::new(&model, options(&model, 5e-4))
            .unwrap()
            .with_body(moving(shape, from, to, h), Coefficients::FRICTIONLESS)
            .unwrap();
        let mut step = Step::begin(contacts, &model, h, &x);
        let zero = vec![0.0; x.len()];
        let a = step.query(&x, &zero);
        let impact = gap / (10.0 * h);
        // Half the activation distance is left, a quarter of the gap.
        assert!(a < 0.8 * impact && a > 0.7 * impact, "{name}: {a} {impact}");
        step.advance(a);
        assert!(step.gap(&x) > 0.0 && step.gap(&x) < 3e-4, "{name}");
        // Nothing more is possible, and it does not end with a touch.
        for _ in 0..5 {
            let a = step.query(&x, &zero);
            step.advance(a);
            assert!(step.gap(&x) > 0.0, "{name}");
        }
        assert!(step.s < 2.0 * impact);
    }
}

/// A ball and a cylinder that spin about their own axis under a sheet at rest sweep nothing: the
/// whole step is safe, however small the gap against the path of a point.
#[test]
fn spinning_in_place_is_safe() {
    let sheet = sheet(2);
    let model = model(&sheet);
    let lying = nalgebra::UnitQuaternion::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, 0.0);
    for (name, shape, pose) in [
        ("ball", Shape::Sphere { radius: 0.2 }, Isometry3::identity()),
        ("half-space", Shape::HalfSpace, Isometry3::identity()),
        (
            "capsule",
            Shape::Capsule {
                radius: 0.1,
                half_length: 0.6,
            },
            Isometry3::from_parts(nalgebra::Translation3::identity(), lying),
        ),
    ] {
        let x = waves(&sheet, top(&shape, &pose) + 1e-6, 1e-6);
        let axis = if name == "half-space" {
            Vector3::z()
        } else {
            Vector3::x()
        };
        let to = Isometry3::from_parts(
            pose.translation,
            nalgebra::UnitQuaternion::from_scaled_axis(0.8 * axis) * pose.rotation,
        );
        let contacts = Contacts::new(&model, options(&model, 1e-3))
            .unwrap()
            .with_body(moving(shape, pose, to, 0.01), Coefficients::FRICTIONLESS)
            .unwrap();
        let mut step = Step::begin(contacts, &model, 0.01, &x);
        let zero = vec![0.0; x.len()];
        assert_eq!(step.query(&x, &zero), 1.0, "{name}");
    }
}

/// A search after many others finds the same as one by contacts that are new, in the same order: what a
/// simulation that is resumed from a file does does not depend on what was searched for before.
#[test]
fn sets_do_not_depend_on_earlier_searches() {
    let sheet = sheet(2);
    let model = model(&sheet);
    let shape = Shape::Cylinder {
        radius: 0.15,
        half_height: 0.2,
    };
    let to = Isometry3::translation(0.02, 0.01, 0.03);
    let make = || {
        Contacts::new(&model, options(&model, 0.05))
            .unwrap()
            .with_body(
                moving(shape.clone(), Isometry3::identity(), to, 0.02),
                Coefficients::FRICTIONLESS,
            )
            .unwrap()
            .with_body(
                fixed(roof(), Isometry3::translation(0.0, 0.0, -0.3)),
                Coefficients::FRICTIONLESS,
            )
            .unwrap()
            .with_self_contact(Coefficients::FRICTIONLESS)
            .unwrap()
    };
    let bent = waves(&sheet, top(&shape, &Isometry3::identity()) + 0.01, 0.05);
    let dx: Vec<f64> = (0..bent.len())
        .map(|i| 0.05 * (3.0 * i as f64).sin())
        .collect();
    let mut fresh = make();
    let span = StepSpan { t0: 0.0, h: 0.02 };
    let bodies = BodyMotions::over(&fresh, span);
    let searched = |contacts: &mut Contacts| {
        let set = ContactSet::of(contacts, motion(&bodies, [0.25, 1.0], &bent, &dx));
        let active = ActiveContacts::at(contacts, &set, 0.25, &bent);
        (set, active)
    };
    let expected = searched(&mut fresh);
    assert!(expected.0.pairs().is_sorted() && expected.0.pairs().len() > 100);
    assert!(expected.1.list().len() > 10);
    let mut used = make();
    // Its tree has the shape of the flat sheet, and its boxes have been elsewhere.
    let mut x = sheet.positions().to_vec();
    for k in 0..5 {
        ActiveContacts::at_rest(&mut used, 0.005 * f64::from(k), &x);
        x.iter_mut().for_each(|x| *x *= 1.1);
    }
    assert_eq!(searched(&mut used), expected);
    assert_eq!(searched(&mut used), expected);
}

/// A scroll with layers 20 mm apart, of an edge length of 125 mm and more, that shakes: lists of neighbours
/// serve several motions each, and every search finds what new contacts find.
#[test]
fn sets_do_not_depend_on_lists_that_serve_many_motions() {
    let sheet = sheet(2);
    let model = model(&sheet);
    let make = || {
        Contacts::new(&model, options(&model, 0.015))
            .unwrap()
            .with_self_contact(Coefficients::FRICTIONLESS)
            .unwrap()
    };
    let mut x = sheet.positions().to_vec();
    for p in x.as_chunks_mut::<3>().0 {
        let angle = 10.0 * p[0];
        let radius = 0.05 + 0.02 * angle / std::f64::consts::TAU;
        *p = [radius * angle.cos(), p[1], radius * angle.sin()];
    }
    let mut used = make();
    let bodies = BodyMotions::over(&used, StepSpan { t0: 0.0, h: 0.02 });
    let (mut pairs, mut cut) = (0, 0);
    for k in 0..60 {
        let size = if k % 7 == 6 { 9e-3 } else { 1e-3 };
        let shake = |i: usize| size * (1.7 * i as f64 + 0.9 * f64::from(k)).sin();
        let dx: Vec<f64> = (0..x.len()).map(shake).collect();
        let motion = motion(&bodies, [0.0, 1.0], &x, &dx);
        let set = ContactSet::of(&mut used, motion);
        assert_eq!(set, ContactSet::of(&mut make(), motion), "motion {k}");
        pairs += set.pairs().len();
        cut += usize::from(set.safe_fraction() < 1.0);
        let part = 0.5 * set.safe_fraction();
        x.iter_mut().zip(&dx).for_each(|(x, d)| *x += part * d);
    }
    assert!(pairs > 1000 && cut > 5, "{pairs} pairs, {cut} motions cut");
}
