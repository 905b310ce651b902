//! Forces and torques of all supports of elastic sheets, with weight, loads and inertia, add up to zero step
//! by step.

use isosheet_dynamics::{Method, Simulation, State};
use isosheet_tests::damped_to;
use isosheet_tests::held_strip::{G, HELD, Held, STEP, STEPS, held_strip, strip};
use nalgebra::Vector3;

/// Inertia `M a` of each vertex by the formula of the method, from velocities at the end of a step, at its
/// start and a step before.
fn inertia(method: &Method, masses: &[f64], [new, old, older]: [&[f64]; 3]) -> Vec<Vector3<f64>> {
    let at = |v: &[f64], i: usize| Vector3::from_column_slice(&v[3 * i..3 * i + 3]);
    let of = |i: usize| match method {
        Method::Bdf2(_) => 1.5 * at(new, i) - 2.0 * at(old, i) + 0.5 * at(older, i),
        _ => at(new, i) - at(old, i),
    };
    masses
        .iter()
        .enumerate()
        .map(|(i, m)| of(i) * (*m / STEP))
        .collect()
}

/// Largest sums of forces and of torques in a run over the largest sums of their magnitudes; with what the
/// simulation says of them itself.
fn left(held: Held, method: &Method, stiffness: f64) -> [f64; 4] {
    let model = held_strip(held, stiffness);
    let start = State::at_rest(strip().positions().to_vec());
    let mut run = Simulation::new(model, start, method.clone()).expect("a simulation");
    let mut before = [run.state().v.clone(), run.state().v.clone()];
    let (mut largest, mut sizes) = ([0.0_f64; 4], [0.0_f64; 4]);
    for step in 0..STEPS {
        let report = run.step(STEP).expect("a step");
        assert_eq!((report.rejected, report.substeps), (0, 1), "{held:?}");
        let State { t, x, v } = run.state();
        let masses = run.model().mass().vertex.clone();
        let rate = inertia(method, &masses, [v, &before[0], &before[1]]);
        before = [v.clone(), std::mem::take(&mut before[0])];
        // The first step of BDF2 has a formula of its own, and the second one a history of it.
        if step < 1 {
            continue;
        }
        let place = |i: usize| Vector3::from_column_slice(&x[3 * i..3 * i + 3]);
        let mut loads = vec![0.0; x.len()];
        run.model().applied_force(*t, x, v, &mut loads);
        let mut sum = [Vector3::zeros(); 2];
        let mut size = [0.0; 2];
        let mut add = |i: usize, force: Vector3<f64>| {
            let torque = place(i).cross(&force);
            sum[0] += force;
            sum[1] += torque;
            size[0] += force.norm();
            size[1] += torque.norm();
        };
        for reaction in run.reactions() {
            add(reaction.support.vertex().index(), reaction.force);
        }
        for (i, (m, a)) in masses.iter().zip(&rate).enumerate() {
            add(i, Vector3::new(0.0, 0.0, -m * G) - a);
            add(i, Vector3::from_column_slice(&loads[3 * i..3 * i + 3]));
        }
        let own = run.imbalance().expect("supports");
        for (k, (value, of)) in [
            (sum[0].norm(), size[0]),
            (sum[1].norm(), size[1]),
            (own.force.norm(), own.forces),
            (own.torque.norm(), own.torques),
        ]
        .into_iter()
        .enumerate()
        {
            largest[k] = largest[k].max(value);
            sizes[k] = sizes[k].max(of);
        }
    }
    std::array::from_fn(|k| largest[k] / sizes[k])
}

/// The tolerance is one of an energy, which is quadratic in the forces that are left; what a strip of this
/// stiffness leaves of the torque of the plate is of the order of its strain.
#[test]
fn all_supports_balance() {
    for tolerance in [1e-12, 1e-3_f64] {
        for method in damped_to(tolerance) {
            for held in HELD {
                for stiffness in [1e3, 1e5] {
                    let found = left(held, &method, stiffness);
                    let bound = tolerance.sqrt();
                    assert!(
                        found.iter().all(|f| *f < bound),
                        "{held:?} {stiffness:e} {method:?}: {found:?} {bound:e}"
                    );
                }
            }
        }
    }
}
