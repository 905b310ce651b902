use isosheet_mesh::{MeshError, Topology, TopologyError, generate};
use proptest::prelude::*;

use crate::{
    Location, MeshFile, MeshFileError, MeshFileProblem, MeshFormat, MeshOptions, Polygons,
    frame_path, parse_mesh, read_sheet, write_obj,
};
use std::path::Path;

fn options(polygons: Polygons) -> MeshOptions {
    MeshOptions {
        polygons,
        ..MeshOptions::default()
    }
}

fn parse_obj(bytes: &[u8], polygons: Polygons) -> Result<MeshFile, MeshFileError> {
    parse_mesh(
        bytes,
        MeshFormat::Obj,
        Path::new("test.obj"),
        &options(polygons),
    )
}

fn parse(text: &str) -> Result<MeshFile, MeshFileError> {
    parse_obj(text.as_bytes(), Polygons::Refuse)
}

fn problem(text: &str) -> (Option<usize>, MeshFileProblem) {
    let e = parse(text).unwrap_err();
    assert!(e.to_string().starts_with("test.obj"), "{e}");
    let line = e.place.map(|p| match p {
        Location::Line(line) => line,
        other => panic!("{other}"),
    });
    (line, e.problem)
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn reads_what_the_format_allows() {
    let m = parse(&format!(
        "# comment\r\nmtllib a.mtl\no sheet\n{SQUARE}vt 0 0\nvn 0 0 1\ng one\nusemtl m\ns off\nf 1/1/1 2/1/1 3/1/1 # first\nf -4//1 \\\n  -2//1 -1//1\nl 1 2\n"
    ))
    .unwrap();
    assert_eq!(m.faces, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((m.vertex_count(), m.polygons), (4, 0));
    assert_eq!(m.into_sheet().unwrap().area(), 1.0);
    // Faces may come first; colours may be nonsense; numbers may have exponents.
    let m =
        parse("f 1 2 3\nv 0 0 0 nan nan nan\nv 1e0 0 0 0.1 0.2 0.3\nv 0 +1.0E+0 0 1.0\n").unwrap();
    assert_eq!(m.positions, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(m.faces, [[0, 1, 2]]);
    // Texture coordinates that are not finite are none.
    let uv = format!("{SQUARE}vt 0 nan\nvt 1\nvt 1 1 0\nf 1/2 2/2 3/3\nf 1/1 3/3 4/3\n");
    let m = parse(&uv).unwrap();
    assert_eq!(
        m.texture,
        [Some([[1.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), None]
    );
    // Bytes that are not UTF-8 in a name.
    let mut bytes = b"o \xff\xfe\n".to_vec();
    bytes.extend(format!("{SQUARE}f 1 2 3\n").into_bytes());
    assert!(parse_obj(&bytes, Polygons::Refuse).is_ok());
    // A continued last line.
    assert_eq!(
        parse(&format!("{SQUARE}f 1 2 3\\")).unwrap().faces,
        [[0, 1, 2]]
    );
}

#[test]
fn every_defect_names_its_line() {
    let says = |text: &str, line: Option<usize>, problem_text: &str| {
        let (found, problem) = problem(text);
        assert_eq!(found, line, "{problem}");
        assert!(problem.to_string().contains(problem_text), "{problem}");
    };
    says("", None, "it is empty");
    says("# only\n\n", None, "it is empty");
    let solid = "\nsolid thing\nfacet\n";
    says(solid, Some(2), "its first unknown word is \"solid\"");
    says("f 1 2 3\n", None, "has 1 face but no vertices");
    let points = format!("{SQUARE}p 1 2\nl 1 2\nl 2 3\n");
    let lines = "4 vertices, 2 line elements and 1 point element, but no faces";
    says(&points, None, lines);
    says("v 0 0\n", Some(1), "a vertex needs three numbers");
    says("v 0 0 x\n", Some(1), "a vertex needs three numbers");
    let nan = "v 0 0 0\nv 0 nan 0\n";
    says(nan, Some(2), "coordinate y of vertex 2 is NaN");
    says("v 0 0 1e999\n", Some(1), "coordinate z of vertex 1 is inf");
    says("v 0 0 0 0.5\n", Some(1), "vertex 1 has the weight 0.5");
    let face = |f: &str, problem_text: &str| {
        says(&format!("{SQUARE}f {f}\n"), Some(5), problem_text);
    };
    face(
        "1 2 5",
        "vertex 5, but the file has 4 vertices, counted from 1",
    );
    face(
        "1 2 -5",
        "vertex -5, but the file has 4 vertices, counted from 1",
    );
    face("0 1 2", "vertex 0, but the file has 4 vertices");
    face("1 2 9999999999", "vertex 9999999999, but");
    face(
        "1 2 -9223372036854775808",
        "vertex -9223372036854775808, but",
    );
    face("1 2 9223372036854775807", "vertex 9223372036854775807, but");
    face("1 b 3", "\"b\" is not a vertex index");
    face("1 2.5 3", "\"2.5\" is not a vertex index");
    face("/1 2 3", "\"/1\" is not a vertex index");
    face("1 2", "a face has 2 corners, and needs at least three");
    face("", "a face has 0 corners, and needs at least three");
    face("1 2 3 4", "a face has 4 corners, and a rigid sheet");
    let missing = read_sheet(Path::new("/no/such/file.obj")).unwrap_err();
    assert!(matches!(missing.problem, MeshFileProblem::Read(_)));
    assert!(
        missing.to_string().contains("/no/such/file.obj"),
        "{missing}"
    );
}

#[test]
fn polygons_are_cut_on_request() {
    let text = format!("{SQUARE}v 2 0.5 0\nf 1 2 3 4\nf 2 5 3\n");
    let m = parse_obj(text.as_bytes(), Polygons::Triangulate).unwrap();
    assert_eq!((m.faces.len(), m.polygons), (3, 1));
    assert!((m.into_sheet().unwrap().area() - 1.5).abs() < 1e-15);
    let flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n";
    let e = parse_obj(flat.as_bytes(), Polygons::Triangulate).unwrap_err();
    let crossed = "the outline of a face of 4 corners crosses";
    assert!(e.problem.to_string().starts_with(crossed), "{e}");
}

#[test]
fn unused_vertices_are_refused_or_dropped() {
    let text = format!("v 9 9 9\n{SQUARE}v 8 8 8\nf 2 3 4\nf 2 4 5\n");
    let mut m = parse(&text).unwrap();
    let error = m.clone().into_sheet().unwrap_err();
    assert!(matches!(
        error.problem,
        MeshFileProblem::Mesh(MeshError::Topology(
            TopologyError::UnreferencedVertex { .. }
        ))
    ));
    assert_eq!(m.drop_unreferenced(), 2);
    assert_eq!(m.into_sheet().unwrap().area(), 1.0);
}

#[test]
fn frames_are_written_and_read_back_exactly() {
    let dir = tempfile::tempdir().unwrap();
    let sheet = generate::delaunay_square(0.3, 0.05, 3).unwrap();
    let path = frame_path(&dir.path().join("frames"), 42);
    assert!(path.ends_with("frame_00042.obj"));
    let x: Vec<f64> = sheet.positions().iter().map(|c| c / 3.0 + 1e-17).collect();
    write_obj(&path, sheet.topology(), &x).unwrap();
    let back = read_sheet(&path).unwrap();
    assert_eq!(back.topology(), sheet.topology());
    assert_eq!(back.positions(), x);

    let written = std::fs::read(&path).unwrap();
    let mut bad = x.clone();
    bad[7] = f64::INFINITY;
    let error = write_obj(&path, sheet.topology(), &bad).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("coordinate y of vertex 2 is inf"),
        "{error}"
    );
    let error = write_obj(&path, sheet.topology(), &x[3..]).unwrap_err();
    assert!(
        error.to_string().starts_with("coordinates of a mesh: "),
        "{error}"
    );
    assert_eq!(std::fs::read(&path).unwrap(), written, "left as it was");
}

/// The file of a mesh.
fn written(t: &Topology, x: &[f64]) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mesh.obj");
    write_obj(&path, t, x).unwrap();
    std::fs::read(path).unwrap()
}

/// Another reader finds the same triangles in space.
#[test]
fn agrees_with_another_reader() {
    let sheet = generate::octagon_244(0.5).unwrap();
    let text = written(sheet.topology(), sheet.positions());
    let ours = parse_obj(&text, Polygons::Refuse).unwrap();
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) =
        tobj::load_obj_buf(&mut &text[..], &tobj::LoadOptions::default(), no_materials).unwrap();
    assert_eq!(models.len(), 1);
    let theirs = &models[0].mesh;
    let place = |x: &[f64], v: u32| {
        [
            x[3 * v as usize],
            x[3 * v as usize + 1],
            x[3 * v as usize + 2],
        ]
    };
    let a: Vec<_> = ours
        .faces
        .iter()
        .flatten()
        .map(|&v| place(&ours.positions, v))
        .collect();
    let b: Vec<_> = theirs
        .indices
        .iter()
        .map(|&v| place(&theirs.positions, v))
        .collect();
    assert_eq!(a, b);
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    /// Any f64 survives the text.
    #[test]
    fn coordinates_survive(c in prop::collection::vec(-1e30..1e30f64, 3), e in -60..30i32) {
        let x: Vec<f64> = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().zip(c.iter().cycle()).map(|(b, c)| b + c * 10f64.powi(e)).collect();
        let t = Topology::from_faces(3, &[[0, 1, 2]]).unwrap();
        let text = written(&t, &x);
        prop_assert_eq!(parse_obj(&text, Polygons::Refuse).unwrap().positions, x);
    }
}

#[test]
fn broken_texture_coordinates_are_refused_with_their_line() {
    for (line, found) in [
        ("vt", ""),
        ("vt a b", "a b"),
        ("vt 0 0,5", "0 0,5"),
        ("vt 1 2 x", "1 2 x"),
    ] {
        let (number, problem) = problem(&format!("{SQUARE}{line}\nf 1/1 2/1 3/1\n"));
        assert_eq!(number, Some(5), "{line}");
        let expected = format!("texture coordinates are numbers, found {found:?}");
        assert_eq!(problem.to_string(), expected);
    }
}
