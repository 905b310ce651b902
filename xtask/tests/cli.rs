//! The command line from outside: what it makes, what it refuses, what it leaves behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

fn xtask() -> Command {
    Command::new(env!("CARGO_BIN_EXE_xtask"))
}

/// Runs a command with arguments and an output folder; returns exit code, output and messages.
fn run(args: &[&str], out: &Path) -> (Option<i32>, String) {
    let result = xtask().args(args).arg("--out").arg(out).output().unwrap();
    let text = [result.stdout, result.stderr].concat();
    let text = String::from_utf8_lossy(&text).into_owned();
    (result.status.code(), text)
}

/// Runs `reproduce-figures` with a list and further arguments.
fn reproduce(out: &Path, figures: &str, more: &[&str]) -> (Option<i32>, String) {
    let args = [&["reproduce-figures", "--figures", figures], more].concat();
    run(&args, out)
}

/// Checks that files were written and are larger than `least` bytes.
fn assert_written(out: &Path, least: u64, files: &[&str]) {
    for file in files {
        let length = fs::metadata(out.join(file)).map_or(0, |m| m.len());
        assert!(length > least, "{file} has {length} bytes");
    }
}

fn read(path: PathBuf) -> String {
    fs::read_to_string(path).unwrap()
}

fn read_json(path: PathBuf) -> serde_json::Value {
    serde_json::from_str(&read(path)).unwrap()
}

fn folder() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    (folder, out)
}

/// The text of each figure of a page has at most three sentences.
fn assert_short(page: &str) {
    let sections = page.split("</h2><p>").skip(1);
    let texts: Vec<&str> = sections.filter_map(|s| s.split("</p>").next()).collect();
    assert!(!texts.is_empty());
    for text in texts {
        // "Fig. 7" and "Sec. 1" end no sentence.
        let ends = text.split(". ").skip(1);
        let ends = ends
            .filter(|next| next.starts_with(char::is_uppercase))
            .count();
        assert!(ends < 3, "{text}");
    }
}

/// Names in a folder that start with a dot and are not the program's own records.
fn leftovers(out: &Path) -> Vec<String> {
    let names = |folder: &Path| -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().flatten();
        let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
        names.collect()
    };
    let hidden = names(out).into_iter();
    let hidden = hidden.filter(|n| n.starts_with('.') && n != ".stamps");
    let records = names(&out.join(".stamps")).into_iter();
    hidden
        .chain(records.filter(|n| n.starts_with('.')))
        .collect()
}

#[test]
fn makes_figures_and_skips_them_when_run_again() {
    let (_keep, out) = folder();
    let (code, text) = reproduce(&out, "1,2", &["--quick"]);
    assert_eq!(code, Some(0), "{text}");
    let files = ["figures/fig01.svg", "figures/fig02.svg", "index.html"];
    assert_written(&out, 500, &files);
    let page = read(out.join("index.html"));
    assert_eq!(page.matches("<section").count(), 2);
    assert_short(&page);
    assert!(page.contains("<svg") && !page.contains("<script") && !page.contains("<link"));
    let table = read(out.join("tables/fig01-1.csv"));
    assert!(
        table.starts_with("split,V,E,F,") && table.lines().count() == 5,
        "{table}"
    );
    assert_eq!(leftovers(&out), Vec::<String>::new());

    let made = || {
        fs::metadata(out.join("figures/fig01.svg"))
            .unwrap()
            .modified()
            .unwrap()
    };
    let before = made();
    let (code, text) = reproduce(&out, "1,2,3", &["--quick"]);
    assert_eq!(code, Some(0), "{text}");
    assert_eq!(text.matches("up to date").count(), 2, "{text}");
    assert_eq!(before, made());
    let page = read(out.join("index.html"));
    assert_eq!(
        page.matches("<section").count(),
        3,
        "earlier figures stay in the report"
    );
}

#[test]
fn a_quick_run_of_everything_writes_readable_runs() {
    let (_keep, out) = folder();
    let (code, text) = reproduce(&out, "10,11,12", &["--quick"]);
    assert_eq!(code, Some(0), "{text}");
    let run = out.join("runs/crumple-m1-contact");
    let history = read(run.join("history.csv"));
    assert_eq!(
        history.lines().count(),
        1 + 13,
        "a header, the start and twelve frames"
    );
    assert!(run.join("trajectory.npz").exists());
    let summary = read_json(run.join("summary.json"));
    assert_eq!(
        (&summary["ending"]["reason"], &summary["steps"]),
        (&"time".into(), &12.into())
    );
    let page = read(out.join("index.html"));
    assert!(page.contains("data:image/png;base64,") && page.contains("33.33"));
    assert_short(&page);
    // Small pictures open the full ones, and every run has its scene.
    assert!(page.contains("<a href=\"figures/fig11.png\"><img"));
    assert!(out.join("scenes/crumple-m1-contact.toml").exists());
    assert!(page.contains("Made with <code>--quick</code>"));
    // Every run has a page of its own beside the report, which has all that it needs.
    let played = [
        "fig11-crumple-m1-contact",
        "fig11-crumple-m1-contact-office-paper",
        "fig12-crumple-m2-contact",
    ];
    for name in played {
        let file = format!("{name}.html");
        assert!(page.contains(&format!("<a href=\"{file}")), "{file}");
        let replay = read(out.join(&file));
        assert!(replay.len() < 8_000_000, "{file} exceeds the budget");
        assert!(!replay.contains("<script src") && !replay.contains("<link rel=\"style"));
    }
    let replay = read(out.join("fig11-crumple-m1-contact.html"));
    assert!(replay.contains("\"frames\":13,") && replay.contains("\"pins\":[20]"));
}

#[test]
fn refuses_what_makes_no_sense_before_any_work() {
    let (_keep, out) = folder();
    for (figures, words) in [
        ("99", "99 is not in 1..=15"),
        ("1,16", "16 is not in 1..=15"),
        ("nine", "invalid value 'nine'"),
        ("1,,2", "invalid value ''"),
    ] {
        let (code, text) = reproduce(&out, figures, &[]);
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains(words), "{words} is missing in {text}");
    }
    let (code, text) = reproduce(&out, "1", &["--fast"]);
    assert_eq!(code, Some(2));
    assert!(text.contains("unexpected argument '--fast'"), "{text}");
    assert!(!out.exists(), "nothing was written");
    assert_eq!(run(&["condition-table", "--level", "9"], &out).0, Some(2));
    // An unknown name is answered with the nearest one.
    for (args, name) in [
        (["cost", "--parts", "pendulm"], "'pendulum'"),
        (["locking", "--yardsticks", "clamp"], "'clamped'"),
        (["hard-cases", "--cases", "flat"], "'flat-start'"),
        (
            ["reproduce-figure", "--figures", "1"],
            "'reproduce-figures'",
        ),
    ] {
        let (code, text) = run(&args, &out);
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains(name), "{name} is missing in {text}");
    }
    assert!(!out.exists(), "nothing was written");
}

#[test]
fn an_unwritable_folder_gets_a_clear_message() {
    let (keep, _) = folder();
    let file = keep.path().join("file");
    fs::write(&file, "not a folder").unwrap();
    let (code, text) = reproduce(&file.join("out"), "1", &[]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("error: cannot write to the folder"), "{text}");
    assert!(!text.contains("figure 1"), "no work was done: {text}");
    assert_eq!(text.matches("os error").count(), 1, "told twice: {text}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_finished_and_the_next_run_goes_on() {
    let (_keep, out) = folder();
    let mut child = xtask()
        .args(["reproduce-figures", "--figures", "1,12", "--out"])
        .arg(&out)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The long part of figure 12 follows when figure 1 and the first run are there.
    let run = out.join("runs/crumple-m2-contact/summary.json");
    while !run.exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it ended too early");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let mut kill = Command::new("kill");
    kill.args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    assert!(out.join("figures/fig01.svg").exists() && out.join("index.html").exists());
    assert!(!out.join("figures/fig12.png").exists());
    assert_eq!(leftovers(&out), Vec::<String>::new());
    let (code, text) = reproduce(&out, "1", &[]);
    assert_eq!(
        (code, text.matches("up to date").count()),
        (Some(0), 1),
        "{text}"
    );
    let (code, text) = reproduce(&out, "12", &["--quick"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(run.exists(), "a full run is not replaced by a quick one");
}

#[test]
fn cost_measures_parts_and_works_and_keeps_them() {
    let (_keep, out) = folder();
    let run = |list| {
        run(
            &["cost", "--quick", "--works", "w1,hanging", "--parts", list],
            &out,
        )
    };
    let (code, text) = run("triangle,pendulum");
    assert_eq!(code, Some(0), "{text}");
    let files = [
        "tables/triangle.csv",
        "plots/triangle.svg",
        "plots/triangle.png",
        "tables/pendulum.csv",
        "plots/pendulum.png",
        "findings.csv",
        "plots/works.png",
        "index.html",
    ];
    assert_written(&out, 500, &files);
    let (code, text) = run("flap,triangle");
    assert_eq!(code, Some(0), "{text}");
    // A problem, a row of w1 and four of the hanging sheet.
    assert_eq!(text.matches("up to date").count(), 6, "{text}");
    let page = read(out.join("index.html"));
    for part in
        ["triangle", "hanging", "pendulum", "flap", "works"].map(|id| format!("id=\"{id}\""))
    {
        assert!(page.contains(&part), "{part} is missing");
    }
    assert!(!page.contains("<script") && !page.contains("<link") && !page.contains("NaN"));
    let (code, text) = run("moon");
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("pendulum, triangle"), "{text}");
}

#[test]
fn experiments_of_validation_are_kept() {
    let (_keep, out) = folder();
    let run = |list| run(&["validation", "--quick", "--experiments", list], &out);
    let (code, text) = run("end-shear");
    assert_eq!(code, Some(0), "{text}");
    let files = ["tables/end-shear.csv", "plots/end-shear.svg", "index.html"];
    assert_written(&out, 200, &files);
    let (code, text) = run("end-shear,bartels-lifted");
    assert_eq!(code, Some(0), "{text}");
    assert_eq!(text.matches("up to date").count(), 1, "{text}");
    let page = read(out.join("index.html"));
    assert!(page.contains("id=\"end-shear\"") && page.contains("id=\"bartels-lifted\""));
    let found = read(out.join("findings.csv"));
    let line = found.lines().find(|l| l.starts_with("end-shear,4 across,"));
    assert!(
        line.is_some_and(|l| l.contains(",at_most,12,pass")),
        "{found}"
    );
    let (code, text) = run("moon");
    assert_eq!(code, Some(2), "{text}");
}

#[test]
fn yardsticks_of_locking_are_kept() {
    let (_keep, out) = folder();
    let run = |list| run(&["locking", "--quick", "--yardsticks", list], &out);
    let (code, text) = run("strips");
    assert_eq!(code, Some(0), "{text}");
    let files = [
        "tables/strips.csv",
        "tables/strips-orders.csv",
        "index.html",
    ];
    assert_written(&out, 200, &files);
    let (code, text) = run("clamped,strips");
    assert_eq!(code, Some(0), "{text}");
    assert_eq!(text.matches("up to date").count(), 1, "{text}");
    let page = read(out.join("index.html"));
    assert!(page.contains("id=\"strips\"") && page.contains("id=\"clamped\""));
    assert!(!page.contains("<script") && !page.contains("<link") && !page.contains("NaN"));
    // What the documentation says is asked for in quick form, too.
    let found = read(out.join("findings.csv"));
    let violation = "strips,rods,largest violation of the equations of isometry,";
    let line = found.lines().find(|l| l.starts_with(violation));
    assert!(
        line.is_some_and(|line| line.contains(",at_most,1e-12,pass")),
        "{found}"
    );
    let (code, text) = run("moon");
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("clamped, strips, d-cone"), "{text}");
}

/// All reports have folders of their own below one; what is wrong with one of them does not keep the others.
#[test]
fn a_report_that_fails_does_not_keep_the_others() {
    let (_dir, out) = folder();
    for report in [
        "reproduce-figures",
        "hard-cases",
        "locking",
        "validation",
        "cost",
    ] {
        fs::create_dir_all(out.join(report)).unwrap();
        fs::write(out.join(report).join("mine.txt"), "mine").unwrap();
    }
    let (code, said) = run(&["all", "--quick"], &out);
    assert_eq!(code, Some(1), "{said}");
    assert!(
        out.join("condition-table/condition.csv").is_file(),
        "{said}"
    );
    assert!(
        said.contains("reproduce-figures, hard-cases, locking, validation, cost"),
        "{said}"
    );
}
