//! Bodies that are thrown.

use isosheet_dynamics::nalgebra::{Matrix3, Vector3};
use isosheet_dynamics::{Method, RigidBody, SheetModel, Simulation, State};

fn points(x: &[f64]) -> Vec<Vector3<f64>> {
    let points = x.as_chunks::<3>().0.iter();
    points.map(|p| Vector3::from(*p)).collect()
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
