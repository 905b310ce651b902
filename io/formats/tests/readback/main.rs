//! Programs of others read what is written: the validator of Khronos for glTF, USD, VTK, numpy and Blender.
//!
//! They are not part of the repository. `ISOSHEET_PYTHON` names a Python that has the packages numpy,
//! usd-core, vtk or bpy (otherwise `python3` is tried), and `NODE_PATH` the folder that has the package
//! gltf-validator. What is missing is skipped, with a word about it.

#[path = "../../../tests/shared/skip.rs"]
mod skip;

use isosheet_formats::{
    BodyPose, FieldSupport, FrameData, MeshFile, Series, SeriesBody, SeriesField, SeriesOptions,
    Trajectory, read_mesh, write_mesh, write_series,
};
use isosheet_mesh::generate::Diagonals;
use isosheet_mesh::{Sheet, generate};
use skip::{runs, skipped};
use std::path::Path;
use std::process::Command;

/// Runs a script with arguments, if there are the packages that it needs: numpy, and one more at most.
fn python(packages: &str, script: &str, arguments: &[&Path]) {
    let name = std::env::var("ISOSHEET_PYTHON").unwrap_or_else(|_| "python3".into());
    if !runs(&name, &["-c", &format!("import {packages}")]) {
        let need = packages.rsplit(", ").next().unwrap_or(packages);
        return skipped(need, &format!("{name} does not import {packages}"));
    }
    let output = Command::new(&name)
        .args(["-c", script])
        .args(arguments)
        .output();
    succeeded(output.expect("Python starts"));
}

fn succeeded(output: std::process::Output) {
    let [out, err] =
        [output.stdout, output.stderr].map(|t| String::from_utf8_lossy(&t).into_owned());
    assert!(output.status.success(), "{out}{err}");
}

/// A strip that is rolled up and stretched by a hundredth at the end, in frames at uneven times.
fn run() -> (Sheet, Trajectory) {
    let sheet = generate::grid(8, 3, 1.0, 0.4, Diagonals::UnionJack).expect("a grid");
    let mut trajectory = Trajectory::new(&sheet);
    for k in 0..12 {
        let (t, curvature) = (0.01 * f64::from(k * k), 0.4 * f64::from(k));
        let stretch = if k == 11 { 1.01 } else { 1.0 };
        let place = |p: &[f64; 3]| {
            let p = p.map(|c| stretch * c);
            match curvature {
                0.0 => p,
                c => [(c * p[0]).sin() / c, p[1], (1.0 - (c * p[0]).cos()) / c],
            }
        };
        let points = sheet.positions().as_chunks::<3>().0;
        let x: Vec<f64> = points.iter().flat_map(place).collect();
        // Numbers that tell frames, vertices and axes apart.
        let contact_forces: Vec<f64> = x.iter().map(|c| c * c - 0.25 * t).collect();
        let gaps: Vec<f64> = (0..x.len() / 3).map(|v| 1e-3 * v as f64 + t).collect();
        let data = FrameData {
            contact_forces: &contact_forces,
            gaps: &gaps,
            ..FrameData::default()
        };
        trajectory.push_with(t, &x, &data).expect("a frame");
    }
    (sheet, trajectory)
}

/// A tetrahedron that turns about the z axis by one radian a second, from the place (0, 0.5, 1) along x at
/// one metre a second, and one that rests at (0, 0, -1).
fn bodies(trajectory: &Trajectory) -> Vec<SeriesBody> {
    let body = |name: &str, poses: Vec<BodyPose>| SeriesBody {
        name: name.to_owned(),
        positions: vec![0., 0., 0., 0.3, 0., 0., 0., 0.2, 0., 0., 0., 0.1],
        faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        poses,
    };
    let moving = |t: &f64| BodyPose {
        rotation: [0.0, 0.0, (0.5 * t).sin(), (0.5 * t).cos()],
        translation: [*t, 0.5, 1.0],
    };
    let rest = BodyPose {
        rotation: [0.0, 0.0, 0.0, 1.0],
        translation: [0.0, 0.0, -1.0],
    };
    let moving = trajectory.times().iter().map(moving).collect();
    vec![body("obstacle_0", moving), body("obstacle_1", vec![rest])]
}

/// The frames with the bodies.
fn series(trajectory: &Trajectory) -> Series<'_> {
    let series = Series::new(trajectory, &SeriesOptions::default()).expect("frames");
    series.with_bodies(bodies(trajectory)).expect("bodies")
}

/// A mesh file in memory, by way of a file.
fn mesh_of(sheet: &Sheet, folder: &Path) -> MeshFile {
    let path = folder.join("sheet.obj");
    isosheet_formats::write_obj(&path, sheet.topology(), sheet.positions()).expect("written");
    read_mesh(&path).expect("read")
}

#[test]
fn khronos_accepts_the_gltf_files() {
    if !runs("node", &["-e", "require('gltf-validator')"]) {
        return skipped("gltf-validator", "node does not find the package");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let (sheet, trajectory) = run();
    let series = series(&trajectory);
    let [moving, still] = ["run.glb", "mesh.glb"].map(|name| folder.path().join(name));
    write_series(&moving, &series).expect("written");
    write_mesh(&still, &mesh_of(&sheet, folder.path())).expect("written");
    for (path, targets) in [(&moving, 11), (&still, 0)] {
        let output = Command::new("node")
            .args(["-e", include_str!("gltf.js")])
            .args([path.as_os_str(), targets.to_string().as_ref()])
            .output();
        succeeded(output.expect("node starts"));
    }
}

#[test]
fn openusd_finds_the_time_samples() {
    let folder = tempfile::tempdir().expect("a folder");
    let (sheet, trajectory) = run();
    let series = series(&trajectory);
    let path = |name| folder.path().join(name);
    write_series(&path("run.usda"), &series).expect("written");
    write_mesh(&path("mesh.usda"), &mesh_of(&sheet, folder.path())).expect("written");
    trajectory.write(&path("run.npz")).expect("written");
    let files = [&*path("run.usda"), &*path("mesh.usda"), &*path("run.npz")];
    python("numpy, pxr", include_str!("usd.py"), &files);
}

#[test]
fn blender_plays_the_animations() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, trajectory) = run();
    let series = series(&trajectory);
    let path = |name| folder.path().join(name);
    for name in ["run.usda", "run.glb", "run.pc2"] {
        write_series(&path(name), &series).expect("written");
    }
    trajectory.write(&path("run.npz")).expect("written");
    let files = ["run.usda", "run.glb", "run.pc2", "run.obj", "run.npz"].map(path);
    let files = files.each_ref().map(|file| &**file);
    python("numpy, bpy", include_str!("blender.py"), &files);
}

#[test]
fn vtk_finds_positions_times_strains_angles_and_fields() {
    let folder = tempfile::tempdir().expect("a folder");
    let (sheet, trajectory) = run();
    let t = sheet.topology();
    let field = |name: &str, support, n: usize| SeriesField {
        name: name.to_owned(),
        support,
        values: (0..trajectory.len() * n).map(|k| 0.5 * k as f64).collect(),
    };
    let every = SeriesOptions {
        every: 2,
        ..SeriesOptions::default()
    };
    let series = Series::new(&trajectory, &every)
        .and_then(|s| {
            s.with_field(field(
                "height <m>",
                FieldSupport::Vertices,
                t.vertex_count(),
            ))
        })
        .and_then(|s| s.with_field(field("energy", FieldSupport::Faces, t.face_count())))
        .and_then(|s| s.with_field(field("force & load", FieldSupport::Edges, t.edge_count())))
        .and_then(|s| s.with_bodies(bodies(&trajectory)))
        .expect("fields that fit");
    let path = |name| folder.path().join(name);
    write_series(&path("the run.pvd"), &series).expect("written");
    write_series(&path("run.fold"), &series).expect("written");
    trajectory.write(&path("run.npz")).expect("written");
    let files = [&*path("the run.pvd"), &*path("run.fold"), &*path("run.npz")];
    python("numpy, vtk", include_str!("vtk.py"), &files);
}

/// The readers of VTK find the mesh in the formats that it has; all but OBJ are binary.
#[test]
fn vtk_finds_the_mesh() {
    let folder = tempfile::tempdir().expect("a folder");
    let (sheet, trajectory) = run();
    let mesh = mesh_of(&sheet, folder.path());
    let path = |name| folder.path().join(name);
    for name in ["mesh.obj", "mesh.ply", "mesh.stl"] {
        write_mesh(&path(name), &mesh).expect("written");
    }
    trajectory.write(&path("run.npz")).expect("written");
    let files = [
        &*path("mesh.obj"),
        &*path("mesh.ply"),
        &*path("mesh.stl"),
        &*path("run.npz"),
    ];
    python("numpy, vtk", include_str!("meshes.py"), &files);
}

#[test]
fn numpy_finds_the_point_cache_and_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, trajectory) = run();
    let series = Series::new(&trajectory, &SeriesOptions::default()).expect("frames");
    let path = |name| folder.path().join(name);
    write_series(&path("run.pc2"), &series).expect("written");
    write_series(&path("run.csv"), &series).expect("written");
    trajectory.write(&path("run.npz")).expect("written");
    let files = [&*path("run.pc2"), &*path("run.csv"), &*path("run.npz")];
    python("numpy", include_str!("tables.py"), &files);
}
