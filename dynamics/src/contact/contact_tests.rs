//! Contact in the step, with the simplest body there is: a floor that the vertices stay above.

use crate::contact::{
    ActiveContact, ActiveContacts, BodyMotion, BodyMotions, BodyPlace, Contact, ContactError,
    ContactKey, ContactKind, ContactLaws, ContactSet, JointMotion, StepMotion, StepSpan, Stiffness,
};
use crate::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet, VertexId, generate};
use nalgebra::{Isometry3, Vector3};

/// A floor at height `z(t)` below all vertices.
pub(crate) struct Floor {
    height: fn(f64) -> f64,
    laws: ContactLaws,
}

impl Floor {
    pub(crate) fn new(height: fn(f64) -> f64) -> Self {
        Self {
            height,
            laws: ContactLaws {
                stiffness: Stiffness::Joules(2e-4),
                ..ContactLaws::frictionless(1e-3)
            },
        }
    }

    fn pose(&self, t: f64) -> Isometry3<f64> {
        Isometry3::translation(0.0, 0.0, (self.height)(t))
    }
}

fn key(v: usize) -> ContactKey {
    ContactKey {
        body: Some(0),
        kind: ContactKind::Vertex,
        pair: [v as u32, 0],
    }
}

impl Contact for Floor {
    fn laws(&self) -> &ContactLaws {
        &self.laws
    }

    fn body_motions(&self, span: StepSpan, out: &mut Vec<BodyMotion>) {
        let motion = StepMotion::new(self.pose(span.t0), self.pose(span.t0 + span.h));
        out.push(BodyMotion {
            material: motion,
            surface: motion,
        });
    }

    fn query(&mut self, motion: JointMotion<'_>, pairs: &mut Vec<ContactKey>) -> f64 {
        let body = &motion.bodies.list()[0].surface;
        let [floor, end] = motion.progress.map(|s| body.pose(s).translation.z);
        // Backwards: the order makes no difference.
        (0..motion.x.len() / 3).rev().fold(1.0, |a: f64, v| {
            pairs.push(key(v));
            let i = 3 * v + 2;
            let (gap, approach) = (motion.x[i] - floor, end - floor - motion.dx[i]);
            if approach > 0.9 * gap {
                a.min(0.9 * gap / approach)
            } else {
                a
            }
        })
    }

    fn evaluate(
        &self,
        pairs: &[ContactKey],
        x: &[f64],
        bodies: &[BodyPlace],
        out: &mut Vec<ActiveContact>,
    ) {
        for key in pairs {
            let [v, _] = key.pair;
            let i = 3 * v as usize;
            let gap = x[i + 2] - bodies[0].origin().z;
            if gap < self.laws.activation {
                out.push(ActiveContact {
                    key: *key,
                    vertices: [v; 4],
                    weights: [1.0, 0.0, 0.0, 0.0],
                    normal: Vector3::z(),
                    gap,
                    closest: Vector3::new(x[i], x[i + 1], bodies[0].origin().z),
                    parallel: None,
                    rolling: None,
                    round: [None; 2],
                });
            }
        }
    }

    fn check_start(&mut self, _: &SheetModel, _: &State) -> Result<(), ContactError> {
        Ok(())
    }
}

/// A sheet of 1 m and 0.1 kg, shifted by `z`.
pub(crate) fn sheet(level: u32, z: f64) -> (Sheet, State) {
    let sheet = generate::isotropic_square(level, 1.0).unwrap();
    let mut x = sheet.positions().to_vec();
    x.iter_mut().skip(2).step_by(3).for_each(|x| *x += z);
    (sheet, State::at_rest(x))
}

/// That sheet under gravity.
pub(crate) fn model(sheet: &Sheet) -> SheetModel {
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
    // The floor carries the weight. The displacement of a flat sheet by a perpendicular force is only the
    // square root of its length error: forces at rest are known to a percent.
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

/// A set does not depend on the order in which pairs are found, and knows a motion that is not finite.
#[test]
fn sets_are_sorted_and_refuse_what_is_not_finite() {
    let mut floor = Floor::new(|t| t);
    let span = StepSpan { t0: 1.0, h: 0.5 };
    let bodies = BodyMotions::over(&floor, span);
    assert!(bodies.any_moves() && bodies.first_progress() == 0.0);
    assert_eq!(bodies.time(0.5), 1.25);
    let x = [0.0, 0.0, 1.0005, 1.0, 0.0, 1.2, 0.0, 1.0, 2.0];
    let dx = [0.0; 9];
    let motion = |dx| JointMotion {
        bodies: &bodies,
        progress: [0.0, 1.0],
        x: &x,
        dx,
    };
    let mut set = ContactSet::of(&mut floor, motion(&dx));
    assert_eq!(set.pairs(), [key(0), key(1), key(2)]);
    assert!((set.safe_fraction() - 0.9 * 0.0005 / 0.5).abs() < 1e-12);
    let active = ActiveContacts::at(&floor, &set, 0.0, &x);
    assert_eq!(active.list().len(), 1);
    assert!((active.gap() - 0.0005).abs() < 1e-12 && active.time() == 1.0);
    // The floor has risen through the first vertex.
    assert!(ActiveContacts::at(&floor, &set, 0.01, &x).gap() < 0.0);
    let mut broken = dx;
    broken[4] = f64::NAN;
    set.update(&mut floor, motion(&broken));
    assert_eq!(set.safe_fraction(), 0.0);
    let active = ActiveContacts::at(&floor, &set, 0.0, &broken);
    assert!(active.gap().is_nan());
}
