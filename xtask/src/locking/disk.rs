//! Triangulations of a disk.

use anyhow::Result;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Radius of the disk, metres.
pub(super) const DISK: f64 = 0.5;

/// A triangulation of the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Mesh {
    Concentric,
    Delaunay,
    UnionJack,
}

impl Mesh {
    pub(super) const ALL: [Self; 3] = [Self::Concentric, Self::Delaunay, Self::UnionJack];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Concentric => "concentric",
            Self::Delaunay => "Delaunay",
            Self::UnionJack => "union jack",
        }
    }

    /// The disk with rods about 1 / `rings` of its radius long, turned by an angle that the seed chooses.
    pub(super) fn disk(self, rings: usize, seed: u64) -> Result<Sheet> {
        let sheet = match self {
            Self::Concentric => generate::disk(rings, DISK)?,
            Self::Delaunay => {
                let sides = 6 * rings;
                let corner = |k: usize| {
                    let (s, c) = (TAU * k as f64 / sides as f64).sin_cos();
                    [DISK * c, DISK * s]
                };
                let outline: Vec<[f64; 2]> = (0..sides).map(corner).collect();
                generate::delaunay(&outline, TAU * DISK / sides as f64, seed)?
            }
            Self::UnionJack => {
                let n = 2 * rings;
                let grid = generate::grid(n, n, 2.0 * DISK, 2.0 * DISK, Diagonals::UnionJack)?;
                let grid = grid.map_positions(|[x, y, z]| [x - DISK, y - DISK, z])?;
                let t = grid.topology();
                let is_inside = |v: &VertexId| {
                    let [x, y, _] = grid.position(*v);
                    x.hypot(y) < DISK + 1e-9
                };
                grid.keep_faces(|f| t.faces()[f.index()].iter().all(is_inside))?
            }
        };
        // The golden angle: no two seeds are near one another.
        let (s, c) = (2.399_963 * seed as f64).sin_cos();
        Ok(sheet.map_positions(|[x, y, z]| [c * x - s * y, s * x + c * y, z])?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disks_have_one_rim_about_the_centre() {
        for mesh in Mesh::ALL {
            for seed in 0..10 {
                let sheet = mesh.disk(4, seed).unwrap();
                let loops = sheet.topology().boundary_loops();
                assert_eq!(loops.len(), 1);
                for v in &loops[0] {
                    let [x, y, _] = sheet.position(*v);
                    assert!((0.3..0.501).contains(&x.hypot(y)));
                }
            }
        }
    }
}
