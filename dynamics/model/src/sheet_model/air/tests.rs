//! The law of drag against its definition and against finite differences.

use super::*;
use crate::SheetModel;
use isosheet_mesh::{MassKind, Sheet, generate};
use isosheet_motion::Interpolation;

const FACTORS: [f64; 2] = [0.7, 0.3];

fn face_drag() -> FaceDrag {
    let normal = Vector3::new(0.48, -0.6, 0.64);
    FaceDrag {
        normal,
        factors: FACTORS,
    }
}

fn velocities() -> [Vector3<f64>; 3] {
    [
        Vector3::new(0.3, 1.1, -0.4),
        Vector3::new(-2.0, 0.1, 0.7),
        // Along the face.
        Vector3::new(0.8, 0.64, 0.0),
    ]
}

#[test]
fn the_force_is_the_gradient_of_the_potential() {
    let (drag, d) = (face_drag(), 1e-5);
    for u in velocities() {
        let force = drag.force(&u);
        for k in 0..3 {
            let step = d * Vector3::ith(k, 1.0);
            let slope = (drag.potential(&(u + step)) - drag.potential(&(u - step))) / (2.0 * d);
            assert!((slope - force[k]).abs() < 1e-9, "{slope}: {force}");
        }
    }
}

#[test]
fn the_derivative_is_that_of_the_force_and_semidefinite() {
    let (drag, d) = (face_drag(), 1e-5);
    for u in velocities() {
        let derivative = drag.derivative(&u);
        for k in 0..3 {
            let step = d * Vector3::ith(k, 1.0);
            let slope = (drag.force(&(u + step)) - drag.force(&(u - step))) / (2.0 * d);
            let error = (slope - derivative.column(k)).norm();
            // Along the face the second derivative jumps.
            let bound = if u[2] == 0.0 { d } else { 1e-9 };
            assert!(error < bound, "{slope}: {derivative}");
        }
        assert_eq!(derivative, derivative.transpose());
        let least = derivative.symmetric_eigenvalues().min();
        assert!(least > -1e-15, "eigenvalue {least}");
    }
    assert_eq!(drag.derivative(&Vector3::zeros()), Matrix3::zeros());
}

/// A model of a sheet of 0.1 kg in the air.
fn in_air(sheet: &Sheet, air: Air) -> SheetModel {
    let model = SheetModel::new(sheet, 0.1, MassKind::Lumped).expect("valid");
    model.with_air(air).expect("valid")
}

fn force_on(sheet: &Sheet, air: Air, v: [f64; 3]) -> Vector3<f64> {
    let x = sheet.positions();
    let v = v.repeat(x.len() / 3);
    let mut force = vec![0.0; x.len()];
    in_air(sheet, air).add_applied_force(0.0, x, &v, &mut force);
    let vertices = force.as_chunks::<3>().0.iter();
    vertices.map(|f| Vector3::from(*f)).sum()
}

/// A flat sheet feels the drag of a plate of its area: `rho A / 2 (c_n u_n^2, c_t u_t^2)`, along the wind.
#[test]
fn a_flat_sheet_feels_the_drag_of_a_plate() {
    let sheet = generate::delaunay_square(0.5, 0.1, 3).expect("valid");
    let air = |wind: [f64; 3]| Air {
        density: 1.3,
        normal: 1.1,
        tangential: 0.05,
        wind: wind.into(),
    };
    let plate = 0.5 * 1.3 * 0.25;
    for (wind, v, want) in [
        ([0.0, 0.0, 3.0], [0.0; 3], [0.0, 0.0, plate * 1.1 * 9.0]),
        ([0.0, 0.0, -3.0], [0.0; 3], [0.0, 0.0, -plate * 1.1 * 9.0]),
        ([3.0, 4.0, 0.0], [0.0; 3], [plate * 0.75, plate, 0.0]),
        (
            [0.0, 2.0, 1.0],
            [0.0, 2.0, -2.0],
            [0.0, 0.0, plate * 1.1 * 9.0],
        ),
        // Nothing moves relative to the air.
        ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0; 3]),
    ] {
        let force = force_on(&sheet, air(wind), v);
        let error = (force - Vector3::from(want)).norm();
        assert!(error < 1e-14, "{force}: {want:?}");
    }
}

/// Which side of a face is its front means nothing.
#[test]
fn both_sides_are_alike() {
    let sheet = generate::delaunay_square(0.5, 0.1, 3).expect("valid");
    let turned: Vec<_> = sheet
        .face_indices()
        .iter()
        .map(|&[a, b, c]| [a, c, b])
        .collect();
    let turned = Sheet::new(sheet.positions().to_vec(), &turned).expect("valid");
    let air = || Air {
        wind: [1.0, -2.0, 0.5].into(),
        ..Air::default()
    };
    let [front, back] = [&sheet, &turned].map(|sheet| force_on(sheet, air(), [0.0; 3]));
    assert!((front - back).norm() < 1e-15, "{front} {back}");
    assert!(front[2] > 0.0, "{front}");
}

/// A wind that is a function is asked at the centroids, at the time of the force.
#[test]
fn a_function_of_point_and_time_is_wind() {
    let x = vec![0.0, 0.0, 1.0, 0.3, 0.0, 1.0, 0.0, 0.6, 1.0];
    let sheet = Sheet::new(x.clone(), &[[0, 1, 2]]).expect("valid");
    let wind = |[x, y, z]: [f64; 3], t: f64| [0.0, 0.0, t * (x + y) * z];
    let air = Air {
        wind: wind.into(),
        ..Air::default()
    };
    let mut force = vec![0.0; 9];
    in_air(&sheet, air).add_applied_force(2.0, &x, &[0.0; 9], &mut force);
    let speed: f64 = 2.0 * (0.1 + 0.2);
    let want = 0.5 * 1.2 * 0.09 * 1.2 * speed * speed / 3.0;
    for f in force.as_chunks::<3>().0 {
        assert!((f[2] - want).abs() < 1e-15, "{f:?}: {want}");
    }
}

#[test]
fn what_cannot_be_used_is_named() {
    let refused = |air: Air| air.validate().expect_err("refused");
    let still = Air::default;
    assert_eq!(still().validate(), Ok(()));
    for (name, air) in [
        (
            "density",
            Air {
                density: -1.0,
                ..still()
            },
        ),
        (
            "normal",
            Air {
                normal: f64::INFINITY,
                ..still()
            },
        ),
        (
            "tangential",
            Air {
                tangential: f64::NAN,
                ..still()
            },
        ),
    ] {
        let error = refused(air);
        assert!(
            matches!(error, AirError::Number { name: found, .. } if found == name),
            "{error:?}"
        );
        assert!(error.advice().is_some());
    }
    let keys = Vec::new();
    let interpolation = Interpolation::Linear;
    let empty = Profile::Keyframes {
        interpolation,
        keys,
    };
    let wind = [0.0.into(), 0.0.into(), empty];
    let error = refused(Air {
        wind: wind.into(),
        ..still()
    });
    assert!(
        matches!(error, AirError::Wind { axis: 'z', .. }),
        "{error:?}"
    );
    let sheet = generate::isotropic_square(0, 1.0).expect("valid");
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
    let air = Air {
        density: f64::NAN,
        ..still()
    };
    let error = model.with_air(air).expect_err("refused");
    assert!(matches!(error, AirError::Number { .. }), "{error:?}");
}
