//! Meshes of disks, and what their rims do.

use crate::report::Effort;
use anyhow::Result;
use isosheet_mesh::generate::Diagonals;
use isosheet_mesh::{Sheet, VertexId, generate};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Disk {
    /// Circles about the centre: every ray from the centre is close to mesh lines.
    #[serde(rename = "concentric")]
    Concentric,
    /// Squares with alternating diagonals, the squares about the centre made circles.
    #[serde(rename = "union jack")]
    UnionJack,
    /// Irregular.
    #[serde(rename = "Delaunay 1")]
    Delaunay1,
    #[serde(rename = "Delaunay 2")]
    Delaunay2,
    #[serde(rename = "Delaunay 3")]
    Delaunay3,
}

/// A mesh: the spacing is the radius over `rings`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct DiskJob {
    pub(super) mesh: Disk,
    #[serde(rename = "R/h")]
    pub(super) rings: usize,
}

/// Radius of disks that become cones, metres.
pub(super) const RADIUS: f64 = 0.1;

impl DiskJob {
    /// The meshes that are compared; the finest is the last of each kind.
    pub(super) fn all(effort: Effort) -> Vec<Self> {
        let sizes: &[usize] = effort.quick_or(&[4], &[6, 10, 16]);
        let kinds = effort.quick_or(&Disk::ALL[2..3], &Disk::ALL[..]);
        let of = |&mesh: &Disk| sizes.iter().map(move |&rings| Self { mesh, rings });
        kinds.iter().flat_map(of).collect()
    }

    pub(super) fn sheet(self) -> Result<Sheet> {
        self.mesh.sheet(self.rings, RADIUS)
    }
}

/// Corners of irregular disks.
const CORNERS: usize = 60;

impl Disk {
    pub(super) const ALL: [Self; 5] = [
        Self::Concentric,
        Self::UnionJack,
        Self::Delaunay1,
        Self::Delaunay2,
        Self::Delaunay3,
    ];

    /// The disk about the origin with the spacing `radius / rings` (metres).
    fn sheet(self, rings: usize, radius: f64) -> Result<Sheet> {
        let irregular = |seed: u64| -> Result<Sheet> {
            let corner = |k: usize| {
                let (s, c) = (TAU * k as f64 / CORNERS as f64).sin_cos();
                [radius * c, radius * s]
            };
            let outline: Vec<[f64; 2]> = (0..CORNERS).map(corner).collect();
            let spacing = radius / rings as f64;
            Ok(generate::delaunay(&outline, spacing, seed)?)
        };
        Ok(match self {
            Self::Concentric => generate::disk(rings, radius)?,
            Self::UnionJack => {
                let n = 2 * rings;
                let square = generate::grid(n, n, 2.0, 2.0, Diagonals::UnionJack)?;
                square.map_positions(|[x, y, z]| {
                    let (x, y) = (x - 1.0, y - 1.0);
                    // Squares about the centre become circles.
                    let scale = radius * x.abs().max(y.abs()) / x.hypot(y).max(f64::MIN_POSITIVE);
                    [scale * x, scale * y, z]
                })?
            }
            Self::Delaunay1 => irregular(1)?,
            Self::Delaunay2 => irregular(2)?,
            Self::Delaunay3 => irregular(3)?,
        })
    }
}

/// The vertices of the rim in the order of their angles, with these (radians).
pub(super) fn rim(sheet: &Sheet) -> Vec<(f64, VertexId)> {
    let rim = sheet.topology().boundary_loops().concat().into_iter();
    let place = |v: VertexId| {
        let [x, y, _] = sheet.position(v);
        (y.atan2(x), v)
    };
    let mut rim: Vec<_> = rim.map(place).collect();
    rim.sort_by(|a, b| a.0.total_cmp(&b.0));
    rim
}

/// A part of the rim above some height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    /// Radians.
    pub(super) angle: f64,
    /// The largest height.
    pub(super) height: f64,
}

/// The parts of a rim whose heights are above `bound`, between places that are interpolated; `rim` has angles
/// and heights around the rim, in order.
pub(super) fn arcs(rim: &[[f64; 2]], bound: f64) -> Vec<Arc> {
    let n = rim.len();
    // Begin below, if any vertex is there.
    let start = rim.iter().position(|l| l[1] <= bound).unwrap_or(0);
    let mut arcs = Vec::new();
    let mut open: Option<Arc> = None;
    for k in 0..n {
        let [[a, low], [b, high]] = [k, k + 1].map(|i| rim[(start + i) % n]);
        let width = (b - a).rem_euclid(TAU);
        let part = ((bound - low) / (high - low)).clamp(0.0, 1.0);
        let angle = match (low > bound, high > bound) {
            (false, false) => continue,
            (false, true) => width * (1.0 - part),
            (true, true) => width,
            (true, false) => width * part,
        };
        let height = low.max(high);
        let arc = open.get_or_insert(Arc { angle: 0.0, height });
        arc.angle += angle;
        arc.height = arc.height.max(height);
        if high <= bound {
            arcs.extend(open.take());
        }
    }
    arcs.extend(open);
    arcs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disks_have_their_rim_on_the_circle() {
        for disk in Disk::ALL {
            let sheet = disk.sheet(6, 0.1).unwrap();
            assert_eq!(sheet.topology().boundary_loops().len(), 1, "{disk:?}");
            for (_, v) in rim(&sheet) {
                let [x, y, _] = sheet.position(v);
                assert!((0.099..0.1 + 1e-10).contains(&x.hypot(y)), "{disk:?}");
            }
        }
    }

    /// Two parts of a rim of eight vertices are above, one of them over the end of the list.
    #[test]
    fn arcs_are_counted_around_the_rim() {
        let heights = [1.0, 1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 1.0];
        let eighth = TAU / 8.0;
        let around: Vec<[f64; 2]> = (0_u8..)
            .map(f64::from)
            .zip(heights)
            .map(|(k, z)| [k * eighth, z])
            .collect();
        let found = arcs(&around, 0.5);
        assert_eq!(found.len(), 2);
        assert!(
            (found[0].angle - eighth * 5.0 / 3.0).abs() < 1e-12,
            "{found:?}"
        );
        assert!((found[1].angle - eighth * 3.0).abs() < 1e-12, "{found:?}");
        assert_eq!((found[0].height, found[1].height), (3.0, 1.0));
        assert!(arcs(&around, 4.0).is_empty());
        assert!((arcs(&around, -1.0)[0].angle - TAU).abs() < 1e-12);
    }
}
