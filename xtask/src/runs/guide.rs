//! The path of paper through a bent guide.

use anyhow::Result;
use isosheet_collide::{Obstacle, Shape, TriangleSurface};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// A channel between two walls: straight along +x at height 0, a quarter turn downwards that starts at x = 0,
/// straight down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Guide {
    /// Radius of the middle line in the bend, metres; at least half the channel.
    pub(crate) radius: f64,
    /// Distance of the walls, metres.
    pub(crate) channel: f64,
    /// Width of the walls, metres.
    pub(crate) width: f64,
    /// Lengths of the straight parts before and after the bend, metres.
    pub(crate) straight: [f64; 2],
    pub(crate) outlet: Outlet,
}

/// The end of the channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Outlet {
    Open,
    /// Closed by a plate, as by a sheet that is stuck there.
    Blocked,
}

/// Segments of a wall in the bend.
const SEGMENTS: usize = 16;

impl Guide {
    /// A wall at the distance `side` outwards from the middle line, as x and z from the inlet to the outlet.
    pub(crate) fn wall(&self, side: f64) -> Vec<[f64; 2]> {
        let (middle, radius) = (-self.radius, self.radius + side);
        let mut points = vec![[-self.straight[0], side]];
        let bends = if radius > 1e-9 { SEGMENTS } else { 0 };
        for k in 0..=bends {
            let (s, c) = (FRAC_PI_2 * k as f64 / bends.max(1) as f64).sin_cos();
            points.push([radius * s, middle + radius * c]);
        }
        points.push([radius, middle - self.straight[1]]);
        points
    }

    /// The plate that closes the outlet, from the inner to the outer wall.
    pub(crate) fn plate(&self) -> Option<[[f64; 2]; 2]> {
        let (half, depth) = (0.5 * self.channel, -self.radius - self.straight[1]);
        let ends = [[self.radius - half, depth], [self.radius + half, depth]];
        (self.outlet == Outlet::Blocked).then_some(ends)
    }

    /// Inner and outer wall, and the plate if there is one.
    pub(crate) fn bodies(&self) -> Result<Vec<Obstacle>> {
        let half = 0.5 * self.channel;
        let walls = [self.wall(-half), self.wall(half)].into_iter();
        walls
            .chain(self.plate().map(Vec::from))
            .map(|line| {
                let y = 0.5 * self.width;
                let positions: Vec<f64> = line
                    .iter()
                    .flat_map(|[x, z]| [*x, -y, *z, *x, y, *z])
                    .collect();
                let faces: Vec<[u32; 3]> = (0..line.len() as u32 - 1)
                    .flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]])
                    .collect();
                let surface = TriangleSurface::new(&positions, &faces)?;
                let shape = Shape::Surface(Arc::new(surface));
                Ok(Obstacle::fixed(shape, Isometry3::identity())?)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_walls_keep_their_distance() {
        let guide = Guide {
            radius: 0.02,
            channel: 0.01,
            width: 0.1,
            straight: [0.1, 0.05],
            outlet: Outlet::Open,
        };
        let (inner, outer) = (guide.wall(-0.005), guide.wall(0.005));
        assert_eq!(inner.len(), outer.len());
        for (p, q) in inner.iter().zip(&outer) {
            assert!(((p[0] - q[0]).hypot(p[1] - q[1]) - 0.01).abs() < 1e-15);
        }
        assert_eq!(guide.bodies().unwrap().len(), 2);
        // A sharp inner corner.
        let sharp = Guide {
            radius: 0.005,
            outlet: Outlet::Blocked,
            ..guide
        };
        assert_eq!(sharp.bodies().unwrap().len(), 3);
    }
}
