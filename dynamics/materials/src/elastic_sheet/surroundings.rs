//! The faces around each face of a sheet.

use super::face::Face;
use isosheet_mesh::{FaceId, Topology};
use nalgebra::{Complex, Vector3};
use std::collections::VecDeque;

/// For each face the faces that share a corner with it, itself among them.
#[derive(Debug, Clone)]
pub(super) struct Surroundings {
    /// Where the faces around each face begin.
    starts: Vec<usize>,
    around: Vec<Neighbour>,
}

/// A face around another one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neighbour {
    /// Its number in the sheet.
    pub(super) face: usize,
    /// `exp(2 i a)`, with the angle `a` from the first axis of the other face to its own when faces are
    /// unfolded.
    turn: Complex<f64>,
}

impl Surroundings {
    pub(super) fn new(topology: &Topology, faces: &[Face]) -> Self {
        let (mut starts, mut around) = (vec![0], Vec::new());
        for face in topology.face_ids() {
            around.extend(unfolded(topology, faces, face));
            starts.push(around.len());
        }
        Self { starts, around }
    }

    /// The faces around each face.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[Neighbour]> {
        let ranges = self.starts.windows(2);
        ranges.map(|range| &self.around[range[0]..range[1]])
    }

    /// The faces around one.
    pub(super) fn of(&self, face: usize) -> &[Neighbour] {
        &self.around[self.starts[face]..self.starts[face + 1]]
    }
}

/// The faces around a face, unfolded across their edges into its plane.
fn unfolded(topology: &Topology, faces: &[Face], face: FaceId) -> Vec<Neighbour> {
    let corners = topology.faces()[face.index()];
    let shares_a_corner = |f: FaceId| {
        let others = topology.faces()[f.index()];
        others.iter().any(|v| corners.contains(v))
    };
    let own = Neighbour {
        face: face.index(),
        turn: Complex::new(1.0, 0.0),
    };
    let (mut found, mut next) = (vec![own], VecDeque::from([own]));
    while let Some(Neighbour { face, turn }) = next.pop_front() {
        for edge in topology.face_edges(FaceId(face as u32)) {
            let others = topology.edge_faces(edge).into_iter().flatten();
            for other in others.filter(|f| shares_a_corner(*f)) {
                if found.iter().any(|n| n.face == other.index()) {
                    continue;
                }
                let [here, there] = [face, other.index()].map(|f| faces[f].direction(edge));
                let neighbour = Neighbour {
                    face: other.index(),
                    turn: turn * here * there.conj(),
                };
                found.push(neighbour);
                next.push_back(neighbour);
            }
        }
    }
    found
}

/// The largest principal value of the mean of a tensor over faces by their areas. `of` gives the area of a
/// face and the components `(s_11, sqrt(2) s_12, s_22)` by its own axes.
pub(super) fn largest_of_mean(
    around: &[Neighbour],
    of: impl Fn(usize) -> (f64, Vector3<f64>),
) -> f64 {
    let (mut area, mut trace) = (0.0, 0.0);
    let mut deviator = Complex::new(0.0, 0.0);
    for neighbour in around {
        let (own, s) = of(neighbour.face);
        area += own;
        trace += own * (s[0] + s[2]);
        let difference = Complex::new(s[0] - s[2], std::f64::consts::SQRT_2 * s[1]);
        deviator += neighbour.turn * difference * own;
    }
    0.5 * (trace + deviator.norm()) / area
}

/// Hands the derivatives of [`largest_of_mean`] by the tensor of each face to `take`.
pub(super) fn pull_largest_of_mean(
    around: &[Neighbour],
    of: impl Fn(usize) -> (f64, Vector3<f64>),
    mut take: impl FnMut(usize, Vector3<f64>),
) {
    let mut area = 0.0;
    let mut deviator = Complex::new(0.0, 0.0);
    for neighbour in around {
        let (own, s) = of(neighbour.face);
        area += own;
        let difference = Complex::new(s[0] - s[2], std::f64::consts::SQRT_2 * s[1]);
        deviator += neighbour.turn * difference * own;
    }
    let size = deviator.norm();
    let along = match size > 0.0 {
        true => deviator.conj() / size,
        false => Complex::new(0.0, 0.0),
    };
    for neighbour in around {
        let (own, _) = of(neighbour.face);
        let turned = along * neighbour.turn;
        let scale = 0.5 * own / area;
        let shear = -std::f64::consts::SQRT_2 * turned.im;
        let tensor = Vector3::new(1.0 + turned.re, shear, 1.0 - turned.re);
        take(neighbour.face, scale * tensor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{Sheet, generate};

    fn surroundings(sheet: &Sheet) -> (Vec<Face>, Surroundings) {
        let topology = sheet.topology();
        let face = |f| Face::new(sheet, f, 0.1).expect("a face with an area");
        let faces: Vec<Face> = topology.face_ids().map(face).collect();
        let surroundings = Surroundings::new(topology, &faces);
        (faces, surroundings)
    }

    /// A tensor that is the same everywhere has the same mean everywhere, whatever the axes of faces are.
    #[test]
    fn the_mean_of_one_tensor_is_that_tensor() {
        let angle: f64 = 0.7;
        let [pull, push] = [2.0, -0.5];
        let along = Vector3::new(angle.cos(), angle.sin(), 0.0);
        let across = Vector3::new(-angle.sin(), angle.cos(), 0.0);
        for sheet in [
            generate::annulus(24, 4, 0.1, 0.3).expect("an annulus"),
            generate::delaunay_square(1.0, 0.2, 1).expect("a square"),
        ] {
            let (faces, around) = surroundings(&sheet);
            // By the axes of a face, the first of which is along its first edge.
            let tensor = |k: usize| {
                let [p, q, r] = faces[k].corners().map(|v| Vector3::from(sheet.position(v)));
                let x = (r - q).normalize();
                let y = ((p - q) - x * x.dot(&(p - q))).normalize();
                let by = |u: &Vector3<f64>, v: &Vector3<f64>| {
                    pull * u.dot(&along) * v.dot(&along) + push * u.dot(&across) * v.dot(&across)
                };
                let root = std::f64::consts::SQRT_2;
                Vector3::new(by(&x, &x), root * by(&x, &y), by(&y, &y))
            };
            for around in around.iter() {
                let mean = largest_of_mean(around, |k| (faces[k].area(), tensor(k)));
                assert!((mean - pull).abs() < 1e-12, "{mean}");
            }
        }
    }

    #[test]
    fn the_faces_around_are_those_that_share_a_corner() {
        let sheet = generate::annulus(12, 3, 0.1, 0.3).expect("an annulus");
        let topology = sheet.topology();
        let (_, around) = surroundings(&sheet);
        for (around, corners) in around.iter().zip(topology.faces()) {
            let mut found: Vec<usize> = around.iter().map(|n| n.face).collect();
            let faces = corners.iter().flat_map(|v| topology.vertex_faces(*v));
            let mut expected: Vec<usize> = faces.map(|f| f.index()).collect();
            for list in [&mut found, &mut expected] {
                list.sort_unstable();
                list.dedup();
            }
            assert_eq!((found.len(), found), (around.len(), expected));
        }
    }
}
