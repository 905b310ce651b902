//! All formats: what is read, and what is refused and where.

use super::*;
use isosheet_mesh::Advice;

pub(super) fn parse(format: MeshFormat, bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let path = format!("test.{}", format.extension());
    parse_mesh(bytes, format, Path::new(&path), &MeshOptions::default())
}

pub(super) fn problem(format: MeshFormat, bytes: &[u8]) -> (Option<Location>, MeshFileProblem) {
    let error = parse(format, bytes).expect_err("should be refused");
    let text = error.with_advice();
    assert!(text.starts_with("test.") && text.len() > 40, "{text}");
    (error.place, error.problem)
}

#[track_caller]
pub(super) fn refuses(format: MeshFormat, bytes: &[u8], place: Option<Location>, says: &str) {
    let (found, problem) = problem(format, bytes);
    assert_eq!(found, place, "{problem}");
    assert!(problem.to_string().contains(says), "{problem}");
}

/// The unit square of two triangles with its corners at x = 1 to 2.
const POINTS: [[f64; 3]; 4] = [
    [1.0, 0.0, 0.5],
    [2.0, 0.0, 0.5],
    [2.0, 1.0, 0.5],
    [1.0, 1.0, 0.5],
];

fn is_the_square(mesh: &MeshFile) {
    assert_eq!(mesh.positions.as_chunks::<3>().0, POINTS);
    assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
}

/// A binary STL file of the square.
fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..5].copy_from_slice(b"solid");
    bytes.extend(2_u32.to_le_bytes());
    for face in [[0, 1, 2], [0, 2, 3]] {
        let numbers = [
            [0.0, 0.0, 1.0],
            POINTS[face[0]],
            POINTS[face[1]],
            POINTS[face[2]],
        ];
        bytes.extend(
            numbers
                .as_flattened()
                .iter()
                .flat_map(|&c| (c as f32).to_le_bytes()),
        );
        bytes.extend([0, 0]);
    }
    bytes
}

/// The facets of the square as text.
fn text_facet(face: [usize; 3]) -> String {
    let corners = face.map(|v| {
        let [x, y, z] = POINTS[v];
        format!("vertex {x} {y} {z}\n")
    });
    format!(
        "facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n",
        corners.concat()
    )
}

/// A binary PLY file of the square with a colour for each vertex.
fn binary_ply() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\n\
        property uchar red\nproperty double y\nproperty double z\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for [x, y, z] in POINTS {
        bytes.extend(x.to_le_bytes());
        bytes.push(200);
        bytes.extend([y, z].iter().flat_map(|c| c.to_le_bytes()));
    }
    bytes.push(4);
    bytes.extend((0..4_i32).flat_map(i32::to_le_bytes));
    bytes
}

const TEXT_PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nelement face 2\nproperty list uchar uint vertex_index\n\
    end_header\n1 0 0.5\n2 0 0.5\n2 1 0.5\n1 1 0.5\n3 0 1 2\n3 0 2 3\n";

/// The square in glTF, y upwards, shown by a child that its parent shifts by 1 along x and scales by `scale`.
fn gltf(scale: f64) -> String {
    let data: Vec<u8> = POINTS
        .iter()
        .flat_map(|[x, y, z]| [x - 1.0, *z, -y])
        .flat_map(|c| ((c / scale) as f32).to_le_bytes())
        .chain(
            [0_u16, 1, 2, 0, 2, 3]
                .into_iter()
                .flat_map(u16::to_le_bytes),
        )
        .collect();
    let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, data);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"translation":[1,0,0],"children":[1]}},{{"mesh":0,"scale":[{scale},{scale},{scale}]}}],
        "meshes":[{{"name":"sheet","primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},
        {{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}}],
        "buffers":[{{"byteLength":60,"uri":"data:application/octet-stream;base64,{data}"}}]}}"#
    )
}

/// The square as a FOLD file, in centimetres, with a mountain along the diagonal.
pub(super) const FOLD: &str = r#"{"file_spec": 1.2, "frame_unit": "cm", "frame_classes": ["creasePattern"],
    "vertices_coords": [[100, 0, 50], [200, 0, 50], [200, 100, 50], [100, 100, 50]],
    "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]], "edges_assignment": ["B", "B", "B", "B", "M"],
    "edges_foldAngle": [0, 0, 0, null, -90], "faces_vertices": [[0, 1, 2], [0, 2, 3]]}"#;

#[test]
fn every_format_has_the_same_square() {
    let vertices = "1 0 .5 0.1 0.2\n2 0 .5\n\n2 1 5e-1 # corner\n1 1 .5\n";
    for head in [
        "OFF 4 2 0\n",
        "OFF\n4 2 5\n",
        "4 2 0\n",
        "  OFF4 2 0\n",
        "STCNOFF # x\n4 2\n",
    ] {
        let off = format!("{head}{vertices}3 0 1 2 1.0 0.5 0.1\n3 0 2 3\n");
        is_the_square(&parse(MeshFormat::Off, off.as_bytes()).unwrap());
    }
    let quad = format!("OFF 4 1 0\n{vertices}4 0 1 2 3\n");
    let quad = parse(MeshFormat::Off, quad.as_bytes()).unwrap();
    is_the_square(&quad);
    assert_eq!((quad.polygons, &quad.diagonals[..]), (1, &[[0, 2]][..]));

    let stl = parse(MeshFormat::Stl, &binary_stl()).unwrap();
    is_the_square(&stl);
    assert_eq!(stl.changes.welded_vertices, 2);
    // Two solids, the second one in capital letters and without a name.
    let (a, b) = (text_facet([0, 1, 2]), text_facet([0, 2, 3]).to_uppercase());
    let text = format!("solid one\n{a}endsolid one\n\nSOLID\n{b}ENDSOLID\n");
    is_the_square(&parse(MeshFormat::Stl, text.as_bytes()).unwrap());

    is_the_square(&parse(MeshFormat::Ply, &binary_ply()).unwrap());
    is_the_square(&parse(MeshFormat::Ply, TEXT_PLY.as_bytes()).unwrap());

    is_the_square(&parse(MeshFormat::Gltf, gltf(1.0).as_bytes()).unwrap());
    is_the_square(&parse(MeshFormat::Gltf, gltf(2.0).as_bytes()).unwrap());
    // A mirrored node turns the faces over in its own frame, and they are turned back.
    let mirrored = parse(MeshFormat::Gltf, gltf(-1.0).as_bytes()).unwrap();
    assert_eq!(mirrored.positions.as_chunks::<3>().0, POINTS);
    assert_eq!(mirrored.faces, [[0, 2, 1], [0, 3, 2]]);

    let fold = parse(MeshFormat::Fold, FOLD.as_bytes()).unwrap();
    is_the_square(&fold);
    assert_eq!(fold.creases.len(), 5);
    let mountain = fold.creases[4];
    assert_eq!(mountain.assignment, EdgeAssignment::Mountain);
    assert_eq!(mountain.angle, Some(-std::f64::consts::FRAC_PI_2));
    assert_eq!(
        (fold.creases[0].angle, fold.creases[3].angle),
        (Some(0.0), None)
    );
}

#[test]
fn formats_are_known_by_their_extension() {
    assert_eq!(MeshFormat::of(Path::new("a/b.STL")), Some(MeshFormat::Stl));
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("folder.obj")).unwrap();
    for name in ["a.step", "a", "folder.obj/a"] {
        let path = dir.path().join(name);
        // Of a file that does not exist the extension is not the problem.
        let missing = read_mesh(&path).unwrap_err().problem;
        assert!(matches!(missing, MeshFileProblem::Read(_)), "{missing}");
        std::fs::write(&path, "").unwrap();
        let error = read_mesh(&path).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("is no known format of meshes"), "{text}");
        assert!(
            text.contains(".obj, .off, .stl, .ply, .fold, .gltf, .glb"),
            "{text}"
        );
    }
    let error = read_mesh(Path::new("/no/such.fold")).unwrap_err();
    assert!(matches!(error.problem, MeshFileProblem::Read(_)));
    let options = MeshOptions {
        weld: Some(-1.0),
        ..MeshOptions::default()
    };
    let error = parse_mesh(b"", MeshFormat::Off, Path::new("x"), &options).unwrap_err();
    assert!(matches!(
        error.problem,
        MeshFileProblem::Options(error) if error.value == Some(-1.0)
    ));
}

#[test]
fn defects_of_off_files_name_their_line() {
    let off = |text: &str, place: Option<usize>, says: &str| {
        let place = place.map(Location::Line);
        refuses(MeshFormat::Off, text.as_bytes(), place, says);
    };
    off("", None, "the file ends before the keyword OFF");
    off("OFF 0 0 0", None, "it is empty");
    off("OFF 1 0 0\n0 0 0", None, "the file has 1 vertex, 0 line");
    off("COFF\nx", Some(2), "or the number of vertices, found \"x\"");
    off("OFF 2 0\n0 0 0\n0 0\n", Some(3), "expected a coordinate");
    let many = "OFF 99999999999 1\n0 0 0\n";
    off(many, None, "the file ends before vertex 1 of");
    let nan = "OFF 2 1\n0 0 0\n0 inf 0\n3 0 0 0\n";
    off(nan, Some(3), "coordinate y of vertex 1 is inf");
    let index = "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n";
    let says = "vertex 3, but the file has 3 vertices, counted from 0";
    off(index, Some(5), says);
    let huge = "OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n99999999999 0 1 2\n";
    off(huge, Some(5), "expected the index of a vertex");
}

#[test]
fn defects_of_stl_files_name_their_byte_or_facet() {
    let stl = |bytes: &[u8], place: Option<usize>, says: &str| {
        refuses(MeshFormat::Stl, bytes, place.map(Location::Byte), says);
    };
    stl(b"", None, "it is empty");
    stl(
        b"some bytes",
        Some(10),
        "the file ends before the number of facets",
    );
    let mut short = binary_stl();
    short[0] = b'x';
    short.truncate(150);
    stl(&short, Some(80), "the header announces 2 facets");
    let mut nan = binary_stl();
    nan[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    stl(&nan, Some(134), "coordinate x of vertex 3 is NaN");
    let text = format!("solid\n{}facet normal 0 0 x\n", text_facet([0, 1, 2]));
    stl(text.as_bytes(), None, "facet 1 (from 0): ");
}

#[test]
fn defects_of_ply_files_name_their_place() {
    let ply = |text: &str, place: Option<Location>, says: &str| {
        refuses(MeshFormat::Ply, text.as_bytes(), place, says);
    };
    ply("plx\n", Some(Location::Line(1)), "expected the word ply");
    let many = TEXT_PLY.replace("vertex 4", "vertex 4000000000");
    ply(&many, None, "announces 4000000000 elements \"vertex\"");
    let empty = TEXT_PLY.replace("element face", "element nothing 99999999999\nelement face");
    ply(&empty, None, "\"nothing\" has no properties");
    let word = TEXT_PLY.replace("2 1 0.5", "2 one 0.5");
    ply(&word, Some(Location::Line(13)), "one");
    let index = TEXT_PLY.replace("3 0 2 3", "3 0 2 4");
    ply(
        &index,
        Some(Location::Face(1)),
        "vertex 4, but the file has 4",
    );
    let flat = TEXT_PLY.replace("float z", "float w");
    ply(&flat, None, "the vertices have no property \"z\"");
    // Triangles that would be lost beside the triangles of the faces.
    let strips = "element tristrips 1\nproperty list int int vertex_indices\nelement face";
    let strips = TEXT_PLY
        .replace("element face", strips)
        .replace("3 0 1 2", "4 0 1 2 3\n3 0 1 2");
    ply(&strips, None, "tristrips");
}

#[test]
fn defects_of_gltf_are_typed() {
    let refused = |text: String, says: &str| {
        refuses(MeshFormat::Gltf, text.as_bytes(), None, says);
    };
    let change = |from: &str, to: &str, says: &str| {
        refused(gltf(1.0).replace(from, to), says);
    };
    let invalid = "the file is not valid glTF";
    refused("{}".into(), invalid);
    change("\"POSITION\":0", "\"POSITION\":7", invalid);
    change("\"indices\":1", "\"indices\":7", invalid);
    let part = "part 0 of mesh 0";
    change("\"count\":4", "\"count\":5", &format!("{part}: positions"));
    change("\"count\":6", "\"count\":7", &format!("{part}: indices"));
    let huge = "\"count\":99999999999999";
    change("\"count\":6", huge, &format!("{part}: indices"));
    let far = "\"byteOffset\":18446744073709551615";
    change("\"byteOffset\":48", far, part);
    let lines = "\"indices\":1,\"mode\":1";
    change("\"indices\":1", lines, &format!("{part} is made of Lines"));
    change(";base64,", ";base32,", "buffer 0: ");
    change("data:application", "none", "buffer 0: ");
    change(
        "\"scene\":0",
        "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0",
        "KHR_draco_mesh_compression",
    );
    // A child that is its own parent.
    let circle = gltf(1.0).replace("\"mesh\":0,", "\"children\":[0],");
    assert!(parse(MeshFormat::Gltf, circle.as_bytes()).is_ok());
    let named = MeshOptions {
        mesh: Some("other".into()),
        ..MeshOptions::default()
    };
    let error = parse_mesh(
        gltf(1.0).as_bytes(),
        MeshFormat::Gltf,
        Path::new("x"),
        &named,
    );
    let error = error.unwrap_err().to_string();
    assert!(error.contains("\"sheet\""), "{error}");
    // A buffer that is a file is read from the folder of the file, or refused.
    let folder = tempfile::tempdir().unwrap();
    let text = gltf(1.0);
    let (head, rest) = text
        .split_once("data:application/octet-stream;base64,")
        .unwrap();
    let (data, tail) = rest.split_once('"').unwrap();
    let engine = base64::engine::general_purpose::STANDARD;
    let data = base64::Engine::decode(&engine, data).unwrap();
    std::fs::write(folder.path().join("my d\u{e4}t#a.bin"), data).unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, format!("{head}my%20d%C3%A4t%23a.bin\"{tail}")).unwrap();
    is_the_square(&read_mesh(&path).unwrap());
    let refuse = MeshOptions {
        buffers: SeparateBuffers::Refuse,
        ..MeshOptions::default()
    };
    let error = read_mesh_with(&path, &refuse).unwrap_err();
    let separate = "buffer 0 is the file \"my%20d%C3%A4t%23a.bin\"";
    assert!(error.to_string().contains(separate), "{error}");
    for length in 0..12 {
        let bytes = [&b"glTF\x02\0\0\0\x05\0\0\0"[..length], b""].concat();
        assert!(parse(MeshFormat::Glb, &bytes).is_err());
    }
}

/// The square of [`gltf`] with other roots and nodes of its scene; node 0 of that has the translation [1, 0,
/// 0].
fn placed_gltf(roots: &str, nodes: &str) -> String {
    let scale = "\"scale\":[1,1,1]}]";
    gltf(1.0)
        .replace(
            "\"scenes\":[{\"nodes\":[0]}]",
            &format!("\"scenes\":[{{\"nodes\":{roots}}}]"),
        )
        .replace(
            &format!(
                "\"nodes\":[{{\"translation\":[1,0,0],\"children\":[1]}},{{\"mesh\":0,{scale}"
            ),
            &format!("\"nodes\":{nodes}"),
        )
}

/// Every node of the scene that shows a mesh adds a copy of it: below others, by a matrix or by its parts,
/// mirrored.
#[test]
fn all_placed_meshes_of_a_gltf_file_are_read() {
    // Node 0 moves by 1 along x, which all others are below; node 2 turns by 90 degrees about y (upwards) and
    // doubles; node 3 mirrors x by a matrix; node 4 is not in the scene.
    let nodes = r#"[{"translation":[1,0,0],"children":[1,2,3]},{"mesh":0},
        {"translation":[0,5,0],"rotation":[0,0.7071067811865476,0,0.7071067811865476],"scale":[2,2,2],"mesh":0},
        {"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,10,0,1],"mesh":0},{"translation":[9,9,9],"mesh":0}]"#;
    let mesh = parse(MeshFormat::Gltf, placed_gltf("[0]", nodes).as_bytes()).unwrap();
    let points = mesh.positions.as_chunks::<3>().0;
    assert_eq!(points.len(), 12);
    assert_eq!(points[..4], POINTS);
    // With z upwards the square is (u, v, 1/2) before it is placed, and the turn is one about z.
    for (k, [x, y, _]) in POINTS.into_iter().enumerate() {
        let (u, v) = (x - 1.0, y);
        let turned = [1.0 - 2.0 * v, 2.0 * u, 5.0 + 1.0];
        let mirrored = [1.0 - u, v, 10.5];
        for (found, expected) in [(points[4 + k], turned), (points[8 + k], mirrored)] {
            for c in 0..3 {
                assert!(
                    (found[c] - expected[c]).abs() < 1e-6,
                    "{found:?} {expected:?}"
                );
            }
        }
    }
    let faces = [
        [0, 1, 2],
        [0, 2, 3],
        [4, 5, 6],
        [4, 6, 7],
        [8, 10, 9],
        [8, 11, 10],
    ];
    assert_eq!(mesh.faces, faces);
    // All of them show their front upwards.
    let sheet = mesh.into_sheet().unwrap();
    assert_eq!(sheet.topology().component_count(), 3);

    // Neighbours that touch stay apart, and what no node shows is read as it is.
    let beside = r#"[{"mesh":0},{"translation":[1,0,0],"mesh":0}]"#;
    let mesh = parse(MeshFormat::Gltf, placed_gltf("[0,1]", beside).as_bytes()).unwrap();
    assert_eq!((mesh.vertex_count(), mesh.changes.welded_vertices), (8, 0));
    let unplaced = parse(
        MeshFormat::Gltf,
        placed_gltf("[0]", r#"[{"translation":[1,0,0]}]"#).as_bytes(),
    );
    assert_eq!(unplaced.unwrap().positions[..3], [0.0, 0.0, 0.5]);
}

/// Strips and fans are triangles in short: every second one of a strip is turned.
#[test]
fn strips_and_fans_of_gltf_files_are_triangles() {
    let read = |mode: u32| {
        let text = gltf(1.0).replace("\"indices\":1", &format!("\"mode\":{mode}"));
        parse(MeshFormat::Gltf, text.as_bytes()).unwrap().faces
    };
    assert_eq!(read(5), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(read(6), [[0, 1, 2], [0, 2, 3]]);
}

/// A pattern of four panels about a vertex, with or without a hole in the middle instead.
pub(super) fn cross(faces: &str) -> String {
    format!(
        r#"{{"vertices_coords": [[0,0],[1,0],[2,0],[2,1],[2,2],[1,2],[0,2],[0,1],[1,1]],
        "edges_vertices": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,6],[6,7],[7,0],[1,8],[3,8],[5,8],[7,8]],
        "edges_assignment": ["B","B","B","B","B","B","B","B","M","V","V","V"]{faces}}}"#
    )
}
