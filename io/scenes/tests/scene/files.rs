//! Scenes with mesh files of several formats.

use isosheet_dynamics::Simulation;
use isosheet_formats::{read_mesh, write_mesh, write_obj};
use isosheet_geometry::Shape;
use isosheet_mesh::generate;
use isosheet_scenes::SceneFile;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The simulation of a scene in a folder.
fn simulation(folder: &Path, text: &str) -> Simulation {
    let scene = SceneFile::parse(text.into(), &folder.join("scene.toml"), &[]);
    let scene = scene.unwrap_or_else(|e| panic!("{e}"));
    let simulation = scene.build().and_then(|s| s.start());
    simulation.unwrap_or_else(|e| panic!("{e}"))
}

/// Checks that two simulations have equal bits after some steps.
fn agree(mut a: Simulation, mut b: Simulation) {
    let start = a.state().x.clone();
    for _ in 0..10 {
        assert_eq!(a.step(0.01).unwrap(), b.step(0.01).unwrap());
    }
    assert_eq!(a.state(), b.state());
    assert_ne!(a.state().x, start, "something moves");
}

/// The valley of a FOLD file is the crease that is named by its ends, and the file is in millimetres.
#[test]
fn creases_come_from_fold_files() {
    let dir = tempfile::tempdir().unwrap();
    let sheet = generate::grid(1, 1, 0.125, 0.125, generate::Diagonals::Rising).unwrap();
    let t = sheet.topology();
    let mut fold =
        String::from("{\"file_spec\": 1.2, \"frame_unit\": \"mm\", \"vertices_coords\": [");
    for (k, p) in sheet.positions().as_chunks::<3>().0.iter().enumerate() {
        let comma = if k == 0 { "" } else { ", " };
        write!(fold, "{comma}[{}, {}]", 1e3 * p[0], 1e3 * p[1]).unwrap();
    }
    let diagonal = t.edge_ids().find(|&e| !t.is_boundary_edge(e)).unwrap();
    let [a, b] = t.edges()[diagonal.index()].map(|v| v.0);
    let faces = sheet.face_indices();
    write!(
        fold,
        "], \"edges_vertices\": [[{a}, {b}]], \"edges_assignment\": [\"V\"], \"faces_vertices\": {faces:?}}}"
    )
    .unwrap();
    fs::write(dir.path().join("valley.fold"), fold).unwrap();
    let scene = |mesh: &str, at: &str| {
        let text = format!(
            "version = 1
            [sheet]
            mesh = {{ {mesh} }}
            [[crease]]
            at = {{ {at} }}
            stiffness = 0.01
            angle = {{ ramp = {{ to = 70.0, end = 0.1 }} }}"
        );
        simulation(dir.path(), &text)
    };
    let rectangle = "rectangle = { width = 0.125, height = 0.125, columns = 1, rows = 1, diagonals = \"rising\" }";
    let ends = format!("ends = [[{a}, {b}]]");
    agree(
        scene("file = { path = \"valley.fold\" }", "pattern = \"valleys\""),
        scene(rectangle, &ends),
    );
}

/// A body from an STL file, which shares no vertices, is that of the OBJ file it was made of.
#[test]
fn bodies_come_from_stl_files() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name| dir.path().join(name);
    let disk = generate::grid(2, 2, 1.0, 1.0, generate::Diagonals::Rising).unwrap();
    write_obj(&path("floor.obj"), disk.topology(), disk.positions()).unwrap();
    write_mesh(&path("floor.stl"), &read_mesh(&path("floor.obj")).unwrap()).unwrap();
    // Vertices have the order in which facets use them.
    write_mesh(&path("same.off"), &read_mesh(&path("floor.stl")).unwrap()).unwrap();
    let scene = |name: &str| {
        let text = format!(
            "version = 1
            [sheet]
            mesh = {{ rectangle = {{ width = 0.2, height = 0.2, columns = 2, rows = 2 }} }}
            thickness = 0.001
            placement = {{ position = [0.4, 0.4, 0.01] }}
            [[obstacle]]
            shape = {{ file = {{ path = \"{name}\" }} }}
            [forces]
            gravity = [0, 0, -9.81]"
        );
        simulation(dir.path(), &text)
    };
    agree(scene("floor.stl"), scene("same.off"));
}

/// A body of several meshes in one file is all of them; a name chooses one.
#[test]
fn bodies_are_all_meshes_of_a_file() {
    let dir = tempfile::tempdir().unwrap();
    // The triangle (0, 0), (1, 0), (0, 1) three times, side by side.
    let gltf = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [2, 0, 0]}, {"mesh": 1, "translation": [4, 0, 0]}],
        "meshes": [{"name": "block", "primitives": [{"attributes": {"POSITION": 0}}]},
            {"name": "last", "primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, -1], "max": [1, 0, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36,
            "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAAAAAIC/"}]}"#;
    fs::write(dir.path().join("blocks.gltf"), gltf).unwrap();
    let body = |more: &str| {
        let text = format!(
            "version = 1
            [sheet]
            mesh = {{ square = {{ side = 1, level = 0 }} }}
            placement = {{ position = [0, 0, 1] }}
            [[obstacle]]
            shape = {{ file = {{ path = \"blocks.gltf\" {more} }} }}"
        );
        let scene = SceneFile::parse(text, &dir.path().join("scene.toml"), &[]);
        scene
            .unwrap_or_else(|e| panic!("{e}"))
            .build()
            .map(|setup| {
                let Shape::Surface(surface) = setup.obstacles[0].shape() else {
                    panic!("a mesh is a surface")
                };
                let x = surface.positions().iter().map(|p| p.x);
                let ends = x.clone().fold(f64::INFINITY, f64::min);
                (
                    surface.positions().len(),
                    [ends, x.fold(f64::NEG_INFINITY, f64::max)],
                )
            })
    };
    assert_eq!(body("").unwrap(), (9, [0.0, 5.0]));
    assert_eq!(body(", mesh = \"block\"").unwrap(), (6, [0.0, 3.0]));
    assert_eq!(body(", mesh = \"last\"").unwrap(), (3, [4.0, 5.0]));
    let error = body(", mesh = \"first\"").unwrap_err();
    assert_eq!(error.placed()[0].key, "obstacle[0].shape.file.mesh");
    assert!(error.to_string().contains("\"block\", \"last\""), "{error}");
}
