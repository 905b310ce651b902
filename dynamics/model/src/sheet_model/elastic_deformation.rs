//! How an elastic sheet is deformed, face by face.

use crate::SheetModel;
use isosheet_materials::potential::At;
use isosheet_materials::potential::Memories;

/// How an elastic sheet is deformed, one value for each face: what a report needs to say whether the mesh is
/// fine enough ([`SheetModel::elastic_deformation`]).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ElasticDeformation {
    /// The Frobenius norm of Green's strain, see `ElasticSheet`.
    pub strain: Vec<f64>,
    /// Energy of stretching, with that of the barrier at the limit, joules.
    pub stretching: Vec<f64>,
    /// The part of it that is in the slack of faces that bend, joules: a sheet that is pulled yields by it as
    /// its material would not.
    pub slack: Vec<f64>,
    /// Part of the area whose strain is beyond half of its limit, where the barrier acts, from 0 to 1.
    pub at_limit: f64,
    /// Energy of bending, joules.
    pub bending: Vec<f64>,
    /// The angle by which the sheet bends over the size of the face, radians: `sqrt(2 V / (D A)) h`, with the
    /// bending energy `V`, the flexural rigidity `D`, the area `A` and the root mean square `h` of the edge
    /// lengths. A chord is shorter than its arc by a part of `angle^2 / 24`. Zero without bending stiffness.
    pub angle: Vec<f64>,
}

impl ElasticDeformation {
    /// The part of the stretching in the elastic energy of a face, from 0 to 1; 0 where there is no energy.
    pub fn share(&self, face: usize) -> f64 {
        share(self.stretching[face], self.bending[face])
    }

    /// The part of the stretching in the elastic energy of the whole sheet, from 0 to 1; 0 where there is no
    /// energy.
    pub fn total_share(&self) -> f64 {
        share(self.stretching.iter().sum(), self.bending.iter().sum())
    }

    /// The part of the slack in the elastic energy of the whole sheet, from 0 to 1; 0 where there is no
    /// energy.
    pub fn slack_share(&self) -> f64 {
        let slack: f64 = self.slack.iter().sum();
        let stretching: f64 = self.stretching.iter().sum();
        share(slack, stretching - slack + self.bending.iter().sum::<f64>())
    }

    /// The face that bends by the largest angle, and that angle.
    pub fn sharpest(&self) -> Option<(usize, f64)> {
        let angles = self.angle.iter().copied().enumerate();
        angles.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The part of an energy in the sum of it and others.
fn share(energy: f64, others: f64) -> f64 {
    let sum = energy + others;
    if sum > 0.0 { energy / sum } else { 0.0 }
}

impl SheetModel {
    /// How an elastic sheet is deformed at a time `t` (seconds) and positions `x` (`3V`, metres) by what its
    /// potentials remember; nothing for a sheet of rods. Bending is that of the potentials that know it by
    /// face (`MaterialReport`), and has an angle if the sheet was told its plate (`ElasticSheet::beside`).
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn elastic_deformation(
        &self,
        t: f64,
        x: &[f64],
        memories: &Memories,
    ) -> Option<ElasticDeformation> {
        let elastic = self.elastic_sheet()?;
        let mut bending = vec![0.0; elastic.face_count()];
        let mut own = At::new(t, x);
        for (potential, at) in self.potentials_at(t, x, memories) {
            if let Some(report) = potential.report() {
                report.add_bending_energies(at, &mut bending);
            }
            // That of the elastic sheet is the last one.
            own = at;
        }
        let of_faces = |values: &mut dyn Iterator<Item = f64>| {
            let mut all = vec![0.0; elastic.face_count()];
            for (face, value) in elastic.faces().zip(values) {
                all[face.index()] = value;
            }
            all
        };
        let angle = of_faces(&mut elastic.bend_angles(&bending));
        Some(ElasticDeformation {
            strain: of_faces(&mut elastic.strains(own)),
            stretching: of_faces(&mut elastic.face_energies(own)),
            slack: of_faces(&mut elastic.slack_energies(own)),
            at_limit: elastic.part_at_limit(own),
            angle,
            bending,
        })
    }
}
