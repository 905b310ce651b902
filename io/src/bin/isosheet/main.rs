//! The program `isosheet`, see [`isosheet_io`].

mod commit;

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(commit) = commit::commit() {
        isosheet_runs::note_commit(commit);
    }
    let program = std::env::current_exe().unwrap_or_else(|_| PathBuf::from("isosheet"));
    isosheet_io::run(std::env::args_os(), &program).into()
}
