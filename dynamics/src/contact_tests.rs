//! Contact in the step, with the simplest body there is: a floor that the vertices stay above.

use crate::contact::{BodyLoad, Contact, ContactError, ContactPoint, ContactWork, CouplingSink};
use crate::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::Vector3;

/// A floor at height `z(t)` below all vertices, with the barrier `-stiffness (d - reach)^2 ln(d / reach)`.
struct Floor {
    height: fn(f64) -> f64,
    reach: f64,
    stiffness: f64,
    t: [f64; 2],
    progress: f64,
}

impl Floor {
    fn new(height: fn(f64) -> f64) -> Self {
        Self {
            height,
            reach: 1e-3,
            stiffness: 1e3,
            t: [0.0; 2],
            progress: 1.0,
        }
    }

    fn travel(&self) -> f64 {
        (self.height)(self.t[1]) - (self.height)(self.t[0])
    }

    fn floor(&self) -> f64 {
        (self.height)(self.t[0]) + self.progress * self.travel()
    }

    /// Value and derivatives of the barrier of each vertex in reach.
    fn active<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = (usize, [f64; 3])> + 'a {
        let (r, k) = (self.reach, self.stiffness);
        (0..x.len() / 3).filter_map(move |v| {
            let d = x[3 * v + 2] - self.floor();
            if d >= r {
                return None;
            }
            if d <= 0.0 {
                return Some((v, [f64::INFINITY, f64::NAN, f64::NAN]));
            }
            let (u, ln) = (d - r, (d / r).ln());
            let slope = -k * (2.0 * u * ln + u * u / d);
            let curvature = -k * (2.0 * ln + 4.0 * u / d - u * u / (d * d));
            Some((v, [-k * u * u * ln, slope, curvature]))
        })
    }
}

impl Contact for Floor {
    fn begin(&mut self, t0: f64, h: f64, _: &[f64]) {
        self.t = [t0, t0 + h];
        self.progress = if self.travel() == 0.0 { 1.0 } else { 0.0 };
    }

    fn progress(&self) -> f64 {
        self.progress
    }

    fn safe_fraction(&mut self, x: &[f64], dx: &[f64]) -> f64 {
        let rise = (1.0 - self.progress) * self.travel();
        (0..x.len() / 3).fold(1.0, |a: f64, v| {
            let (gap, approach) = (x[3 * v + 2] - self.floor(), rise - dx[3 * v + 2]);
            if approach > 0.9 * gap {
                a.min(0.9 * gap / approach)
            } else {
                a
            }
        })
    }

    fn advance(&mut self, fraction: f64) {
        self.progress = if fraction == 1.0 {
            1.0
        } else {
            self.progress + fraction * (1.0 - self.progress)
        };
    }

    fn energy(&self, x: &[f64]) -> f64 {
        self.active(x).map(|(_, b)| b[0]).sum()
    }

    fn add_gradient(&self, x: &[f64], scale: f64, out: &mut [f64]) {
        for (v, b) in self.active(x) {
            out[3 * v + 2] += scale * b[1];
        }
    }

    fn add_drive(&self, x: &[f64], scale: f64, out: &mut [f64]) {
        for (v, b) in self.active(x) {
            out[3 * v + 2] -= scale * b[2] * (1.0 - self.progress) * self.travel();
        }
    }

    fn add_hessian(&self, x: &[f64], sink: &mut dyn CouplingSink) {
        for (v, b) in self.active(x) {
            let z = Vector3::z();
            sink.add(v as u32, v as u32, &(b[2] * z * z.transpose()));
        }
    }

    fn couplings(&self, _: &[f64], out: &mut Vec<[u32; 2]>) {
        out.clear();
    }

    fn relag(&mut self, _: &[f64]) -> f64 {
        0.0
    }

    fn finish(&mut self, x1: &[f64]) -> ContactWork {
        let force: f64 = self.active(x1).map(|(_, b)| -b[1]).sum();
        ContactWork {
            bodies: force * self.travel(),
            ..ContactWork::default()
        }
    }

    fn potential(&self, x: &[f64]) -> f64 {
        self.energy(x)
    }

    fn gap(&self, x: &[f64]) -> f64 {
        (0..x.len() / 3).fold(f64::INFINITY, |m, v| m.min(x[3 * v + 2] - self.floor()))
    }

    fn loads(&self, x: &[f64]) -> Vec<BodyLoad> {
        let force: f64 = self.active(x).map(|(_, b)| b[1]).sum();
        vec![BodyLoad {
            force: force * Vector3::z(),
            torque: Vector3::zeros(),
        }]
    }

    fn activation(&self) -> f64 {
        self.reach
    }

    fn contact_points(&self, _: &[f64], out: &mut Vec<ContactPoint>) {
        out.clear();
    }

    fn check_start(&mut self, _: &SheetModel, _: &State) -> Result<(), ContactError> {
        Ok(())
    }
}

/// A sheet of 1 m and 0.1 kg, shifted by `z`.
fn sheet(level: u32, z: f64) -> (Sheet, State) {
    let sheet = generate::isotropic_square(level, 1.0).unwrap();
    let mut x = sheet.positions().to_vec();
    x.iter_mut().skip(2).step_by(3).for_each(|x| *x += z);
    (sheet, State::at_rest(x))
}

fn model(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .unwrap()
        .with_gravity()
}

#[test]
fn a_flat_sheet_lands_and_lies_still() {
    let (sheet, start) = sheet(2, 5e-3);
    let model = model(&sheet).with_damping(10.0).unwrap();
    let mut simulation = Simulation::new(model, start, Method::default())
        .unwrap()
        .with_contact(Floor::new(|_| 0.0))
        .unwrap();
    let mut report = simulation.step(1.0 / 120.0).unwrap();
    for _ in 0..360 {
        report = simulation.step(1.0 / 120.0).unwrap();
        assert!(report.gap.unwrap() > 0.0 && report.strain < 1e-12);
    }
    assert!(report.kinetic < 1e-9 * 0.1 * 9.8 * 5e-3, "{report:?}");
    // The floor carries the weight. A flat sheet gives way to a force across it by the root of its length error
    // only: forces at rest are known to a percent.
    let load = simulation.body_loads()[0].force.z;
    assert!((load / (-0.1 * 9.8) - 1.0).abs() < 0.01, "{load}");
}

#[test]
fn a_sheet_hung_at_a_corner_drapes_on_the_floor() {
    for level in [1, 2, 3] {
        let (sheet, start) = sheet(level, 0.3);
        let last = VertexId(sheet.topology().vertex_count() as u32 - 1);
        let model = model(&sheet)
            .with_damping(2.0)
            .unwrap()
            .with_pins(&[last])
            .unwrap();
        let mut simulation = Simulation::new(model, start, Method::default())
            .unwrap()
            .with_contact(Floor::new(|_| 0.0))
            .unwrap();
        for _ in 0..60 {
            let report = simulation.step(1.0 / 60.0).unwrap();
            assert!(report.gap.unwrap() > 0.0 && report.strain < 1e-12);
        }
        let lowest = simulation
            .state()
            .x
            .iter()
            .skip(2)
            .step_by(3)
            .fold(1.0_f64, |m, z| m.min(*z));
        assert!(lowest < 1e-3, "nothing reached the floor: {lowest}");
    }
}

#[test]
fn a_fast_floor_does_not_tunnel() {
    // 10 m/s through a gap of 1 mm.
    let (sheet, start) = sheet(2, 1e-3);
    let model = model(&sheet);
    let mut simulation = Simulation::new(model, start, Method::default())
        .unwrap()
        .with_contact(Floor::new(|t| 10.0 * t))
        .unwrap();
    for _ in 0..6 {
        let report = simulation.step(1.0 / 60.0).unwrap();
        assert!(report.gap.unwrap() > 0.0 && report.strain < 1e-12);
    }
}

#[test]
fn methods_without_room_for_contact_say_so() {
    let (sheet, start) = sheet(1, 1.0);
    let method = Method::EnergyMomentum(crate::EnergyMomentumOptions::default());
    let simulation = Simulation::new(model(&sheet), start, method).unwrap();
    let refused = simulation.with_contact(Floor::new(|_| 0.0));
    assert!(matches!(
        refused.map(|_| ()),
        Err(crate::SimulationError::Contact(ContactError::Method))
    ));
}
