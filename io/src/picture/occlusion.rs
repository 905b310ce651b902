//! Ambient occlusion: how much of the surroundings a point of the sheet sees.

use super::camera::normal;
use super::pieces::Piece;
use super::vector::{axpy, cross, sub, unit};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::Ray;
use parry3d_f64::query::details::local_ray_intersection_with_triangle;
use rayon::prelude::*;

/// Rays sent from every point, on a fixed spiral: pictures are the same at every run.
const RAYS: usize = 40;

/// How far in from its corner of a face a point lies, as part of the way to the centroid: a point on a crease
/// would count the neighbouring face as touching.
const INSET: f64 = 0.25;

/// Openness (0 dark to 1 free) at the three corners of every piece, on its front or back side. A piece is a
/// face or a part of one.
///
/// Rays are distributed by the cosine law; a face hides what is behind it out to `reach`, less and less with
/// distance. The results do not depend on the number of threads: every ray is followed by itself, and the
/// nearest face is the same in whatever order the faces are looked at.
pub(super) fn openness(
    pieces: &[Piece],
    faces: &[[usize; 3]],
    x: &[[f64; 3]],
    reach: f64,
) -> Vec<[f64; 3]> {
    let faces: Vec<[Vector; 3]> = faces.iter().map(|f| f.map(|v| x[v].into())).collect();
    let boxes: Vec<Aabb> = faces.iter().map(|f| Aabb::from_points(*f)).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let directions = spiral();
    let one = |piece: &Piece| {
        let c = piece.corners.map(|v| x[v]);
        let side = if piece.back { -1.0 } else { 1.0 };
        let up = normal(&c).map(|k| side * k);
        let right = unit(&cross(&up, &sub(&c[1], &c[0])));
        let ahead = cross(&up, &right);
        let centroid = [0, 1, 2].map(|k| (c[0][k] + c[1][k] + c[2][k]) / 3.0);
        c.map(|corner| {
            let from = axpy(&corner, INSET, &sub(&centroid, &corner));
            let seen = directions.iter().map(|d| {
                let along = [0, 1, 2].map(|k| d[0] * right[k] + d[1] * ahead[k] + d[2] * up[k]);
                let ray = Ray::new(from.into(), along.into());
                let nearest = tree.cast_ray(&ray, reach, |face, _| {
                    // A ray does not meet the face that it starts from.
                    let [a, b, c] = faces[face as usize];
                    let hit = (face as usize != piece.face)
                        .then(|| local_ray_intersection_with_triangle(a, b, c, &ray));
                    let t = hit.flatten()?.0.time_of_impact;
                    (t > 0.0).then_some(t)
                });
                nearest.map_or(1.0, |(_, t)| (t.min(reach) / reach).sqrt())
            });
            seen.sum::<f64>() / RAYS as f64
        })
    };
    pieces.par_iter().map(one).collect()
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

    #[test]
    fn a_lone_face_is_open_and_a_covered_one_is_not() {
        let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let seen = |faces: &[[usize; 3]], x: &[[f64; 3]], back: bool| {
            let piece = |(face, corners): (usize, &[usize; 3])| Piece {
                corners: *corners,
                face,
                back,
            };
            let pieces: Vec<Piece> = faces.iter().enumerate().map(piece).collect();
            openness(&pieces, faces, x, 1.0)
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
        assert!(open(&seen(&both, &x, true)[0]));
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
        let faces: Vec<[usize; 3]> = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let piece = |(face, corners): (usize, &[usize; 3])| Piece {
            corners: *corners,
            face,
            back: face % 2 == 0,
        };
        let pieces: Vec<Piece> = faces.iter().enumerate().map(piece).collect();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            pool.install(|| openness(&pieces, &faces, &x, 2.0))
        };
        let one = on(1);
        assert!(one.iter().flatten().any(|o| *o < 0.9));
        assert_eq!(one, on(4));
    }
}
