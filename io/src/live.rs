//! `isosheet live`.

mod access;
mod answer;
mod board;
mod clock;
mod message;
mod page;
mod player;
mod request;
mod server;
mod session;
mod slider;

use super::composing::unwritten;
use super::failure::{Code, Done, Failure};
use super::fold_options::FoldOptions;
use super::interrupt;
use super::message::print_result;
use super::open::open_address;
use super::panels::{Pattern, text_of};
use super::simulate::use_threads;
use access::{Access, random_text};
use board::Board;
use clap::Args;
use isosheet_formats::MeshFormat;
use isosheet_scenes::SceneFile;
use player::{Ended, Player};
use server::{Server, Shared, listen};
use session::Session;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::sync::{Arc, Mutex};

const EXAMPLES: &str = "\
Examples:
  isosheet live cloth.toml                       play a scene in the browser, and pull at its sheet
  isosheet live crane.svg                        fold a crease pattern, and pull at it
  isosheet live crane.svg --part 0.8 --contact   fold it to four fifths of its angles, with panels that touch
  isosheet live flag.toml --set stop.time=60     play it for a minute before it pauses";

const NOTES: &str = "\
The page is that of a run, with the 3D view and the plots. It shows the run as it goes: play, pause, single steps;
a vertex that the mouse holds is pulled by a spring; sliders drive the wind and all motions, angles and loads that
the scene names. Play is never faster than real time, and the page says how fast it is.

The page is served to this machine alone (127.0.0.1), to whoever has the address with its random token. The first
page steers, all others watch. The run waits while no page is open, and pauses at the time `stop.time` of the
scene; play goes on beyond it. Other conditions to stop and `output` of the scene are not used, and no folder is
written: `isosheet simulate` does that. Ctrl-C, or `End` in the page, ends the run.";

/// Play a scene in the browser while it is computed
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = NOTES)]
pub(crate) struct Live {
    /// The scene file, or a crease pattern (FOLD, SVG, CP, OPX), which is folded as `isosheet fold` does
    scene: PathBuf,
    /// Change a key of the scene, for example `method.step=0.005` or `obstacle[0].friction=0.3`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    edits: Vec<String>,
    #[command(flatten)]
    options: FoldOptions,
    /// Do not open the page in a browser, only print its address
    #[arg(long)]
    no_open: bool,
    /// The port of the page [default: one that is free]
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true
    )]
    port: u16,
    /// Number of threads, at most 1024; the results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = super::simulate::threads())]
    threads: u16,
}

impl Live {
    /// The scene of the file: the one that folds it, if it is a crease pattern.
    fn scene(&self) -> Result<SceneFile, Failure> {
        let is_pattern = MeshFormat::of(&self.scene)
            .is_some_and(|format| format == MeshFormat::Fold || format.is_drawing());
        if !is_pattern {
            if let Some(option) = self.options.given() {
                let message = format!(
                    "{option} is for crease patterns, and {} is none",
                    self.scene.display()
                );
                let remedy = "change keys of the scene, for example `--set folding.part=0.5`";
                return Err(Failure::misuse(message).remedy(remedy));
            }
            return Ok(SceneFile::read(&self.scene, &self.edits)?);
        }
        let pattern = Pattern {
            file: &self.scene,
            scene: unwritten(&self.scene),
        };
        let (scene, facts) = pattern.rigid(self.options.frame, None)?;
        let scene = self.options.of(scene, facts.sharpest)?;
        let scene = pattern.chosen(scene)?.scene;
        Ok(SceneFile::parse(
            text_of(&scene)?,
            &pattern.scene,
            &self.edits,
        )?)
    }

    pub(crate) fn run(&self) -> Done {
        interrupt::install()?;
        use_threads(self.threads)?;
        let scene = self.scene()?;
        let session = Session::start(scene)?;
        let failed = |e: io::Error| {
            let failure = Failure::new(Code::Output, format!("cannot serve the page: {e}"));
            failure.remedy("choose another port with `--port`, or none for one that is free")
        };
        let random = || random_text().map_err(|e| failed(e.into()));
        let (token, nonce) = (random()?, random()?);
        let title = self.scene.file_stem().unwrap_or_default();
        let page = page::page(&session, &title.to_string_lossy(), &nonce);
        let page = page.map_err(|e| Failure::of(Code::Input, &e))?;
        let listener = listen(self.port).map_err(failed)?;
        let port = listener.local_addr().map_err(failed)?.port();
        let access = Access::new(token, port);
        let address = access.address();
        let (sender, commands) = mpsc::channel();
        let board = Arc::new(Board::default());
        let end_is_asked = Arc::new(AtomicBool::new(false));
        let shared = Shared {
            access,
            page,
            policy: answer::policy(&nonce),
            board: board.clone(),
            commands: sender,
            end_is_asked: end_is_asked.clone(),
            answering: AtomicUsize::new(0),
            waiting: Mutex::default(),
        };
        let server = Server::start(listener, shared).map_err(failed)?;
        print_result(format_args!("page: {address}\nCtrl-C ends the run"))?;
        // Deleted at the end.
        let _door = match self.no_open {
            true => None,
            false => open_address(&address),
        };
        let player = Player {
            session,
            board: &board,
            commands,
            is_over: &interrupt::requested,
            end_is_asked: &|| end_is_asked.load(Ordering::SeqCst),
        };
        let ended = player.play();
        server.end();
        match ended {
            Ended::ByPage => print_result(format_args!("ended by the page")),
            Ended::ByProcess => print_result(format_args!("ended by Ctrl-C")),
        }
    }
}
