//! Groups of faces that mesh files name, as selections.

use base64::Engine;
use isosheet_dynamics::Material;
use isosheet_formats::{FaceGroups, read_mesh, write_mesh};
use isosheet_scenes::{SceneFile, Setup};
use std::fs;
use std::path::Path;

/// Two unit squares side by side; the left one is of the group.
const VERTICES: [[f32; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [2.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [2.0, 1.0, 0.0],
];

/// The four triangles, the left square first.
const TRIANGLES: [[u16; 3]; 4] = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];

fn obj_vertices() -> String {
    VERTICES
        .iter()
        .map(|[x, y, z]| format!("v {x} {y} {z}\n"))
        .collect()
}

fn ply() -> String {
    let vertices = VERTICES.iter().map(|[x, y, z]| format!("{x} {y} {z}\n"));
    let faces = TRIANGLES.iter().enumerate();
    let faces = faces
        .map(|(k, [a, b, c])| format!("3 {a} {b} {c} {} 0.5 {k}\n", if k < 2 { 7 } else { -7 }));
    let elements = "element vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n\
                    property list uchar int vertex_indices\nproperty short label\nproperty float weight\n\
                    property uchar red\nend_header\n";
    ["ply\nformat ascii 1.0\n", elements].concat() + &vertices.chain(faces).collect::<String>()
}

fn fold() -> String {
    format!(
        "{{\"vertices_coords\": {VERTICES:?}, \"faces_vertices\": [[0, 1, 4, 3], [1, 2, 5, 4]],
         \"faces_isosheet:group\": [\"left\", null]}}"
    )
}

/// With y upwards, so that the sheet stands, and a part of the mesh for each square.
fn gltf() -> String {
    let mut bytes: Vec<u8> = VERTICES
        .iter()
        .flatten()
        .flat_map(|c| c.to_le_bytes())
        .collect();
    bytes.extend(TRIANGLES.iter().flatten().flat_map(|v| v.to_le_bytes()));
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let length = bytes.len();
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"mesh": 0, "name": "coat"}}],
        "materials": [{{"name": "left"}}],
        "meshes": [{{"name": "cloth", "primitives": [
            {{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}},
            {{"attributes": {{"POSITION": 0}}, "indices": 2}}]}}],
        "buffers": [{{"byteLength": {length}, "uri": "data:application/octet-stream;base64,{data}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 72}}, {{"buffer": 0, "byteOffset": 72, "byteLength": 24}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [0, 0, 0], "max": [2, 1, 0]}},
            {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}},
            {{"bufferView": 1, "byteOffset": 12, "componentType": 5123, "count": 6, "type": "SCALAR"}}]}}"#
    )
}

fn build(folder: &Path, text: &str) -> Result<Setup, String> {
    let scene = SceneFile::parse(text.into(), &folder.join("scene.toml"), &[]);
    let setup = scene.map_err(|e| e.to_string())?.build();
    setup.map_err(|e| e.to_string())
}

/// A sheet of paper whose group is of card and is held.
fn scene(file: &str, group: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmaterial = \"office paper\"\nrefine = 1\n\
         mesh = {{ file = {{ path = \"{file}\", polygons = \"triangulate\" }} }}\n\
         [[sheet.patch]]\nat = {{ group = \"{group}\" }}\nmaterial = \"card\"\n\
         [[support]]\nat = {{ group = \"{group}\" }}\n"
    )
}

/// In each format the patch is the left square, refined in 8 triangles with the 9 vertices that are held.
#[test]
fn groups_of_all_formats_are_patches_and_supports() {
    let dir = tempfile::tempdir().unwrap();
    let vertices = obj_vertices();
    let square = "f 1 2 5 4\n";
    let other = "f 2 3 6 5\n";
    let files = [
        (
            "group.obj",
            "left",
            format!("{vertices}g left all\n{square}g right all\n{other}"),
        ),
        (
            "object.obj",
            "left side",
            format!("{vertices}o left side\n{square}o b\n{other}"),
        ),
        (
            "material.obj",
            "left",
            format!("{vertices}usemtl left\n{square}usemtl b\n{other}"),
        ),
        ("label.ply", "label=7", ply()),
        ("key.fold", "left", fold()),
        ("material.gltf", "left", gltf()),
    ];
    let [paper, card] = [Material::office_paper(), Material::card()].map(|m| m.density);
    for (file, group, content) in files {
        fs::write(dir.path().join(file), content).unwrap();
        let setup =
            build(dir.path(), &scene(file, group)).unwrap_or_else(|e| panic!("{file}: {e}"));
        let mass = setup.model.mass().total();
        assert!(
            (mass / (paper + card) - 1.0).abs() < 1e-12,
            "{file}: {mass}"
        );
        let pins = setup.model.pins();
        assert_eq!(pins.len(), 9, "{file}");
        let x = setup.start.x.as_chunks::<3>().0;
        assert!(pins.iter().all(|v| x[v.index()][0] <= 1.0), "{file}");
    }
}

/// All corners of the middle face are corners of faces of the group, and it is not of the group.
#[test]
fn a_patch_is_the_faces_of_a_group_and_no_others() {
    let dir = tempfile::tempdir().unwrap();
    let text = "v 0 0 0\nv 1 0 0\nv 0.5 1 0\nv -1 1 0\nv 2 1 0\nv 0.5 -1 0\n\
                g side\nf 1 3 4\nf 2 5 3\nf 1 6 2\ng\nf 1 2 3\n";
    fs::write(dir.path().join("a.obj"), text).unwrap();
    let scene = scene("a.obj", "side").replace("refine = 1\n", "");
    let mass = build(dir.path(), &scene).unwrap().model.mass().total();
    let [paper, card] = [Material::office_paper(), Material::card()].map(|m| m.density);
    let side = 0.5 * (1.5 + 1.5 + 1.0);
    assert!(
        (mass / (side * card + 0.5 * paper) - 1.0).abs() < 1e-12,
        "{mass}"
    );
}

#[test]
fn a_group_that_is_not_there_is_answered_with_those_that_are() {
    let dir = tempfile::tempdir().unwrap();
    let vertices = obj_vertices();
    fs::write(
        dir.path().join("a.obj"),
        format!("{vertices}g left\nf 1 2 5 4\ng right\nf 2 3 6 5\n"),
    )
    .unwrap();
    fs::write(
        dir.path().join("b.obj"),
        format!("{vertices}f 1 2 5 4\nf 2 3 6 5\n"),
    )
    .unwrap();
    let message = |file: &str| build(dir.path(), &scene(file, "middle")).err().unwrap();
    let found = message("a.obj");
    assert!(
        found.contains("no group of faces has the name \"middle\": there are \"left\", \"right\""),
        "{found}"
    );
    assert!(found.contains("isosheet info"), "{found}");
    let found = message("b.obj");
    assert!(found.contains("the sheet has none"), "{found}");
}

/// Of two sheets with the same group both are meant where no sheet is named.
#[test]
fn groups_of_several_sheets_are_found_by_the_names_of_sheets() {
    let dir = tempfile::tempdir().unwrap();
    let text = format!("{}g left\nf 1 2 5 4\ng right\nf 2 3 6 5\n", obj_vertices());
    fs::write(dir.path().join("a.obj"), text).unwrap();
    let sheet = |name: &str, z: f64| {
        format!(
            "[[sheet]]\nname = \"{name}\"\nplacement = {{ position = [0, 0, {z}] }}\n\
             mesh = {{ file = {{ path = \"a.obj\", polygons = \"triangulate\" }} }}\n"
        )
    };
    let pins = |support: &str| {
        let sheets = [sheet("lower", 0.0), sheet("upper", 1.0)].concat();
        let text =
            format!("version = 1\n{sheets}[[support]]\n{support}at = {{ group = \"right\" }}\n");
        let pins = build(dir.path(), &text).unwrap().model.pins();
        pins.iter().map(|v| v.index()).collect::<Vec<_>>()
    };
    assert_eq!(pins("sheet = \"upper\"\n"), [7, 8, 10, 11]);
    assert_eq!(pins(""), [1, 2, 4, 5, 7, 8, 10, 11]);
}

/// A mesh that is written as OBJ keeps its groups, with words as names.
#[test]
fn groups_are_written_to_obj_files() {
    let dir = tempfile::tempdir().unwrap();
    let [from, to] = ["from.obj", "to.obj"].map(|name| dir.path().join(name));
    let text = format!(
        "{}f 1 2 5\no left side\ng a\nf 1 5 4\ng b c\nf 2 3 6\no\ng\nf 2 6 5\n",
        obj_vertices()
    );
    fs::write(&from, text).unwrap();
    let read = read_mesh(&from).unwrap();
    write_mesh(&to, &read).unwrap();
    let groups = |g: &FaceGroups| {
        let groups = g
            .iter()
            .map(|(name, faces)| (name.replace(' ', "_"), faces.to_vec()));
        groups.collect::<Vec<_>>()
    };
    let again = read_mesh(&to).unwrap();
    assert_eq!(again.faces, read.faces);
    assert_eq!(groups(&again.groups), groups(&read.groups));
    assert_eq!(groups(&read.groups).len(), 4);
}
