//! Clamps, sheets that are curved at rest, and directions.

use crate::{parse, simulation};
use isosheet_dynamics::{Material, Simulation};
use isosheet_scenes::SupportForces;

/// Half a sheet of office paper, 0.2 m long, with its short edge at `x = 0`.
fn paper(lines: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmaterial = \"office paper\"\ndamping = 8\n\
         mesh = {{ rectangle = {{ width = 0.2, height = 0.04, columns = 20, rows = 4 }} }}\n{lines}\n"
    )
}

const EDGE: &str = "at = { box = { min = [-1, -1, -1], max = [1e-6, 1, 1] } }";

/// Gravity for which the weight of the sheet is ten times what its stiffness is, `q L^3 / D = 10`.
fn heavy() -> (f64, String) {
    let Material {
        rigidity, density, ..
    } = Material::office_paper();
    let load = 10.0 * rigidity / 0.2_f64.powi(3);
    let gravity = load / density;
    (load, format!("[forces]\ngravity = [0, 0, -{gravity}]\n"))
}

fn refused(text: &str) -> String {
    match parse(text).map_err(|e| e.to_string()) {
        Err(error) => error,
        Ok(scene) => match scene.build() {
            Err(error) => error.to_string(),
            Ok(_) => panic!("accepted:\n{text}"),
        },
    }
}

fn settle(simulation: &mut Simulation, seconds: f64) {
    let h = 1.0 / 60.0;
    for _ in 0..(seconds / h) as usize {
        simulation.step(h).unwrap();
    }
}

/// The mean place of the vertices at the free end, metres.
fn tip(simulation: &Simulation, start: &[f64]) -> [f64; 3] {
    let places = simulation.state().x.as_chunks::<3>().0.iter();
    let end = places
        .zip(start.as_chunks::<3>().0)
        .filter(|(_, s)| s[0] > 0.2 - 1e-6);
    let end: Vec<&[f64; 3]> = end.map(|(p, _)| p).collect();
    std::array::from_fn(|k| end.iter().map(|p| p[k]).sum::<f64>() / end.len() as f64)
}

/// One line of vertices clamps a sheet: the heavy elastica for `q L^3 / D = 10` ends at `x = 0.65635 L`, and
/// `0.70020 L` below. Force and torque of the support are the weight and its moment.
#[test]
fn a_sheet_that_is_clamped_along_a_line_is_the_heavy_elastica() {
    let (load, gravity) = heavy();
    let text = paper(&format!("{gravity}[[support]]\n{EDGE}\nhold = \"clamp\""));
    let setup = parse(&text).unwrap().build().unwrap();
    let (start, facts) = (setup.start.x.clone(), setup.facts.clone());
    let mut simulation = setup.start().unwrap();
    let supports = SupportForces::new(facts, &simulation, 1);
    settle(&mut simulation, 3.0);
    let [x, _, z] = tip(&simulation, &start);
    let found = [x / 0.2, -z / 0.2];
    for (found, expected) in found.into_iter().zip([0.65635, 0.70020]) {
        assert!((found - expected).abs() < 0.03, "{found} {expected}");
    }
    let held = supports.loads(&simulation).next().unwrap();
    let weight = load * 0.2 * 0.04;
    assert!((held.force[2] / weight - 1.0).abs() < 1e-3, "{held:?}");
    // About the y axis, against the moment of the weight about the line.
    let masses = &simulation.model().mass().vertex;
    let total = simulation.model().mass().total();
    let places = simulation.state().x.as_chunks::<3>().0.iter();
    let arm: f64 = places.zip(masses).map(|(p, m)| m * p[0] / total).sum();
    let moment = -weight * arm;
    assert!(
        (held.torque[1] / moment - 1.0).abs() < 1e-2,
        "{held:?} {moment}"
    );
}

/// A line of pins is called what it is to a sheet with bending stiffness.
#[test]
fn a_line_of_pins_is_called_a_hinge() {
    let modelled = |lines: &str| {
        let lines = format!("{lines}\n[[support]]\n{EDGE}\nhold = ");
        move |hold: &str| {
            let text = paper(&format!("{lines}{hold}"));
            let setup = parse(&text).unwrap().build().unwrap();
            let mut modelled = setup.modelled.iter();
            modelled.any(|what| what == "a hinge at `support[0]`")
        }
    };
    let turning =
        "{ moving_pin = { rotation = { centre = [0, 0, 0], axis = [0, 1, 0], angle = 0 } } }";
    let plate = modelled("");
    assert!(plate("\"pin\"") && plate("{ moving_pin = { z = 0 } }"));
    assert!(!plate("\"clamp\"") && !plate(turning));
    let limp = modelled("isometry = \"rods\"\nbending = \"none\"");
    assert!(
        !limp("\"pin\""),
        "without stiffness all supports are hinges"
    );
}

/// A clamp that turns by a right angle and moves takes a weightless sheet with it as a rigid body.
#[test]
fn a_clamp_that_turns_takes_the_sheet_with_it() {
    let motion = "{ z = { smooth_step = { to = 0.05, end = 1 } }, rotation = { centre = [0, 0, 0], \
                  axis = [0, 1, 0], angle = { smooth_step = { to = 90, end = 1 } } } }";
    let text = paper(&format!(
        "[[support]]\n{EDGE}\nhold = {{ moving_clamp = {motion} }}"
    ));
    let setup = parse(&text).unwrap().build().unwrap();
    let start = setup.start.x.clone();
    let mut simulation = setup.start().unwrap();
    settle(&mut simulation, 3.0);
    let [x, _, z] = tip(&simulation, &start);
    assert!(x.abs() < 1e-3 && (z - (0.05 - 0.2)).abs() < 1e-3, "{x} {z}");
}

/// Two clamps, of which one slides: under its weight the sheet sags as a beam that is built in at both ends,
/// by `q L^4 / (384 D)`, without tension.
#[test]
fn a_clamp_that_slides_holds_the_slope_alone() {
    let Material {
        rigidity, density, ..
    } = Material::office_paper();
    let sag = 5e-4;
    let gravity = 384.0 * rigidity * sag / 0.2_f64.powi(4) / density;
    let far = "at = { box = { min = [0.1999, -1, -1], max = [1, 1, 1] } }";
    let beam = format!("bending = {{ plate = {{ rigidity = {rigidity}, poisson = 0 }} }}");
    let text = paper(&format!(
        "{beam}\n[forces]\ngravity = [0, 0, -{gravity}]\n[[support]]\n{EDGE}\nhold = \"clamp\"\n\
         [[support]]\n{far}\nhold = {{ sliding_clamp = {{ direction = [1, 0, 0] }} }}"
    ));
    let mut simulation = simulation(&text);
    settle(&mut simulation, 3.0);
    let lowest = simulation.state().x.as_chunks::<3>().0.iter();
    let lowest = lowest.map(|p| p[2]).fold(0.0, f64::min);
    assert!((-lowest / sag - 1.0).abs() < 0.03, "{lowest}");
}

/// A sheet of rods is clamped by the faces at the line.
#[test]
fn rods_are_clamped_by_faces() {
    let support = format!("[[support]]\n{EDGE}\nhold = \"clamp\"");
    let rods = paper(&format!(
        "isometry = \"rods\"\nbending = {{ hinges = {{ rigidity = 5e-4 }} }}\n{support}"
    ));
    let pins = |text: &str| simulation(text).model().pins().len();
    assert_eq!(pins(&paper(&support)), 5, "the line");
    let pinned = pins(&rods);
    assert!(
        (6..=10).contains(&pinned),
        "the line and the next: {pinned}"
    );
}

#[test]
fn a_mesh_that_is_curved_at_rest_stays_so() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("arc.obj");
    let mut text = String::new();
    let (columns, radius) = (12, 0.1);
    for k in 0..=columns {
        let angle = f64::from(k) * 0.1;
        for y in [0.0, 0.02, 0.04] {
            let [x, z] = [radius * angle.sin(), radius * (1.0 - angle.cos())];
            text += &format!("v {x} {y} {z}\n");
        }
    }
    for k in 0..columns {
        for j in 1..=2 {
            let a = 3 * k + j;
            text += &format!("f {} {} {} {}\n", a, a + 3, a + 4, a + 1);
        }
    }
    std::fs::write(&mesh, text).unwrap();
    let moved = |rest: &str, bending: &str| {
        let scene = format!(
            "version = 1\n[sheet]\nmesh = {{ file = {{ path = \"{}\", polygons = \"triangulate\" }} }}\nmaterial = \"office paper\"\n{rest}\n{bending}\n",
            mesh.display()
        );
        let setup = parse(&scene).unwrap().build().unwrap();
        let start = setup.start.x.clone();
        let mut simulation = setup.start().unwrap();
        settle(&mut simulation, 0.1);
        let pairs = simulation.state().x.iter().zip(&start);
        pairs.map(|(x, s)| (x - s).abs()).fold(0.0, f64::max)
    };
    for bending in ["", "bending = { hinges = { rigidity = 5e-4 } }"] {
        let stays = moved("rest = \"mesh\"", bending);
        assert!(stays < 1e-9, "{bending}: {stays}");
        assert!(moved("", bending) > 1e-3, "{bending}");
    }
}

/// A poster off a roll, which hangs from its clamped edge without weight, curls to the roll.
#[test]
fn a_poster_curls_to_its_roll() {
    let curl = "curl = { along = [1, 0, 0], radius = 0.1 }";
    let text = paper(&format!("{curl}\n[[support]]\n{EDGE}\nhold = \"clamp\""));
    let setup = parse(&text).unwrap().build().unwrap();
    let start = setup.start.x.clone();
    let mut simulation = setup.start().unwrap();
    settle(&mut simulation, 3.0);
    let [x, _, z] = tip(&simulation, &start);
    let [expected_x, expected_z] = [0.1 * 2.0_f64.sin(), 0.1 * (1.0 - 2.0_f64.cos())];
    assert!((x - expected_x).hypot(z - expected_z) < 2e-3, "{x} {z}");
}

/// A curl may be given by its radius, by its components, or by another shape of the mesh, which a file has:
/// the energy is that of the one curl.
#[test]
fn a_curl_may_be_a_tensor_or_a_shape() {
    let folder = tempfile::tempdir().unwrap();
    let rectangle = isosheet_mesh::generate::anisotropic_grid(20, 4, 0.2, 0.04).unwrap();
    let write = |name: &str, place: &dyn Fn(&[f64; 3]) -> [f64; 3]| {
        let points = rectangle.positions().as_chunks::<3>().0.iter();
        let vertices = points.map(|p| {
            let [x, y, z] = place(p);
            format!("v {x} {y} {z}\n")
        });
        let faces = rectangle.face_indices().into_iter();
        let faces = faces.map(|f| {
            let [a, b, c] = f.map(|v| v + 1);
            format!("f {a} {b} {c}\n")
        });
        let text: String = vertices.chain(faces).collect();
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    write("flat.obj", &|p| *p);
    write("roll.obj", &|[x, y, _]| {
        let angle = x / 0.1;
        [0.1 * angle.sin(), *y, 0.1 * (1.0 - angle.cos())]
    });
    let energy = |curl: &str| {
        let text = format!(
            "version = 1\n[sheet]\nmaterial = \"office paper\"\ndirection = [1, 0, 0]\n\
             mesh = {{ file = {{ path = \"flat.obj\" }} }}\ncurl = {{ {curl} }}\n[stop]\ntime = 1\n"
        );
        let path = folder.path().join("scene.toml");
        let setup = isosheet_scenes::SceneFile::parse(text, &path, &[]);
        let setup = setup.unwrap().build().unwrap();
        setup.model.potential_energy(0.0, &setup.start.x)
    };
    let radius = energy("along = [1, 0, 0], radius = 0.1");
    let expected = 0.5 * 5e-4 * 100.0 * 0.2 * 0.04;
    assert!(
        (radius / expected - 1.0).abs() < 0.05,
        "{radius} {expected}"
    );
    let tensor = energy("curvature = 10");
    assert!((tensor / radius - 1.0).abs() < 1e-12, "{tensor} {radius}");
    let shape = energy("shape = { path = \"roll.obj\" }");
    assert!((shape / radius - 1.0).abs() < 0.1, "{shape} {radius}");
    let halved = energy("shape = { path = \"roll.obj\" }, profile = 0.5");
    assert!((halved / shape - 0.25).abs() < 1e-9, "{halved} {shape}");
}

/// A strip of an orthotropic plate bends by the rigidity along it: 1 along, 4 across, at 0, 45 and 90 degrees
/// under a small load. (At 45 degrees a wide one bends by the law in the turned axes.)
#[test]
fn a_strip_bends_by_its_direction() {
    let deflection = |angle: f64| {
        let (s, c) = angle.to_radians().sin_cos();
        let bending = format!(
            "bending = {{ orthotropic = {{ direction = [{c}, {s}, 0], along = 1e-3, across = 4e-3, twist = 1e-3 }} }}"
        );
        let text = paper(&format!(
            "{bending}\n[forces]\ngravity = [0, 0, -0.01]\n[[support]]\n{EDGE}\nhold = \"clamp\""
        ));
        let setup = parse(&text).unwrap().build().unwrap();
        let start = setup.start.x.clone();
        let mut simulation = setup.start().unwrap();
        settle(&mut simulation, 4.0);
        -tip(&simulation, &start)[2]
    };
    let [along, across] = [0.0, 90.0].map(deflection);
    assert!(
        (along / across / 4.0 - 1.0).abs() < 0.02,
        "{along} {across}"
    );
    let load = 0.01 * Material::office_paper().density;
    let expected = load * 0.2_f64.powi(4) / (8.0 * 1e-3);
    assert!((along / expected - 1.0).abs() < 0.03, "{along} {expected}");
    let turned = deflection(45.0);
    assert!(
        across < turned && turned < along,
        "{across} {turned} {along}"
    );
}

#[test]
fn what_makes_no_sense_is_refused_with_a_reason() {
    let edge = format!("[[support]]\n{EDGE}\nhold = ");
    for (lines, reason) in [
        ("curl = { along = [1, 0, 0], radius = 0 }".to_owned(), "sheet.curl.radius"),
        ("curl = { along = [1, 0, 0], radius = 1e-4 }".to_owned(), "would roll up to the radius 1e-4 m"),
        ("curl = { along = [0, 0, 0], radius = 1 }".to_owned(), "sheet.curl.along"),
        ("curl = { along = [0, 0, 1], radius = 1 }".to_owned(), "no part in the plane of face 0"),
        ("curl = { along = [1, 0, 0] }".to_owned(), "how the sheet is curved"),
        ("curl = { twist = 1 }".to_owned(), "no direction"),
        ("curl = { along = [1, 0, 0], curvature = 1, radius = 1 }".to_owned(), "the same curvature"),
        (
            "curl = { twist = 1, shape = { path = \"a.obj\" } }".to_owned(),
            "by a shape and by numbers",
        ),
        (
            "bending = \"none\"\ncurl = { along = [1, 0, 0], radius = 1 }".to_owned(),
            "no plate resists bending",
        ),
        ("bending = \"none\"\nrest = \"mesh\"".to_owned(), "nothing resists bending"),
        (
            "rest = \"mesh\"\ncurl = { along = [1, 0, 0], radius = 1 }".to_owned(),
            "curls besides",
        ),
        (
            "bending = { orthotropic = { direction = [1, 0, 0], along = 1, across = 1, twist = 1, coupling = 1 } }"
                .to_owned(),
            "without resistance",
        ),
        (
            "[[support]]\nat = { vertices = [0, 50] }\nhold = \"clamp\"".to_owned(),
            "needs an edge",
        ),
        (
            format!("bending = \"none\"\n{edge}{{ sliding_clamp = {{ direction = [1, 0, 0] }} }}"),
            "holds the slope of a plate",
        ),
    ] {
        let message = refused(&paper(&lines));
        assert!(message.contains(reason), "{lines}: {message}");
    }
}
