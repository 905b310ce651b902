//! The scene that folds a crease pattern.

use crate::sheets::fold_group::FoldGroup;
use isosheet_dynamics::Material;
use isosheet_files::FileError;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What the panels of a crease pattern are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panels {
    /// Rigid: folds are at creases alone.
    Rigid,
    /// An elastic sheet, each of whose triangles is divided into four so often.
    Elastic {
        /// `sheet.refine`.
        refine: usize,
    },
    /// Soft in their plane, so that they stretch on the way to a shape that no isometric motion leads to,
    /// with springs at the edges of their triangles: where these are slender, the bending stiffness of the
    /// material would keep creases open.
    Soft {
        /// Stiffness in the plane beside the bending stiffness of the material over the square of the longest
        /// side of the sheet.
        stiffness: u32,
    },
}

/// A scene that folds a crease pattern to its angles.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldScene {
    /// The pattern as the scene names it: relative to the folder of the scene, or absolute.
    pub pattern: PathBuf,
    /// The frame of a FOLD file, if not the first one with vertices.
    pub frame: Option<usize>,
    /// Metres for a unit of the pattern.
    pub scale: f64,
    /// The longest side of the sheet, metres.
    pub size: f64,
    /// The material by its name.
    pub material: String,
    /// What the panels are.
    pub panels: Panels,
    /// The part of the angles; mountains are valleys where it is negative.
    pub part: f64,
    /// Whether panels touch each other.
    pub touch: Touch,
    /// Groups of creases that fold one after the other; none if all fold at the same time.
    pub order: Vec<FoldGroup>,
}

/// What panels do where they meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// They pass through each other.
    Passes,
    /// They touch.
    Touches,
}

/// The strain that soft panels do not exceed.
const SOFT_LIMIT: f64 = 0.4;

/// Stiffness of a metre of the edges inside of soft panels beside that of creases.
const SOFT_EDGES: f64 = 0.4;

/// In how much time the springs reach their angles, in which steps, and when the run ends, seconds. Inertia
/// of the panels is small then beside the springs, and each step turns a crease by a few degrees.
const TIME: f64 = 4.0;
const STEP: f64 = 1.0 / 30.0;
const END: f64 = 5.0;

/// Stiffness of a metre of crease beside the bending stiffness of the material over the longest side of the
/// sheet: creases that are stiffer bend the panels, and softer ones do not reach their angles.
const CREASES: f64 = 20.0;

/// The gap below which panels feel each other, beside the longest side of the sheet: half the thickness of
/// office paper of 0.2 m. What is wider keeps creases of 180 degrees open, whose panels lie between others.
const NEAR: f64 = 2.5e-4;

impl FoldScene {
    /// The text of the scene.
    ///
    /// # Errors
    /// [`FileError`] if the path of the pattern cannot be written.
    pub fn text(&self) -> Result<String, FileError> {
        let path = path_value(&self.pattern)?;
        let frame = self
            .frame
            .map_or(String::new(), |k| format!(", frame = {k}"));
        let scale = toml::Value::from(self.scale);
        let mut text = format!(
            "# Folds the crease pattern {} to its angles, or to 180 degrees where it gives none.\n\
             # Lengths in metres, times in seconds, angles in degrees. docs/scene.md describes all keys.\n\
             version = 1\n\n[sheet]\nmesh = {{ file = {{ path = {path}, scale = {scale}, polygons = \"triangulate\"{frame} }} }}\n",
            Path::new(&self.pattern)
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .escape_debug(),
        );
        let material = toml::Value::from(self.material.as_str());
        let creases = CREASES * self.rigidity() / self.size;
        let stiffness = two_digits(creases);
        let flat = match self.panels {
            Panels::Soft { .. } => format!(
                "flat_stiffness = {:?} # N: of the edges inside of panels\n",
                two_digits(SOFT_EDGES * creases)
            ),
            Panels::Rigid | Panels::Elastic { .. } => String::new(),
        };
        let panels = match self.panels {
            Panels::Rigid => "isometry = \"rods\" # rigid panels\nbending = \"none\"\n".to_owned(),
            Panels::Elastic { refine: 0 } => String::new(),
            Panels::Soft { stiffness } => format!(
                "isometry = {{ elastic = {{ stiffness = {:?}, limit = {SOFT_LIMIT:?} }} }} # panels stretch on the way\n\
                 bending = \"none\"\n",
                two_digits(f64::from(stiffness) * self.rigidity() / (self.size * self.size))
            ),
            Panels::Elastic { refine } => {
                format!(
                    "refine = {refine} # each triangle is divided into four, so often: panels bend\n"
                )
            }
        };
        let part = self.part;
        // Each group has the time that all creases have together otherwise.
        let turns = self.order.len().max(1) as f64;
        let slower = two_digits(self.slowness());
        let [time, step, end] = [turns * TIME, STEP, turns * TIME + END - TIME].map(|t| slower * t);
        let groups: Vec<String> = self.order.iter().map(FoldGroup::to_string).collect();
        let order = match groups.is_empty() {
            true => String::new(),
            false => format!("order = [{}] # one after the other\n", groups.join(", ")),
        };
        let (damping, frames) = (5.0 / slower, 30.0 / slower);
        let _ = write!(
            text,
            "material = {material}\n{panels}damping = {damping:?} # 1/s\n\n[folding]\ntime = {time:?} # s\n\
             stiffness = {stiffness:?} # N: newton metres per radian and metre of crease\n\
             {flat}part = {part:?} # of the angles of the pattern\n{order}\n[method]\nstep = {step:?} # s\n\n[stop]\ntime = {end:?} # s\n\n\
             [output]\nframes_per_second = {frames:?}\n"
        );
        if self.touch == Touch::Touches {
            let near = two_digits(NEAR * self.size);
            let _ = write!(
                text,
                "\n[contact]\nself_contact = true\nactivation = {near:?} # m: panels that lie on each other are so near\n"
            );
        }
        Ok(text)
    }

    /// The time in which a crease turns a panel, over that of a sheet of office paper of 0.2 m: springs of
    /// the stiffness `D / L` a metre turn masses of `density L^3` a metre.
    fn slowness(&self) -> f64 {
        let paper = Material::office_paper();
        let density = Material::named(&self.material).map_or(paper.density, |m| m.density);
        let ratio = (density / paper.density * paper.rigidity / self.rigidity()).sqrt();
        ratio * (self.size / 0.2).powi(2)
    }

    /// The bending stiffness of the material, N m; that of office paper where it has none.
    fn rigidity(&self) -> f64 {
        let of_material = Material::named(&self.material).map(|m| m.rigidity);
        of_material.ok().filter(|d| *d > 0.0).unwrap_or(5e-4)
    }
}

/// A path as the text of a scene has it.
///
/// # Errors
/// [`FileError`] if it is not valid UTF-8.
pub fn path_value(path: &Path) -> Result<toml::Value, FileError> {
    let text = path.to_str().ok_or_else(|| {
        let problem = "its path is not valid UTF-8, so that no scene can name it";
        FileError::content(path, problem, "give it another name")
    })?;
    Ok(toml::Value::from(text))
}

/// A number as a scene shows it: with two digits.
pub fn two_digits(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(number)
}
