//! Directions of materials by the texture coordinates of meshes.

use isosheet_dynamics::Simulation;
use isosheet_mesh::{Sheet, generate};
use isosheet_scenes::SceneFile;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The simulation of a scene in a folder.
fn simulation(folder: &Path, text: &str) -> Result<Simulation, String> {
    let scene = SceneFile::parse(text.into(), &folder.join("scene.toml"), &[]);
    let started = scene
        .map_err(|e| e.to_string())?
        .build()
        .and_then(|setup| setup.start());
    started.map_err(|e| e.to_string())
}

/// An OBJ file with texture coordinates of its vertices; the faces from `bare` on have none.
fn obj(sheet: &Sheet, uv: impl Fn([f64; 3]) -> [f64; 2], bare: usize) -> String {
    let mut text = String::new();
    for p in sheet.positions().as_chunks::<3>().0 {
        let ([x, y, z], [u, v]) = (p, uv(*p));
        writeln!(text, "v {x} {y} {z}\nvt {u} {v}").unwrap();
    }
    for (k, face) in sheet.face_indices().into_iter().enumerate() {
        let [a, b, c] = face.map(|v| v + 1);
        match k < bare {
            true => writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}").unwrap(),
            false => writeln!(text, "f {a} {b} {c}").unwrap(),
        }
    }
    text
}

/// A sheet of paper that is clamped along one side and bends under its weight.
fn scene(direction: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmaterial = \"office paper\"\ndirection = {direction}\ndamping = 4\nrefine = 1\n\
         mesh = {{ file = {{ path = \"sheet.obj\" }} }}\nplacement = {{ turn = {{ axis = [0, 0, 1], angle = 30 }} }}\n\
         [forces]\ngravity = [0, 0, -9.81]\n[[support]]\n\
         at = {{ half_space = {{ point = [0, 0, 0], normal = [-0.8660254037844386, -0.5, 0] }} }}\nhold = \"clamp\""
    )
}

/// Where vertices come to be.
fn bent(folder: &Path, direction: &str) -> Vec<f64> {
    let mut simulation = simulation(folder, &scene(direction)).unwrap();
    for _ in 0..20 {
        simulation.step(1.0 / 60.0).unwrap();
    }
    simulation.state().x.clone()
}

fn off(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// Texture coordinates of any size that are turned by 45 degrees are the direction [1, 1, 0], the second one
/// that across it: at the end of the sheet these differ.
#[test]
fn turned_texture_coordinates_are_a_turned_direction() {
    let dir = tempfile::tempdir().unwrap();
    let sheet = generate::grid(6, 3, 0.2, 0.1, generate::Diagonals::Rising).unwrap();
    let uv = |[x, y, _]: [f64; 3]| [0.3 + 7.0 * (x + y), 2.0 * (y - x)];
    fs::write(dir.path().join("sheet.obj"), obj(&sheet, uv, usize::MAX)).unwrap();
    let [along, across] = ["{ uv = \"u\" }", "{ uv = \"v\" }"].map(|uv| bent(dir.path(), uv));
    let [expected, other] = ["[1, 1, 0]", "[1, -1, 0]"].map(|vector| bent(dir.path(), vector));
    assert!(off(&along, &expected) < 1e-9, "{}", off(&along, &expected));
    assert!(off(&across, &other) < 1e-9, "{}", off(&across, &other));
    assert!(off(&along, &across) > 1e-4, "{}", off(&along, &across));
}

/// On a cylinder the direction follows the faces: that along its axis is the same vector everywhere.
#[test]
fn directions_follow_the_faces_of_a_curved_sheet() {
    let dir = tempfile::tempdir().unwrap();
    let flat = generate::grid(6, 3, 0.2, 0.1, generate::Diagonals::Rising).unwrap();
    let radius = 0.1;
    let rolled = flat.map_positions(|[x, y, _]| {
        [
            radius * (x / radius).sin(),
            y,
            radius * (1.0 - (x / radius).cos()),
        ]
    });
    let uv = |[x, y, z]: [f64; 3]| [radius * x.atan2(radius - z), y];
    fs::write(
        dir.path().join("sheet.obj"),
        obj(&rolled.unwrap(), uv, usize::MAX),
    )
    .unwrap();
    let scene = |direction: &str| {
        scene(direction).replace("damping = 4\n", "damping = 4\nrest = \"mesh\"\n")
    };
    let bent = |direction: &str| {
        let mut simulation = simulation(dir.path(), &scene(direction)).unwrap();
        for _ in 0..20 {
            simulation.step(1.0 / 60.0).unwrap();
        }
        simulation.state().x.clone()
    };
    let [along, around] = ["{ uv = \"v\" }", "{ uv = \"u\" }"].map(bent);
    let expected = bent("[0, 1, 0]");
    assert!(off(&along, &expected) < 1e-9, "{}", off(&along, &expected));
    assert!(off(&around, &expected) > 1e-4);
}

#[test]
fn faces_without_texture_are_refused_by_their_number() {
    let dir = tempfile::tempdir().unwrap();
    let sheet = generate::grid(6, 3, 0.2, 0.1, generate::Diagonals::Rising).unwrap();
    let message = |content: String| {
        fs::write(dir.path().join("sheet.obj"), content).unwrap();
        simulation(dir.path(), &scene("{ uv = \"u\" }"))
            .err()
            .unwrap()
    };
    let plane = |[x, y, _]: [f64; 3]| [x, y];
    let found = message(obj(&sheet, plane, 0));
    assert!(
        found.contains("the mesh of the sheet has no texture coordinates"),
        "{found}"
    );
    let found = message(obj(&sheet, plane, 5));
    assert!(
        found.contains("face 5 of the mesh has no texture coordinates"),
        "{found}"
    );
    let found = message(obj(&sheet, |[x, ..]| [x, 2.0 * x], usize::MAX));
    assert!(
        found.contains("face 0 of the mesh has no area in the texture"),
        "{found}"
    );
    let generated = scene("{ uv = \"u\" }").replace(
        "mesh = { file = { path = \"sheet.obj\" } }",
        "mesh = { square = { side = 0.2, level = 1 } }",
    );
    let found = simulation(dir.path(), &generated).err().unwrap();
    assert!(found.contains("the mesh is from no file"), "{found}");
    let found = simulation(dir.path(), &scene("{ uv = \"w\" }"))
        .err()
        .unwrap();
    assert!(found.contains('w'), "{found}");
}
