//! The command `isosheet`: simulates scenes, checks and repairs what they are made of.
//!
//! The program `isosheet` and the Python module of the same name are thin shells around [`run`].

mod acting;
mod action_scene;
mod action_verdict;
#[cfg(test)]
mod book_tests;
mod check;
mod collect;
mod composing;
mod convert;
mod crumple;
mod drape;
mod exit;
mod face_moments;
mod failure;
mod fit;
mod fold;
mod fold_options;
mod frames;
mod gallery;
mod given;
mod hang;
mod info;
mod interrupt;
mod layers;
mod live;
mod mesh;
mod message;
mod one_frame;
mod open;
mod page;
mod panels;
mod pictures;
mod printable;
mod progress;
mod reading;
mod rest;
mod simulate;
mod start;
mod strip;
mod sweep;
mod trace;
mod unroll;
mod workers;
mod write;

use clap::{CommandFactory, Parser, Subcommand};
use exit::EXIT_CODES;
use message::Verbosity;
use std::ffi::OsString;
use std::path::Path;

const EXAMPLES: &str = "\
Examples:
  isosheet new cloth --kind drape              write a scene to start from: cloth.toml
  isosheet fold crane.svg --open               fold a crease pattern, and look at it
  isosheet drape cloth.obj --on vase.obj       let a sheet fall on a body; also `hang` and `crumple`
  isosheet simulate cloth.toml --open          run it in the folder cloth-run, and open its 3D page
  isosheet rest cloth.toml                     find the shape that the sheet takes at rest
  isosheet info cloth-run                      say what came of it
  isosheet convert cloth-run cloth.usda        write it for Blender; .pvd for ParaView, .apng as a film ...
  isosheet sweep cloth.toml --over sheet.density=0.1,0.2
                                               run the scene with both values
  isosheet fit cloth.toml --rest --vary sheet.density=0.05..0.5 --to tip=-0.1
                                               find the density with which a measure ends at a value
  isosheet mesh box.svg -o box.fold --spacing 5mm
                                               make a mesh of a drawing, with its creases and cuts
  isosheet unroll cone.obj -o cone.svg         lay a mesh out in the plane, as a pattern to cut
  isosheet check cloth.toml                    say what is wrong with a scene or a mesh file";

/// Simulates sheets that bend and crease and do not stretch.
#[derive(Debug, Parser)]
#[command(name = "isosheet", version, before_help = EXAMPLES, after_help = EXIT_CODES)]
struct Cli {
    #[command(flatten)]
    verbosity: Verbosity,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene; continue it if a part of it is done, do nothing if it is complete
    Simulate(simulate::Simulate),
    /// Find the shape that the sheet of a scene takes at rest
    Rest(rest::RestArgs),
    /// Fold a crease pattern (FOLD, SVG, CP, OPX) without a scene file
    Fold(fold::Fold),
    /// Let the sheet of a mesh or a drawing fall on a table or a body, without a scene file
    Drape(drape::Drape),
    /// Hang the sheet of a mesh or a drawing by its corners, without a scene file
    Hang(hang::Hang),
    /// Crumple the sheet of a mesh or a drawing, without a scene file
    Crumple(crumple::Crumple),
    /// Play a scene in the browser while it is computed, and pull at its sheet
    Live(live::Live),
    /// Continue the run in a folder, with the scene that is stored there
    Resume(simulate::Resume),
    /// Run a scene with all combinations of some values, on all cores or by GNU parallel, Slurm or Snakemake
    Sweep(sweep::SweepArgs),
    /// Find values of keys with which the run of a scene ends as is asked for
    Fit(fit::FitArgs),
    /// Make one table of the summaries of runs and sweeps
    Collect(collect::Collect),
    /// Make the 3D page of a run, complete or not
    Page(page::Page),
    /// Make one page of many runs: pictures, key numbers and links to the pages that play them
    Gallery(gallery::GalleryArgs),
    /// Say what a scene or a mesh file is, what is wrong with it and how to repair it
    Check(check::Check),
    /// Say what came of a run, or what the sheet of a scene or a mesh file is like
    Info(info::Info),
    /// Convert a mesh file to another format, or a run to files of other programs
    Convert(convert::Convert),
    /// Make a triangle mesh of a drawing, with its creases, cuts and holes
    Mesh(mesh::MeshArgs),
    /// Lay a mesh out in the plane as a pattern to cut: a drawing in true size, with creases and rulings
    Unroll(unroll::Unroll),
    /// Write a commented scene to start from
    New(start::New),
    /// Print the completion script of a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// Does what a command line says, whose first word names the command, and returns the exit code. A sweep
/// starts `program`, which has to be this command too, for each of its runs.
///
/// Results go to standard output, everything else to standard error. Of what a process has only once, a call
/// takes over Ctrl-C and keeps how much is said: one command line is meant for one process.
///
/// ```
/// let words = ["isosheet", "info", "no-such-run"].map(Into::into);
/// assert_eq!(isosheet_io::run(words, "isosheet".as_ref()), 3); // a file cannot be read
/// ```
pub fn run(words: impl IntoIterator<Item = OsString>, program: &Path) -> u8 {
    let cli = match Cli::try_parse_from(words) {
        Ok(cli) => cli,
        Err(answer) => {
            // Nobody is left to be told that stdout is closed.
            let _ = answer.print();
            return answer.exit_code() as u8;
        }
    };
    cli.verbosity.choose();
    let done = match cli.command {
        Command::Simulate(simulate) => simulate.run(),
        Command::Rest(rest) => rest.run(),
        Command::Fold(fold) => fold.run(),
        Command::Drape(drape) => drape.run(),
        Command::Hang(hang) => hang.run(),
        Command::Crumple(crumple) => crumple.run(),
        Command::Live(live) => live.run(),
        Command::Resume(resume) => resume.run(),
        Command::Sweep(sweep) => sweep.run(program),
        Command::Fit(fit) => fit.run(),
        Command::Collect(collect) => collect.run(),
        Command::Page(page) => page.run(),
        Command::Gallery(gallery) => gallery.run(),
        Command::Check(check) => check.run(),
        Command::Info(info) => info.run(),
        Command::Convert(convert) => convert.run(),
        Command::Mesh(mesh) => mesh.run(),
        Command::Unroll(unroll) => unroll.run(),
        Command::New(new) => new.run(),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "isosheet", &mut script);
            write::to_stdout(&String::from_utf8_lossy(&script))
        }
    };
    done.map_or_else(|failure| exit::report(&failure), |()| 0)
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::CommandFactory;

    /// `-o, --out` is the one way to say where to write. `convert` has the file as its second word besides,
    /// as all converters have it.
    #[test]
    fn outputs_are_given_by_one_option() {
        for command in Cli::command().get_subcommands() {
            let name = command.get_name();
            for argument in command.get_arguments() {
                let is_out = argument.get_long() == Some("out");
                assert_eq!(
                    argument.get_short() == Some('o'),
                    is_out,
                    "{name}: {argument}"
                );
            }
            let words = command.get_positionals().filter(|word| !word.is_hide_set());
            let most = if name == "convert" { 2 } else { 1 };
            assert!(words.count() <= most, "{name}");
        }
    }
}
