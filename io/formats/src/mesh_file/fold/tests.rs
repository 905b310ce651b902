//! Defects, frames, faces of drawings, cuts and angles.

use crate::mesh_file::tests::{FOLD, cross, parse, refuses};
use crate::mesh_file::{
    EdgeAssignment, FoldFrame, Location, MeshFileProblem, MeshFormat, MeshOptions, parse_mesh,
};
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{EdgeId, VertexId, fold_angle};
use std::path::Path;

#[test]
fn defects_of_fold_files_are_typed() {
    let change = |from: &str, to: &str, says: &str| {
        let text = FOLD.replace(from, to);
        refuses(MeshFormat::Fold, text.as_bytes(), None, says);
    };
    change("\"cm\"", "\"mile\"", "the unit \"mile\" is unknown");
    change("[200, 0, 50]", "[200]", "vertex 1 has 1 coordinates");
    let fourth = "vertex 1 has a fourth coordinate";
    change("[200, 0, 50]", "[200, 0, 50, 1]", fourth);
    let length = "`edges_assignment` has 6 entries for 5 edges";
    change("\"M\"]", "\"M\", \"M\"]", length);
    let vertex = "edge 2 refers to vertex 9";
    change("[2, 3], [3, 0]", "[2, 9], [3, 0]", vertex);
    let letter = "edge 4 has the assignment \"mountain\"";
    change("\"M\"", "\"mountain\"", letter);
    change("-90", "-190", "edge 4 has the fold angle -190 degrees");
    change("faces_vertices", "x:faces", "do not lie in the plane z = 0");
    let empty = b"{\"vertices_coords\": []}";
    refuses(
        MeshFormat::Fold,
        empty,
        None,
        "no frame has `vertices_coords`",
    );
    let cut = &FOLD.as_bytes()[..100];
    refuses(MeshFormat::Fold, cut, None, "the file is not valid FOLD: ");
    let index = FOLD.replace("[0, 2, 3]", "[0, 2, -3]");
    let face = Some(Location::Face(1));
    refuses(
        MeshFormat::Fold,
        index.as_bytes(),
        face,
        "a face refers to vertex -3",
    );
}

/// A title names one frame; errors list what there is to choose from.
#[test]
fn frames_have_titles() {
    let text = r#"{"frame_title": "crease pattern", "frame_classes": ["creasePattern"],
        "vertices_coords": [[0, 0], [1, 0], [0, 1]], "faces_vertices": [[0, 1, 2]], "file_frames": [
        {"frame_title": "moved", "frame_inherit": true, "vertices_coords": [[5, 0], [6, 0], [5, 1]]},
        {"frame_title": "twice", "frame_inherit": true}, {"frame_title": "twice", "frame_inherit": true}]}"#;
    let read = |frame: &str, format| {
        let options = MeshOptions {
            frame: Some(FoldFrame::Title(frame.into())),
            ..MeshOptions::default()
        };
        parse_mesh(text.as_bytes(), format, Path::new("x.fold"), &options)
    };
    let x = |frame| read(frame, MeshFormat::Fold).unwrap().positions[0];
    // The title of a frame is not inherited.
    assert_eq!((x("crease pattern"), x("moved")), (0.0, 5.0));
    let frames = r#"0 "crease pattern" (creasePattern), 1 "moved", 2 "twice", 3 "twice""#;
    for (title, problem) in [
        ("folded", r#"there is no frame "folded""#),
        ("twice", r#"2 frames have the title "twice""#),
    ] {
        let said = read(title, MeshFormat::Fold).unwrap_err().to_string();
        let expected = format!("x.fold: {problem}; the frames of the file are {frames}");
        assert_eq!(said, expected);
    }
    let other = read("moved", MeshFormat::Off).unwrap_err().problem;
    assert!(matches!(other, MeshFileProblem::Frame(_)));
}

/// Files of runs have thousands of frames, which no error lists.
#[test]
fn lists_of_frames_are_short() {
    let frames = vec!["{}"; 5000].join(", ");
    let text = format!("{{\"file_frames\": [{frames}]}}");
    let options = MeshOptions {
        frame: Some(FoldFrame::Number(9000)),
        ..MeshOptions::default()
    };
    let path = Path::new("x.fold");
    let error = parse_mesh(text.as_bytes(), MeshFormat::Fold, path, &options).unwrap_err();
    let said = error.to_string();
    assert!(
        said.ends_with("9, 10, 11, and so on to 5000") && said.len() < 200,
        "{said}"
    );
}

#[test]
fn frames_inherit_from_their_parents() {
    let text = r#"{"frame_unit": "mm", "faces_vertices": [[0, 1, 2]], "file_frames": [
        {"frame_inherit": true, "vertices_coords": [[0, 0], [1, 0], [0, 1]]},
        {"frame_inherit": true, "frame_parent": 1, "faces_vertices": [[0, 2, 1]],
         "frame_classes": ["foldedForm"]},
        {"frame_inherit": true, "frame_parent": 4},
        {"frame_inherit": true, "frame_parent": 3}]}"#;
    let frame = |frame: Option<usize>| {
        let options = MeshOptions {
            frame: frame.map(FoldFrame::Number),
            ..MeshOptions::default()
        };
        parse_mesh(
            text.as_bytes(),
            MeshFormat::Fold,
            Path::new("x.fold"),
            &options,
        )
    };
    let first = frame(None).unwrap();
    assert_eq!((first.positions[3], first.faces[0]), (1e-3, [0, 1, 2]));
    assert_eq!(frame(Some(1)).unwrap(), first);
    let second = frame(Some(2)).unwrap();
    assert_eq!(
        (&second.positions, second.faces[0]),
        (&first.positions, [0, 2, 1])
    );
    let refused = |n| frame(Some(n)).unwrap_err().problem;
    let says = |n, text: &str| {
        let problem = refused(n).to_string();
        assert!(problem.starts_with(text), "{problem}");
    };
    says(0, "the file has 1 face but no vertices");
    says(3, "frame 3 inherits from frame ");
    let missing = "there is no frame 5; the frames of the file are 0, 1, 2 (foldedForm), 3, 4";
    says(5, missing);
}

#[test]
fn faces_of_a_crease_pattern_are_found() {
    let mesh = parse(MeshFormat::Fold, cross("").as_bytes()).unwrap();
    let sheet = mesh.clone().into_sheet().unwrap();
    assert_eq!(
        (mesh.polygons, sheet.topology().face_count(), sheet.area()),
        (4, 8, 4.0)
    );
    let given = ", \"faces_vertices\": [[0,1,8,7],[1,2,3,8],[8,3,4,5],[7,8,5,6]]";
    let given = parse(MeshFormat::Fold, cross(given).as_bytes()).unwrap();
    assert_eq!(given.into_sheet().unwrap().area(), 4.0);
    let assignments = mesh.fold_assignments(sheet.topology()).unwrap();
    let count = |a| assignments.iter().filter(|b| **b == Some(a)).count();
    assert_eq!(count(FoldAssignment::Boundary), 8);
    assert_eq!(count(FoldAssignment::Mountain), 1);
    assert_eq!(count(FoldAssignment::Valley), 3);
    assert_eq!(count(FoldAssignment::Flat), 4, "the diagonals");

    // A square in a square, connected at its corners: the inner one is a hole if its edges are boundary.
    let frame = |inner: &str| {
        format!(
            r#"{{"vertices_coords": [[0,0],[3,0],[3,3],[0,3],[1,1],[2,1],[2,2],[1,2]],
            "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[4,5],[5,6],[6,7],[7,4],[0,4],[1,5],[2,6],[3,7]],
            "edges_assignment": ["B","B","B","B",{inner},{inner},{inner},{inner},"M","V","M","V"]}}"#
        )
    };
    let area = |text: &str| {
        let mesh = parse(MeshFormat::Fold, text.as_bytes()).unwrap();
        mesh.into_sheet().unwrap().area()
    };
    assert!((area(&frame("\"M\"")) - 9.0).abs() < 1e-14);
    assert!((area(&frame("\"B\"")) - 8.0).abs() < 1e-14);
}

#[test]
fn patterns_without_faces_that_are_no_drawing_are_refused() {
    let refused = |coords: &str, edges: &str, says: &str| {
        let text = format!(r#"{{"vertices_coords": [{coords}], "edges_vertices": [{edges}]}}"#);
        refuses(MeshFormat::Fold, text.as_bytes(), None, says);
    };
    let square = "[0,0],[1,0],[1,1],[0,1]";
    let sides = "[0,1],[1,2],[2,3],[3,0]";
    let with = |more: &str| format!("{sides},{more}");
    let two = format!("{square},[0.4,0.4],[0.6,0.4],[0.5,0.6]");
    refused(
        &two,
        &with("[4,5],[5,6],[6,4]"),
        "lies inside of another one",
    );
    refused(square, "[0,1],[1,2],[2,3]", "enclose no face");
}

/// Faces of the file that leave out creases, or whose outlines go to and fro along an edge, are found anew.
#[test]
fn faces_that_do_not_fit_the_edges_are_replaced() {
    let read = |faces: &str, edges: &str| {
        let text = format!(
            r#"{{"vertices_coords": [[0,0],[1,0],[1,1],[0,1],[0.5,0.5]], "faces_vertices": [{faces}],
            "edges_vertices": [[0,1],[1,2],[2,3],[3,0],{edges}], "edges_assignment": ["B","B","B","B","M"]}}"#
        );
        parse(MeshFormat::Fold, text.as_bytes()).unwrap()
    };
    let stale = read("[0,1,2,3]", "[0,2]");
    assert_eq!((stale.changes.replaced_faces, stale.faces.len()), (1, 2));
    // A crease that ends inside of a face.
    let spur = read("[0,4,0,1,2,3]", "[0,4]");
    assert_eq!(
        (spur.changes.replaced_faces, spur.changes.loose_lines),
        (1, 1)
    );
    let fitting = read("[0,1,2],[0,2,3]", "[0,2]");
    assert_eq!(fitting.changes.replaced_faces, 0);
    assert_eq!(fitting.faces, [[0, 1, 2], [0, 2, 3]]);
    // Two squares with a crease between them that is no side of either.
    let two = r#"{"vertices_coords": [[0,0],[1,0],[1,1],[0,1],[2,0],[3,0],[3,1],[2,1]],
        "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[4,5],[5,6],[6,7],[7,4],[1,4]]}"#;
    let two = parse(MeshFormat::Fold, two.as_bytes()).unwrap();
    assert_eq!((two.faces.len(), two.changes.loose_lines), (4, 1));
}

#[test]
fn lines_of_patterns_without_faces_may_cross_and_lead_nowhere() {
    let read = |coords: &str, edges: &str| {
        let text = format!(r#"{{"vertices_coords": [{coords}], "edges_vertices": [{edges}]}}"#);
        parse(MeshFormat::Fold, text.as_bytes()).unwrap()
    };
    let square = "[0,0],[1,0],[1,1],[0,1]";
    let sides = "[0,1],[1,2],[2,3],[3,0]";
    let crossing = read(square, &format!("{sides},[0,2],[3,1]"));
    assert_eq!((crossing.vertex_count(), crossing.faces.len()), (5, 4));
    assert_eq!(crossing.positions[12..], [0.5, 0.5, 0.0]);
    assert_eq!(crossing.changes.divided_lines, 2);
    let on_side = read(
        &format!("{square},[0.5,0]"),
        &format!("{sides},[2,4],[3,4]"),
    );
    assert_eq!((on_side.vertex_count(), on_side.faces.len()), (5, 3));
    let loose = read(&format!("{square},[0.5,0.4]"), &format!("{sides},[0,4]"));
    assert_eq!((loose.changes.loose_lines, loose.polygons), (1, 1));
}

/// Seen from the other side, mountains are valleys: where all faces are clockwise the file shows the back of
/// the sheet.
#[test]
fn clockwise_faces_of_flat_patterns_are_turned_over_with_their_creases() {
    let read = |faces: &str, more: &str| {
        let text = cross(&format!(", \"faces_vertices\": [{faces}]{more}"));
        parse(MeshFormat::Fold, text.as_bytes())
    };
    let angles = ", \"edges_foldAngle\": [0,0,0,0,0,0,0,0,-30,40,50,null]";
    let clockwise = "[7,8,1,0],[8,3,2,1],[5,4,3,8],[6,5,8,7]";
    let mesh = read(clockwise, angles).unwrap();
    assert_eq!(mesh.changes.reversed_faces, 4);
    let creases = mesh.creases[8..12].iter();
    let creases: Vec<_> = creases
        .map(|c| (c.assignment, c.angle.map(|a| a.to_degrees().round())))
        .collect();
    use EdgeAssignment::{Mountain, Valley};
    assert_eq!(
        creases,
        [
            (Valley, Some(30.0)),
            (Mountain, Some(-40.0)),
            (Mountain, Some(-50.0)),
            (Mountain, None)
        ]
    );
    assert!(
        mesh.creases
            .iter()
            .all(|c| c.angle != Some(0.0) || c.angle.unwrap().is_sign_positive())
    );
    assert_eq!(mesh.into_sheet().unwrap().area(), 4.0);
    // Faces and edges of the same drawing that are not listed clockwise.
    let counter = "[0,1,8,7],[1,2,3,8],[8,3,4,5],[7,8,5,6]";
    let mesh = read(counter, angles).unwrap();
    assert_eq!(
        (mesh.changes.reversed_faces, mesh.creases[8].assignment),
        (0, Mountain)
    );
    // Which side is meant at an edge between both kinds of faces, nobody can say.
    let both = "[7,8,1,0],[8,3,2,1],[8,3,4,5],[7,8,5,6]";
    let refused = read(both, "").unwrap_err().problem.to_string();
    let expected = "edge 9 folds between face 2 and face 1, whose vertices are listed in opposite directions, so";
    assert!(refused.starts_with(expected), "{refused}");
    let flat = cross(&format!(", \"faces_vertices\": [{both}]")).replace("\"V\"", "\"U\"");
    let mesh = parse(MeshFormat::Fold, flat.as_bytes()).unwrap();
    assert_eq!(
        (mesh.changes.reversed_faces, mesh.creases[8].assignment),
        (2, Valley)
    );
    // In a folded form some faces are clockwise as they lie.
    let folded = ", \"frame_classes\": [\"foldedForm\"]";
    let mesh = read(clockwise, folded).unwrap();
    assert_eq!(
        (mesh.changes.reversed_faces, mesh.creases[8].assignment),
        (0, Mountain)
    );
}

/// A repair that reverses a face turns the creases at it, and refuses what it cannot know.
#[test]
fn repairs_turn_creases_with_their_faces() {
    // Three strips one above the other, the middle one in the other direction.
    let text = |second: &str| {
        format!(
            r#"{{"frame_classes": ["foldedForm"],
            "vertices_coords": [[0,0,1],[1,0,1],[0,1,0],[1,1,0],[0,2,0],[1,2,0]],
            "edges_vertices": [[0,3],[2,3],[2,5]], "edges_assignment": ["F", "{second}", "M"],
            "faces_vertices": [[0,1,3],[0,3,2],[5,3,2],[5,2,4]]}}"#
        )
    };
    let mut mesh = parse(MeshFormat::Fold, text("F").as_bytes()).unwrap();
    assert_eq!(mesh.repair().unwrap().reversed_faces, 2);
    let letters: Vec<_> = mesh.creases.iter().map(|c| c.assignment).collect();
    assert_eq!(
        letters,
        [
            EdgeAssignment::Flat,
            EdgeAssignment::Flat,
            EdgeAssignment::Valley
        ]
    );
    let mut mesh = parse(MeshFormat::Fold, text("V").as_bytes()).unwrap();
    let refused = mesh.repair().unwrap_err().to_string();
    assert!(
        refused.starts_with("edge 1 folds between face"),
        "{refused}"
    );
}

/// What contradicts itself is refused where faces are given as where they are not.
#[test]
fn contradictions_are_refused() {
    let faces = ", \"faces_vertices\": [[0,1,8,7],[1,2,3,8],[8,3,4,5],[7,8,5,6]]";
    for faces in [faces, ""] {
        let refused = |from: &str, to: &str, says: &str| {
            let text = cross(faces).replace(from, to);
            refuses(MeshFormat::Fold, text.as_bytes(), None, says);
        };
        let text = cross(faces)
            .replace("[7,8]]", "[7,8],[8,1]]")
            .replace("\"V\"]", "\"V\",\"F\"]");
        let twice = "edges 8 and 12 are the same edge, between the vertices 8 and 1";
        refuses(MeshFormat::Fold, text.as_bytes(), None, twice);
        let itself = "edge 11 leads from vertex 8 to the same vertex";
        refused("[7,8]]", "[8,8]]", itself);
        let angles = |angles: &str, says: &str| {
            refused(
                "\"edges_assignment\"",
                &format!("\"edges_foldAngle\": [0,0,0,0,0,0,0,0,{angles}], \"edges_assignment\""),
                says,
            );
        };
        let mountain = "edge 8 is a mountain and has the fold angle 90 degrees";
        angles("90,null,null,null", mountain);
        angles("-90,null,-45,null", "edge 10 is a valley and has");
    }
    // A crease from corner to corner of a face: in a folded form faces are not found anew.
    let lost = cross(&format!("{faces}, \"frame_classes\": [\"foldedForm\"]"))
        .replace("[7,8]]", "[7,8],[0,8]]")
        .replace("\"V\"]", "\"V\",\"V\"]");
    refuses(
        MeshFormat::Fold,
        lost.as_bytes(),
        None,
        "edge 12 is a crease or a cut",
    );
    // The angles of a folded form are what the folds have come to.
    let folded = format!(
        "{faces}, \"frame_classes\": [\"foldedForm\"], \"edges_foldAngle\": [0,0,0,0,0,0,0,0,3,1,1,1]"
    );
    assert!(parse(MeshFormat::Fold, cross(&folded).as_bytes()).is_ok());
}

/// Two edges that become one by welding are one crease, which does what both were meant to do.
#[test]
fn creases_are_welded_with_their_vertices() {
    let text = |second: &str| {
        format!(
            r#"{{"vertices_coords": [[0,0],[1,0],[0,1],[1,0],[1,1],[0,1]],
            "edges_vertices": [[1,2],[3,5]], "edges_assignment": ["V", "{second}"],
            "faces_vertices": [[0,1,2],[3,4,5]]}}"#
        )
    };
    let options = MeshOptions {
        weld: Some(0.0),
        ..MeshOptions::default()
    };
    for (second, expected) in [
        ("V", EdgeAssignment::Valley),
        ("M", EdgeAssignment::Unassigned),
    ] {
        let text = text(second);
        let mesh = parse_mesh(text.as_bytes(), MeshFormat::Fold, Path::new("x"), &options).unwrap();
        let letters: Vec<_> = mesh.creases.iter().map(|c| c.assignment).collect();
        assert_eq!(letters, [expected]);
    }
}

#[test]
fn cuts_separate_the_sheet() {
    // A slit from the boundary to the middle opens there and ends at the middle.
    let slit = cross("").replace("\"M\"", "\"C\"");
    let mesh = parse(MeshFormat::Fold, slit.as_bytes()).unwrap();
    assert_eq!(
        (mesh.vertex_count(), mesh.changes.vertices_at_cuts),
        (10, 1)
    );
    let sheet = mesh.clone().into_sheet().unwrap();
    let t = sheet.topology();
    assert_eq!(
        (
            t.component_count(),
            t.euler_characteristic(),
            t.boundary_edge_count()
        ),
        (1, 1, 10)
    );
    assert_eq!(
        mesh.creases
            .iter()
            .filter(|c| c.assignment == EdgeAssignment::Cut)
            .count(),
        2
    );
    assert_eq!(sheet.area(), 4.0);
    // Two cuts in line separate two halves.
    let halves = slit.replace("\"V\",\"V\",\"V\"", "\"V\",\"C\",\"V\"");
    let mesh = parse(MeshFormat::Fold, halves.as_bytes()).unwrap();
    let sheet = mesh.clone().into_sheet().unwrap();
    assert_eq!(
        (sheet.topology().component_count(), mesh.vertex_count()),
        (2, 12)
    );
    for crease in mesh.creases {
        let [a, b] = crease.ends.map(VertexId);
        assert!(sheet.topology().find_edge(a, b).is_some(), "{crease:?}");
    }
}

/// The sign of the angles: a valley of 60 degrees in a folded frame has that fold angle.
#[test]
fn angles_have_the_sign_of_the_mesh() {
    let (s, c) = (60_f64.to_radians().sin(), 60_f64.to_radians().cos());
    let text = format!(
        r#"{{"frame_classes": ["foldedForm"], "vertices_coords": [[0,0,0],[0,1,0],[-1,0,0],[{c},0,{s}]],
        "edges_vertices": [[0,1]], "edges_assignment": ["V"], "edges_foldAngle": [60],
        "faces_vertices": [[0,1,2],[1,0,3]]}}"#
    );
    let mesh = parse(MeshFormat::Fold, text.as_bytes()).unwrap();
    let angle = mesh.creases[0].angle.unwrap();
    let sheet = mesh.into_sheet().unwrap();
    let t = sheet.topology();
    let edge: EdgeId = t.find_edge(VertexId(0), VertexId(1)).unwrap();
    let measured = fold_angle(t, sheet.positions(), edge).unwrap();
    assert!((angle - measured).abs() < 1e-15, "{angle} {measured}");
}
