//! Crease patterns folded by driven angles.

use super::Staged;
use anyhow::Result;
use isosheet_dynamics::{
    CreaseSpring, CreaseSprings, Interpolation, Method, Profile, SheetModel, Simulation, State,
};
use isosheet_mesh::generate::{FoldAssignment, FoldPattern, degree_four, miura};
use isosheet_mesh::origami::{DegreeFour, FoldingMode, Miura};
use isosheet_mesh::{EdgeId, MassKind, Sheet, VertexId};
use serde::{Deserialize, Serialize};

/// A crease pattern and which of its creases are driven.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Creases {
    /// Miura's pattern: the zigzags are driven, the straight creases are free hinges.
    Miura {
        /// Panels along the zigzags and along the straight creases.
        panels: [usize; 2],
        /// Length of the straight creases and of the zigzags' parts, metres.
        sides: [f64; 2],
        /// Acute angle of the panels, radians.
        angle: f64,
    },
    /// A vertex of degree four: one crease is driven, the others are told weakly to which side they fold.
    Vertex {
        /// Angles from crease 1 to 2 and from 2 to 3, radians.
        sectors: [f64; 2],
        /// Length of the creases, metres.
        radius: f64,
        /// Whether creases 1 and 3 fold alike, or 2 and 4.
        mode: Alike,
    },
}

/// The creases of a vertex of degree four that fold alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Alike {
    Odd,
    Even,
}

impl Alike {
    pub(crate) fn mode(self) -> FoldingMode {
        match self {
            Self::Odd => FoldingMode::OddAlike,
            Self::Even => FoldingMode::EvenAlike,
        }
    }

    /// The crease, from 0, that folds most and is driven.
    pub(crate) fn lead(self) -> usize {
        match self {
            Self::Odd => 0,
            Self::Even => 1,
        }
    }
}

/// Everything that decides how a run goes: the sheet starts exactly flat and at rest, free in space, without
/// gravity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fold {
    /// Name of the folder of the run.
    pub(crate) name: String,
    pub(crate) creases: Creases,
    /// Mass of a square metre, kilograms.
    pub(crate) weight: f64,
    /// Rest angle of the driven creases in the end, radians, and the time that it takes to get there,
    /// seconds.
    pub(crate) full: f64,
    pub(crate) duration: f64,
    /// Stiffness of the driven creases, newtons (newton metres per radian and metre of crease).
    pub(crate) drive: f64,
    /// Stiffness of the edges inside panels, and of creases that are told only to which side they fold, as
    /// multiples of that of the drive.
    pub(crate) panel: f64,
    pub(crate) hint: f64,
    /// Rate of the velocity damping, 1/s.
    pub(crate) damping: f64,
    /// Time between frames, seconds.
    pub(crate) frame: f64,
    /// Number of frames after the first.
    pub(crate) frames: usize,
}

impl Fold {
    /// The pattern.
    pub(crate) fn pattern(&self) -> Result<FoldPattern> {
        Ok(match self.creases {
            Creases::Miura {
                panels: [columns, rows],
                sides: [straight, zigzag],
                angle,
            } => miura(columns, rows, straight, zigzag, angle)?,
            Creases::Vertex {
                sectors,
                radius,
                mode,
            } => {
                let exact = DegreeFour { sectors };
                degree_four(sectors, radius, exact.assignment(mode.mode()))?
            }
        })
    }

    /// The kinematics of the Miura pattern with rigid panels.
    pub(crate) fn miura(&self) -> Option<Miura> {
        match self.creases {
            Creases::Miura {
                sides: [straight, zigzag],
                angle,
                ..
            } => Some(Miura {
                straight,
                zigzag,
                angle,
            }),
            Creases::Vertex { .. } => None,
        }
    }

    /// The rest angle of a driven crease, radians: a cubic ramp, level at both ends.
    fn drive(&self, sign: f64) -> Profile {
        Profile::Keyframes {
            interpolation: Interpolation::MonotoneCubic,
            keys: vec![[0.0, 0.0], [self.duration, sign * self.full]],
        }
    }

    /// Whether an edge is a driven crease.
    pub(crate) fn is_driven(&self, pattern: &FoldPattern, e: EdgeId) -> bool {
        let [a, b] = pattern.sheet.topology().edges()[e.index()].map(VertexId::index);
        pattern.assignment(e).sign() != 0.0
            && match self.creases {
                Creases::Miura { .. } => b - a == 1,
                Creases::Vertex { mode, .. } => b == mode.lead() + 1,
            }
    }

    fn springs(&self, pattern: &FoldPattern) -> Result<CreaseSprings> {
        let t = pattern.sheet.topology();
        let mut springs = Vec::new();
        for edge in t.edge_ids() {
            let assignment = pattern.assignment(edge);
            let share = match assignment {
                FoldAssignment::Boundary => continue,
                FoldAssignment::Flat => self.panel,
                _ if self.is_driven(pattern, edge) => 1.0,
                _ => self.hint,
            };
            let sign = assignment.sign();
            springs.push(CreaseSpring {
                edge,
                stiffness: share * self.drive * pattern.sheet.lengths()[edge.index()],
                rest: if sign == 0.0 {
                    0.0.into()
                } else {
                    self.drive(sign).into()
                },
            });
        }
        Ok(CreaseSprings::new(t, springs)?)
    }
}

impl Staged for Fold {
    fn name(&self) -> &str {
        &self.name
    }

    fn frame(&self) -> f64 {
        self.frame
    }

    fn frames(&self) -> usize {
        self.frames
    }

    fn sheet(&self) -> Result<Sheet> {
        Ok(self.pattern()?.sheet)
    }

    fn simulation(&self, sheet: &Sheet) -> Result<Simulation> {
        let springs = self.springs(&self.pattern()?)?;
        let model = SheetModel::new(sheet, self.weight * sheet.area(), MassKind::Lumped)?
            .with_potential(springs)
            .with_damping(self.damping)?;
        let state = State::at_rest(sheet.positions().to_vec());
        Ok(Simulation::new(model, state, Method::default())?)
    }
}
