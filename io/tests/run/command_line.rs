//! The command line by the usual conventions: what is misuse, what goes where, what is said.

use crate::{code, isosheet, run, stderr, stdout, with_scene};
use isosheet_scenes::StartingPoint;
use std::fs;

/// A folder with a scene, its run of 0.1 s, and a mesh.
fn with_run() -> tempfile::TempDir {
    let dir = with_scene(StartingPoint::Fold);
    let short = ["simulate", "scene.toml", "--set", "stop.time=0.1", "-q"];
    let done = run(dir.path(), &short);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::write(dir.path().join("sheet.obj"), mesh).unwrap();
    dir
}

/// What the parser refuses and what the command itself refuses end alike, and nothing is written.
#[test]
fn misuse_ends_with_exit_code_2() {
    let dir = with_run();
    let dir = dir.path();
    let before = fs::read_dir(dir).unwrap().count();
    let lines = [
        "simulate",
        "simulate scene.toml --set stop.time",
        "simulate scene.toml --set stop.time.x=1",
        "simulate scene.toml --threads 0",
        "simulate scene.toml --threads 100000",
        "simulate scene.toml -q -v",
        "check scene.toml --fix",
        "check scene.toml --fix -o fixed.toml",
        "check sheet.obj --fix -o sheet.obj",
        "check sheet.obj -o fixed.obj",
        "check sheet.obj --set stop.time=1",
        "check scene.toml --set stop",
        "info sheet.obj --set stop.time=1",
        "info scene-run --set stop.time=1",
        "new",
        "new ..",
        "new a -o b.toml",
        "sweep scene.toml",
        "sweep scene.toml --over stop.time=1 -j 0",
        "sweep scene.toml --over stop.time.x=1",
        "collect scene-run -o scene-run/summary.json",
        "unknown",
    ];
    for line in lines {
        let words: Vec<&str> = line.split(' ').collect();
        let output = run(dir, &words);
        assert_eq!(code(&output), Some(2), "{line}: {}", stderr(&output));
        assert!(stderr(&output).starts_with("error: "), "{line}");
        assert!(output.stdout.is_empty(), "{line}");
    }
    assert_eq!(fs::read_dir(dir).unwrap().count(), before);
}

/// Results are on standard output, progress is on standard error and can be left out or be told in full.
#[test]
fn results_and_progress_are_kept_apart() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let simulate = |more: &[&str]| {
        let short = [
            "simulate",
            "scene.toml",
            "--set",
            "stop.time=0.1",
            "--force",
        ];
        let output = run(dir, &[&short[..], more].concat());
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        [stdout(&output), stderr(&output)]
    };
    let [result, progress] = simulate(&[]);
    let lines: Vec<&str> = result.lines().collect();
    assert!(lines[0].starts_with("complete: 6 steps"), "{result}");
    assert_eq!(lines[1..], ["page: scene-run/index.html"]);
    assert!(progress.contains("vertices: ") && progress.contains("; 6 steps"));
    assert_eq!(progress.lines().count(), 1, "{progress}");
    let [result, progress] = simulate(&["--quiet"]);
    assert!(result.starts_with("complete: 6 steps"), "{result}");
    assert_eq!(progress, "");
    let [_, progress] = simulate(&["-v"]);
    let steps = progress.lines().filter(|l| l.starts_with("step "));
    assert_eq!(steps.count(), 6, "{progress}");
    let [result, progress] = simulate(&["--set", "stop.time=0.01"]);
    assert!(result.starts_with("complete: 1 step to"), "{result}");
    assert!(progress.contains("; 1 step\n"), "{progress}");
}

/// Every subcommand that writes takes `-o`.
#[test]
fn out_has_one_meaning() {
    let dir = with_run();
    let dir = dir.path();
    let lines = [
        ("new -o own.toml --kind drape", "own.toml"),
        (
            "simulate scene.toml --set stop.time=0.1 -o a",
            "a/summary.json",
        ),
        (
            "sweep scene.toml --over stop.time=0.1 -o b",
            "b/000/summary.json",
        ),
        ("collect b -o b.csv", "b.csv"),
        ("page a -o a.html", "a.html"),
        ("gallery a -o c", "c/index.html"),
        ("check sheet.obj --fix -o fixed.ply", "fixed.ply"),
        ("convert a a.usda", "a.usda"),
    ];
    for (line, file) in lines {
        let words: Vec<&str> = line.split(' ').collect();
        let output = run(dir, &words);
        assert_eq!(code(&output), Some(0), "{line}: {}", stderr(&output));
        assert!(dir.join(file).is_file(), "{line}");
        assert!(!stdout(&output).is_empty(), "{line} says what it wrote");
    }
}

#[test]
fn check_and_info_take_edits_and_info_describes_a_run() {
    let dir = with_run();
    let dir = dir.path();
    let checked = run(dir, &["check", "scene.toml", "--set", "stop.time=-1"]);
    assert_eq!(code(&checked), Some(3), "{}", stderr(&checked));
    let edit = "sheet.mesh={ square = { side = 1.0, level = 0 } }";
    let drape = run(dir, &["new", "drape", "--kind", "drape"]);
    assert_eq!(code(&drape), Some(0));
    let info = run(dir, &["info", "drape.toml", "--set", edit]);
    assert_eq!(code(&info), Some(0), "{}", stderr(&info));
    assert!(stdout(&info).contains("9, of these 8"), "{}", stdout(&info));
    let info = run(dir, &["info", "scene-run"]);
    assert_eq!(code(&info), Some(0), "{}", stderr(&info));
    let text = stdout(&info);
    for part in [
        "scene-run\n",
        "at 0.1000 s: the whole time has passed",
        "largest strain",
        "wall time",
        "The scene:\nvertices ",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    fs::remove_file(dir.join("scene-run/summary.json")).unwrap();
    let info = run(dir, &["info", "scene-run"]);
    let text = stdout(&info);
    assert!(text.contains("not complete: up to 0.1000 s"), "{text}");
}

/// A program in the place of the one that opens pages notes what it is asked to open.
#[cfg(target_os = "linux")]
#[test]
fn open_opens_the_page() {
    use std::os::unix::fs::PermissionsExt;
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let opener = dir.join("xdg-open");
    fs::write(
        &opener,
        "#!/bin/sh\nprintf %s \"$1\" > \"$OPENED.part\"\nmv \"$OPENED.part\" \"$OPENED\"\n",
    )
    .unwrap();
    fs::set_permissions(&opener, fs::Permissions::from_mode(0o755)).unwrap();
    let opened = |out: &str, line: &[&str]| {
        let note = dir.join(out);
        let path = format!("{}:/usr/bin:/bin", dir.display());
        let mut command = isosheet(dir);
        let output = command
            .args(line)
            .env("PATH", path)
            .env("OPENED", &note)
            .output()
            .unwrap();
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        while !note.is_file() {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        fs::read_to_string(note).unwrap()
    };
    let page = |path: &str| dir.join(path).canonicalize().unwrap().display().to_string();
    let simulate = ["simulate", "scene.toml", "--set", "stop.time=0.1", "--open"];
    assert_eq!(opened("one", &simulate), page("scene-run/index.html"));
    let line = ["page", "scene-run", "-o", "p.html", "--open"];
    assert_eq!(opened("two", &line), page("p.html"));
    let line = ["gallery", "scene-run", "--open"];
    assert_eq!(opened("three", &line), page("gallery/index.html"));
}
