//! Starts that are refused and options that make no sense.

use super::*;
use isosheet_dynamics::contact::{BarrierError, ContactPair};

fn table(model: &SheetModel, gap: f64) -> Contacts {
    let shape = Shape::Cuboid {
        half: [0.25, 0.25, 0.1],
    };
    let pose = Isometry3::translation(0.5, 0.5, -0.1 - gap);
    Contacts::new(model, ContactOptions::for_sheet(model))
        .unwrap()
        .with_body(fixed(shape, pose), Coefficients::equal(0.3))
        .unwrap()
}

#[test]
fn touching_starts_are_refused_by_name() {
    let sheet = sheet(1);
    let model = model(&sheet);
    let flat = State::at_rest(sheet.positions().to_vec());
    for gap in [1e-3, 1e-5] {
        assert_eq!(table(&model, gap).check_start(&model, &flat), Ok(()));
    }
    for depth in [0.0, 0.01, 0.05] {
        let error = table(&model, -depth)
            .check_start(&model, &flat)
            .unwrap_err();
        let ContactError::Touching { pair, gap, t } = error else {
            panic!("{error}")
        };
        assert!(matches!(pair, ContactPair::Body { body: 0, .. }));
        assert!((gap + depth).abs() < 1e-15, "{gap}");
        assert_eq!(t, 0.0);
    }
    let mut broken = flat.clone();
    broken.x[4] = f64::NAN;
    let mut contacts = table(&model, 1e-3);
    let active = ActiveContacts::at_rest(&mut contacts, 0.0, &broken.x);
    assert!(active.gap().is_nan());
    let barrier = BarrierPotential::new(contacts.options.activation, 1.0).unwrap();
    assert_eq!(active.barrier_energy(&barrier), f64::INFINITY);
    let mut step = Step::begin(contacts, &model, 0.0, &flat.x);
    let dx = vec![0.0; flat.x.len()];
    assert_eq!(step.query(&broken.x, &dx), 0.0);
    assert_eq!(step.query(&flat.x, &broken.x), 0.0);
    let mut contacts = step.contacts;
    let other = super::sheet(2);
    assert_eq!(
        contacts.check_start(&super::model(&other), &flat),
        Err(ContactError::Sheet {
            expected: 25,
            found: 81
        })
    );
}

/// Faces far larger than the body, with no vertex near it.
#[test]
fn starts_that_pass_through_are_refused() {
    let sheet = sheet(0);
    let model = model(&sheet);
    let x = waves(&sheet, 0.0, 0.02);
    for (name, shape) in shapes() {
        let pose = Isometry3::translation(0.08, 0.13, 0.011);
        let mut contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
            .unwrap()
            .with_body(fixed(shape, pose), Coefficients::FRICTIONLESS)
            .unwrap();
        let error = contacts
            .check_start(&model, &State::at_rest(x.clone()))
            .unwrap_err();
        assert!(
            matches!(error, ContactError::Touching { pair: ContactPair::Body { body: 0, .. }, gap, .. } if gap <= 0.0),
            "{name}: {error}"
        );
    }
    // A corner of the sheet pushed through the sheet.
    let sheet = super::sheet(1);
    let model = super::model(&sheet);
    let mut x = sheet.positions().to_vec();
    let through = |x: &[f64]| {
        let mut contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
            .unwrap()
            .with_self_contact(Coefficients::FRICTIONLESS)
            .unwrap();
        contacts.check_start(&model, &State::at_rest(x.to_vec()))
    };
    assert_eq!(through(&x), Ok(()));
    let corner = x
        .as_chunks::<3>()
        .0
        .iter()
        .position(|p| p[0] == 0.0 && p[1] == 0.0)
        .unwrap();
    x[3 * corner..3 * corner + 3].copy_from_slice(&[0.55, 0.63, 0.1]);
    assert_eq!(through(&x), Ok(()));
    x[3 * corner + 2] = -0.1;
    assert_eq!(through(&x), Ok(()), "on one side of the flat sheet");
    // From below the sheet at its neighbours to above it.
    for p in x.as_chunks_mut::<3>().0 {
        if p[0] + p[1] < 0.6 && p[2] == 0.0 {
            p[2] = -0.05;
        }
    }
    x[3 * corner..3 * corner + 3].copy_from_slice(&[0.83, 0.87, 0.01]);
    assert!(matches!(
        through(&x),
        Err(ContactError::Touching {
            pair: ContactPair::Sheet { .. },
            ..
        })
    ));
}

/// The closest points of the sheet and the body coincide, so that there is no direction between them.
#[test]
fn starts_without_any_distance_are_refused() {
    let sheet = sheet(1);
    let model = model(&sheet);
    let flat = State::at_rest(sheet.positions().to_vec());
    let patch = [0.4, 0.4, 0.0, 0.63, 0.41, 0.0, 0.52, 0.64, 0.0];
    let patch = TriangleSurface::new(&patch, &[[0, 1, 2]]).unwrap();
    // A ball whose centre lies in a face far from its edges, and an open surface that lies in the sheet.
    for (shape, expected) in [
        (Shape::Sphere { radius: 1e-3 }, -1e-3),
        (Shape::Surface(Arc::new(patch)), 0.0),
    ] {
        let place = match shape {
            Shape::Sphere { .. } => Isometry3::translation(0.45, 0.57, 0.0),
            _ => Isometry3::identity(),
        };
        let mut contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))
            .unwrap()
            .with_body(fixed(shape, place), Coefficients::FRICTIONLESS)
            .unwrap();
        let error = contacts.check_start(&model, &flat).unwrap_err();
        assert!(
            matches!(error, ContactError::Touching { gap, .. } if gap == expected),
            "{error}"
        );
    }
}

#[test]
fn options_that_make_no_sense_are_named() {
    let sheet = sheet(1);
    let model = model(&sheet);
    let good = ContactOptions::for_sheet(&model);
    good.validate().unwrap();
    assert_eq!(
        good.activation,
        0.01 * model.mean_length(),
        "one percent of the mean rod length"
    );
    let make = |o: ContactOptions| Contacts::new(&model, o).map(|_| ());
    let o = ContactOptions {
        activation: 0.0,
        ..good
    };
    assert!(matches!(make(o), Err(ContactsError::Barrier(_))));
    let o = ContactOptions {
        thickness: -1.0,
        ..good
    };
    assert_eq!(make(o), Err(ContactsError::Thickness(-1.0)));
    let o = ContactOptions {
        thickness: 1e20,
        ..good
    };
    assert!(matches!(make(o), Err(ContactsError::Resolution { .. })));
    let o = ContactOptions {
        stiffness: Stiffness::Joules(0.0),
        ..good
    };
    let refused = BarrierError::Stiffness(0.0);
    assert_eq!(make(o), Err(ContactsError::Barrier(refused)));
    let o = ContactOptions {
        rest_speed: f64::NAN,
        ..good
    };
    assert!(matches!(make(o), Err(ContactsError::RestSpeed(_))));
    let o = ContactOptions {
        remainder: 1.0,
        ..good
    };
    assert!(matches!(make(o), Err(ContactsError::Ccd(_))));
    let contacts = || Contacts::new(&model, good).unwrap();
    let bad = Coefficients {
        rest: 0.1,
        sliding: 0.2,
    };
    assert!(matches!(
        contacts().with_self_contact(bad),
        Err(ContactsError::Friction(_))
    ));
    let floor = || fixed(Shape::HalfSpace, Isometry3::identity());
    assert!(matches!(
        contacts().with_body(floor(), bad),
        Err(ContactsError::Friction(_))
    ));
    let thick = ContactOptions {
        thickness: 0.3,
        ..good
    };
    let contacts = Contacts::new(&model, thick).unwrap();
    assert!(matches!(
        contacts.with_self_contact(Coefficients::FRICTIONLESS),
        Err(ContactsError::Reach { height, .. }) if height > 0.0 && height < 0.3
    ));
    let round = Shape::Cylinder {
        radius: 1.0,
        half_height: 1.0,
    };
    let flat = ContactOptions {
        segments: 2,
        ..good
    };
    let contacts = Contacts::new(&model, flat).unwrap();
    assert!(matches!(
        contacts.with_body(
            fixed(round, Isometry3::identity()),
            Coefficients::FRICTIONLESS
        ),
        Err(ContactsError::Obstacle(_))
    ));
}

/// The automatic stiffness: one contact carries a hundred vertices at half the activation distance, whatever
/// the gravity, and without any.
#[test]
fn automatic_stiffness_carries_a_hundred_vertices() {
    let sheet = sheet(2);
    let plain = || SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
    for (model, acceleration) in [
        (plain().with_gravity(), 9.8),
        (plain().with_acceleration([0.0, 3.0, -4.0]), 5.0),
        (plain(), 9.8),
    ] {
        let options = ContactOptions::for_sheet(&model);
        let contacts = Contacts::new(&model, options)
            .unwrap()
            .with_body(
                fixed(Shape::HalfSpace, Isometry3::identity()),
                Coefficients::FRICTIONLESS,
            )
            .unwrap();
        let mut x = sheet.positions().to_vec();
        x.iter_mut().skip(2).step_by(3).for_each(|z| *z = 1.0);
        x[2] = 0.5 * options.activation;
        let step = Step::begin(contacts, &model, 0.0, &x);
        let weight = 100.0 * 0.1 / 81.0 * acceleration;
        let load = step.terms(&x, |t| t.loads())[0];
        assert!((load.force.z + weight).abs() < 1e-11);
        assert!((step.gap(&x) - x[2]).abs() < 1e-18);
    }
}
