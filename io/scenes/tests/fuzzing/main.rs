//! The readers on damaged files: seeds of `io/fuzz/seeds` with random changes, the same for every run.
//!
//! A reader may return a value or a typed error. Failures are panics, numbers that are not finite and indices
//! of nothing in what was read, and allocations beyond [`MOST_MEMORY`]. A case that does not end keeps the
//! test from ending: `--nocapture` shows which target that is, and `target/tmp/fuzz/TARGET/current` is the
//! case. `cargo test` tries [`CASES`] cases of each target, `cargo xtask soak` more of them with other seeds,
//! and `ISOSHEET_FUZZ_TARGET=T` runs one target alone. `limits.rs` runs cases in processes with limits.
//! The seeds of all targets are written to `target/tmp/fuzz/` for cargo-fuzz, which `io/fuzz` is for.

mod bombs;
#[cfg(unix)]
mod limits;
mod mutation;
mod targets;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use targets::{TARGETS, checkpoints, checkpoints_json, histories, target, trajectories, with_file};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Held by each test while it runs: the memory of another one would be counted.
static ALONE: Mutex<()> = Mutex::new(());

/// Cases of each target in `cargo test`.
const CASES: u64 = 1500;

/// Bytes that all allocations of a case may add up to. A scene of 300 cells that is started takes about 30
/// MB.
const MOST_MEMORY: usize = 512 << 20;

/// Files to begin with.
fn seeds(name: &str) -> Vec<Vec<u8>> {
    match name {
        "checkpoint" => checkpoints().to_vec(),
        "checkpoint_json" => checkpoints_json().to_vec(),
        "trajectory" => trajectories().to_vec(),
        "history" => histories().to_vec(),
        _ => {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../fuzz/seeds")
                .join(name);
            let entries = fs::read_dir(&folder).expect("the folder of seeds");
            let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
            paths.sort();
            paths.iter().map(|p| fs::read(p).expect("a seed")).collect()
        }
    }
}

/// The folder of a target in the build folder.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("fuzz")
        .join(name);
    fs::create_dir_all(&folder).expect("the build folder can be written");
    folder
}

/// What a case did that no case may do.
fn fault(name: &str, data: &[u8]) -> Option<String> {
    let before = ALLOCATOR.stats().bytes_allocated;
    let panicked = catch_unwind(AssertUnwindSafe(|| target(name)(data))).is_err();
    let memory = ALLOCATOR.stats().bytes_allocated - before;
    if panicked {
        Some("a panic, shown above".to_owned())
    } else if memory > MOST_MEMORY {
        Some(format!("{memory} bytes of memory"))
    } else {
        None
    }
}

/// Runs cases of one target, each of which is in a file of its folder before it begins.
fn run(name: &'static str, cases: u64, seed: u64) {
    let seeds = seeds(name);
    for (k, seed) in seeds.iter().enumerate() {
        let path = folder(name).join(format!("seed-{k}"));
        fs::write(path, seed).expect("the build folder can be written");
    }
    println!("{name}: {cases} cases");
    let current = folder(name).join("current");
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for done in 0..cases {
        // The seeds as they are come first.
        let data = match seeds.get(done as usize) {
            Some(seed) => seed.clone(),
            None => mutation::mutate(&seeds, &mut rng),
        };
        fs::write(&current, &data).expect("the build folder can be written");
        if let Some(fault) = fault(name, &data) {
            panic!(
                "{name}, case {done}: {fault}; the file is {}",
                current.display()
            );
        }
    }
}

#[test]
fn damaged_files_give_a_value_or_a_typed_error() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let only = std::env::var("ISOSHEET_FUZZ_TARGET").ok();
    let names = TARGETS.map(|(name, _)| name).into_iter();
    for name in names.filter(|name| only.as_deref().is_none_or(|only| only == *name)) {
        run(
            name,
            CASES * u64::from(isosheet_random::times()),
            isosheet_random::seed(),
        );
    }
}

/// The seeds have to reach what lies behind the first checks: none of them may be refused.
#[test]
fn every_seed_is_accepted() {
    use isosheet_drawings::{DrawingOptions, parse_drawing};
    use isosheet_dynamics::Checkpoint;
    use isosheet_formats::{
        MeshFormat, MeshOptions, Trajectory, mesh_drawing, parse_mesh, read_history,
    };
    use isosheet_scenes::SceneFile;
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    for (name, _) in TARGETS {
        let seeds = seeds(name);
        assert!(!seeds.is_empty(), "{name}");
        for (k, seed) in seeds.iter().enumerate() {
            let text = || std::str::from_utf8(seed).expect("a text");
            let path = Path::new(name);
            let refusal = match name {
                "checkpoint" => Checkpoint::from_bytes(seed).err().map(|e| e.to_string()),
                "checkpoint_json" => Checkpoint::from_json(text()).err().map(|e| e.to_string()),
                "trajectory" => {
                    let read = with_file("npz", seed, Trajectory::read);
                    read.err().map(|e| e.to_string())
                }
                "history" => {
                    let read = with_file("csv", seed, read_history);
                    read.err().map(|e| e.to_string())
                }
                "scene" => {
                    let built = SceneFile::parse(text().to_owned(), path, &[])
                        .map_err(|e| e.to_string())
                        .and_then(|scene| scene.build().map_err(|e| e.to_string()));
                    built.err()
                }
                "svg" | "dxf" => {
                    let options = DrawingOptions::with_spacing(0.01);
                    let drawing = parse_drawing(seed, &path.with_extension(name), &options);
                    let drawn = drawing.map_err(|e| e.to_string());
                    let drawn =
                        drawn.and_then(|d| mesh_drawing(&d, &options).map_err(|e| e.to_string()));
                    drawn.err()
                }
                _ => {
                    let format = MeshFormat::of(&path.with_extension(name)).expect("a format");
                    let mesh = parse_mesh(seed, format, path, &MeshOptions::default());
                    mesh.err().map(|e| e.to_string())
                }
            };
            assert_eq!(refusal, None, "{name}, seed {k}");
        }
    }
}
