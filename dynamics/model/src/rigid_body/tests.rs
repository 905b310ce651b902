use super::*;
use crate::SheetModel;

/// A block of 0.3 x 0.2 x 0.1 m, turned, that is not at the origin.
fn block() -> (RigidBody, Matrix3<f64>) {
    let mass = 0.6;
    let sides = Vector3::new(0.3, 0.2, 0.1);
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.7, 1.1).into_inner();
    let own = Matrix3::from_diagonal(&sides.map(|a: f64| mass * a * a / 12.0));
    let moments = turn * own * turn.transpose();
    let moments = 0.5 * (moments + moments.transpose());
    let body = RigidBody::new(mass, [0.1, 0.2, 0.3], moments.transpose().into()).unwrap();
    (body, moments)
}

fn points(x: &[f64]) -> Vec<Vector3<f64>> {
    let points = x.as_chunks::<3>().0.iter();
    points.map(|p| Vector3::from(*p)).collect()
}

#[test]
fn the_tetrahedron_has_mass_centre_and_moments_of_the_body() {
    let (body, moments) = block();
    let corners = points(body.tetrahedron().positions());
    let masses = body.mass_matrix();
    assert_eq!(masses.edge, None);
    let masses = masses.vertex;
    let mass: f64 = masses.iter().sum();
    assert!((mass - body.mass()).abs() < 1e-15);
    let centre: Vector3<f64> = corners
        .iter()
        .zip(&masses)
        .map(|(a, m)| *m * a / mass)
        .sum();
    assert!((centre - Vector3::new(0.1, 0.2, 0.3)).norm() < 1e-15);
    let second = corners.iter().zip(&masses).map(|(a, m)| {
        let r = a - centre;
        *m * r * r.transpose()
    });
    assert!((second.sum::<Matrix3<f64>>() - moments).norm() < 1e-15 * moments.norm().max(1.0));
    // A point of the body is the combination of the corners.
    let point = [0.3, -0.4, 0.25];
    let carried = body.carried(point, VertexId(0)).into_iter();
    let sum: Vector3<f64> = carried.map(|(v, b)| b * corners[v.index()]).sum();
    assert!((sum - Vector3::from(point)).norm() < 1e-14);
}

/// Whatever corners carry a body, its kinetic energy and its angular momentum follow from its mass, centre
/// and inertia: of a block and of a plate, with corners at joints near and far, in the middle too.
#[test]
fn any_tetrahedron_has_the_energy_and_the_momentum_of_the_body() {
    let (block, moments) = block();
    let thin = Matrix3::from_diagonal(&Vector3::new(0.02, 0.01, 1e-9));
    let plate = RigidBody::new(0.6, [0.1, 0.2, 0.3], thin.into()).unwrap();
    let centre = Vector3::new(0.1, 0.2, 0.3);
    for (body, moments) in [(block, moments), (plate, thin)] {
        for away in [0.0, 0.05, 1.0, 200.0] {
            let beside: Vector3<f64> = centre + away * Vector3::new(0.6, 0.8, 0.0);
            let point: [f64; 3] = beside.into();
            let axis = Vector3::new(1.0, -2.0, 0.5);
            let jointed = body.clone().with_corner(point).unwrap();
            let hinged = body.clone().with_edge(point, axis.into()).unwrap();
            for (guided, on_line) in [(body.clone(), 0), (jointed, 1), (hinged, 2)] {
                let sheet = guided.tetrahedron();
                let corners = points(sheet.positions());
                for corner in &corners[..on_line] {
                    let off = corner - Vector3::from(point);
                    let along = if on_line == 2 {
                        axis.normalize()
                    } else {
                        Vector3::zeros()
                    };
                    let across = off - along.dot(&off) * along;
                    assert!(across.norm() < 1e-10 * (1.0 + away), "{across}");
                }
                let model = SheetModel::with_mass(&sheet, guided.mass_matrix()).unwrap();
                let (linear, angular) =
                    (Vector3::new(0.3, -0.1, 0.2), Vector3::new(2.0, 1.0, -3.0));
                let v = corners
                    .iter()
                    .map(|a| linear + angular.cross(&(a - centre)));
                let v: Vec<f64> = v.flat_map(<[f64; 3]>::from).collect();
                let inertia = moments.trace() * Matrix3::identity() - moments;
                let expected =
                    0.3 * linear.norm_squared() + 0.5 * angular.dot(&(inertia * angular));
                let energy = model.kinetic_energy(&v);
                assert!(
                    (energy / expected - 1.0).abs() < 1e-9,
                    "{away} {energy} {expected}"
                );
                let turning = Vector3::from(model.angular_momentum(sheet.positions(), &v));
                let expected = 0.6 * centre.cross(&linear) + inertia * angular;
                assert!(
                    (turning - expected).norm() < 1e-8 * expected.norm(),
                    "{away}"
                );
                let carried = guided.carried([0.4, 0.1, 0.2], VertexId(0)).into_iter();
                let place: Vector3<f64> = carried.map(|(v, b)| b * corners[v.index()]).sum();
                assert!(
                    (place - Vector3::new(0.4, 0.1, 0.2)).norm() < 1e-10,
                    "{away}"
                );
            }
        }
    }
    let (block, _) = self::block();
    let error = block.clone().with_edge([0.0; 3], [0.0; 3]).unwrap_err();
    assert!(matches!(
        error,
        RigidBodyError::Guide {
            what: "direction",
            ..
        }
    ));
    let error = block.with_corner([f64::NAN, 0.0, 0.0]).unwrap_err();
    assert!(matches!(error, RigidBodyError::Guide { what: "point", .. }));
}

#[test]
fn bodies_that_make_no_sense_are_refused() {
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let error = |mass, moments| RigidBody::new(mass, [0.0; 3], moments).unwrap_err();
    assert_eq!(error(-1.0, unit), RigidBodyError::Mass { mass: -1.0 });
    let mut flat = unit;
    flat[2][2] = 0.0;
    assert!(matches!(error(1.0, flat), RigidBodyError::Moments { least, .. } if least == 0.0));
    flat[2][2] = f64::NAN;
    assert!(matches!(error(1.0, flat), RigidBodyError::Moments { .. }));
    let mut skew = unit;
    skew[0][1] = 0.5;
    assert!(matches!(error(1.0, skew), RigidBodyError::Moments { .. }));
}
