//! Galleries of runs.

use crate::{code, isosheet, killed, run, stderr, stdout};
use isosheet_files::read_json;
use isosheet_films::GalleryEntry;
use isosheet_scenes::StartingPoint;
use std::fs;
use std::path::Path;

fn write_scene(folder: &Path, kind: StartingPoint) {
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("scene.toml"), kind.text()).unwrap();
}

/// The places that a page refers to.
fn references(page: &str) -> Vec<String> {
    let quoted = |attribute: &str| {
        let parts = page.split(attribute).skip(1);
        let values = parts.map(|rest| rest.split('"').next().unwrap().to_owned());
        values.collect::<Vec<_>>()
    };
    [quoted(" href=\""), quoted(" src=\"")].concat()
}

#[test]
fn a_gallery_shows_every_run_beneath_its_folders_and_needs_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    // A scene beside its run, and one further down whose run is not complete.
    write_scene(&dir.join("a"), StartingPoint::Fold);
    let done = run(&dir.join("a"), &["simulate", "scene.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    write_scene(&dir.join("b/c"), StartingPoint::Drape);
    let part = [
        "simulate",
        "b/c/scene.toml",
        "--out",
        "b/c/scene-run",
        "--set",
        "stop.time=30",
    ];
    killed(dir, &part, "b/c/scene-run", 20);
    // A run whose history is damaged.
    write_scene(&dir.join("d"), StartingPoint::Fold);
    let done = run(
        &dir.join("d"),
        &["simulate", "scene.toml", "--out", "broken"],
    );
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    fs::write(dir.join("d/broken/history.csv"), "t,h\n").unwrap();

    let made = run(dir, &["gallery", "b", ".", "--out", "shown"]);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    let said = stderr(&made);
    assert!(said.contains("left out: ./d/broken: "), "{said}");
    assert_eq!(stdout(&made), "shown/index.html: 2 runs\n");

    let entries: Vec<GalleryEntry> = read_json(&dir.join("shown/gallery.json")).unwrap();
    let [drape, fold] = &entries[..] else {
        panic!("two runs: {entries:?}");
    };
    // The folders in the order of the command line; a run that is found twice is shown once.
    assert_eq!(
        (drape.name.as_str(), fold.name.as_str()),
        ("scene", "scene-2")
    );
    assert_eq!(
        drape.caption,
        "A tablecloth of plastic film that falls on a round table and drapes over its rim."
    );
    assert!(drape.summary.is_none() && drape.t > 0.0 && drape.t < 30.0);
    let summary = fold.summary.as_ref().unwrap();
    assert_eq!((summary.steps, fold.vertices), (90, 25));

    let moved = dir.join("elsewhere");
    fs::rename(dir.join("shown"), &moved).unwrap();
    let page = fs::read_to_string(moved.join("index.html")).unwrap();
    for part in [
        "<dd>90</dd>",
        &format!("<dd>{:.1e}</dd>", summary.largest_strain),
        "<dd>not complete: up to ",
        // What cannot be shown has a line of its own, and the page has all others.
        "Not shown",
        "<li>./d/broken: ",
    ] {
        assert!(page.contains(part), "{part}: {page}");
    }
    let references = references(&page);
    assert_eq!(references.len(), 6);
    for file in references {
        let start = fs::read(moved.join(&file)).unwrap();
        let expected: &[u8] = if file.ends_with(".png") {
            b"\x89PNG"
        } else {
            b"<!doctype html>"
        };
        assert!(
            start
                .to_ascii_lowercase()
                .starts_with(&expected.to_ascii_lowercase()),
            "{file}"
        );
    }
}

/// A process that is killed leaves pages without a list of them, and an unfinished file wherever it was
/// writing.
#[test]
fn a_killed_gallery_is_made_by_the_same_command() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    write_scene(dir, StartingPoint::Fold);
    for k in 0..4 {
        let out = format!("runs/{k}");
        let arguments = ["simulate", "scene.toml", "--out", &out];
        let done = run(dir, &[&arguments[..], &["--set", "stop.time=0.1"]].concat());
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    }
    let command = ["gallery", "runs", "--out", "shown"];
    let shown = dir.join("shown");
    let mut child = isosheet(dir).args(command).spawn().unwrap();
    while !shown.join("runs/0.html").is_file() {
        assert!(child.try_wait().unwrap().is_none(), "four runs take longer");
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!shown.join("gallery.json").exists());
    // Where the kill came while the list was written.
    fs::write(shown.join(".tmpA1b2C3.part"), "<!doctype html>").unwrap();
    fs::write(shown.join("runs/.tmpD4e5F6.part"), "<!doctype html>").unwrap();

    let made = run(dir, &command);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    let entries: Vec<GalleryEntry> = read_json(&shown.join("gallery.json")).unwrap();
    assert_eq!(entries.len(), 4);
    let count = |folder: &Path| fs::read_dir(folder).unwrap().count();
    assert_eq!(
        (count(&shown), count(&shown.join("runs"))),
        (3, 8),
        "index, data and folder; two files a run"
    );

    // Hidden files of other programs are nobody's unfinished ones.
    fs::create_dir(dir.join("other")).unwrap();
    fs::write(dir.join("other/.profile"), "").unwrap();
    let refused = run(dir, &["gallery", "runs", "--out", "other"]);
    assert_eq!(code(&refused), Some(4), "{}", stderr(&refused));
}

/// A floor of a hundred metres below a cloth of twenty centimetres costs no more memory than others do.
#[test]
fn huge_bodies_are_drawn() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = StartingPoint::Drape.text();
    let scene = scene.replace("side = 0.5", "side = 0.2");
    let scene = scene.replace("[-0.25, -0.25, 0.0]", "[-0.1, -0.1, 0.0]");
    let scene = scene.replace(
        "cylinder = { radius = 0.15, height = 0.2 }",
        "box = { size = [100.0, 100.0, 0.2] }",
    );
    assert!(
        scene.contains("100.0") && scene.contains("side = 0.2") && scene.contains("-0.1, -0.1")
    );
    fs::write(dir.join("scene.toml"), scene).unwrap();
    let short = ["simulate", "scene.toml", "--set", "stop.time=0.1"];
    let done = run(dir, &short);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let done = run(dir, &["convert", "scene-run", "floor.png"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let made = run(dir, &["gallery", "."]);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    assert!(dir.join("gallery/runs/scene.png").is_file());
}

#[test]
fn a_gallery_is_replaced_and_other_folders_are_not() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for name in ["One", "two"] {
        write_scene(dir, StartingPoint::Fold);
        let out = format!("runs/{name}");
        let done = run(dir, &["simulate", "scene.toml", "--out", &out]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    }
    let gallery = |folders: &[&str]| run(dir, &[&["gallery"], folders].concat());
    let made = gallery(&["runs"]);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    let files = || {
        let entries = fs::read_dir(dir.join("gallery/runs")).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    let both = ["One.html", "One.png", "two.html", "two.png"];
    assert_eq!(files(), both);
    let index = fs::read(dir.join("gallery/index.html")).unwrap();
    assert_eq!(code(&gallery(&["runs"])), Some(0));
    assert_eq!(
        fs::read(dir.join("gallery/index.html")).unwrap(),
        index,
        "the same again"
    );
    assert_eq!(files(), both);
    assert_eq!(code(&gallery(&["runs/two"])), Some(0));
    assert_eq!(files(), ["two.html", "two.png"]);

    for (arguments, expected, part) in [
        (
            vec!["gallery", "runs", "--out", "runs"],
            4,
            "not the folder of a gallery",
        ),
        (
            vec!["gallery", "gallery"],
            3,
            "no folder of a run in gallery",
        ),
        (vec!["gallery", "none"], 3, "cannot read none"),
        (vec!["gallery"], 2, "DIR"),
    ] {
        let refused = run(dir, &arguments);
        assert_eq!(code(&refused), Some(expected), "{}", stderr(&refused));
        assert!(stderr(&refused).contains(part), "{}", stderr(&refused));
    }
}

/// Cards of the runs of a sweep say by what these differ.
#[test]
fn runs_of_sweeps_show_their_values() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    write_scene(dir, StartingPoint::Hanging);
    let sweep = [
        "sweep",
        "scene.toml",
        "--over",
        "sheet.damping=2.0,5.0",
        "--set",
        "stop.time=0.05",
        "--out",
        "many",
    ];
    let done = run(dir, &sweep);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let made = run(dir, &["gallery", "many"]);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    let entries: Vec<GalleryEntry> = read_json(&dir.join("gallery/gallery.json")).unwrap();
    let values: Vec<_> = entries.iter().map(|entry| entry.values.clone()).collect();
    let damping = |value: &str| vec![("sheet.damping".to_owned(), value.to_owned())];
    assert_eq!(values, [damping("2.0"), damping("5.0")]);
    let page = fs::read_to_string(dir.join("gallery/index.html")).unwrap();
    assert!(
        page.contains("<dt>sheet.damping</dt><dd>2.0</dd>"),
        "{page}"
    );
}
