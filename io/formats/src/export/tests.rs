//! What is written is read back, by the readers of this crate and by others.

use super::*;
use crate::Trajectory;
use crate::{
    EdgeAssignment, FoldFrame, MeshFile, MeshFormat, MeshOptions, parse_mesh, read_mesh,
    read_mesh_with,
};
use isosheet_mesh::generate::{Diagonals, FoldAssignment};
use isosheet_mesh::{Sheet, Topology, fold_angle, generate};
use std::fs;

/// A sheet that is rolled up: at time t it lies on a cylinder of radius 1 / (4 t), with its rows straight.
fn rolled(frames: usize) -> (Sheet, Trajectory) {
    let sheet = generate::grid(6, 3, 1.0, 0.5, Diagonals::Rising).unwrap();
    let mut trajectory = Trajectory::new(&sheet);
    for k in 0..frames {
        let t = k as f64 / frames as f64;
        let curvature = 4.0 * t;
        let place = |p: &[f64; 3]| {
            if curvature == 0.0 {
                return *p;
            }
            let angle = curvature * p[0];
            [
                angle.sin() / curvature,
                p[1],
                (1.0 - angle.cos()) / curvature,
            ]
        };
        let x: Vec<f64> = sheet
            .positions()
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(place)
            .collect();
        trajectory.push(t, &x).unwrap();
    }
    (sheet, trajectory)
}

fn series(trajectory: &Trajectory) -> Series<'_> {
    Series::new(trajectory, &SeriesOptions::default()).unwrap()
}

/// A mesh with positions that 32-bit floats hold.
fn mesh() -> MeshFile {
    let text =
        "OFF 5 3 0\n0 0 0.25\n1 0 0.5\n1 1.5 -0.125\n0 1 0\n2 0.5 1\n3 0 1 2\n3 0 2 3\n3 1 4 2\n";
    let options = MeshOptions::default();
    parse_mesh(
        text.as_bytes(),
        MeshFormat::Off,
        Path::new("m.off"),
        &options,
    )
    .unwrap()
}

#[test]
fn meshes_come_back_from_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh();
    for format in ExportMeshFormat::ALL {
        let path = folder.path().join(format!("m.{}", format.extension()));
        write_mesh(&path, &mesh).unwrap();
        if format == ExportMeshFormat::Usda {
            continue;
        }
        let back = read_mesh(&path).unwrap();
        assert_eq!(back.faces, mesh.faces, "{format:?}");
        assert_eq!(back.positions, mesh.positions, "{format:?}");
        let creases = if format == ExportMeshFormat::Fold {
            7
        } else {
            0
        };
        assert_eq!(back.creases.len(), creases);
    }
    // All digits in the formats that say so.
    let mut exact = mesh.clone();
    exact
        .positions
        .iter_mut()
        .for_each(|c| *c = *c / 3.0 + 1e-17);
    for extension in ["obj", "off", "ply", "fold"] {
        let path = folder.path().join(format!("exact.{extension}"));
        write_mesh(&path, &exact).unwrap();
        assert_eq!(
            read_mesh(&path).unwrap().positions,
            exact.positions,
            "{extension}"
        );
    }
    let path = folder.path().join("single.stl");
    write_mesh(&path, &exact).unwrap();
    let back = read_mesh(&path).unwrap().positions;
    assert!(
        back.iter()
            .zip(&exact.positions)
            .all(|(a, b)| *a == f64::from(*b as f32))
    );
}

const POINTS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

/// Whether a JSON value has nulls or empty lists in it.
fn has_empty_entries(value: &serde_json::Value) -> bool {
    match value {
        serde_json::Value::Null => true,
        serde_json::Value::Array(list) => list.is_empty() || list.iter().any(has_empty_entries),
        serde_json::Value::Object(map) => map.values().any(has_empty_entries),
        _ => false,
    }
}

#[test]
fn creases_and_cuts_come_back_from_fold_files() {
    let text = r#"{"vertices_coords": [[0,0],[1,0],[2,0],[2,1],[1,1],[0,1]],
        "edges_vertices": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,0],[1,4]],
        "edges_assignment": ["B","B","B","B","B","B","V"],
        "edges_foldAngle": [0,0,0,0,0,0,72.5], "faces_vertices": [[0,1,4,5],[1,2,3,4]]}"#;
    let options = MeshOptions::default();
    let path = Path::new("p.fold");
    let first = parse_mesh(text.as_bytes(), MeshFormat::Fold, path, &options).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("q.fold");
    write_mesh(&path, &first).unwrap();
    let second = read_mesh(&path).unwrap();
    assert_eq!(
        second.creases, first.creases,
        "diagonals are flat edges now"
    );
    // Where no edge has an angle there is no list of angles.
    let square = MeshFile::of_frame(POINTS.concat(), vec![[0, 1, 2], [0, 2, 3]], Vec::new());
    let plain = folder.path().join("plain.fold");
    write_mesh(&plain, &square).unwrap();
    let written: serde_json::Value = serde_json::from_slice(&fs::read(&plain).unwrap()).unwrap();
    assert!(!has_empty_entries(&written), "{written}");
    assert!(written.get("edges_foldAngle").is_none());
    // Mountains and valleys of a pattern are folded whole, as the format has it where no angle is given.
    let pattern = br#"{"file_spec": 1.2, "frame_unit": "cm", "vertices_coords": [[0,0],[1,0],[2,0],[2,1],[1,1],[0,1]],
        "edges_vertices": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,0],[1,4]],
        "edges_assignment": ["B","B","B","B","B","B","M"], "faces_vertices": [[0,1,4,5],[1,2,3,4]]}"#;
    for (letter, angle) in [("M", -180.0), ("V", 180.0)] {
        let text = String::from_utf8_lossy(pattern).replace("\"M\"", &format!("\"{letter}\""));
        let path = folder.path().join("pattern.fold");
        fs::write(&path, text).unwrap();
        let mesh = read_mesh(&path).unwrap();
        write_mesh(&path, &mesh).unwrap();
        let written: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        assert_eq!(written["edges_foldAngle"][6], angle);
        assert!(written["edges_foldAngle"][0].is_null());
        // The unit of the file was known.
        assert_eq!(
            (&written["frame_unit"], &written["vertices_coords"][3][0]),
            (&"m".into(), &0.02.into())
        );
    }
    assert_eq!(read_mesh(&plain).unwrap().faces, square.faces);
    assert_eq!((second.polygons, second.changes), (0, first.changes));
    let valley = second.creases[6];
    assert_eq!(valley.assignment, EdgeAssignment::Valley);
    assert!((valley.angle.unwrap().to_degrees() - 72.5).abs() < 1e-13);
    let cut = text.replace("\"V\"", "\"C\"");
    let cut = parse_mesh(
        cut.as_bytes(),
        MeshFormat::Fold,
        Path::new("c.fold"),
        &options,
    )
    .unwrap();
    assert_eq!(cut.vertex_count(), 8);
    write_mesh(&path, &cut).unwrap();
    let back = read_mesh(&path).unwrap();
    assert_eq!((back.positions, back.faces), (cut.positions, cut.faces));
    // A flat mesh with a face turned over is no crease pattern: its faces stay as they are.
    let mut turned = first;
    turned.faces[0].reverse();
    write_mesh(&path, &turned).unwrap();
    assert_eq!(read_mesh(&path).unwrap().faces, turned.faces);
}

#[test]
fn fold_series_have_the_fold_angles_of_the_mesh() {
    let (sheet, trajectory) = rolled(5);
    let t = sheet.topology();
    let assignments: Vec<_> = t
        .edge_ids()
        .map(|e| (!t.is_boundary_edge(e) && e.index() % 3 == 0).then_some(FoldAssignment::Valley))
        .collect();
    let valleys = assignments.iter().flatten().count();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.fold");
    let series = series(&trajectory).with_assignments(assignments).unwrap();
    let written = write_series(&path, &series).unwrap();
    assert_eq!(
        (written.files, written.frames),
        (vec![path.clone()], vec![0, 1, 2, 3, 4])
    );
    for frame in 0..5 {
        let options = MeshOptions {
            frame: Some(FoldFrame::Number(frame)),
            ..MeshOptions::default()
        };
        let mesh = read_mesh_with(&path, &options).unwrap();
        assert_eq!(mesh.positions, trajectory.frame(frame).unwrap());
        assert_eq!(mesh.faces, sheet.face_indices());
        let count = |a| mesh.creases.iter().filter(|c| c.assignment == a).count();
        assert_eq!(count(EdgeAssignment::Valley), valleys);
        assert_eq!(count(EdgeAssignment::Boundary), t.boundary_edge_count());
        let topology = Topology::from_faces(mesh.vertex_count(), &mesh.faces).unwrap();
        let mut largest: f64 = 0.0;
        for crease in &mesh.creases {
            let [a, b] = crease.ends.map(isosheet_mesh::VertexId);
            let e = topology.find_edge(a, b).unwrap();
            let expected = fold_angle(&topology, &mesh.positions, e).unwrap_or(0.0);
            assert!((crease.angle.unwrap() - expected).abs() < 1e-14);
            largest = largest.max(expected);
        }
        // Between two columns of the cylinder's polygon, whose tangents turn by curvature times width.
        let turn = 4.0 * frame as f64 / 5.0 / 6.0;
        assert!((largest - turn).abs() < 1e-12, "{largest} {turn}");
    }
    let text = fs::read_to_string(&path).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["file_spec"], 1.2);
    assert_eq!(json["file_frames"][2]["isosheet:time"], 0.6);
}

/// Folds that close and pass through themselves by some degrees keep their sides in the file; an unassigned
/// one keeps that from which it came, and what begins shut has that of its assignment.
#[test]
fn shut_folds_keep_their_sides_in_a_file() {
    let positions = |degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.5, 0.0, -c, 0.5, s]
    };
    let sheet = Sheet::new(positions(0.0), &[[0, 2, 1], [0, 1, 3]]).unwrap();
    let t = sheet.topology();
    let crease = t.edge_ids().find(|&e| !t.is_boundary_edge(e)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.fold");
    let (mountain, valley) = (FoldAssignment::Mountain, FoldAssignment::Valley);
    for (degrees, assignment, expected) in [
        (&[0.0, -90.0, -170.0, -185.0][..], Some(mountain), -180.0),
        (&[0.0, 90.0, 170.0, 185.0], Some(valley), 180.0),
        (&[0.0, -90.0, -170.0, -179.0], None, -179.0),
        (&[0.0, -90.0, -170.0, -185.0], None, -180.0),
        // Pressed through itself by as much as it can be, and back.
        (
            &[0.0, -90.0, -200.0, -300.0, -200.0, -100.0],
            Some(mountain),
            -100.0,
        ),
        // A mountain that has popped through to a valley.
        (&[0.0, 60.0, 120.0], Some(mountain), 120.0),
        (&[-185.0], Some(mountain), -180.0),
        (&[185.0], Some(valley), 180.0),
    ] {
        let mut trajectory = Trajectory::new(&sheet);
        for (k, angle) in degrees.iter().enumerate() {
            trajectory.push(k as f64, &positions(*angle)).unwrap();
        }
        let mut assignments = vec![None; t.edge_count()];
        assignments[crease.index()] = assignment;
        let series = series(&trajectory).with_assignments(assignments).unwrap();
        let last = trajectory.len() - 1;
        write_frame(&path, &series, last).unwrap();
        let mesh = read_mesh(&path).unwrap();
        let ends = t.edges()[crease.index()].map(|v| v.0);
        let found = mesh.creases.iter().find(|c| c.ends == ends).unwrap();
        let angle = found.angle.unwrap().to_degrees();
        assert!((angle - expected).abs() < 1e-12, "{degrees:?}: {angle}");
    }
}

/// The format's own reader finds the frames as base plus displacement, and the weights that choose them.
#[test]
fn gltf_has_a_morph_target_for_each_frame() {
    let (_, trajectory) = rolled(4);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.glb");
    write_series(&path, &series(&trajectory)).unwrap();
    let ::gltf::Gltf { document, blob } = ::gltf::Gltf::open(&path).unwrap();
    let blob = blob.unwrap();
    let data = |_: ::gltf::Buffer<'_>| Some(&blob[..]);
    let mesh = document.meshes().next().unwrap();
    let reader_of = mesh.primitives().next().unwrap();
    let reader = reader_of.reader(data);
    let base: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let targets: Vec<Vec<[f32; 3]>> = reader
        .read_morph_targets()
        .map(|(p, _, _)| p.unwrap().collect())
        .collect();
    assert_eq!(targets.len(), 3);
    for frame in 0..4 {
        let x = trajectory.frame(frame).unwrap().as_chunks::<3>().0;
        for (v, &[x, y, z]) in x.iter().enumerate() {
            for (k, expected) in [x, z, -y].into_iter().enumerate() {
                let moved = if frame > 0 {
                    targets[frame - 1][v][k]
                } else {
                    0.0
                };
                let got = f64::from(base[v][k]) + f64::from(moved);
                assert!(
                    (got - expected).abs() < 1.2e-7,
                    "{frame} {v} {k}: {got} {expected}"
                );
            }
        }
    }
    let animation = document.animations().next().unwrap();
    let channel = animation.channels().next().unwrap();
    let reader = channel.reader(data);
    let times: Vec<f32> = reader.read_inputs().unwrap().collect();
    assert_eq!(times, [0.0, 0.25, 0.5, 0.75]);
    let Some(::gltf::animation::util::ReadOutputs::MorphTargetWeights(weights)) =
        reader.read_outputs()
    else {
        panic!("weights");
    };
    let weights: Vec<f32> = weights.into_f32().collect();
    assert_eq!(weights, [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.]);
}

#[test]
fn gltf_takes_key_frames_evenly() {
    let (_, trajectory) = rolled(300);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.glb");
    let frames = write_series(&path, &series(&trajectory)).unwrap().frames;
    assert_eq!(
        (frames.len(), frames[0], frames[119]),
        (MOST_KEY_FRAMES, 0, 299)
    );
    assert!(frames.windows(2).all(|w| (2..=3).contains(&(w[1] - w[0]))));
    let back = read_mesh(&path).unwrap();
    assert_eq!(back.faces, trajectory.faces());
}

#[test]
fn tables_caches_and_single_files_have_the_positions() {
    let (sheet, trajectory) = rolled(7);
    let folder = tempfile::tempdir().unwrap();
    let every = SeriesOptions {
        every: 3,
        ..SeriesOptions::default()
    };
    let series = Series::new(&trajectory, &every).unwrap();
    let csv_path = folder.path().join("run.csv");
    assert_eq!(write_series(&csv_path, &series).unwrap().frames, [0, 3, 6]);
    let mut table = ::csv::Reader::from_path(&csv_path).unwrap();
    let rows: Vec<(usize, f64, usize, f64, f64, f64)> =
        table.deserialize().collect::<Result<_, _>>().unwrap();
    assert_eq!(rows.len(), 3 * trajectory.vertex_count());
    for (frame, t, v, x, y, z) in rows {
        assert_eq!(t, trajectory.times()[frame]);
        assert_eq!(
            trajectory.frame(frame).unwrap()[3 * v..3 * v + 3],
            [x, y, z]
        );
    }

    let path = folder.path().join("run.pc2");
    let written = write_series(&path, &series).unwrap();
    assert_eq!(written.files, [folder.path().join("run.obj"), path.clone()]);
    let bytes = fs::read(&path).unwrap();
    let integer = |at: usize| i32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let vertices = trajectory.vertex_count();
    assert_eq!((&bytes[..12], integer(12)), (&b"POINTCACHE2\0"[..], 1));
    assert_eq!((integer(16) as usize, integer(28)), (vertices, 3));
    assert_eq!(bytes.len(), 32 + 3 * 12 * vertices);
    let numbers: Vec<f32> = bytes[32..]
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| f32::from_le_bytes(*b))
        .collect();
    let last: Vec<f32> = trajectory
        .frame(6)
        .unwrap()
        .iter()
        .map(|&c| c as f32)
        .collect();
    assert_eq!(numbers[2 * 3 * vertices..], last);

    let path = folder.path().join("frames.obj");
    let written = write_series(&path, &series).unwrap();
    assert_eq!(
        written.files[1],
        folder.path().join("frames/frame_00003.obj")
    );
    let mesh = read_mesh(&written.files[2]).unwrap();
    assert_eq!(mesh.positions, trajectory.frame(6).unwrap());
    assert_eq!(mesh.faces, sheet.face_indices());
}

/// A triangle that turns by a quarter about z and moves along x, and one that rests.
fn bodies(frames: usize) -> Vec<SeriesBody> {
    let body = |name: &str, poses: Vec<BodyPose>| SeriesBody {
        name: name.to_owned(),
        positions: vec![1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0],
        faces: vec![[0, 1, 2]],
        poses,
    };
    let pose = |x: f64, turn: f64| BodyPose {
        rotation: [0.0, 0.0, (0.5 * turn).sin(), (0.5 * turn).cos()],
        translation: [x, 0.0, 0.0],
    };
    let last = (frames - 1) as f64;
    let moving = (0..frames).map(|k| pose(k as f64, 0.5 * std::f64::consts::PI * k as f64 / last));
    vec![
        body("obstacle_0", moving.collect()),
        body("obstacle_1", vec![pose(5.0, 0.0)]),
    ]
}

#[test]
fn bodies_are_beside_the_sheet() {
    let (sheet, trajectory) = rolled(3);
    let folder = tempfile::tempdir().unwrap();
    let series = series(&trajectory).with_bodies(bodies(3)).unwrap();
    let path = folder.path().join("run.obj");
    let files = write_series(&path, &series).unwrap().files;
    assert_eq!(files.len(), 6);
    let mesh = read_mesh(&folder.path().join("run/bodies_00002.obj")).unwrap();
    assert_eq!(mesh.faces, [[0, 1, 2], [3, 4, 5]]);
    let expected = [
        2., 1., 0., 0., 0., 0., 2., 0., 3., 6., 0., 0., 5., 2., 0., 5., 0., 3.,
    ];
    for (found, expected) in mesh.positions.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{:?}", mesh.positions);
    }
    // The sheet is alone in its file, with the place of each vertex in a picture.
    let mesh = read_mesh(&folder.path().join("run/frame_00002.obj")).unwrap();
    assert_eq!(mesh.positions, trajectory.frame(2).unwrap());
    let text = fs::read_to_string(folder.path().join("run/frame_00002.obj")).unwrap();
    let uv = text.lines().filter_map(|line| line.strip_prefix("vt "));
    let uv: Vec<f64> = uv
        .flat_map(str::split_whitespace)
        .map(|c| c.parse().unwrap())
        .collect();
    for (uv, p) in uv
        .as_chunks::<2>()
        .0
        .iter()
        .zip(sheet.positions().as_chunks::<3>().0)
    {
        assert!((uv[0] - p[0]).abs() < 1e-12 && (uv[1] - p[1]).abs() < 1e-12);
    }
    assert_eq!(uv.len(), 2 * sheet.topology().vertex_count());

    let path = folder.path().join("run.glb");
    write_series(&path, &series).unwrap();
    let ::gltf::Gltf { document, .. } = ::gltf::Gltf::open(&path).unwrap();
    let names: Vec<_> = document
        .nodes()
        .map(|n| n.name().unwrap().to_owned())
        .collect();
    assert_eq!(names, ["sheet", "obstacle_0", "obstacle_1"]);
    let paths: Vec<_> = document
        .animations()
        .next()
        .unwrap()
        .channels()
        .map(|c| (c.target().node().index(), c.target().property()))
        .collect();
    use ::gltf::animation::Property::{MorphTargetWeights, Rotation, Translation};
    assert_eq!(
        paths,
        [(0, MorphTargetWeights), (1, Translation), (1, Rotation)]
    );
    // The first mesh is the sheet, as readers of one mesh expect; this one reads all that are shown.
    let named = MeshOptions {
        mesh: Some("sheet".to_owned()),
        ..MeshOptions::default()
    };
    let sheet = read_mesh_with(&path, &named).unwrap();
    assert_eq!(sheet.faces, trajectory.faces());
    let all = read_mesh(&path).unwrap();
    let [first, second] = [0, 1].map(|k| bodies(3)[k].faces.len());
    assert_eq!(all.faces.len(), sheet.faces.len() + first + second);

    let wrong = |change: fn(&mut SeriesBody)| {
        let mut bodies = bodies(3);
        change(&mut bodies[0]);
        series.clone().with_bodies(bodies).unwrap_err()
    };
    let poses = wrong(|body| body.poses.truncate(2));
    let poses = poses.to_string();
    assert!(
        poses.ends_with("has 2 poses, and the trajectory 3 frames"),
        "{poses}"
    );
    let name = wrong(|body| body.name = "a body".to_owned());
    assert_eq!(name.to_string(), "\"a body\" is no name of a body");
    let face = wrong(|body| body.faces[0][1] = 3);
    assert!(
        face.to_string().contains("refers to vertex 3 of 3"),
        "{face}"
    );
}

#[test]
fn a_part_of_the_frames_is_written() {
    let (_, trajectory) = rolled(7);
    let part = |first, last, every| {
        let options = SeriesOptions {
            first,
            last,
            every,
            ..SeriesOptions::default()
        };
        Series::new(&trajectory, &options).map(|series| series.frames().to_vec())
    };
    assert_eq!(part(2, Some(5), 2).unwrap(), [2, 4]);
    assert_eq!(part(5, None, 1).unwrap(), [5, 6]);
    for (first, last, wrong, says) in [
        (
            2,
            Some(7),
            7,
            "there is no frame 7: the trajectory has 7 frames",
        ),
        (9, None, 9, "there is no frame 9: "),
        (3, Some(2), 3, "frames from 3 to 2 were asked for"),
    ] {
        match part(first, last, 1) {
            Err(ExportError::Frames(error)) => {
                assert!(error.message.starts_with(says), "{error}");
                assert_eq!(error.index, Some(wrong));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn strains_are_relative_elongations() {
    let sheet = generate::grid(1, 1, 1.0, 1.0, Diagonals::Rising).unwrap();
    let mut trajectory = Trajectory::new(&sheet);
    let doubled: Vec<f64> = sheet.positions().iter().map(|c| 2.0 * c).collect();
    trajectory.push(0.0, sheet.positions()).unwrap();
    trajectory.push(1.0, &doubled).unwrap();
    trajectory.push(1.0, sheet.positions()).unwrap();
    let series = series(&trajectory);
    assert_eq!(series.frames(), [0, 1], "one frame for each time");
    assert_eq!(series.edge_strains(0), [0.0; 5]);
    assert!(
        series
            .edge_strains(1)
            .iter()
            .all(|s| (s - 1.0).abs() < 1e-15)
    );
    assert_eq!(series.fold_angles(0), [0.0; 5]);
}

#[test]
fn what_cannot_be_written_is_refused_by_name() {
    let (sheet, trajectory) = rolled(3);
    let empty = Trajectory::new(&sheet);
    let refused = |t: &Trajectory, every| {
        let options = SeriesOptions {
            every,
            ..SeriesOptions::default()
        };
        Series::new(t, &options).unwrap_err()
    };
    let of = |error: ExportError| match error {
        ExportError::Data(error) => error,
        other => panic!("{other:?}"),
    };
    let none = of(refused(&empty, 1));
    assert_eq!(none.message, "the trajectory has no frames");
    let zeroth = of(refused(&trajectory, 0));
    assert_eq!(zeroth.message, "every 0th frame was asked for");
    let ok = || series(&trajectory);
    let assigned = ok().with_assignments(vec![None; 3]).unwrap_err();
    assert!(
        assigned.to_string().contains("there are 3 values"),
        "{assigned}"
    );
    let field = |name: &str, values: Vec<f64>| SeriesField {
        name: name.to_owned(),
        support: FieldSupport::Faces,
        values,
    };
    let n = 3 * sheet.topology().face_count();
    let error = |f| of(ok().with_field(f).unwrap_err());
    let few = error(field("a", vec![0.0; 5]));
    assert!(few.message.contains("there are 5 values"), "{few}");
    let mut bad = vec![0.0; n];
    bad[7] = f64::NAN;
    let nan = error(field("a", bad));
    assert_eq!(nan.message, "value 7 of the field \"a\" is NaN");
    assert_eq!(nan.index, Some(7));
    let twice = error(field("strain", vec![0.0; n]));
    assert!(twice.message.contains("two fields"), "{twice}");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xyz");
    let unknown = write_series(&path, &ok()).unwrap_err().to_string();
    assert!(
        unknown.contains(".xyz") && unknown.contains(".usda"),
        "{unknown}"
    );
    let unknown = write_mesh(&path, &mesh()).unwrap_err().to_string();
    assert!(
        unknown.contains(".ply") && !unknown.contains(".pvd"),
        "{unknown}"
    );
    let mut nan = mesh();
    nan.positions[4] = f64::NAN;
    let mut huge = mesh();
    huge.positions[4] = 1e39;
    let mut wrong = mesh();
    wrong.faces[2][1] = 9;
    for format in ExportMeshFormat::ALL {
        let path = folder.path().join(format!("a.{}", format.extension()));
        let says = |mesh: &MeshFile, text: &str, index: usize| {
            let error = of(write_mesh(&path, mesh).unwrap_err());
            assert!(error.message.starts_with(text), "{error}");
            assert_eq!(error.index, Some(index));
        };
        says(&nan, "coordinate y of vertex 1 is NaN", 1);
        says(&wrong, "face 2 refers to vertex 9", 2);
        let single = ["stl", "glb", "usda"].contains(&format.extension());
        match write_mesh(&path, &huge) {
            Err(error) => {
                assert!(single, "{format:?}");
                assert!(
                    error
                        .to_string()
                        .starts_with("coordinate y of vertex 1 is 1e39, too")
                );
            }
            Ok(()) => assert!(!single, "{format:?}"),
        }
        assert_eq!(path.exists(), !single, "{format:?}");
    }
    let mut far = Trajectory::new(&sheet);
    far.push(0.0, &vec![1e300; sheet.positions().len()])
        .unwrap();
    for extension in ["glb", "usda", "pc2"] {
        let path = folder.path().join(format!("far.{extension}"));
        let error = write_series(&path, &series(&far)).unwrap_err();
        assert!(
            error.to_string().contains("too large for the 32-bit"),
            "{error}"
        );
        assert!(!path.exists());
    }
    assert!(series(&far).fold_angles(0).iter().all(|a| a.is_finite()));
}
