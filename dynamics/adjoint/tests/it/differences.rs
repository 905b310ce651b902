//! Gradients of runs without contact.

use crate::problems::{as_meshed, exact};
use crate::support::{bdf2, checked, shell};
use isosheet_adjoint::{Plan, Scene, SceneError, coordinate};
use isosheet_dynamics::{
    Air, CreaseSpring, CreaseSprings, Curl, Curvature, ElasticSheet, Gas, LoadedFaces, Material,
    MaterialDirection, Method, NaturalTensor, PlateBending, PlateStiffness, Profile, SheetModel,
    State, VertexLoad, Wind,
};
use isosheet_mesh::{FaceId, MassKind, Sheet, VertexId, generate};

/// A film that is soft in its plane. (Steps of stiffer sheets end where the round-off of their energy hides
/// what is left of the forces, a part 1e-5 of them, and differences of runs are no better.)
fn film() -> Material {
    let mut film = Material::office_paper();
    film.stiffness = 300.0;
    film.rigidity = 2e-4;
    film
}

/// A shell of rods that hangs by a corner: gravity, a wind of acceleration, and where the corner moves to.
#[test]
fn hanging_rods() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = shell()?;
        let corner = VertexId(0);
        let [x, y, z] = sheet.position(corner);
        let (lift, push) = (p[1], p[2]);
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_acceleration([0.0, push, -p[0]])
            .with_moving_pin(corner, move |t: f64| [x, y, z + lift * t * t])?;
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 8);
    let loss = coordinate(40, 2, 8);
    checked(
        "hanging rods",
        &family,
        &[9.8, 0.3, 0.2],
        &plan,
        &loss,
        1e-6,
    );
}

/// An elastic membrane that hangs by two corners.
#[test]
fn hanging_membrane() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::isotropic_square(2, 0.2)?;
        let model = SheetModel::new(&sheet, p[2], MassKind::Lumped)?
            .with_acceleration([0.0, 0.1, -p[0]])
            .with_pins(&[VertexId(0), VertexId(8)])?
            .with_elastic_sheet(ElasticSheet::new(&sheet, p[1], p[3])?)?;
        Ok(as_meshed(model, &sheet))
    };
    for (name, method) in [
        ("hanging membrane, BDF2", bdf2()),
        ("hanging membrane, Euler", Method::ImplicitEuler(exact())),
    ] {
        let plan = Plan::steps(method, 1e-2, 12);
        let loss = coordinate(40, 2, 12);
        let numbers = [9.8, 300.0, 4e-3, 0.3];
        checked(name, &family, &numbers, &plan, &loss, 1e-6);
    }
}

/// A strip of film that is clamped at one end and bends under its weight: rigidity, stiffness, Poisson's
/// ratio, density.
#[test]
fn clamped_film() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(10, 3, 0.2, 0.06)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
        let mut material = Material::office_paper();
        material.rigidity = p[0];
        material.stiffness = p[1];
        material.poisson = p[2];
        material.density = p[3];
        let model = SheetModel::of_material(&sheet, &material)
            .clamped(&clamp)
            .build()?
            .with_acceleration([0.0, 0.0, -p[4]]);
        Ok(as_meshed(model, &sheet))
    };
    let film = film();
    let numbers = [
        film.rigidity,
        film.stiffness,
        film.poisson,
        film.density,
        9.8,
    ];
    for (name, method, h) in [
        ("clamped film, BDF2", bdf2(), 1e-2),
        ("clamped film, at rest", Method::Equilibrium(exact()), 1.0),
    ] {
        let count = if h < 1.0 { 10 } else { 1 };
        let plan = Plan::steps(method, h, count);
        let loss = coordinate(10, 2, count);
        checked(name, &family, &numbers, &plan, &loss, 1e-6);
    }
}

/// A plate without a membrane's slack: rods, with a plate.
#[test]
fn rods_with_a_plate() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = shell()?;
        let plate = PlateStiffness {
            rigidity: p[0],
            poisson: p[1],
        };
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_gravity()
            .with_pins(&[VertexId(0)])?
            .with_potential(PlateBending::new(&sheet, plate)?);
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 6);
    let loss = coordinate(40, 2, 6);
    checked(
        "rods with a plate",
        &family,
        &[5e-4, 0.3],
        &plan,
        &loss,
        1e-6,
    );
}

/// A strip whose end is pulled and turned by moving pins, with a load on its middle: the numbers of the
/// motion, and the load.
#[test]
fn pulled_and_turned() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(10, 3, 0.2, 0.06)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
        let led = sheet.vertices_where(|[x, _, _]| x > 0.175);
        let mut model = SheetModel::of_material(&sheet, &Material::office_paper())
            .clamped(&clamp)
            .build()?
            .with_gravity();
        let (lift, turn) = (p[0], p[1]);
        for v in led {
            let [x, y, z] = sheet.position(v);
            model = model.with_moving_pin(v, move |t: f64| {
                let angle: f64 = turn * t * t;
                let (sin, cos) = angle.sin_cos();
                let arm = x - 0.19;
                [
                    x - arm + arm * cos - 0.2 * t * t,
                    y,
                    z + lift * t * t + arm * sin,
                ]
            })?;
        }
        let middle = sheet.vertices_where(|[x, _, _]| (x - 0.1).abs() < 1e-6);
        let size = Profile::Ramp {
            from: 0.0,
            to: p[2],
            begin: 0.0,
            end: 0.1,
        };
        let load = VertexLoad::new(sheet.topology(), &middle, [0.0, 0.3, 1.0], size)?;
        let model = model.with_force(load);
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 10);
    let loss = coordinate(5, 2, 10);
    checked(
        "pulled and turned",
        &family,
        &[0.5, 2.0, 1e-3],
        &plan,
        &loss,
        1e-6,
    );
}

/// A sheet that folds at a crease whose rest angle changes, with the curl of its halves.
#[test]
fn folded_and_curled() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(8, 3, 0.16, 0.06)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
        let t = sheet.topology();
        let on_line = |v: VertexId| (sheet.position(v)[0] - 0.08).abs() < 1e-9;
        let edges = t
            .edge_ids()
            .filter(|e| t.edges()[e.index()].iter().all(|v| on_line(*v)));
        let edges: Vec<_> = edges.filter(|e| !t.is_boundary_edge(*e)).collect();
        let springs = edges.iter().map(|edge| CreaseSpring {
            edge: *edge,
            stiffness: p[1],
            rest: Profile::Ramp {
                from: 0.0,
                to: p[0],
                begin: 0.0,
                end: 0.1,
            }
            .into(),
            yields: None,
            in_series: None,
        });
        let springs = CreaseSprings::new(t, springs.collect())?;
        let curl = Curl {
            direction: MaterialDirection::Uniform([1.0, 0.2, 0.0]),
            curvature: NaturalTensor::Uniform(Curvature {
                along: p[2],
                ..Curvature::default()
            }),
            profile: 1.0.into(),
        };
        let model = SheetModel::of_material(&sheet, &film())
            .clamped(&clamp)
            .creased(&edges)
            .curled(curl)
            .build()?
            .with_gravity()
            .with_potential(springs);
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 10);
    let loss = coordinate(8, 2, 10);
    checked("folded", &family, &[0.8, 2e-3, 1.5], &plan, &loss, 1e-6);
}

/// Patches of other materials: the rigidity of one, the stiffness of another one, the curl of a third one.
#[test]
fn patches() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(12, 4, 0.18, 0.06)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.016);
        let t = sheet.topology();
        let beyond = |face: &FaceId, x: f64| {
            let corners = t.faces()[face.index()];
            corners.iter().all(|v| sheet.position(*v)[0] > x - 1e-9)
        };
        let of = |stiffness: f64, rigidity: f64| {
            let mut own = film();
            (own.stiffness, own.rigidity) = (stiffness, rigidity);
            own
        };
        let from = |x: f64| {
            t.face_ids()
                .filter(|f| beyond(f, x))
                .collect::<Vec<FaceId>>()
        };
        let curl = |face: FaceId| Curvature {
            along: if beyond(&face, 0.135) { p[2] } else { 1.0 },
            ..Curvature::default()
        };
        let model = SheetModel::of_material(&sheet, &film())
            .clamped(&clamp)
            .with_patch(from(0.045), &of(p[1], 3e-4))
            .with_patch(from(0.09), &of(300.0, p[0]))
            .curled(Curl {
                direction: MaterialDirection::Uniform([1.0, 0.2, 0.0]),
                curvature: NaturalTensor::Faces(t.face_ids().map(curl).collect()),
                profile: 1.0.into(),
            })
            .build()?
            .with_gravity();
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 8);
    let loss = coordinate(12, 2, 8);
    checked("patches", &family, &[4e-4, 400.0, 2.0], &plan, &loss, 1e-6);
}

/// The rest shape: coordinates of the mesh move with the start.
#[test]
fn another_rest_shape() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let grid = generate::anisotropic_grid(8, 3, 0.16, 0.06)?;
        let sheet = grid
            .map_positions(|[x, y, z]| [x * (1.0 + p[0] * y), y + p[1] * x * x * (0.16 - x), z])?;
        let clamp = grid.vertices_where(|[x, _, _]| x < 0.025);
        let model = SheetModel::of_material(&sheet, &film())
            .clamped(&clamp)
            .build()?
            .with_gravity();
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 8);
    let loss = coordinate(8, 2, 8);
    checked("another shape", &family, &[0.5, 2.0], &plan, &loss, 1e-6);
}

/// Coordinates of the mesh of paper, which is stiff in its plane, and under its weight strained by 1e-7.
#[test]
fn another_rest_shape_of_paper() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let grid = generate::anisotropic_grid(8, 4, 0.2, 0.1)?;
        let mut x = grid.positions().to_vec();
        x[3 * 44] = p[0];
        x[3 * 20 + 1] += p[1];
        let faces = grid.topology().faces().iter().map(|f| f.map(|v| v.0));
        let sheet = Sheet::new(x, &faces.collect::<Vec<_>>())?;
        let clamp = grid.vertices_where(|[x, _, _]| x < 1e-9);
        let model = SheetModel::of_material(&sheet, &Material::office_paper())
            .build()?
            .with_pins(&clamp)?
            .with_damping(3.0)?
            .with_gravity();
        Ok(as_meshed(model, &sheet))
    };
    let loss = coordinate(44, 2, 10);
    let plan = Plan::steps(bdf2(), 1e-2, 10);
    // The second one is a twentieth of the first one.
    checked("paper", &family, &[0.2, 1e-4], &plan, &loss, 1e-3);
}

/// A film that swells. Its steps end where the round-off of the energy of its strain hides what is left of
/// the forces.
#[test]
fn swollen() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(8, 3, 0.16, 0.06)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
        let model = SheetModel::of_material(&sheet, &film())
            .clamped(&clamp)
            .swelling(p[0])
            .build()?
            .with_gravity();
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 8);
    let loss = coordinate(8, 2, 8);
    checked("swollen", &family, &[1e-3], &plan, &loss, 5e-5);
}

/// A flag in the wind: its velocity, the density of the air, the damping, and the motion of a corner.
#[test]
fn in_the_wind() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = shell()?;
        let [x, y, z] = [p[0], 1.0, 0.3].map(Profile::from);
        let air = Air {
            density: p[1],
            wind: Wind::Uniform([x, y, z]),
            ..Air::default()
        };
        let [a, b, c] = sheet.position(VertexId(8));
        let drive = p[3];
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_gravity()
            .with_pins(&[VertexId(0)])?
            .with_moving_pin(VertexId(8), move |t: f64| [a, b, c + drive * t * t])?
            .with_elastic_sheet(ElasticSheet::new(&sheet, 300.0, 0.3)?)?
            .with_damping(p[2])?
            .with_air(air)?;
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 10);
    let loss = coordinate(40, 1, 10);
    let numbers = [3.0, 1.2, 0.7, 2.0];
    checked("in the wind", &family, &numbers, &plan, &loss, 1e-6);
}

/// Positions and velocities at the start, against differences of runs.
#[test]
fn the_state_at_the_start() {
    let family = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::anisotropic_grid(8, 3, 0.16, 0.06)?;
        let clamp = sheet.vertices_where(|[x, _, _]| x < 0.025);
        let model = SheetModel::of_material(&sheet, &film())
            .clamped(&clamp)
            .build()?
            .with_gravity();
        let n = 3 * sheet.topology().vertex_count();
        let mut start = State::moving(sheet.positions().to_vec(), vec![0.0; n]);
        start.x[3 * 8 + 2] += p[0];
        start.v[3 * 8 + 2] += p[1];
        start.x[5] += p[2];
        Ok(Scene::new(model, start))
    };
    let plan = Plan::steps(bdf2(), 1e-2, 8);
    let loss = coordinate(17, 2, 8);
    let numbers = [1e-4, 0.1, 2e-4];
    let gradient = checked("start", &family, &numbers, &plan, &loss, 1e-6);
    let of = &gradient.of_start;
    for (found, expected) in [of.x[26], of.v[26], of.x[5]]
        .iter()
        .zip(&gradient.of_numbers)
    {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
}

/// A membrane that a pressure blows up, held by its edge, which tilts, and a tent that a gas blows up.
#[test]
fn blown_up() {
    let open = |p: &[f64]| -> Result<Scene, SceneError> {
        let sheet = generate::isotropic_square(2, 0.2)?;
        let faces = LoadedFaces::all(sheet.topology())?;
        let t = sheet.topology();
        let edge: Vec<VertexId> = t
            .vertex_ids()
            .filter(|v| t.is_boundary_vertex(*v))
            .collect();
        let mut model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_elastic_sheet(ElasticSheet::new(&sheet, p[1], 0.3)?)?
            .with_pressure(faces, p[0])?;
        let drive = p[2];
        for v in edge {
            let [x, y, z] = sheet.position(v);
            model = model.with_moving_pin(v, move |t: f64| [x, y, z + drive * x * t * t])?;
        }
        Ok(as_meshed(model, &sheet))
    };
    let plan = Plan::steps(bdf2(), 5e-3, 10);
    let loss = coordinate(20, 2, 10);
    checked("blown up", &open, &[5.0, 300.0, 3.0], &plan, &loss, 1e-6);
    let closed = |p: &[f64]| -> Result<Scene, SceneError> {
        let corners = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1];
        let tent = Sheet::new(corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
        let sheet = generate::split_1_4(&generate::split_1_4(&tent)?)?;
        let faces = LoadedFaces::all(sheet.topology())?;
        let gas = Gas {
            pressure: Gas::default().ambient + p[0],
            exponent: p[1],
            ..Gas::default()
        };
        let model = SheetModel::new(&sheet, 4e-3, MassKind::Lumped)?
            .with_gravity()
            .with_pins(&[VertexId(0)])?
            .with_elastic_sheet(ElasticSheet::new(&sheet, 300.0, 0.3)?)?
            .with_gas(faces, gas, sheet.positions())?;
        Ok(as_meshed(model, &sheet))
    };
    let loss = coordinate(3, 2, 10);
    checked("gas", &closed, &[30.0, 1.4], &plan, &loss, 1e-6);
}
