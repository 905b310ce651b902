//! Files and folders that strangers made: nothing outside of them is read, changed or deleted, and nothing is
//! waited for.

use crate::{code, run, stderr, stdout, with_scene};
use isosheet_scenes::StartingPoint;
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

/// A triangle whose buffer is the file of a name.
fn gltf(uri: &str, length: usize) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {length}, "uri": "{uri}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
        "min": [0, 0, 0], "max": [1, 1, 0]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]}}"#
    )
}

/// The corners of a triangle.
fn corners() -> Vec<u8> {
    let corners = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    corners.iter().flat_map(|c| c.to_le_bytes()).collect()
}

fn fifo(path: &Path) {
    mknodat(CWD, path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
}

#[test]
fn a_gltf_file_reads_buffers_of_its_own_folder_alone() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("mesh");
    fs::create_dir_all(folder.join("data")).unwrap();
    fs::write(dir.path().join("secret.bin"), corners()).unwrap();
    fs::write(
        folder.join("data/own.bin"),
        [corners(), vec![1; 9]].concat(),
    )
    .unwrap();
    symlink("../secret.bin", folder.join("link.bin")).unwrap();
    symlink("/dev/zero", folder.join("zero.bin")).unwrap();
    fifo(&folder.join("fifo.bin"));
    let secret = dir.path().join("secret.bin");
    let secret = secret.to_str().unwrap();
    for (uri, length, problem) in [
        ("../secret.bin", 36, "it leads out of its folder"),
        ("data/../../secret.bin", 36, "it leads out of its folder"),
        (secret, 36, "it leads out of its folder"),
        ("link.bin", 36, "it leads out of its folder"),
        ("/dev/zero", 36, "it leads out of its folder"),
        ("zero.bin", 36, "it leads out of its folder"),
        ("fifo.bin", 36, "it is a pipe or a device"),
        ("data", 36, "it is a folder"),
        ("data/own.bin", 1 << 30, "it has 45 bytes, and 1073741824"),
        (
            "data:application/octet-stream;base64,AAAA",
            36,
            "it has 3 bytes, and 36",
        ),
    ] {
        fs::write(folder.join("mesh.gltf"), gltf(uri, length)).unwrap();
        for arguments in [
            &["convert", "mesh.gltf", "out.obj"][..],
            &["check", "mesh.gltf"],
        ] {
            let refused = run(&folder, arguments);
            assert_eq!(code(&refused), Some(3), "{uri}: {}", stderr(&refused));
            assert!(stderr(&refused).contains(problem), "{}", stderr(&refused));
        }
        assert!(!folder.join("out.obj").exists());
    }
    fs::write(folder.join("mesh.gltf"), gltf("data/own.bin", 36)).unwrap();
    let done = run(&folder, &["convert", "mesh.gltf", "out.obj"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
}

#[test]
fn nothing_is_written_or_deleted_through_links_in_the_folder_of_a_run() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let simulate = ["simulate", "scene.toml", "--out", "run"];
    let done = run(dir, &simulate);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    // As a run that was killed before its summary.
    fs::remove_file(dir.join("run/summary.json")).unwrap();
    fs::create_dir(dir.join("mine")).unwrap();
    for name in ["run.lock", "history.csv", "frames.bin", "obj", "meshes"] {
        let entry = dir.join("run").join(name);
        let (kept, mine) = (dir.join("kept"), dir.join("mine/letter"));
        let unfinished = dir.join("mine/.frame_00000.obj.part");
        fs::write(&mine, "dear").unwrap();
        fs::write(&unfinished, "mine too").unwrap();
        if entry.exists() {
            fs::rename(&entry, &kept).unwrap();
        }
        let target = if ["obj", "meshes"].contains(&name) {
            dir.join("mine")
        } else {
            mine.clone()
        };
        symlink(&target, &entry).unwrap();
        for arguments in [
            &["resume", "run"][..],
            &simulate,
            &[&simulate[..], &["--force"]].concat(),
        ] {
            let refused = run(dir, arguments);
            assert_eq!(code(&refused), Some(4), "{name}: {}", stderr(&refused));
            let said = stderr(&refused);
            assert!(said.contains(&format!("run/{name} is a link")), "{said}");
            assert_eq!(fs::read_to_string(&mine).unwrap(), "dear", "{name}");
            assert!(unfinished.exists(), "{name}");
        }
        fs::remove_file(&entry).unwrap();
        if kept.exists() {
            fs::rename(&kept, &entry).unwrap();
        }
    }
    let resumed = run(dir, &["resume", "run"]);
    assert_eq!(code(&resumed), Some(0), "{}", stderr(&resumed));
}

#[test]
fn a_run_is_replaced_and_the_files_beside_it_stay() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(
        dir.join("square.off"),
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
    )
    .unwrap();
    let scene = "version = 1\nsheet.mesh.file.path = \"square.off\"\nsheet.density = 0.1\n\
                 method.step = 0.1\nstop.time = 0.2\noutput.obj = true\n";
    fs::write(dir.join("scene.toml"), scene).unwrap();
    let simulate = ["simulate", "scene.toml", "--out", "run", "--force"];
    let done = run(dir, &simulate);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let own = [
        "obj/mine.obj",
        "obj/frame_1.obj",
        "meshes/mine.off",
        "notes.txt",
    ];
    for name in own {
        fs::write(dir.join("run").join(name), "mine").unwrap();
    }
    assert!(dir.join("run/obj/frame_00002.obj").is_file());
    assert!(dir.join("run/meshes/0-square.off").is_file());
    let set = [
        "--set",
        "output.obj=false",
        "--set",
        "sheet.mesh={square={side=1,level=1}}",
    ];
    let again = run(dir, &[&simulate[..], &set].concat());
    assert_eq!(code(&again), Some(0), "{}", stderr(&again));
    for name in own {
        assert_eq!(
            fs::read_to_string(dir.join("run").join(name)).unwrap(),
            "mine"
        );
    }
    assert!(!dir.join("run/obj/frame_00002.obj").exists());
    assert!(!dir.join("run/meshes/0-square.off").exists());
}

#[test]
fn a_stored_scene_reads_meshes_of_its_own_folder_alone() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let done = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    fs::write(
        dir.join("secret.off"),
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    )
    .unwrap();
    let scene = "version = 1\nsheet.mesh.file.path = \"../secret.off\"\nsheet.density = 1\n\
                 method.step = 0.1\nstop.time = 1\n";
    fs::write(dir.join("run/scene.toml"), scene).unwrap();
    for subcommand in ["resume", "info", "page"] {
        let refused = run(dir, &[subcommand, "run"]);
        assert_eq!(code(&refused), Some(3), "{subcommand}");
        let said = stderr(&refused);
        assert!(said.contains("../secret.off: it leads out"), "{said}");
    }
}

#[test]
fn a_gallery_deletes_nothing_outside_of_its_folder() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let done = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let gallery = ["gallery", "run", "-o", "shown"];
    let made = run(dir, &gallery);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    let entries = fs::read_to_string(dir.join("shown/gallery.json")).unwrap();
    fs::write(dir.join("letter.html"), "dear").unwrap();
    let changed = entries.replacen("\"run\"", "\"../../letter\"", 1);
    assert_ne!(changed, entries);
    fs::write(dir.join("shown/gallery.json"), changed).unwrap();
    let refused = run(dir, &gallery);
    assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
    assert!(
        stderr(&refused).contains("../../letter"),
        "{}",
        stderr(&refused)
    );
    assert!(dir.join("letter.html").exists());
    fs::write(
        dir.join("shown/gallery.json"),
        entries.replacen("\"run\"", "\"letter\"", 1),
    )
    .unwrap();
    fs::remove_dir_all(dir.join("shown/runs")).unwrap();
    symlink(dir, dir.join("shown/runs")).unwrap();
    let refused = run(dir, &gallery);
    assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
    assert!(dir.join("letter.html").exists());
    assert!(!dir.join("run.html").exists());
}

#[test]
fn a_scene_that_cannot_start_leaves_no_folder() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let simulate = ["simulate", "scene.toml", "--out", "run"];
    // The table is in the way of the cloth.
    let penetrating = ["--set", "sheet.at.position=[0, 0, 0]"];
    let refused = run(dir, &[&simulate[..], &penetrating].concat());
    assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
    assert!(!dir.join("run").exists(), "{}", stderr(&refused));
    let done = run(dir, &simulate);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    // A run that is there stays when what was to replace it cannot start.
    let before = fs::read(dir.join("run/summary.json")).unwrap();
    let refused = run(dir, &[&simulate[..], &penetrating, &["--force"]].concat());
    assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
    assert_eq!(fs::read(dir.join("run/summary.json")).unwrap(), before);
}

#[test]
fn a_complete_folder_may_have_lost_its_empty_lock() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let simulate = ["simulate", "scene.toml", "--out", "run"];
    assert_eq!(code(&run(dir, &simulate)), Some(0));
    fs::remove_file(dir.join("run/run.lock")).unwrap();
    let again = run(dir, &simulate);
    assert_eq!(code(&again), Some(0), "{}", stderr(&again));
    let other = [&simulate[..], &["--set", "stop.time=0.1"]].concat();
    assert_eq!(code(&run(dir, &other)), Some(4));
    let replaced = run(dir, &[&other[..], &["--force"]].concat());
    assert_eq!(code(&replaced), Some(0), "{}", stderr(&replaced));
}

#[test]
fn pipes_are_refused_and_not_waited_for() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let done = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    for name in ["pipe.toml", "pipe.obj", "pipe.stl"] {
        fifo(&dir.join(name));
        for subcommand in ["check", "info"] {
            let refused = run(dir, &[subcommand, name]);
            assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
            assert!(
                stderr(&refused).contains("it is a pipe or a device"),
                "{}",
                stderr(&refused)
            );
        }
    }
    for name in ["checkpoint.bin", "history.csv", "frames.bin", "scene.toml"] {
        let (file, kept) = (dir.join("run").join(name), dir.join("kept"));
        fs::rename(&file, &kept).unwrap();
        fifo(&file);
        let _ = fs::remove_file(dir.join("run/summary.json"));
        let refused = run(dir, &["resume", "run"]);
        assert!(
            [Some(3), Some(4)].contains(&code(&refused)),
            "{name}: {}",
            stderr(&refused)
        );
        let refused = run(dir, &["page", "run", "-o", "page.html"]);
        let refused_or_not_needed = code(&refused) == Some(3) || name == "checkpoint.bin";
        assert!(refused_or_not_needed, "{name}: {}", stderr(&refused));
        fs::remove_file(&file).unwrap();
        fs::rename(&kept, &file).unwrap();
    }
    fs::create_dir(dir.join("sweep")).unwrap();
    fifo(&dir.join("sweep/runs.csv"));
    assert_eq!(code(&run(dir, &["collect", "sweep"])), Some(3));
}

/// An archive of which one array announces more than it has, or more than memory can hold.
#[test]
fn arrays_that_memory_cannot_hold_are_refused_before_they_are_read() {
    use std::io::Write;
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let header = |shape: &str| {
        let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        let text = format!("{text:<117}\n");
        let mut header = b"\x93NUMPY\x01\x00".to_vec();
        header.extend((text.len() as u16).to_le_bytes());
        header.extend(text.as_bytes());
        header
    };
    for (shape, problem) in [
        ("(1099511627776,)", "needs 8796093022208 bytes"),
        ("(18446744073709551615,)", "bytes"),
    ] {
        let file = fs::File::create(dir.join("bomb.npz")).unwrap();
        let mut zip = zip::ZipWriter::new(file);
        zip.start_file("t.npy", zip::write::SimpleFileOptions::default())
            .unwrap();
        zip.write_all(&header(shape)).unwrap();
        zip.finish().unwrap();
        let refused = run(dir, &["convert", "bomb.npz", "out.usda"]);
        assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
        assert!(stderr(&refused).contains(problem), "{}", stderr(&refused));
    }
    // Half a gigabyte of zeros is half a megabyte of archive, which may take 32 MiB and fifty times its
    // length.
    let file = fs::File::create(dir.join("bomb.npz")).unwrap();
    let mut zip = zip::ZipWriter::new(file);
    zip.start_file("t.npy", zip::write::SimpleFileOptions::default())
        .unwrap();
    let count = 1 << 26;
    zip.write_all(&header(&format!("({count},)"))).unwrap();
    let block = vec![0; 1 << 20];
    for _ in 0..8 * (count >> 20) {
        zip.write_all(&block).unwrap();
    }
    zip.finish().unwrap();
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", "ulimit -v 600000; exec \"$@\"", "sh"]);
    shell.arg(env!("CARGO_BIN_EXE_isosheet"));
    shell.args(["convert", "bomb.npz", "out.usda"]);
    let refused = shell.current_dir(dir).output().unwrap();
    assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
    assert!(
        stderr(&refused).contains("that an archive of this length may take"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn thousands_of_corners_and_of_unknown_keys_are_answered_shortly() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let count = 100_000;
    let mut polygon = String::new();
    for k in 0..count {
        let (y, x) = (f64::from(k) / f64::from(count) * std::f64::consts::TAU).sin_cos();
        polygon += &format!("v {x} {y} 0\n");
    }
    let corners: Vec<String> = (1..=count).map(|k| k.to_string()).collect();
    polygon += &format!("f {}\n", corners.join(" "));
    fs::write(dir.join("polygon.obj"), polygon).unwrap();
    let refused = run(dir, &["convert", "polygon.obj", "out.off"]);
    assert_eq!(code(&refused), Some(3), "{}", stderr(&refused));
    let said = stderr(&refused);
    assert!(
        said.contains("100000 corners, more than the 1000 of a polygon"),
        "{said}"
    );
    let mut scene = "version = 1\n".to_owned();
    for k in 0..200_000 {
        scene += &format!("unknown{k} = 1\n");
    }
    fs::write(dir.join("keys.toml"), scene).unwrap();
    let refused = run(dir, &["check", "keys.toml"]);
    assert_eq!(code(&refused), Some(3));
    let said = stderr(&refused);
    assert!(said.contains("`unknown0`"), "{said}");
    assert!(said.contains("199950 further problems"), "{said}");
}

#[test]
fn names_control_no_terminal() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = "version = 1\n[[sheet]]\nname = \"\\u001b]0;x\\u0007\\u009b2J\"\n\
                 mesh = { square = { side = 0.1, level = 0 } }\n[[sheet]]\nname = \"z\"\n\
                 mesh = { square = { side = 0.1, level = 0 } }\nplacement = { position = [0, 0, 1] }\n";
    fs::write(dir.join("s.toml"), scene).unwrap();
    let is_plain = |text: &str| text.chars().all(|c| !c.is_control() || "\n\t".contains(c));
    let set = [
        "--set",
        "measure=[{name=\"m\",sheet=\"\\u001b[1m\",at=\"all\",quantity=\"x\"}]",
    ];
    for arguments in [
        &["check", "s.toml"][..],
        &["simulate", "s.toml"],
        &["simulate", "s.toml", "--json", "-o", "json"],
        &["info", "s-run"],
        &[&["check", "s.toml"], &set[..]].concat(),
        &["check", "\u{1b}[1m.obj"],
    ] {
        let output = run(dir, arguments);
        let said = format!("{}{}", stdout(&output), stderr(&output));
        assert!(is_plain(&said), "{said:?}");
        let shows_name = said.contains("\\u001b") && !said.is_empty();
        assert!(shows_name || arguments[0] == "simulate", "{said}");
    }
}

#[test]
fn a_table_of_runs_has_no_formulas() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let done = run(dir, &["simulate", "scene.toml", "--out", "=cmd|x"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let table = run(dir, &["collect", "=cmd|x"]);
    assert!(stdout(&table).contains("\n'=cmd|x,"), "{}", stdout(&table));
}
