//! What a scene asks its sheets to reach, and how far they are from it.

use crate::measures::yielding::{YieldingAngles, YieldingCrease};
use crate::sheets::creases::Crease;
use crate::sheets::folding::{FoldResidual, FoldTargets};
use crate::time::kinks::Kinks;
use isosheet_dynamics::{CreaseSpring, Glue, RestAngle, Simulation, State};
use isosheet_mesh::{EdgeId, VertexId, angle_near};
use serde::{Deserialize, Serialize};

/// What a scene asks its sheets to reach.
#[derive(Clone, Debug, Default)]
pub struct Targets {
    /// Where the creases are driven, if the scene folds to the angles of a FOLD file.
    pub folding: Option<FoldTargets>,
    /// The creases of the scene that are driven.
    pub creases: Vec<DrivenCrease>,
    /// The creases of the scene that can yield.
    pub yielding: Vec<YieldingCrease>,
    /// The seams, in the order of the scene.
    pub seams: Vec<Glue>,
}

/// A `[[crease]]` whose angle changes.
#[derive(Clone, Debug)]
pub struct DrivenCrease {
    /// Its number in the scene.
    pub number: usize,
    /// Its name, or the lines of the drawing that it follows.
    pub name: Option<String>,
    /// Its edges with their rest angles.
    pub edges: Vec<(EdgeId, RestAngle)>,
}

/// How far a driven crease is from its angle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CreaseResidual {
    /// Its number in the scene.
    pub number: usize,
    /// Its name, or the lines of the drawing that it follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Largest difference at an edge, degrees.
    pub largest: f64,
    /// Root of the mean square of the differences, degrees.
    pub rms: f64,
}

/// How far the sheets are from what the scene asks for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Differences of the angles between panels from the angles of a FOLD file, if the scene folds to them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folding: Option<FoldResidual>,
    /// Differences of the kinks of the driven creases from their own angles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub creases: Vec<CreaseResidual>,
    /// By how much the vertices of each seam are further from each other than they are meant to be, at most,
    /// metres.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seams: Vec<f64>,
}

impl DrivenCrease {
    /// Of the springs of a crease; nothing if none is driven. `edge` gives their edges in the union of all
    /// sheets.
    pub(crate) fn of(
        (number, crease): (usize, &Crease),
        springs: &[CreaseSpring],
        edge: impl Fn(EdgeId) -> EdgeId,
    ) -> Option<Self> {
        let driven = springs.iter().filter(|spring| spring.rest.is_driven());
        let edges: Vec<_> = driven.map(|s| (edge(s.edge), s.rest.clone())).collect();
        (!edges.is_empty()).then(|| Self {
            number,
            name: crease.called(),
            edges,
        })
    }

    fn residual(&self, t: f64, kinks: Kinks<'_>) -> CreaseResidual {
        let (mut largest, mut squares) = (0.0_f64, 0.0);
        for (edge, rest) in &self.edges {
            let off = angle_near(kinks.angle(*edge) - rest.at(t), 0.0);
            let off = off.abs().to_degrees();
            largest = largest.max(off);
            squares += off * off;
        }
        CreaseResidual {
            number: self.number,
            name: self.name.clone(),
            largest,
            rms: (squares / self.edges.len() as f64).sqrt(),
        }
    }
}

impl Targets {
    /// The pairs of vertices that are glued to each other.
    pub fn glued(&self) -> Vec<[VertexId; 2]> {
        let pairs = self.seams.iter().flat_map(|seam| seam.pairs());
        pairs.copied().collect()
    }

    /// The angles of the creases that can yield, in their order, where a simulation is.
    pub fn yielding_angles(&self, simulation: &Simulation) -> Vec<YieldingAngles> {
        YieldingCrease::angles(&self.yielding, simulation)
    }

    /// How far the sheets are from what is asked for where a simulation is.
    pub fn residuals(&self, simulation: &Simulation) -> Residuals {
        let State { t, ref x, .. } = *simulation.state();
        let bends = simulation.bends_at_creases().unwrap_or_default();
        let topology = simulation.model().topology();
        let kinks = Kinks::new(topology, x, &bends);
        let folding = self.folding.as_ref();
        let creases = self.creases.iter();
        Residuals {
            folding: folding.map(|targets| targets.residual(topology, x)),
            creases: creases.map(|crease| crease.residual(t, kinks)).collect(),
            seams: self.seams.iter().map(|seam| seam.opening(t, x)).collect(),
        }
    }
}

impl Residuals {
    /// What is left, in words, an entry for each kind of target.
    pub fn in_words(&self) -> Vec<String> {
        let mut words = Vec::new();
        if let Some(f) = self.folding {
            words.push(format!(
                "fold angles differ from their targets by {:.2} degrees at most and {:.2} rms",
                f.largest, f.rms
            ));
            if f.wrong_side > 0 {
                let (wrong, all) = (f.wrong_side, f.creases);
                words.push(format!(
                    "{wrong} of {all} creases are folded to their wrong side"
                ));
            }
        }
        let worst = self
            .creases
            .iter()
            .max_by(|a, b| a.largest.total_cmp(&b.largest));
        if let Some(crease) = worst {
            let name = crease.name.as_ref();
            let name = name.map_or(String::new(), |name| format!(" (\"{name}\")"));
            words.push(format!(
                "driven creases differ from their angles by {:.2} degrees at most, at `crease[{}]`{name}",
                crease.largest, crease.number
            ));
        }
        let seams = self.seams.iter().enumerate();
        if let Some((number, opening)) = seams.max_by(|a, b| a.1.total_cmp(b.1)) {
            words.push(format!(
                "seams are open by {opening:.1e} m at most, at `glue[{number}]`"
            ));
        }
        words
    }
}
