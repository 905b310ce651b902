//! The program of the 3D page of a run: `io/view/dist` is built from `io/view/src` by npm and esbuild.
//!
//! The built files are part of the repository, so that nobody needs npm who does not change the page.

use anyhow::{Context, bail, ensure};
use clap::Args;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The files that are built.
const FILES: [&str; 3] = ["view.js", "view.css", "LICENSES.txt"];

/// Arguments of `bundle-view`.
#[derive(Debug, Args)]
pub(crate) struct BundleViewArgs {
    /// Change nothing; fail if io/view/dist is not what the sources and the lock file make
    ///
    /// Says so and succeeds where npm is missing or the registry does not answer.
    #[arg(long)]
    pub(crate) check: bool,
}

/// Builds the files anew, or checks that they are what the sources and the lock file make.
pub(crate) fn run(args: &BundleViewArgs) -> anyhow::Result<()> {
    let folder = sources()?;
    check_lock(&folder.join("package-lock.json"))?;
    if args.check {
        if let Some(reason) = why_not() {
            println!("skipped: {reason}, so the program of the 3D page was not built");
            return Ok(());
        }
        install(&folder)?;
        let built = tempfile::tempdir().context("cannot create a temporary folder")?;
        build(&folder, built.path())?;
        compare(&folder.join("dist"), built.path())?;
        println!("io/view/dist is what its sources and its lock file make");
    } else {
        install(&folder)?;
        build(&folder, &folder.join("dist"))?;
        println!("built {} in io/view/dist", FILES.join(", "));
    }
    Ok(())
}

/// The folder of the page's sources.
fn sources() -> anyhow::Result<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../io/view");
    folder
        .canonicalize()
        .with_context(|| format!("cannot find {}", folder.display()))
}

/// Checks that the lock file names packages by their checksums, and no address that they came from.
fn check_lock(lock: &Path) -> anyhow::Result<()> {
    let text =
        fs::read_to_string(lock).with_context(|| format!("cannot read {}", lock.display()))?;
    ensure!(
        !text.contains("\"resolved\""),
        "{} has addresses of a registry; make it again with the settings in io/view/.npmrc",
        lock.display()
    );
    Ok(())
}

/// Why the files cannot be built here: npm is missing, or the registry does not answer.
fn why_not() -> Option<&'static str> {
    let quiet = |command: &mut Command| {
        let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    if !quiet(Command::new("npm").arg("--version")) {
        Some("npm is not installed")
    } else if !quiet(Command::new("npm").args([
        "ping",
        "--fetch-retries=0",
        "--fetch-timeout=10000",
    ])) {
        Some("the npm registry does not answer")
    } else {
        None
    }
}

/// Installs what the lock file says. No script of a package is run.
fn install(folder: &Path) -> anyhow::Result<()> {
    execute(
        Command::new("npm").args(["ci", "--ignore-scripts", "--loglevel=error"]),
        folder,
    )
}

fn build(folder: &Path, out: &Path) -> anyhow::Result<()> {
    execute(
        Command::new("node")
            .args(["build.mjs", "--outdir"])
            .arg(out),
        folder,
    )
}

fn execute(command: &mut Command, folder: &Path) -> anyhow::Result<()> {
    let program = command.get_program().to_string_lossy().into_owned();
    let status = command
        .current_dir(folder)
        .status()
        .with_context(|| format!("cannot start {program}; install Node.js 20 or newer"))?;
    if !status.success() {
        bail!("{program} failed ({status}); its messages are above");
    }
    Ok(())
}

/// Checks that the files of two folders are the same to the byte.
fn compare(committed: &Path, built: &Path) -> anyhow::Result<()> {
    for file in FILES {
        let read = |folder: &Path| {
            let path = folder.join(file);
            fs::read(&path).with_context(|| format!("cannot read {}", path.display()))
        };
        ensure!(
            read(committed)? == read(built)?,
            "io/view/dist/{file} is not what the sources make; run `cargo xtask bundle-view`"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with the three files, `text` in each.
    fn folder(text: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in FILES {
            fs::write(folder.path().join(file), text).unwrap();
        }
        folder
    }

    #[test]
    fn the_lock_file_has_no_addresses() {
        check_lock(&sources().unwrap().join("package-lock.json")).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let lock = folder.path().join("package-lock.json");
        fs::write(&lock, r#"{ "resolved": "https://example.org/three.tgz" }"#).unwrap();
        let error = check_lock(&lock).unwrap_err().to_string();
        assert!(error.contains("addresses"), "{error}");
    }

    #[test]
    fn a_difference_names_the_file() {
        let (committed, built) = (folder("a"), folder("a"));
        compare(committed.path(), built.path()).unwrap();
        fs::write(built.path().join("view.css"), "b").unwrap();
        let error = compare(committed.path(), built.path())
            .unwrap_err()
            .to_string();
        assert!(error.contains("dist/view.css"), "{error}");
        fs::remove_file(committed.path().join("view.js")).unwrap();
        let error = compare(committed.path(), built.path())
            .unwrap_err()
            .to_string();
        assert!(error.contains("view.js"), "{error}");
    }
}
