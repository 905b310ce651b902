use super::motion_archive;
use crate::mesh_file::MeshFile;
use crate::{Clock, MovingMesh};
use crate::{Series, SeriesOptions, Trajectory, write_series};
use isosheet_mesh::generate;
use std::path::Path;

fn read(path: &Path) -> Result<MovingMesh, String> {
    let archive = motion_archive(path).map_err(|e| e.to_string())?;
    MovingMesh::parse(&archive, path).map_err(|e| e.to_string())
}

/// A square that bends, at uneven times; coordinates have few digits where `is_single`.
fn bending(is_single: bool) -> Trajectory {
    let square = generate::isotropic_square(1, 1.0).unwrap();
    let mut trajectory = Trajectory::new(&square);
    for (k, t) in [0.0, 0.25, 1.0 / 3.0, 1.7].into_iter().enumerate() {
        let bend = |p: &[f64; 3]| [p[0] + 0.1 * t, p[1], p[2] + 0.3 * k as f64 * p[0] * p[0]];
        let x = square.positions().as_chunks::<3>().0.iter().flat_map(bend);
        let digits = |c: f64| if is_single { f64::from(c as f32) } else { c };
        let x: Vec<f64> = x.map(digits).collect();
        trajectory.push(t, &x).unwrap();
    }
    trajectory
}

/// What was exported is read back: all numbers, and the times to round-off.
#[test]
fn the_exports_of_a_motion_are_that_motion() {
    let dir = tempfile::tempdir().unwrap();
    for (name, is_single, has_times) in [
        ("a.npz", false, true),
        ("b.pvd", false, true),
        ("d.obj", false, false),
    ] {
        let motion = bending(is_single);
        let series = Series::new(&motion, &SeriesOptions::default()).unwrap();
        let path = dir.path().join(name);
        write_series(&path, &series).unwrap();
        let folder = path.with_extension("");
        let of_folder = [folder.clone(), folder.join("frame_*.obj")];
        let of_list = [path.clone(), folder];
        let paths = match name {
            "d.obj" => &of_folder[..],
            "b.pvd" => &of_list[..],
            _ => &of_list[..1],
        };
        for path in paths {
            let found = read(path).unwrap();
            assert_eq!(found.clock() == Clock::Seconds, has_times, "{path:?}");
            for (k, t) in motion.times().iter().enumerate() {
                let expected = if has_times { *t } else { k as f64 };
                assert!((found.times()[k] - expected).abs() < 1e-15, "{path:?}");
                assert_eq!(found.frame(k).as_flattened(), motion.frame(k).unwrap());
            }
            assert_eq!(found.faces(), motion.faces());
        }
    }
}

/// The trajectory in the folder of a run is taken, and a list of legacy files with their times.
#[test]
fn folders_of_runs_and_lists_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let motion = bending(false);
    motion
        .write(&dir.path().join("run/trajectory.npz"))
        .unwrap();
    let found = read(&dir.path().join("run")).unwrap();
    assert_eq!(found.frame(3).as_flattened(), motion.frame(3).unwrap());
    std::fs::remove_file(dir.path().join("run/trajectory.npz")).unwrap();
    std::fs::write(dir.path().join("run/scene.toml"), "").unwrap();
    let said = read(&dir.path().join("run")).unwrap_err();
    assert!(said.contains("has no trajectory.npz"), "{said}");

    let vtk = |z: f64| {
        format!(
            "# vtk DataFile Version 3.0\nleaf\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0 1 0 0 1 1 {z} 0 1 0\n\
             METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n\
             POLYGONS 1 5\n4 0 1 2 3\nPOINT_DATA 4\nSCALARS a float\n"
        )
    };
    for (name, z) in [("leaf_a.vtk", 0.0), ("leaf_b.vtk", 0.125)] {
        std::fs::write(dir.path().join(name), vtk(z)).unwrap();
    }
    let list = r#"{"file-series-version": "1.0", "files": [{"name": "leaf_a.vtk", "time": 0.5},
        {"name": "leaf_b.vtk", "time": 0.75}]}"#;
    let path = dir.path().join("leaf.vtk.series");
    std::fs::write(&path, list).unwrap();
    let found = read(&path).unwrap();
    assert_eq!(found.times(), [0.5, 0.75]);
    assert_eq!(found.frame(1)[2], [1.0, 1.0, 0.125]);
    assert_eq!(found.faces().len(), 2);
    std::fs::write(&path, list.replace("leaf_b", "../leaf_b")).unwrap();
    assert!(read(&path).is_err());
}

/// Frames of polygons are cut as the first one is, whichever diagonal is the shorter one later.
#[test]
fn numbered_polygons_keep_the_triangles_of_the_first() {
    let dir = tempfile::tempdir().unwrap();
    for (name, x) in [("walk8.obj", 1.5), ("walk9.obj", 1.0), ("walk10.obj", 0.25)] {
        let text = format!("v 0 0 0\nv 1 0 0\nv {x} {x} 0\nv 0 1 0\nf 1 2 3 4\n");
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let found = read(&dir.path().join("walk*.obj")).unwrap();
    assert_eq!(
        (found.clock(), found.times()),
        (Clock::Frames, &[0.0, 1.0, 2.0][..])
    );
    assert_eq!(found.frame(2)[2], [0.25, 0.25, 0.0]);
    let alone = MeshFile::of_frame(
        found.frame(0).as_flattened().to_vec(),
        found.faces().to_vec(),
        Vec::new(),
    );
    assert_eq!(alone.faces.len(), 2);
}

/// The k-th file in the order of the numbers is k frames after the first one, whatever distance the numbers
/// have; one that is missing is told, but for files that have times.
#[test]
fn numbers_of_samples_have_one_distance() {
    let dir = tempfile::tempdir().unwrap();
    let write = |folder: &str, numbers: &[u64], extension: &str| {
        std::fs::create_dir(dir.path().join(folder)).unwrap();
        for number in numbers {
            let path = format!("{folder}/walk_{number:04}.{extension}");
            let text = match extension {
                "obj" => format!("v 0 0 {number}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                _ => format!(
                    "# vtk DataFile Version 3.0\nwalk\nASCII\nDATASET POLYDATA\nFIELD FieldData 1\n\
                     TimeValue 1 1 double\n{number}\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
                ),
            };
            std::fs::write(dir.path().join(path), text).unwrap();
        }
        read(&dir.path().join(folder))
    };
    for (folder, numbers) in [("each", [8, 9, 10]), ("tenth", [10, 20, 30])] {
        let found = write(folder, &numbers, "obj").unwrap();
        let frames = (found.clock(), found.times());
        assert_eq!(frames, (Clock::Frames, &[0.0, 1.0, 2.0][..]), "{folder}");
        let heights = [0, 1, 2].map(|k| found.frame(k)[0][2]);
        assert_eq!(heights, numbers.map(|n| n as f64));
    }
    let said = write("gap", &[8, 9, 11, 12], "obj").unwrap_err();
    assert!(
        said.contains("number 11 follows 9, and others are 1 apart"),
        "{said}"
    );
    let found = write("times", &[8, 9, 11], "vtk").unwrap();
    assert_eq!(
        (found.clock(), found.times()),
        (Clock::Seconds, &[8.0, 9.0, 11.0][..])
    );
}

#[test]
fn samples_that_do_not_fit_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let says = |name: &str| read(&dir.path().join(name)).unwrap_err();
    let obj = |x: &[f64], faces: &str| {
        let vertices = x.iter().map(|x| format!("v {x} {} 0\n", x * x));
        vertices.collect::<String>() + faces
    };
    let write = |name: &str, text: &str| {
        let path = dir.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    std::fs::create_dir(dir.path().join("empty")).unwrap();
    assert!(
        says("empty").contains("no mesh files whose names end with"),
        "{}",
        says("empty")
    );
    assert!(says("nothing_*.obj").contains("the folder has no files"));
    assert!(says("a_*_*.obj").contains("several *"));
    assert!(says("missing.npz").contains("cannot read"));
    let four = [0.0, 1.0, 2.0, 3.0];
    write("more/a_1.obj", &obj(&four, "f 1 2 3\nf 1 3 4\n"));
    write(
        "more/a_2.obj",
        &obj(&[0.0, 1.0, 2.0, 3.0, 4.0], "f 1 2 3\nf 1 3 4\n"),
    );
    assert!(
        says("more").contains("a_2.obj: sample 1 has 5 vertices, and a_1.obj has 4"),
        "{}",
        says("more")
    );
    write("more/a_2.obj", &obj(&four, "f 1 2 3\n"));
    assert!(
        says("more").contains("sample 1 has 1 face, and a_1.obj has 2"),
        "{}",
        says("more")
    );
    write("more/a_2.obj", &obj(&four, "f 1 2 4\nf 2 3 4\n"));
    assert!(
        says("more").contains("faces between other vertices"),
        "{}",
        says("more")
    );
    let said = says("more/b_*.obj");
    assert!(
        said.contains("no file has a name of this pattern with a number for the *: the folder has a_1.obj, a_2.obj"),
        "{said}"
    );
    write("more/a_2.obj", "f 1 2\n");
    assert!(says("more").contains("a_2.obj: "), "{}", says("more"));
    write("more/a_2.obj", &obj(&four, "f 1 2 3\nf 1 3 4\n"));
    write("more/a_02.obj", &obj(&four, "f 1 2 3\nf 1 3 4\n"));
    assert!(
        says("more").contains("has the number 2, which"),
        "{}",
        says("more")
    );
    write("two/a_1.obj", "");
    write("two/b_1.obj", "");
    assert!(
        says("two").contains("several meshes in motion: a_*.obj, b_*.obj"),
        "{}",
        says("two")
    );
    write(
        "l.pvd",
        "<VTKFile><Collection><DataSet file=\"a\"/></Collection></VTKFile>",
    );
    assert!(
        says("l.pvd").contains("sample 0 has no `timestep`"),
        "{}",
        says("l.pvd")
    );
    write(
        "l.pvd",
        "<VTKFile><Collection><DataSet timestep=\"1\" file=\"more/a_1.obj\"/>\
         <DataSet timestep=\"1\" file=\"more/a_2.obj\"/></Collection></VTKFile>",
    );
    assert!(
        says("l.pvd").contains("frame 1 has the time 1 s after 1 s"),
        "{}",
        says("l.pvd")
    );
}

/// Files with numbers that no integer holds are refused, and not passed over.
#[test]
fn numbers_beyond_64_bits_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        std::fs::write(
            dir.path().join(name),
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        )
        .unwrap();
    };
    for name in ["a1.obj", "a2.obj", "a00000000000000000000000003.obj"] {
        write(name);
    }
    let paths = [dir.path().to_owned(), dir.path().join("a*.obj")];
    for path in &paths {
        assert_eq!(read(path).unwrap().times(), [0.0, 1.0, 2.0]);
    }
    write("a18446744073709551616.obj");
    for path in &paths {
        let said = read(path).unwrap_err();
        assert!(said.contains("a18446744073709551616.obj"), "{said}");
        assert!(said.contains("larger than 18446744073709551615"), "{said}");
    }
}
