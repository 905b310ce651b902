//! An elastic strip that is clamped at one end and held at the other in all the ways that there are.

use isosheet_dynamics::constraint::{Line, Plane, Side, Sphere};
use isosheet_dynamics::{
    ElasticSheet, PlateBending, PlateStiffness, PointProfile, Profile, RigidDisplacement,
    SheetModel, VertexConstraint, VertexLoad,
};
use isosheet_mesh::generate::{Diagonals, grid};
use isosheet_mesh::{MassKind, Sheet, VertexId};

const COLUMNS: usize = 12;
const LENGTH: f64 = 0.12;
const WIDTH: f64 = 0.02;
/// Mass, kilograms.
const MASS: f64 = 3e-4;
/// Gravity, metres per second squared.
pub const G: f64 = 9.8;
/// Length of a step, seconds.
pub const STEP: f64 = 1.0 / 240.0;
/// Number of steps.
pub const STEPS: usize = 60;

/// What holds one end; the other one is clamped by the pins of two lines of vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// Nothing.
    Clamped,
    /// Pins that lift it and move it back.
    MovingPins,
    /// A level plane.
    OnPlane,
    /// A level plane that rises.
    OnMovingPlane,
    /// A slanting plane that rises.
    OnTiltedMovingPlane,
    /// A sphere.
    OnSphere,
    /// A slanting line.
    OnLine,
    /// A level plane that holds it from below alone.
    OverPlane,
    /// Such a plane, which rises.
    OverRisingPlane,
}

/// All of them.
pub const HELD: [Held; 9] = [
    Held::Clamped,
    Held::MovingPins,
    Held::OnPlane,
    Held::OnMovingPlane,
    Held::OnTiltedMovingPlane,
    Held::OnSphere,
    Held::OnLine,
    Held::OverPlane,
    Held::OverRisingPlane,
];

/// The strip, flat.
pub fn strip() -> Sheet {
    grid(COLUMNS, 2, LENGTH, WIDTH, Diagonals::UnionJack).expect("a strip")
}

fn column(k: usize) -> impl Iterator<Item = VertexId> {
    (0..3).map(move |row| VertexId::from_index(k + row * (COLUMNS + 1)))
}

/// From 0 to `to` within the run.
fn rise(to: f64) -> Profile {
    Profile::SmoothStep {
        from: 0.0,
        to,
        begin: 0.0,
        end: STEP * STEPS as f64,
    }
}

/// The strip under its weight and a load that grows, of a stiffness in its plane in newtons per metre.
///
/// # Panics
/// If the stiffness is not positive.
pub fn held_strip(held: Held, stiffness: f64) -> SheetModel {
    let sheet = strip();
    let clamp: Vec<VertexId> = column(0).chain(column(1)).collect();
    let tip = || column(COLUMNS);
    let law = PlateStiffness {
        rigidity: 2e-4,
        poisson: 0.3,
    };
    let plate = PlateBending::clamped(&sheet, law, &clamp).expect("a plate");
    let elastic = ElasticSheet::new(&sheet, stiffness, 0.3)
        .expect("a sheet")
        .beside(&sheet, &plate);
    let load = VertexLoad::new(
        sheet.topology(),
        &[VertexId(COLUMNS as u32 / 2)],
        [0.3, 0.2, 1.0],
        rise(1e-3),
    );
    let mut model = SheetModel::new(&sheet, MASS, MassKind::Lumped)
        .expect("a model")
        .with_acceleration([0.0, 0.0, -G])
        .with_force(load.expect("a load"))
        .with_pins(&clamp)
        .expect("pins")
        .with_potential(plate)
        .with_elastic_sheet(elastic)
        .expect("a sheet");
    if held == Held::MovingPins {
        for v in tip() {
            let motion = PointProfile {
                offset: sheet.position(v),
                x: rise(-0.01),
                z: rise(0.02),
                ..PointProfile::default()
            };
            model = model.with_moving_pin(v, motion).expect("a pin");
        }
        return model;
    }
    for v in tip() {
        let [x, y, z] = sheet.position(v);
        let plane = |normal: [f64; 3]| Plane::new([x, y, z], normal).expect("a plane");
        let up = [0.0, 0.0, 1.0];
        let moving = |constraint: VertexConstraint, to: f64| {
            constraint.moving(RigidDisplacement {
                z: rise(to),
                ..RigidDisplacement::default()
            })
        };
        let constraint = match held {
            Held::Clamped | Held::MovingPins => continue,
            Held::OnPlane => VertexConstraint::on_surface(v, plane(up), Side::On),
            Held::OnMovingPlane => {
                moving(VertexConstraint::on_surface(v, plane(up), Side::On), 0.03)
            }
            Held::OnTiltedMovingPlane => moving(
                VertexConstraint::on_surface(v, plane([0.5, 0.1, 1.0]), Side::On),
                0.03,
            ),
            Held::OnSphere => {
                let centre = [x - 0.03, y, z - 0.04];
                let sphere = Sphere::new(centre, 0.05).expect("a sphere");
                VertexConstraint::on_surface(v, sphere, Side::On)
            }
            Held::OnLine => {
                let line = Line::new([x, y, z], [1.0, 0.0, 0.3]).expect("a line");
                VertexConstraint::on_curve(v, line)
            }
            Held::OverPlane => VertexConstraint::on_surface(v, plane(up), Side::Outside),
            Held::OverRisingPlane => moving(
                VertexConstraint::on_surface(v, plane(up), Side::Outside),
                0.03,
            ),
        };
        model = model.with_constraint(constraint).expect("a vertex");
    }
    model
}
