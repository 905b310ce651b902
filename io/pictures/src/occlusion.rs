//! Ambient occlusion: how much of the surroundings a point sees, and where a surface is smooth.

use super::camera::{centre, normal};
use super::pieces::Piece;
use super::solid::Triangles;
use isosheet_mesh::vec3::{axpy, cross, dot, sub, unit};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
use rayon::prelude::*;

/// Rays sent from every point, on a fixed spiral: pictures are the same at every run.
const RAYS: usize = 40;

/// Faces that are nearer than this part of the reach lie on the point: the other layer of a seam or of a flat
/// fold, which is either hidden by the point or hides it.
const TOUCHING: f64 = 2e-3;

/// How far in from a crease a point lies, as part of the way to the centroid of its faces: a point on the
/// crease would count the faces on the other side as touching.
const INSET: f64 = 0.25;

/// Faces at a vertex whose normals differ by less than this (cosine, 37 degrees) share one point: the surface
/// is smooth there. Creases that are sharper keep the shadow on their hollow side.
const SMOOTH: f64 = 0.8;

/// A point from which rays are sent.
struct Spot {
    vertex: usize,
    /// Sums over the corners of pieces here: unit normals towards the viewer, and centroids.
    normal: [f64; 3],
    centroid: [f64; 3],
    corners: f64,
    /// The faces that meet here, which do not hide what is around the point.
    faces: Vec<usize>,
}

/// A corner of a piece, on the side that is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    /// How much of what is around it sees, from 0, dark, to 1, free.
    pub(super) open: f64,
    /// The unit normal of the surface: the mean of the pieces that meet smoothly there.
    pub(super) normal: [f64; 3],
}

/// What hides the surroundings of points.
pub(super) struct Occlusion {
    /// Of each face a corner, and the edges from there.
    faces: Vec<[Vector; 3]>,
    tree: Bvh,
    reach: f64,
}

impl Occlusion {
    /// The faces of a scene, each of which hides what is behind it out to `reach`, less and less with
    /// distance.
    pub(super) fn new(scene: &Triangles, reach: f64) -> Self {
        let corner = |v: usize| scene.x[v].into();
        let faces: Vec<[Vector; 3]> = scene.faces.iter().map(|f| f.map(corner)).collect();
        let boxes: Vec<Aabb> = faces.iter().map(|f| Aabb::from_points(*f)).collect();
        let edges = faces.iter().map(|[a, b, c]| [*a, *b - *a, *c - *a]);
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            faces: edges.collect(),
            reach,
        }
    }

    /// What is around the three corners of every piece; corners of pieces that are not seen at all count as
    /// open.
    ///
    /// Pieces that meet smoothly in a vertex share one value there. Rays are distributed by the cosine law.
    /// The results do not depend on the number of threads: every ray is followed by itself, and the nearest
    /// face is the same in whatever order the faces are looked at.
    pub(super) fn of_corners(
        &self,
        pieces: &[Piece],
        seen: &[bool],
        scene: &Triangles,
    ) -> Vec<[Surroundings; 3]> {
        let (spots, of_corner) = spots(pieces, scene);
        let mut is_seen = vec![false; spots.len()];
        for (spots, _) in of_corner.iter().zip(seen).filter(|(_, seen)| **seen) {
            for k in spots {
                is_seen[*k] = true;
            }
        }
        let directions = spiral();
        let one = |(k, spot): (usize, &Spot)| {
            let up = unit(spot.normal);
            let corner = scene.x[spot.vertex];
            let is_crease = shares_vertex(&spots, k);
            let centroid = spot.centroid.map(|c| c / spot.corners);
            let inset = if is_crease { INSET } else { 0.0 };
            let from = axpy(corner, inset, sub(centroid, corner));
            let open = match is_seen[k] {
                true => self.around(&from, &up, &directions, &spot.faces),
                false => 1.0,
            };
            Surroundings { open, normal: up }
        };
        let around: Vec<Surroundings> = spots.par_iter().enumerate().map(one).collect();
        of_corner
            .iter()
            .map(|spots| spots.map(|k| around[k]))
            .collect()
    }

    /// Openness at a point with an upward direction; some faces hide nothing.
    fn around(
        &self,
        from: &[f64; 3],
        up: &[f64; 3],
        directions: &[[f64; 3]],
        free: &[usize],
    ) -> f64 {
        // Neighbouring points turn the spiral alike, so that the light does not flicker from one to the next.
        let aside = if up[0].abs() < 0.6 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let right = unit(cross(aside, up));
        let ahead = cross(up, right);
        let seen = directions.iter().map(|d| {
            let along = [0, 1, 2].map(|k| d[0] * right[k] + d[1] * ahead[k] + d[2] * up[k]);
            let ray = Ray::new(*from, along);
            let nearest = self.tree.find_best(
                self.reach,
                |node, _| ray.enters(node),
                |face, _| {
                    let t = ray.meets(&self.faces[face as usize])?;
                    let hides = t > TOUCHING * self.reach && !free.contains(&(face as usize));
                    hides.then_some(t)
                },
            );
            nearest.map_or(1.0, |(_, t)| (t.min(self.reach) / self.reach).sqrt())
        });
        seen.sum::<f64>() / RAYS as f64
    }
}

/// A ray as the tree asks for it.
struct Ray {
    from: Vector,
    along: Vector,
    inverse: Vector,
}

impl Ray {
    fn new(from: [f64; 3], along: [f64; 3]) -> Self {
        Self {
            from: from.into(),
            along: along.into(),
            // Not infinite where a component is zero.
            inverse: along.map(|c| 1.0 / (c + f64::MIN_POSITIVE)).into(),
        }
    }

    /// Where the ray enters a box, or the largest number for one that it misses.
    fn enters(&self, node: &BvhNode) -> f64 {
        let low = (node.mins() - self.from) * self.inverse;
        let high = (node.maxs() - self.from) * self.inverse;
        let enter = low.min(high).max_element().max(0.0);
        let leave = low.max(high).min_element();
        if enter <= leave { enter } else { f64::MAX }
    }

    /// Where the ray meets a face that is given by a corner and the edges from there.
    fn meets(&self, [corner, p, q]: &[Vector; 3]) -> Option<f64> {
        let normal = self.along.cross(*q);
        let volume = 1.0 / p.dot(normal);
        let offset = self.from - *corner;
        let u = volume * offset.dot(normal);
        // No number for a ray in the plane of the face, which meets nothing.
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let across = offset.cross(*p);
        let v = volume * self.along.dot(across);
        (v >= 0.0 && u + v <= 1.0).then(|| volume * q.dot(across))
    }
}

/// Whether another point belongs to the same vertex: points of one vertex follow each other.
fn shares_vertex(spots: &[Spot], k: usize) -> bool {
    let here = |other: Option<&Spot>| other.is_some_and(|o| o.vertex == spots[k].vertex);
    here(spots.get(k + 1)) || k > 0 && here(spots.get(k - 1))
}

/// The points of the corners of pieces, in the order of vertices, and the points of each piece.
fn spots(pieces: &[Piece], scene: &Triangles) -> (Vec<Spot>, Vec<[usize; 3]>) {
    let mut corners_at: Vec<Vec<(usize, usize)>> = vec![Vec::new(); scene.x.len()];
    for (number, piece) in pieces.iter().enumerate() {
        for (k, &v) in piece.corners.iter().enumerate() {
            corners_at[v].push((number, k));
        }
    }
    let mut spots: Vec<Spot> = Vec::new();
    let mut of_corner = vec![[0; 3]; pieces.len()];
    for (vertex, corners) in corners_at.iter().enumerate() {
        let first = spots.len();
        for &(number, k) in corners {
            let piece = &pieces[number];
            let points = piece.corners.map(|v| scene.x[v]);
            let side = if piece.back { -1.0 } else { 1.0 };
            let flat = normal(&points).map(|c| side * c);
            let skin = scene.skin(piece.face);
            let n = skin.map_or(flat, |skin| skin.normal(&flat, &scene.x[vertex]));
            let centroid = centre(&points);
            let group = (first..spots.len()).find(|&s| dot(unit(spots[s].normal), n) > SMOOTH);
            let group = group.unwrap_or_else(|| {
                spots.push(Spot {
                    vertex,
                    normal: [0.0; 3],
                    centroid: [0.0; 3],
                    corners: 0.0,
                    faces: Vec::new(),
                });
                spots.len() - 1
            });
            let spot = &mut spots[group];
            spot.normal = axpy(spot.normal, 1.0, n);
            spot.centroid = axpy(spot.centroid, 1.0, centroid);
            spot.corners += 1.0;
            if !spot.faces.contains(&piece.face) {
                spot.faces.push(piece.face);
            }
            of_corner[number][k] = group;
        }
    }
    (spots, of_corner)
}

/// Directions of the upper half space by the cosine law.
fn spiral() -> Vec<[f64; 3]> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..RAYS)
        .map(|k| {
            let square = (k as f64 + 0.5) / RAYS as f64;
            let (s, c) = (golden * k as f64).sin_cos();
            let r = square.sqrt();
            [r * c, r * s, (1.0 - square).sqrt()]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::Topology;

    fn openness(pieces: &[Piece], scene: &Triangles, reach: f64) -> Vec<[f64; 3]> {
        let around =
            Occlusion::new(scene, reach).of_corners(pieces, &vec![true; pieces.len()], scene);
        around.iter().map(|c| c.map(|c| c.open)).collect()
    }

    fn scene(faces: &[[u32; 3]], x: &[[f64; 3]]) -> Triangles {
        let topology = Topology::from_faces(x.len(), faces).unwrap();
        Triangles::new(&topology, x.as_flattened(), &[], &[0.0; 3], 1.0)
    }

    /// Two faces that meet at an angle, radians.
    fn hinge(slope: f64) -> Triangles {
        let x = [
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.5, 0.0],
            [slope.cos(), 0.5, slope.sin()],
        ];
        scene(&[[0, 1, 2], [1, 0, 3]], &x)
    }

    fn pieces(scene: &Triangles, back: impl Fn(usize) -> bool) -> Vec<Piece> {
        let faces = scene.faces.iter().enumerate();
        let piece = |(face, corners): (usize, &[usize; 3])| Piece {
            corners: *corners,
            face,
            back: back(face),
        };
        faces.map(piece).collect()
    }

    #[test]
    fn a_lone_face_is_open_and_a_covered_one_is_not() {
        let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let seen = |faces: &[[u32; 3]], x: &[[f64; 3]], back: bool| {
            let scene = scene(faces, x);
            openness(&pieces(&scene, |_| back), &scene, 1.0)
        };
        let open = |o: &[f64; 3]| o.iter().all(|o| (o - 1.0).abs() < 1e-12);
        assert!(
            [true, false]
                .map(|back| seen(&[[0, 1, 2]], &floor, back))
                .iter()
                .all(|o| open(&o[0]))
        );
        let mut x = floor.to_vec();
        x.extend([[-20.0, -20.0, 0.25], [20.0, -20.0, 0.25], [0.0, 30.0, 0.25]]);
        let both = [[0, 1, 2], [3, 4, 5]];
        // Above everything is hidden at 0.25 / cos, below nothing.
        let above = seen(&both, &x, false)[0];
        assert!(above.iter().all(|o| (0.5..0.75).contains(o)), "{above:?}");
        let scene_of_both = scene(&both, &x);
        let pieces_of_both = pieces(&scene_of_both, |_| false);
        let occlusion = Occlusion::new(&scene_of_both, 1.0);
        let unseen = occlusion.of_corners(&pieces_of_both, &[false, true], &scene_of_both);
        assert!(unseen[0].iter().all(|corner| corner.open == 1.0));
        assert!(open(&seen(&both, &x, true)[0]));
    }

    /// Where two faces meet at less than the angle of a crease they share one value, which the next face does
    /// not darken; where they meet at a right angle each has its own, and the hollow side is dark.
    #[test]
    fn creases_are_dark_inside_and_bends_are_not() {
        let at = |slope: f64| {
            let scene = hinge(slope);
            openness(&pieces(&scene, |_| false), &scene, 1.0)
        };
        let [bent, folded] = [0.3, 1.6].map(at);
        assert_eq!([bent[0][0], bent[0][1]], [bent[1][1], bent[1][0]]);
        assert!(bent[0].iter().all(|o| *o > 0.95), "{bent:?}");
        assert!(folded[0][..2].iter().all(|o| *o < 0.85), "{folded:?}");
    }

    /// A bend looks smooth, a fold does not.
    #[test]
    fn bends_have_one_normal_and_folds_two() {
        for (slope, expected) in [(0.3_f64, [0.0, 0.3]), (1.6, [0.0, 1.6])] {
            let scene = hinge(slope);
            let pieces = pieces(&scene, |_| false);
            let around = Occlusion::new(&scene, 1.0).of_corners(&pieces, &[true; 2], &scene);
            let shared = if slope < 1.0 {
                [slope / 2.0; 2]
            } else {
                expected
            };
            for ((corners, on_line), own) in around.iter().zip(shared).zip(expected) {
                for (corner, tilt) in corners.iter().zip([on_line, on_line, own]) {
                    let normal = [-tilt.sin(), 0.0, tilt.cos()];
                    let off = sub(corner.normal, normal);
                    assert!(dot(off, off) < 1e-24, "{corner:?} {tilt}");
                }
            }
        }
    }

    /// Every ray is followed by itself, so that threads change no bit.
    #[test]
    fn threads_change_nothing() {
        let x: Vec<[f64; 3]> = (0..300)
            .map(|k| {
                let k = f64::from(k);
                [(1.3 * k).sin(), (2.1 * k).cos(), (0.7 * k).sin()]
            })
            .collect();
        let faces: Vec<[u32; 3]> = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let scene = scene(&faces, &x);
        let pieces = pieces(&scene, |face| face % 2 == 0);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            pool.install(|| openness(&pieces, &scene, 2.0))
        };
        let one = on(1);
        assert!(one.iter().flatten().any(|o| *o < 0.9));
        assert_eq!(one, on(4));
    }
}
