//! How much shorter the chords of a bent sheet are than its arcs.

use super::bend::{Bend, NUMBERS};
use super::curved::CurvedFace;
use super::face::Face;
use crate::material::plate_bending::PlateBending;
use crate::material::plate_bending::SecondDerivatives;
use crate::potential::At;
use isosheet_mesh::{FaceId, Part, Sheet};
use std::ops::Range;

/// The bends of the faces of a sheet, or of one of the parts of a union.
#[derive(Debug, Clone)]
pub(super) struct Arcs {
    curvatures: SecondDerivatives,
    /// The bends of faces that are curved without stress; nothing where all are flat.
    at_rest: Vec<Bend>,
    /// Where the faces around each face begin, and their numbers.
    starts: Vec<usize>,
    around: Vec<u32>,
    /// The numbers of its coordinates in the union, and of its faces among those that are elastic.
    coordinates: Range<usize>,
    faces: Range<usize>,
}

impl Arcs {
    /// Of a sheet that bends as a plate with rigidity.
    pub(super) fn new(sheet: &Sheet, plate: &PlateBending, faces: &[Face]) -> Self {
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
        let curvatures = plate.second_derivatives(sheet);
        let at_rest = At::new(0.0, sheet.positions());
        Self {
            at_rest: match plate.is_curved() {
                true => bends(&curvatures, faces, at_rest).collect(),
                false => Vec::new(),
            },
            curvatures,
            starts,
            around,
            coordinates: 0..3 * topology.vertex_count(),
            faces: 0..topology.face_count(),
        }
    }

    /// The same of a sheet in a union of several, among whose elastic faces its first one has the number
    /// `first`.
    pub(super) fn in_union(self, part: &Part, first: usize) -> Self {
        Self {
            coordinates: part.coordinates(),
            faces: first..first + self.faces.len(),
            ..self
        }
    }

    /// Its faces that are curved without stress.
    pub(super) fn curved<'a>(&'a self, faces: &'a [Face]) -> impl Iterator<Item = CurvedFace> + 'a {
        let own = faces[self.faces.clone()].iter().zip(&self.at_rest);
        let bent = own.filter(|(_, bend)| bend.own > 0.0);
        bent.map(|(face, bend)| {
            let size = face.mean_squared_length().sqrt();
            CurvedFace {
                face: face.id,
                size,
                radius: size / bend.own.sqrt(),
                thickness: face.thickness(),
            }
        })
    }

    /// Writes the bends at a time and positions of the union to the numbers that are remembered of its faces.
    pub(super) fn remember(&self, faces: &[Face], here: At<'_>, memory: &mut [f64]) {
        let own = &faces[self.faces.clone()];
        let at = At::new(here.t, &here.x[self.coordinates.clone()]);
        let rows = &mut memory.as_chunks_mut::<NUMBERS>().0[self.faces.clone()];
        for (k, (row, mut bend)) in rows
            .iter_mut()
            .zip(bends(&self.curvatures, own, at))
            .enumerate()
        {
            if let Some(rest) = self.at_rest.get(k) {
                bend.chords -= rest.chords;
                bend.own = (bend.own - rest.own).abs();
            }
            let before = Bend::remembered(row);
            *row = Bend {
                squared: before.squared,
                credit: before.credit,
                ..bend
            }
            .numbers();
        }
        for (k, range) in self.starts.windows(2).enumerate() {
            let around = self.around[range[0]..range[1]].iter();
            let bends = around.map(|f| Bend::remembered(&rows[*f as usize]));
            let wanted = bends.fold(0.0, |most: f64, bend| most.max(bend.own));
            let bend = Bend::remembered(&rows[k]);
            rows[k] = own[k].with_slack(here, bend, wanted).numbers();
        }
    }
}

/// The bends of faces, each with its own square.
fn bends<'a>(
    curvatures: &'a SecondDerivatives,
    faces: &'a [Face],
    at: At<'a>,
) -> impl Iterator<Item = Bend> + 'a {
    faces.iter().zip(curvatures.at(at)).map(|(face, h)| Bend {
        chords: face.chords(&h),
        own: h.norm_squared() * face.mean_squared_length(),
        squared: 0.0,
        credit: 0.0,
    })
}
