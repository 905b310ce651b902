//! What the page about scene files says before its index.

/// The text in Markdown, with `KINDS`, `TABLES` and `EXAMPLE` in the places of what is made of the code.
pub(super) const INTRODUCTION: &str = "\
# Scene files

A scene file says in TOML what is simulated. `isosheet simulate SCENE` runs it. Lengths are in metres, times in
seconds, masses in kilograms, forces in newtons and **angles in degrees**. The program models only what the
scene names: without `forces.gravity` there is no gravity, without `air` no air, without obstacles and
self-contact no contact.

## The tables

TABLES

[Values of several tables](scene/values.md) describes profiles, selections, poses and what else several tables
have. [Ranges of numbers](scene/ranges.md) has the least and the largest number of each unit. These pages and
`scene.schema.json`, the JSON schema for editors, are made of the structs that read scenes.

**To find a key**, look it up in the [index of all keys](#index-of-all-keys) at the end of this page. Or build
the book, `mdbook build docs`, and search it: the key `s` opens the search.

## How keys are written

Where a key has several choices, a choice with keys of its own is a table with one entry
(`shape = { sphere = { radius = 0.1 } }`). A choice without keys is its name (`shape = \"half_space\"`). An unknown
key is an error, which names the nearest known one.

EXAMPLE

`isosheet new NAME --kind KIND` writes a commented scene to start from; KIND is one of
KINDS.
`isosheet check SCENE` says what is wrong with a scene. `--set key=value` changes a key for one run, for example
`--set stop.time=0.5 --set 'obstacle[1].friction=0.3'`. The number of the only entry of a list may be left out.

## What a run writes

`isosheet simulate` writes the folder `NAME-run` (`--out` names another one): `scene.toml` as it was run,
`meshes/` with the mesh files, `history.csv`, `loads.csv`, `measures.csv`, `events.csv`, `trajectory.npz`,
`obj/` if the scene asks for it, `index.html`, and last `summary.json`. The page `index.html` shows the run in
3D and plays it, in any browser and without a connection. `isosheet page DIR` makes the page anew, also of a
run that is not complete. `isosheet info DIR` says what came of the run.

The command that began a stopped run continues it, as does `isosheet resume DIR`. After an edit of the scene
`isosheet simulate SCENE --force` replaces the run. Runs that failed or were stopped have `trajectory.npz`,
too. Where that file was deleted, the command of the run or `isosheet convert DIR x.npz` writes it again.

`isosheet sweep SCENE --over stop.time=1,2 --over sheet.damping=0.5,1,2` runs all combinations of the values
in the folders `NAME-sweep/000`, `001` and so on. One run for each core goes on at a time, or as many as `-j`
says. `NAME-sweep/runs.csv` is the table of the runs. With `--engine parallel`, `slurm` or `snakemake` the
command prints what GNU parallel, Slurm or Snakemake need to run them. Repeat the command to continue runs
that were stopped or killed. You may add values at the end of the first key.
`isosheet collect NAME-sweep --out all.csv` makes one table of the keys and of all `summary.json`, with a row
for each run.

The exit codes:

| code | meaning |
|---|---|
| 0 | done; of `simulate`, the run is complete; of `sweep`, all runs are |
| 1 | a step of the simulation failed |
| 2 | the command line is wrong, or does not fit to the files that it names |
| 3 | the scene or the mesh is wrong, or a file cannot be read |
| 4 | the folder holds the run of another scene or version, another sweep, or other files |
| 5 | another process is writing to the folder |
| 6 | a file or a folder cannot be written |
| 130 | stopped by Ctrl-C, or a run of a sweep was killed; the same command without `--force` continues |

## Index of all keys

";
