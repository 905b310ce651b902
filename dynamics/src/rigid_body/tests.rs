use super::*;
use crate::{Method, SheetModel, Simulation, State};

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

/// Whatever corners carry a body, its kinetic energy and its angular momentum are those of its mass, centre and
/// inertia: of a block and of a plate, with corners at joints near and far, in the middle too.
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

/// Euler's equations of a free body in its own axes, `I dw/dt = (I w) x w`, by the classical Runge-Kutta
/// method in many steps.
fn euler_top(inertia: &Vector3<f64>, mut w: Vector3<f64>, duration: f64) -> Vector3<f64> {
    let rate = |w: &Vector3<f64>| {
        let l = inertia.component_mul(w);
        l.cross(w).component_div(inertia)
    };
    let count = 20_000;
    let h = duration / f64::from(count);
    for _ in 0..count {
        let k1 = rate(&w);
        let k2 = rate(&(w + 0.5 * h * k1));
        let k3 = rate(&(w + 0.5 * h * k2));
        let k4 = rate(&(w + h * k3));
        w += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    w
}

/// Angular velocity of the body in its own axes, from angular momentum and second moments in space.
fn own_rate(model: &SheetModel, state: &State, at_rest: &[Vector3<f64>]) -> Vector3<f64> {
    let now = points(&state.x);
    let centre = now.iter().sum::<Vector3<f64>>() / 4.0;
    let start = at_rest.iter().sum::<Vector3<f64>>() / 4.0;
    // Three edge vectors then and now give the rotation.
    let edges = |p: &[Vector3<f64>], c: Vector3<f64>| {
        Matrix3::from_columns(&[p[0] - c, p[1] - c, p[2] - c])
    };
    let turn = edges(&now, centre) * edges(at_rest, start).try_inverse().unwrap();
    let momentum: Vector3<f64> = {
        let about_origin = Vector3::from(model.angular_momentum(&state.x, &state.v));
        about_origin - centre.cross(&Vector3::from(model.linear_momentum(&state.v)))
    };
    let inertia = now.iter().zip(&model.mass().vertex).map(|(a, m)| {
        let r = a - centre;
        *m * (r.norm_squared() * Matrix3::identity() - r * r.transpose())
    });
    let rate = inertia.sum::<Matrix3<f64>>().try_inverse().unwrap() * momentum;
    turn.tr_mul(&rate)
}

/// A block that is thrown and spins about its middle axis, which is unstable, turns over. Its
/// angular velocity in its own axes is compared with that of Euler's equations.
fn thrown(method: Method, h: f64) -> (f64, Simulation) {
    let sides = Vector3::new(0.3, 0.2, 0.1);
    let mass = 0.6;
    let moments = Matrix3::from_diagonal(&sides.map(|a: f64| mass * a * a / 12.0));
    let body = RigidBody::new(mass, [0.0; 3], moments.into()).unwrap();
    let sheet = body.tetrahedron();
    let model = SheetModel::with_mass(&sheet, body.mass_matrix())
        .unwrap()
        .with_gravity();
    let rate = Vector3::new(0.1, 15.0, 0.2);
    let at_rest = points(sheet.positions());
    let thrown = Vector3::new(1.0, 0.0, 4.9);
    let v = at_rest
        .iter()
        .flat_map(|r| <[f64; 3]>::from(thrown + rate.cross(r)));
    let state = State {
        t: 0.0,
        x: sheet.positions().to_vec(),
        v: v.collect(),
    };
    let mut run = Simulation::new(model, state, method).unwrap();
    for _ in 0..(1.0 / h).round() as usize {
        run.step(h).unwrap();
    }
    let inertia = Vector3::from_fn(|i, _| moments.trace() - moments[(i, i)]);
    let expected = euler_top(&inertia, rate, 1.0);
    assert!(
        (expected - rate).norm() > 0.5 * rate.norm(),
        "it turns: {expected}"
    );
    let error = (own_rate(run.model(), run.state(), &at_rest) - expected).norm() / rate.norm();
    (error, run)
}

#[test]
fn a_thrown_block_obeys_the_equations_of_euler() {
    let method = Method::EnergyMomentum(Default::default());
    let (coarse, _) = thrown(method.clone(), 2e-3);
    let (fine, run) = thrown(method, 1e-3);
    // Second order.
    let order = (coarse / fine).log2();
    assert!(
        fine < 1e-2 && (1.8..2.2).contains(&order),
        "{coarse} {fine} {order}"
    );
    // The parabola of the centre; momenta and energy are kept.
    let now = points(&run.state().x);
    let centre = now.iter().sum::<Vector3<f64>>() / 4.0;
    let expected = Vector3::new(1.0, 0.0, 4.9 - 0.5 * 9.8);
    assert!((centre - expected).norm() < 1e-9, "{centre}");
    let (damped, _) = thrown(Method::default(), 1e-3);
    let (finer, _) = thrown(Method::default(), 5e-4);
    let order = (damped / finer).log2();
    assert!((1.6..2.4).contains(&order), "{damped} {finer} {order}");
}
