//! A hand that holds a vertex of a simulation.

use super::LiveScene;
use crate::SceneError;
use crate::meshes::selection::bounds;
use isosheet_dynamics::{Hand, HandError};
use isosheet_mesh::{Advice, VertexId};
use thiserror::Error;

/// The stretch of the spring of a hand under the whole weight of the sheet, as a part of its size: a vertex
/// that carries all of it seems to be where the hand is, and light sheets do not shake at it.
const STRETCH: f64 = 0.01;

/// Standard gravity, m/s2: a sheet without weight is held as firmly as one with it.
const GRAVITY: f64 = 9.80665;

/// Why a vertex cannot be held.
#[derive(Debug, Error)]
pub enum HoldError {
    /// The vertex cannot move.
    #[error("vertex {} cannot be pulled at: a support holds it in place", vertex.index())]
    Held {
        /// The vertex.
        vertex: VertexId,
    },
    /// It is one of the surface of a body.
    #[error("vertex {} is one of a body", vertex.index())]
    Body {
        /// The vertex.
        vertex: VertexId,
    },
    /// The hand.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// The scene cannot be built.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Advice for HoldError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Held { .. } => Some("pull at another vertex"),
            Self::Body { .. } => Some("pull at a vertex of a sheet"),
            Self::Hand(error) => error.advice(),
            Self::Scene(error) => error.advice(),
        }
    }
}

impl LiveScene {
    /// Holds a vertex by a spring from now on, in place of any held before. It pulls at nothing until
    /// [`LiveScene::lead`] moves its other end, which costs nothing. Its stiffness is `M g / (d / 100)` with
    /// the mass `M` of the sheet, standard gravity `g` and the diagonal `d` of the box around the rest shape:
    /// the weight of the whole sheet stretches it by a hundredth of that. What it does is work. Returns where
    /// it is, metres.
    ///
    /// ```
    /// use isosheet_scenes::{LiveScene, SceneFile, StartingPoint};
    /// use isosheet_mesh::VertexId;
    /// use std::path::Path;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let text = StartingPoint::Hanging.text().into();
    /// let mut live = LiveScene::start(SceneFile::parse(text, Path::new("sheet.toml"), &[])?)?;
    /// let mut to = live.hold(VertexId(0))?;
    /// to[2] += 0.001;
    /// live.lead(to, 0.01)?;
    /// live.step(0.01)?;
    /// live.let_go()?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`HoldError`]; then nothing has changed.
    pub fn hold(&mut self, vertex: VertexId) -> Result<[f64; 3], HoldError> {
        let surfaces = &mut self.under_way.facts.bodies.iter();
        let driven = &mut self.under_way.facts.origins.driven.iter();
        if surfaces.any(|body| body.surface().contains(&vertex.index()))
            || driven.any(|surface| surface.part.vertices.contains(&vertex.index()))
        {
            return Err(HoldError::Body { vertex });
        }
        let model = self.under_way.simulation.model();
        let immobile = self.under_way.simulation.immobile_vertices();
        if model.pins().contains(&vertex) || immobile.contains(&vertex) {
            return Err(HoldError::Held { vertex });
        }
        let positions = self.under_way.simulation.state().x.as_chunks::<3>().0;
        let at = positions.get(vertex.index()).copied().unwrap_or_default();
        let hand = Hand::new(model.topology(), vertex, self.firmness(), at)?;
        if self.hand().is_some_and(|(held, _)| held == vertex) {
            // The new hand begins where the vertex is, and not where the old one was led.
            self.let_go()?;
        }
        self.go_on_with_hand(Some(hand))?;
        Ok(at)
    }

    /// Leads the hand from where it is to a point (metres) until time `end` (seconds), see
    /// [`Simulation::lead_hand`]. Nothing if none is held.
    ///
    /// [`Simulation::lead_hand`]: isosheet_dynamics::Simulation::lead_hand
    ///
    /// # Errors
    /// [`HandError::Target`], [`HandError::End`]; then nothing has changed.
    pub fn lead(&mut self, to: [f64; 3], end: f64) -> Result<(), HandError> {
        match &self.hand {
            Some(hand) => self.under_way.simulation.lead_hand(hand.vertex(), to, end),
            None => Ok(()),
        }
    }

    /// Lets go of the vertex that is held; the energy of the spring is gone, as work. Nothing if none is
    /// held.
    ///
    /// # Errors
    /// [`SceneError`] if the simulation cannot go on without it.
    pub fn let_go(&mut self) -> Result<(), SceneError> {
        match self.hand {
            Some(_) => self.go_on_with_hand(None),
            None => Ok(()),
        }
    }

    fn go_on_with_hand(&mut self, hand: Option<Hand>) -> Result<(), SceneError> {
        let scene = self.file.scene().clone();
        let rebuilt = self.rebuild(&scene, hand);
        rebuilt.map_err(|e| e.in_text(self.file.text()))
    }

    /// The vertex that a hand holds, and where the hand is, metres.
    pub fn hand(&self) -> Option<(VertexId, [f64; 3])> {
        let vertex = self.hand.as_ref()?.vertex();
        let at = self.under_way.simulation.hand_target(vertex).ok()?;
        Some((vertex, at))
    }

    /// The stiffness of the spring of a hand, N/m.
    fn firmness(&self) -> f64 {
        let [low, high] = bounds(self.under_way.facts.sheet.positions().as_chunks::<3>().0);
        let sides = (0..3).map(|k| high[k] - low[k]);
        let size = sides.map(|side| side * side).sum::<f64>().sqrt();
        self.under_way.simulation.model().mass().total() * GRAVITY / (STRETCH * size)
    }
}
