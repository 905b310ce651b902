//! What is measured of a square sheet that hangs from a corner.

use super::FigureScene;
use anyhow::{Result, bail};
use isosheet_mesh::{Sheet, VertexId};
use isosheet_scenes::Mesh;

/// A square sheet that is held at one vertex, as Figs. 11 and 12 have it.
#[derive(Clone, Debug)]
pub(crate) struct Hanging {
    /// Level k of the mesh M^k.
    pub(crate) level: u32,
    /// Side, metres.
    pub(crate) side: f64,
    /// The vertex that is held.
    pub(crate) pin: VertexId,
    /// The sheet at rest.
    pub(crate) sheet: Sheet,
}

impl Hanging {
    /// Of a scene.
    ///
    /// # Errors
    /// A scene whose sheet is not a square, or is not held at one vertex.
    pub(crate) fn of(scene: &FigureScene) -> Result<Self> {
        let Mesh::Square { side, level } = scene.scene().sheet[0].mesh else {
            bail!("{}: the sheet is not a square", scene.name());
        };
        let setup = scene.setup()?;
        let [pin] = setup.model.pins()[..] else {
            bail!("{}: the sheet is not held at one vertex", scene.name());
        };
        Ok(Self {
            level,
            side,
            pin,
            sheet: setup.facts.sheet.clone(),
        })
    }
}

/// Mass of the sheet of a scene, kilograms.
///
/// # Errors
/// As [`FigureScene::setup`].
pub(crate) fn mass(scene: &FigureScene) -> Result<f64> {
    Ok(scene.setup()?.model.mass().vertex.iter().sum())
}
