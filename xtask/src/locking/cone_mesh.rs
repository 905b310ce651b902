//! The meshes of disks that become cones.

use anyhow::Result;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::fmt;

/// Radius, metres.
pub(super) const RADIUS: f64 = 0.1;

/// Corners of irregular disks.
const CORNERS: usize = 60;

/// A mesh: the spacing is the radius over `rings`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Mesh {
    pub(super) kind: Kind,
    pub(super) rings: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Kind {
    /// Circles about the centre: every ray from the centre is close to mesh lines.
    Concentric,
    /// Squares with alternating diagonals, the squares about the centre made circles.
    UnionJack,
    /// Irregular, with a seed.
    Delaunay(u64),
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Concentric => f.write_str("concentric"),
            Self::UnionJack => f.write_str("union jack"),
            Self::Delaunay(seed) => write!(f, "Delaunay {seed}"),
        }
    }
}

impl Mesh {
    /// The disk about the origin.
    pub(super) fn disk(self) -> Result<Sheet> {
        let cell = RADIUS / self.rings as f64;
        let corner = |k: usize| {
            let (s, c) = (TAU * k as f64 / CORNERS as f64).sin_cos();
            [RADIUS * c, RADIUS * s]
        };
        Ok(match self.kind {
            Kind::Concentric => generate::disk(self.rings, RADIUS)?,
            Kind::UnionJack => {
                let n = 2 * self.rings;
                let square = generate::grid(n, n, 2.0, 2.0, Diagonals::UnionJack)?;
                square.map_positions(|[x, y, z]| {
                    let (x, y) = (x - 1.0, y - 1.0);
                    // Squares about the centre become circles.
                    let scale = RADIUS * x.abs().max(y.abs()) / x.hypot(y).max(f64::MIN_POSITIVE);
                    [scale * x, scale * y, z]
                })?
            }
            Kind::Delaunay(seed) => {
                let outline: Vec<[f64; 2]> = (0..CORNERS).map(corner).collect();
                generate::delaunay(&outline, cell, seed)?
            }
        })
    }
}

impl Kind {
    /// Those that are compared.
    pub(super) const ALL: [Self; 5] = [
        Self::Concentric,
        Self::UnionJack,
        Self::Delaunay(1),
        Self::Delaunay(2),
        Self::Delaunay(3),
    ];
}

/// The vertices of the rim in the order of their angles.
pub(super) fn rim(sheet: &Sheet) -> Vec<VertexId> {
    let mut rim: Vec<VertexId> = sheet.topology().boundary_loops().concat();
    let angle = |v: &VertexId| {
        let [x, y, _] = sheet.position(*v);
        y.atan2(x)
    };
    rim.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    rim
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disks_have_their_rim_on_the_circle() {
        for kind in Kind::ALL {
            let sheet = Mesh { kind, rings: 6 }.disk().unwrap();
            assert_eq!(sheet.topology().boundary_loops().len(), 1, "{kind}");
            for v in rim(&sheet) {
                let [x, y, _] = sheet.position(v);
                assert!(
                    (0.99..1.0 + 1e-9).contains(&(x.hypot(y) / RADIUS)),
                    "{kind}"
                );
            }
        }
    }
}
