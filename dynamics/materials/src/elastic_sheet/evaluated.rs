//! The faces of an elastic sheet where it is evaluated, on the threads of rayon's current pool.

use super::bend::Bend;
use super::face::{Blocks, Face, StrainCourse, Strained};
use crate::HessianSink;
use crate::evaluation::{Evaluation, Room};
use crate::potential::At;
use isosheet_linalg::parallel::{Work, in_order};

/// Nanoseconds for the state of a face with its energy, as for its part of a Hessian, by a profile of a drape
/// of 2437 vertices on one core at 2.4 GHz. It decides what is shared among threads, and no result.
const FACE_TIME: f64 = 100.0;
/// Nanoseconds for what a face does along a displacement, by the profile from which [`FACE_TIME`] is. It
/// decides what is shared among threads, and no result.
const COURSE_TIME: f64 = 40.0;

/// The faces where a sheet was evaluated last, with their energies, and room for their Hessians.
#[derive(Debug, Default, Clone)]
pub(super) struct EvaluatedFaces {
    states: Evaluation<(Strained, f64)>,
    blocks: Room<Vec<Blocks>>,
    courses: Room<Vec<Option<StrainCourse>>>,
}

/// The stiffness of the barrier in a memory, joules per square metre; none without.
pub(super) fn barrier_of(memory: &[f64]) -> f64 {
    memory.first().copied().unwrap_or(0.0)
}

/// A face, with its state.
pub(super) fn strained<'a>(faces: &'a [Face], k: usize, at: At<'_>) -> (&'a Face, Strained) {
    let bends = at.memory.get(1..).unwrap_or_default().as_chunks().0;
    let bend = bends.get(k).map_or(Bend::FLAT, Bend::remembered);
    let face = &faces[k];
    (face, face.at(at, &bend))
}

fn work(faces: &[Face], each: f64) -> Work {
    let count = faces.len();
    Work { count, each }
}

impl EvaluatedFaces {
    /// Hands the states of the faces to `take`, with their energies, joules.
    pub(super) fn evaluate<R>(
        &self,
        faces: &[Face],
        at: At<'_>,
        take: impl FnOnce(&[(Strained, f64)]) -> R,
    ) -> R {
        let barrier = barrier_of(at.memory);
        let state = |k| {
            let (face, strained) = strained(faces, k, at);
            let energy = face.energy(&strained, barrier);
            (strained, energy)
        };
        let work = work(faces, FACE_TIME);
        self.states.at(at, work, state, take)
    }

    /// Largest part of the displacement `dx` along which every face keeps a part of its distance from the
    /// limit.
    pub(super) fn part_within(&self, faces: &[Face], at: At<'_>, dx: &[f64]) -> f64 {
        self.evaluate(faces, at, |states| {
            let mut part = 1.0;
            let course = |k: usize| faces[k].course(&states[k].0, dx);
            let cut = |_, course: &Option<StrainCourse>| {
                if let Some(course) = course {
                    part = course.safe_part(part);
                }
            };
            let work = work(faces, COURSE_TIME);
            let room = &self.courses;
            room.with(|room| in_order(room, work, course, cut));
            part
        })
    }

    /// Whether every face keeps a part of its distance from the limit in a displacement to `end`, where the
    /// faces are evaluated.
    pub(super) fn stay_within(&self, faces: &[Face], at: At<'_>, end: &[f64]) -> bool {
        self.evaluate(faces, At { x: end, ..at }, |states| {
            let mut all = faces.iter().zip(states);
            all.all(|(face, (end, _))| face.stays_within(at, end))
        })
    }

    /// Adds the Hessian, with a part of the force densities of the edges.
    pub(super) fn add_blocks(
        &self,
        faces: &[Face],
        at: At<'_>,
        part: fn(f64) -> f64,
        hessian: &mut dyn HessianSink,
    ) {
        let barrier = barrier_of(at.memory);
        self.evaluate(faces, at, |states| {
            let blocks = |k: usize| faces[k].blocks(&states[k].0, barrier, part);
            let add = |k: usize, blocks: &Blocks| faces[k].add_hessian(blocks, hessian);
            let work = work(faces, FACE_TIME);
            let room = &self.blocks;
            room.with(|room| in_order(room, work, blocks, add));
        });
    }
}
