//! Sweeps: run, killed and run again, by this command and by others; tables of their results.

use crate::skip::skipped;
use crate::{code, isosheet, run, stderr, stdout, with_scene};
use isosheet_runs::{Sweep, Variation};
use isosheet_scenes::StartingPoint;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Twelve runs of 500 to 625 steps.
const TWELVE: [&str; 12] = [
    "sweep",
    "scene.toml",
    "--over",
    "stop.time=1,1.25",
    "--over",
    "sheet.damping=2.0,5.0",
    "--over",
    "sheet.mesh.miura={ columns = 3, rows = 4, straight = 0.05, zigzag = 0.05, angle = 60 },{ columns = 4, rows = 3, \
     straight = 0.05, zigzag = 0.04, angle = 70 },{ columns = 4, rows = 4, straight = 0.05, zigzag = 0.05, angle = 60 }",
    "--set",
    "method.step=0.002",
    "--out",
    "my sweep",
];

/// The number of complete runs of a sweep.
fn complete(folder: &Path) -> usize {
    let summary = |k: usize| folder.join(format!("{k:03}/summary.json"));
    (0..12).filter(|k| summary(*k).is_file()).count()
}

fn wait_for(mut what: impl FnMut() -> bool) {
    while !what() {
        sleep(Duration::from_millis(2));
    }
}

/// The table of a sweep without the wall times.
fn collected(dir: &Path) -> Vec<Vec<String>> {
    let output = run(dir, &["collect", "my sweep"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let mut reader = csv::Reader::from_reader(&output.stdout[..]);
    let header = reader.headers().unwrap().clone();
    let wall = header.iter().position(|name| name == "wall_time").unwrap();
    let rows = reader.records().map(|row| row.unwrap());
    let rows = std::iter::once(header).chain(rows).map(|row| {
        let cells = row.iter().enumerate().filter(|(k, _)| *k != wall);
        cells.map(|(_, cell)| cell.to_owned()).collect()
    });
    rows.collect()
}

/// The table of a sweep that nothing disturbs.
fn undisturbed() -> Vec<Vec<String>> {
    let dir = with_scene(StartingPoint::Fold);
    let done = run(dir.path(), &[&TWELVE[..], &["-j", "2"]].concat());
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert!(stdout(&done).contains("complete: 12 runs"));
    collected(dir.path())
}

/// Starts a process as the leader of a group, and kills the whole group when some runs are complete.
#[cfg(unix)]
fn killed_half_way(mut command: Command, sweep: &Path) {
    use std::os::unix::process::CommandExt;
    command.stderr(Stdio::null()).process_group(0);
    let mut child = command.spawn().unwrap();
    wait_for(|| complete(sweep) >= 1);
    let group = format!("-{}", child.id());
    let kill = Command::new("kill").args(["-9", "--", &group]).status();
    assert!(kill.unwrap().success());
    child.wait().unwrap();
    let count = complete(sweep);
    assert!((1..12).contains(&count), "killed too late: {count}");
}

#[cfg(unix)]
#[test]
fn a_sweep_that_is_killed_ends_with_the_same_table() {
    let expected = undisturbed();
    assert_eq!(expected.len(), 13);
    let header = &expected[0];
    let keys = ["stop.time", "sheet.damping", "sheet.mesh.miura"];
    assert_eq!(
        (header[0].as_str(), &header[1..4]),
        ("folder", &keys.map(String::from)[..])
    );
    // The table says what each run computed.
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    for row in &expected[1..] {
        let [asked, reached] =
            ["stop.time", "ending.t"].map(|c| row[column(c)].parse::<f64>().unwrap());
        assert!((asked - reached).abs() < 1e-12, "{asked} {reached}");
        let faces = match row[3].contains("70") || row[3].contains("columns = 3") {
            true => "24",
            false => "32",
        };
        assert_eq!(row[column("faces")], faces);
    }
    let dir = with_scene(StartingPoint::Fold);
    let (dir, sweep) = (dir.path(), dir.path().join("my sweep"));
    let local = [&TWELVE[..], &["-j", "2"]].concat();
    let mut command = isosheet(dir);
    command.args(&local);
    killed_half_way(command, &sweep);
    let partial = run(dir, &["collect", "my sweep", "--out", "all.csv"]);
    assert_eq!(code(&partial), Some(3), "{}", stderr(&partial));
    assert!(!dir.join("all.csv").exists());
    let named = stderr(&partial).matches("not complete: my sweep/").count();
    assert_eq!(named, 12 - complete(&sweep));
    let partial = run(
        dir,
        &[
            "collect",
            "my sweep",
            "--out",
            "all.csv",
            "--allow-incomplete",
        ],
    );
    assert_eq!(code(&partial), Some(0), "{}", stderr(&partial));
    let lines = fs::read_to_string(dir.join("all.csv"))
        .unwrap()
        .lines()
        .count();
    assert_eq!(lines, 1 + complete(&sweep));
    let done = run(dir, &local);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert_eq!(collected(dir), expected);
    let line = expected[1..].iter().map(|row| &row[0]).collect::<Vec<_>>();
    assert_eq!(line[11], "my sweep/011");
}

/// GNU parallel runs each line in a group of its own: after a kill of the program the runs under way go on,
/// and are found in use by the same line until they have ended.
#[cfg(unix)]
#[test]
fn gnu_parallel_runs_a_sweep_and_may_be_killed() {
    let version = Command::new("parallel").arg("--version").output();
    if !version.is_ok_and(|v| v.stdout.starts_with(b"GNU parallel")) {
        skipped("parallel", "GNU parallel is not installed");
        return;
    }
    let dir = with_scene(StartingPoint::Fold);
    let (dir, sweep) = (dir.path(), dir.path().join("my sweep"));
    let printed = run(dir, &[&TWELVE[..], &["--engine", "parallel"]].concat());
    assert_eq!(code(&printed), Some(0), "{}", stderr(&printed));
    let line = String::from_utf8(printed.stdout).unwrap();
    assert!(
        line.starts_with("parallel --arg-file '") && line.ends_with("/my sweep/commands.txt'\n")
    );
    let shell = |line: &str| {
        let mut command = Command::new("sh");
        command
            .args(["-c", line])
            .current_dir(dir)
            .stderr(Stdio::null());
        command
    };
    killed_half_way(
        shell(&line.replace("parallel ", "exec parallel -j 2 ")),
        &sweep,
    );
    wait_for(|| shell(&line).status().unwrap().success());
    assert_eq!(collected(dir), undisturbed());
}

/// Whether Slurm runs jobs on this machine and no other: temporary folders are seen by no other one.
#[cfg(unix)]
fn has_slurm_of_its_own() -> bool {
    let said = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output().ok()?;
        let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        output.status.success().then_some(text)
    };
    let nodes = said("sbatch", &["--version"])
        .and_then(|_| said("sinfo", &["--noheader", "--Node", "--format=%N %T"]));
    let Some(nodes) = nodes.filter(|nodes| !nodes.is_empty()) else {
        let reason = "Slurm is not installed, or its controller does not answer";
        skipped("slurm", reason);
        return false;
    };
    let own = said("hostname", &["-s"]).unwrap_or_default();
    let is_ready = |node: &str| {
        let state = node.strip_prefix(&format!("{own} "));
        state.is_some_and(|s| ["idle", "mixed", "allocated"].contains(&s))
    };
    let is_own = nodes.lines().all(is_ready);
    if !is_own {
        let reason = "the nodes of Slurm are not this machine alone, or not ready";
        skipped("slurm", &format!("{reason}: {nodes}"));
    }
    is_own
}

/// The job array runs the sweep. When the job is cancelled half-way, the same script completes the table.
#[cfg(unix)]
#[test]
fn slurm_runs_a_sweep_and_may_be_cancelled() {
    if !has_slurm_of_its_own() {
        return;
    }
    let dir = with_scene(StartingPoint::Fold);
    let (dir, sweep) = (dir.path(), dir.path().join("my sweep"));
    let script = run(dir, &[&TWELVE[..], &["--engine", "slurm"]].concat());
    assert_eq!(code(&script), Some(0), "{}", stderr(&script));
    fs::write(dir.join("array.sh"), &script.stdout).unwrap();
    let slurm = |program: &str, arguments: &[&str]| {
        let mut command = Command::new(program);
        let output = command.args(arguments).current_dir(dir).output().unwrap();
        assert!(output.status.success(), "{program}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap().trim().to_owned()
    };
    let submit = || slurm("sbatch", &["--parsable", "array.sh"]);
    // A job that has ended is known for some minutes, and has no tasks in the queue.
    let ended = |job: &str| slurm("squeue", &["--noheader", "--jobs", job]).is_empty();
    let first = submit();
    wait_for(|| complete(&sweep) >= 4);
    slurm("scancel", &[&first]);
    wait_for(|| ended(&first));
    let count = complete(&sweep);
    assert!((4..12).contains(&count), "cancelled too late: {count}");
    let second = submit();
    wait_for(|| ended(&second));
    assert_eq!(collected(dir), undisturbed());
}

/// Every line is what a shell and Slurm make of it: the words of a run, whatever its values are.
#[cfg(unix)]
#[test]
fn lines_of_shell_keep_all_values() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let values: Variation =
        r#"sheet.mesh.file.path="it's.obj","$HOME `id`.obj",'\n "q" {}.obj',{} & ;#"#
            .parse()
            .unwrap();
    let sweep = Sweep::new(
        &dir.join("a b.toml"),
        &dir.join("c'd"),
        Vec::new(),
        vec![values],
    )
    .unwrap();
    sweep.write("echo-words").unwrap();
    let commands = fs::read_to_string(dir.join("c'd/commands.txt")).unwrap();
    for (line, run) in commands.lines().zip(sweep.runs()) {
        let line = line.replacen("echo-words", "printf '%s\\n'", 1);
        let output = Command::new("sh").args(["-c", &line]).output().unwrap();
        let words = String::from_utf8(output.stdout).unwrap();
        assert_eq!(words, sweep.arguments(&run).join("\n") + "\n");
    }
    assert_eq!(commands.lines().count(), 4);
}

/// Nothing is written or run if any run is wrong, and every kind of problem is told once.
#[test]
fn wrong_keys_and_values_are_refused_before_anything_runs() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let sweep = |arguments: &[&str]| run(dir, &[&["sweep", "scene.toml"], arguments].concat());
    let wrong = [
        "--over",
        "sheet.damping=1,-2,fast",
        "--over",
        "stop.time=1,2,0",
        "-j",
        "2",
    ];
    let refused = sweep(&wrong);
    let text = stderr(&refused);
    assert_eq!(code(&refused), Some(3), "{text}");
    // Runs 3 to 5 have a negative damping, 6 to 8 one that is no number, 2 no time, and 5 both.
    let first = "run 002 (sheet.damping=1, stop.time=0) cannot start";
    let second = "run 003 (sheet.damping=-2, stop.time=1) and another run cannot start";
    let third = "run 005 (sheet.damping=-2, stop.time=0) cannot start";
    let fourth = "run 006 (sheet.damping=fast, stop.time=1) and 2 other runs cannot start";
    for part in [
        first,
        second,
        third,
        fourth,
        "scene.toml with sheet.damping=1, stop.time=0:",
        "nothing was run",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let unknown = sweep(&["--over", "sheet.dampin=1,2"]);
    assert_eq!(code(&unknown), Some(3));
    assert!(
        stderr(&unknown).contains("did you mean `damping`?"),
        "{}",
        stderr(&unknown)
    );
    // A start that only the engine refuses: the perturbation of a scene in a chart is missing.
    let start = sweep(&["--over", "method.integrator=bdf2,chart"]);
    assert_eq!(code(&start), Some(3), "{}", stderr(&start));
    assert!(stderr(&start).contains("run 001 (method.integrator=chart) cannot start"));
    for bad in [
        "stop.time",
        "stop.time=1,,2",
        "stop.time=[1",
        "stop.time=1,1",
    ] {
        assert_eq!(code(&sweep(&["--over", bad])), Some(2), "{bad}");
    }
    assert_eq!(
        code(&sweep(&["--over", "stop.time=1", "--over", "stop=2"])),
        Some(2)
    );
    assert_eq!(code(&sweep(&[])), Some(2));
    let place = sweep(&["--over", "stop.time.x=0.1,0.2"]);
    assert_eq!(code(&place), Some(2), "{}", stderr(&place));
    let both = ["--over", "stop.time=1", "-j", "1", "--engine", "slurm"];
    assert_eq!(code(&sweep(&both)), Some(2));
    assert_eq!(fs::read_dir(dir).unwrap().count(), 1, "the scene alone");
}

#[test]
fn folders_keep_their_sweep() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let sweep = |over: &str, more: &[&str]| {
        let arguments = [
            "sweep",
            "scene.toml",
            "--set",
            "stop.time=0.1",
            "--over",
            over,
        ];
        run(dir, &[&arguments[..], more].concat())
    };
    // Without a number of jobs there are as many as cores.
    let first = sweep("sheet.damping=1,2", &[]);
    assert_eq!(code(&first), Some(0), "{}", stderr(&first));
    let table = fs::read_to_string(dir.join("scene-sweep/runs.csv")).unwrap();
    assert_eq!(table, "run,folder,sheet.damping\n0,000,1\n1,001,2\n");
    let log = fs::read_to_string(dir.join("scene-sweep/001.log")).unwrap();
    assert!(log.contains("complete: 6 steps"), "{log}");
    let onto = run(
        dir,
        &["collect", "scene-sweep", "--out", "scene-sweep/runs.csv"],
    );
    assert_eq!(code(&onto), Some(2), "{}", stderr(&onto));
    let scene = run(dir, &["collect", "scene-sweep", "--out", "scene.toml"]);
    assert_eq!(code(&scene), Some(2), "{}", stderr(&scene));
    let again = fs::read_to_string(dir.join("scene-sweep/runs.csv")).unwrap();
    assert_eq!(again, table);
    let other = sweep("sheet.damping=2,1", &[]);
    assert_eq!(code(&other), Some(4), "{}", stderr(&other));
    // A value more at the end of the first key.
    let more = sweep("sheet.damping=1,2,3", &["-j", "3"]);
    assert_eq!(code(&more), Some(0), "{}", stderr(&more));
    let log = fs::read_to_string(dir.join("scene-sweep/001.log")).unwrap();
    assert!(log.contains("already complete: 6 steps"), "{log}");
    fs::create_dir(dir.join("mine")).unwrap();
    fs::write(dir.join("mine/letter.txt"), "dear").unwrap();
    let foreign = sweep("sheet.damping=1", &["--out", "mine"]);
    assert_eq!(code(&foreign), Some(4), "{}", stderr(&foreign));
    assert_eq!(fs::read_dir(dir.join("mine")).unwrap().count(), 1);
    // Runs of the scene as it was do not count for a scene that was changed since.
    let text = fs::read_to_string(dir.join("scene.toml")).unwrap();
    fs::write(
        dir.join("scene.toml"),
        text.replace("density = 0.1", "density = 0.2"),
    )
    .unwrap();
    let changed = sweep("sheet.damping=1,2,3,4", &["-j", "1"]);
    assert_eq!(code(&changed), Some(4), "{}", stderr(&changed));
    assert!(stderr(&changed).contains("3 of 4 runs failed, the first one is run 000: error: "));
    assert!(
        dir.join("scene-sweep/003/summary.json").is_file(),
        "the others are run"
    );
    let single = run(dir, &["collect", "scene-sweep/000", "scene-sweep"]);
    let rows = String::from_utf8(single.stdout).unwrap();
    assert_eq!(rows.lines().count(), 6, "{rows}");
    assert!(
        rows.starts_with("folder,sheet.damping,program,version,"),
        "{rows}"
    );
    assert_eq!(code(&run(dir, &["collect", "mine"])), Some(3));
    assert_eq!(
        code(&run(dir, &["collect", "scene-sweep", "--out", "mine"])),
        Some(6)
    );
}

/// The texts for all programs have the lines of the sweep.
#[test]
fn texts_for_slurm_and_snakemake() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let over = ["sweep", "scene.toml", "--over", "stop.time=0.1,0.2"];
    let text = |engine: &[&str]| {
        let output = run(dir, &[&over[..], engine].concat());
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let parts: HashMap<&str, String> = ["parallel", "slurm", "snakemake"]
        .map(|name| (name, text(&["--engine", name])))
        .into();
    // Nothing is run where a text is printed.
    assert!(!dir.join("scene-sweep/000.log").exists());
    // What a task of the array does, with a shell instead of Slurm.
    let mut task = Command::new("sh");
    task.args(["-c", &parts["slurm"]])
        .env("SLURM_ARRAY_TASK_ID", "1");
    assert!(task.stderr(Stdio::null()).status().unwrap().success());
    assert!(dir.join("scene-sweep/001/summary.json").is_file());
    assert!(!dir.join("scene-sweep/000").exists());
}
