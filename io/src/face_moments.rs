//! The centre of the area of triangles, and the normal of the plane that they are nearest to.

use nalgebra::{Matrix3, Vector3};

/// What triangles are like as a whole.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FaceMoments {
    /// The centre of their area.
    pub(crate) centre: [f64; 3],
    /// The axis of their normals, weighted by area, of length 1. Its largest component is positive: the
    /// orientation of the faces does not matter.
    pub(crate) normal: Vector3<f64>,
}

impl FaceMoments {
    /// Of triangles by their corners; `None` if they have no area.
    pub(crate) fn of(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Option<Self> {
        let mut area = 0.0;
        let mut centre = Vector3::zeros();
        let mut normals = Matrix3::zeros();
        for face in faces {
            let [a, b, c] = face.map(|v| Vector3::from(points[v as usize]));
            let normal = 0.5 * (b - a).cross(&(c - a));
            let size = normal.norm();
            if size > 0.0 {
                area += size;
                centre += size / 3.0 * (a + b + c);
                normals += normal * normal.transpose() / size;
            }
        }
        if !(area > 0.0 && area.is_finite()) {
            return None;
        }
        let axes = (normals / area).symmetric_eigen();
        let normal: Vector3<f64> = axes
            .eigenvectors
            .column(axes.eigenvalues.imax())
            .into_owned();
        Some(Self {
            centre: (centre / area).into(),
            normal: normal * normal[normal.iamax()].signum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_strip_and_a_triangle_have_the_centre_and_the_normal_of_their_faces() {
        let strip = [
            [0.0, 0.0, 2.0],
            [9.0, 0.0, 2.0],
            [9.0, 0.01, 2.0],
            [0.0, 0.01, 2.0],
        ];
        // Two faces of opposite orientation.
        let found = FaceMoments::of(&strip, &[[0, 1, 2], [0, 3, 2]]).unwrap();
        assert!((found.normal - Vector3::z()).norm() < 1e-12);
        for (found, expected) in found.centre.into_iter().zip([4.5, 0.005, 2.0]) {
            assert!((found - expected).abs() < 1e-12);
        }
        let triangle = [[0.0; 3], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]];
        let found = FaceMoments::of(&triangle, &[[0, 2, 1]]).unwrap();
        assert!((found.normal - Vector3::x()).norm() < 1e-12);
        assert!((found.centre[1] - 1.0).abs() < 1e-12 && found.centre[0] == 0.0);
        assert_eq!(FaceMoments::of(&triangle, &[[0, 1, 1]]), None);
    }
}
