//! Finds git's log of HEAD for the commit in summaries, as the program `isosheet` does.

#[path = "../build.rs"]
mod log;

fn main() {
    log::main();
}
