//! Convergence orders against closed forms, and what the published simplification costs.

use super::*;

struct Problem {
    sheet: Sheet,
    pins: Vec<VertexId>,
    model: fn(&Problem) -> SheetModel,
    v: Vec<f64>,
    end: f64,
}

impl Problem {
    /// Run with n equal steps to the end time.
    fn run(&self, chart: Box<dyn Chart>, options: ChartOptions, n: u32) -> ChartSimulation {
        let options = ChartOptions {
            control: ChartStepControl::Fixed(self.end / f64::from(n)),
            ..options
        };
        let x = self.sheet.positions();
        let mut s = ChartSimulation::new((self.model)(self), chart, options, x, &self.v).unwrap();
        for _ in 0..n {
            s.step().unwrap();
        }
        s
    }

    /// Observed order of a method from the error at n, 2n and 4n steps.
    fn order(&self, method: ChartMethod, n: u32, error: &dyn Fn(&[f64]) -> f64) {
        for (which, build) in [
            ("front", front as fn(&Sheet, &[VertexId]) -> Box<dyn Chart>),
            ("cartesian", cartesian),
        ] {
            let options = ChartOptions {
                method,
                ..Default::default()
            };
            let e = [n, 2 * n, 4 * n].map(|n| {
                let s = self.run(build(&self.sheet, &self.pins), options, n);
                assert!(s.mechanics().system().max_strain(s.positions()) < 1e-10);
                error(s.positions()).abs()
            });
            let expected = if method == ChartMethod::RungeKutta4 {
                4.0
            } else {
                1.0
            };
            for (a, b) in [(e[0], e[1]), (e[1], e[2])] {
                let order = (a / b).log2();
                assert!(
                    (order - expected).abs() < 0.15 * expected.max(2.0),
                    "{which} {method:?}: errors {e:?}, order {order}"
                );
            }
        }
    }

    fn orders(&self, coarse: u32, fine: u32, error: &dyn Fn(&[f64]) -> f64) {
        self.order(ChartMethod::ForwardEuler, coarse, error);
        self.order(ChartMethod::RungeKutta4, fine, error);
    }
}

/// Triangle pinned along a horizontal edge: the pendulum with elliptic functions, at a quarter period.
#[test]
fn order_on_the_pinned_triangle() {
    let (h, g, start) = (0.7, 9.81, 2.0f64);
    let (mut a, mut b) = (1.0, (0.5 * start).cos());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let period = 2.0 * PI * f64::sqrt(h / g) / a;
    assert!((period - 2.230427653768689).abs() < 1e-12);
    let x = vec![
        0.0,
        0.0,
        0.0,
        1.0,
        0.0,
        0.0,
        0.4,
        h * start.sin(),
        -h * start.cos(),
    ];
    let problem = Problem {
        sheet: Sheet::new(x, &[[0, 1, 2]]).unwrap(),
        pins: vec![VertexId(0), VertexId(1)],
        model: |p| {
            let mass = MassMatrix::from_vertex_masses(vec![1.0; 3]).unwrap();
            SheetModel::with_mass(&p.sheet, mass)
                .unwrap()
                .with_acceleration([0.0, 0.0, -9.81])
                .with_pins(&p.pins)
                .unwrap()
        },
        v: vec![0.0; 9],
        end: 0.25 * period,
    };
    problem.orders(200, 40, &|x| x[7]);
}

/// Free triangle: a rigid body. The error is measured against conserved quantities and a fine run.
#[test]
fn order_on_the_free_triangle() {
    let x = vec![0.0, 0.0, 0.0, 1.0, 0.1, 0.0, 0.3, 0.8, 0.1];
    let v = {
        // Rotation about the centroid: any v works, its tangent part is taken.
        let omega = [0.9, -1.3, 2.0];
        let c = [1.3 / 3.0, 0.9 / 3.0, 0.1 / 3.0];
        let mut v = vec![0.0; 9];
        for k in 0..3 {
            let r = [x[3 * k] - c[0], x[3 * k + 1] - c[1], x[3 * k + 2] - c[2]];
            v[3 * k] = omega[1] * r[2] - omega[2] * r[1];
            v[3 * k + 1] = omega[2] * r[0] - omega[0] * r[2];
            v[3 * k + 2] = omega[0] * r[1] - omega[1] * r[0];
        }
        v
    };
    let problem = Problem {
        sheet: Sheet::new(x, &[[0, 1, 2]]).unwrap(),
        pins: vec![],
        model: |p| SheetModel::new(&p.sheet, 1.0, MassKind::Consistent).unwrap(),
        v,
        end: 1.0,
    };
    let options = ChartOptions {
        method: ChartMethod::RungeKutta4,
        ..Default::default()
    };
    let mut fine = problem.run(cartesian(&problem.sheet, &[]), options, 1000);
    let u = fine.velocities().unwrap();
    let m = (problem.model)(&problem);
    let x0 = problem.sheet.positions();
    let (l0, l1) = (
        m.angular_momentum(x0, &problem.v),
        m.angular_momentum(fine.positions(), &u),
    );
    let (p0, p1) = (m.linear_momentum(&problem.v), m.linear_momentum(&u));
    for i in 0..3 {
        assert!((l0[i] - l1[i]).abs() < 1e-9, "{l0:?} {l1:?}");
        assert!((p0[i] - p1[i]).abs() < 1e-9);
    }
    assert!((m.kinetic_energy(&problem.v) - m.kinetic_energy(&u)).abs() < 1e-9);
    let end = fine.positions().to_vec();
    // A component, so that errors of different vertices do not cancel in their order.
    problem.orders(200, 40, &|x| {
        x.iter()
            .zip(&end)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    });
}

/// Free symmetric flap: incomplete elliptic integral of the second kind.
#[test]
fn order_on_the_free_flap() {
    let (h, m, hinge, start, end, w) = (0.8f64, 0.3, 0.5, 0.5f64, 1.2f64, 1.4f64);
    let at = |t: f64| (h * t.sin(), h * t.cos());
    let (s, c) = at(start);
    // Hinge along y at the origin, apexes at x = +-s, z = c: the faces meet the plane x = 0 at `start`.
    let x = vec![0.0, -0.5, 0.0, 0.0, 0.5, 0.0, s, 0.0, c, -s, 0.0, c];
    let drift = 2.0 * m / (hinge + 2.0 * m) * h * start.sin() * w;
    let (vx, vz) = (h * start.cos() * w, -h * start.sin() * w + drift);
    let v = vec![0.0, 0.0, drift, 0.0, 0.0, drift, vx, 0.0, vz, -vx, 0.0, vz];
    let k2 = 2.0 * m / (hinge + 2.0 * m);
    let energy = h * h * w * w * m * (1.0 - k2 * start.sin() * start.sin());
    // Simpson's rule for the integral of sqrt(1 - k2 sin^2).
    let n = 2000;
    let step = (end - start) / f64::from(n);
    let f = |t: f64| (1.0 - k2 * t.sin() * t.sin()).sqrt();
    let integral: f64 = (0..n)
        .map(|i| {
            let t = start + step * f64::from(i);
            step / 6.0 * (f(t) + 4.0 * f(t + 0.5 * step) + f(t + step))
        })
        .sum();
    let problem = Problem {
        sheet: Sheet::new(x, &[[0, 1, 3], [1, 0, 2]]).unwrap(),
        pins: vec![],
        model: |p| {
            let mass = MassMatrix::from_vertex_masses(vec![0.25, 0.25, 0.3, 0.3]).unwrap();
            SheetModel::with_mass(&p.sheet, mass).unwrap()
        },
        v,
        end: h * (m / energy).sqrt() * integral,
    };
    problem.orders(200, 16, &|x| {
        let (dx, dz) = (x[6] - x[0], x[8] - x[2]);
        dx.atan2(dz) - end
    });
}

/// Hanging strip: small oscillations at the zeros of the Laguerre polynomial `L_3`.
#[test]
fn order_on_the_hanging_strip() {
    // Rows of two vertices, rung length 1, at z = 0, -1, -2, -3; the top row is pinned.
    let rows = 3u32;
    let mut x = Vec::new();
    let mut faces = Vec::new();
    for r in 0..=rows {
        let z = -f64::from(r);
        x.extend([0.0, 0.0, z, 0.7, 0.0, z]);
        if r < rows {
            let a = 2 * r;
            faces.extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
        }
    }
    // L_3(u) = 0 near 2.294; the mode has L_j(u) at row j from the bottom.
    let u = 2.294_280_360_279_042_f64;
    let laguerre = |j: u32| match j {
        0 => 1.0,
        1 => 1.0 - u,
        2 => 1.0 - 2.0 * u + 0.5 * u * u,
        _ => 1.0 - 3.0 * u + 1.5 * u * u - u * u * u / 6.0,
    };
    assert!(laguerre(3).abs() < 1e-14);
    let omega = (9.8 * u).sqrt();
    let amplitude = 1e-5;
    // Started from rest in the mode; rods longer by the square of the amplitude do not matter.
    for r in 1..=rows {
        for side in 0..2 {
            x[(6 * r + 3 * side + 1) as usize] = amplitude * laguerre(rows - r);
        }
    }
    let v = vec![0.0; x.len()];
    let problem = Problem {
        sheet: Sheet::new(x, &faces).unwrap(),
        pins: vec![VertexId(0), VertexId(1)],
        model: |p| {
            let mass = MassMatrix::from_vertex_masses(vec![0.2; 8]).unwrap();
            SheetModel::with_mass(&p.sheet, mass)
                .unwrap()
                .with_gravity()
                .with_pins(&p.pins)
                .unwrap()
        },
        v,
        end: 0.2 * PI / omega,
    };
    let exact = amplitude * (0.2 * PI).cos();
    problem.orders(100, 3, &|x| (x[19] - exact) / amplitude);
}

fn position_error(s: &ChartSimulation, reference: &[f64]) -> f64 {
    s.positions()
        .iter()
        .zip(reference)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// What the published simplification costs: literal equations do not converge, re-formed momenta do.
#[test]
fn published_equations_do_not_converge() {
    let problem = Problem {
        sheet: bumped(0, 0.1),
        pins: vec![VertexId(0)],
        model: |p| model(&p.sheet, &p.pins, MassKind::Lumped),
        v: vec![0.0; 27],
        end: 0.3,
    };
    let chart = || front(&problem.sheet, &problem.pins);
    let reference = problem.run(
        cartesian(&problem.sheet, &problem.pins),
        ChartOptions {
            method: ChartMethod::RungeKutta4,
            ..Default::default()
        },
        600,
    );
    let reference = reference.positions();
    let error = |equations, method, position, n| {
        let options = ChartOptions {
            equations,
            method,
            position,
            rebase: Rebase::Never,
            ..Default::default()
        };
        position_error(&problem.run(chart(), options, n), reference)
    };
    let euler = ChartMethod::ForwardEuler;
    let literal =
        [300, 1200].map(|n| error(Equations::Published, euler, PositionUpdate::Linear, n));
    assert!(
        literal[1] > 1e-2 && literal[1] > 0.8 * literal[0],
        "{literal:?}"
    );
    for (equations, method, position) in [
        (Equations::Reformed, euler, PositionUpdate::Exact),
        (Equations::Reformed, euler, PositionUpdate::Projected),
        (Equations::Full, euler, PositionUpdate::Exact),
    ] {
        let e = [300, 1200].map(|n| error(equations, method, position, n));
        let ratio = e[0] / e[1];
        assert!(
            e[1] < 5e-3 && ratio > 3.0 && ratio < 5.5,
            "{equations:?} {method:?} {position:?} {e:?}"
        );
    }
}

/// What Eqs. 23 and 24 suppose: that along the exact motion of the equations the Hamiltonian does not change,
/// so that its change in a step comes from the remainder, which falls with the square of the step. With the
/// published equations it changes by `h qdot . dT/dq`, in proportion to the step.
#[test]
fn the_hamiltonian_changes_to_first_order_with_the_published_equations() {
    let mut v = vec![0.0; 27];
    // All but the pinned corner turn about it.
    let sheet = bumped(0, 0.1);
    let x = sheet.positions();
    for k in 1..9 {
        let r = [x[3 * k] - x[0], x[3 * k + 1] - x[1]];
        v[3 * k] = -2.0 * r[1];
        v[3 * k + 1] = 2.0 * r[0];
        v[3 * k + 2] = r[0] - r[1];
    }
    let problem = |end: f64| Problem {
        sheet: bumped(0, 0.1),
        pins: vec![VertexId(0)],
        model: |p| model(&p.sheet, &p.pins, MassKind::Lumped),
        v: v.clone(),
        end,
    };
    let change = |equations, h: f64| {
        let problem = problem(h);
        let options = ChartOptions {
            equations,
            method: ChartMethod::ForwardEuler,
            position: PositionUpdate::Exact,
            rebase: Rebase::Never,
            ..Default::default()
        };
        let chart = || front(&problem.sheet, &problem.pins);
        let x = problem.sheet.positions();
        let model = (problem.model)(&problem);
        let start = ChartSimulation::new(model, chart(), options, x, &problem.v).unwrap();
        (problem.run(chart(), options, 1).hamiltonian() - start.hamiltonian()).abs()
    };
    for (equations, order) in [(Equations::Published, 1.0), (Equations::Full, 2.0)] {
        let [coarse, fine] = [1e-5, 5e-6].map(|h| change(equations, h));
        let found = (coarse / fine).log2();
        assert!((found - order).abs() < 0.05, "{equations:?}: {found}");
    }
}
