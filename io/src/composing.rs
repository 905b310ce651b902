//! What commands share that compose their scene themselves.

use super::failure::{Code, Done, Failure, Format, Message};
use super::message::{print_message, print_result};
use super::progress::event;
use super::simulate::{How, default_folder, existing};
use clap::Args;
use isosheet_drawings::Length;
use isosheet_dynamics::Material;
use isosheet_files::{FileError, write_atomically};
use isosheet_mesh::Advice;
use isosheet_runs::{Recording, check_folder, check_run};
use isosheet_scenes::SceneFile;
use serde_json::json;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// How a scene that a command composes is made and run.
#[derive(Debug, Args)]
pub(super) struct Composing {
    /// The folder to write to [default: the name of the first file with `-run`, in the current folder]
    #[arg(short, long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
    /// The folder, as commands had it up to version 0.1
    #[arg(hide = true, value_name = "OUT", conflicts_with = "out", value_parser = folder)]
    old_out: Option<PathBuf>,
    /// What the sheet is made of: a name of the page "Materials" of the book [default: see below]
    #[arg(long, value_name = "NAME", value_parser = material)]
    material: Option<String>,
    /// The longest side of the sheet, such as 200mm; metres without a unit [default: see below]
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    size: Option<f64>,
    /// Write the scene to a file, which `isosheet simulate` runs again
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Delete the run that the folder holds before, and replace the scene of `--scene`
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    how: How,
}

/// The name of a material.
fn material(text: &str) -> Result<String, String> {
    let found = Material::named(text).map(|_| text.to_owned());
    found.map_err(|e| e.with_advice())
}

/// The folder of a run, which has no name of a scene: `-o` named the file of the scene up to version 0.1.
fn folder(text: &str) -> Result<PathBuf, String> {
    match text.ends_with(".toml") {
        true => Err("this is the folder of the run: `--scene FILE` writes the scene".to_owned()),
        false => Ok(text.into()),
    }
}

/// A length in metres: with its unit, or in metres if it is shorter than ten. (Whoever writes 200 means
/// millimetres.)
pub(super) fn length(text: &str) -> Result<f64, String> {
    let Length { metres } = text.parse()?;
    let is_bare = text.trim().parse::<f64>().is_ok();
    match metres {
        10.0.. if is_bare => Err(format!(
            "without a unit this is {text} metres: write {text}mm or {text}m"
        )),
        1e-4..=1e3 => Ok(metres),
        _ => Err("give a length from 0.1mm to 1000m, such as 200mm".to_owned()),
    }
}

/// The place of a scene for a file that is not written: its paths are relative to that, and no file has its
/// name.
pub(super) fn unwritten(of: &Path) -> PathBuf {
    let name = of.file_name().unwrap_or_default().to_string_lossy();
    of.with_file_name(format!("<scene of {name}>"))
}

/// How a scene names a file: by its name where both are in one folder, and otherwise by its whole path.
pub(super) fn named_from(scene: &Path, file: &Path) -> Result<PathBuf, Failure> {
    if let Some(name) = file.file_name()
        && scene.parent() == file.parent()
    {
        return Ok(name.into());
    }
    let whole = std::path::absolute(file);
    whole.map_err(|e| Failure::of(Code::Input, &FileError::unreadable(file, e)))
}

/// A scene by its text, as if it were in a file.
pub(super) fn parsed(at: &Path, text: String) -> Result<SceneFile, Failure> {
    Ok(SceneFile::parse(text, at, &[])?)
}

impl Composing {
    pub(super) fn format(&self) -> Format {
        self.how.format()
    }

    /// The material, or the one of a command.
    pub(super) fn material_or(&self, default: &str) -> String {
        self.material.clone().unwrap_or_else(|| default.to_owned())
    }

    /// The longest side of the sheet, if it was asked for, metres.
    pub(super) fn size(&self) -> Option<f64> {
        self.size
    }

    /// The folder of the run of a file.
    fn folder(&self, of: &Path) -> PathBuf {
        let given = self.out.as_ref().or(self.old_out.as_ref());
        given.cloned().unwrap_or_else(|| default_folder(of, "run"))
    }

    /// Gets ready, and refuses what would be refused after the work: a folder in which nothing can be
    /// written, and a scene file among the files of the run.
    pub(super) fn begin(&self, of: &Path) -> Done {
        let folder = self.folder(of);
        if let Some(scene) = &self.scene {
            let [inner, outer] = [scene, &folder].map(std::path::absolute);
            if let (Ok(inner), Ok(outer)) = (inner, outer)
                && inner.starts_with(&outer)
            {
                let message = format!(
                    "{} is in the folder of the run, {}",
                    scene.display(),
                    folder.display()
                );
                return Err(Failure::misuse(message).remedy(
                    "write the scene to another folder; the folder of the run has a copy, `scene.toml`",
                ));
            }
        }
        if let Some(scene) = self.scene.as_deref().filter(|scene| scene.exists()) {
            SceneFile::read(scene, &[]).map_err(|_| {
                let message = format!("{} is a file that is no scene", scene.display());
                Failure::misuse(message).remedy("give the scene another name, or remove the file")
            })?;
        }
        check_folder(&folder)?;
        if let Some(old) = &self.old_out {
            print_message(format_args!(
                "warning: the folder is given without its option, which the next version refuses\n  = help: write `--out {}`",
                old.display()
            ));
        }
        self.how.prepare()
    }

    /// Refuses what would be refused once one of some scenes is chosen: a folder that holds the run of
    /// another one, and a scene file of another one.
    pub(super) fn begin_one_of(&self, of: &Path, texts: &[String]) -> Done {
        self.begin(of)?;
        self.check_scene_file(texts)?;
        let scenes = texts
            .iter()
            .map(|text| parsed(&self.scene_path(of), text.clone()));
        let scenes: Vec<SceneFile> = scenes.collect::<Result<_, _>>()?;
        Ok(check_run(&self.folder(of), &scenes, existing(self.force))?)
    }

    /// Refuses to replace a scene by one of these texts unless it is one of them, or that was asked for.
    fn check_scene_file(&self, texts: &[String]) -> Done {
        let old = self.scene.as_ref().filter(|_| !self.force);
        let Some((scene, old)) = old.and_then(|s| Some((s, fs::read_to_string(s).ok()?))) else {
            return Ok(());
        };
        if texts.contains(&old) {
            return Ok(());
        }
        let message = format!("{} is another scene", scene.display());
        Err(Failure::misuse(message)
            .remedy("give the scene another name, or replace it with --force"))
    }

    /// How the scene of a file names another file.
    pub(super) fn named_from_scene(&self, of: &Path, file: &Path) -> Result<PathBuf, Failure> {
        named_from(&self.scene_path(of), file)
    }

    /// The file of the scene.
    pub(super) fn scene_path(&self, of: &Path) -> PathBuf {
        self.scene.clone().unwrap_or_else(|| unwritten(of))
    }

    /// Writes the scene if that was asked for, runs it, and says what came of it in the words of `verdict`.
    pub(super) fn run(
        &self,
        of: &Path,
        text: String,
        verdict: impl FnOnce(&Recording) -> Option<String>,
    ) -> Done {
        let file = parsed(&self.scene_path(of), text.clone());
        let file = file.map_err(|failure| self.naming_scene(failure))?;
        if let Some(scene) = &self.scene {
            self.check_scene_file(std::slice::from_ref(&text))?;
            write_atomically(scene, |w| w.write_all(text.as_bytes()))
                .map_err(|e| Failure::of(Code::Output, &e))?;
        }
        let folder = self.folder(of);
        let ran = self.how.show_scene(&file, &folder, existing(self.force));
        ran.map_err(|failure| self.naming_scene(failure))?;
        let words = verdict(&Recording::read(&folder)?);
        if self.format() == Format::Json {
            event(&json!({ "event": "verdict", "text": words, "scene": self.scene }));
            return Ok(());
        }
        // Warnings name its keys.
        let own = folder.join("scene.toml");
        let scene = self.scene.as_ref().unwrap_or(&own);
        print_result(format_args!("scene: {}", scene.display()))?;
        match words {
            Some(words) => print_result(format_args!("{words}")),
            None => Ok(()),
        }
    }

    /// A failure that names keys of the scene, with where these keys are.
    fn naming_scene(&self, failure: Failure) -> Failure {
        match (&failure.message, &self.scene) {
            (Message::Scene(_), Some(scene)) => {
                let scene = scene.display();
                failure.remedy(format!(
                    "these keys are in {scene}: edit it, and run it by `isosheet simulate {scene}`"
                ))
            }
            (Message::Scene(_), None) => failure.remedy(
                "these keys are in the scene: write it by `--scene FILE`, edit it, and run it by `isosheet simulate FILE`",
            ),
            _ => failure,
        }
    }
}
