//! How much shorter the chords of a bent sheet are than its arcs.

use super::bend::{Bend, NUMBERS};
use super::face::Face;
use crate::material::plate_bending::PlateBending;
use crate::material::plate_bending::SecondDerivatives;
use isosheet_mesh::{FaceId, Part, Sheet};
use std::ops::Range;

/// The bends of the faces of a sheet, or of one of the parts of a union.
#[derive(Debug, Clone)]
pub(super) struct Arcs {
    curvatures: SecondDerivatives,
    /// Where the faces around each face begin, and their numbers.
    starts: Vec<usize>,
    around: Vec<u32>,
    /// The numbers of its coordinates and faces in the union.
    coordinates: Range<usize>,
    faces: Range<usize>,
}

impl Arcs {
    /// Of a sheet that bends as a plate with rigidity.
    pub(super) fn new(sheet: &Sheet, plate: &PlateBending) -> Self {
        let topology = sheet.topology();
        let (mut starts, mut around) = (vec![0], Vec::new());
        for face in topology.face_ids() {
            let corners = topology.faces()[face.index()].iter();
            let mut faces: Vec<FaceId> = corners
                .flat_map(|v| topology.vertex_faces(*v))
                .copied()
                .collect();
            faces.sort_unstable();
            faces.dedup();
            around.extend(faces.iter().map(|f| f.0));
            starts.push(around.len());
        }
        Self {
            curvatures: plate.second_derivatives(sheet),
            starts,
            around,
            coordinates: 0..3 * topology.vertex_count(),
            faces: 0..topology.face_count(),
        }
    }

    /// The same of a sheet in a union of several.
    pub(super) fn in_union(self, part: &Part) -> Self {
        Self {
            coordinates: part.coordinates(),
            faces: part.faces.clone(),
            ..self
        }
    }

    /// Writes the bends at positions of the union to the numbers that are remembered of its faces.
    pub(super) fn remember(&self, faces: &[Face], x: &[f64], memory: &mut [f64]) {
        let own = &faces[self.faces.clone()];
        let curvatures = self.curvatures.at(&x[self.coordinates.clone()]);
        let rows = &mut memory.as_chunks_mut::<NUMBERS>().0[self.faces.clone()];
        for ((row, face), h) in rows.iter_mut().zip(own).zip(curvatures) {
            let bend = Bend {
                chords: face.chords(&h),
                own: h.norm_squared() * face.mean_squared_length(),
                squared: 0.0,
            };
            *row = bend.numbers();
        }
        for (k, range) in self.starts.windows(2).enumerate() {
            let around = self.around[range[0]..range[1]].iter();
            let bends = around.map(|f| Bend::remembered(&rows[*f as usize]));
            let squared = bends.fold(0.0, |most: f64, bend| most.max(bend.own));
            let bend = Bend::remembered(&rows[k]);
            rows[k] = Bend { squared, ..bend }.numbers();
        }
    }
}
