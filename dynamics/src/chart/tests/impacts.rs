//! The small problem of all contacts at once, on contacts that need no geometry.

use super::*;
use crate::chart::impact::Impacts;
use crate::chart::mobility::Mobility;
use crate::contact::ContactPoint;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A bent sheet with a pin in the chart and one as closure, velocities that keep both, and random contacts.
struct Scene {
    mechanics: ChartMechanics,
    mobility: Mobility,
    /// On the unknowns.
    v: Vec<f64>,
    points: Vec<ContactPoint>,
}

impl Scene {
    fn new(seed: u64, count: usize) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let sheet = bumped(0, 0.3);
        let x = sheet.positions();
        let m = model(&sheet, &[VertexId(0), VertexId(5)], MassKind::Consistent);
        let chart = cartesian(&sheet, &[VertexId(0)]);
        let mut mechanics = ChartMechanics::new(m, chart, MassSolverKind::Saddle).unwrap();
        let mut mobility = Mobility::new(&mechanics, x).unwrap();
        mechanics.at(x).unwrap();
        mobility.at(&mechanics, 0.0, x).unwrap();
        let mut v = vec![0.0; mechanics.system().unknowns()];
        let mut other = v.clone();
        for velocities in [&mut v, &mut other] {
            let push = velocities.iter().map(|_| rng.random_range(-0.1..0.1));
            let push: Vec<f64> = push.collect();
            mobility.respond(&push, velocities).unwrap();
        }
        let mut vector = || Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0_f64));
        let points = (0..count).map(|k| {
            let (normal, more) = (vector().normalize(), vector());
            let weights = [1.0, -0.4 + 0.3 * more.x, -0.6 - 0.3 * more.x, 0.0];
            let first = 1 + (k as u32) % 5;
            ContactPoint {
                stencil: std::array::from_fn(|i| (first + i as u32, weights[i])),
                normal,
                gap: 1e-4 * (1.0 + more.y),
                body_velocity: Vector3::zeros(),
                friction: if k % 3 == 0 { 0.0 } else { 1.0 + more.z },
            }
        });
        let mut scene = Self {
            points: points.collect(),
            mechanics,
            mobility,
            v,
        };
        // Bodies that move as the sheet could, so that it can get out of their way.
        if seed % 2 == 1 {
            for i in 0..count {
                scene.points[i].body_velocity = scene.relative(&scene.points[i], &other);
            }
        }
        scene
    }

    fn kinetic(&self, v: &[f64]) -> f64 {
        let mut full = vec![0.0; self.mechanics.model().coordinate_count()];
        self.mechanics.system().scatter(v, &mut full);
        self.mechanics.model().kinetic_energy(&full)
    }

    fn relative(&self, point: &ContactPoint, v: &[f64]) -> Vector3<f64> {
        let of = |(w, c): &(u32, f64)| {
            let first = self.mechanics.system().unknown(VertexId(*w));
            first.map_or(Vector3::zeros(), |u| {
                *c * Vector3::from_column_slice(&v[u..u + 3])
            })
        };
        point.stencil.iter().map(of).sum::<Vector3<f64>>() - point.body_velocity
    }
}

/// Work and energy, cone, no approach; over many random problems with friction up to 2 and every restitution.
#[test]
fn impacts_never_add_energy() {
    let mut lossy = 0;
    for seed in 0..200 {
        let mut scene = Scene::new(seed, 1 + seed as usize % 7);
        let e = (seed % 11) as f64 / 10.0;
        let system = scene.mechanics.system();
        let impacts = Impacts::new(system, &mut scene.mobility, 0.01, &scene.points).unwrap();
        let Some(impact) = impacts.solve(system, &scene.v, e) else {
            let v = &scene.v;
            let approaches = |p: &ContactPoint| p.normal.dot(&scene.relative(p, v)) < 0.0;
            assert!(!scene.points.iter().any(approaches));
            continue;
        };
        let after: Vec<f64> = scene
            .v
            .iter()
            .zip(&impact.change)
            .map(|(a, b)| a + b)
            .collect();
        let (before, now) = (scene.kinetic(&scene.v), scene.kinetic(&after));
        let size = before + now + impact.driven.abs();
        let balance = now - before + impact.loss - impact.driven;
        assert!(balance.abs() < 1e-10 * size, "seed {seed}: {balance:e}");
        assert!(impact.loss > -1e-12 * size, "seed {seed}: {}", impact.loss);
        lossy += usize::from(impact.loss > 1e-3 * size);
        let speed = scene.v.iter().fold(0.3, |m: f64, v| m.max(v.abs()));
        for ContactImpulse { point, impulse } in &impact.impulses {
            let normal = impulse.dot(&point.normal);
            let tangential = (impulse - normal * point.normal).norm();
            let round_off = 1e-12 * impulse.norm();
            assert!(normal >= -round_off, "seed {seed}: {impulse}");
            let most = point.friction * normal + round_off;
            assert!(tangential <= most, "seed {seed}: {tangential} above {most}");
            let leaves = point.normal.dot(&scene.relative(point, &after));
            assert!(leaves > -1e-6 * speed, "seed {seed}: {leaves}");
        }
        // Closures and lengths hold on.
        let mut back = impact.change.clone();
        let full = {
            let mut full = vec![0.0; scene.mechanics.model().coordinate_count()];
            system.scatter(&impact.change, &mut full);
            full
        };
        back.truncate(system.equations());
        system.apply(bumped(0, 0.3).positions(), &full, &mut back);
        assert!(back.iter().all(|r| r.abs() < 1e-12));
        assert!(full[15..18].iter().all(|c| c.abs() < 1e-12));
    }
    assert!(lossy > 50, "{lossy} of the problems lose energy");
}

/// One contact without friction parts at e times the speed; with enough friction and no restitution it
/// sticks.
#[test]
fn one_contact_follows_newtons_law() {
    let mut stuck = 0;
    for seed in 0..40 {
        let mut scene = Scene::new(seed, 1);
        let e = f64::from(seed as u32 % 5) / 4.0;
        // A point of a face that can move any way.
        scene.points[0].stencil = [(4, 0.2), (7, 0.5), (8, 0.3), (0, 0.0)];
        for friction in [0.0, 1e3] {
            scene.points[0].friction = friction;
            if friction > 0.0 {
                // Head on but for a little.
                let n = scene.points[0].normal;
                let want = -n + 0.05 * Vector3::x();
                let old = scene.relative(&scene.points[0], &scene.v);
                scene.points[0].body_velocity += old - want;
            }
            let system = scene.mechanics.system();
            let impacts = Impacts::new(system, &mut scene.mobility, 0.01, &scene.points).unwrap();
            let Some(impact) = impacts.solve(system, &scene.v, e) else {
                continue;
            };
            let after: Vec<f64> = scene
                .v
                .iter()
                .zip(&impact.change)
                .map(|(a, b)| a + b)
                .collect();
            let (old, new) = (
                scene.relative(&scene.points[0], &scene.v),
                scene.relative(&scene.points[0], &after),
            );
            let n = scene.points[0].normal;
            if friction == 0.0 {
                let want = -e * n.dot(&old);
                assert!(
                    (n.dot(&new) - want).abs() < 1e-9,
                    "seed {seed}: {old} {new}"
                );
                // Nothing but the normal impulse acts.
                assert!(impact.impulses[0].impulse.cross(&n).norm() < 1e-15);
            } else {
                let sliding = new - n.dot(&new) * n;
                assert!(sliding.norm() < 1e-9, "seed {seed}: {new}");
                stuck += 1;
            }
        }
    }
    assert_eq!(stuck, 40);
}
