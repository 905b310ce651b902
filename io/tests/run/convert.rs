//! `isosheet convert`.

use crate::{code, isosheet, run, stderr, with_scene, with_short_run};
use isosheet_formats::{
    EdgeAssignment, ExportMeshFormat, FoldFrame, MeshFile, MeshFormat, MeshOptions, SeriesFormat,
    Trajectory, read_mesh, read_mesh_with,
};
use isosheet_runs::Recording;
use isosheet_scenes::{SceneFile, StartingPoint};
use std::fs;
use std::path::Path;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(code(&output), Some(0), "{arguments:?}: {}", stderr(&output));
    text(&output.stdout)
}

fn refused(folder: &Path, arguments: &[&str], exit: i32) -> String {
    let output = run(folder, arguments);
    assert_eq!(
        code(&output),
        Some(exit),
        "{arguments:?}: {}",
        stderr(&output)
    );
    assert!(output.stdout.is_empty());
    stderr(&output)
}

#[test]
fn mesh_files_are_converted() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let off = "OFF 5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 1.001 0\n4 0 1 2 3\n3 3 4 0\n";
    fs::write(dir.join("a.off"), off).unwrap();
    let said = done(dir, &["convert", "a.off", "b.ply"]);
    assert_eq!(
        said,
        "b.ply: 5 vertices and 3 faces, 1 polygon cut into triangles\n"
    );
    let read = |name: &str| read_mesh(&dir.join(name)).unwrap();
    assert_eq!(read("b.ply").positions, read("a.off").positions);
    let said = done(dir, &["convert", "b.ply", "c.fold", "--weld", "0.002"]);
    assert_eq!(said, "c.fold: 4 vertices and 3 faces, 1 vertex welded\n");
    for (from, to) in [("c.fold", "d.stl"), ("d.stl", "e.glb"), ("e.glb", "F.OBJ")] {
        done(dir, &["convert", from, to]);
        assert_eq!(read(to).faces.len(), 3, "{to}");
    }
    done(dir, &["convert", "a.off", "-o", "c.ply"]);
    refused(dir, &["convert", "a.off"], 2);
    refused(dir, &["convert", "a.off", "b.ply", "-o", "c.ply"], 2);
    let said = refused(dir, &["convert", "a.off", "b.step"], 2);
    assert!(said.contains(".step is no format"), "{said}");
    for missing in ["a.xyz", "a-run", "none.obj", "none.npz"] {
        let said = refused(dir, &["convert", missing, "b.ply"], 3);
        assert!(
            said.contains(missing) && said.contains("No such file"),
            "{said}"
        );
    }
    fs::write(dir.join("a.xyz"), "").unwrap();
    let said = refused(dir, &["convert", "a.xyz", "b.ply"], 3);
    assert!(said.contains(".fold, .gltf, .glb"), "{said}");
    refused(dir, &["convert", "a.off", "g.ply", "--every", "2"], 2);
    refused(dir, &["convert", "a.off", "g.ply", "--weld=-1"], 2);
    refused(dir, &["convert", "a.off", "g.ply", "--every", "0"], 2);
    assert!(!dir.join("g.ply").exists());
}

/// Another file is replaced; what is read is not, by whatever name it is called.
#[test]
fn what_is_read_is_not_replaced() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n# mine\n";
    for name in ["a.obj", "b.obj"] {
        fs::write(dir.join(name), square).unwrap();
    }
    let read = |name: &str| fs::read_to_string(dir.join(name)).unwrap();
    fs::create_dir(dir.join("sub")).unwrap();
    let mut names = vec!["a.obj", "./a.obj", "sub/../a.obj"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../a.obj", dir.join("sub/link.obj")).unwrap();
        fs::hard_link(dir.join("a.obj"), dir.join("hard.obj")).unwrap();
        names.extend(["sub/link.obj", "hard.obj"]);
    }
    for name in names {
        let said = refused(dir, &["convert", "a.obj", name], 2);
        assert!(said.contains("is the file that is read"), "{said}");
        assert_eq!(read(name), square);
    }
    done(dir, &["convert", "a.obj", "b.obj"]);
    assert!(!read("b.obj").contains("mine") && read("a.obj") == square);

    fs::write(dir.join("scene.toml"), StartingPoint::Hanging.text()).unwrap();
    let edits = ["--set", "stop.time=0.1", "--out", "run"];
    let simulated = run(dir, &[&["simulate", "scene.toml"], &edits[..]].concat());
    assert_eq!(code(&simulated), Some(0), "{}", stderr(&simulated));
    let history = read("run/history.csv");
    for (file, remedy) in [
        ("scene.toml", "`isosheet simulate scene.toml`"),
        ("run/scene.toml", "name its folder, run"),
        ("run/summary.json", "name its folder, run"),
    ] {
        let said = refused(dir, &["convert", file, "x.obj"], 3);
        assert!(said.contains(remedy), "{said}");
    }
    let said = refused(dir, &["convert", "run", "run"], 2);
    assert!(said.contains("run is the folder that is read"), "{said}");
    for (input, file) in [
        ("run", "run/history.csv"),
        ("run/trajectory.npz", "run/history.csv"),
        ("run", "run/loads.csv"),
    ] {
        let said = refused(dir, &["convert", input, file], 2);
        assert!(said.contains("is a file of the run in"), "{said}");
    }
    // A point cache has a mesh beside it.
    let said = refused(dir, &["convert", "run", "a.pc2"], 6);
    assert!(said.contains("a.obj, which is there"), "{said}");
    assert_eq!(read("a.obj"), square);
    done(dir, &["convert", "run", "cache.pc2"]);
    done(dir, &["convert", "run", "cache.pc2"]);
    for (input, option) in [("run", "--scale=2"), ("run/trajectory.npz", "--no-bodies")] {
        refused(dir, &["convert", input, "x.png", option], 2);
    }
    refused(
        dir,
        &["convert", "run/trajectory.npz", "x.csv", "--no-bodies"],
        2,
    );
    assert_eq!(read("run/history.csv"), history);
    let count = || fs::read_dir(dir.join("run")).unwrap().count();
    let before = count();
    for name in ["run.pvd", "run.obj", "run/"] {
        refused(dir, &["convert", "run", name], 2);
    }
    assert_eq!(count(), before);
    done(dir, &["convert", "run", "run/points.csv"]);
    done(dir, &["convert", "run", "run.csv"]);
    done(dir, &["convert", "run", "run.obj", "--frame", "1"]);
}

/// A file whose name says another format than it has, and mesh files where scenes are meant.
#[test]
fn files_of_the_wrong_kind_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    for name in [
        "a.obj", "a.off", "a.stl", "a.ply", "a.fold", "a.glb", "a.gltf",
    ] {
        fs::write(dir.join(name), square).unwrap();
    }
    for (arguments, exit, parts) in [
        (
            ["convert", "a.off", "b.obj"],
            3,
            ["keyword OFF", "found \"v\""],
        ),
        (["convert", "a.stl", "b.obj"], 3, ["cut short", "a.stl"]),
        (
            ["convert", "a.ply", "b.obj"],
            3,
            ["line 1: expected the word ply", "found \"v 0 0 0\""],
        ),
        (
            ["convert", "a.fold", "b.obj"],
            3,
            ["not valid FOLD", "line 1"],
        ),
        (
            ["convert", "a.glb", "b.obj"],
            3,
            ["not valid glTF", "line 1"],
        ),
        (
            ["convert", "a.gltf", "b.obj"],
            3,
            ["not valid glTF", "line 1"],
        ),
        (
            ["convert", "a.obj", "b.png"],
            2,
            [".png is no format", "the folder of a run"],
        ),
        (
            ["simulate", "--out=r", "a.obj"],
            3,
            ["a.obj: it is a mesh file and no scene", "mesh = { file"],
        ),
    ] {
        let said = refused(dir, &arguments, exit);
        for part in parts {
            assert!(said.contains(part), "{arguments:?}: {part}: {said}");
        }
    }
    let sweep = ["sweep", "a.obj", "--over", "stop.time=1,2"];
    assert!(refused(dir, &sweep, 3).contains("a mesh file and no scene"));
    let said = refused(dir, &["info", "a.obj"], 3);
    assert!(
        said.contains("isosheet convert") && !said.contains("Polygons"),
        "{said}"
    );
}

#[test]
fn runs_are_converted() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("fold.toml"), StartingPoint::Fold.text()).unwrap();
    done(
        dir,
        &[
            "simulate",
            "fold.toml",
            "--out",
            "r",
            "--set",
            "stop.time=0.2",
        ],
    );
    let recording = Recording::read(&dir.join("r")).unwrap();
    let trajectory = &recording.trajectory;
    let frames = trajectory.len();
    assert!(frames >= 3, "{frames} frames");

    for format in SeriesFormat::ALL {
        let name = format!("out.{}", format.extension());
        let said = done(dir, &["convert", "r", &name]);
        assert!(said.contains(&format!(": {frames} frames")), "{said}");
    }
    let last = MeshOptions {
        frame: Some(FoldFrame::Number(frames - 1)),
        ..MeshOptions::default()
    };
    let mesh = read_mesh_with(&dir.join("out.fold"), &last).unwrap();
    assert_eq!(mesh.positions, trajectory.frame(frames - 1).unwrap());
    // 4 x 4 panels: three lines of four creases each way, and a diagonal in each panel.
    let count = |a| mesh.creases.iter().filter(|c| c.assignment == a).count();
    let creases = count(EdgeAssignment::Mountain) + count(EdgeAssignment::Valley);
    assert_eq!((creases, count(EdgeAssignment::Flat)), (24, 16));
    for crease in &mesh.creases {
        let angle = crease.angle.unwrap();
        match crease.assignment {
            EdgeAssignment::Mountain => assert!(angle < -1e-3, "{angle}"),
            EdgeAssignment::Valley => assert!(angle > 1e-3, "{angle}"),
            _ => {}
        }
    }
    let said = done(
        dir,
        &["convert", "r/trajectory.npz", "every.csv", "--every", "2"],
    );
    assert!(
        said.contains(&format!(": {} frames", frames.div_ceil(2))),
        "{said}"
    );

    for format in ExportMeshFormat::ALL {
        let name = format!("one.{}", format.extension());
        done(dir, &["convert", "r", &name, "--frame", "1"]);
    }
    let one = read_mesh(&dir.join("one.fold")).unwrap();
    assert_eq!(one.positions, trajectory.frame(1).unwrap());
    assert_eq!(one.creases.len(), mesh.creases.len());

    let said = refused(dir, &["convert", "r", "one.ply"], 2);
    assert!(said.contains("--frame K"), "{said}");
    refused(dir, &["convert", "r", "x.ply", "--frame", "99999"], 2);
    refused(
        dir,
        &["convert", "r", "x.ply", "--frame", "1", "--every", "2"],
        2,
    );
    refused(dir, &["convert", "r", "x.csv", "--weld", "1"], 2);
    for command in [&["convert", ".", "x.csv"][..], &["info", "."]] {
        let said = refused(dir, command, 3);
        assert!(said.contains("is not the folder of a run"), "{said}");
    }
    fs::write(dir.join("no.npz"), "nothing").unwrap();
    refused(dir, &["convert", "no.npz", "x.csv"], 3);
}

#[test]
fn the_help_lists_all_formats() {
    let dir = tempfile::tempdir().unwrap();
    for command in ["check", "info"] {
        let help = done(dir.path(), &[command, "--help"]);
        assert!(help.contains("FOLD, glTF, VTK)"), "{help}");
    }
    let help = done(dir.path(), &["convert", "--help"]);
    let parts: Vec<&str> = help.split("Files that are written of a run:").collect();
    let (read, written) = parts[0].split_once("Mesh files that are written").unwrap();
    let has = |part: &str, extension: &str| {
        part.split_whitespace()
            .any(|w| w == format!(".{extension}"))
    };
    assert!(
        MeshFormat::ALL.iter().all(|f| has(read, f.extension())),
        "{read}"
    );
    assert!(
        ExportMeshFormat::ALL
            .iter()
            .all(|f| has(written, f.extension())),
        "{written}"
    );
    assert!(
        SeriesFormat::ALL
            .iter()
            .all(|f| has(parts[1], f.extension())),
        "{}",
        parts[1]
    );
}

/// The size of a PNG file, pixels.
fn size(png: &[u8]) -> [u32; 2] {
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()))
}

/// Numbered pictures, all by one camera, in the size and from the side that are asked for; what to do for a
/// film.
#[test]
fn films_are_numbered_pictures() {
    let dir = with_short_run(StartingPoint::Drape);
    let dir = dir.path();
    let recording = Recording::read(&dir.join("run")).unwrap();
    let times = recording.trajectory.times();
    let folder = |name: &str| {
        let entries = fs::read_dir(dir.join(name)).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().path()).collect();
        names.sort();
        names
            .into_iter()
            .map(|path| fs::read(path).unwrap())
            .collect::<Vec<_>>()
    };
    let said = done(
        dir,
        &[
            "convert", "run", "few.png", "--frames", "1..3", "--size", "96x64", "--view", "top",
        ],
    );
    assert_eq!(
        said,
        "few/frame_00000.png to few/frame_00002.png: 3 frames\n"
    );
    let few = folder("few");
    assert!(few.len() == 3 && few.iter().all(|png| size(png) == [96, 64]));
    assert!(few[0] != few[1], "the cloth falls");
    // The height alone, and another rate: the width is even, as encoders of films demand.
    let duration = times[times.len() - 1] - times[0];
    let count = (100.0 * duration + 1e-6).floor() as usize + 1;
    done(
        dir,
        &["convert", "run", "all.png", "--fps", "100", "--size", "60"],
    );
    let all = folder("all");
    assert_eq!(all.len(), count);
    assert!(
        all.iter()
            .all(|png| size(png) == size(&all[0]) && size(png)[0].is_multiple_of(2))
    );
    let said = done(
        dir,
        &[
            "convert", "run", "all.usda", "--fps", "100", "--frames", "1..",
        ],
    );
    assert!(said.starts_with("all.usda: "), "{said}");
    let usda = fs::read_to_string(dir.join("all.usda")).unwrap();
    for part in [
        "timeCodesPerSecond = 100",
        "def Mesh \"obstacle_0\"",
        "texCoord2f[] primvars:st",
    ] {
        assert!(usda.contains(part), "{part}");
    }
    refused(dir, &["convert", "run", "x.usda", "--fps", "0"], 2);
    refused(
        dir,
        &["convert", "run", "x.usda", "--fps", "10", "--every", "2"],
        2,
    );
}

/// The names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// The numbered files of an earlier export would be taken for frames of this one by whatever reads the
/// folder.
#[test]
fn numbered_files_of_an_earlier_export_are_removed() {
    let dir = with_short_run(StartingPoint::Drape);
    let dir = dir.path();
    let count = Recording::read(&dir.join("run")).unwrap().trajectory.len();
    assert!(count > 3, "{count} frames");
    let some =
        |output: &str, more: &[&str]| done(dir, &[&["convert", "run", output][..], more].concat());
    let pictures = ["--size", "48x32", "--every"];
    let said = some("film.png", &[&pictures[..], &["1"]].concat());
    assert!(!said.contains("removed"), "{said}");
    assert_eq!(names(&dir.join("film")).len(), count);
    for own in ["frame_1.png", "frame_00000.jpg", "frame_00001.obj"] {
        fs::write(dir.join("film").join(own), "mine").unwrap();
    }
    let few = count.div_ceil(3);
    let said = some("film.png", &[&pictures[..], &["3"]].concat());
    let removed = format!("({} files of an earlier export removed)", count - few);
    assert!(said.contains(&removed), "{said}");
    let left = names(&dir.join("film"));
    assert_eq!(left.len(), few + 3, "{left:?}");

    // Files of frames keep the numbers of the run; numbers of bodies go with the bodies.
    for extension in ["obj", "pvd"] {
        let output = format!("f.{extension}");
        let inner = if extension == "pvd" { "vtp" } else { "obj" };
        let of = |name: &str, numbers: &[usize]| -> Vec<String> {
            let numbers = numbers.iter();
            numbers.map(|k| format!("{name}_{k:05}.{inner}")).collect()
        };
        let found = || -> Vec<String> {
            let names = names(&dir.join("f")).into_iter();
            names.filter(|name| name.ends_with(inner)).collect()
        };
        some(&output, &[]);
        let all: Vec<usize> = (0..count).collect();
        assert_eq!(found(), [of("bodies", &[0]), of("frame", &all)].concat());
        let said = some(&output, &["--frames", "1..2"]);
        assert_eq!(found(), [of("bodies", &[1]), of("frame", &[1, 2])].concat());
        let removed = format!("({} files of an earlier", count - 2 + 1);
        assert!(said.contains(&removed), "{said}");
        let said = some(&output, &["--frames", "1..2", "--no-bodies"]);
        assert_eq!(found(), of("frame", &[1, 2]));
        let lists = usize::from(extension == "pvd");
        let removed = format!("{} of an earlier", ["1 file", "2 files"][lists]);
        assert!(said.contains(&removed), "{said}");
        assert!(!dir.join("f-bodies.pvd").exists());
    }

    // What is refused removes nothing.
    refused(
        dir,
        &["convert", "run", "film.png", "--frames", "90000.."],
        2,
    );
    assert_eq!(names(&dir.join("film")), left);
    fs::create_dir(dir.join("run/obj")).unwrap();
    let said = refused(dir, &["convert", "run", "run/obj.obj", "--every", "2"], 2);
    assert!(said.contains("files of the run itself"), "{said}");
}

/// A program in place of ffmpeg keeps what it is told and what it is given.
#[cfg(unix)]
#[test]
fn films_are_encoded_by_ffmpeg_where_it_is() {
    use std::os::unix::fs::PermissionsExt;
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    done(
        dir,
        &[
            "simulate",
            "scene.toml",
            "--out",
            "run",
            "--set",
            "stop.time=0.1",
        ],
    );
    let convert = |path: &str, film: &str| {
        let mut command = isosheet(dir);
        command.env("PATH", path);
        let output = command
            .args(["convert", "run", film, "--fps", "20", "--size", "41x30"])
            .output();
        output.expect("the command starts")
    };
    let none = convert("", "films/a.mp4");
    assert_eq!(code(&none), Some(6), "{}", stderr(&none));
    let said = stderr(&none);
    assert!(
        said.contains("encoded by ffmpeg") && said.contains(".apng"),
        "{said}"
    );
    assert_eq!(fs::read_dir(dir.join("films")).unwrap().count(), 0);

    let bin = dir.join("bin");
    fs::create_dir(&bin).unwrap();
    let program = |script: &str| {
        let path = bin.join("ffmpeg");
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    };
    let path = format!("{}:/usr/bin:/bin", bin.display());
    program("echo \"$@\" > arguments; for film; do :; done; cat > \"$film\"");
    let film = convert(&path, "films/a.mp4");
    assert_eq!(code(&film), Some(0), "{}", stderr(&film));
    // A tenth of a second has the frames at 0, 0.05 and 0.1 s.
    let bytes = fs::read(dir.join("films/a.mp4")).unwrap();
    assert_eq!(bytes.len(), 3 * 41 * 30 * 3);
    let arguments = fs::read_to_string(dir.join("arguments")).unwrap();
    for part in [
        "-video_size 41x30",
        "-framerate 20.000000",
        "rgb24",
        "yuv420p",
    ] {
        assert!(arguments.contains(part), "{part}: {arguments}");
    }
    program("echo 'no such codec' >&2; exit 1");
    let failed = convert(&path, "films/b.webm");
    assert_eq!(code(&failed), Some(6));
    assert!(
        stderr(&failed).contains("no such codec"),
        "{}",
        stderr(&failed)
    );
    assert_eq!(fs::read_dir(dir.join("films")).unwrap().count(), 1);
}

/// The frame that is asked for, animations of all frames, and what cannot be drawn.
#[test]
fn frames_of_runs_become_pictures() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let short = [
        "simulate",
        "scene.toml",
        "--out",
        "run",
        "--set",
        "stop.time=0.1",
    ];
    done(dir, &short);
    let count = Recording::read(&dir.join("run")).unwrap().trajectory.len();
    assert_eq!(
        done(dir, &["convert", "run", "last.png"]),
        "last.png: 1 frame\n"
    );
    let last = (count - 1).to_string();
    done(dir, &["convert", "run", "same.png", "--frame", &last]);
    done(dir, &["convert", "run", "first.PNG", "--frame", "0"]);
    let said = done(dir, &["convert", "run", "all.apng"]);
    assert_eq!(said, format!("all.apng: {count} frames\n"));
    let said = done(dir, &["convert", "run", "some.apng", "--every", "2"]);
    assert_eq!(said, format!("some.apng: {} frames\n", count.div_ceil(2)));
    let [last, same, first, all] =
        ["last.png", "same.png", "first.PNG", "all.apng"].map(|f| fs::read(dir.join(f)).unwrap());
    assert!(last == same && last != first);
    assert!(all.starts_with(b"\x89PNG"));
    // The chunk that says how many frames there are, and how often they are shown.
    let control = all.windows(4).position(|w| w == b"acTL").unwrap() + 4;
    let number = |at: usize| u32::from_be_bytes(all[at..at + 4].try_into().unwrap());
    assert_eq!((number(control) as usize, number(control + 4)), (count, 0));
    let none = count.to_string();
    let said = refused(dir, &["convert", "run", "x.png", "--frame", &none], 2);
    assert!(said.contains(&format!("{count} frames")), "{said}");
    refused(dir, &["convert", "run", "x.apng", "--frame", "0"], 2);
    let said = refused(dir, &["convert", "run", "x.apng", "--fps", "120"], 2);
    assert!(said.contains("120 pictures a second"), "{said}");
    let low = [
        "convert", "run", "x.png", "--size", "60", "--colour", "strain",
    ];
    let said = refused(dir, &low, 2);
    assert!(said.contains("a scale of colours takes"), "{said}");
    refused(dir, &["convert", "run", "x.png", "--time", "9"], 2);
    let beyond = format!("1..{none}");
    refused(dir, &["convert", "run", "x.png", "--frames", &beyond], 2);
    refused(dir, &["convert", "run", "x.png", "--frames", "2..1"], 2);
    refused(dir, &["convert", "run", "x.png", "--size", "0"], 2);
    refused(dir, &["convert", "run", "x.png", "--view", "0,91"], 2);
    refused(dir, &["convert", "run", "x.usda", "--size", "100"], 2);
    refused(dir, &["convert", "run", "run.png", "--every", "2"], 2);
    refused(dir, &["convert", "run/trajectory.npz", "x.png"], 2);
    refused(dir, &["convert", "run", "x.png", "--weld", "0.1"], 2);
    assert!(!dir.join("x.png").exists() && !dir.join("x.apng").exists());
}

/// One frame by its time, pictures without marks, and meshes for printers.
#[test]
fn a_frame_is_found_by_its_time_and_a_mesh_is_made_thicker_and_larger() {
    let dir = with_short_run(StartingPoint::Drape);
    let dir = dir.path();
    let recording = Recording::read(&dir.join("run")).unwrap();
    let times = recording.trajectory.times();
    let between = (0.4 * times[1] + 0.6 * times[2]).to_string();
    // A frame lasts 1/30 s: beyond the ends by more there is none.
    for (time, written) in [
        ("-5", false),
        ("1e9", false),
        ("-0.01", true),
        ("0.21", true),
    ] {
        let option = format!("--time={time}");
        let command = ["convert", "run", "end.obj", &option];
        match written {
            true => drop(done(dir, &command)),
            false => {
                let said = refused(dir, &command, 2);
                assert!(
                    said.contains("the run has frames from 0 to 0.2 s"),
                    "{said}"
                );
            }
        }
    }
    for format in ["png", "obj"] {
        let [by_time, by_number] = ["time", "frame"].map(|name| format!("{name}.{format}"));
        done(
            dir,
            &[
                "convert",
                "run",
                &by_time,
                "--time",
                &between,
                "--no-bodies",
            ],
        );
        done(
            dir,
            &["convert", "run", &by_number, "--frame", "2", "--no-bodies"],
        );
        let [by_time, by_number] = [by_time, by_number].map(|f| fs::read(dir.join(f)).unwrap());
        assert!(by_time == by_number, "{format}");
    }
    done(
        dir,
        &[
            "convert",
            "run",
            "plain.png",
            "--frame",
            "2",
            "--no-bodies",
            "--plain",
        ],
    );
    let [plain, marked] = ["plain.png", "frame.png"].map(|f| fs::read(dir.join(f)).unwrap());
    assert!(plain != marked && size(&plain) == size(&marked));

    let said = refused(dir, &["convert", "run", "x.stl"], 2);
    assert!(
        said.contains("a .stl file has one mesh")
            && said.contains("`--frame K`, `--time T` or `--part P`"),
        "{said}"
    );
    let thick = ["--thickness", "2mm", "--scale", "1000"];
    done(
        dir,
        &[&["convert", "run", "body.ply", "--frame", "0"][..], &thick].concat(),
    );
    let [flat, body] = ["flat.ply", "body.ply"].map(|name| {
        done(dir, &["convert", "run", "flat.ply", "--frame", "0"]);
        read_mesh(&dir.join(name)).unwrap()
    });
    assert_eq!(body.vertex_count(), 2 * flat.vertex_count());
    let place = |mesh: &MeshFile, v: usize| [0, 1, 2].map(|k| mesh.positions[3 * v + k]);
    for v in 0..flat.vertex_count() {
        // The sheet begins flat.
        let [x, y, z] = place(&flat, v).map(|c| 1e3 * c);
        for (v, by) in [(v, 1.0), (v + flat.vertex_count(), -1.0)] {
            let found = place(&body, v);
            let away = [x - found[0], y - found[1], z + by - found[2]];
            assert!(away.iter().all(|d| d.abs() < 1e-9), "{found:?}");
        }
    }
    let sheet = body.into_sheet().unwrap();
    assert_eq!(sheet.topology().boundary_edge_count(), 0);
    for wrong in [
        &["convert", "run", "x.usda", "--scale", "2", "--frame", "0"][..],
        &["convert", "run", "x.obj", "--scale", "2"],
        &["convert", "run", "x.stl", "--scale", "-2", "--frame", "0"],
        &[
            "convert",
            "run",
            "x.stl",
            "--thickness",
            "0",
            "--frame",
            "0",
        ],
        &["convert", "run", "x.stl", "--time", "nan"],
        &["convert", "flat.ply", "x.stl", "--time", "1"],
        &["convert", "flat.ply", "x.stl", "--plain"],
    ] {
        refused(dir, wrong, 2);
    }
    assert!(!dir.join("x.stl").exists() && !dir.join("x.obj").exists());
}

/// Every kind of scene to start from, after a few steps, in every format: with refined meshes and crease
/// patterns, several sheets, glue, bodies and bends that stay.
#[test]
fn every_kind_of_run_is_converted_to_every_format() {
    let series = SeriesFormat::ALL.map(SeriesFormat::extension);
    let meshes = ExportMeshFormat::ALL.map(ExportMeshFormat::extension);
    for kind in StartingPoint::ALL {
        let dir = with_scene(kind);
        let dir = dir.path();
        let scene = SceneFile::read(&dir.join("scene.toml"), &[]).unwrap();
        let step = scene.scene().method.step;
        let edits = [
            format!("stop.time={}", 2.0 * step),
            format!("output.frames_per_second={}", 1.0 / step),
        ];
        done(
            dir,
            &[
                "simulate",
                "scene.toml",
                "--set",
                &edits[0],
                "--set",
                &edits[1],
            ],
        );
        for extension in series.into_iter().chain(["apng"]) {
            let out = format!("series.{extension}");
            let said = done(dir, &["convert", "scene-run", &out, "--frames", "0..2"]);
            assert!(said.starts_with("series"), "{kind:?} {said}");
            assert!(
                dir.join(out).exists() || dir.join("series").exists(),
                "{kind:?} {said}"
            );
        }
        for extension in meshes.into_iter().chain(["png"]) {
            let out = format!("frame.{extension}");
            done(dir, &["convert", "scene-run", &out, "--frame", "2"]);
            assert!(dir.join(out).is_file(), "{kind:?} {extension}");
        }
        let frames = read_mesh(&dir.join("frame.fold")).unwrap();
        let trajectory = Trajectory::read(&dir.join("scene-run/trajectory.npz")).unwrap();
        assert_eq!(frames.positions, trajectory.frame(2).unwrap(), "{kind:?}");
        assert_eq!(frames.faces, trajectory.faces());
    }
}

/// The pattern of a refined sheet is that of its mesh: the pleats of the hyperbolic paraboloid have as many
/// parts as `refine` makes of an edge, and are mountains and valleys in turn.
#[test]
fn refined_patterns_are_exported() {
    let dir = with_scene(StartingPoint::Hypar);
    let dir = dir.path();
    let count = |out: &str, refine: &str| {
        let [stop, more] = ["stop.time=1e-3", refine].map(|edit| ["--set", edit]);
        let simulate = [&["simulate", "scene.toml", "-o", out], &stop[..], &more].concat();
        done(dir, &simulate);
        done(dir, &["convert", out, "x.fold", "--frame", "0"]);
        let creases = read_mesh(&dir.join("x.fold")).unwrap().creases;
        [EdgeAssignment::Mountain, EdgeAssignment::Valley]
            .map(|a| creases.iter().filter(|c| c.assignment == a).count())
    };
    let whole = count("whole", "sheet.refine=0");
    assert!(whole.iter().all(|n| *n > 0));
    assert_eq!(count("halves", "sheet.refine=1"), whole.map(|n| 2 * n));
}

/// The colours of the pixels of a PNG file.
fn pixels(png: &[u8]) -> Vec<[u8; 3]> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels.as_chunks::<3>().0.to_vec()
}

/// The share of the pixels of a PNG file that have the warm tint of the upper side of a sheet.
fn share_of_paper(png: &[u8]) -> f64 {
    let pixels = pixels(png);
    let is_paper = |p: &&[u8; 3]| i16::from(p[0]) > i16::from(p[2]) + 15;
    pixels.iter().filter(is_paper).count() as f64 / pixels.len() as f64
}

/// The sheet is coloured by a quantity, on the scale of colours that is below it; a range that is given fixes
/// both.
#[test]
fn pictures_show_a_quantity_with_its_scale() {
    let dir = with_short_run(StartingPoint::Drape);
    let dir = dir.path();
    let picture = |options: &[&str]| {
        let convert = ["convert", "run", "x.png", "--size", "300x280", "--plain"];
        done(dir, &[&convert, options].concat());
        let png = fs::read(dir.join("x.png")).unwrap();
        assert_eq!(size(&png), [300, 280]);
        pixels(&png)
    };
    let has = |pixels: &[[u8; 3]], colour: [u8; 3]| {
        let off = |p: &[u8; 3]| (0..3).map(|k| p[k].abs_diff(colour[k])).max();
        pixels.iter().filter(|p| off(p) <= Some(2)).count()
    };
    // The ends of viridis, and letters of ten pixels below which the bar has eight rows.
    let [low, high] = [[0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]];
    let plain = picture(&[]);
    let gap = picture(&["--colour", "Gap"]);
    for end in [low, high] {
        assert_eq!(has(&plain, end), 0);
        assert!(has(&gap, end) >= 8, "{end:?}");
    }
    // Far above all gaps the sheet has the colour of the low end, and the bar both.
    let far = picture(&["--color", "gap", "--range", "1..2"]);
    let small = has(&far, high);
    assert!((8..100).contains(&small), "{small}");
    assert!(has(&gap, high) > 100 + small);
    let said = refused(dir, &["convert", "run", "y.png", "--colour", "warmth"], 2);
    assert!(
        said.contains("no quantity `warmth`; it has `fold angle"),
        "{said}"
    );
    for wrong in [
        &["y.png", "--colour", "gap", "--range", "2..1"][..],
        &["y.png", "--colour", "gap", "--range", "0..0"],
        &["y.png", "--colour", "height", "--range", "1e-320..3e-320"],
        &["y.png", "--colour", "gap", "--range=-inf..1"],
        &["y.png", "--colour", "gap", "--range", "0..nan"],
        &["y.png", "--colour", "gap", "--range", "1"],
        &["y.png", "--range", "0..1"],
        &["y.png", "--colour", "gap", "--size", "30"],
        &["y.usda", "--colour", "gap"],
    ] {
        refused(dir, &[&["convert", "run"], wrong].concat(), 2);
    }
    assert!(!dir.join("y.png").exists() && !dir.join("y.usda").exists());
}

/// Pages have a ground below the lowest point of bodies and sheet where something falls, and none where
/// nothing does or where there is a floor.
#[test]
fn runs_have_a_ground_where_something_falls() {
    let ground = |kind, edits: &[&str]| {
        let dir = with_scene(kind);
        let edits = edits.iter().flat_map(|edit| ["--set", edit]);
        let arguments = [
            "simulate",
            "scene.toml",
            "--out",
            "run",
            "--set",
            "stop.time=0.02",
        ];
        done(
            dir.path(),
            &arguments.into_iter().chain(edits).collect::<Vec<_>>(),
        );
        let recording = Recording::read(&dir.path().join("run")).unwrap();
        let x = (0..recording.trajectory.len()).filter_map(|k| recording.trajectory.frame(k));
        let heights = x.flat_map(|x| x.as_chunks::<3>().0).map(|p| p[2]);
        let lowest = heights.fold(f64::INFINITY, f64::min);
        (recording.replay().unwrap().ground, lowest)
    };
    // The sheet is on a table, whose foot is lower.
    let (on_table, sheet) = ground(StartingPoint::Drape, &[]);
    let (hanging, lowest) = ground(StartingPoint::Hanging, &[]);
    assert!(on_table.unwrap() < sheet - 0.01, "{on_table:?} {sheet}");
    assert!(hanging.unwrap() < lowest, "{hanging:?} {lowest}");
    assert_eq!(ground(StartingPoint::Fold, &[]).0, None);
    let aslant = ["forces.gravity=[1, 0, -9.81]"];
    assert_eq!(ground(StartingPoint::Hanging, &aslant).0, None);
}

/// Where a plate stands between the usual viewer and the sheet, the picture is taken from elsewhere. Bodies
/// can be left out.
#[test]
fn pictures_show_the_sheet_and_not_a_plate_before_it() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = "version = 1
        [sheet]
        mesh = { square = { side = 0.2, level = 1 } }
        placement = { position = [-0.1, -0.1, 0] }
        [[obstacle]]
        shape = { box = { size = [3, 0.01, 3] } }
        pose = { position = [0, -0.3, 0] }
        [stop]
        time = 0.02";
    fs::write(dir.join("plate.toml"), scene).unwrap();
    done(dir, &["simulate", "plate.toml"]);
    let share = |options: &[&str]| {
        done(dir, &[&["convert", "plate-run", "x.png"], options].concat());
        share_of_paper(&fs::read(dir.join("x.png")).unwrap())
    };
    assert!(share(&[]) > 0.2);
    assert_eq!(share(&["--view", "-60,25"]), 0.0);
    assert!(share(&["--view", "-60,25", "--no-bodies"]) > 0.2);
    for (option, has) in [(None, true), (Some("--no-bodies"), false)] {
        let convert = ["convert", "plate-run", "x.usda"].into_iter().chain(option);
        done(dir, &convert.collect::<Vec<_>>());
        let text = fs::read_to_string(dir.join("x.usda")).unwrap();
        assert_eq!(text.contains("obstacle_0"), has, "{option:?}");
    }
    fs::write(dir.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let said = refused(dir, &["convert", "a.obj", "b.obj", "--no-bodies"], 2);
    assert!(said.contains("--no-bodies"), "{said}");
}

/// A file that does not fit on the disk (here: into the size that the system allows) is one error of this
/// program, and no text of a library beside it; nothing is left.
#[cfg(unix)]
#[test]
fn files_that_do_not_fit_are_one_error() {
    let dir = with_scene(StartingPoint::Stamp);
    let dir = dir.path();
    done(dir, &["simulate", "scene.toml", "--set", "stop.time=0.04"]);
    // The shell counts in blocks of half a kilobyte or a whole one.
    let script = "trap '' XFSZ; ulimit -f 4; exec \"$0\" convert scene-run \"$1\" -q";
    let series = SeriesFormat::ALL.map(SeriesFormat::extension);
    for extension in series.into_iter().chain(["png", "apng"]) {
        let out = format!("x.{extension}");
        let ended = std::process::Command::new("sh")
            .current_dir(dir)
            .args(["-c", script, env!("CARGO_BIN_EXE_isosheet"), &out])
            .output()
            .unwrap();
        let said = stderr(&ended);
        assert_eq!(code(&ended), Some(6), "{extension}: {said}");
        let (first, rest) = said.split_once('\n').unwrap();
        assert!(first.starts_with("error: cannot write x"), "{said}");
        assert_eq!(rest, "  = help: check the free space\n", "{extension}");
        assert!(!dir.join(out).is_file());
    }
}

/// The frame in which a pattern is folded by a part is written alone.
#[test]
fn a_frame_of_a_fold_is_chosen_by_its_part() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let square = "1 0 0 1 0\n1 1 0 1 1\n1 1 1 0 1\n1 0 1 0 0\n3 0 0 1 1\n";
    fs::write(dir.join("square.cp"), square).unwrap();
    let folded = run(dir, &["fold", "square.cp", "--out", "out"]);
    assert_eq!(code(&folded), Some(0), "{}", stderr(&folded));
    let angle_of = |option: &str, value: &str| {
        let done = run(dir, &["convert", "out", "half.fold", option, value]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let mesh = read_mesh(&dir.join("half.fold")).unwrap();
        let angles = mesh.creases.iter().filter_map(|crease| crease.angle);
        angles.fold(0.0, f64::max).to_degrees()
    };
    let angle = |part: &str| angle_of("--part", part);
    // A frame is 2 % of the folding at most, and the crease lags its spring by some degrees.
    assert!((angle("0.5") - 90.0).abs() < 8.0, "{}", angle("0.5"));
    assert!((angle("1") - 180.0).abs() < 0.1, "{}", angle("1"));
    assert_eq!(angle("0"), angle_of("--frame", "0"));
    let refused = |words: &[&str], expected: &str| {
        let output = run(dir, &[&["convert"], words].concat());
        assert_eq!(code(&output), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    };
    refused(
        &["out", "x.fold", "--part", "2"],
        "the part of the folding is 2",
    );
    refused(
        &["half.fold", "x.obj", "--part", "0.5"],
        "--part chooses a frame of a run",
    );
    refused(&["out", "x.fbx"], "write .glb or .usda");
    refused(&["out", "x.abc"], "write .usda");
    refused(&["half.fold", "x.abc"], "write .usda");
    for (name, expected) in [
        ("a.fbx", "export the mesh as .glb"),
        ("a.abc", "one of these for each frame"),
    ] {
        fs::write(dir.join(name), "no mesh").unwrap();
        let output = run(dir, &["convert", name, "x.obj"]);
        assert_eq!(code(&output), Some(3), "{}", stderr(&output));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    let other = with_short_run(StartingPoint::Drape);
    let other = other.path().join("run");
    let words = [other.to_str().unwrap(), "x.obj", "--part", "0.5"];
    refused(&words, "this one folds none");
}
