use super::*;
use crate::distance::{Jet, point_edge, point_point};
use crate::testing::{check_jet, points, sizes};
use proptest::prelude::*;

fn shapes() -> impl Strategy<Value = Shape> {
    (0..5_u8, proptest::array::uniform3(0.2..1.0_f64)).prop_map(|(kind, [a, b, c])| match kind {
        0 => Shape::HalfSpace,
        1 => Shape::Cuboid { half: [a, b, c] },
        2 => Shape::Sphere { radius: a },
        3 => Shape::Cylinder {
            radius: a,
            half_height: b,
        },
        _ => Shape::Capsule {
            radius: a,
            half_length: b,
        },
    })
}

fn scaled(shape: &Shape, s: f64) -> Shape {
    match *shape {
        Shape::HalfSpace => Shape::HalfSpace,
        Shape::Cuboid { half } => Shape::Cuboid {
            half: half.map(|h| s * h),
        },
        Shape::Sphere { radius } => Shape::Sphere { radius: s * radius },
        Shape::Cylinder {
            radius,
            half_height,
        } => Shape::Cylinder {
            radius: s * radius,
            half_height: s * half_height,
        },
        Shape::Capsule {
            radius,
            half_length,
        } => Shape::Capsule {
            radius: s * radius,
            half_length: s * half_length,
        },
        Shape::Surface(_) => unreachable!("only analytic shapes are generated"),
    }
}

proptest! {
    #![proptest_config(isosheet_random::cases(1000))]

    #[test]
    fn derivatives_match_differences(shape in shapes(), size in sizes(), p in points::<1>()) {
        let shape = scaled(&shape, size);
        let p = 2.0 * size * p[0];
        let at = shape.signed_distance(&p);
        // The gradient jumps on the medial axis, the Hessian where the nearest feature changes.
        let steady = (0..6).all(|k| {
            let mut q = p;
            q[k / 2] += if k % 2 == 0 { 1e-3 } else { -1e-3 } * size;
            let d = shape.signed_distance(&q);
            (d.hessian - at.hessian).norm() * size < 0.1 && (d.normal - at.normal).norm() < 0.1
        });
        if steady {
            check_jet(&[p], 0.03 * size, &|q| {
                let d = shape.signed_distance(&q[0]);
                Jet { value: d.value, gradient: [d.normal], hessian: [[d.hessian]] }
            });
        }
        prop_assert!((at.normal.norm() - 1.0).abs() < 1e-12);
        // The closest point is on the surface.
        prop_assert!(shape.signed_distance(&at.closest(&p)).value.abs() < 1e-12 * size);
    }

    /// Against the primitives of the body: another way to its distances.
    #[test]
    fn distances_agree_with_the_contact_geometry(shape in shapes(), p in points::<1>()) {
        let p = 2.0 * p[0];
        let found = shape.signed_distance(&p).value;
        let Some(g) = shape.contact_geometry(100).unwrap() else {
            prop_assert_eq!(found, p.z);
            return Ok(());
        };
        let x: Vec<Vector3<f64>> = g.positions.as_chunks::<3>().0.iter().map(|q| Vector3::from(*q)).collect();
        match shape {
            Shape::Sphere { .. } => {
                prop_assert!((point_point(&[p, x[0]]).distance() - g.radius - found).abs() < 1e-15);
            }
            Shape::Capsule { .. } => {
                prop_assert!((point_edge(&[p, x[0], x[1]]).distance() - g.radius - found).abs() < 1e-15);
            }
            _ => {
                let surface = TriangleSurface::new(&g.positions, g.mesh.faces()).unwrap();
                prop_assert!(surface.is_closed());
                let other = surface.signed_distance(&p).value;
                let sag = if let Shape::Cylinder { radius, .. } = shape {
                    radius * (1.0 - (std::f64::consts::PI / 100.0).cos())
                } else {
                    0.0
                };
                prop_assert!((-1e-12..=sag + 1e-12).contains(&(other - found)), "{other} {found}");
                let as_shape = Shape::Surface(Arc::new(surface));
                prop_assert_eq!(as_shape.signed_distance(&p).value, other);
            }
        }
    }
}

/// Points by hand, on every feature.
#[test]
fn distances_by_hand() {
    let at = |shape: &Shape, p: [f64; 3]| shape.signed_distance(&Vector3::from(p)).value;
    let cuboid = Shape::Cuboid {
        half: [1.0, 2.0, 3.0],
    };
    assert_eq!(at(&cuboid, [0.0, 0.0, 0.0]), -1.0);
    assert_eq!(at(&cuboid, [0.0, 5.0, 7.0]), 5.0);
    assert_eq!(at(&cuboid, [2.0, -4.0, 5.0]), 3.0);
    let cylinder = Shape::Cylinder {
        radius: 5.0,
        half_height: 1.0,
    };
    assert_eq!(at(&cylinder, [6.0, 8.0, 0.0]), 5.0);
    assert_eq!(at(&cylinder, [0.0, 0.0, -4.0]), 3.0);
    assert_eq!(at(&cylinder, [4.8, 6.4, 5.0]), 5.0);
    assert_eq!(at(&cylinder, [0.0, 0.0, 0.0]), -1.0);
    let capsule = Shape::Capsule {
        radius: 1.0,
        half_length: 2.0,
    };
    assert_eq!(at(&capsule, [3.0, 0.0, 6.0]), 4.0);
    assert_eq!(at(&capsule, [3.0, 4.0, 1.0]), 4.0);
    // Where the closest point is not unique, values and normals are still finite.
    for shape in [cuboid, cylinder, capsule, Shape::Sphere { radius: 1.0 }] {
        let d = shape.signed_distance(&Vector3::zeros());
        assert!(d.value < 0.0 && d.normal.norm() == 1.0 && d.hessian.iter().all(|h| h.is_finite()));
    }
}

#[test]
fn bad_lengths_are_named() {
    assert_eq!(
        Shape::Cuboid {
            half: [1.0, 0.0, 1.0]
        }
        .validate(),
        Err(ShapeError::Length {
            shape: "cuboid",
            name: "half[1]",
            value: 0.0
        })
    );
    assert_eq!(
        Shape::Sphere { radius: -1.0 }.validate(),
        Err(ShapeError::Length {
            shape: "sphere",
            name: "radius",
            value: -1.0
        })
    );
    assert!(
        Shape::Capsule {
            radius: 1.0,
            half_length: f64::NAN
        }
        .validate()
        .is_err()
    );
    assert!(
        Shape::Cylinder {
            radius: 1.0,
            half_height: f64::INFINITY
        }
        .validate()
        .is_err()
    );
    assert!(Shape::HalfSpace.validate().is_ok());
    let cylinder = Shape::Cylinder {
        radius: 1.0,
        half_height: 1.0,
    };
    assert_eq!(cylinder.contact_geometry(2), Err(ShapeError::Segments(2)));
}
