//! Meshes in motion, from files or as numbers.

use crate::meshes::up_axis::UpAxis;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_formats::{Clock, MovingMesh};
use isosheet_mesh::wording::brief;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A mesh in motion: the positions of its vertices at several times, between which they go straight on at
/// constant speed.
///
/// ```toml
/// [[obstacle]]
/// shape = { sequence = { path = "body.npz", up = "y" } }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
#[checked]
pub struct Sequence {
    /// Path, relative to the scene file: the folder of a run, whose trajectory is taken; an archive of numpy
    /// (`.npz`) with the arrays `t` (T times, seconds), `x` (T x V x 3) and `faces` (F x 3, from 0), which
    /// `numpy.savez("body.npz", t=t, x=x, faces=faces)` writes; a list of mesh files with their times in
    /// seconds (`.pvd`, `.vtk.series`); or a folder of mesh files whose names end in the numbers of frames,
    /// or a pattern with one `*` for these numbers, `walk/walk_*.obj`. VTK files may have times. Without it
    /// the scene has `frames`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<PathBuf>,
    /// The frames from a program, in place of a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames: Option<MeshFrames>,
    /// Frames a second, of files that have numbers and no times: in the order of the numbers, which are
    /// consecutive or all at one distance, the first file is at 0 s, the next one at 1 / `rate`, and so on.
    #[serde(default)]
    pub rate: Option<f64>,
    /// Length of one unit of the file, metres: 0.001 for a file in millimetres.
    #[serde(default = "one")]
    pub scale: f64,
    /// The axis of the file that points upwards; it becomes z. Leave it out for a file of glTF, which names
    /// it.
    #[serde(default)]
    pub up: UpAxis,
    /// What is added to the times of the file, seconds.
    #[serde(default)]
    pub delay: f64,
    /// What the mesh does in a run that begins before its first time or goes on after its last one.
    #[serde(default)]
    pub outside: Outside,
}

/// Frames of a mesh in motion.
///
/// ```toml
/// [[obstacle]]
///
/// [obstacle.shape.sequence.frames]
/// times = [0, 1]
/// positions = [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0.1], [1, 0, 0.1], [0, 1, 0.1]]]
/// faces = [[0, 1, 2]]
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct MeshFrames {
    /// The times of the frames, seconds, in their order.
    pub times: Vec<f64>,
    /// The positions of all vertices in each frame, metres.
    pub positions: Vec<Vec<[f64; 3]>>,
    /// Vertices of each triangle by their numbers, from 0.
    pub faces: Vec<[u32; 3]>,
}

impl MeshFrames {
    fn check(&self, key: &Key, checks: &mut Checks) {
        let (frames, times) = (self.positions.len(), self.times.len());
        if frames != times {
            let message = format!("there are positions of {frames} frames at {times} times");
            checks.report(
                key.name("positions"),
                message,
                "give one frame for each time",
            );
        }
        for (key, time) in key.name("times").entries(&self.times) {
            checks.number(key, *time, Unit::Second);
        }
        let first = self.positions.first().map_or(0, Vec::len);
        for (key, frame) in key.name("positions").entries(&self.positions) {
            checks.points(key.clone(), frame);
            if frame.len() != first {
                let message = format!(
                    "the frame has {} vertices, and the first one {first}",
                    frame.len()
                );
                checks.report(key, message, "give the same vertices in all frames");
            }
        }
    }

    /// The mesh at the times of the frames; `key` is its place.
    pub(crate) fn mesh(&self, key: &Key) -> Result<MovingMesh, Problem> {
        let x = self.positions.iter().flatten().flatten().copied().collect();
        let corners: Vec<i64> = self.faces.iter().flatten().map(|v| i64::from(*v)).collect();
        let times = (Clock::Seconds, self.times.clone());
        let mesh = MovingMesh::new(Path::new("the mesh in motion"), times, x, &corners);
        mesh.map_err(|e| Problem::from_error(key.clone(), &e))
    }
}

/// What a mesh in motion does before its first and after its last time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum Outside {
    /// Nothing: a run that needs it is refused.
    #[default]
    Refuse,
    /// It rests where it is at that time. A mesh with a single time rests throughout.
    Rest,
}

fn one() -> f64 {
    1.0
}

impl Sequence {
    /// A file in metres with z upwards, at its own times.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: Some(path.into()),
            frames: None,
            scale: 1.0,
            rate: None,
            up: UpAxis::Z,
            delay: 0.0,
            outside: Outside::Refuse,
        }
    }

    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("scale"), self.scale, Unit::Metre);
        let path = self.path.as_deref().unwrap_or(Path::new(""));
        self.up.check(path, key, checks);
        checks.number(key.name("delay"), self.delay, Unit::Second);
        if let Some(rate) = self.rate {
            checks.positive(key.name("rate"), rate, Unit::PerSecond);
        }
        match (&self.path, &self.frames) {
            (Some(path), None) if path.as_os_str().is_empty() => {
                checks.report(
                    key.name("path"),
                    "the path is empty",
                    "name a mesh in motion",
                );
            }
            (Some(_), None) => {}
            (None, Some(frames)) => frames.check(&key.name("frames"), checks),
            (given, _) => {
                let message = match given {
                    Some(_) => "the mesh in motion has a `path` and `frames`",
                    None => "the mesh in motion has neither a `path` nor `frames`",
                };
                checks.report(key.clone(), message, "give one of them");
            }
        }
    }

    /// The place of what it is made of.
    fn source(&self, key: &Key) -> Key {
        key.name(if self.path.is_some() {
            "path"
        } else {
            "frames"
        })
    }

    /// What a file has, in metres, with z upwards and at times of the simulation; `key` is its place.
    pub(crate) fn place(&self, mesh: MovingMesh, key: &Key) -> Result<MovingMesh, Problem> {
        let mesh = match (mesh.clock(), self.rate) {
            (Clock::Seconds, None) => mesh,
            (Clock::Frames, Some(rate)) => mesh.at_rate(rate),
            (Clock::Seconds, Some(_)) => {
                let message = "the mesh in motion has times in seconds besides";
                return Err(Problem::new(key.name("rate"), message, "leave `rate` out"));
            }
            (Clock::Frames, None) => {
                let message = "the files of the mesh in motion have numbers and no times";
                let remedy = "write the frames a second beside `path`, such as `rate = 24`";
                return Err(Problem::new(self.source(key), message, remedy));
            }
        };
        let placed = mesh.map(|p| self.up.place(p.map(|c| self.scale * c)));
        Ok(placed.delayed(self.delay))
    }

    /// Refuses a run to a time, in seconds, that goes beyond the times of the mesh; `key` is its place.
    pub(crate) fn check_times(
        &self,
        mesh: &MovingMesh,
        end: f64,
        key: &Key,
    ) -> Result<(), Problem> {
        let times = mesh.times();
        let [first, last] = [times.first(), times.last()].map(|t| t.copied().unwrap_or_default());
        let round_off = 4.0 * f64::EPSILON * first.abs().max(last.abs()).max(self.delay.abs());
        let is_inside = first <= round_off && last >= end - round_off;
        if is_inside || self.outside == Outside::Rest {
            return Ok(());
        }
        let [from, to, end] = [first, last, end].map(brief);
        let own = match times.len() {
            1 => format!("has one time, {from} s"),
            _ => format!("goes from {from} s to {to} s"),
        };
        let message = format!("the mesh in motion {own}, and the run goes from 0 s to {end} s");
        let remedy = "shift it by `delay`, end the run earlier (`stop.time`), or write `outside = \"rest\"`, so that it \
                      rests before and after";
        Err(Problem::new(self.source(key), message, remedy))
    }
}
