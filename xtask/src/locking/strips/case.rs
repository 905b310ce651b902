//! What is done to a strip, and the answer of the elastica.

use crate::locking::grids::Grid;
use crate::locking::isometry::PAPER_RIGIDITY;
use crate::locking::meshes::{vertices, with_line};
use crate::locking::model::{Model, Plate};
use crate::locking::nudge::Nudge;
use anyhow::Result;
use isosheet_dynamics::{PointProfile, Profile, SheetModel};
use isosheet_mesh::{Sheet, VertexId};
use isosheet_tests::{Elastica, buckled};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Unit of length, metres: the width. Length of the free part, and of each clamp.
pub(super) const WIDTH: f64 = 0.1;
pub(super) const LENGTH: f64 = 4.0 * WIDTH;
const CLAMP: f64 = 0.5 * WIDTH;

/// Distance of the clamps of the strip that is pushed together.
const PUSHED: f64 = 1.2 * WIDTH;

/// Mass per area (kg/m2), flexural rigidity (N m), rate of damping (1/s).
pub(super) const DENSITY: f64 = 0.08;
pub(super) const RIGIDITY: f64 = PAPER_RIGIDITY;
const DAMPING: f64 = 4.0;

/// How long the clamps move, and until when a force chooses the side, seconds.
const MOVING: f64 = 4.0;
const NUDGED: f64 = 2.0;

/// The force that chooses the side, over `D / a`: it lifts the middle of the flat strip by about a tenth of
/// its width.
const NUDGE: f64 = 0.5;

/// What is done to a strip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Case {
    /// A load upwards, 1.6 in units of `D / L^3`: the one of Bartels.
    Loaded,
    /// A weight in units of `D / L^3`.
    Heavy(f64),
    Pushed,
}

impl Case {
    pub(super) const ALL: [Self; 5] = [
        Self::Loaded,
        Self::Heavy(1.0),
        Self::Heavy(10.0),
        Self::Heavy(100.0),
        Self::Pushed,
    ];

    /// Load per area, newtons per square metre, and its sign along z.
    pub(super) fn load(self) -> Option<(f64, f64)> {
        let unit = RIGIDITY / LENGTH.powi(3);
        match self {
            Self::Loaded => Some((0.025 * RIGIDITY / WIDTH.powi(3), 1.0)),
            Self::Heavy(gamma) => Some((gamma * unit, -1.0)),
            Self::Pushed => None,
        }
    }

    /// Energy in joules and the place of the tip or of the middle, metres (along x and z).
    pub(super) fn exact(self) -> Exact {
        let Some((weight, sign)) = self.load() else {
            let [energy, height] = buckled(PUSHED / LENGTH);
            return Exact {
                energy: energy * RIGIDITY * WIDTH / LENGTH,
                place: [0.5 * PUSHED, height * LENGTH],
            };
        };
        let elastica = Elastica {
            length: LENGTH,
            rigidity: RIGIDITY,
            weight,
        };
        let hanging = elastica.at_rest();
        Exact {
            energy: hanging.energy * WIDTH,
            place: [hanging.tip[0], sign * hanging.tip[1]],
        }
    }

    pub(super) fn sheet(self, grid: Grid, across: usize) -> Result<Sheet> {
        let cell = WIDTH / across as f64;
        let beyond = match self {
            Self::Pushed => CLAMP,
            _ => 0.0,
        };
        let sheet = grid.rectangle([-CLAMP, 0.0], [LENGTH + beyond, WIDTH], cell)?;
        let sheet = with_line(&sheet, 0.0, cell)?;
        match self {
            Self::Pushed => with_line(&with_line(&sheet, 0.5 * LENGTH, cell)?, LENGTH, cell),
            _ => Ok(sheet),
        }
    }

    pub(super) fn clamp(self, sheet: &Sheet) -> Vec<VertexId> {
        let beyond = match self {
            Self::Pushed => LENGTH - 1e-9,
            _ => f64::INFINITY,
        };
        vertices(sheet, |[x, ..]| x < 1e-9 || x > beyond)
    }

    pub(super) fn model(self, model: Model, sheet: &Sheet) -> Result<SheetModel> {
        let clamp = self.clamp(sheet);
        let moved = model.sheet(sheet, plate(&clamp))?.with_damping(DAMPING)?;
        if let Some((load, sign)) = self.load() {
            let moved = moved.with_acceleration([0.0, 0.0, sign * load / DENSITY]);
            return Ok(moved.with_pins(&clamp)?);
        }
        let middle = middle(sheet);
        let force = NUDGE * RIGIDITY / WIDTH / middle.len().max(1) as f64;
        let mut moved = moved.with_potential(Nudge {
            forces: middle.into_iter().map(|v| (v, force)).collect(),
            end: NUDGED,
        });
        for v in clamp {
            let push = Profile::SmoothStep {
                from: 0.0,
                to: PUSHED - LENGTH,
                begin: 0.0,
                end: MOVING,
            };
            let offset = sheet.position(v);
            moved = if offset[0] < 1e-9 {
                moved.with_pins(&[v])?
            } else {
                let motion = PointProfile {
                    offset,
                    x: push,
                    ..PointProfile::default()
                };
                moved.with_moving_pin(v, motion)?
            };
        }
        Ok(moved)
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Loaded => f.write_str("loaded"),
            Self::Heavy(gamma) => write!(f, "heavy, Γ = {gamma}"),
            Self::Pushed => f.write_str("pushed together"),
        }
    }
}

/// The answer of the elastica.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Exact {
    /// Joules.
    pub(super) energy: f64,
    /// Metres along x and z.
    pub(super) place: [f64; 2],
}

pub(super) fn plate(clamped: &[VertexId]) -> Plate<'_> {
    Plate {
        density: DENSITY,
        rigidity: RIGIDITY,
        clamped,
        creases: &[],
    }
}

/// The vertices on the middle line of a strip that is pushed together.
pub(super) fn middle(sheet: &Sheet) -> Vec<VertexId> {
    vertices(sheet, |[x, ..]| (x - 0.5 * LENGTH).abs() < 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_strip_has_its_clamps_and_its_middle() {
        for case in Case::ALL {
            for grid in Grid::ALL {
                for across in [2, 4] {
                    let sheet = case.sheet(grid, across).unwrap();
                    let on = |x: f64| vertices(&sheet, |p| (p[0] - x).abs() < 1e-9).len();
                    assert!(on(0.0) > across && on(LENGTH) > across, "{case} {grid}");
                    assert!(case.clamp(&sheet).len() > on(0.0));
                    assert!(case != Case::Pushed || middle(&sheet).len() > across);
                }
            }
        }
    }
}
