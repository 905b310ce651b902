//! What Fig. 16 says of its scenes: a strip of paper, a nip that moves it, and the walls of a guide.

use crate::runs::FigureScene;
use anyhow::Result;
use isosheet_io::scene::{Profile, Wall};

/// What the figure says of a scene.
pub(super) struct Feed {
    /// Inner and outer wall of the guide, and the plate that closes it if there is one.
    pub(super) walls: Vec<Wall>,
    /// Length and width of the strip, metres, and its cells along these.
    pub(super) size: [f64; 2],
    pub(super) cells: [usize; 2],
    /// Flexural rigidity of the paper, newton metres.
    pub(super) rigidity: f64,
    /// How far the nip has moved by time, metres.
    pub(super) displacement: Profile,
    /// The nip slips at this force, newtons: then the run ends.
    pub(super) limit: f64,
    /// Gap below which contact acts, metres.
    pub(super) activation: f64,
}

impl Feed {
    pub(super) fn of(scene: &FigureScene) -> Result<Self> {
        let bodies = 0..scene.scene().obstacle.len();
        let walls = bodies.map(|k| scene.value(&format!("/obstacle/{k}/shape/wall")));
        let of_mesh = |key: &str| format!("/sheet/mesh/rectangle/{key}");
        Ok(Self {
            walls: walls.collect::<Result<_>>()?,
            size: [
                scene.value(&of_mesh("width"))?,
                scene.value(&of_mesh("height"))?,
            ],
            cells: [
                scene.value(&of_mesh("columns"))?,
                scene.value(&of_mesh("rows"))?,
            ],
            rigidity: scene.value("/sheet/bending/hinges/rigidity")?,
            displacement: scene.value("/support/0/hold/moving_pin/x")?,
            limit: scene.value("/stop/support_force")?,
            activation: scene.value("/contact/activation")?,
        })
    }

    /// Radius of the middle line of the bend, metres.
    pub(super) fn radius(&self) -> f64 {
        0.5 * (self.walls[INNER].corner_radius + self.walls[OUTER].corner_radius)
    }

    /// Distance of the walls, metres.
    pub(super) fn channel(&self) -> f64 {
        self.walls[OUTER].line[0][1] - self.walls[INNER].line[0][1]
    }

    /// Speed of the nip once it moves evenly, metres per second: that in the middle of its way.
    pub(super) fn speed(&self) -> f64 {
        let (t, h) = (0.4, 0.1);
        (self.displacement.value(t + h) - self.displacement.value(t)) / h
    }

    /// The plate that closes the outlet.
    pub(super) fn plate(&self) -> Option<&Wall> {
        self.walls.get(PLATE)
    }
}

/// The numbers of the walls among the bodies.
pub(super) const INNER: usize = 0;
pub(super) const OUTER: usize = 1;
pub(super) const PLATE: usize = 2;
