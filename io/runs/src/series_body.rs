//! Obstacles for files of other programs.

use isosheet_collide::Obstacle;
use isosheet_formats::{BodyPose, SeriesBody};
use isosheet_geometry::Triangles;

/// Sides of the circles of round bodies: their surface is at most 0.1 % of the radius off.
const SIDES: usize = 64;

/// An obstacle of a scene at the times (seconds) of the frames of a trajectory. Of a half-space there
/// is a square in its plane, about the origin of its frame and with this half side (metres).
pub fn series_body(name: String, obstacle: &Obstacle, times: &[f64], half: f64) -> SeriesBody {
    // The sides are enough for any shape.
    let mesh = obstacle.shape().triangles(SIDES).ok().flatten();
    let mesh = mesh.unwrap_or_else(|| Triangles::square(half));
    let mut poses: Vec<BodyPose> = Vec::with_capacity(times.len());
    for t in times {
        let pose = obstacle.motion().pose(*t);
        let q = pose.rotation.quaternion();
        let mut rotation = [q.i, q.j, q.k, q.w];
        // A quaternion and its negative are one rotation, and programs interpolate between
        // neighbours.
        let dot = |p: &BodyPose| (0..4).map(|k| p.rotation[k] * rotation[k]).sum::<f64>();
        if poses.last().is_some_and(|p| dot(p) < 0.0) {
            rotation = rotation.map(|c| -c);
        }
        poses.push(BodyPose {
            rotation,
            translation: pose.translation.vector.into(),
        });
    }
    if poses.windows(2).all(|pair| pair[0] == pair[1]) {
        poses.truncate(1);
    }
    SeriesBody {
        name,
        positions: mesh.points.concat(),
        faces: mesh.faces,
        poses,
    }
}
