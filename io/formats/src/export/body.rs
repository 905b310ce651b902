//! Bodies beside a moving sheet.

use super::ExportError;
use super::error::check_mesh;
use isosheet_files::DataError;
use nalgebra::Isometry3;

/// A rigid body: a mesh in its own frame, and where that is.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesBody {
    /// The name: ASCII letters, digits and `_`, not beginning with a digit, as some formats demand.
    pub name: String,
    /// Positions of its vertices in its own frame (3V, metres).
    pub positions: Vec<f64>,
    /// Its faces, counter-clockwise as seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// Its pose in each frame of the trajectory, or a single one if it rests.
    pub poses: Vec<BodyPose>,
}

/// Where a body is: a point `X` of its own frame is at `R X + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPose {
    /// The rotation `R` as a quaternion `[x, y, z, w]` of length 1, where `w` is the real part.
    pub rotation: [f64; 4],
    /// Where the origin of the body is, metres.
    pub translation: [f64; 3],
}

impl BodyPose {
    /// No rotation and no translation.
    pub const IDENTITY: Self = Self::at([0.0; 3]);

    /// A translation, in metres.
    pub const fn at(translation: [f64; 3]) -> Self {
        Self {
            rotation: [0.0, 0.0, 0.0, 1.0],
            translation,
        }
    }
}

impl SeriesBody {
    /// Whether the body is the same in all frames.
    pub fn rests(&self) -> bool {
        self.poses.len() == 1
    }

    /// Its positions in a frame of the trajectory (3V, metres).
    pub(super) fn placed(&self, frame: usize) -> Vec<f64> {
        let pose = match self.poses[..] {
            [pose] => pose,
            _ => self.poses[frame],
        };
        let points = self.positions.as_chunks::<3>().0.iter();
        points.flat_map(|p| pose.apply(p)).collect()
    }

    /// Whether it is a mesh with poses for so many frames.
    pub(super) fn validate(&self, frames: usize) -> Result<(), ExportError> {
        let count = self.poses.len();
        if count != 1 && count != frames {
            let name = &self.name;
            let message = format!("{name} has {count} poses, and the trajectory {frames} frames");
            let remedy = "give a pose for each frame, or a single one for a body at rest";
            return Err(DataError::new(message, remedy).into());
        }
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let starts = |c: char| is_plain(c) && !c.is_ascii_digit();
        if !(self.name.starts_with(starts) && self.name.chars().all(is_plain)) {
            let message = format!("{:?} is no name of a body", self.name);
            let remedy = "use ASCII letters, digits and _, and no digit at the beginning";
            return Err(DataError::new(message, remedy).into());
        }
        check_mesh(&self.positions, &self.faces)
    }
}

impl BodyPose {
    /// The place of a point of the body.
    fn apply(&self, p: &[f64; 3]) -> [f64; 3] {
        let [x, y, z, w] = self.rotation;
        let q = [x, y, z];
        let cross = |a: &[f64; 3], b: &[f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let turn = cross(&q, p);
        let twice = cross(&q, &turn);
        [0, 1, 2].map(|k| p[k] + 2.0 * (w * turn[k] + twice[k]) + self.translation[k])
    }
}

impl From<Isometry3<f64>> for BodyPose {
    fn from(pose: Isometry3<f64>) -> Self {
        let q = pose.rotation.quaternion();
        Self {
            rotation: [q.i, q.j, q.k, q.w],
            translation: pose.translation.vector.into(),
        }
    }
}
