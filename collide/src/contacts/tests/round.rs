//! Round bodies that respond: derivatives, balance, and motions that are safe.

use super::*;
use crate::RoundBody;
use isosheet_dynamics::RigidBody;
use isosheet_dynamics::contact::CarriedPoint;
use isosheet_geometry::distance::{edge_edge, point_triangle};
use isosheet_mesh::{MassMatrix, Part, VertexId};
use proptest::prelude::*;

const ACTIVATION: f64 = 0.02;

/// A bent sheet with round bodies, and the vertices that carry all.
struct Scene {
    contacts: Contacts,
    model: SheetModel,
    x: Vec<f64>,
    bodies: Vec<RoundBody>,
    rigid: Vec<RigidBody>,
    /// The first vertex that carries a body.
    first: usize,
}

impl Scene {
    fn new(bodies: &[RoundBody]) -> Self {
        let sheet = sheet(2);
        let bent = waves(&sheet, 0.0, 0.1);
        let rigid: Vec<RigidBody> = bodies
            .iter()
            .map(|body| {
                let [a, b] = body.axis.map(Vector3::from);
                let moments = Matrix3::from_diagonal(&Vector3::new(0.011, 0.012, 0.013));
                RigidBody::new(1.0, (0.5 * (a + b)).into(), moments.into()).unwrap()
            })
            .collect();
        let tetrahedra: Vec<Sheet> = rigid.iter().map(RigidBody::tetrahedron).collect();
        let all: Vec<&Sheet> = std::iter::once(&sheet).chain(&tetrahedra).collect();
        let union = Sheet::union(&all).unwrap();
        let parts = Part::of_union(&all);
        let first = parts[0].vertices.end;
        let count = union.topology().vertex_count();
        // The polyhedra that are replaced are the tetrahedra themselves.
        let own = (first..count).map(|v| {
            let mut carried: CarriedPoint = [(VertexId::from_index(v), 0.0); 4];
            carried[0].1 = 1.0;
            carried
        });
        let points = SurfacePoints::new(count, first, own.collect()).unwrap();
        let masses = MassMatrix::from_vertex_masses(vec![0.1; count]).unwrap();
        let model = SheetModel::with_mass(&union, masses).unwrap();
        let options = ContactOptions {
            activation: ACTIVATION,
            thickness: 1e-3,
            rest_speed: 1e-2,
            stiffness: Stiffness::Joules(2.0),
            ..ContactOptions::for_surface(&union, &points)
        };
        let ranges: Vec<_> = parts[1..]
            .iter()
            .map(|part| part.vertices.clone())
            .collect();
        let mut contacts = Contacts::on_surface(&union, points, options)
            .unwrap()
            .with_parts(&ranges, []);
        for (k, (body, rigid)) in bodies.iter().zip(&rigid).enumerate() {
            let carrier = VertexId::from_index(ranges[k].start);
            contacts = contacts
                .with_round_body(k, ranges[k].clone(), *body, |p| rigid.carried(p, carrier))
                .unwrap();
        }
        let mut x = bent;
        x.extend_from_slice(&union.positions()[3 * first..]);
        Self {
            contacts: contacts
                .with_self_contact(Coefficients::equal(0.4))
                .unwrap(),
            model,
            x,
            bodies: bodies.to_vec(),
            rigid,
            first,
        }
    }

    /// Contacts, the barrier, and friction lagged at positions `x`, as they are after a step from `x0`.
    fn at(&mut self, x0: &[f64], x: &[f64]) -> (ContactSet, BarrierPotential, LaggedFriction) {
        self.contacts
            .check_start(&self.model, &State::at_rest(x.to_vec()))
            .unwrap();
        let barrier = BarrierPotential::new(ACTIVATION, 2.0).unwrap();
        let [p0, p] = [x0, x].map(|x| self.places(x));
        let bodies = BodyMotions::over(&self.contacts, StepSpan { t0: 0.0, h: 0.02 });
        let zero = vec![0.0; p.len()];
        let set = ContactSet::of(&mut self.contacts, motion(&bodies, [1.0; 2], &p, &zero));
        let active = ActiveContacts::at(&self.contacts, &set, 1.0, &p);
        let mut friction = LaggedFriction::none();
        friction.lag(
            self.contacts.laws(),
            &barrier,
            &active,
            Course::from_start(&p0, 0.02),
            &p,
        );
        (set, barrier, friction)
    }

    fn places(&self, x: &[f64]) -> Vec<f64> {
        SurfacePoints::placed(self.contacts.points(), x).into_owned()
    }

    /// Where the axis of a body is.
    fn axis(&self, body: usize, x: &[f64]) -> [Vector3<f64>; 2] {
        let first = VertexId::from_index(self.first + 4 * body);
        self.bodies[body].axis.map(|p| {
            let carried = self.rigid[body].carried(p, first).into_iter();
            carried
                .map(|(v, b)| b * Vector3::from_column_slice(&x[3 * v.index()..3 * v.index() + 3]))
                .sum()
        })
    }

    /// The least distance of surfaces, by all pairs of faces and edges of the sheet and axes.
    fn clearance(&self, x: &[f64]) -> f64 {
        let place = |v: VertexId| Vector3::from_column_slice(&x[3 * v.index()..3 * v.index() + 3]);
        let t = self.model.topology();
        let mut least = f64::INFINITY;
        for k in 0..self.bodies.len() {
            let ([a, b], radius) = (self.axis(k, x), self.bodies[k].radius);
            for face in t.faces().iter().filter(|f| f[0].index() < self.first) {
                let [p, q, r] = face.map(place);
                for end in [a, b] {
                    least = least.min(point_triangle(&[end, p, q, r]).distance() - radius - 1e-3);
                }
            }
            for edge in t.edges().iter().filter(|e| e[0].index() < self.first) {
                let [p, q] = edge.map(place);
                least = least.min(edge_edge(&[a, b, p, q]).distance() - radius - 1e-3);
            }
            for other in 0..k {
                let [c, d] = self.axis(other, x);
                let radii = radius + self.bodies[other].radius;
                least = least.min(edge_edge(&[a, b, c, d]).distance() - radii);
            }
        }
        least
    }
}

fn ball(place: [f64; 3], radius: f64) -> RoundBody {
    RoundBody {
        axis: [place; 2],
        radius,
    }
}

/// The sheet lies below 0.13 m: a ball and a capsule near to it and to each other, and two parallel capsules.
fn scenes() -> Vec<(&'static str, Vec<RoundBody>)> {
    let capsule = |y: f64, z: f64, lift: f64| RoundBody {
        axis: [[-0.2, y, z], [0.25, y, z + lift]],
        radius: 0.1,
    };
    vec![
        ("ball", vec![ball([0.05, -0.02, 0.1875], 0.15)]),
        ("capsule", vec![capsule(0.03, 0.165, 0.0)]),
        (
            "balls",
            vec![
                ball([0.05, 0.0, 0.5], 0.15),
                ball([0.1, 0.05, 0.208], 0.141),
            ],
        ),
        (
            "ball and capsule",
            vec![capsule(0.0, 0.6, 0.05), ball([0.02, 0.1, 0.382], 0.14)],
        ),
        (
            "parallel capsules",
            vec![capsule(0.0, 0.6, 0.0), capsule(0.01, 0.8102, 0.0)],
        ),
    ]
}

/// Lets the bodies down until the least gap is half of the activation distance.
fn lowered(bodies: &[RoundBody]) -> Scene {
    let scene = Scene::new(bodies);
    let gap = scene.clearance(&scene.x);
    if gap > 0.0 && gap < ACTIVATION {
        return scene;
    }
    let below = |by: f64| {
        let moved = bodies.iter().map(|body| RoundBody {
            axis: body.axis.map(|[x, y, z]| [x, y, z - by]),
            ..*body
        });
        Scene::new(&moved.collect::<Vec<_>>())
    };
    let (mut low, mut high) = (-0.5, 0.5);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        let scene = below(middle);
        match scene.clearance(&scene.x) > 0.5 * ACTIVATION {
            true => low = middle,
            false => high = middle,
        }
    }
    below(low)
}

/// Barrier and friction against differences by the positions of the vertices that carry all, and no force in
/// all.
#[test]
fn derivatives_are_those_of_the_energy() {
    for (name, bodies) in scenes() {
        let mut scene = lowered(&bodies);
        let x = scene.x.clone();
        // Each vertex has come from elsewhere.
        let x0: Vec<f64> = (0..x.len())
            .map(|i| x[i] + 1e-4 * (1.7 * i as f64).sin())
            .collect();
        let (set, barrier, friction) = scene.at(&x0, &x);
        assert!(!friction.contacts().is_empty(), "{name}");
        let points = scene.contacts.points().unwrap().clone();
        let evaluated = |x: &[f64]| {
            let p = scene.places(x);
            let active = ActiveContacts::at(&scene.contacts, &set, 1.0, &p);
            (p, active)
        };
        let energies = |x: &[f64]| {
            let (p, active) = evaluated(x);
            [
                active.barrier_energy(&barrier),
                friction.energy(&p, active.bodies()),
            ]
        };
        let gradients = |x: &[f64]| {
            let (p, active) = evaluated(x);
            let mut out = [vec![0.0; p.len()], vec![0.0; p.len()]];
            active.add_barrier_gradient(&barrier, 1.0, &mut out[0]);
            friction.add_gradient(&p, active.bodies(), 1.0, &mut out[1]);
            out.map(|forces| {
                let mut carried = vec![0.0; x.len()];
                points.add_forces(&forces, &mut carried);
                carried
            })
        };
        let exact = gradients(&x);
        let largest = |g: &[f64]| g.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let size = exact.each_ref().map(|g| largest(g));
        assert!(size.iter().all(|s| *s > 0.0), "{name}: {size:?}");
        let h = 1e-7;
        for i in 0..x.len() {
            let moved = |d: f64| {
                let mut y = x.clone();
                y[i] += d;
                energies(&y)
            };
            let (up, down) = (moved(h), moved(-h));
            for k in 0..2 {
                let slope = (up[k] - down[k]) / (2.0 * h);
                let error = (slope - exact[k][i]).abs() / size[k];
                assert!(
                    error < 2e-6,
                    "{name}, {k}, coordinate {i}: {slope} {}",
                    exact[k][i]
                );
            }
        }
        for g in &exact {
            let sum: Vector3<f64> = g.as_chunks::<3>().0.iter().map(|g| Vector3::from(*g)).sum();
            assert!(sum.norm() < 1e-12 * largest(g), "{name}: {sum}");
        }
        // Of friction the Hessian too; its forces act where the surfaces touch, so that their torque is that
        // of the gap between these.
        let mut dense = Dense::new(3 * points.count());
        let (p, active) = evaluated(&x);
        friction.add_hessian(&p, active.bodies(), &mut dense);
        let of_points = dense.matrix();
        let matrix = nalgebra::DMatrix::from_fn(3 * points.count(), x.len(), |row, column| {
            let mut unit = vec![0.0; x.len()];
            unit[column] = 1.0;
            SurfacePoints::placed(Some(&points), &unit)[row]
        });
        let hessian = matrix.transpose() * of_points * &matrix;
        let scale = hessian.norm();
        for i in (0..x.len()).step_by(7).chain(3 * scene.first..x.len()) {
            let moved = |d: f64| {
                let mut y = x.clone();
                y[i] += d;
                gradients(&y)[1].clone()
            };
            let (up, down) = (moved(h), moved(-h));
            for j in 0..x.len() {
                let slope = (up[j] - down[j]) / (2.0 * h);
                let error = (slope - hessian[(j, i)]).abs();
                assert!(
                    error < 1e-5 * scale,
                    "{name}, {i} {j}: {slope} {}",
                    hessian[(j, i)]
                );
            }
        }
        let torque: Vector3<f64> = exact[1]
            .as_chunks::<3>()
            .0
            .iter()
            .zip(x.as_chunks::<3>().0)
            .map(|(g, x)| Vector3::from(*x).cross(&Vector3::from(*g)))
            .sum();
        let forces: f64 = friction.contacts().iter().map(|c| 0.4 * c.force).sum();
        assert!(
            torque.norm() <= (ACTIVATION + 1e-3) * forces,
            "{name}: {torque} {forces}"
        );
    }
}

proptest! {
    #![proptest_config(isosheet_random::cases(48))]

    /// No part of a motion that is said to be safe brings surfaces together, and a motion through the sheet
    /// is not safe.
    #[test]
    fn safe_motions_keep_surfaces_apart(
        which in 0..5_usize,
        down in 0.0..1.5_f64,
        aside in [-0.3..0.3_f64, -0.3..0.3],
        turn in [-0.4..0.4_f64, -0.4..0.4, -0.4..0.4],
    ) {
        let (name, bodies) = scenes().swap_remove(which);
        let mut scene = lowered(&bodies);
        let (x, n) = (scene.x.clone(), scene.x.len());
        let mut dx = vec![0.0; n];
        let count = scene.bodies.len();
        let last = 3 * (scene.first + 4 * (count - 1));
        // The last body goes towards what is below, or the first towards the last above it.
        let (start, end, sign) = match name {
            "parallel capsules" | "ball" | "capsule" => (last, n, -1.0),
            _ => (3 * scene.first, 3 * scene.first + 12, -1.0),
        };
        for i in (start..end).step_by(3) {
            let step = Vector3::new(aside[0], aside[1], sign * down)
                + Vector3::from(turn).cross(&Vector3::new(x[i], x[i + 1], x[i + 2]));
            dx[i..i + 3].copy_from_slice(step.as_slice());
        }
        let [p, dp] = [&x, &dx].map(|x| scene.places(x));
        let bodies = BodyMotions::over(&scene.contacts, StepSpan { t0: 0.0, h: 0.02 });
        let set = ContactSet::of(&mut scene.contacts, motion(&bodies, [1.0; 2], &p, &dp));
        let safe = set.safe_fraction();
        for k in 0..=40 {
            let s = safe * f64::from(k) / 40.0;
            let y: Vec<f64> = x.iter().zip(&dx).map(|(x, d)| x + s * d).collect();
            let clear = scene.clearance(&y);
            prop_assert!(clear > 0.0, "{}: {} at {} of {}", name, clear, s, safe);
            // Whatever is within reach is found.
            let active = ActiveContacts::at(&scene.contacts, &set, 1.0, &scene.places(&y));
            prop_assert!(clear >= ACTIVATION || (active.gap() - clear).abs() < 1e-9,
                "{}: {} {}", name, active.gap(), clear);
        }
        let whole: Vec<f64> = x.iter().zip(&dx).map(|(x, d)| x + d).collect();
        // A motion is cut where surfaces would come near to each other, and nowhere else.
        let comes_near = (0..200).any(|k| {
            let y: Vec<f64> = (0..n)
                .map(|i| x[i] + (whole[i] - x[i]) * f64::from(k) / 199.0)
                .collect();
            scene.clearance(&y) < 0.6 * ACTIVATION
        });
        prop_assert!(safe == 1.0 || comes_near, "{} {}", name, safe);
    }
}
