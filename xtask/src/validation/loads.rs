//! Loads that change in time, under every method, and the balance of the forces of all supports.

use super::experiment::{Experiment, Job, Measured, Quantity};
use anyhow::Result;
use cpu_time::ThreadTime;
use isosheet_dynamics::{Method, Simulation, State};
use isosheet_tests::held_strip::{G, HELD, STEP, STEPS, held_strip, strip};
use isosheet_tests::pushed::{END, exact};
use isosheet_tests::{damped, methods, pushed};
use nalgebra::Vector3;

/// Positions under loads of all kinds, by all methods.
pub(super) const IN_TIME: Experiment = Experiment {
    name: "loads-in-time",
    title: "Loads that change in time",
    source: "The integral of the acceleration; the wind is that whose drag makes it",
    about: "A triangle is moved along its normal by 4 (1.6 + sin(4 pi t + 0.4)) m/s2, by each kind of load and with each \
            method, in steps of 1/60 s (4), 1/120 s (8) and 1/240 s (16): where it is after half a second, over where \
            it should be. Meshes make no difference.",
    quantities: || {
        let of = |(name, _): (&'static str, Method)| {
            let loads =
                pushed::loads().map(|(load, ..)| Quantity::new(format!("{name}, {load}"), 1.0));
            loads.into_iter()
        };
        methods().flat_map(of).collect()
    },
    measure: moved,
};

fn moved(job: Job) -> Result<Measured> {
    let begun = ThreadTime::now();
    let mut measured = Measured::default();
    let steps = (15.0 * job.across as f64 * END).round() as usize;
    for (_, method) in methods() {
        for (_, _, model) in pushed::loads() {
            let mut run = Simulation::new(model(), pushed::start(), method.clone())?;
            for _ in 0..steps {
                measured.factorisations += run.step(END / steps as f64)?.factorisations;
            }
            measured.values.push(run.state().x[2] / exact(END)[0]);
        }
    }
    measured.vertices = pushed::triangle().positions().len() / 3;
    measured.cpu = begun.elapsed().as_secs_f64();
    Ok(measured)
}

/// What a strip is held by, and what it asks of its supports.
pub(super) const BALANCED: Experiment = Experiment {
    name: "supports",
    title: "Forces of all supports",
    source: "Newton: the sum of all forces and the rate of the momentum",
    about: "An elastic strip, clamped at one end and held at the other, under its weight and a load that grows: the \
            largest sum of the forces of all supports that is not balanced by weight, load and inertia in a quarter of a \
            second, over the largest force of the supports, as 1 + sum / force; for every kind of support, at the \
            tolerance that a run has. Stiffnesses of 1e3 N/m (4), 1e4 N/m (8) and 1e5 N/m (16). Meshes make no difference.",
    quantities: || {
        let of = |(name, _): (&'static str, Method)| {
            HELD.map(|held| Quantity::new(format!("{name}, {held:?}"), 1.0))
                .into_iter()
        };
        damped().into_iter().flat_map(of).collect()
    },
    measure: balanced,
};

fn balanced(job: Job) -> Result<Measured> {
    let begun = ThreadTime::now();
    let mut measured = Measured::default();
    let stiffness = match job.across {
        4 => 1e3,
        8 => 1e4,
        _ => 1e5,
    };
    for (_, method) in damped() {
        for held in HELD {
            let start = State::at_rest(strip().positions().to_vec());
            let mut run = Simulation::new(held_strip(held, stiffness), start, method.clone())?;
            let mut momenta = [Vector3::zeros(); 2];
            let (mut left, mut force) = (0.0_f64, 0.0_f64);
            // Steps of one length since the start, or since one that was divided.
            let mut equal = 0;
            for _ in 0..STEPS {
                let report = run.step(STEP)?;
                measured.factorisations += report.factorisations;
                equal = if report.substeps == 1 { equal + 1 } else { 0 };
                let State { t, x, v } = run.state();
                let model = run.model();
                let now = Vector3::from(model.linear_momentum(v));
                let [last, before] = momenta;
                let rate = match method {
                    Method::Bdf2(_) => 1.5 * now - 2.0 * last + 0.5 * before,
                    _ => now - last,
                } / STEP;
                momenta = [now, last];
                // The formula is that of equal steps, and the first one of all has its own.
                if equal < 2 {
                    continue;
                }
                let mut loads = vec![0.0; x.len()];
                model.applied_force(*t, x, v, &mut loads);
                let loads: Vector3<f64> = loads
                    .as_chunks::<3>()
                    .0
                    .iter()
                    .map(|f| Vector3::from(*f))
                    .sum();
                let weight = Vector3::new(0.0, 0.0, -model.mass().total() * G);
                let held: Vector3<f64> = run.reactions().iter().map(|r| r.force).sum();
                left = left.max((held + loads + weight - rate).norm());
                force = force.max(held.norm());
            }
            measured.values.push(1.0 + left / force);
            measured.vertices = run.model().topology().vertex_count();
        }
    }
    measured.cpu = begun.elapsed().as_secs_f64();
    Ok(measured)
}
