use super::*;
use crate::constraint::{Plane, Side};
use crate::reaction::ForceTime;
use crate::{Support, VertexConstraint};
use isosheet_mesh::{MassKind, generate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn random(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

#[test]
fn fits_rigid_displacements() {
    let rng = &mut ChaCha8Rng::seed_from_u64(1);
    for _ in 0..100 {
        let rotation = Rotation3::new(random(rng));
        let shift = random(rng);
        let pairs: Vec<_> = (0..4)
            .map(|_| random(rng))
            .map(|p| [p, rotation * p + shift])
            .collect();
        let fit = RigidFit::of(&pairs);
        let p = random(rng);
        assert!((fit.apply(&p) - (rotation * p + shift)).norm() < 1e-13);
    }
}

#[test]
fn fits_the_smallest_rotation() {
    let rng = &mut ChaCha8Rng::seed_from_u64(2);
    for _ in 0..100 {
        let (origin, shift) = (random(rng), random(rng));
        // One point: a translation.
        let fit = RigidFit::of(&[[origin, origin + shift]]);
        let p = random(rng);
        assert!((fit.apply(&p) - (p + shift)).norm() < 1e-14);
        // A line: the rotation that takes it to the other one about their common perpendicular.
        let (from, to) = (random(rng).normalize(), random(rng).normalize());
        let place = |s: f64| [origin + s * from, origin + shift + s * to];
        let fit = RigidFit::of(&[-1.0, 0.3, 2.0].map(place));
        let Some(smallest) = Rotation3::rotation_between(&from, &to) else {
            continue;
        };
        let expected = smallest * (p - origin) + origin + shift;
        assert!((fit.apply(&p) - expected).norm() < 1e-9, "{from} {to}");
    }
}

/// Resultant and moment about the origin of the forces of the supports on a sheet at `x`.
fn wrench(balance: &Balance, model: &SheetModel, x: &[f64]) -> Vector6<f64> {
    let mut sum = Vector6::zeros();
    let mut add = |v: VertexId, force: Vector3<f64>| {
        let moment = point(x, v).cross(&force);
        let parts = force.iter().chain(&moment).copied();
        sum += Vector6::from_iterator(parts);
    };
    for v in model.topology().vertex_ids() {
        add(v, point(&balance.pins, v));
    }
    for (c, force) in model.constraints().iter().zip(&balance.constraints) {
        add(c.vertex(), *force);
    }
    sum
}

/// Forces at free vertices go to the supports with resultant and moment, whatever holds the sheet, and no
/// other forces that do so have a smaller sum of squares.
#[test]
fn supports_take_resultant_and_moment() {
    let rng = &mut ChaCha8Rng::seed_from_u64(3);
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let x: Vec<f64> = sheet
        .positions()
        .iter()
        .map(|x| x + rng.random_range(-0.1..0.1))
        .collect();
    let plane = |v: u32, rng: &mut ChaCha8Rng| {
        let at = point(&x, VertexId(v));
        let plane = Plane::new(at.into(), random(rng).into()).unwrap();
        VertexConstraint::on_surface(VertexId(v), plane, Side::On)
    };
    for case in 0..3 {
        let mut model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        let pins = [&[0, 3, 17][..], &[0, 7], &[5]][case];
        model = model
            .with_pins(&pins.iter().map(|v| VertexId(*v)).collect::<Vec<_>>())
            .unwrap();
        for v in [&[][..], &[9, 12], &[1, 2, 3]][case] {
            model = model.with_constraint(plane(*v, rng)).unwrap();
        }
        let mut balance = Balance::new(&model, ForceTime::End);
        balance
            .pins
            .iter_mut()
            .for_each(|f| *f = rng.random_range(-1.0..1.0));
        let before = wrench(&balance, &model, &x);
        balance_as_rigid(&mut balance, &model, 0.0, &x);
        let after = wrench(&balance, &model, &x);
        assert!(
            (after - before).norm() < 1e-9,
            "case {case}: {before} {after}"
        );
        for v in model
            .topology()
            .vertex_ids()
            .filter(|v| !model.is_pinned(*v))
        {
            assert_eq!(point(&balance.pins, v), Vector3::zeros());
        }
    }
}

/// A table holds up what presses on it, and nothing down.
#[test]
fn one_sided_supports_do_not_pull() {
    let sheet = generate::isotropic_square(1, 1.0).unwrap();
    let x = sheet.positions();
    for (load, sign) in [(-1.0, 1.0), (1.0, 0.0)] {
        let mut model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        for v in model.topology().vertex_ids() {
            let plane = Plane::new(point(x, v).into(), [0.0, 0.0, 1.0]).unwrap();
            let c = VertexConstraint::on_surface(v, plane, Side::Outside);
            model = model.with_constraint(c).unwrap();
        }
        let mut balance = Balance::new(&model, ForceTime::End);
        let n = model.topology().vertex_count() as f64;
        // The forces that the sheet needs are opposite to those that act on it.
        balance
            .pins
            .iter_mut()
            .skip(2)
            .step_by(3)
            .for_each(|f| *f = -load);
        balance_as_rigid(&mut balance, &model, 0.0, x);
        let sum: Vector3<f64> = balance.constraints.iter().sum();
        assert!(
            (sum - Vector3::new(0.0, 0.0, sign * n)).norm() < 1e-9,
            "{load}: {sum}"
        );
        let supports = crate::reaction::supports(&model);
        assert!(
            supports.zip(&balance.multipliers).all(|(support, m)| {
                matches!(support, Support::Constraint { .. }) && m.x <= 1e-12
            })
        );
    }
}
