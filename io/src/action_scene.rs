//! Scenes in which a sheet of a file does one thing: it drapes over a body, hangs, or is crumpled.

use super::face_moments::FaceMoments;
use isosheet_dynamics::Material;
use isosheet_files::FileError;
use isosheet_scenes::{
    DrawingFile, MeshFileKey, PolygonFaces, Pose, Turn, UpAxis, bounds, path_value, two_digits,
};
use nalgebra::{Unit, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_4;
use std::fmt::Write;

/// What a sheet does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// It falls on a body, with the centre of its area above that of the body.
    Drape(DrapedBody, Below),
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
        file: MeshFileKey,
        /// The centre of the area of the file as the scene places it, metres.
        centre: [f64; 3],
        /// The heights of its lowest and its highest point, metres.
        heights: [f64; 2],
    },
}

/// What is below a body that a sheet drapes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Below {
    /// Nothing: the hem hangs free.
    Nothing,
    /// A floor at its lowest point.
    Floor,
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
    File(MeshFileKey),
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
    /// Of its faces in the frame of the mesh, metres.
    pub(crate) moments: FaceMoments,
    /// The material by its name.
    pub(crate) material: String,
    /// What the sheet does.
    pub(crate) action: Action,
    /// How often its faces are divided, where that is not left to the scene.
    pub(crate) refine: Option<usize>,
    /// The time at which the run ends at the latest, seconds, where that is not left to the scene.
    pub(crate) time: Option<f64>,
}

/// A sheet has at least so many faces: faces of a coarser mesh are divided.
const LEAST_FACES: usize = 400;

/// A sheet is flat that is thinner along the normal of its faces than this part of its longest side.
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
    /// The text of the scene. The top of a body that the sheet drapes over, and the vertices that it hangs
    /// by, are at z = 0.
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
        let centre = turned.place(self.moments.centre);
        let bottom = match self.action {
            Action::Drape(..) => ABOVE * size,
            Action::Hang(_) => low[2] - high[2],
            Action::Crumple => 0.0,
        };
        let position = [-centre[0], -centre[1], bottom - low[2]].map(digits);
        // The sides of the box about it, beside the centre of its area.
        let sides = [0, 1].map(|k| [low[k] - centre[k], high[k] - centre[k]]);
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
            Action::Drape(body, below) => {
                text.push_str(&draped(body, *below, half)?);
                15.0 * seconds
            }
            Action::Hang(held) => {
                let x = sides[0].map(digits);
                let y = digits(sides[1][1]);
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
                text.push_str(&self.crumpled(sides, high[2] - low[2], size, push));
                push + 10.0 * seconds
            }
        };
        let friction = match self.action {
            Action::Hang(_) => 0.0,
            Action::Drape(..) | Action::Crumple => 0.3,
        };
        let step = two_digits(STEP * seconds);
        let _ = write!(
            text,
            "\n[contact]\nself_contact = true\nfriction = {friction:?}\n\n[forces]\ngravity = [0.0, 0.0, -{GRAVITY:?}] # m/s2\n\n\
             [method]\nstep = {step:?} # s\n\n[stop]\ntime = {:?} # s\n",
            self.time.unwrap_or(two_digits(stop)),
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
        let mut least = 0;
        while self.faces << (2 * least) < LEAST_FACES {
            least += 1;
        }
        self.refine.unwrap_or(least)
    }

    /// The turn that lays a flat sheet on its face. One that is crumpled is turned about z besides, so that
    /// the plates come from the corners of a rectangle.
    fn turn(&self) -> Option<Turn> {
        let about = match self.action {
            Action::Crumple => UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_4),
            Action::Drape(..) | Action::Hang(_) => UnitQuaternion::identity(),
        };
        let (axis, angle) = (about * self.laid()).axis_angle()?;
        // Far below what can be seen, and above the round-off of quarter turns.
        let rounded = |number: f64| (1e9 * number).round() / 1e9 + 0.0;
        let angle = rounded(angle.to_degrees());
        let axis = axis.into_inner().map(rounded).into();
        (angle != 0.0).then_some(Turn { axis, angle })
    }

    /// The rotation that turns the normal of a flat sheet upwards.
    fn laid(&self) -> UnitQuaternion<f64> {
        let normal = self.moments.normal;
        let heights = self
            .positions
            .iter()
            .map(|p| normal.dot(&Vector3::from(*p)));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
            (h.min(low), h.max(high))
        });
        let [least, largest] = bounds(&self.positions);
        let longest = (0..3).map(|k| largest[k] - least[k]).fold(0.0, f64::max);
        let across = normal.cross(&Vector3::z());
        match Unit::try_new(across, 0.0) {
            Some(axis) if high - low < FLAT * longest => {
                UnitQuaternion::from_axis_angle(&axis, across.norm().atan2(normal.z))
            }
            _ => UnitQuaternion::identity(),
        }
    }

    fn title(&self) -> String {
        let what = match &self.action {
            Action::Drape(DrapedBody::Table, _) => "falls on a round table and drapes over its rim",
            Action::Drape(DrapedBody::Tool { .. }, _) => "falls on a body and drapes over it",
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
    fn crumpled(&self, sides: [[f64; 2]; 2], height: f64, size: f64, push: f64) -> String {
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
            let [out, inward] = [from, to].map(digits);
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
            for side in sides[k] {
                // The half space is on the outer side.
                let sign = side.signum();
                let turn = match k {
                    0 => ([0.0, 1.0, 0.0], -90.0 * sign),
                    _ => ([1.0, 0.0, 0.0], 90.0 * sign),
                };
                let from = 1.02 * side;
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

/// The body that a sheet of such half sides falls on, with its top at z = 0, and what is below it.
fn draped(body: &DrapedBody, below: Below, half: [f64; 2]) -> Result<String, FileError> {
    let (shape, position, height, note) = match body {
        DrapedBody::Table => {
            let radius = two_digits(0.6 * half[0].min(half[1]));
            let height = two_digits(0.8 * half[0].max(half[1]));
            let shape = format!("{{ cylinder = {{ radius = {radius:?}, height = {height:?} }} }}");
            let middle = [0.0, 0.0, digits(-0.5 * height)];
            (shape, middle, height, "a round table")
        }
        DrapedBody::Tool {
            file,
            centre,
            heights: [bottom, top],
        } => {
            let shape = format!("{{ file = {} }}", file_value(file)?);
            let position = [-centre[0], -centre[1], -top].map(digits);
            (shape, position, top - bottom, "its top is at z = 0")
        }
    };
    let mut text = format!(
        "\n[[obstacle]] # {note}\nshape = {shape}\npose = {{ position = {position:?} }}\nfriction = 0.3\n"
    );
    if below == Below::Floor {
        let floor = [0.0, 0.0, digits(-height)];
        let _ = write!(
            text,
            "\n[[obstacle]] # the floor\nshape = \"half_space\"\npose = {{ position = {floor:?} }}\nfriction = 0.3\n"
        );
    }
    Ok(text)
}

/// A mesh file as the text of a scene has it.
fn file_value(file: &MeshFileKey) -> Result<String, FileError> {
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

/// A coordinate as a scene shows it: with all digits to a picometre, without the round-off of one that is 0.
fn digits(length: f64) -> f64 {
    format!("{length:.12}").parse().unwrap_or(length) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip narrower than a hundredth of its length, far from the origin.
    fn strip(action: Action) -> ActionScene {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.005], [0.0, 0.005]];
        let positions = corners.map(|[x, y]| [2_600_000.25 + x, y, 3.0]).to_vec();
        let moments = FaceMoments::of(&positions, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        ActionScene {
            source: SheetSource::File(MeshFileKey::new("strip.obj")),
            positions,
            faces: 2,
            moments,
            material: "office paper".to_owned(),
            action,
            refine: None,
            time: None,
        }
    }

    #[test]
    fn a_narrow_strip_far_away_lies_on_its_face_above_the_table() {
        let scene = strip(Action::Drape(DrapedBody::Table, Below::Nothing));
        assert_eq!(scene.turn(), None);
        let text: toml::Table = scene.text().unwrap().parse().unwrap();
        let position = text["sheet"]["placement"]["position"].as_array().unwrap();
        let position: Vec<f64> = position.iter().map(|c| c.as_float().unwrap()).collect();
        for (found, expected) in position.iter().zip([-2_600_000.75, -0.0025, ABOVE - 3.0]) {
            assert!((found - expected).abs() < 1e-8, "{position:?}");
        }
        let radius = text["obstacle"][0]["shape"]["cylinder"]["radius"].as_float();
        assert!(radius > Some(0.0));
    }

    /// Quarter turns are exact, and the plates begin outside of the sheet whatever its size is.
    #[test]
    fn an_upright_sheet_is_laid_and_plates_begin_outside() {
        let upright = |action, size: f64| {
            let mut scene = strip(action);
            scene.positions = vec![
                [0.0; 3],
                [size, 0.0, 0.0],
                [size, 0.0, size],
                [0.0, 0.0, size],
            ];
            scene.moments = FaceMoments::of(&scene.positions, &[[0, 1, 2], [0, 2, 3]]).unwrap();
            scene
        };
        let turn = upright(Action::Hang(HeldCorners::Corner), 1.0).turn();
        let axis = [1.0, 0.0, 0.0];
        assert_eq!(turn, Some(Turn { axis, angle: 90.0 }));
        for size in [0.1, 0.145, 0.149] {
            let text: toml::Table = upright(Action::Crumple, size)
                .text()
                .unwrap()
                .parse()
                .unwrap();
            let keys = &text["obstacle"][1]["motion"]["x"]["keyframes"]["keys"];
            let out = keys[0][1].as_float().unwrap();
            // The sheet stands on its corner.
            assert!(
                (out / (0.5 * 2.0_f64.sqrt() * size) - 1.02).abs() < 1e-6,
                "{out}"
            );
        }
    }
}
