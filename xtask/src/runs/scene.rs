//! The scenes of the figures: files of the folder `xtask/scenes`, which `isosheet simulate` runs too.

use anyhow::{Context, Result};
use isosheet_mesh::Sheet;
use isosheet_scenes::{MaterialKey, Scene, SceneFile, Setup, StartingPoint};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use toml_edit::DocumentMut;

/// The folder of the files.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");

/// A scene, and the name of the folder that its run is kept in.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FigureScene {
    name: String,
    file: SceneFile,
}

impl FigureScene {
    /// A file of `xtask/scenes` (without `.toml`) with edits `key=value`, as `isosheet simulate --set` makes
    /// them.
    ///
    /// # Errors
    /// A file that is not there, edits that make no sense.
    pub(crate) fn of(file: &str, name: &str, edits: &[String]) -> Result<Self> {
        let path = Path::new(FOLDER).join(file).with_extension("toml");
        Ok(Self {
            name: name.to_owned(),
            file: SceneFile::read(&path, edits)?,
        })
    }

    /// A scene that `isosheet new` writes if there is one of that kind, or else a file of `xtask/scenes`,
    /// with edits.
    ///
    /// # Errors
    /// As [`FigureScene::of`].
    pub(crate) fn named(file: &str, name: &str, edits: &[String]) -> Result<Self> {
        let Some(start) = StartingPoint::ALL.iter().find(|start| start.name() == file) else {
            return Self::of(file, name, edits);
        };
        let path = Path::new(file).with_extension("toml");
        Ok(Self {
            name: name.to_owned(),
            file: SceneFile::parse(start.text().to_owned(), &path, edits)?,
        })
    }

    /// This scene under another name, with edits.
    ///
    /// # Errors
    /// Edits that make no sense.
    pub(crate) fn edited(&self, name: &str, edits: &[String]) -> Result<Self> {
        let text = self.file.text();
        Ok(Self {
            name: name.to_owned(),
            file: SceneFile::parse(text.text.clone(), &text.path, edits)?,
        })
    }

    /// This scene with an elastic sheet of a named material in place of rods. The material brings its own
    /// mass.
    ///
    /// # Errors
    /// A name that no material has.
    pub(crate) fn made_of(&self, material: &str) -> Result<Self> {
        let suffix = material.replace(' ', "-").to_lowercase();
        self.with_sheet(format!("{}-{suffix}", self.name), |sheet| {
            for key in ["mass", "density"] {
                sheet.remove(key);
            }
            sheet["material"] = toml_edit::value(material);
            Ok(())
        })
    }

    /// This scene with a sheet at rest whose vertices are displaced in its plane by random vectors of up to
    /// `part` mean edge lengths in each direction, under another name: a mesh without straight lines of
    /// edges.
    ///
    /// # Errors
    /// A displacement that turns a triangle over.
    pub(crate) fn jittered(&self, name: &str, part: f64, seed: u64) -> Result<Self> {
        let sheet = self.sheet()?;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let reach = part * sheet.mean_length();
        let mut positions = sheet.positions().as_chunks::<3>().0.to_vec();
        for [x, y, _] in &mut positions {
            for coordinate in [x, y] {
                *coordinate += reach * random.random_range(-1.0..=1.0);
            }
        }
        let triangles = json!({ "vertices": positions, "faces": sheet.face_indices() });
        let mesh = toml::Value::try_from(json!({ "triangles": triangles }))?;
        self.edited(name, &[format!("sheet.mesh={mesh}")])
    }

    /// This scene with a change of its one table `[sheet]`, under another name.
    fn with_sheet(
        &self,
        name: String,
        change: impl FnOnce(&mut toml_edit::Table) -> Result<()>,
    ) -> Result<Self> {
        let text = self.file.text();
        let mut document: DocumentMut = text.text.parse()?;
        let sheet = document["sheet"].as_table_mut();
        change(sheet.context("the scene has not one table [sheet]")?)?;
        let file = SceneFile::parse(document.to_string(), &text.path, &[])?;
        Ok(Self { name, file })
    }

    /// What the sheet is made of, in words.
    pub(crate) fn sheet_name(&self) -> &str {
        match &self.scene().sheet[0].material {
            Some(MaterialKey::Named(name)) => name,
            Some(MaterialKey::Plate(_)) => "plate",
            None => "rods",
        }
    }

    /// Name of the folder of the run.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn scene(&self) -> &Scene {
        self.file.scene()
    }

    /// The value of a key of the scene, given as a JSON pointer such as `/sheet/density`.
    ///
    /// # Errors
    /// A key that the scene does not have, a value of another kind.
    pub(crate) fn value<T: DeserializeOwned>(&self, key: &str) -> Result<T> {
        let scene = serde_json::to_value(self.scene())?;
        let value = scene.pointer(key).cloned();
        let value = value.with_context(|| format!("{} has no {key}", self.name))?;
        serde_json::from_value(value).with_context(|| format!("{key} of {}", self.name))
    }

    /// The scene file for runs whose page the figure writes.
    ///
    /// # Errors
    /// None that is known.
    pub(crate) fn without_page(&self) -> Result<SceneFile> {
        let text = self.file.text();
        let edits = ["output.page=false".to_owned()];
        Ok(SceneFile::parse(text.text.clone(), &text.path, &edits)?)
    }

    /// The text of the scene file with its edits.
    pub(crate) fn text(&self) -> &str {
        &self.file.text().text
    }

    /// Everything that decides how the run goes.
    pub(crate) fn options(&self) -> Value {
        json!({ "name": self.name, "scene": self.text() })
    }

    /// Time between frames, which are the steps, seconds.
    pub(crate) fn frame(&self) -> f64 {
        self.scene().method.step
    }

    /// Number of frames after the first, unless the run ends before.
    pub(crate) fn frames(&self) -> usize {
        (self.scene().stop.time / self.frame()).round() as usize
    }

    /// Everything that a simulation is made of.
    ///
    /// # Errors
    /// Values of which no simulation can be made.
    pub(crate) fn setup(&self) -> Result<Setup> {
        Ok(self.file.build()?)
    }

    /// The sheet at rest, placed in space.
    ///
    /// # Errors
    /// As [`FigureScene::setup`].
    pub(crate) fn sheet(&self) -> Result<Sheet> {
        Ok(self.setup()?.sheet.clone())
    }
}

/// A number that changes with the files of the folder: what is made of their scenes is not up to date then.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn scene_fingerprint() -> Result<u64> {
    let files = fs::read_dir(FOLDER)?.map(|file| Ok(file?.path()));
    let mut files = files.collect::<Result<Vec<_>>>()?;
    files.retain(|file| file.extension().is_some_and(|e| e == "toml"));
    files.sort();
    let mut hasher = DefaultHasher::new();
    for file in &files {
        (file.file_name(), fs::read(file)?).hash(&mut hasher);
    }
    Ok(hasher.finish())
}

/// The edit by which each start of a scene has other random displacements, as a part of the mean edge length.
pub(crate) fn displaced(perturbation: f64, seed: u64) -> String {
    format!("sheet.start={{perturbation={perturbation:?},seed={seed}}}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_folder_makes_a_simulation() {
        let entries = fs::read_dir(FOLDER).unwrap().map(|e| e.unwrap().path());
        for path in entries.filter(|path| path.is_file()) {
            let name = path.file_stem().unwrap().to_str().unwrap();
            let scene = FigureScene::of(name, name, &[]).unwrap();
            assert!(scene.setup().unwrap().start().is_ok(), "{name}");
            // What `isosheet simulate` shows is what the figures show: every step.
            let output = &scene.scene().output;
            assert_eq!(output.steps_per_frame(scene.frame()), 1, "{name}");
            let rest = &scene.scene().stop.rest;
            assert!(rest.is_none(), "figures show all of {name}");
        }
    }

    /// Whatever mass its rods have, a material brings its own.
    #[test]
    fn a_material_takes_the_place_of_rods() {
        for file in ["fig12", "fig14", "fig15-rings"] {
            let rods = FigureScene::of(file, file, &[]).unwrap();
            let elastic = rods.made_of("PET film").unwrap();
            let names = (
                elastic.name().to_owned(),
                elastic.sheet_name(),
                rods.sheet_name(),
            );
            assert_eq!(names, (format!("{file}-pet-film"), "PET film", "rods"));
            let setup = elastic.setup().unwrap();
            assert!(setup.model.elastic_sheet().is_some());
            let mass: f64 = setup.model.mass().vertex.iter().sum();
            assert!(
                (mass / setup.sheet.area() / 0.139 - 1.0).abs() < 1e-9,
                "{file}"
            );
        }
    }
}
