//! Scenes in which a sheet of a file does one thing: it drapes over a body, hangs, or is crumpled.

use super::drawing::DrawingFile;
use super::fold_scene::{path_value, two_digits};
use super::mesh_file::{MeshFile, PolygonFaces};
use super::pose::{Pose, Turn};
use super::selection::bounds;
use super::up_axis::UpAxis;
use crate::format::FileError;
use isosheet_dynamics::Material;
use std::fmt::Write;

/// What a sheet does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// It falls on a body, with its middle above that of the body.
    Drape(DrapedBody),
    /// It swings down from where it is held.
    Hang(HeldCorners),
    /// Plates push it together from all sides and withdraw.
    Crumple,
}

/// What a sheet drapes over.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum DrapedBody {
    /// A round table, six tenths as wide as the sheet.
    Table,
    /// The triangles of a file: a solid if they are closed, otherwise a surface with two sides.
    Tool {
        /// The file as the scene names it.
        file: MeshFile,
        /// The bounds of the file as the scene places it, metres.
        bounds: [[f64; 3]; 2],
    },
}

/// Which corners of the box about a sheet are held: of each the vertex that is nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum HeldCorners {
    /// The one at the smallest x and the largest y
    Corner,
    /// Both at the largest y
    TwoCorners,
}

/// Where the mesh of a sheet comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SheetSource {
    /// A mesh file.
    File(MeshFile),
    /// A drawing.
    Drawing(DrawingFile),
}

/// A scene in which a sheet does one thing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ActionScene {
    /// The mesh of the sheet.
    pub(crate) source: SheetSource,
    /// The positions of its vertices in the frame of the mesh, metres.
    pub(crate) positions: Vec<[f64; 3]>,
    /// The number of its faces.
    pub(crate) faces: usize,
    /// The material by its name.
    pub(crate) material: String,
    /// What the sheet does.
    pub(crate) action: Action,
}

/// A sheet has at least so many faces: those of a coarser mesh are divided.
const LEAST_FACES: usize = 400;

/// A sheet is flat that is thinner than this part of its longest side.
const FLAT: f64 = 0.01;

/// Earth's acceleration, m/s2.
const GRAVITY: f64 = 9.81;

/// A step beside the time of a fall by the size: a sixtieth of a second for half a metre.
const STEP: f64 = 0.074;

/// By how much of its longest side a sheet is above what it falls on.
const ABOVE: f64 = 0.02;

/// The part of the way to its middle that is left of a sheet which is crumpled.
const CRUMPLED: f64 = 0.45;

impl ActionScene {
    /// The text of the scene. The top of a body that the sheet drapes over, and the vertices that it hangs by, are at z = 0.
    ///
    /// # Errors
    /// [`FileError`] if the path of a file cannot be written.
    pub(crate) fn text(&self) -> Result<String, FileError> {
        let turn = self.turn();
        let turned = Pose {
            turn: turn.clone(),
            ..Pose::default()
        };
        let points: Vec<[f64; 3]> = self.positions.iter().map(|p| turned.place(*p)).collect();
        let [low, high] = bounds(&points);
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let middle = |k: usize| 0.5 * (low[k] + high[k]);
        let bottom = match self.action {
            Action::Drape(_) => ABOVE * size,
            Action::Hang(_) => low[2] - high[2],
            Action::Crumple => 0.0,
        };
        let position = [-middle(0), -middle(1), bottom - low[2]].map(digits);
        let half = [0, 1].map(|k| 0.5 * (high[k] - low[k]));
        let mut text = format!(
            "# {}\n# Lengths in metres, times in seconds, angles in degrees. docs/scene.md describes all keys.\nversion = 1\n\n\
             [sheet]\nmesh = {}\nmaterial = {}\n",
            self.title(),
            self.mesh_value()?,
            toml::Value::from(self.material.as_str()),
        );
        let refine = self.refine();
        if refine > 0 {
            let _ = writeln!(
                text,
                "refine = {refine} # each triangle is divided into four, so often"
            );
        }
        let seconds = (size / GRAVITY).sqrt();
        let _ = writeln!(text, "damping = {:?} # 1/s: air", two_digits(0.5 / seconds));
        let turn = turn.map_or(String::new(), |Turn { axis, angle }| {
            format!(", turn = {{ axis = {axis:?}, angle = {angle:?} }}")
        });
        let _ = writeln!(text, "placement = {{ position = {position:?}{turn} }}");
        let stop = match &self.action {
            Action::Drape(body) => {
                text.push_str(&draped(body, half)?);
                15.0 * seconds
            }
            Action::Hang(held) => {
                let x = [-half[0], half[0]].map(digits);
                let y = digits(half[1]);
                let points = match held {
                    HeldCorners::Corner => format!("[{:?}, {y:?}, 0.0]", x[0]),
                    HeldCorners::TwoCorners => {
                        format!("[{:?}, {y:?}, 0.0], [{:?}, {y:?}, 0.0]", x[0], x[1])
                    }
                };
                let _ = write!(text, "\n[[support]]\nat = {{ nearest = [{points}] }}\n");
                30.0 * seconds
            }
            Action::Crumple => {
                let push = two_digits(10.0 * size);
                text.push_str(&self.crumpled(half, high[2] - low[2], size, push));
                push + 10.0 * seconds
            }
        };
        let friction = match self.action {
            Action::Hang(_) => 0.0,
            Action::Drape(_) | Action::Crumple => 0.3,
        };
        let step = two_digits(STEP * seconds);
        let _ = write!(
            text,
            "\n[contact]\nself_contact = true\nfriction = {friction:?}\n\n[forces]\ngravity = [0.0, 0.0, -{GRAVITY:?}] # m/s2\n\n\
             [method]\nstep = {step:?} # s\n\n[stop]\ntime = {:?} # s\n",
            two_digits(stop),
        );
        // A sheet may be at rest between the plates.
        if self.action != Action::Crumple {
            let speed = two_digits(REST * (GRAVITY * size).sqrt());
            let duration = two_digits(seconds);
            let _ = writeln!(
                text,
                "rest = {{ speed = {speed:?}, duration = {duration:?} }} # or when all vertices are so slow for so long"
            );
        }
        Ok(text)
    }

    /// How often the faces are divided.
    fn refine(&self) -> usize {
        let mut refine = 0;
        while self.faces << (2 * refine) < LEAST_FACES {
            refine += 1;
        }
        refine
    }

    /// The turn that lays a flat sheet on its face. One that is crumpled is turned about z besides, so that the plates come
    /// from the corners of a rectangle.
    fn turn(&self) -> Option<Turn> {
        let [low, high] = bounds(&self.positions);
        let extent = [0, 1, 2].map(|k| high[k] - low[k]);
        let longest = extent.into_iter().fold(0.0, f64::max);
        let thin = (0..3).find(|&k| extent[k] < FLAT * longest);
        let (axis, angle) = match (thin, &self.action) {
            (Some(0), _) => ([0.0, 1.0, 0.0], -90.0),
            (Some(1), _) => ([1.0, 0.0, 0.0], 90.0),
            (_, Action::Crumple) => ([0.0, 0.0, 1.0], 45.0),
            _ => return None,
        };
        Some(Turn { axis, angle })
    }

    fn title(&self) -> String {
        let what = match &self.action {
            Action::Drape(DrapedBody::Table) => "falls on a round table and drapes over its rim",
            Action::Drape(DrapedBody::Tool { .. }) => "falls on a body and drapes over it",
            Action::Hang(HeldCorners::Corner) => "swings down from a corner that is held",
            Action::Hang(HeldCorners::TwoCorners) => "swings down from two corners that are held",
            Action::Crumple => "is pushed together from all sides and let go",
        };
        let path = match &self.source {
            SheetSource::Drawing(drawing) => &drawing.path,
            SheetSource::File(file) => &file.path,
        };
        let name = path.file_name().unwrap_or_default();
        let name = name.to_string_lossy();
        format!("The sheet of {} {what}.", name.escape_debug())
    }

    fn mesh_value(&self) -> Result<String, FileError> {
        match &self.source {
            SheetSource::File(file) => Ok(format!("{{ file = {} }}", file_value(file)?)),
            SheetSource::Drawing(drawing) => Ok(format!(
                "{{ drawing = {{ path = {}, spacing = {:?}, scale = {:?} }} }}",
                path_value(&drawing.path)?,
                drawing.spacing,
                drawing.scale
            )),
        }
    }

    /// The plates that push a sheet together within a time (seconds), and the table that it lies on.
    fn crumpled(&self, half: [f64; 2], height: f64, size: f64, push: f64) -> String {
        let mut text = String::new();
        if let Ok(material) = Material::named(&self.material)
            && material.yields.is_some()
        {
            // A table of the sheet, which is the last one so far.
            text.push_str("yield = { layers = 4 } # sharp bends stay\n");
        }
        text.push_str("start = { perturbation = 0.001, seed = 1 }\n");
        let [hold, free] = [1.2, 1.5].map(|part| two_digits(part * push));
        let mut plate = |from: f64, to: f64, axis: &str, turn: Option<([f64; 3], f64)>| {
            let [out, inward] = [from, to].map(two_digits);
            let turn = turn.map_or(String::new(), |(axis, angle)| {
                format!("pose = {{ turn = {{ axis = {axis:?}, angle = {angle:?} }} }}\n")
            });
            let away = two_digits(1.2 * from);
            let _ = write!(
                text,
                "\n[[obstacle]]\nshape = \"half_space\"\n{turn}motion = {{ {axis} = {{ keyframes = {{ keys = \
                 [[0.0, {out:?}], [{push:?}, {inward:?}], [{hold:?}, {inward:?}], [{free:?}, {away:?}]] }} }} }}\n\
                 friction = 0.3\n"
            );
        };
        for (k, axis) in ["x", "y"].into_iter().enumerate() {
            for sign in [-1.0, 1.0] {
                // The half space is on the outer side.
                let turn = match k {
                    0 => ([0.0, 1.0, 0.0], -90.0 * sign),
                    _ => ([1.0, 0.0, 0.0], 90.0 * sign),
                };
                let from = sign * 1.02 * half[k];
                plate(from, CRUMPLED * from, axis, Some(turn));
            }
        }
        // The sheet has room to bend upwards and downwards.
        let room = 0.4 * size;
        plate(
            height + room,
            height + 0.1 * room,
            "z",
            Some(([1.0, 0.0, 0.0], 180.0)),
        );
        let _ = write!(
            text,
            "\n[[obstacle]] # the table\nshape = \"half_space\"\npose = {{ position = [0.0, 0.0, {:?}] }}\nfriction = 0.3\n",
            two_digits(-room)
        );
        text
    }
}

/// The speed at which a sheet is at rest, beside that of a fall by its size.
const REST: f64 = 1e-3;

/// The body that a sheet of such half sides falls on, with its top at z = 0.
fn draped(body: &DrapedBody, half: [f64; 2]) -> Result<String, FileError> {
    let (shape, position, note) = match body {
        DrapedBody::Table => {
            let radius = two_digits(0.6 * half[0].min(half[1]));
            let height = two_digits(0.8 * half[0].max(half[1]));
            let shape = format!("{{ cylinder = {{ radius = {radius:?}, height = {height:?} }} }}");
            (shape, [0.0, 0.0, digits(-0.5 * height)], "a round table")
        }
        DrapedBody::Tool { file, bounds } => {
            let [low, high] = *bounds;
            let middle = |k: usize| digits(-0.5 * (low[k] + high[k]));
            let shape = format!("{{ file = {} }}", file_value(file)?);
            (
                shape,
                [middle(0), middle(1), digits(-high[2])],
                "its top is at z = 0",
            )
        }
    };
    Ok(format!(
        "\n[[obstacle]] # {note}\nshape = {shape}\npose = {{ position = {position:?} }}\nfriction = 0.3\n"
    ))
}

/// A mesh file as the text of a scene has it.
fn file_value(file: &MeshFile) -> Result<String, FileError> {
    let mut text = format!(
        "{{ path = {}, scale = {:?}",
        path_value(&file.path)?,
        file.scale
    );
    if file.up == UpAxis::Y {
        text.push_str(", up = \"y\"");
    }
    if file.polygons == PolygonFaces::Triangulate {
        text.push_str(", polygons = \"triangulate\"");
    }
    text.push_str(" }");
    Ok(text)
}

/// A coordinate as a scene shows it: to a part in a million, and without the round-off of one that is 0.
fn digits(length: f64) -> f64 {
    match length.abs() < 1e-12 {
        true => 0.0,
        false => format!("{length:.5e}").parse().unwrap_or(length),
    }
}
