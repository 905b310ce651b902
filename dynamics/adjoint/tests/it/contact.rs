//! Gradients of runs in contact.

use crate::support::{bdf2, checked, checked_with};
use isosheet_adjoint::{AdjointOptions, Plan, Run, Scene, SceneError, coordinate};
use isosheet_collide::{Coefficients, Contacts, Obstacle, Shape};
use isosheet_dynamics::contact::SurfacePoints;
use isosheet_dynamics::{ElasticSheet, Material, RigidBody, SheetModel, State};
use isosheet_mesh::{MassKind, MassMatrix, Sheet, VertexId, generate};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// A square over a ball, with its middle just above it.
fn above_a_ball(n: usize) -> Result<Sheet, SceneError> {
    let square = generate::delaunay_square(0.2, 0.2 / n as f64, 2)?;
    Ok(square.map_positions(|[x, y, _]| [x - 0.1, y - 0.1, 0.0503 + 0.01 * x * x])?)
}

/// A membrane falls on a ball without friction: gravity, the height of the ball.
#[test]
fn a_membrane_on_a_ball() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = above_a_ball(5)?;
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_acceleration([0.0, 0.0, -p[0]])
            .with_elastic_sheet(ElasticSheet::new(&sheet, 300.0, 0.3)?)?;
        let ball = Obstacle::at(Shape::Sphere { radius: 0.05 }, [0.0, 0.003, p[1]])?;
        let contacts = Contacts::for_sheet(&model, [ball], Coefficients::FRICTIONLESS)?;
        let start = State::at_rest(sheet.positions().to_vec());
        Ok(Scene::new(model, start).with_contact(contacts))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 12);
    let loss = coordinate(0, 2, 12);
    let options = AdjointOptions {
        sizes: vec![9.8, 1e-4],
        ..AdjointOptions::default()
    };
    let name = "membrane on a ball";
    checked_with(options, name, &family, &[9.8, 0.0], &plan, &loss, 1e-3);
}

/// Paper falls on a ball with friction: gravity, the coefficient, the speed of the ball.
#[test]
fn paper_drapes_over_a_ball_with_friction() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = above_a_ball(5)?;
        let paper = Material::office_paper();
        let model = SheetModel::of_material(&sheet, &paper)
            .build()?
            .with_acceleration([0.5, 0.0, -p[0]]);
        let speed = p[2];
        let motion = isosheet_dynamics::RigidMotion::from(move |t: f64| {
            Isometry3::translation(0.0, 0.003, speed * t)
        });
        let ball = Obstacle::new(Shape::Sphere { radius: 0.05 }, motion)?;
        let contacts = Contacts::for_sheet(&model, [ball], Coefficients::equal(p[1]))?;
        let start = State::at_rest(sheet.positions().to_vec());
        Ok(Scene::new(model, start).with_contact(contacts))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 12);
    let loss = coordinate(0, 0, 12);
    let numbers = [9.8, 0.3, 0.01];
    checked("paper on a ball", &family, &numbers, &plan, &loss, 1e-3);
}

/// A shell of rods slides down a plane with friction.
#[test]
fn rods_slide_down_a_plane() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let square = generate::isotropic_square(1, 0.1)?;
        let sheet =
            square.map_positions(|[x, y, _]| [x, y, 3.0 * x * (x - 0.03) + 2.0 * y * y + 8e-3])?;
        let model =
            SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?.with_acceleration([p[2], 0.0, -p[0]]);
        let floor = Obstacle::at(Shape::HalfSpace, [0.0, 0.0, 0.0])?;
        let contacts = Contacts::for_sheet(&model, [floor], Coefficients::equal(p[1]))?;
        let start = State::at_rest(sheet.positions().to_vec());
        Ok(Scene::new(model, start).with_contact(contacts))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 10);
    let loss = coordinate(7, 0, 10);
    checked(
        "rods on a plane",
        &family,
        &[9.8, 0.2, 4.0],
        &plan,
        &loss,
        1e-3,
    );
}

/// A patch falls on another one that is held by its corners: contact of the sheet with itself.
#[test]
fn a_patch_falls_on_another() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let lower = generate::isotropic_square(1, 0.1)?;
        let upper = generate::delaunay_square(0.05, 0.017, 4)?;
        let upper = upper.map_positions(|[x, y, _]| [x + 0.021, y + 0.027, 2e-4 + 0.01 * x])?;
        let both = Sheet::union(&[&lower, &upper])?;
        let inside = 1e-9..=0.0999;
        let is_end = |c: f64| !inside.contains(&c);
        let held = both.vertices_where(|[x, y, z]| z == 0.0 && is_end(x) && is_end(y));
        let model = SheetModel::new(&both, 4e-3, MassKind::Lumped)?
            .with_acceleration([1.0, 0.0, -p[0]])
            .with_pins(&held)?
            .with_elastic_sheet(ElasticSheet::new(&both, p[2], 0.3)?)?;
        let contacts = Contacts::for_sheet(&model, [], Coefficients::equal(p[1]))?;
        let start = State::at_rest(both.positions().to_vec());
        Ok(Scene::new(model, start).with_contact(contacts))
    };
    let plan = Plan::steps(bdf2(), 2e-3, 10);
    let loss = coordinate(30, 0, 10);
    let numbers = [9.8, 0.2, 300.0];
    checked("a patch on another", &family, &numbers, &plan, &loss, 1e-3);
}

const FACES: [[u32; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

/// A block over an inclined plane: gravity, friction, its mass; `above` is the distance from the plane,
/// metres.
fn block(p: &[f64], above: f64) -> Result<Scene, SceneError> {
    let plane = Isometry3::rotation(Vector3::new(0.0, 0.5, 0.0));
    let pose = plane
        * Isometry3::new(
            Vector3::new(0.0, 0.0, 0.025 + above),
            Vector3::new(0.002, 0.001, 0.0),
        );
    let sides = Vector3::new(0.1, 0.08, 0.05);
    let own = Matrix3::from_diagonal(&sides.map(|a| p[2] * a * a / 12.0));
    let turn = pose.rotation.to_rotation_matrix().into_inner();
    let moments = turn * own * turn.transpose();
    let moments = 0.5 * (moments + moments.transpose());
    let body = RigidBody::new(p[2], pose.translation.vector.into(), moments.into())?;
    let corner = |i: u32| -> [f64; 3] {
        let sign = |k: u32| if i >> k & 1 == 0 { -0.5 } else { 0.5 };
        let local = Vector3::new(sign(0), sign(1), sign(2)).component_mul(&sides);
        (pose * Point3::from(local)).into()
    };
    let surface = Sheet::new((0..8).flat_map(corner).collect(), &FACES)?;
    let tetrahedron = body.tetrahedron();
    let masses = MassMatrix::from_vertex_masses(body.mass_matrix().vertex)?;
    let model = SheetModel::with_mass(&tetrahedron, masses)?.with_acceleration([0.0, 0.0, -p[0]]);
    let corners = surface.positions().as_chunks::<3>().0.iter();
    let carried = corners.map(|p| body.carried(*p, VertexId(0)));
    let points = SurfacePoints::new(4, 0, carried.collect())?;
    let options = isosheet_collide::ContactOptions::for_surface(&surface, &points);
    let floor = Obstacle::fixed(Shape::HalfSpace, plane)?;
    let contacts = Contacts::on_surface(&surface, points, options)?
        .with_body(floor, Coefficients::equal(p[1]))?;
    let start = State::at_rest(tetrahedron.positions().to_vec());
    Ok(Scene::new(model, start).with_contact(contacts))
}

/// A block that responds slides down an inclined plane, and turns: gravity, friction, its mass.
#[test]
fn a_block_slides_down_an_inclined_plane() {
    let plan = Plan::steps(bdf2(), 4e-3, 12);
    let loss = coordinate(0, 0, 12);
    let name = "a block on a plane";
    checked(
        name,
        &|p: &[f64]| block(&[p[0], p[1], 0.5], 6e-4),
        &[9.8, 0.2],
        &plan,
        &loss,
        1e-3,
    );
    // The motion does not depend on the mass, but by the barrier, which carries it alike.
    let family = |p: &[f64]| block(p, 6e-4);
    let run = Run::record(&family, &[9.8, 0.2, 0.5], plan, AdjointOptions::default());
    let gradient = run.expect("a run").gradient(&loss).expect("a gradient");
    assert!(
        gradient.of_numbers[2].abs() < 1e-10,
        "{:?}",
        gradient.of_numbers
    );
}

/// Two blocks of which one moves towards the other by `speed`, metres per second.
fn two_blocks(speed: f64) -> Result<Scene, SceneError> {
    let (side, gap) = (0.05, 8e-3);
    let moments = Matrix3::from_diagonal_element(0.5 * side * side / 6.0);
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let (mut sheets, mut masses, mut carried) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..2u32 {
        // (Turned a little, so that a corner meets a face.)
        let turn = 0.1 * f64::from(k);
        let pose = Isometry3::new(
            Vector3::new(0.0, 0.0, f64::from(k) * (side + gap)),
            Vector3::new(turn, 0.5 * turn, 0.0),
        );
        let body = RigidBody::new(0.5, pose.translation.vector.into(), moments.into())?;
        let corner = |i: u32| -> [f64; 3] {
            let sign = |axis: u32| if i >> axis & 1 == 0 { -0.5 } else { 0.5 };
            (pose * Point3::from(side * Vector3::new(sign(0), sign(1), sign(2)))).into()
        };
        let own: Vec<[f64; 3]> = (0..8).map(corner).collect();
        carried.extend(own.iter().map(|p| body.carried(*p, VertexId(4 * k))));
        corners.extend(own.into_iter().flatten());
        faces.extend(FACES.map(|face| face.map(|v| v + 8 * k)));
        sheets.push(body.tetrahedron());
        masses.push(MassMatrix::from_vertex_masses(body.mass_matrix().vertex)?);
    }
    let surface = Sheet::new(corners, &faces)?;
    let both = Sheet::union(&[&sheets[0], &sheets[1]])?;
    let model = SheetModel::with_mass(&both, MassMatrix::union(&masses))?;
    let points = SurfacePoints::new(8, 0, carried)?;
    let options = isosheet_collide::ContactOptions::for_surface(&surface, &points);
    let contacts = Contacts::on_surface(&surface, points, options)?
        .with_self_contact(Coefficients::FRICTIONLESS)?
        .with_parts(&[0..8, 8..16], []);
    let mut v = vec![0.0; 24];
    v[12..]
        .iter_mut()
        .skip(2)
        .step_by(3)
        .for_each(|v| *v = -speed);
    let start = State::moving(both.positions().to_vec(), v);
    Ok(Scene::new(model, start).with_contact(contacts))
}

/// Two blocks meet, and turn.
#[test]
fn two_blocks_meet() {
    let family = |p: &[f64]| two_blocks(p[0]);
    let plan = Plan::steps(bdf2(), 1e-2, 6);
    let loss = coordinate(0, 2, 6);
    checked("two blocks", &family, &[0.5], &plan, &loss, 1e-3);
}

/// A strip whose end is held by a cylinder that turns rolls up on it, with friction on itself: the speed of
/// the turn, the coefficient, gravity.
#[test]
fn a_strip_rolls_up() {
    let (radius, length, cells) = (0.01, 0.1, 20);
    let gap = 3e-4;
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let grid = generate::anisotropic_grid(cells, 2, length, 0.02)?;
        // (Along the top of the cylinder, and a little aslant, so that it does not roll onto its own edge.)
        let sheet = grid.map_positions(|[x, y, _]| [x - 0.005, y + 0.05 * x, radius + gap])?;
        let held = grid.vertices_where(|[x, _, _]| x < 0.011);
        let turn = move |rate: f64| {
            move |t: f64| Isometry3::rotation(Vector3::new(0.0, -rate * t * t, 0.0))
        };
        let mut film = Material::office_paper();
        (film.rigidity, film.stiffness) = (2e-5, 3e3);
        let mut model = SheetModel::of_material(&sheet, &film)
            .build()?
            .with_acceleration([0.0, 0.0, -p[2]]);
        for v in held {
            let at = Point3::from(sheet.position(v));
            let turn = turn(p[0]);
            model = model.with_moving_pin(v, move |t: f64| (turn(t) * at).into())?;
        }
        let along_y = Isometry3::rotation(Vector3::new(0.5 * std::f64::consts::PI, 0.0, 0.0));
        let turn = turn(p[0]);
        let motion = isosheet_dynamics::RigidMotion::from(move |t: f64| turn(t) * along_y);
        let shape = Shape::Cylinder {
            radius,
            half_height: 0.05,
        };
        let cylinder = Obstacle::new(shape, motion)?;
        let contacts = Contacts::for_sheet(&model, [cylinder], Coefficients::equal(p[1]))?;
        let start = State::at_rest(sheet.positions().to_vec());
        Ok(Scene::new(model, start).with_contact(contacts))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 36);
    let loss = coordinate(cells, 2, 36);
    let numbers = [40.0, 0.3, 9.8];
    checked("rolled", &family, &numbers, &plan, &loss, 1e-3);
}
