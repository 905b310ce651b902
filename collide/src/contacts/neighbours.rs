//! Lists of neighbours that serve many motions.

use super::body::ContactBody;
use super::displacements::Displacements;
use super::motion::SheetMotion;
use isosheet_geometry::distance::{edge_edge, point_triangle};
use isosheet_geometry::vectors::{gather, larger};
use isosheet_geometry::{BroadPhase, Candidates, ContactMesh, CrossCandidates, RigidPath};
use isosheet_linalg::parallel::{Work, fill};

/// Skin of the lists, in mean edge lengths. With 0.06 and 0.25 a draping disk of 688 vertices takes 12 % and
/// 25 % more time, a star of 876 vertices as long and 14 % more, tablecloths of 289 vertices as long; with
/// 0.6 all take 10 to 55 % more.
const SKIN: f64 = 0.12;
/// Lists of a motion that is so many times as long as the motion at hand, or as the skin, are made anew,
/// because they hold too many pairs.
const LONGEST: f64 = 16.0;
/// Nanoseconds for the distance of a pair, estimated: it decides what is shared among threads, and no result.
const DISTANCE_TIME: f64 = 60.0;
/// Part of the skin that motions may use. The rest covers the round-off of the boxes, as long as
/// coordinates are below a million edge lengths.
const USED: f64 = 1.0 - 1e-6;

/// Whether pairs of the sheet with itself are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SelfPairs {
    /// They are not.
    Ignored,
    /// They are.
    Listed,
}

/// Pairs of primitives that may come within reach of each other, found by the broad phase.
///
/// The lists are made of the boxes of one motion, enlarged by a skin, and hold all pairs that come within
/// reach on motions that leave these boxes by no more than the skin, relative to each other (Verlet, Phys.
/// Rev. 159, 1967, with positions in place of motions). Whoever asks for pairs looks at the boxes of the
/// motion at hand too, and so finds the same pairs whatever was asked for before. Of the sheet with itself
/// only pairs are looked at whose distance in the middle of that motion and whose displacements since then
/// allow a contact.
#[derive(Debug)]
pub(super) struct Neighbours {
    /// Boxes of the sheet during the motion that was asked for last. The tree is that of the lists.
    boxes: BroadPhase,
    /// Metres.
    skin: f64,
    own_pairs: SelfPairs,
    /// Start, end and middle of the motion that lists were made for, `3V`, metres.
    listed: [Vec<f64>; 3],
    /// Largest displacement along an axis on that motion, at least the skin, metres; infinite where there are
    /// no lists.
    listed_length: f64,
    /// Positions at the end of the motion.
    end: Vec<f64>,
    /// Pairs of the sheet with itself, as the broad phase finds them.
    candidates: Candidates,
    vertex_face: ByDistance,
    edge_edge: ByDistance,
    /// Distance in the middle of the listed motion from which pairs of the sheet with itself stay out of
    /// reach on the motion, metres.
    far: f64,
    /// Of each body.
    cross: Vec<CrossCandidates>,
}

impl Neighbours {
    /// No lists yet, with the shape of the tree from the positions of a sheet whose edges have the mean
    /// length `length`, metres.
    pub(super) fn new(
        sheet: SheetMotion<'_>,
        length: f64,
        bodies: usize,
        own_pairs: SelfPairs,
    ) -> Self {
        Self {
            boxes: BroadPhase::new(sheet.mesh.clone(), sheet.x),
            skin: SKIN * length,
            own_pairs,
            listed: std::array::from_fn(|_| sheet.x.to_vec()),
            listed_length: f64::INFINITY,
            end: sheet.x.to_vec(),
            candidates: Candidates::default(),
            vertex_face: ByDistance::default(),
            edge_edge: ByDistance::default(),
            far: f64::INFINITY,
            cross: vec![CrossCandidates::default(); bodies],
        }
    }

    /// Boxes of the sheet during the motion of the last update.
    pub(super) fn boxes(&self) -> &BroadPhase {
        &self.boxes
    }

    /// Pairs of a vertex and a face of the sheet that may come within reach, with their distances in the
    /// middle of the listed motion.
    pub(super) fn vertex_face(&self) -> &[(f64, [u32; 2])] {
        self.vertex_face.below(self.far)
    }

    /// Pairs of two edges of the sheet that may come within reach, with their distances in the middle of the
    /// listed motion.
    pub(super) fn edge_edge(&self) -> &[(f64, [u32; 2])] {
        self.edge_edge.below(self.far)
    }

    /// Pairs of the sheet with a body. The list also has pairs whose boxes do not overlap.
    pub(super) fn with_body(&self, body: usize) -> &CrossCandidates {
        &self.cross[body]
    }

    /// The boxes of the sheet at rest, with their tree.
    pub(super) fn at_rest(&mut self, x: &[f64], reach: f64) -> &mut BroadPhase {
        self.listed_length = f64::INFINITY;
        self.boxes.update(x, x, 0.5 * reach);
        &mut self.boxes
    }

    /// Sets the boxes of sheet and bodies for a motion, and makes the lists anew if the motion needs that.
    /// `parts` are the motions of the bodies.
    pub(super) fn update(
        &mut self,
        sheet: SheetMotion<'_>,
        bodies: &mut [ContactBody],
        parts: &[RigidPath],
    ) {
        let SheetMotion { x, dx, reach, .. } = sheet;
        for (end, (x, dx)) in self.end.iter_mut().zip(x.iter().zip(dx)) {
            *end = x + dx;
        }
        for (body, part) in bodies.iter_mut().zip(parts) {
            if let Some(features) = body.features_mut() {
                features.place(part, reach);
            }
        }
        let length = dx.iter().fold(self.skin, |m, d| m.max(d.abs()));
        if self.listed_length > LONGEST * length || !self.is_within_skin(x, bodies) {
            self.list(sheet, bodies);
            self.listed_length = length;
        }
        self.boxes.update_boxes(x, &self.end, 0.5 * reach);
        if self.own_pairs == SelfPairs::Listed {
            let far = reach + self.approach(x) + (1.0 - USED) * self.skin;
            self.far = if far.is_nan() { f64::INFINITY } else { far };
        }
    }

    /// Bound on how much nearer two points of the sheet come to each other from the middle of the listed
    /// motion to some place on the motion from `x` to the end, metres.
    fn approach(&self, x: &[f64]) -> f64 {
        let [.., middle] = &self.listed;
        let before = Displacements::beyond([middle; 2], x, x).spread();
        let now = Displacements::beyond([x; 2], &self.end, &self.end).spread();
        // Points come nearer by the first; by what `approach` in sheet.rs bounds, once for each primitive,
        // which is the displacement relative to the mean of four points, by no more than twice 3/4 of
        // the second.
        before + 1.5 * now
    }

    /// Whether the motion from `x` to the end leaves the boxes of the lists by no more than the skin.
    fn is_within_skin(&self, x: &[f64], bodies: &[ContactBody]) -> bool {
        let [start, end, _] = &self.listed;
        let sheet = Displacements::beyond([start, end], x, &self.end);
        // Of a pair of the sheet with itself both boxes are enlarged by the skin, of a pair with a body only
        // that of the sheet.
        let itself = match self.own_pairs {
            SelfPairs::Listed => 0.5 * sheet.relative_to(&sheet),
            SelfPairs::Ignored => 0.0,
        };
        let of_bodies = bodies.iter().filter_map(ContactBody::features);
        let displacements = of_bodies.map(|f| sheet.relative_to(f.displacements()) + f.growth());
        // Not a number, and so not within the skin, where a coordinate is not.
        displacements.fold(itself, larger) <= USED * self.skin
    }

    /// Makes the lists for motions like that of the sheet.
    fn list(&mut self, sheet: SheetMotion<'_>, bodies: &mut [ContactBody]) {
        let SheetMotion { mesh, x, reach, .. } = sheet;
        let [start, end, middle] = &mut self.listed;
        start.copy_from_slice(x);
        end.copy_from_slice(&self.end);
        for (m, (x, end)) in middle.iter_mut().zip(x.iter().zip(end)) {
            *m = 0.5 * (x + *end);
        }
        self.boxes.update(x, &self.end, 0.5 * reach + self.skin);
        if self.own_pairs == SelfPairs::Listed {
            self.boxes.self_candidates(&mut self.candidates);
            let Candidates {
                vertex_face,
                edge_edge: two_edges,
            } = &self.candidates;
            let [.., at] = &self.listed;
            self.vertex_face.set(vertex_face, |pair| {
                let vertices = mesh.vertex_face(pair);
                point_triangle(&gather(at, vertices)).distance() - radii(mesh, vertices)
            });
            self.edge_edge.set(two_edges, |pair| {
                let vertices = mesh.edge_edge(pair);
                edge_edge(&gather(at, vertices)).distance() - radii(mesh, vertices)
            });
        }
        for (body, pairs) in bodies.iter_mut().zip(&mut self.cross) {
            if let Some(features) = body.features_mut() {
                self.boxes.candidates_with(features.list(), pairs);
            }
        }
    }
}

/// The radii of two primitives, the first of which has the first and the second one the last of these
/// vertices, metres.
fn radii(mesh: &ContactMesh, [first, .., last]: [u32; 4]) -> f64 {
    mesh.radius(first) + mesh.radius(last)
}

/// Pairs in the order of their distances, less the radii of what is round, in the middle of the listed
/// motion, metres.
#[derive(Debug, Default)]
struct ByDistance(Vec<(f64, [u32; 2])>);

impl ByDistance {
    /// Takes over other pairs.
    fn set(&mut self, pairs: &[[u32; 2]], distance: impl Fn([u32; 2]) -> f64 + Sync) {
        // (What is not a number is taken to be no distance.)
        let entry = |k: usize| (distance(pairs[k]).max(0.0), pairs[k]);
        let count = pairs.len();
        let each = DISTANCE_TIME;
        fill(&mut self.0, Work { count, each }, entry);
        self.0.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// The pairs whose distance is not above `far`.
    fn below(&self, far: f64) -> &[(f64, [u32; 2])] {
        let count = self.0.partition_point(|(distance, _)| *distance <= far);
        &self.0[..count]
    }
}
