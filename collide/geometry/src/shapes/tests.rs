use super::*;
use crate::distance::{Jet, point_edge, point_point};
use crate::testing::{check_jet, points, sizes};
use nalgebra::Matrix3;
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// A kind of shape and three lengths.
fn forms() -> impl Strategy<Value = (u8, [f64; 3])> {
    (0..5_u8, proptest::array::uniform3(0.2..1.0_f64))
}

/// The shape of a form, scaled.
fn shape((kind, lengths): (u8, [f64; 3]), size: f64) -> Shape {
    let [radius, half_height, other] = lengths.map(|length| size * length);
    match kind {
        0 => Shape::HalfSpace,
        1 => Shape::Cuboid {
            half: [radius, half_height, other],
        },
        2 => Shape::Sphere { radius },
        3 => Shape::Cylinder {
            radius,
            half_height,
        },
        _ => Shape::Capsule {
            radius,
            half_length: half_height,
        },
    }
}

proptest! {
    #![proptest_config(isosheet_random::cases(1000))]

    #[test]
    fn derivatives_match_differences(form in forms(), size in sizes(), p in points::<1>()) {
        let shape = shape(form, size);
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
    fn distances_agree_with_the_contact_geometry(form in forms(), p in points::<1>()) {
        let shape = shape(form, 1.0);
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

/// The volume that the faces enclose; positive where they are counter-clockwise from outside.
fn volume(mesh: &Triangles) -> f64 {
    let six = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| mesh.points[v as usize]);
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    mesh.faces.iter().map(six).sum::<f64>() / 6.0
}

/// Round bodies are closed, wound outwards, and have the volume of their shapes.
#[test]
fn round_bodies_have_their_volumes() {
    let (radius, half_length) = (0.5, 0.75);
    let ball = TAU / 1.5 * radius * radius * radius;
    let tube = TAU * radius * radius * half_length;
    let shapes = [
        (Shape::Sphere { radius }, ball),
        (
            Shape::Capsule {
                radius,
                half_length,
            },
            ball + tube,
        ),
        (
            Shape::Cylinder {
                radius,
                half_height: half_length,
            },
            tube,
        ),
    ];
    for (shape, expected) in shapes {
        let moments = shape.moments().unwrap();
        assert!((moments.volume / expected - 1.0).abs() < 1e-15, "{shape:?}");
        let mesh = shape.triangles(128).unwrap().unwrap();
        let found = volume(&mesh);
        assert!(
            found < expected && found > 0.998 * expected,
            "{shape:?}: {found}"
        );
        let sides: BTreeSet<[u32; 2]> = mesh
            .faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .collect();
        assert_eq!(sides.len(), 3 * mesh.faces.len());
        assert!(sides.iter().all(|[a, b]| sides.contains(&[*b, *a])));
    }
    assert_eq!(Shape::HalfSpace.triangles(8).unwrap(), None);
    assert!(Shape::Sphere { radius }.triangles(3).is_err());
}

/// The second moments of the volume about the origin, as sums over tetrahedra with the origin.
fn second_moments(mesh: &Triangles) -> Matrix3<f64> {
    let of = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| Vector3::from(mesh.points[v as usize]));
        let sum = a + b + c;
        let squares = [a, b, c, sum].map(|v| v * v.transpose());
        a.dot(&b.cross(&c)) / 120.0 * squares.iter().sum::<Matrix3<f64>>()
    };
    mesh.faces.iter().map(of).sum()
}

/// Bounds and moments agree with triangles with many sides, which are inside of the shape.
#[test]
fn bounds_and_moments_are_those_of_the_triangles() {
    let shapes = [
        Shape::Cuboid {
            half: [0.3, 0.5, 0.2],
        },
        Shape::Sphere { radius: 0.3 },
        Shape::Cylinder {
            radius: 0.2,
            half_height: 0.35,
        },
        Shape::Capsule {
            radius: 0.2,
            half_length: 0.25,
        },
    ];
    for shape in shapes {
        let mesh = shape.triangles(256).unwrap().unwrap();
        let surface = TriangleSurface::new(&mesh.points.concat(), &mesh.faces).unwrap();
        let [found, expected] = [Form::bounds(&surface), shape.bounds()].map(Option::unwrap);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).amax() < 1e-15, "{shape:?}");
        }
        let (moments, second) = (shape.moments().unwrap(), second_moments(&mesh));
        assert_eq!(moments.centre, Vector3::zeros());
        // Corners are on the shape, and sides `r (1 - cos(pi / 256))` inside of it.
        assert!(
            (volume(&mesh) / moments.volume - 1.0).abs() < 1e-3,
            "{shape:?}"
        );
        let error = (second - moments.second).amax() / moments.second.amax();
        assert!(error < 1e-3, "{shape:?}: {error}");
    }
    assert!(Shape::HalfSpace.bounds().is_none() && Shape::HalfSpace.moments().is_none());
}

/// Turned by what leaves it as it is, a shape has the same distances; what is convex is beside the planes at
/// its closest points.
#[test]
fn symmetry_and_convexity_are_what_is_said() {
    let turns = |shape: &Shape| match shape.symmetry() {
        Symmetry::None => vec![],
        Symmetry::Axis => vec![Vector3::z()],
        Symmetry::Full => vec![Vector3::z(), Vector3::new(0.6, -0.3, 0.8)],
    };
    let open = TriangleSurface::wall(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], 0.5).unwrap();
    let shapes = [
        Shape::HalfSpace,
        Shape::Cuboid {
            half: [0.3, 0.5, 0.2],
        },
        Shape::Sphere { radius: 0.3 },
        Shape::Cylinder {
            radius: 0.2,
            half_height: 0.35,
        },
        Shape::Capsule {
            radius: 0.2,
            half_length: 0.25,
        },
        Shape::Surface(Arc::new(open)),
    ];
    let points = || {
        (0..50)
            .map(f64::from)
            .map(|i| Vector3::new((1.3 * i).sin(), (2.1 * i).cos(), (0.7 * i).sin()))
    };
    for shape in shapes {
        assert_eq!(shape.is_solid(), !matches!(shape, Shape::Surface(_)));
        for axis in turns(&shape) {
            let turn = nalgebra::Rotation3::new(axis);
            for p in points() {
                let [here, there] = [p, turn * p].map(|p| shape.signed_distance(&p).value);
                assert!((here - there).abs() < 1e-14, "{shape:?}");
            }
        }
        let corners = shape.triangles(16).unwrap().filter(|_| shape.is_convex());
        for corner in corners.iter().flat_map(|mesh| &mesh.points) {
            for p in points() {
                let d = shape.signed_distance(&p);
                assert!(
                    d.normal.dot(&(Vector3::from(*corner) - d.closest(&p))) < 1e-14,
                    "{shape:?}"
                );
            }
        }
    }
}
