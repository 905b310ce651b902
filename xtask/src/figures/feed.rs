//! What Fig. 16 says of its scenes: a strip of paper, a nip that moves it, and the walls of a guide.

use anyhow::{Context as _, Result, bail, ensure};
use isosheet_io::scene::{Bending, Hold, Mesh, Profile, Scene, Shape, Wall};

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
    pub(super) fn of(scene: &Scene) -> Result<Self> {
        let Mesh::Rectangle {
            width,
            height,
            columns,
            rows,
            ..
        } = scene.sheet.mesh
        else {
            bail!("the strip is a rectangle");
        };
        let Bending::Hinges { rigidity } = scene.sheet.bending else {
            bail!("the strip resists bending at its edges");
        };
        let Some(Hold::MovingPin(nip)) = scene.support.first().map(|s| &s.hold) else {
            bail!("a nip moves the strip");
        };
        let walls = scene.obstacle.iter().map(|body| match &body.shape {
            Shape::Wall(wall) => Ok(wall.clone()),
            other => bail!("the guide has walls, not {other:?}"),
        });
        let walls = walls.collect::<Result<Vec<_>>>()?;
        ensure!(walls.len() > OUTER, "a guide has two walls");
        Ok(Self {
            walls,
            size: [width, height],
            cells: [columns, rows],
            rigidity,
            displacement: nip.x.clone(),
            limit: scene.stop.support_force.context("the nip slips")?,
            activation: scene.contact.activation.context("a gap of contact")?,
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
