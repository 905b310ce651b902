//! Loads that follow the sheet: pressure, enclosed gas, loads and moments that turn with it.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Keyframe, Obstacle, Shape};
use isosheet_dynamics::{
    At, EdgeMoment, ElasticSheet, Gas, Glue, Isotropic, LoadedFaces, Material, Method, Potential,
    Profile, SheetModel, Simulation, State,
};
use isosheet_mesh::{EdgeId, MassKind, Part, Sheet, VertexId, generate};
use isosheet_tests::implicit_euler;
use nalgebra::{Isometry3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// A sphere of triangles, an octahedron whose faces are divided into four some times, with its front outside.
fn sphere(level: u32, radius: f64) -> Sheet {
    let mut x: Vec<Vector3<f64>> = [Vector3::x(), Vector3::y(), -Vector3::x(), -Vector3::y()]
        .into_iter()
        .chain([Vector3::z(), -Vector3::z()])
        .collect();
    let mut faces: Vec<[u32; 3]> = (0..4)
        .flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]])
        .collect();
    for _ in 0..level {
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                x.push((x[a as usize] + x[b as usize]).normalize());
                x.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let x = x
        .iter()
        .flat_map(|p| <[f64; 3]>::from(radius * p))
        .collect();
    Sheet::new(x, &faces).expect("a sphere")
}

/// The volume behind the faces of a closed sheet, or of one that vertical walls close.
fn volume(sheet: &Sheet, x: &[f64]) -> f64 {
    let faces = sheet.topology().faces().iter();
    let below = faces.map(|f| {
        let [a, b, c] = f.map(|v| Vector3::from_column_slice(&x[3 * v.index()..][..3]));
        let across = (b - a).cross(&(c - a)).z / 2.0;
        across * (a + b + c).z / 3.0
    });
    below.sum()
}

/// A film without bending stiffness.
fn film(sheet: &Sheet, stiffness: f64, limit: f64) -> SheetModel {
    let elastic = ElasticSheet::new(sheet, stiffness, POISSON).expect("valid");
    let elastic = elastic.with_limit(limit).expect("valid");
    let mass = 0.05 * sheet.area();
    let model = SheetModel::new(sheet, mass, MassKind::Lumped).expect("valid");
    model.with_elastic_sheet(elastic).expect("its own")
}

fn simulation(model: SheetModel, x: &[f64], method: Method) -> Simulation {
    Simulation::new(model, State::at_rest(x.to_vec()), method).expect("valid")
}

const RADIUS: f64 = 0.1;
const STIFFNESS: f64 = 1e5;
const POISSON: f64 = 0.3;

/// By which part the radius of a sphere grows in a pressure, by Hooke's law.
fn growth(pressure: f64) -> f64 {
    pressure * RADIUS * (1.0 - POISSON) / (2.0 * STIFFNESS)
}

/// Largest component of a velocity, metres per second.
fn speed(run: &Simulation) -> f64 {
    run.state().v.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

fn mean_radius(x: &[f64]) -> f64 {
    let points = x.as_chunks::<3>().0;
    points.iter().map(|p| Vector3::from(*p).norm()).sum::<f64>() / points.len() as f64
}

/// A sphere of film grows by `p R^2 (1 - nu) / (2 E h)`.
#[test]
fn a_sphere_of_film_grows_by_hookes_law() {
    let sheet = sphere(3, RADIUS);
    let pressure = 4e3;
    let model = film(&sheet, STIFFNESS, ElasticSheet::LIMIT)
        .with_damping(200.0)
        .expect("valid");
    let faces = LoadedFaces::all(sheet.topology()).expect("faces");
    let model = model.with_pressure(faces, pressure).expect("valid");
    let mut run = simulation(model, sheet.positions(), implicit_euler());
    let mut factorisations = 0;
    for _ in 0..40 {
        factorisations += run.step(0.02).expect("accepted").factorisations;
    }
    let growth = growth(pressure);
    let found = mean_radius(&run.state().x) / RADIUS - 1.0;
    assert!(
        (found / growth - 1.0).abs() < 0.03,
        "{found} {growth}, {factorisations}"
    );
}

/// A sphere of film that holds air, into which more is let, grows until Hooke's pressure is that of the gas.
#[test]
fn a_sphere_that_is_blown_up_balances_the_gas() {
    let sheet = sphere(3, RADIUS);
    let first = volume(&sheet, sheet.positions());
    let added = 0.05 * first;
    let gas = Gas {
        added: Profile::SmoothStep {
            from: 0.0,
            to: added,
            begin: 0.0,
            end: 0.2,
        },
        ..Gas::default()
    };
    let model = film(&sheet, STIFFNESS, ElasticSheet::LIMIT)
        .with_damping(200.0)
        .expect("valid");
    let faces = LoadedFaces::all(sheet.topology()).expect("faces");
    let model = model
        .with_gas(faces, gas, sheet.positions())
        .expect("valid");
    let mut run = simulation(model, sheet.positions(), implicit_euler());
    let mut factorisations = 0;
    for _ in 0..40 {
        factorisations += run.step(0.02).expect("accepted").factorisations;
    }
    let x = &run.state().x;
    let pressure = 101_325.0 * ((first + added) / volume(&sheet, x) - 1.0);
    let found = mean_radius(x) / RADIUS - 1.0;
    assert!(
        (found / growth(pressure) - 1.0).abs() < 0.03,
        "{found} {pressure}"
    );
    assert!(
        pressure > 2e3 && factorisations < 400,
        "{pressure} Pa, {factorisations}"
    );
}

/// Side of a pillow, metres.
const SIDE: f64 = 0.2;

/// Two squares of film whose rims are joined.
struct Pillow {
    sheet: Sheet,
    pairs: Vec<[VertexId; 2]>,
    /// The two squares with the front of all faces outside.
    outwards: Sheet,
}

impl Pillow {
    fn new(cells: usize) -> Self {
        let square = generate::grid(cells, cells, SIDE, SIDE, generate::Diagonals::UnionJack);
        let square = square.expect("valid");
        // What may wrinkle does not lie exactly flat.
        let wave = |x: f64, y: f64| 1e-5 * (71.0 * x * x + 113.0 * y + 1700.0 * x * y).sin();
        let at = |height: f64| {
            let lifted = square.map_positions(|[x, y, z]| [x, y, z + height + wave(x, y + height)]);
            lifted.expect("valid")
        };
        let sheets = [at(0.0), at(1e-3)];
        let sheets: Vec<&Sheet> = sheets.iter().collect();
        let sheet = Sheet::union(&sheets).expect("valid");
        let parts = Part::of_union(&sheets);
        let topology = square.topology();
        let rim = topology
            .vertex_ids()
            .filter(|v| topology.is_boundary_vertex(*v));
        let pairs = rim
            .map(|v| [parts[0].vertex(v), parts[1].vertex(v)])
            .collect();
        let faces = sheet.face_indices().into_iter().enumerate();
        let faces: Vec<[u32; 3]> = faces
            .map(|(f, [a, b, c])| {
                if f < topology.face_count() {
                    [a, c, b]
                } else {
                    [a, b, c]
                }
            })
            .collect();
        let outwards = Sheet::new(sheet.positions().to_vec(), &faces).expect("a pillow");
        Self {
            sheet,
            pairs,
            outwards,
        }
    }

    fn faces(&self) -> LoadedFaces {
        let faces: Vec<_> = self.sheet.topology().face_ids().collect();
        let faces = LoadedFaces::new(self.sheet.topology(), &faces, &self.pairs).expect("a pillow");
        assert!(faces.rim().is_empty());
        // The front of the first face is inside.
        faces.turned_over()
    }

    fn glue(&self) -> Glue {
        let (topology, x) = (self.sheet.topology(), self.sheet.positions());
        Glue::new(topology, &self.pairs, 1e5, 1.0, x).expect("valid")
    }

    fn film(&self, damping: f64) -> SheetModel {
        let model = film(&self.sheet, STIFFNESS, ElasticSheet::LIMIT).with_damping(damping);
        model.expect("valid").with_potential(self.glue())
    }
}

/// Two plates press a pillow that holds air. What is stored is the work that compresses the air, `p V`
/// constant, and what stretches the film; what the plates do closes the balance.
#[test]
fn plates_compress_the_gas() {
    let pillow = Pillow::new(8);
    let x = pillow.sheet.positions();
    let first = volume(&pillow.outwards, x);
    let [blown, pressed] = [0.2, 0.6];
    let added = 8e-4;
    let gas = Gas {
        added: Profile::SmoothStep {
            from: 0.0,
            to: added,
            begin: 0.0,
            end: blown,
        },
        ..Gas::default()
    };
    let model = pillow
        .film(20.0)
        .with_gas(pillow.faces(), gas, x)
        .expect("valid");
    let plate = |sign: f64| {
        let keys = [(0.0, 0.08), (blown, 0.08), (pressed, 0.006)];
        let keys = keys.map(|(t, height)| Keyframe {
            t,
            pose: Isometry3::translation(0.1, 0.1, sign * (height + 0.01)),
        });
        let shape = Shape::Cuboid {
            half: [0.2, 0.2, 0.01],
        };
        Obstacle::new(shape, keys.to_vec()).expect("valid")
    };
    let mut contacts = Contacts::new(&model, ContactOptions::for_sheet(&model)).expect("valid");
    for sign in [1.0, -1.0] {
        let plate = plate(sign);
        contacts = contacts
            .with_body(plate, Coefficients::FRICTIONLESS)
            .expect("apart");
    }
    let mut run = simulation(model, x, Method::Bdf2(Default::default()))
        .with_contact(contacts)
        .expect("apart");
    let step = |run: &mut Simulation| run.step(2.5e-3).expect("accepted");
    let before = (0..80).map(|_| step(&mut run)).last().expect("steps");
    let after = (0..160).map(|_| step(&mut run)).last().expect("steps");
    let x = &run.state().x;
    let part = volume(&pillow.outwards, x) / (first + added);
    let of_air = 101_325.0 * (first + added) * (part - 1.0 - part.ln());
    let elastic = run.model().elastic_sheet().expect("a film");
    let here = At::new(run.state().t, x);
    let others = elastic.energy(here) + pillow.glue().energy(here);
    // (The energy of the contact, some per cent, is none of the model.)
    let stored = run.model().potential_energy(run.state().t, x) - others;
    assert!(
        part < 0.5 && (stored / of_air - 1.0).abs() < 0.01,
        "{part}: {stored} {of_air}"
    );
    let work = after.work - before.work;
    let lost = (after.energy_drift - before.energy_drift).abs();
    assert!(
        of_air > 0.9 * work && lost < 0.05 * work,
        "{work}: {of_air} {lost}"
    );
}

/// A square pillow that is blown up approaches the volume of a tea bag from below as its mesh is refined:
/// about `w^3 (1 / pi - 0.142 (1 - 10^-1))` for the width `w` (Robin, Mathematics Today 40, 2004), and no
/// more than 0.217 `w^3`. Wrinkles that are finer than the mesh are missing.
#[test]
fn a_pillow_approaches_the_volume_of_a_tea_bag() {
    let blown = |cells: usize| {
        let pillow = Pillow::new(cells);
        let rising = Profile::SmoothStep {
            from: 0.0,
            to: 500.0,
            begin: 0.0,
            end: 0.5,
        };
        let model = pillow.film(20.0).with_pressure(pillow.faces(), rising);
        let mut run = simulation(
            model.expect("valid"),
            pillow.sheet.positions(),
            implicit_euler(),
        );
        for _ in 0..70 {
            run.step(0.01).expect("accepted");
        }
        assert!(speed(&run) < 1e-3);
        volume(&pillow.outwards, &run.state().x) / SIDE.powi(3)
    };
    let tea_bag = 1.0 / PI - 0.142 * 0.9;
    let [coarse, fine] = [8, 16].map(blown);
    assert!(
        coarse < fine && fine < 0.217 && fine > 0.6 * tea_bag,
        "{coarse} {fine}"
    );
}

/// Sze, Liu and Lo (Finite Elements in Analysis and Design 40, 2004): a moment `2 pi E I / L` at its end
/// bends a cantilever to a full circle.
#[test]
fn a_moment_bends_a_strip_to_a_circle() {
    // A part of the time of its slowest motion, seconds.
    const STEP: f64 = 14.4;
    let [length, width] = [12.0, 1.0];
    let union_jack = generate::Diagonals::UnionJack;
    let strip = generate::grid(52, 4, length + 1.0, width, union_jack).expect("valid");
    let strip = strip
        .map_positions(|[x, y, z]| [x - 1.0, y, z])
        .expect("valid");
    let clamp = strip.vertices_where(|[x, ..]| x < 1e-9);
    let tip = strip.vertices_where(|[x, ..]| x > length - 1e-9);
    let topology = strip.topology();
    let is_at_tip = |e: &EdgeId| {
        let ends = topology.edges()[e.index()];
        ends.iter().all(|v| tip.contains(v))
    };
    let edges: Vec<EdgeId> = topology.edge_ids().filter(is_at_tip).collect();
    let material = Isotropic {
        youngs: 1.2e6,
        thickness: 0.1,
        density: 1e3,
        poisson: 0.0,
    };
    let material = Material::isotropic(material).expect("valid");
    for part in [0.5, 1.0] {
        let size = Profile::Ramp {
            from: 0.0,
            to: part * TAU * material.rigidity * width / length,
            begin: 0.0,
            end: 40.0 * STEP,
        };
        let x = strip.positions();
        let moment = EdgeMoment::new(topology, &edges, [0.0, -1.0, 0.0], size, x).expect("valid");
        let model = SheetModel::of_material(&strip, &material).clamped(&clamp);
        let model = model.build().expect("valid").with_edge_moment(moment);
        // What velocity is left at the end of the next step is a ten-thousandth.
        let model = model.with_damping(1e4_f64.ln() / STEP).expect("valid");
        let mut run = simulation(model, x, implicit_euler());
        for _ in 0..70 {
            run.step(STEP).expect("accepted");
        }
        // Loads that follow the sheet settle to a thousandth in a step.
        assert!(speed(&run) * STEP < 1e-2 * length);
        // An arc of the angle that the moment asks for.
        let angle = part * TAU;
        let [u, w] = [angle.sin(), 1.0 - angle.cos()].map(|c| c * length / angle);
        for v in &tip {
            let [x, _, z] = [0, 1, 2].map(|k| run.state().x[3 * v.index() + k]);
            let error = (x - u).hypot(z - w) / length;
            assert!(error < 0.01, "{part}: [{x}, {z}], not [{u}, {w}]");
        }
    }
}

/// A film on a frame bears a pressure: the pins carry the pressure on the area of the frame, whatever the
/// film does.
#[test]
fn a_frame_carries_the_pressure_on_its_area() {
    let side = 0.2;
    let sheet = generate::grid(12, 12, side, side, generate::Diagonals::UnionJack).expect("valid");
    let frame: Vec<VertexId> = sheet
        .topology()
        .vertex_ids()
        .filter(|v| sheet.topology().is_boundary_vertex(*v))
        .collect();
    let faces = LoadedFaces::all(sheet.topology()).expect("faces");
    let model = film(&sheet, STIFFNESS, ElasticSheet::LIMIT)
        .with_damping(100.0)
        .expect("valid")
        .with_pins(&frame)
        .expect("valid")
        .with_pressure(faces, 300.0)
        .expect("valid");
    let mut run = simulation(model, sheet.positions(), implicit_euler());
    let mut factorisations = 0;
    for _ in 0..100 {
        factorisations += run.step(0.02).expect("accepted").factorisations;
    }
    let sum: Vector3<f64> = run.reactions().iter().map(|r| r.force).sum();
    let want = Vector3::new(0.0, 0.0, -300.0 * side * side);
    assert!(
        (sum - want).norm() < 1e-6 * want.norm(),
        "{sum}, {factorisations}"
    );
    assert!(factorisations < 400, "{factorisations}");
}

/// A square of film and one of rods fly in a pressure on one side of them, which has no potential: the work
/// closes the balance of energy at the order of the method.
#[test]
fn the_work_of_a_pressure_closes_the_energy_balance() {
    let sheet = generate::grid(6, 6, 0.2, 0.2, generate::Diagonals::UnionJack).expect("valid");
    let bent = sheet
        .map_positions(|[x, y, z]| [x, y, z + 0.3 * x * y])
        .expect("valid");
    let size = Profile::Sine {
        mean: 5.0,
        amplitude: 5.0,
        frequency: 3.0,
        phase: 0.0,
    };
    let of_film = || film(&bent, 50.0, 0.3);
    let of_rods = || SheetModel::new(&bent, 2e-3, MassKind::Lumped).expect("valid");
    let drift = |model: SheetModel, steps: usize| {
        let faces = LoadedFaces::all(bent.topology()).expect("faces");
        let model = model.with_pressure(faces, size.clone()).expect("valid");
        let mut run = simulation(model, bent.positions(), Method::Bdf2(Default::default()));
        let step = |_| run.step(0.1 / steps as f64).expect("accepted");
        let report = (0..steps).map(step).last().expect("steps");
        (report.energy_drift / report.work).abs()
    };
    let models: [&dyn Fn() -> SheetModel; 2] = [&of_film, &of_rods];
    for (name, model) in ["film", "rods"].into_iter().zip(models) {
        let drifts = [50, 100, 200].map(|steps| drift(model(), steps));
        assert!(
            drifts[1] < 0.3 * drifts[0] && drifts[2] < 0.3 * drifts[1],
            "{name}: {drifts:?}"
        );
    }
}
