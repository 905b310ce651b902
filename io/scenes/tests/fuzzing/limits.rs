//! Files within limits of memory and time, each in a process of its own: damaged ones of every format, and
//! small ones that stand for much.
//!
//! A process may take what a valid file takes, and 64 MiB and a hundred times the length of its file besides.
//! Its time on the processor ends a case that would not end by itself.

use crate::targets::{TARGETS, target};
use crate::{ALONE, bombs, folder, mutation, seeds};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::PoisonError;

/// Damaged files of each target in `cargo test`.
const CASES: u32 = 4;

/// Small files that stand for much, of each kind in `cargo test`.
const BOMBS: u32 = 1;

/// Seconds of the processor that a case may take: a hundred times what the slowest one takes on a slow
/// machine.
const SECONDS: u32 = 60;

/// Kibibytes that any case may take besides what a valid file takes.
const LEAST: u64 = 64 << 10;

/// Bytes for each byte of a file.
const TIMES: u64 = 100;

/// The variables that say to the process of a case which target is run with which file.
const TARGET: &str = "ISOSHEET_LIMITED_TARGET";
const FILE: &str = "ISOSHEET_LIMITED_FILE";

/// What the process of a case does; nothing in a run of all tests.
#[test]
fn one_file() {
    let (Ok(name), Ok(path)) = (std::env::var(TARGET), std::env::var(FILE)) else {
        return;
    };
    target(&name)(&fs::read(path).expect("the file of the case"));
    println!("peak: {} kB", peak().unwrap_or(0));
}

/// The largest address space that this process has had, KiB, where the system says it as Linux does.
fn peak() -> Option<u64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("VmPeak:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

/// Runs a target with a file, within a number of KiB if one is given.
fn run(name: &str, path: &Path, limit: Option<u64>) -> Output {
    let memory = limit.map_or("unlimited".to_owned(), |kibibytes| kibibytes.to_string());
    let limited = r#"ulimit -c 0; ulimit -v "$1" && ulimit -t "$2" && shift 2 && exec "$@""#;
    Command::new("sh")
        .args(["-c", limited, "sh", &memory, &SECONDS.to_string()])
        .arg(std::env::current_exe().expect("the test has a path"))
        .args([
            "--exact",
            "limits::one_file",
            "--nocapture",
            "--test-threads=1",
        ])
        .env(TARGET, name)
        .env(FILE, path)
        .env("RAYON_NUM_THREADS", "1")
        .env("RUST_BACKTRACE", "0")
        .output()
        .expect("there is a shell")
}

/// What a case does that no case may do.
fn fault(name: &str, data: &[u8], base: u64) -> Option<String> {
    let path = folder(name).join("limited");
    fs::write(&path, data).expect("the build folder can be written");
    let limit = base + LEAST + TIMES * data.len() as u64 / 1024;
    let output = run(name, &path, Some(limit));
    if output.status.success() {
        return None;
    }
    let kept = folder("limits").join(format!("{name}-{:08x}", crc(data)));
    fs::rename(&path, &kept).expect("the build folder can be written");
    let said = String::from_utf8_lossy(&output.stderr);
    let said = said.lines().filter(|line| !line.is_empty()).take(3);
    Some(format!(
        "{name}, {} bytes, {limit} KiB, {SECONDS} s: {}, {}; the file is {}",
        data.len(),
        output.status,
        said.collect::<Vec<_>>().join(" "),
        kept.display()
    ))
}

fn crc(data: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(data)
}

/// The KiB that a valid file of a target takes.
fn base(name: &str) -> u64 {
    let path = folder(name).join("limited");
    let peak = |seed: &Vec<u8>| -> u64 {
        fs::write(&path, seed).expect("the build folder can be written");
        let said = run(name, &path, None).stdout;
        let said = String::from_utf8_lossy(&said);
        let peak = said
            .split_once("peak: ")
            .and_then(|(_, rest)| rest.split_once(" kB"));
        peak.map_or(0, |(kibibytes, _)| kibibytes.parse().expect("a number"))
    };
    seeds(name).iter().map(peak).max().unwrap_or(0)
}

#[test]
fn damaged_files_stay_within_limits() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    if peak().is_none() {
        println!("skipped: the system does not say what memory a process has");
        return;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(isosheet_random::seed());
    let only = std::env::var("ISOSHEET_FUZZ_TARGET").ok();
    let names = TARGETS.map(|(name, _)| name).into_iter();
    let (mut count, mut faults) = (0, Vec::new());
    for name in names.filter(|name| only.as_deref().is_none_or(|only| only == *name)) {
        let (seeds, base) = (seeds(name), base(name));
        let mut files = Vec::new();
        for _ in 0..CASES * isosheet_random::times() {
            files.push(mutation::mutate(&seeds, &mut rng));
        }
        for _ in 0..BOMBS * isosheet_random::times() {
            files.extend(bombs::of(name, &mut rng));
        }
        count += files.len();
        faults.extend(files.iter().filter_map(|data| fault(name, data, base)));
    }
    println!("{count} files, {} beyond their limits", faults.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
