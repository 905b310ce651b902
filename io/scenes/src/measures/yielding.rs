//! Creases of a scene that yield, and what of their angles stays.

use crate::sheets::creases::Crease;
use crate::time::kinks::Kinks;
use isosheet_dynamics::{CreaseSpring, RestAngle, Simulation, State};
use isosheet_mesh::EdgeId;

/// A `[[crease]]` that can yield.
#[derive(Clone, Debug)]
pub struct YieldingCrease {
    /// Its number in the scene.
    pub number: usize,
    /// Its name, or the lines of the drawing that it follows.
    pub name: Option<String>,
    /// Its edges with their rest angles.
    pub edges: Vec<(EdgeId, RestAngle)>,
}

/// The angles of a crease that can yield, in the mean over its edges, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YieldingAngles {
    /// Its kink now.
    pub now: f64,
    /// The kink at which its moment is zero.
    pub kept: f64,
    /// By how much that differs from its rest angle.
    pub plastic: f64,
}

impl YieldingCrease {
    /// Of the springs of a crease; nothing if it does not yield. `edge` gives their edges in the union of all
    /// sheets.
    pub(crate) fn of(
        (number, crease): (usize, &Crease),
        springs: &[CreaseSpring],
        edge: impl Fn(EdgeId) -> EdgeId,
    ) -> Option<Self> {
        crease.yields.as_ref()?;
        let edges = springs.iter().map(|s| (edge(s.edge), s.rest.clone()));
        let edges: Vec<_> = edges.collect();
        (!edges.is_empty()).then(|| Self {
            number,
            name: crease.called(),
            edges,
        })
    }

    /// The angles of some creases, in their order, where a simulation is.
    pub(crate) fn angles(all: &[Self], simulation: &Simulation) -> Vec<YieldingAngles> {
        if all.is_empty() {
            return Vec::new();
        }
        let State { t, ref x, .. } = *simulation.state();
        let bends = simulation.bends_at_creases().unwrap_or_default();
        let plastic = simulation.plastic_angles().unwrap_or_default();
        let kinks = Kinks::new(simulation.model().topology(), x, &bends);
        let angles = |crease: &Self| {
            let count = crease.edges.len() as f64;
            let mean = |of: &dyn Fn(&(EdgeId, RestAngle)) -> f64| {
                (crease.edges.iter().map(of).sum::<f64>() / count).to_degrees()
            };
            let stays = mean(&|(e, _)| plastic.get(e.index()).copied().unwrap_or(0.0));
            YieldingAngles {
                now: mean(&|(e, _)| kinks.angle(*e)),
                kept: mean(&|(_, rest)| rest.at(t)) + stays,
                plastic: stays,
            }
        };
        all.iter().map(angles).collect()
    }
}
