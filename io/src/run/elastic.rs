//! What a run says of an elastic sheet.

use isosheet_dynamics::{ElasticSheet, SheetModel, Simulation, State};
use isosheet_mesh::wording::brief;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How an elastic sheet was modelled and how it was deformed, in `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElasticSummary {
    /// Stiffness of the material, Young's modulus times thickness, N/m.
    pub stiffness: f64,
    /// Smallest and largest stiffness of a face, N/m: less than that of the material where the mesh is so
    /// coarse that it would lock ([`ElasticSheet::softened`]).
    pub used: [f64; 2],
    /// Edge length up to which faces have the stiffness of the material, metres; none if no face is softened
    /// however large.
    pub unsoftened_size: Option<f64>,
    /// Limit of the strain.
    pub limit: f64,
    /// Largest strain of a face in any step, the norm of Green's strain.
    pub strain: f64,
    /// Part of the stretching in the elastic energy at the end, from 0 to 1.
    pub share: f64,
    /// Where the sheet bent most over the size of a face, if it bends.
    pub sharpest: Option<Bend>,
}

/// A bend of a face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bend {
    /// The angle over the size of the face, radians.
    pub angle: f64,
    /// Time, seconds.
    pub t: f64,
    /// The middle of the face at that time, metres.
    pub at: [f64; 3],
}

impl fmt::Display for Bend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.at.map(brief);
        write!(
            f,
            "{} rad near ({x}, {y}, {z}) m at {} s",
            brief(self.angle),
            brief(self.t)
        )
    }
}

impl Bend {
    /// Part by which chords of this angle are shorter than their arcs: the error of the shape that comes of
    /// the mesh.
    pub fn shortening(&self) -> f64 {
        self.angle * self.angle / 24.0
    }
}

impl ElasticSummary {
    /// Of a model at the start of a run; none for a sheet of rods.
    pub fn of(model: &SheetModel) -> Option<Self> {
        let elastic = model.elastic_sheet()?;
        let size = elastic.unsoftened_size();
        Some(Self {
            stiffness: elastic.stiffness(),
            used: used(elastic),
            unsoftened_size: size.is_finite().then_some(size),
            limit: elastic.limit(),
            strain: 0.0,
            share: 0.0,
            sharpest: None,
        })
    }

    /// Takes in where a simulation is.
    pub fn observe(&mut self, simulation: &Simulation) {
        let State { t, x, .. } = simulation.state();
        let Some(deformation) = simulation.elastic_deformation() else {
            return;
        };
        self.strain = deformation
            .strain
            .iter()
            .copied()
            .fold(self.strain, f64::max);
        self.share = deformation.total_share();
        let before = self.sharpest.map_or(0.0, |bend| bend.angle);
        if let Some((face, angle)) = deformation.sharpest()
            && angle > before
        {
            let corners = simulation.model().topology().faces()[face];
            let mean = |k: usize| corners.iter().map(|v| x[3 * v.index() + k]).sum::<f64>() / 3.0;
            let at = [mean(0), mean(1), mean(2)];
            self.sharpest = Some(Bend { angle, t: *t, at });
        }
    }

    /// What was softened, in words.
    pub(crate) fn stiffness_in_words(&self) -> String {
        let [least, most] = self.used.map(brief);
        let material = brief(self.stiffness);
        match self.unsoftened_size {
            Some(size) if self.used[0] < self.stiffness => format!(
                "{least} to {most} N/m on this mesh in place of {material} N/m, which faces of up to {} m would have",
                brief(size)
            ),
            _ => format!("{material} N/m, that of the material"),
        }
    }
}

fn used(elastic: &ElasticSheet) -> [f64; 2] {
    let stiffnesses = elastic.face_stiffnesses();
    stiffnesses.fold([f64::INFINITY, 0.0], |[least, most], k| {
        [least.min(k), most.max(k)]
    })
}
