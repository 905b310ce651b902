//! How much shorter the chords of a bent sheet are than its arcs.

mod derivatives;

use super::bend::{Bend, NUMBERS};
use super::curved::CurvedFace;
use super::face::Face;
use super::surroundings::{Neighbour, Surroundings, largest_of_mean};
use crate::evaluation::Room;
use crate::plate_bending::PlateBending;
use crate::plate_bending::SecondDerivatives;
use crate::potential::At;
use isosheet_mesh::{Part, Sheet};
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;

/// The bends of the faces of a sheet, or of one of the parts of a union.
#[derive(Debug, Clone)]
pub(super) struct Arcs {
    curvatures: SecondDerivatives,
    /// The bends of faces that are curved without stress; nothing where all are flat.
    at_rest: Vec<Bend>,
    around: Surroundings,
    /// While bends are remembered, the stresses of the faces, and the stresses of their material alone.
    stresses: Room<Vec<[Vector3<f64>; 2]>>,
    /// The numbers of its coordinates in the union, and of its faces among the elastic ones.
    coordinates: Range<usize>,
    faces: Range<usize>,
}

impl Arcs {
    /// Of a sheet that bends as a plate with rigidity.
    pub(super) fn new(sheet: &Sheet, plate: &PlateBending, faces: &[Face]) -> Self {
        let topology = sheet.topology();
        let curvatures = plate.second_derivatives(sheet);
        let at_rest = At::new(0.0, sheet.positions());
        Self {
            at_rest: match plate.is_curved() {
                true => bends(&curvatures, faces, at_rest).collect(),
                false => Vec::new(),
            },
            curvatures,
            around: Surroundings::new(topology, faces),
            stresses: Room::default(),
            coordinates: 0..3 * topology.vertex_count(),
            faces: 0..topology.face_count(),
        }
    }

    /// The bends of the faces of this sheet as a part of a union of several sheets, among whose elastic faces
    /// its first one has the number `first`.
    pub(super) fn in_union(self, part: &Part, first: usize) -> Self {
        Self {
            coordinates: part.coordinates(),
            faces: first..first + self.faces.len(),
            ..self
        }
    }

    /// Marks the faces whose memories of a state may be others by other arcs, with other elastic faces;
    /// false where these are not of the same faces.
    pub(super) fn add_difference(
        &self,
        other: &Self,
        (faces, others): (&[Face], &[Face]),
        differs: &mut [bool],
    ) -> bool {
        if self.coordinates != other.coordinates
            || self.faces != other.faces
            || self.at_rest.len() != other.at_rest.len()
            || !self.curvatures.are_comparable(&other.curvatures)
        {
            return false;
        }
        let (own, others) = (&faces[self.faces.clone()], &others[self.faces.clone()]);
        let is_other = |k: usize| {
            own[k] != others[k]
                || self.at_rest.get(k) != other.at_rest.get(k)
                || !self.curvatures.is_same(&other.curvatures, k)
        };
        let is_other: Vec<bool> = (0..own.len()).map(is_other).collect();
        let differs = &mut differs[self.faces.clone()];
        for (around, differs) in self.around.iter().zip(differs) {
            *differs |= around.iter().any(|f| is_other[f.face]);
        }
        true
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

    /// Writes the bends where a simulation starts to the numbers that are remembered of its faces, with the
    /// slack of the bend of each face.
    pub(super) fn start(&self, faces: &[Face], here: At<'_>, memory: &mut [f64]) {
        let rows = self.rows(memory);
        for (row, bend) in rows.iter_mut().zip(self.bends(faces, here)) {
            let squared = bend.own;
            *row = Bend { squared, ..bend }.numbers();
        }
    }

    /// Writes the bends at a time and positions of the union to the numbers that are remembered of its faces.
    /// Each has the slack of the bend of that face around it which bends most, as far as the tension around
    /// it leaves it.
    pub(super) fn remember(&self, faces: &[Face], here: At<'_>, memory: &mut [f64]) {
        let slack = |face: &Face, bend, wanted| face.with_slack(here, bend, wanted);
        self.remember_by(faces, here, memory, slack);
    }

    /// As [`Arcs::remember`]; `slack` gives each face its slack, by its bend and the squared bend that it is
    /// wanted for.
    pub(super) fn remember_by(
        &self,
        faces: &[Face],
        here: At<'_>,
        memory: &mut [f64],
        mut slack: impl FnMut(&Face, Bend, f64) -> Bend,
    ) {
        let own = &faces[self.faces.clone()];
        let rows = self.rows(memory);
        self.stresses.with(|stresses| {
            let before = own.iter().zip(rows.iter());
            let stress = |(face, row): (&Face, &_)| {
                [Bend::remembered(row), Bend::FLAT].map(|bend| face.stress(here, &bend))
            };
            stresses.clear();
            stresses.extend(before.map(stress));
            for (row, bend) in rows.iter_mut().zip(self.bends(faces, here)) {
                let Bend {
                    squared, credit, ..
                } = Bend::remembered(row);
                *row = Bend {
                    squared,
                    credit,
                    ..bend
                }
                .numbers();
            }
            for (k, around) in self.around.iter().enumerate() {
                let squared = |f: usize| Bend::remembered(&rows[f]).own;
                let wanted = wanted(own, k, around, squared, |f| &stresses[f]);
                let bend = Bend::remembered(&rows[k]);
                rows[k] = slack(&own[k], bend, wanted).numbers();
            }
        });
    }

    /// As [`Arcs::remember_by`], of some faces alone: the bends that they are to remember go to `take`, with
    /// the numbers of the faces among the elastic ones. `slack` has the number of the face among its own
    /// first.
    pub(super) fn remember_parts_by(
        &self,
        faces: &[Face],
        here: At<'_>,
        memory: &[f64],
        parts: &[u32],
        mut slack: impl FnMut(usize, &Face, Bend, f64) -> Bend,
        mut take: impl FnMut(usize, Bend),
    ) {
        let own = &faces[self.faces.clone()];
        let rows = &memory.as_chunks::<NUMBERS>().0[self.faces.clone()];
        let mut known: Vec<Option<(Bend, [Vector3<f64>; 2])>> = vec![None; own.len()];
        let first = self.faces.start;
        let own_parts = parts.iter().map(|k| *k as usize);
        for k in own_parts
            .filter(|k| self.faces.contains(k))
            .map(|k| k - first)
        {
            let around = self.around.of(k);
            for f in around.iter().map(|f| f.face) {
                known[f].get_or_insert_with(|| {
                    let before = [Bend::remembered(&rows[f]), Bend::FLAT];
                    let stresses = before.map(|bend| own[f].stress(here, &bend));
                    (self.bend(faces, here, f), stresses)
                });
            }
            let of = |f: usize| known[f].as_ref().expect("it has been made");
            let wanted = wanted(own, k, around, |f| of(f).0.own, |f| &of(f).1);
            let Bend {
                squared, credit, ..
            } = Bend::remembered(&rows[k]);
            let bend = Bend {
                squared,
                credit,
                ..of(k).0
            };
            take(first + k, slack(k, &own[k], bend, wanted));
        }
    }

    fn rows<'a>(&self, memory: &'a mut [f64]) -> &'a mut [[f64; NUMBERS]] {
        &mut memory.as_chunks_mut().0[self.faces.clone()]
    }

    /// The bends of its faces beyond those without stress, without slack.
    fn bends<'a>(&'a self, faces: &'a [Face], here: At<'a>) -> impl Iterator<Item = Bend> + 'a {
        let own = &faces[self.faces.clone()];
        let at = At::new(here.t, &here.x[self.coordinates.clone()]);
        let bends = bends(&self.curvatures, own, at).enumerate();
        bends.map(|(k, bend)| self.beyond_rest(k, bend))
    }

    /// The bend of one of its faces beyond the one without stress, without slack.
    fn bend(&self, faces: &[Face], here: At<'_>, k: usize) -> Bend {
        let at = At::new(here.t, &here.x[self.coordinates.clone()]);
        let face = &faces[self.faces.start + k];
        self.beyond_rest(k, bend(face, &self.curvatures.of_face(k, at)))
    }

    fn beyond_rest(&self, k: usize, mut bend: Bend) -> Bend {
        if let Some(rest) = self.at_rest.get(k) {
            bend.chords -= rest.chords;
            bend.own = (bend.own - rest.own).abs();
        }
        bend
    }
}

/// The squared bend that the slack of a face is wanted for: that of the face around it which bends most, as
/// far as the tension around it leaves it. `stresses` gives the stress of a face, and that of its material
/// alone.
fn wanted<'a>(
    faces: &[Face],
    k: usize,
    around: &[Neighbour],
    squared: impl Fn(usize) -> f64,
    stresses: impl Fn(usize) -> &'a [Vector3<f64>; 2],
) -> f64 {
    let squares = around.iter().map(|f| squared(f.face));
    let most = squares.fold(0.0, f64::max);
    let mean = |which: usize| largest_of_mean(around, |f| (faces[f].area(), stresses(f)[which]));
    faces[k].left_by(mean(0).min(mean(1))) * most
}

/// The bends of faces, each with its own square.
fn bends<'a>(
    curvatures: &'a SecondDerivatives,
    faces: &'a [Face],
    at: At<'a>,
) -> impl Iterator<Item = Bend> + 'a {
    let all = faces.iter().zip(curvatures.at(at));
    all.map(|(face, second)| bend(face, &second))
}

/// The bend of a face with the second derivatives of positions.
fn bend(face: &Face, second: &Matrix3<f64>) -> Bend {
    Bend {
        chords: face.chords(second),
        own: second.norm_squared() * face.mean_squared_length(),
        squared: 0.0,
        credit: 0.0,
    }
}
