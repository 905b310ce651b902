//! What stays of the angles of a sheet that yields.

use isosheet_mesh::wording::{brief, place, quoted};
use isosheet_scenes::UnderWay;
use serde::{Deserialize, Serialize};

/// What yields by less than this, degrees, is not told: no one sees it.
const TOLD: f64 = 0.005;

/// The angles that stay after unloading, at the end of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeptAngles {
    /// Of the creases that have yielded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub creases: Vec<KeptFold>,
    /// Of the sheet, where it has yielded most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sheet: Option<KeptBend>,
}

/// What a crease keeps of its angle, in the mean over its edges, degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptFold {
    /// Its number in the scene.
    pub number: usize,
    /// Its name, or the lines of the drawing that it follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The angle under load: the one of the run that was farthest from the angle at rest.
    pub loaded: f64,
    /// The angle that is kept: the moment is zero there.
    pub kept: f64,
    /// The part of it that is plastic.
    pub plastic: f64,
    /// The angle under load less the one that is kept.
    pub springback: f64,
}

/// What a sheet keeps of its bend, at the face that keeps most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptBend {
    /// The curvature that is kept, 1/m: the moment is zero there. It is positive for a valley.
    pub curvature: f64,
    /// The largest curvature of this face under load in the run, 1/m: what is kept and the elastic part.
    pub loaded: f64,
    /// The middle of the face in the flat sheet, metres.
    pub at: [f64; 3],
}

impl KeptAngles {
    /// Takes in where a run is.
    pub(super) fn observe(&mut self, under_way: &UnderWay) {
        let (facts, simulation) = (&under_way.facts, &under_way.simulation);
        if !simulation.model().can_yield() {
            return;
        }
        let targets = &facts.targets;
        let angles = targets.yielding_angles(simulation);
        for (crease, angles) in targets.yielding.iter().zip(angles) {
            let known = self
                .creases
                .iter_mut()
                .find(|kept| kept.number == crease.number);
            let rest = angles.kept - angles.plastic;
            // Where it was farthest from its rest, and how far that was from the rest at that time.
            let loaded = match &known {
                Some(old)
                    if (old.loaded - (old.kept - old.plastic)).abs()
                        > (angles.now - rest).abs() =>
                {
                    old.loaded
                }
                _ => angles.now,
            };
            let fold = KeptFold {
                number: crease.number,
                name: crease.name.clone(),
                loaded,
                kept: angles.kept,
                plastic: angles.plastic,
                springback: loaded - angles.kept,
            };
            match known {
                Some(old) => *old = fold,
                None => self.creases.push(fold),
            }
        }
        self.observe_sheet(under_way);
    }

    fn observe_sheet(&mut self, under_way: &UnderWay) {
        let simulation = &under_way.simulation;
        let Some(curvatures) = simulation.plastic_curvatures() else {
            return;
        };
        let sheet = &under_way.facts.sheet;
        let (topology, lengths) = (sheet.topology(), sheet.lengths());
        // The root mean square of the lengths of its edges.
        let size = |face| {
            let squares = topology
                .face_edges(face)
                .map(|e| lengths[e.index()].powi(2));
            (squares.iter().sum::<f64>() / 3.0).sqrt()
        };
        let faces = topology.face_ids().zip(&curvatures);
        let most = faces.max_by(|a, b| a.1[0].abs().total_cmp(&b.1[0].abs()));
        let is_seen = |face, curvature: f64| (curvature * size(face)).to_degrees().abs() > TOLD;
        let Some((face, &[kept, _])) = most.filter(|(face, [kept, _])| is_seen(*face, *kept))
        else {
            return;
        };
        let corners = topology.faces()[face.index()].map(|v| sheet.position(v));
        let elastic = simulation.elastic_deformation();
        let elastic = elastic.and_then(|of| of.angle.get(face.index()).copied());
        let elastic = elastic.unwrap_or(0.0) / size(face);
        let loaded = kept + elastic.copysign(kept);
        let before = self.sheet.map_or(0.0, |bend| bend.loaded);
        self.sheet = Some(KeptBend {
            curvature: kept,
            loaded: if before.abs() > loaded.abs() {
                before
            } else {
                loaded
            },
            at: [0, 1, 2].map(|k| corners.iter().map(|c| c[k]).sum::<f64>() / 3.0),
        });
    }

    /// Without the creases that have not yielded.
    pub(super) fn of_yielded(&self) -> Self {
        let yielded = self.creases.iter().filter(|c| c.plastic.abs() > TOLD);
        Self {
            creases: yielded.cloned().collect(),
            sheet: self.sheet,
        }
    }

    /// Whether nothing has yielded.
    pub(super) fn is_empty(&self) -> bool {
        self.creases.is_empty() && self.sheet.is_none()
    }

    /// What is kept, in words: of the crease that springs back most, and of the sheet.
    pub fn in_words(&self) -> Vec<String> {
        let mut words = Vec::new();
        let most = self
            .creases
            .iter()
            .max_by(|a, b| a.springback.abs().total_cmp(&b.springback.abs()));
        if let Some(fold) = most {
            let name = fold.name.as_ref();
            let name = name.map_or(String::new(), |name| format!(" ({})", quoted(name)));
            let others = match self.creases.len() {
                1 => String::new(),
                n => format!(", the most of {n} creases that yielded"),
            };
            words.push(format!(
                "`crease[{}]`{name} keeps {:.1} of {:.1} degrees under load, a springback of {:.1} degrees{others}",
                fold.number, fold.kept, fold.loaded, fold.springback
            ));
        }
        if let Some(bend) = &self.sheet {
            let radius = |curvature: f64| brief(1.0 / curvature.abs());
            words.push(format!(
                "the sheet keeps a radius of curvature of {} m at {} of the flat sheet, where it was bent to {} m under load",
                radius(bend.curvature),
                place(&bend.at),
                radius(bend.loaded)
            ));
        }
        words
    }
}
