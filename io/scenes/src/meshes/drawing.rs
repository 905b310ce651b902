//! Drawings as meshes of a scene.

use crate::meshes::foreign;
use crate::meshes::mesh_file::Files;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_drawings::{
    DrawingOptions, DrawingUnit, LineClass, LineRules, Selector, parse_drawing,
};
use isosheet_files::FileError;
use isosheet_formats::{DrawingError, DrawnSheet, mesh_drawing};
use isosheet_mesh::plane::PlaneError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A sheet in a drawing, as `isosheet mesh` makes it. Lines are selected by `"layer:NAME"`, by a colour,
/// `"red"` or `"#ff8000"`, or by `"dashed"` and `"solid"`; other lines go by the words in the name of their
/// layer, then by their colour as in Origami Simulator.
///
/// ```toml
/// [sheet]
/// mesh = { drawing = { path = "box.svg", spacing = 0.005, cut = ["black"], valley = ["layer:creases"] } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct DrawingFile {
    /// Path of the drawing (.svg, .dxf), relative to the scene file.
    pub path: PathBuf,
    /// Length of the edges, about, metres.
    pub spacing: f64,
    /// Ends of lines that are at most so far apart are joined, metres. If left out, a ten-thousandth of the
    /// diagonal of the drawing.
    #[serde(default)]
    pub snap: Option<f64>,
    /// The unit of the drawing. If left out, the unit that the file names.
    #[serde(default)]
    #[schemars(with = "Option<foreign::DrawingUnit>")]
    pub unit: Option<DrawingUnit>,
    /// The drawing is made larger by this factor.
    #[serde(default = "one")]
    pub scale: f64,
    /// Lines where the sheet ends or is cut.
    #[serde(default)]
    pub cut: Vec<String>,
    /// Lines where it folds to either side: `[[crease]]` has them as the pattern `unassigned`.
    #[serde(default)]
    pub crease: Vec<String>,
    /// Lines where it folds away from the viewer.
    #[serde(default)]
    pub mountain: Vec<String>,
    /// Lines where it folds towards the viewer.
    #[serde(default)]
    pub valley: Vec<String>,
    /// Lines that edges follow, and that stay flat.
    #[serde(default)]
    pub flat: Vec<String>,
    /// Lines that are left out.
    #[serde(default)]
    pub ignore: Vec<String>,
    /// Another number gives another triangulation.
    #[serde(default)]
    pub seed: u64,
}

/// Refuses words that select no lines of any drawing.
pub(crate) fn check_lines(list: &[String], key: &Key, checks: &mut Checks) {
    for (k, text) in list.iter().enumerate() {
        if let Err(problem) = text.parse::<Selector>() {
            let remedy = "name a layer, a colour or dashes";
            checks.report(key.entry(k), problem, remedy);
        }
    }
}

fn one() -> f64 {
    1.0
}

impl DrawingFile {
    /// A drawing whose mesh has edges of about a length, metres.
    pub fn new(path: impl Into<PathBuf>, spacing: f64) -> Self {
        Self {
            path: path.into(),
            spacing,
            snap: None,
            unit: None,
            scale: one(),
            cut: Vec::new(),
            crease: Vec::new(),
            mountain: Vec::new(),
            valley: Vec::new(),
            flat: Vec::new(),
            ignore: Vec::new(),
            seed: 0,
        }
    }

    fn lists(&self) -> [(&'static str, &[String], LineClass); 6] {
        [
            ("cut", &self.cut, LineClass::Cut),
            ("crease", &self.crease, LineClass::Crease),
            ("mountain", &self.mountain, LineClass::Mountain),
            ("valley", &self.valley, LineClass::Valley),
            ("flat", &self.flat, LineClass::Flat),
            ("ignore", &self.ignore, LineClass::Ignored),
        ]
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("spacing"), self.spacing, Unit::Metre);
        checks.positive(key.name("snap"), self.snap, Unit::Metre);
        checks.positive(key.name("scale"), self.scale, Unit::Metre);
        checks.count(key.name("seed"), self.seed, 0);
        if self.path.as_os_str().is_empty() {
            checks.report(key.name("path"), "the path is empty", "name a drawing");
        }
        for (name, list, _) in self.lists() {
            check_lines(list, &key.name(name), checks);
        }
    }

    fn options(&self) -> DrawingOptions {
        // Selectors that cannot be read were refused.
        let selectors = self.lists().into_iter().flat_map(|(_, list, class)| {
            let selectors = list.iter().filter_map(|text| text.parse::<Selector>().ok());
            selectors.map(move |s| (s, class))
        });
        DrawingOptions {
            snap: self.snap,
            unit: self.unit,
            scale: self.scale,
            rules: LineRules {
                selectors: selectors.collect(),
            },
            seed: self.seed,
            ..DrawingOptions::with_spacing(self.spacing)
        }
    }

    /// The sheet; `key` is the place of the drawing in the scene.
    pub(crate) fn sheet(&self, key: &Key, files: &mut Files) -> Result<DrawnSheet, Problem> {
        let of_path = |e: FileError| Problem::from_error(key.name("path"), &e);
        let bytes = files.contents(&self.path);
        let bytes = bytes.map_err(|e| of_path(FileError::unreadable(&self.path, e)))?;
        let options = self.options();
        let drawing = parse_drawing(&bytes, &self.path, &options).map_err(of_path)?;
        mesh_drawing(&drawing, &options).map_err(|e| match e {
            DrawingError::Plane(PlaneError::Open { .. }) => Problem::new(
                key.clone(),
                e.to_string(),
                "close the outline there, give a `snap` of at least the gap, or leave out lines that are no outline \
                 by `ignore`",
            ),
            _ => Problem::from_error(key.clone(), &e),
        })
    }
}
