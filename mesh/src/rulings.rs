//! The rulings of a bent sheet: the straight lines of a developable surface, face by face.

use crate::vec3::{Vec3, cross, dot, norm, sub};

/// The line along which a face is straight, and how much it is curved across it.
///
/// A developable surface has one principal curvature that is zero, and straight lines in it along that
/// direction, its rulings. Of a mesh it is the direction of the principal curvature that is smaller in size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ruling {
    /// Unit vector along the ruling, in the plane of the face. Of both directions it is the one whose
    /// component of largest size is positive (of components of equal size the first one).
    pub direction: [f64; 3],
    /// The principal curvature across the ruling, 1/m: positive where the sheet is a valley as seen from the
    /// side from which faces are counter-clockwise.
    pub curvature: f64,
}

/// Part of `(kappa h)^2` by which an arc over the length `h` is longer than its chord, as a factor: a chord
/// of an arc of the angle `a` is shorter by `a^2 / 24`.
const SHORTENING: f64 = 24.0;

impl Ruling {
    /// Of a face with its corners (counter-clockwise, metres) and its second fundamental form
    /// `(k11, k12, k22)`, 1/m: the second derivatives of the surface along the normal of the face, by lengths
    /// along the first edge of the face and, counter-clockwise from it, across. `strain` is the relative
    /// error of the lengths of edges.
    ///
    /// Nothing where there is no ruling beyond noise. With the longest edge `h` of the face and its principal
    /// curvatures `k1`, `k2`, `|k1| >= |k2|`, there is one if
    ///
    /// ```text
    /// |k1| - |k2| > (24 strain)^(1/2) / h + |k1| (k1 h)^2.
    /// ```
    ///
    /// The first term is the curvature that an error of the length may hide: a chord of an arc of the angle
    /// `a` is shorter by the part `a^2 / 24`. The second one is the order of the error of curvatures that are
    /// fitted to positions with the spacing `h`. So a flat face has none, nor have a sphere and an umbilic,
    /// where both curvatures are alike, nor a sharp fold, by a radian and more over a face.
    ///
    /// ```
    /// use isosheet_mesh::Ruling;
    /// let corners = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0]];
    /// let ruling = Ruling::of_face(&corners, [0.0, 0.0, -2.0], 1e-12);
    /// let along_x = Ruling { direction: [1.0, 0.0, 0.0], curvature: -2.0 };
    /// assert_eq!(ruling, Some(along_x));
    /// ```
    pub fn of_face(corners: &[[f64; 3]; 3], form: [f64; 3], strain: f64) -> Option<Self> {
        let [first, second] = axes(corners)?;
        let size = longest(corners);
        let [large, small] = principal_values(form);
        let turned = large * size;
        let noise = (SHORTENING * strain).sqrt() / size + large.abs() * turned * turned;
        // (What is not a number is not beyond noise.)
        let beyond = large.abs() - small.abs() > noise;
        if !beyond {
            return None;
        }
        let [k11, k12, k22] = form;
        // The direction of the larger value by sign.
        let angle = 0.5 * (2.0 * k12).atan2(k11 - k22);
        let (sine, cosine) = angle.sin_cos();
        let [along, across] = match large >= small {
            true => [-sine, cosine],
            false => [cosine, sine],
        };
        let direction: Vec3 = [0, 1, 2].map(|k| along * first[k] + across * second[k]);
        let mut sign_of = 0.0_f64;
        for component in direction {
            if component.abs() > sign_of.abs() {
                sign_of = component;
            }
        }
        Some(Self {
            direction: direction.map(|c| if sign_of < 0.0 { -c } else { c }),
            curvature: large,
        })
    }
}

/// The principal values of a symmetric matrix `(k11, k12, k22)`, the larger one in size first.
pub fn principal_values([k11, k12, k22]: [f64; 3]) -> [f64; 2] {
    let mean = 0.5 * (k11 + k22);
    let radius = (0.5 * (k11 - k22)).hypot(k12);
    let first = if mean < 0.0 {
        mean - radius
    } else {
        mean + radius
    };
    [first, 2.0 * mean - first]
}

/// Unit vectors in the plane of a face: along its first edge, and counter-clockwise across; nothing of one
/// without an area.
fn axes([a, b, c]: &[[f64; 3]; 3]) -> Option<[Vec3; 2]> {
    let base = sub(*b, *a);
    let normal = cross(base, sub(*c, *a));
    let across = cross(normal, base);
    let unit = |v: Vec3| {
        let length = norm(v);
        (length.is_normal()).then(|| v.map(|c| c / length))
    };
    Some([unit(base)?, unit(across)?])
}

/// The length of the longest edge of a face.
fn longest([a, b, c]: &[[f64; 3]; 3]) -> f64 {
    let squared = [[a, b], [b, c], [c, a]].map(|[p, q]| {
        let side = sub(*p, *q);
        dot(side, side)
    });
    squared.into_iter().fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A face in space, not along its axes, with its normal.
    fn face() -> [[f64; 3]; 3] {
        [[0.1, 0.2, 0.3], [0.12, 0.21, 0.29], [0.1, 0.22, 0.31]]
    }

    /// A form of two principal values gives the direction of the smaller one, whatever the axes.
    #[test]
    fn the_ruling_is_the_direction_of_the_smaller_curvature() {
        let corners = face();
        let [first, second] = axes(&corners).unwrap();
        for (k1, k2) in [(3.0, 0.0), (-3.0, 0.5), (2.0, -0.3), (-4.0, -1.0)] {
            for angle in [0.0, 0.4, 1.1, 1.6, 2.9] {
                // The direction across, and the ruling a quarter turn further.
                let (s, c) = f64::sin_cos(angle);
                let form = [
                    k1 * c * c + k2 * s * s,
                    (k1 - k2) * s * c,
                    k1 * s * s + k2 * c * c,
                ];
                let ruling = Ruling::of_face(&corners, form, 1e-12).unwrap();
                assert!((ruling.curvature - k1).abs() < 1e-14 * k1.abs());
                let expected = [0, 1, 2].map(|k| c * second[k] - s * first[k]);
                let cosine = dot(ruling.direction, expected);
                assert!((cosine.abs() - 1.0).abs() < 1e-14, "{cosine}");
                assert!((norm(ruling.direction) - 1.0).abs() < 1e-15);
                let largest = ruling
                    .direction
                    .into_iter()
                    .max_by(|a, b| a.abs().total_cmp(&b.abs()));
                assert!(largest.unwrap() > 0.0);
            }
        }
    }

    #[test]
    fn what_is_not_beyond_noise_has_no_ruling() {
        let corners = face();
        let size = longest(&corners);
        let of = |form| Ruling::of_face(&corners, form, 1e-12);
        let least = (24.0e-12_f64).sqrt() / size;
        assert_eq!(of([0.0; 3]), None);
        assert_eq!(of([0.99 * least, 0.0, 0.0]), None);
        assert!(of([1.01 * least, 0.0, 0.0]).is_some());
        // A sphere, a saddle of equal curvatures, a sharp fold, and what cannot be told.
        assert_eq!(of([2.0, 0.0, 2.0]), None);
        assert_eq!(of([0.0, 2.0, 0.0]), None);
        assert_eq!(of([1.01 / size, 0.0, 0.0]), None);
        assert_eq!(of([f64::NAN, 0.0, 1.0]), None);
        let needle = [corners[0], corners[1], corners[1]];
        assert_eq!(Ruling::of_face(&needle, [2.0, 0.0, 0.0], 1e-12), None);
    }
}
