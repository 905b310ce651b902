//! What a run says of an elastic sheet.

use isosheet_dynamics::{Simulation, State};
use isosheet_mesh::FaceId;
use isosheet_mesh::wording::brief;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How an elastic sheet was modelled and how it was deformed, in `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElasticSummary {
    /// Stiffness of the material, Young's modulus times thickness, N/m.
    pub stiffness: f64,
    /// Limit of the strain; where sheets have several, that of the face which came nearest to its own.
    pub limit: f64,
    /// Largest strain of a face in any step, the norm of Green's strain; where sheets have several limits,
    /// that of the face which came nearest to its own.
    pub strain: f64,
    /// Part of the stretching in the elastic energy at the end, from 0 to 1.
    pub share: f64,
    /// Part of the slack of bends in the elastic energy at the end, from 0 to 1: the error of the energy that
    /// comes of the mesh where a sheet bends and is pulled.
    #[serde(default)]
    pub slack: f64,
    /// Part of the area at the end whose strain is beyond half of its limit, from 0 to 1: there the limit
    /// acts beside the stiffness of the material.
    #[serde(default)]
    pub at_limit: f64,
    /// Where the sheet bent most over the size of a face, if it bends.
    pub sharpest: Option<Bend>,
    /// Where the sheet bends most over the size of a face at the end, if it bends.
    #[serde(default)]
    pub at_end: Option<Bend>,
    /// The face that is the largest for its bend at rest, if the sheet is curved without stress.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_rest: Option<BendAtRest>,
}

/// A face that is curved without stress: a shell bends over the length `(R t)^1/2` near edges and loads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BendAtRest {
    /// The root mean square of the lengths of its edges, metres.
    pub size: f64,
    /// The radius `R` at rest, metres.
    pub radius: f64,
    /// The thickness `t` by the stiffness in the plane and the flexural rigidity, metres.
    pub thickness: f64,
    /// The middle of the face at the start, metres.
    pub at: [f64; 3],
}

impl BendAtRest {
    /// The length `(R t)^1/2`, metres.
    pub fn bending_length(&self) -> f64 {
        (self.radius * self.thickness).sqrt()
    }

    /// The size of the face in units of that.
    pub fn coarseness(&self) -> f64 {
        self.size / self.bending_length()
    }
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

    /// Part by which forces are wrong that such a bend balances, at most: a quarter of the square of the
    /// angle, as in `cargo xtask validation` (a strip between two plates, and one that is pushed together).
    pub fn force_error(&self) -> f64 {
        0.25 * self.angle * self.angle
    }
}

impl ElasticSummary {
    /// At the start of a run; none for a sheet of rods.
    pub fn of(simulation: &Simulation) -> Option<Self> {
        let elastic = simulation.model().elastic_sheet()?;
        let at_rest = elastic.coarsest_curved().map(|curved| BendAtRest {
            size: curved.size,
            radius: curved.radius,
            thickness: curved.thickness,
            at: middle(simulation, curved.face),
        });
        Some(Self {
            stiffness: elastic.stiffness(),
            limit: elastic.limit(),
            strain: 0.0,
            share: 0.0,
            slack: 0.0,
            at_limit: 0.0,
            sharpest: None,
            at_end: None,
            at_rest,
        })
    }

    /// Takes in where a simulation is.
    pub fn observe(&mut self, simulation: &Simulation) {
        let State { t, .. } = simulation.state();
        let Some(deformation) = simulation.elastic_deformation() else {
            return;
        };
        let elastic = simulation.model().elastic_sheet();
        let faces = elastic.iter().flat_map(|e| e.faces().zip(e.limits()));
        for (face, limit) in faces {
            let strain = deformation.strain[face.index()];
            if strain / limit > self.strain / self.limit {
                (self.strain, self.limit) = (strain, limit);
            }
        }
        self.share = deformation.total_share();
        self.slack = deformation.slack_share();
        self.at_limit = deformation.at_limit;
        let before = self.sharpest.map_or(0.0, |bend| bend.angle);
        if let Some((face, angle)) = deformation.sharpest() {
            let at = middle(simulation, FaceId::from_index(face));
            let bend = Bend { angle, t: *t, at };
            self.at_end = Some(bend);
            if angle > before {
                self.sharpest = Some(bend);
            }
        }
    }
}

/// The middle of a face where it is now, metres.
fn middle(simulation: &Simulation, face: FaceId) -> [f64; 3] {
    let corners = simulation.model().topology().faces()[face.index()];
    let x = &simulation.state().x;
    [0, 1, 2].map(|k| corners.iter().map(|v| x[3 * v.index() + k]).sum::<f64>() / 3.0)
}
