//! Plates that are not flat without stress, against closed forms and differences.

use super::*;
use crate::MaterialDirection;
use isosheet_mesh::generate;
use isosheet_motion::Profile;
use nalgebra::Rotation3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn sheet(seed: u64) -> Sheet {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.6], [0.0, 0.6]];
    generate::delaunay(&outline, 0.12, seed).unwrap()
}

fn map(x: &[f64], to: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<f64> {
    let points = x.as_chunks::<3>().0.iter();
    points
        .flat_map(|p| <[f64; 3]>::from(to(Vector3::from(*p))))
        .collect()
}

/// The flat sheet on a cylinder whose axis has the angle `axis` to the y-axis, of the curvature `k` upwards.
fn rolled(x: &[f64], axis: f64, k: f64) -> Vec<f64> {
    let along = Vector3::new(axis.cos(), axis.sin(), 0.0);
    let across = Vector3::new(-axis.sin(), axis.cos(), 0.0);
    map(x, |p| {
        let s = k * along.dot(&p);
        along * (s.sin() / k) + across * across.dot(&p) + Vector3::z() * ((1.0 - s.cos()) / k)
    })
}

fn plate(poisson: f64) -> PlateStiffness {
    let rigidity = 2.0;
    PlateStiffness { rigidity, poisson }
}

fn bent(along: f64, across: f64) -> Curvature {
    Curvature {
        along,
        across,
        ..Curvature::default()
    }
}

fn curl(angle: f64, along: f64, across: f64) -> Curl {
    Curl {
        direction: MaterialDirection::Uniform([angle.cos(), angle.sin(), 0.0]),
        curvature: bent(along, across).into(),
        profile: Profile::Constant(1.0),
    }
}

fn energy(plate: &PlateBending, x: &[f64]) -> f64 {
    let memory = plate.memory();
    plate.energy(At::new(0.0, x).with_memory(&memory))
}

fn gradient(plate: &PlateBending, t: f64, x: &[f64]) -> Vec<f64> {
    let memory = plate.memory();
    let mut gradient = vec![0.0; x.len()];
    plate.add_gradient(At::new(t, x).with_memory(&memory), &mut gradient);
    gradient
}

/// A bilayer that wants to be curved about one axis: without energy on the cylinder, and with that of what it
/// is bent beyond elsewhere; the small curvature makes the mesh as good as smooth.
#[test]
fn a_curl_about_one_axis_is_a_cylinder() {
    let sheet = sheet(3);
    let area: f64 = sheet.face_areas().iter().sum();
    let (k, poisson) = (0.02, 0.3);
    for angle in [0.0, 0.7] {
        let plate = PlateBending::new(&sheet, plate(poisson)).unwrap();
        let plate = plate.with_curl(&sheet, curl(angle, k, 0.0)).unwrap();
        for (factor, expected) in [(1.0, 0.0), (0.5, 0.25), (2.0, 1.0), (-1.0, 4.0)] {
            let found = energy(&plate, &rolled(sheet.positions(), angle, factor * k));
            let unit = area * k * k;
            assert!(
                (found / unit - expected).abs() < 2e-3,
                "{angle} {factor}: {}",
                found / unit
            );
        }
        // Across the curl nothing fits.
        let across = angle + std::f64::consts::FRAC_PI_2;
        let found = energy(&plate, &rolled(sheet.positions(), across, k)) / (area * k * k);
        assert!((found - (2.0 - 2.0 * poisson)).abs() < 5e-3, "{found}");
    }
}

/// A plate that wants to be curved about both axes alike rolls up along one of them, to `(1 + nu)` times the
/// curvature: of cylinders that one has the least energy, `(1 - nu^2)` times `D k^2 / 2` per area.
#[test]
fn a_curl_about_both_axes_is_a_tighter_cylinder() {
    let sheet = sheet(5);
    let area: f64 = sheet.face_areas().iter().sum();
    let (k, poisson) = (0.02, 0.3);
    let plate = PlateBending::new(&sheet, plate(poisson)).unwrap();
    let plate = plate.with_curl(&sheet, curl(0.3, k, k)).unwrap();
    let at =
        |factor: f64| energy(&plate, &rolled(sheet.positions(), 0.0, factor * k)) / (area * k * k);
    let least = 1.0 + poisson;
    let expected = |factor: f64| (factor - least).powi(2) + 1.0 - poisson * poisson;
    for factor in [0.0001, 1.0, least, 2.0] {
        assert!(
            (at(factor) - expected(factor)).abs() < 5e-3,
            "{factor}: {}",
            at(factor)
        );
    }
}

/// A mesh that is curved at rest, as a bowl which no flat sheet makes, is in equilibrium there, without
/// energy, wherever it is placed.
#[test]
fn a_sheet_that_is_curved_at_rest_stays_so() {
    let flat = sheet(8);
    let bowl = map(flat.positions(), |p| {
        let (x, y) = (p.x - 0.5, p.y - 0.3);
        Vector3::new(p.x, p.y, 0.8 * x * x + 0.5 * y * y - 0.3 * x * y)
    });
    let bowl = Sheet::new(bowl, &flat.face_indices()).unwrap();
    let plate = PlateBending::new(&bowl, plate(0.3)).unwrap().curved(&bowl);
    let turned = Rotation3::from_euler_angles(0.4, -1.0, 2.0);
    let placed = map(bowl.positions(), |p| {
        turned * p + Vector3::new(1.0, 2.0, 3.0)
    });
    let flattened = energy(&plate, flat.positions());
    assert!(flattened > 0.1, "to flatten it takes energy: {flattened}");
    for x in [bowl.positions(), &placed] {
        assert!(energy(&plate, x) < 1e-24 * flattened);
        let force = gradient(&plate, 0.0, x);
        let scale = gradient(&plate, 0.0, flat.positions());
        let largest = |f: &[f64]| f.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        assert!(largest(&force) < 1e-11 * largest(&scale));
    }
}

/// With directions, a curl that changes with time, and yielding besides.
#[test]
fn gradients_are_differences_of_energies() {
    let sheet = sheet(1);
    let direction = MaterialDirection::Uniform([1.0, 0.5, 0.0]);
    let law = OrthotropicPlate {
        along: 2.0,
        across: 1.0,
        coupling: 0.3,
        twist: 0.5,
        direction: direction.clone(),
    };
    let ramp = Profile::Ramp {
        from: 0.0,
        to: 1.0,
        begin: 0.0,
        end: 1.0,
    };
    let curl = Curl {
        direction,
        curvature: Curvature {
            twist: 0.4,
            ..bent(1.5, -0.5)
        }
        .into(),
        profile: ramp,
    };
    let plate = PlateBending::new(&sheet, law).unwrap();
    let plate = plate.with_curl(&sheet, curl).unwrap();
    let plate = plate.with_yield(&sheet, Yield::perfect(0.8)).unwrap();
    assert!(plate.is_driven());
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let x: Vec<f64> = rolled(sheet.positions(), 0.4, 1.0)
        .iter()
        .map(|x| x + 0.01 * rng.random_range(-1.0..1.0))
        .collect();
    let memory = plate.memory();
    let t = 0.6;
    let at = |x: &[f64]| plate.energy(At::new(t, x).with_memory(&memory));
    let found = gradient(&plate, t, &x);
    let largest = found.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let h = 1e-6;
    for i in 0..x.len() {
        let [mut up, mut down] = [x.clone(), x.clone()];
        up[i] += h;
        down[i] -= h;
        let expected = (at(&up) - at(&down)) / (2.0 * h);
        assert!(
            (found[i] - expected).abs() < 1e-7 * largest,
            "{i}: {} {expected}",
            found[i]
        );
    }
}

/// A twist alone: of the surfaces `z = c x y`, whose twist is `c`, the one with `c = k_12` has no energy, to
/// fourth order.
#[test]
fn a_twist_is_that_of_a_saddle() {
    let sheet = sheet(3);
    let area: f64 = sheet.face_areas().iter().sum();
    let (k, poisson, angle) = (1e-3, 0.3, 0.4_f64);
    let twist = Curvature {
        twist: k,
        ..Curvature::default()
    };
    let each = vec![twist; sheet.topology().face_count()];
    for curvature in [twist.into(), NaturalTensor::Faces(each)] {
        let curl = Curl {
            curvature,
            ..curl(angle, 0.0, 0.0)
        };
        let plate = PlateBending::new(&sheet, plate(poisson)).unwrap();
        let plate = plate.with_curl(&sheet, curl).unwrap();
        let saddle = |c: f64| {
            map(sheet.positions(), |p| {
                let (s, t) = (angle.cos(), angle.sin());
                let [along, across] = [s * p.x + t * p.y, s * p.y - t * p.x];
                Vector3::new(p.x, p.y, c * along * across)
            })
        };
        // `D (1 - nu) (c - k)^2` per area, with `D = 2`.
        for factor in [-1.0, 0.0, 1.0, 2.0] {
            let found = energy(&plate, &saddle(factor * k)) / (area * k * k);
            let expected = 2.0 * (1.0 - poisson) * (factor - 1.0).powi(2);
            assert!((found - expected).abs() < 5e-3, "{factor}: {found}");
        }
    }
}

/// The curvature of a bowl on a flat sheet: bent to the bowl there are no moments, with its profile at one.
#[test]
fn a_sheet_may_be_curled_as_another_shape_is() {
    let sheet = sheet(8);
    let bowl = map(sheet.positions(), |p| {
        Vector3::new(
            p.x,
            p.y,
            1e-3 * (0.8 * p.x * p.x + 0.5 * p.y * p.y - 0.3 * p.x * p.y),
        )
    });
    let plate = || PlateBending::new(&sheet, plate(0.3)).unwrap();
    let curled = |factor| plate().curled_as(&sheet, &bowl, Profile::Constant(factor));
    let flat = energy(&plate(), &bowl);
    assert!(energy(&curled(1.0).unwrap(), &bowl) < 1e-5 * flat);
    let doubled = energy(&curled(2.0).unwrap(), &bowl);
    assert!((doubled / flat - 1.0).abs() < 1e-3, "{doubled} {flat}");
    let nan = vec![f64::NAN; bowl.len()];
    assert!(
        plate()
            .curled_as(&sheet, &nan, Profile::Constant(1.0))
            .is_err()
    );
}

#[test]
fn curls_that_make_no_sense_are_refused() {
    let sheet = sheet(1);
    let error = |curl| {
        let plate = PlateBending::new(&sheet, 1.0).unwrap();
        plate.with_curl(&sheet, curl).unwrap_err()
    };
    let source = CurlError::Curvature {
        value: f64::INFINITY,
    };
    assert_eq!(
        error(curl(0.0, f64::INFINITY, 0.0)),
        PlateBendingError::Curl { source }
    );
    let few = Curl {
        curvature: NaturalTensor::Faces(vec![bent(1.0, 0.0)]),
        ..curl(0.0, 0.0, 0.0)
    };
    let expected = sheet.topology().face_count();
    let source = CurlError::Count { found: 1, expected };
    assert_eq!(error(few), PlateBendingError::Curl { source });
    let normal = Curl {
        direction: MaterialDirection::Uniform([0.0, 0.0, 1.0]),
        ..curl(0.0, 1.0, 0.0)
    };
    let source = |error| {
        matches!(
            error,
            PlateBendingError::Curl {
                source: CurlError::Direction(_)
            }
        )
    };
    assert!(source(error(normal)));
    let bad = Curl {
        profile: Profile::Constant(f64::NAN),
        ..curl(0.0, 1.0, 0.0)
    };
    assert!(matches!(
        error(bad),
        PlateBendingError::Curl {
            source: CurlError::Profile(_)
        }
    ));
}
