//! Ambient occlusion: how much of the surroundings a point of the sheet sees.

use super::camera::normal;
use super::pieces::Piece;
use crate::draw::spatial::{axpy, cross, dot, sub, unit};

/// Rays sent from every point, on a fixed spiral: pictures are the same at every run.
const RAYS: usize = 40;

/// How far in from its corner of a face a point lies, as part of the way to the centroid: a point on a crease
/// would count the neighbouring face as touching.
const INSET: f64 = 0.25;

/// Openness (0 dark to 1 free) at the three corners of every piece, on its front or back side. A piece is a
/// face or a part of one.
///
/// Rays are distributed by the cosine law; a face hides what is behind it out to `reach`, less and less with
/// distance.
pub(super) fn openness(
    pieces: &[Piece],
    faces: &[[usize; 3]],
    x: &[[f64; 3]],
    reach: f64,
) -> Vec<[f64; 3]> {
    let faces: Vec<[[f64; 3]; 3]> = faces.iter().map(|f| f.map(|v| x[v])).collect();
    let boxes: Vec<[[f64; 2]; 3]> = faces.iter().map(bounds).collect();
    let directions = spiral();
    let one = |piece: &Piece| {
        let c = piece.corners.map(|v| x[v]);
        // No ray from the piece gets farther than this.
        let around = bounds(&c).map(|[low, high]| [low - reach, high + reach]);
        let near: Vec<&[[f64; 3]; 3]> = (0..faces.len())
            .filter(|k| *k != piece.face)
            .filter(|k| {
                let mut axes = boxes[*k].iter().zip(&around);
                axes.all(|(a, b)| a[0] <= b[1] && b[0] <= a[1])
            })
            .map(|k| &faces[k])
            .collect();
        let side = if piece.back { -1.0 } else { 1.0 };
        let up = normal(&c).map(|k| side * k);
        let right = unit(&cross(&up, &sub(&c[1], &c[0])));
        let ahead = cross(&up, &right);
        let centroid = [0, 1, 2].map(|k| (c[0][k] + c[1][k] + c[2][k]) / 3.0);
        c.map(|corner| {
            let from = axpy(&corner, INSET, &sub(&centroid, &corner));
            let mut seen = 0.0;
            for d in &directions {
                let ray = [0, 1, 2].map(|k| d[0] * right[k] + d[1] * ahead[k] + d[2] * up[k]);
                let mut nearest = reach;
                for other in &near {
                    if let Some(t) = hit(&from, &ray, other) {
                        nearest = nearest.min(t);
                    }
                }
                seen += (nearest / reach).sqrt();
            }
            seen / RAYS as f64
        })
    };
    pieces.iter().map(one).collect()
}

/// The smallest and largest coordinates of a face.
fn bounds(face: &[[f64; 3]; 3]) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|axis| {
        let [a, b, c] = face.map(|p| p[axis]);
        [a.min(b).min(c), a.max(b).max(c)]
    })
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

/// Distance along the unit ray to a triangle (Möller and Trumbore 1997).
fn hit(from: &[f64; 3], ray: &[f64; 3], c: &[[f64; 3]; 3]) -> Option<f64> {
    let (e1, e2) = (sub(&c[1], &c[0]), sub(&c[2], &c[0]));
    let p = cross(ray, &e2);
    let det = dot(&e1, &p);
    if det == 0.0 {
        return None;
    }
    let s = sub(from, &c[0]);
    let u = dot(&s, &p) / det;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = cross(&s, &e1);
    let v = dot(ray, &q) / det;
    if v < 0.0 || u + v > 1.0 {
        return None;
    }
    let t = dot(&e2, &q) / det;
    (t > 0.0).then_some(t)
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
}
