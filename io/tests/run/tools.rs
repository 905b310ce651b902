//! The subcommands around runs.

use crate::{code, run, stderr, with_scene};
use isosheet_files::read_json;
use isosheet_formats::read_sheet;
use isosheet_runs::Summary;
use isosheet_scenes::StartingPoint;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The first run of a newcomer ends with a result that can be used.
#[test]
fn starting_points_run_without_a_warning() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for kind in StartingPoint::ALL {
        let name = kind.name();
        assert_eq!(code(&run(dir, &["new", name, "--kind", name])), Some(0));
        let done = run(dir, &["simulate", &format!("{name}.toml")]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        assert!(!stderr(&done).contains("warning"), "{}", stderr(&done));
    }
}

#[test]
fn new_check_info_and_completions() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for kind in StartingPoint::ALL {
        let name = kind.name();
        assert_eq!(code(&run(dir, &["new", name, "--kind", name])), Some(0));
        let check = run(dir, &["check", &format!("{name}.toml")]);
        assert_eq!(code(&check), Some(0), "{}", stderr(&check));
        assert_eq!(
            code(&run(dir, &["new", name, "--kind", name])),
            Some(6),
            "not overwritten"
        );
    }
    let info = run(dir, &["info", "fold.toml"]);
    let text = String::from_utf8_lossy(&info.stdout).into_owned();
    // 25 vertices, 4 x 4 panels of two triangles: 56 edges, 75 - 56 = 19 degrees of freedom, 9 interior
    // vertices with one dependent rod each.
    for part in [
        "25, of these 16 on the boundary",
        "56,",
        "freedom 19",
        "rods   9 in a flat state, 9 as given",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // An elastic sheet has no rods, and none that depend on each other.
    let info = run(dir, &["info", "drape.toml"]);
    let text = String::from_utf8_lossy(&info.stdout).into_owned();
    assert!(text.contains("= 3V, as no edge is a rigid rod"), "{text}");
    assert!(!text.contains("dependent"), "{text}");
    let script = run(dir, &["completions", "bash"]);
    assert!(String::from_utf8_lossy(&script.stdout).contains("simulate"));
    let help = run(dir, &["--help"]);
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    let codes = help.split("Exit codes:").nth(1).unwrap().lines().skip(1);
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scene.md");
    let page = fs::read_to_string(page).unwrap();
    let rows = codes.map(|line| line.trim().split_once(' ').unwrap());
    let rows: Vec<String> = rows
        .map(|(n, text)| format!("| {n} | {} |", text.trim()))
        .collect();
    assert!(
        rows.len() == 8 && rows.iter().all(|row| page.contains(row)),
        "{rows:?}"
    );
    assert_eq!(code(&run(dir, &["simulate"])), Some(2));
}

#[test]
fn names_of_no_file_and_impossible_numbers_of_threads_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["..", ".", "", "a/", "a/.", "a/..", "/"] {
        let refused = run(dir.path(), &["new", name]);
        assert_eq!(code(&refused), Some(2), "{name}: {}", stderr(&refused));
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
    fs::write(dir.path().join("s.toml"), StartingPoint::Hanging.text()).unwrap();
    for threads in ["0", "1025", "100000", "-1", "x"] {
        let refused = run(dir.path(), &["simulate", "s.toml", "--threads", threads]);
        assert_eq!(code(&refused), Some(2), "{threads}: {}", stderr(&refused));
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn meshes_are_checked_and_repaired() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let soup = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\nf 4 6 5\n";
    fs::write(dir.join("soup.obj"), soup).unwrap();
    let check = run(dir, &["check", "soup.obj"]);
    assert_eq!(code(&check), Some(3));
    assert!(
        stderr(&check).contains("--fix -o FILE2` repairs this"),
        "{}",
        stderr(&check)
    );
    let fix = run(dir, &["check", "soup.obj", "--fix", "-o", "sheet.obj"]);
    assert_eq!(code(&fix), Some(0), "{}", stderr(&fix));
    let sheet = read_sheet(&dir.join("sheet.obj")).unwrap();
    assert_eq!((sheet.topology().vertex_count(), sheet.area()), (4, 1.0));
    assert_eq!(code(&run(dir, &["check", "sheet.obj"])), Some(0));
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    fs::write(dir.join("quad.obj"), quad).unwrap();
    let refused = run(dir, &["check", "quad.obj"]);
    assert!(
        stderr(&refused).contains("cuts polygons"),
        "{}",
        stderr(&refused)
    );
    assert_eq!(
        code(&run(dir, &["check", "quad.obj", "--fix", "-o", "cut.ply"])),
        Some(0)
    );
    // Two triangles that touch along a side are a sheet of two parts; merging joins them. Three that touch
    // along one side cannot be joined, and stay as they are.
    let touching = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n";
    fs::write(dir.join("touch.obj"), touching).unwrap();
    let check = run(dir, &["check", "touch.obj"]);
    let text = String::from_utf8_lossy(&check.stdout).into_owned();
    assert!(
        text.contains("in 2 parts") && text.contains("2 coincident"),
        "{text}"
    );
    assert_eq!(
        code(&run(dir, &["check", "touch.obj", "--fix", "-o", "one.obj"])),
        Some(0)
    );
    assert_eq!(
        read_sheet(&dir.join("one.obj"))
            .unwrap()
            .topology()
            .component_count(),
        1
    );
    let up = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 7 8 9\n";
    fs::write(dir.join("three.obj"), format!("{touching}{up}")).unwrap();
    let kept = run(dir, &["check", "three.obj", "--fix", "-o", "kept.obj"]);
    assert_eq!(code(&kept), Some(0), "{}", stderr(&kept));
    assert_eq!(
        read_sheet(&dir.join("kept.obj"))
            .unwrap()
            .topology()
            .component_count(),
        3
    );
    let fan = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    fs::write(dir.join("fan.obj"), fan).unwrap();
    let refused = run(dir, &["check", "fan.obj", "--fix", "-o", "no.obj"]);
    assert_eq!(code(&refused), Some(3));
    assert!(!dir.join("no.obj").exists());
}

/// A closed solid is a valid sheet of rods, and a file in millimetres a valid sheet of kilometres.
#[test]
fn sheets_that_cannot_do_what_was_meant_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(dir.join("solid.obj"), tetrahedron).unwrap();
    let square = |side: u32| format!("v 0 0 0\nv {side} 0 0\nv 0 {side} 0\nf 1 2 3\n");
    let beside = format!("{tetrahedron}{}", square(9).replace("1 2 3", "5 6 7"));
    fs::write(dir.join("two.obj"), beside).unwrap();
    fs::write(dir.join("wide.obj"), square(800)).unwrap();
    fs::write(dir.join("right.obj"), square(2)).unwrap();
    let scene = |name: &str, more: &str| {
        format!("version = 1\n[sheet]\nmesh = {{ file = {{ path = \"{name}\"{more} }} }}\n")
    };
    fs::write(dir.join("wide.toml"), scene("wide.obj", "")).unwrap();
    fs::write(
        dir.join("scaled.toml"),
        scene("wide.obj", ", scale = 0.001"),
    )
    .unwrap();
    fs::write(dir.join("solid.toml"), scene("solid.obj", "")).unwrap();
    let elastic = "isometry = { elastic = { stiffness = 1e5 } }\n";
    fs::write(dir.join("elastic.toml"), scene("solid.obj", "") + elastic).unwrap();
    let closed = ["surface is closed", "cannot bend"];
    let wide = ["800 m wide", "scale = 0.001"];
    let cases: [(&str, &[&str]); 8] = [
        ("solid.obj", &closed),
        ("solid.toml", &closed),
        ("elastic.toml", &[]),
        ("two.obj", &["1 of the 2 parts", "cannot bend"]),
        ("wide.obj", &wide),
        ("wide.toml", &wide),
        ("scaled.toml", &[]),
        ("right.obj", &[]),
    ];
    for (file, parts) in cases {
        let check = run(dir, &["check", file]);
        assert_eq!(code(&check), Some(0), "{file}: {}", stderr(&check));
        let text = stderr(&check);
        assert!(
            parts.iter().all(|part| text.contains(part)),
            "{file}: {text}"
        );
        assert_eq!(
            text.contains("warning: "),
            !parts.is_empty(),
            "{file}: {text}"
        );
    }
}

/// What `check` warns of is said where the scene is run, too: a sheet in the unit of another program, and a
/// point that chooses a vertex far away.
#[test]
fn runs_warn_of_wrong_units() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(
        dir.join("wide.obj"),
        "v 0 0 0\nv 800 0 0\nv 0 800 0\nf 1 2 3\n",
    )
    .unwrap();
    let scene = |name: &str, mesh: &str, more: &str| {
        let stop = "[method]\nstep = 0.01\n[stop]\ntime = 0.01\n";
        let text = format!("version = 1\n[sheet]\nmesh = {mesh}\n{more}{stop}");
        fs::write(dir.join(name), text).unwrap();
    };
    scene("file.toml", "{ file = { path = \"wide.obj\" } }", "");
    scene(
        "office.toml",
        "{ rectangle = { width = 300, height = 210, columns = 2, rows = 2 } }",
        "material = \"office paper\"\n",
    );
    // The far corner of the unit square is nearest.
    let pins = "[[support]]\nat = { nearest = [[0, 0, 0], [301, 401, 0]] }\nhold = \"pin\"\n";
    scene("far.toml", "{ square = { side = 1, level = 0 } }", pins);
    let far = [
        "`support[0].at.nearest[1]` is 500 m away",
        "the sheet is 1 m wide",
    ];
    let cases: [(&str, &[&str]); 3] = [
        ("file.toml", &["800 m wide", "scale = 0.001"]),
        ("office.toml", &["`sheet` is 300 m wide", "in metres"]),
        ("far.toml", &far),
    ];
    for (file, parts) in cases {
        for command in ["check", "simulate", "info"] {
            let output = run(dir, &[command, file]);
            assert_eq!(code(&output), Some(0), "{file}: {}", stderr(&output));
            let text = stderr(&output);
            assert_eq!(text.matches("warning: ").count(), 1, "{file}: {text}");
            assert!(
                parts.iter().all(|part| text.contains(part)),
                "{file}: {text}"
            );
        }
    }
}

/// The scenes of the figures are scenes like any other.
#[test]
fn scenes_of_the_figures_are_checked_and_run() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../xtask/scenes");
    let folders = [scenes.clone(), scenes.join("gallery")];
    let entries = folders
        .iter()
        .flat_map(|folder| fs::read_dir(folder).unwrap());
    let files: Vec<_> = entries
        .map(|e| e.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    assert!(files.len() >= 20, "{files:?}");
    let folder = tempfile::tempdir().unwrap();
    for file in files {
        let output = run(folder.path(), &["check", file.to_str().unwrap()]);
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    }
    let vertex = scenes.join("fig17-vertex-odd.toml");
    let arguments = [
        "simulate",
        vertex.to_str().unwrap(),
        "--out",
        "run",
        "--set",
        "stop.time=0.5",
    ];
    let output = run(folder.path(), &arguments);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let summary: Summary = read_json(&folder.path().join("run/summary.json")).unwrap();
    assert_eq!((summary.steps, summary.frames), (30, 31));
}

/// The summary names the commit that the command was built from, where it was built in a repository.
#[test]
fn the_summary_names_the_commit() {
    let git = |arguments: &[&str]| {
        let mut git = Command::new("git");
        let output = git
            .args(arguments)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        output.status.success().then_some(text)
    };
    let is_source = git(&["ls-files", "--error-unmatch", "build.rs"]).is_some();
    let head = is_source.then(|| git(&["rev-parse", "HEAD"])).flatten();
    let dir = with_scene(StartingPoint::Hanging);
    let dir = dir.path();
    let simulate = ["simulate", "scene.toml", "--set", "stop.time=0.05"];
    assert_eq!(code(&run(dir, &simulate)), Some(0));
    let summary: Summary = read_json(&dir.join("scene-run/summary.json")).unwrap();
    assert_eq!(summary.commit, head);
}
