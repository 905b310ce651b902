//! Losses of the forces of supports and of energies.

use crate::problems::{as_meshed, exact};
use crate::support::{bdf2, checked, shell};
use isosheet_adjoint::{
    AdjointOptions, Kept, Moment, OfMoments, OfState, Plan, Run, Scene, SceneError, Share, energy,
    support_force,
};
use isosheet_collide::{Coefficients, Contacts, Obstacle, Shape};
use isosheet_dynamics::constraint::{Plane, Side, Sphere};
use isosheet_dynamics::{
    Curl, Curvature, ElasticSheet, JointCoordinate, JointSpring, Material, MaterialDirection,
    Method, NaturalTensor, RigidBody, SheetModel, Simulation, State, VertexConstraint,
};
use isosheet_mesh::{MassKind, MassMatrix, VertexId, generate};

/// Half the square of the force on some vertices at each step, so that every step takes part.
fn squared_forces(
    vertices: &'static [usize],
) -> OfMoments<impl Fn(usize, &Moment<'_>) -> Option<Share>> {
    OfMoments(move |_: usize, moment: &Moment<'_>| {
        let mut of_forces = vec![[0.0; 3]; moment.support_forces.len()];
        let mut value = 0.0;
        for v in vertices {
            let force = moment.support_forces[*v];
            value += 0.5 * force.iter().map(|f| f * f).sum::<f64>();
            of_forces[*v] = force;
        }
        Some(Share {
            value,
            of: OfState::zeros(moment.state.x.len()),
            of_forces,
            ..Share::default()
        })
    })
}

/// The forces are those of the simulation, but for what its steps leave of the equations.
fn agree(scene: Scene, forces: &[[f64; 3]], plan: &Plan) {
    let mut simulation =
        Simulation::new(scene.model, scene.start, plan.method.clone()).expect("a simulation");
    if let Some(contact) = scene.contact {
        simulation = simulation.with_boxed_contact(contact).expect("contact");
    }
    for h in &plan.steps {
        simulation.step(*h).expect("a step");
    }
    let mut known = vec![[0.0; 3]; forces.len()];
    for (support, force) in simulation.support_forces() {
        let own = &mut known[support.vertex().index()];
        for k in 0..3 {
            own[k] += force[k];
        }
    }
    let norm = |of: &[[f64; 3]]| of.as_flattened().iter().map(|f| f * f).sum::<f64>().sqrt();
    let difference: Vec<[f64; 3]> = known
        .iter()
        .zip(forces)
        .map(|(a, b)| std::array::from_fn(|k| a[k] - b[k]))
        .collect();
    let part = norm(&difference) / norm(&known);
    println!("forces differ by a part {part:e}");
    assert!(part < 1e-5, "{known:?} {forces:?}");
}

/// The forces after the last step.
fn last_forces(run: &Run<'_>) -> Vec<[f64; 3]> {
    let forces = std::cell::RefCell::default();
    let loss = OfMoments(|_: usize, moment: &Moment<'_>| {
        *forces.borrow_mut() = moment.support_forces.to_vec();
        None
    });
    run.value(&loss).expect("forces");
    forces.into_inner()
}

/// A shell of rods that hangs by a corner which moves.
#[test]
fn the_pin_of_hanging_rods() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = shell()?;
        let corner = VertexId(0);
        let [x, y, z] = sheet.position(corner);
        let (lift, push) = (p[1], p[2]);
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Consistent)?
            .with_acceleration([0.0, push, -p[0]])
            .with_moving_pin(corner, move |t: f64| [x, y, z + lift * t * t])?;
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 8);
    let numbers = [9.8, 0.3, 0.2];
    let force = support_force(vec![0], 2, 8);
    checked("pin of rods", &family, &numbers, &plan, &force, 1e-6);
    let squares = squared_forces(&[0]);
    checked(
        "pin of rods, all steps",
        &family,
        &numbers,
        &plan,
        &squares,
        1e-6,
    );
    let run = Run::record(&family, &numbers, plan.clone(), AdjointOptions::default());
    agree(
        family(&numbers).expect("a scene"),
        &last_forces(&run.expect("a run")),
        &plan,
    );
}

/// A membrane with a vertex on a ball that moves, and another one on a plane.
#[test]
fn guides_of_a_membrane() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::isotropic_square(2, 0.2)?;
        let at = |v: u32| sheet.position(VertexId(v));
        let [x, y, z] = at(0);
        let ball = Sphere::new([x, y, z - 0.1], 0.1)?;
        let lift = p[2];
        let motion = move |t: f64| nalgebra::Isometry3::translation(0.0, 0.0, lift * t * t);
        let plane = Plane::new(at(8), [0.1, 0.2, 1.0])?;
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_acceleration([0.0, 0.1, -p[0]])
            .with_pins(&[VertexId(40)])?
            .with_constraint(
                VertexConstraint::on_surface(VertexId(0), ball, Side::On).moving(motion),
            )?
            .with_constraint(VertexConstraint::on_surface(VertexId(8), plane, Side::On))?
            .with_elastic_sheet(ElasticSheet::new(&sheet, p[1], 0.3)?)?;
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 8);
    let numbers = [9.8, 300.0, 4.0];
    let squares = squared_forces(&[0, 8, 40]);
    checked("guides", &family, &numbers, &plan, &squares, 1e-6);
    let run = Run::record(&family, &numbers, plan.clone(), AdjointOptions::default());
    agree(
        family(&numbers).expect("a scene"),
        &last_forces(&run.expect("a run")),
        &plan,
    );
}

/// Film out of a clamp, with a curl.
fn curled(p: &[f64]) -> Result<Scene, SceneError> {
    let sheet = generate::anisotropic_grid(8, 3, 0.16, 0.06)?;
    let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
    let mut film = Material::office_paper();
    film.stiffness = p[0];
    film.rigidity = p[1];
    film.density = p[2];
    let curl = Curl {
        direction: MaterialDirection::Uniform([1.0, 0.2, 0.0]),
        curvature: NaturalTensor::Uniform(Curvature {
            along: p[3],
            ..Curvature::default()
        }),
        profile: 1.0.into(),
    };
    let model = SheetModel::of_material(&sheet, &film)
        .clamped(&clamp)
        .curled(curl)
        .build()?
        .with_gravity();
    Ok(as_meshed(model, &sheet))
}

const CURLED: [f64; 4] = [300.0, 2e-4, 0.08, 1.5];

/// A clamp carries the weight: the force at rest is that of the mass, and its derivative by the density is
/// the area times the acceleration.
#[test]
fn a_clamp_carries_the_weight() {
    let family = |p: &[f64]| curled(&[CURLED[0], CURLED[1], p[0], CURLED[3]]);
    let plan = Plan::steps(Method::Equilibrium(exact()), 1.0, 1);
    let run = Run::record(&family, &[0.08], plan, AdjointOptions::default()).expect("a run");
    let gradient = run.gradient(&support_force((0..36).collect(), 2, 1));
    let gradient = gradient.expect("a gradient");
    let of_density = 0.16 * 0.06 * 9.8;
    println!("{} {:?}", gradient.value, gradient.of_numbers);
    assert!((gradient.value / (0.08 * of_density) - 1.0).abs() < 1e-6);
    assert!((gradient.of_numbers[0] / of_density - 1.0).abs() < 1e-6);
}

/// Kinetic and potential energy, with what the sheet remembers of its bends, from checkpoints, too.
#[test]
fn energies_of_a_curled_film() {
    let plan = Plan::steps(bdf2(), 1e-2, 8);
    let loss = energy(8);
    let gradient = checked("energy", &curled, &CURLED, &plan, &loss, 1e-6);
    let options = AdjointOptions {
        kept: Kept::Between { checkpoints: 3 },
        ..AdjointOptions::default()
    };
    let run = Run::record(&curled, &CURLED, plan.clone(), options).expect("a run");
    assert_eq!(run.value(&loss).expect("an energy"), gradient.value);
    let again = run.gradient(&loss).expect("a gradient");
    assert_eq!(again.of_numbers, gradient.of_numbers);
    // At all moments, the start included, and of kinetic energy apart.
    let uneven = OfMoments(|n: usize, moment: &Moment<'_>| {
        let energies = moment.energies;
        let stored: f64 = energies.potentials.iter().sum();
        let mut of_energies = energies.clone();
        of_energies.kinetic = 0.3 * n as f64;
        of_energies.potentials.fill(2.0);
        Some(Share {
            value: 0.3 * n as f64 * energies.kinetic + 2.0 * stored,
            of: OfState::zeros(moment.state.x.len()),
            of_energies,
            ..Share::default()
        })
    });
    checked("energies", &curled, &CURLED, &plan, &uneven, 1e-6);
}

/// Film that is clamped at an edge comes to rest on a ball with friction.
#[test]
fn a_clamp_beside_contact() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::delaunay_square(0.2, 0.04, 2)?;
        let sheet = sheet.map_positions(|[x, y, _]| [x - 0.1, y - 0.1, 0.0503 + 0.01 * x * x])?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < -0.0999);
        let paper = Material::office_paper();
        let model = SheetModel::of_material(&sheet, &paper)
            .clamped(&clamp)
            .build()?
            .with_acceleration([0.0, 0.5, -p[0]]);
        let ball = Obstacle::at(Shape::Sphere { radius: 0.05 }, [0.03, 0.003, 0.0])?;
        let contacts = Contacts::for_sheet(&model, [ball], Coefficients::equal(p[1]))?;
        let start = State::at_rest(sheet.positions().to_vec());
        Ok(Scene::new(model, start).with_contact(contacts))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 10);
    let all = squared_forces(&[0, 1, 2, 3, 4, 5]);
    checked("clamp and ball", &family, &[9.8, 0.3], &plan, &all, 1e-3);
}

/// A body that swings about a hinge with a spring and a damper: the force on its axis, and the energy.
#[test]
fn a_body_on_a_hinge() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let moments = nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(2e-4, 3e-4, 4e-4));
        let body = RigidBody::new(0.2, [0.1, 0.02, 0.0], moments.into())?
            .with_edge([0.0, 0.0, 0.0], [0.0, 1.0, 0.3])?;
        let tetrahedron = body.tetrahedron();
        let masses = MassMatrix::from_vertex_masses(body.mass_matrix().vertex)?;
        let x = tetrahedron.positions();
        let angle = JointCoordinate::angle([0, 1, 2, 3].map(VertexId), x);
        let spring = JointSpring::new(angle.clone(), p[1], 0.3.into())?;
        let model = SheetModel::with_mass(&tetrahedron, masses)?
            .with_acceleration([0.0, 0.0, -p[0]])
            .with_pins(&[VertexId(0), VertexId(1)])?
            .with_potential(spring)
            .with_joint_damper(angle, p[2])?;
        Ok(Scene::new(model, State::at_rest(x.to_vec())))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 12);
    let numbers = [9.8, 0.3, 2e-2];
    let forces = squared_forces(&[0, 1]);
    checked("axis of a hinge", &family, &numbers, &plan, &forces, 1e-6);
    checked(
        "energy on a hinge",
        &family,
        &numbers,
        &plan,
        &energy(12),
        1e-6,
    );
}
