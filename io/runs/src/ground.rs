//! The ground of pictures and pages of runs without a floor, which shows shadows alone.

use super::Recording;
use isosheet_collide::Obstacle;
use nalgebra::Point3;

/// How far the ground is below bodies that stand on it, as part of the size of the space that the sheet
/// passes through: nothing lies in its plane.
const STANDING: f64 = 0.01;

/// How far the ground is below a sheet that is lower than all bodies, and so hangs or falls, as part of the
/// size of the space that the sheet passes through.
const HANGING: f64 = 0.1;

/// Sides of round bodies, whose lowest points count.
const SIDES: usize = 32;

impl Recording {
    /// The height of the ground, metres, below all that a run shows at some times: the sheet, which is in the
    /// box between two corners, and its bodies. None where the scene has no gravity along z, and so no side
    /// that is below, or a half-space, which is a floor, a wall or a slope.
    pub fn ground(&self, times: &[f64], [low, high]: [[f64; 3]; 2]) -> Option<f64> {
        let gravity = self.scene.scene().forces.gravity?;
        let is_down = gravity[0] == 0.0 && gravity[1] == 0.0 && gravity[2] < 0.0;
        let is_plane = |body: &Obstacle| body.shape().bounds().is_none();
        if !is_down || self.obstacles.iter().any(is_plane) {
            return None;
        }
        let bodies = self.obstacles.iter().filter_map(|body| lowest(body, times));
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let standing = bodies.reduce(f64::min).filter(|body| *body <= low[2]);
        Some(match standing {
            Some(body) => body - STANDING * size,
            None => low[2] - HANGING * size,
        })
    }
}

/// The lowest height of a body at some times, metres.
fn lowest(body: &Obstacle, times: &[f64]) -> Option<f64> {
    let mesh = body.shape().triangles(SIDES).ok()??;
    let mut poses: Vec<_> = times.iter().map(|t| body.motion().pose(*t)).collect();
    poses.dedup();
    let heights = poses.iter().flat_map(|pose| {
        let points = mesh.points.iter();
        points.map(move |p| (pose * Point3::from(*p)).z)
    });
    heights.reduce(f64::min)
}
