//! Energies, gradients and Hessians against finite differences, and the balance of forces.

use super::*;
use nalgebra::DMatrix;

const H: f64 = 1.0 / 60.0;

/// Central differences of the energy against the gradient.
fn check_gradient(name: &str, step: &Step, x: &[f64]) {
    assert!(step.energy(x) > 0.0, "{name}: nothing within reach");
    let g = step.gradient(x);
    let scale = largest(&g);
    let h = 1e-7;
    for i in 0..x.len() {
        let at = |d: f64| {
            let mut y = x.to_vec();
            y[i] += d;
            step.energy(&y)
        };
        let slope = (at(h) - at(-h)) / (2.0 * h);
        assert!(
            (slope - g[i]).abs() < 1e-6 * scale,
            "{name}, coordinate {i}: {slope} against {} of {scale}",
            g[i]
        );
    }
}

/// Differences of a gradient.
fn curvature(gradient: &dyn Fn(&[f64]) -> Vec<f64>, x: &[f64]) -> DMatrix<f64> {
    let n = x.len();
    let step = 1e-7;
    let mut out = DMatrix::zeros(n, n);
    for i in 0..n {
        let at = |d: f64| {
            let mut y = x.to_vec();
            y[i] += d;
            gradient(&y)
        };
        let (up, down) = (at(step), at(-step));
        for j in 0..n {
            out[(j, i)] = (up[j] - down[j]) / (2.0 * step);
        }
    }
    0.5 * (&out + out.transpose())
}

fn positive_part(m: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = m.clone().symmetric_eigen();
    let values = eigen.eigenvalues.map(|v| v.max(0.0));
    &eigen.eigenvectors * DMatrix::from_diagonal(&values) * eigen.eigenvectors.transpose()
}

/// Visits the contacts one by one.
fn sum_of_positive_parts(step: &Step, x: &[f64]) -> DMatrix<f64> {
    let mut sum = DMatrix::zeros(x.len(), x.len());
    for contact in step.active(x).list() {
        let alone = One {
            contacts: &step.contacts,
            key: contact.key,
        };
        let gradient = |x: &[f64]| {
            let mut out = vec![0.0; x.len()];
            let active = ActiveContacts::at(&alone, &step.set, step.s, x);
            active.add_barrier_gradient(&step.barrier, 1.0, &mut out);
            out
        };
        sum += positive_part(&curvature(&gradient, x));
    }
    sum
}

/// Contact with all pairs but one left out.
struct One<'a> {
    contacts: &'a Contacts,
    key: ContactKey,
}

impl Contact for One<'_> {
    fn laws(&self) -> &ContactLaws {
        self.contacts.laws()
    }

    fn body_motions(&self, span: StepSpan, out: &mut Vec<BodyMotion>) {
        self.contacts.body_motions(span, out);
    }

    fn query(&mut self, _: JointMotion<'_>, _: &mut Vec<ContactKey>) -> f64 {
        unreachable!("the set is known")
    }

    fn evaluate(
        &self,
        _: &[ContactKey],
        x: &[f64],
        bodies: &[BodyPlace],
        out: &mut Vec<ActiveContact>,
    ) {
        self.contacts.evaluate(&[self.key], x, bodies, out);
    }

    fn check_start(&mut self, _: &SheetModel, _: &State) -> Result<(), ContactError> {
        Ok(())
    }
}

/// Semidefinite, within the reported couplings, and the sum of the positive parts of all contacts' true
/// Hessians up to `tolerance`.
fn check_hessian(name: &str, step: &Step, x: &[f64], tolerance: f64) {
    let dense = step.hessian(x);
    let ours = dense.matrix();
    let size = ours.norm();
    assert!(size > 0.0, "{name}: nothing within reach");
    assert!((&ours - ours.transpose()).norm() < 1e-14 * size, "{name}");
    let lowest = ours.clone().symmetric_eigenvalues().min();
    assert!(lowest > -1e-12 * size, "{name}: {lowest} of {size}");
    let truth = sum_of_positive_parts(step, x);
    let error = (&ours - &truth).norm() / size;
    assert!(error < tolerance, "{name}: error {error}");
    let mut couplings = Vec::new();
    step.terms(x, |t| t.append_couplings(&mut couplings));
    for pair in dense.pairs {
        let [a, b] = pair;
        let neighbours = step
            .contacts
            .mesh
            .edges()
            .iter()
            .any(|e| *e == [a, b] || *e == [b, a]);
        assert!(
            a == b || neighbours || couplings.contains(&pair),
            "{name}: {pair:?}"
        );
    }
}

fn tilt() -> nalgebra::UnitQuaternion<f64> {
    nalgebra::UnitQuaternion::from_euler_angles(0.4, 0.25, 0.7)
}

/// A step with one body below a wavy sheet, `gap` below it.
fn over(shape: Shape, friction: Coefficients, gap: f64) -> (Step, Vec<f64>) {
    let sheet = sheet(1);
    let model = model(&sheet);
    let rotation = match shape {
        Shape::HalfSpace => nalgebra::UnitQuaternion::identity(),
        _ => tilt(),
    };
    let pose = Isometry3::from_parts(nalgebra::Translation3::identity(), rotation);
    let mut x = waves(&sheet, top(&shape, &pose) + gap, 0.05);
    let options = options(&model, 0.1);
    let mut contacts = Contacts::new(&model, options)
        .unwrap()
        .with_body(fixed(shape, pose), friction)
        .unwrap();
    // Down until the smallest gap is the one asked for; a gap shrinks by no more than the shift.
    for _ in 0..60 {
        let down = 0.5 * (ActiveContacts::at_rest(&mut contacts, 0.0, &x).gap() - gap);
        x.iter_mut().skip(2).step_by(3).for_each(|z| *z -= down);
    }
    let step = Step::begin(contacts, &model, H, &x);
    assert!((step.gap(&x) / gap - 1.0).abs() < 1e-6);
    (step, x)
}

#[test]
fn bodies_match_differences() {
    for (name, shape) in shapes() {
        let (step, x) = over(shape.clone(), Coefficients::FRICTIONLESS, 0.02);
        check_gradient(name, &step, &x);
        assert_eq!(step.terms(&x, |t| t.barrier_energy()), step.energy(&x));
        // The gap is not small against the mesh here, a tenth.
        check_hessian(name, &step, &x, 0.3);
        let (step, x) = over(shape, Coefficients::FRICTIONLESS, 1e-4);
        check_hessian(name, &step, &x, 2e-3);
    }
}

/// A sheet whose edges lie along the edges of a box below, up to a twist.
fn aligned(twist: f64, friction: Coefficients) -> (Step, Vec<f64>) {
    let sheet = sheet(1);
    let model = model(&sheet);
    let half = [0.25, 0.25, 0.1];
    let pose = Isometry3::translation(0.5, 0.5, -0.12);
    let mut x = waves(&sheet, 0.0, twist);
    for (p, flat) in x.chunks_mut(3).zip(sheet.positions().chunks(3)) {
        p[0] = flat[0] + twist * p[2];
        p[1] = flat[1] + twist * p[0] - 0.3 * p[2];
    }
    let contacts = Contacts::new(&model, options(&model, 0.1))
        .unwrap()
        .with_body(fixed(Shape::Cuboid { half }, pose), friction)
        .unwrap();
    let step = Step::begin(contacts, &model, H, &x);
    let active = step.active(&x);
    assert!(active.list().iter().any(|c| c.parallel.is_some()));
    (step, x)
}

#[test]
fn parallel_edges_of_sheet_and_body_match_differences() {
    for twist in [0.02, 1e-3] {
        let (step, x) = aligned(twist, Coefficients::FRICTIONLESS);
        check_gradient("aligned", &step, &x);
        check_hessian("aligned", &step, &x, 0.3);
    }
    // Exactly parallel: no kink.
    let (step, x) = aligned(0.0, Coefficients::FRICTIONLESS);
    let before = step.gradient(&x);
    let scale = largest(&before);
    for i in 0..x.len() {
        let mut y = x.clone();
        y[i] += 1e-7;
        let after = step.gradient(&y);
        let jump = after.iter().zip(&before).map(|(a, b)| (a - b).abs());
        assert!(jump.fold(0.0, f64::max) < 1e-3 * scale);
    }
}

/// A strip folded over itself, all pairs within reach at once.
fn folded(gap: f64, friction: Coefficients, skew: f64) -> (Step, Vec<f64>) {
    let sheet = sheet(1);
    let model = model(&sheet);
    let x = {
        let mut x = waves(&sheet, 0.0, 0.2 * gap * skew.abs());
        for p in x.as_chunks_mut::<3>().0 {
            // Round a hairpin of the width of the gap.
            if p[0] > 0.0 {
                *p = [
                    0.9 * gap - p[0],
                    p[1] + skew * p[0],
                    p[2] + gap + skew * 0.02 * p[0],
                ];
            }
        }
        x
    };
    let options = options(&model, 0.08);
    let contacts = Contacts::new(&model, options)
        .unwrap()
        .with_self_contact(friction)
        .unwrap();
    (Step::begin(contacts, &model, H, &x), x)
}

#[test]
fn self_contact_matches_differences() {
    let (step, x) = folded(0.05, Coefficients::FRICTIONLESS, 0.3);
    check_gradient("folded", &step, &x);
    check_hessian("folded", &step, &x, 0.2);
    // Parallel edges and their factor.
    let (step, x) = folded(0.05, Coefficients::FRICTIONLESS, 0.01);
    let active = step.active(&x);
    assert!(active.list().iter().any(|c| c.parallel.is_some()));
    check_gradient("parallel", &step, &x);
    check_hessian("parallel", &step, &x, 0.3);
}

#[test]
fn friction_matches_differences() {
    let coefficients = Coefficients {
        rest: 0.6,
        sliding: 0.4,
    };
    for (name, shape) in shapes() {
        let (step, x) = over(shape, coefficients, 0.02);
        let smoothing = step.contacts.options.rest_speed * H;
        for size in [0.3, 2.0, 30.0] {
            let y: Vec<f64> = (0..x.len())
                .map(|i| x[i] + size * smoothing * (3.0 * i as f64).sin())
                .collect();
            check_friction(name, &step, &y, smoothing);
        }
    }
    let (step, x) = folded(0.05, coefficients, 0.3);
    let smoothing = step.contacts.options.rest_speed * H;
    let y: Vec<f64> = (0..x.len())
        .map(|i| x[i] + 2.0 * smoothing * (3.0 * i as f64).sin())
        .collect();
    check_friction("folded", &step, &y, smoothing);
}

/// The part of friction alone, which changes over its smoothing distance.
fn check_friction(name: &str, step: &Step, y: &[f64], smoothing: f64) {
    let Step { friction, .. } = step;
    assert!(!friction.contacts().is_empty(), "{name}");
    let active = step.active(y);
    let bodies = active.bodies();
    let energy = |x: &[f64]| friction.energy(x, bodies);
    let barrier = active.barrier_energy(&step.barrier);
    assert!((step.energy(y) - barrier - energy(y)).abs() < 1e-12);
    let mut barrier = vec![0.0; y.len()];
    active.add_barrier_gradient(&step.barrier, 1.0, &mut barrier);
    let all = step.gradient(y);
    let g: Vec<f64> = all.iter().zip(&barrier).map(|(a, b)| a - b).collect();
    let scale = largest(&g);
    assert!(scale > 0.0, "{name}");
    for i in 0..y.len() {
        let at = |d: f64| {
            let mut z = y.to_vec();
            z[i] += d;
            energy(&z)
        };
        let h = 1e-4 * smoothing;
        let slope = (at(h) - at(-h)) / (2.0 * h);
        assert!(
            (slope - g[i]).abs() < 1e-5 * scale,
            "{name} {i}: {slope} against {} of {scale}",
            g[i]
        );
    }
    let mut dense = Dense::new(y.len());
    friction.add_hessian(y, bodies, &mut dense);
    let ours = dense.matrix();
    assert!(ours.clone().symmetric_eigenvalues().min() > -1e-12 * ours.norm());
}

/// The loads balance the gradient, in force and torque.
#[test]
fn action_is_reaction() {
    let mut scenes: Vec<_> = shapes()
        .into_iter()
        .map(|(name, shape)| (name, over(shape, Coefficients::equal(0.5), 0.02)))
        .collect();
    scenes.push(("aligned", aligned(0.02, Coefficients::equal(0.5))));
    for (name, (step, x)) in scenes {
        let y: Vec<f64> = (0..x.len())
            .map(|i| x[i] + 1e-4 * (3.0 * i as f64).sin())
            .collect();
        for (x, has_slid) in [(&x, false), (&y, true)] {
            let g = step.gradient(x);
            let load = step.terms(x, |t| t.loads())[0];
            let origin = *step.active(x).bodies()[0].origin();
            let mut force = Vector3::zeros();
            let mut torque = Vector3::zeros();
            for (p, g) in x.as_chunks::<3>().0.iter().zip(g.as_chunks::<3>().0) {
                let (p, g) = (Vector3::from(*p), Vector3::from(*g));
                force += g;
                torque += (p - origin).cross(&g);
            }
            let scale = load.force.norm();
            assert!(scale > 0.0);
            assert!((load.force - force).norm() < 1e-11 * scale, "{name}");
            // Friction acts at the closest point, a gap below the sheet.
            let slack = if has_slid { 0.1 } else { 1e-11 };
            assert!(
                (load.torque - torque).norm() < slack * scale,
                "{name}: {} {torque}",
                load.torque
            );
        }
    }
}

/// For a body that is shifted by `u`, the drive is minus the Hessian times a shift of the sheet by
/// `u`; over a floor, where nothing is left out of the Hessian, it is the change of the gradient.
#[test]
fn drive_is_the_shift_of_a_body() {
    let sheet = sheet(1);
    let model = model(&sheet);
    for (name, shape) in shapes() {
        let pose = Isometry3::from_parts(
            nalgebra::Translation3::identity(),
            if name == "half-space" {
                nalgebra::UnitQuaternion::identity()
            } else {
                tilt()
            },
        );
        let x = waves(&sheet, top(&shape, &pose) + 0.002, 0.05);
        let push = nalgebra::Translation3::new(0.1e-7, -0.2e-7, 1e-7);
        let body = moving(shape, pose, push * pose, H);
        let contacts = Contacts::new(&model, options(&model, 0.1))
            .unwrap()
            .with_body(body, Coefficients::FRICTIONLESS)
            .unwrap();
        let mut step = Step::begin(contacts, &model, H, &x);
        assert_eq!(step.s, 0.0);
        let mut drive = vec![0.0; x.len()];
        step.terms(&x, |t| t.add_drive(1.0, &mut drive));
        let u = Vector3::from(push.vector);
        let shift = nalgebra::DVector::from_fn(x.len(), |i, _| u[i % 3]);
        let expected = -step.hessian(&x).matrix() * shift;
        let before = step.gradient(&x);
        step.advance(1.0);
        let after = step.gradient(&x);
        let scale = expected.amax();
        assert!(scale > 0.0);
        for i in 0..x.len() {
            let error = (drive[i] - expected[i]).abs();
            assert!(error < 1e-10 * scale, "{name}: {error} of {scale}");
            if name == "half-space" {
                let change = after[i] - before[i];
                assert!(
                    (drive[i] - change).abs() < 1e-4 * scale,
                    "{change} {}",
                    drive[i]
                );
            }
        }
        let mut none = vec![0.0; x.len()];
        step.terms(&x, |t| t.add_drive(1.0, &mut none));
        assert_eq!(largest(&none), 0.0);
    }
}
