use super::*;
use isosheet_mesh::Advice;
use std::fs;

fn sweep(variations: &[&str]) -> Result<Sweep, SweepError> {
    let variations = variations.iter().map(|v| v.parse().unwrap()).collect();
    let (scene, folder) = (Path::new("/data/s.toml"), Path::new("/data/my sweep"));
    Sweep::new(scene, folder, vec!["stop.time=2".into()], variations)
}

#[test]
fn the_last_key_changes_fastest() {
    let sweep = sweep(&["a=1,2", "b.c=x,y,z"]).unwrap();
    assert_eq!(sweep.len(), 6);
    let values: Vec<_> = sweep.runs().map(|run| run.values.join(" ")).collect();
    assert_eq!(values, ["1 x", "1 y", "1 z", "2 x", "2 y", "2 z"]);
    let run = sweep.run(4);
    assert_eq!((run.number, run.folder.as_str()), (4, "004"));
    assert_eq!(run.edits, ["stop.time=2", "a=2", "b.c=y"]);
    let expected = [
        "simulate",
        "/data/s.toml",
        "--set",
        "stop.time=2",
        "--set",
        "a=2",
        "--set",
        "b.c=y",
        "--out",
        "/data/my sweep/004",
    ];
    assert_eq!(sweep.arguments(&run), expected);
}

/// Values that are added to the first key leave the runs before as they are.
#[test]
fn values_are_added_at_the_end_of_the_first_key() {
    let table = |v: &[&str]| sweep(v).unwrap().table();
    let first = table(&["a=1,2", "b=1,2"]);
    assert!(table(&["a=1,2,3", "b=1,2"]).begins_with(&first));
    assert!(!table(&["a=1,2", "b=1,2,3"]).begins_with(&first));
    assert!(!table(&["a=1", "b=1,2"]).begins_with(&first));
    assert!(!table(&["a=1,2", "c=1,2"]).begins_with(&first));
}

#[test]
fn keys_that_meet_and_too_many_runs_are_refused() {
    let says = |keys: &[&str], text: &str| {
        let refused = sweep(keys).err();
        matches!(refused, Some(SweepError::Keys(error)) if error.message.contains(text))
    };
    let same = |keys: &[&str]| says(keys, "the same part of the scene");
    assert!(same(&["a=1", "b=1", "a=2"]));
    assert!(same(&["list[0].x=1", "list.0.x=2"]));
    assert!(same(&["a.b=1", "a=2"]) && same(&["a=1", "a.b=2"]));
    assert!(!same(&["a.b=1", "a.bc=2"]));
    assert!(says(&[], "needs a key with values"));
    // Every run has the edit `stop.time=2`, made before that of the sweep.
    let overwritten = "overwrite `stop.time=2`";
    assert!(says(&["stop.time=1,2"], overwritten) && says(&["stop={ time = 1 }"], overwritten));
    assert!(sweep(&["stop.rest=0.1,0.2"]).is_ok());
    let many: Vec<String> = (0..1000).map(|k| k.to_string()).collect();
    let many = ["a", "b"].map(|key| format!("{key}={}", many.join(",")));
    assert!(says(
        &[&many[0], &many[1]],
        "these are 1000000 runs, more than 100000"
    ));
}

#[test]
fn texts_for_other_programs() {
    let sweep = sweep(&["a=1,2", "b=1,2,3"]).unwrap();
    let parallel = SweepRunner::Parallel.text(&sweep);
    assert_eq!(
        parallel,
        "parallel --arg-file '/data/my sweep/commands.txt'\n"
    );
    let slurm = SweepRunner::Slurm.text(&sweep);
    assert!(slurm.starts_with("#!/bin/sh\n#SBATCH"), "{slurm}");
    assert!(slurm.contains("\n#SBATCH --array=0-5\n") && slurm.contains("\n#SBATCH --requeue\n"));
    let last = r#"eval "$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" '/data/my sweep/commands.txt')""#;
    assert_eq!(slurm.lines().last(), Some(last));
    let snakefile = SweepRunner::Snakemake.text(&sweep);
    assert!(
        snakefile.contains("workdir: \"/data/my sweep\"\n"),
        "{snakefile}"
    );
    assert!(
        snakefile.contains("touch(\"{run}.done\")") && snakefile.contains("\"{params.command}\"")
    );
}

#[test]
fn a_table_comes_back_and_other_files_are_no_tables() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("runs.csv");
    let table = SweepTable {
        keys: vec!["a".into(), "b[0].c".into()],
        runs: vec![
            (
                "000".into(),
                vec!["[1, 2]".into(), "\"x, \\\"y\\\"\"".into()],
            ),
            ("001".into(), vec!["{ q = 'z' }".into(), "ä".into()]),
        ],
    };
    table.write(&path).unwrap();
    assert_eq!(SweepTable::read(&path).unwrap(), table);
    for wrong in [
        "",
        "a,b\n1,2\n",
        "run,folder\n",
        "run,folder,a\n1,001,2\n",
        "run,folder,a\n0,../x,2\n",
        "run,folder,a\n0,000\n",
    ] {
        fs::write(&path, wrong).unwrap();
        let read = SweepTable::read(&path);
        let error = read.unwrap_err();
        assert!(
            error.advice().is_some_and(|a| a.contains("sweep anew")),
            "{wrong:?}: {error}"
        );
    }
}
