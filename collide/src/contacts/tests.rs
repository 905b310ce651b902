//! Tests of the whole contact potential and of its guarantee.

mod derivatives;
mod round;
mod safety;
mod start;

use super::*;
use crate::{Coefficients, Keyframe, Stiffness};
use isosheet_dynamics::contact::BodyMotions;
use isosheet_dynamics::contact::internals::{
    BarrierPotential, ContactSet, ContactTerms, CouplingSink, Course, LaggedFriction,
};
use isosheet_geometry::{
    ContactGeometry, Form, Shape, ShapeError, SignedDistance, TriangleSurface, Triangles,
};
use isosheet_mesh::{MassKind, Sheet, generate};
use nalgebra::{Isometry3, Matrix3};
use std::sync::Arc;

fn sheet(level: u32) -> Sheet {
    generate::isotropic_square(level, 1.0).unwrap()
}

fn model(sheet: &Sheet) -> SheetModel {
    SheetModel::new(sheet, 0.1, MassKind::Lumped)
        .unwrap()
        .with_gravity()
}

#[test]
fn contact_in_one_call_has_all_obstacles_and_the_sheet_itself() {
    let model = model(&sheet(1));
    let floor = |z| Obstacle::at(Shape::HalfSpace, [0.0, 0.0, z]).unwrap();
    let friction = Friction::from(Coefficients::equal(0.3));
    let contacts =
        Contacts::for_sheet(&model, [floor(-1.0), floor(-2.0)], friction.clone()).unwrap();
    assert_eq!(*contacts.options(), ContactOptions::for_sheet(&model));
    assert!(contacts.has_self_contact);
    assert_eq!(contacts.laws.itself, friction);
    assert_eq!(contacts.laws.bodies, [friction.clone(), friction]);
    assert_eq!(contacts.bodies().len(), 2);
    let negative = Contacts::for_sheet(&model, [], Coefficients::equal(-0.1));
    assert!(matches!(negative, Err(ContactsError::Friction(_))));
}

fn options(model: &SheetModel, activation: f64) -> ContactOptions {
    ContactOptions {
        activation,
        stiffness: Stiffness::Joules(2.0),
        segments: 12,
        ..ContactOptions::for_sheet(model)
    }
}

/// A roof of two triangles: open.
fn roof() -> Shape {
    let x = [
        -0.3, -0.2, -0.1, 0.3, -0.2, -0.1, 0.3, 0.0, 0.1, -0.3, 0.0, 0.1, 0.3, 0.2, -0.1, -0.3,
        0.2, -0.1,
    ];
    let faces = [[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]];
    Shape::Surface(Arc::new(TriangleSurface::new(&x, &faces).unwrap()))
}

/// A closed surface.
fn tetrahedron() -> Shape {
    let x = [
        0.0, 0.0, 0.2, 0.2, 0.0, -0.1, -0.1, 0.2, -0.1, -0.1, -0.2, -0.1,
    ];
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    Shape::Surface(Arc::new(TriangleSurface::new(&x, &faces).unwrap()))
}

/// Every kind of body, with the height of its top above its origin in the pose of [`tilted`].
fn shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("half-space", Shape::HalfSpace),
        (
            "cuboid",
            Shape::Cuboid {
                half: [0.2, 0.15, 0.1],
            },
        ),
        ("sphere", Shape::Sphere { radius: 0.2 }),
        (
            "cylinder",
            Shape::Cylinder {
                radius: 0.15,
                half_height: 0.2,
            },
        ),
        (
            "capsule",
            Shape::Capsule {
                radius: 0.1,
                half_length: 0.2,
            },
        ),
        ("roof", roof()),
        ("tetrahedron", tetrahedron()),
        ("rounded box", rounded_box()),
    ]
}

/// A box whose edges and corners are rounded, as a program describes it.
#[derive(Debug)]
struct Rounded {
    core: Shape,
    radius: f64,
}

impl Form for Rounded {
    fn name(&self) -> &'static str {
        "rounded box"
    }

    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        let of_core = self.core.signed_distance(p);
        let value = of_core.value - self.radius;
        SignedDistance { value, ..of_core }
    }

    fn triangles(&self, sides: usize) -> Result<Option<Triangles>, ShapeError> {
        self.core.triangles(sides)
    }

    fn contact_geometry(&self, segments: usize) -> Result<Option<ContactGeometry>, ShapeError> {
        let of_core = self.core.contact_geometry(segments)?;
        let radius = self.radius;
        Ok(of_core.map(|of_core| ContactGeometry { radius, ..of_core }))
    }

    fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        let [low, high] = self.core.bounds()?;
        Some([low.add_scalar(-self.radius), high.add_scalar(self.radius)])
    }

    fn is_convex(&self) -> bool {
        true
    }
}

fn rounded_box() -> Shape {
    let half = [0.15, 0.1, 0.05];
    let (core, radius) = (Shape::Cuboid { half }, 0.05);
    Shape::Other(Arc::new(Rounded { core, radius }))
}

/// Height of a body's highest point in a pose.
fn top(shape: &Shape, pose: &Isometry3<f64>) -> f64 {
    let Some(geometry) = shape.contact_geometry(12).unwrap() else {
        return pose.translation.vector.z;
    };
    let points = geometry.positions.as_chunks::<3>().0.iter();
    let heights = points.map(|p| (pose * nalgebra::Point3::from(*p)).z);
    heights.fold(f64::NEG_INFINITY, f64::max) + geometry.radius
}

/// A sheet bent over a body: the flat sheet over the origin with its lowest parts `gap` above the
/// body's top, waves of amplitude `wave`, and an irregular part that leaves no two edges parallel.
fn waves(sheet: &Sheet, height: f64, wave: f64) -> Vec<f64> {
    let mut x = sheet.positions().to_vec();
    for (i, p) in x.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        let (u, v) = (p[0] - 0.51, p[1] - 0.47);
        let bump = (7.0 * u).cos() * (5.0 * v + 0.3).cos();
        let odd = (12.9898 * (i as f64 + 1.0)).sin() * 43_758.547;
        let odd = odd - odd.floor();
        *p = [
            u + 0.02 * odd,
            v - 0.03 * odd * odd,
            height + wave * (1.0 - bump) * 0.5 + 0.3 * wave * odd,
        ];
    }
    x
}

fn fixed(shape: Shape, pose: Isometry3<f64>) -> Obstacle {
    Obstacle::fixed(shape, pose).unwrap()
}

fn moving(shape: Shape, from: Isometry3<f64>, to: Isometry3<f64>, h: f64) -> Obstacle {
    let keys = vec![Keyframe { t: 0.0, pose: from }, Keyframe { t: h, pose: to }];
    Obstacle::new(shape, keys).unwrap()
}

/// A dense Hessian that collects blocks.
struct Dense {
    n: usize,
    values: Vec<f64>,
    pairs: Vec<[u32; 2]>,
}

impl Dense {
    fn new(n: usize) -> Self {
        Self {
            n,
            values: vec![0.0; n * n],
            pairs: Vec::new(),
        }
    }

    fn matrix(&self) -> nalgebra::DMatrix<f64> {
        nalgebra::DMatrix::from_vec(self.n, self.n, self.values.clone())
    }
}

impl CouplingSink for Dense {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        assert!(a <= b);
        self.pairs.push([a, b]);
        for r in 0..3 {
            for c in 0..3 {
                let (i, j) = (3 * a as usize + r, 3 * b as usize + c);
                self.values[i + self.n * j] += block[(r, c)];
                if a != b {
                    self.values[j + self.n * i] += block[(r, c)];
                }
            }
        }
    }
}

/// A step in progress: the values that an iteration works with.
struct Step {
    contacts: Contacts,
    barrier: BarrierPotential,
    bodies: BodyMotions,
    s: f64,
    set: ContactSet,
    friction: LaggedFriction,
}

impl Step {
    /// Starts a step of `h` seconds at positions `x` at time 0, friction lagged there.
    fn begin(mut contacts: Contacts, model: &SheetModel, h: f64, x: &[f64]) -> Self {
        let start = State::at_rest(x.to_vec());
        contacts.check_start(model, &start).unwrap();
        let barrier = BarrierPotential::at_start(contacts.laws(), model, &start).unwrap();
        let bodies = BodyMotions::over(&contacts, StepSpan { t0: 0.0, h });
        let s = bodies.first_progress();
        let zero = vec![0.0; x.len()];
        let set = ContactSet::of(&mut contacts, motion(&bodies, [s; 2], x, &zero));
        let mut step = Self {
            contacts,
            barrier,
            bodies,
            s,
            set,
            friction: LaggedFriction::none(),
        };
        let active = step.active(x);
        step.friction.lag(
            step.contacts.laws(),
            &barrier,
            &active,
            Course::from_start(x, h),
            x,
        );
        step
    }

    /// Checks a motion from `x` with the bodies going on to the ends of theirs.
    fn query(&mut self, x: &[f64], dx: &[f64]) -> f64 {
        let motion = motion(&self.bodies, [self.s, 1.0], x, dx);
        self.set.update(&mut self.contacts, motion);
        self.set.safe_fraction()
    }

    fn advance(&mut self, fraction: f64) {
        self.s = if fraction == 1.0 {
            1.0
        } else {
            self.s + fraction * (1.0 - self.s)
        };
    }

    fn active(&self, x: &[f64]) -> ActiveContacts {
        ActiveContacts::at(&self.contacts, &self.set, self.s, x)
    }

    fn gap(&self, x: &[f64]) -> f64 {
        self.active(x).gap()
    }

    /// What `look` sees of the contact terms at `x`.
    fn terms<T>(&self, x: &[f64], look: impl FnOnce(ContactTerms<'_>) -> T) -> T {
        look(ContactTerms {
            x,
            active: &self.active(x),
            barrier: &self.barrier,
            friction: &self.friction,
        })
    }

    fn energy(&self, x: &[f64]) -> f64 {
        self.terms(x, |t| t.energy())
    }

    fn gradient(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        self.terms(x, |t| t.add_gradient(1.0, &mut out));
        out
    }

    fn hessian(&self, x: &[f64]) -> Dense {
        let mut out = Dense::new(x.len());
        self.terms(x, |t| t.add_hessian(&mut out));
        out
    }
}

fn motion<'a>(
    bodies: &'a BodyMotions,
    progress: [f64; 2],
    x: &'a [f64],
    dx: &'a [f64],
) -> JointMotion<'a> {
    JointMotion {
        bodies,
        progress,
        x,
        dx,
    }
}

fn largest(list: &[f64]) -> f64 {
    list.iter().fold(0.0, |m, v| m.max(v.abs()))
}
