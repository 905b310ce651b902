//! Rigid bodies that respond: four point masses with six rods, whose surface is carried by them, beside
//! sheets that are elastic.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::contact::SurfacePoints;
use isosheet_dynamics::{
    ElasticSheet, ImplicitOptions, Method, PlateBending, PotentialOfPart, RigidBody, SheetModel,
    Simulation, State,
};
use isosheet_mesh::{MassKind, MassMatrix, Part, Sheet, VertexId, generate};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

const G: f64 = 9.8;
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

/// A homogeneous block and its surface, in a pose.
struct Block {
    body: RigidBody,
    surface: Sheet,
}

impl Block {
    fn new(mass: f64, sides: [f64; 3], pose: Isometry3<f64>) -> Self {
        let sides = Vector3::from(sides);
        let own = Matrix3::from_diagonal(&sides.map(|a| mass * a * a / 12.0));
        let turn = pose.rotation.to_rotation_matrix().into_inner();
        let moments = turn * own * turn.transpose();
        let moments = 0.5 * (moments + moments.transpose());
        let body = RigidBody::new(mass, pose.translation.vector.into(), moments.into());
        let corner = |i: u32| -> [f64; 3] {
            let sign = |k: u32| if i >> k & 1 == 0 { -0.5 } else { 0.5 };
            let local = Vector3::new(sign(0), sign(1), sign(2)).component_mul(&sides);
            (pose * Point3::from(local)).into()
        };
        Self {
            body: body.expect("a block"),
            surface: Sheet::new((0..8).flat_map(corner).collect(), &FACES).expect("a surface"),
        }
    }
}

/// A block, beside a sheet if there is one: the model without loads, contact, and the start.
struct Scene {
    model: SheetModel,
    contacts: Contacts,
    state: State,
    /// The first of the four vertices of the block.
    first: usize,
}

impl Scene {
    /// With a sheet of paper of the given mass.
    fn of(sheet: Option<(&Sheet, f64)>, block: &Block, friction: f64) -> Self {
        let tetrahedron = block.body.tetrahedron();
        let mut sheets: Vec<&Sheet> = sheet.iter().map(|(sheet, _)| *sheet).collect();
        let mut surfaces = sheets.clone();
        sheets.push(&tetrahedron);
        surfaces.push(&block.surface);
        let union = Sheet::union(&sheets).expect("a union");
        let parts = Part::of_union(&sheets);
        let first = parts.last().expect("a block").vertices.start;
        let mut masses = match sheet {
            Some((sheet, mass)) => {
                let own = MassMatrix::from_total(sheet, mass, MassKind::Lumped);
                own.expect("masses").vertex
            }
            None => Vec::new(),
        };
        masses.extend(block.body.mass_matrix().vertex);
        let masses = MassMatrix::from_vertex_masses(masses).expect("masses");
        let mut model = SheetModel::with_mass(&union, masses).expect("a model");
        if let Some((sheet, _)) = sheet {
            let (stiffness, poisson, rigidity) = (3e5, 0.3, 5e-4);
            let plate = PlateBending::new(sheet, rigidity).expect("a plate");
            let elastic = ElasticSheet::new(sheet, stiffness, poisson).expect("elastic");
            let elastic = elastic.beside(sheet, &plate);
            let faces = union.topology().face_count();
            let elastic = ElasticSheet::union(vec![(elastic, parts[0].clone())], faces);
            model = model
                .with_potential(PotentialOfPart::new(plate, &parts[0]))
                .with_elastic_sheet(elastic)
                .expect("its faces");
            assert_eq!(model.rods().len(), 6, "the rods of the block");
        }
        let corners = block.surface.positions().as_chunks::<3>().0.iter();
        let carried = corners.map(|p| block.body.carried(*p, VertexId::from_index(first)));
        let count = union.topology().vertex_count();
        let points = SurfacePoints::new(count, first, carried.collect()).expect("points");
        let surface = Sheet::union(&surfaces).expect("a surface");
        let options = ContactOptions::for_surface(&surface, &points);
        let contacts = Contacts::on_surface(&surface, points, options)
            .expect("contact")
            .with_self_contact(Coefficients::equal(friction))
            .expect("friction")
            .with_parts(std::slice::from_ref(&(first..first + 8)), []);
        let state = State::at_rest(union.positions().to_vec());
        Self {
            model,
            contacts,
            state,
            first,
        }
    }

    /// Velocity of the block, metres per second.
    fn throw(&mut self, velocity: Vector3<f64>) {
        for v in self.state.v[3 * self.first..].as_chunks_mut::<3>().0 {
            *v = velocity.into();
        }
    }
}

fn tight() -> Method {
    Method::Bdf2(ImplicitOptions {
        tolerance: Some(1e-10),
        ..ImplicitOptions::default()
    })
}

fn centre(x: &[f64]) -> Vector3<f64> {
    let points = x.as_chunks::<3>().0.iter();
    points.map(|p| Vector3::from(*p)).sum::<Vector3<f64>>() / 4.0
}

/// On an inclined plane a block slides with the acceleration `g (sin a - mu cos a)`, and its loads on the
/// plane are its weight.
#[test]
fn a_block_slides_down_an_inclined_plane() {
    let (slope, friction) = (0.5_f64, 0.2);
    let plane = Isometry3::rotation(Vector3::new(0.0, slope, 0.0));
    // On the plane but for a gap at which its barrier acts.
    let pose = plane * Isometry3::translation(0.0, 0.0, 0.025 + 5e-4);
    let block = Block::new(0.5, [0.1, 0.08, 0.05], pose);
    let scene = Scene::of(None, &block, 0.0);
    let floor = Obstacle::fixed(Shape::HalfSpace, plane).expect("a plane");
    let contacts = scene
        .contacts
        .with_body(floor, Coefficients::equal(friction));
    let model = scene.model.with_acceleration([0.0, 0.0, -G]);
    let mut run = Simulation::new(model, scene.state, tight())
        .expect("a start")
        .with_contact(contacts.expect("friction"))
        .expect("a gap");
    let h = 1.0 / 240.0;
    let (settling, steps) = (24, 96);
    for _ in 0..settling {
        run.step(h).expect("a step");
    }
    let start = run.state().v[0];
    let mut load = Vector3::zeros();
    for _ in 0..steps {
        let report = run.step(h).expect("a step");
        assert!(report.constrained_strain < 1e-12);
        load += run.body_loads()[0].force / f64::from(steps);
    }
    let along = Vector3::new(slope.cos(), 0.0, -slope.sin());
    let acceleration = G * (slope.sin() - friction * slope.cos());
    let gained = (run.state().v[0] - start) / along.x;
    let expected = acceleration * h * f64::from(steps);
    assert!(
        (gained / expected - 1.0).abs() < 5e-3,
        "{gained} {expected}"
    );
    // Newton's law for the block: the plane carries what does not accelerate it.
    let carried = 0.5 * (Vector3::new(0.0, 0.0, -G) - acceleration * along);
    assert!(
        (load - carried).norm() < 5e-3 * carried.norm(),
        "{load} {carried}"
    );
}

/// A block is thrown at a free sheet of paper: momenta are kept, and the block stays rigid.
#[test]
fn a_block_that_hits_a_sheet_keeps_the_momenta() {
    let sheet = generate::delaunay(&[[0.0, 0.0], [0.3, 0.0], [0.3, 0.2], [0.0, 0.2]], 0.05, 3);
    let sheet = sheet.expect("a rectangle");
    let turned = nalgebra::UnitQuaternion::from_euler_angles(0.4, 0.3, 0.2);
    let pose = Isometry3::from_parts(nalgebra::Translation3::new(0.12, 0.11, 0.06), turned);
    let block = Block::new(0.02, [0.06, 0.05, 0.04], pose);
    let mut scene = Scene::of(Some((&sheet, 5e-3)), &block, 0.3);
    scene.throw(Vector3::new(0.3, 0.1, -1.0));
    let model = scene.model;
    let before = (
        Vector3::from(model.linear_momentum(&scene.state.v)),
        Vector3::from(model.angular_momentum(&scene.state.x, &scene.state.v)),
    );
    let mut run = Simulation::new(model, scene.state, tight())
        .expect("a start")
        .with_contact(scene.contacts)
        .expect("a gap");
    let mut touched = false;
    for _ in 0..60 {
        let report = run.step(1.0 / 480.0).expect("a step");
        assert!(report.constrained_strain < 1e-12 && report.gap.is_none_or(|gap| gap > 0.0));
        touched |= report.gap.is_some_and(f64::is_finite);
    }
    assert!(touched, "they meet");
    let state = run.state();
    let after = Vector3::from(run.model().linear_momentum(&state.v));
    let error = (after - before.0).norm() / before.0.norm();
    assert!(error < 1e-8, "linear momentum: {error}");
    let turning = Vector3::from(run.model().angular_momentum(&state.x, &state.v));
    let scale = before.1.norm() + 0.3 * before.0.norm();
    let error = (turning - before.1).norm() / scale;
    // BDF2 keeps the angular momentum to its order.
    assert!(error < 1e-3, "angular momentum: {error}");
    // Contact forces are internal.
    let forces = run.contact_forces().expect("contact");
    let (sum, size) = forces.as_chunks::<3>().0.iter().fold(
        (Vector3::zeros(), 0.0),
        |(sum, size): (Vector3<f64>, f64), f| {
            let f = Vector3::from(*f);
            (sum + f, size + f.norm())
        },
    );
    assert!(sum.norm() <= 1e-12 * size.max(1e-6), "{sum}");
}

/// A block lies in a sheet of paper that is held at its edges: the supports carry the weight of both.
#[test]
fn a_block_lies_in_a_hammock() {
    let sheet = generate::isotropic_square(2, 0.2).expect("a square");
    let pose = Isometry3::translation(0.1, 0.1, 0.021);
    let block = Block::new(0.03, [0.06, 0.05, 0.04], pose);
    let scene = Scene::of(Some((&sheet, 3.2e-3)), &block, 0.3);
    let edge = sheet.topology().vertex_ids().filter(|v| {
        let x = sheet.positions()[3 * v.index()];
        !(1e-9..0.2 - 1e-9).contains(&x)
    });
    let edge: Vec<VertexId> = edge.collect();
    let model = scene.model.with_acceleration([0.0, 0.0, -G]);
    let model = model.with_pins(&edge).expect("pins");
    let model = model.with_damping(8.0).expect("damping");
    let mut run = Simulation::new(model, scene.state, Method::default())
        .expect("a start")
        .with_contact(scene.contacts)
        .expect("a gap");
    for _ in 0..180 {
        let report = run.step(1.0 / 60.0).expect("a step");
        assert!(report.constrained_strain < 1e-12 && report.gap.is_none_or(|gap| gap > 0.0));
    }
    let held: f64 = run.reactions().iter().map(|r| r.force.z).sum();
    let weight = G * (0.03 + 3.2e-3);
    assert!((held / weight - 1.0).abs() < 1e-3, "{held} {weight}");
    let place = centre(&run.state().x[3 * scene.first..]);
    assert!(place.z < 0.021 && place.z > -0.1, "{place}");
}
