//! Random surfaces for property tests, and parts of sheets.

use proptest::prelude::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{FaceId, MeshError, Sheet, Topology, VertexId};

/// A face list under construction, with its vertex count.
pub(crate) type Soup = (usize, Vec<[u32; 3]>);

/// An arbitrary triangulated disk, grown from one triangle by `steps` random moves: an ear on a boundary
/// edge, a triangle across a boundary corner, a vertex inside a face, a flip of an inner edge.
pub(crate) fn random_disk(rng: &mut impl Rng, steps: usize) -> Soup {
    let mut n = 3u32;
    let mut faces = vec![[0, 1, 2]];
    let mut rim = vec![0, 1, 2];
    for _ in 0..steps {
        match rng.random_range(0..4) {
            0 => {
                let i = rng.random_range(0..rim.len());
                let (a, b) = (rim[i], rim[(i + 1) % rim.len()]);
                faces.push([b, a, n]);
                rim.insert(i + 1, n);
                n += 1;
            }
            1 => {
                let i = rng.random_range(0..rim.len());
                let (a, b, c) = (rim[i], rim[(i + 1) % rim.len()], rim[(i + 2) % rim.len()]);
                if rim.len() > 3 && !joined(&faces, a, c) {
                    faces.push([b, a, c]);
                    rim.remove((i + 1) % rim.len());
                }
            }
            2 => {
                let f = rng.random_range(0..faces.len());
                let [a, b, c] = faces[f];
                faces[f] = [a, b, n];
                faces.extend([[b, c, n], [c, a, n]]);
                n += 1;
            }
            _ => flip(rng, &mut faces),
        }
    }
    (n as usize, faces)
}

fn joined(faces: &[[u32; 3]], a: u32, b: u32) -> bool {
    faces.iter().any(|f| f.contains(&a) && f.contains(&b))
}

/// Turns the edge between two random neighbouring faces, if the new edge does not exist yet.
fn flip(rng: &mut impl Rng, faces: &mut [[u32; 3]]) {
    let f = rng.random_range(0..faces.len());
    let i = rng.random_range(0..3usize);
    let (a, b, c) = (faces[f][i], faces[f][(i + 1) % 3], faces[f][(i + 2) % 3]);
    for g in 0..faces.len() {
        for j in 0..3 {
            if faces[g][j] == b && faces[g][(j + 1) % 3] == a {
                let d = faces[g][(j + 2) % 3];
                if c != d && !joined(faces, c, d) {
                    faces[f] = [a, d, c];
                    faces[g] = [d, b, c];
                }
                return;
            }
        }
    }
}

/// A closed torus of `m` x `n` cells, m and n at least 3.
pub(crate) fn torus(m: u32, n: u32) -> Soup {
    let mut faces = Vec::new();
    let id = |i: u32, j: u32| i % m + m * (j % n);
    for j in 0..n {
        for i in 0..m {
            let (a, b, c, d) = (id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    ((m * n) as usize, faces)
}

/// The closed octahedron.
pub(crate) fn octahedron() -> Soup {
    let mut faces = Vec::new();
    for k in 0..4u32 {
        faces.extend([[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]);
    }
    (6, faces)
}

/// A Moebius band of `n` cells, n odd and at least 5: the winding cannot be consistent.
pub(crate) fn moebius(n: u32) -> Soup {
    // Rungs (2k, 2k + 1); the last is joined to the first turned over.
    let rung = |k: u32| if k < n { (2 * k, 2 * k + 1) } else { (1, 0) };
    let mut faces = Vec::new();
    for k in 0..n {
        let ((a, b), (c, d)) = (rung(k), rung(k + 1));
        faces.extend([[a, c, b], [b, c, d]]);
    }
    (2 * n as usize, faces)
}

/// Removes up to `tries` random faces as long as the rest is a surface: holes, gaps, several components.
pub(crate) fn punch(rng: &mut impl Rng, soup: Soup, tries: usize) -> Soup {
    let (n, mut faces) = soup;
    for _ in 0..tries {
        let f = rng.random_range(0..faces.len());
        let removed = faces.swap_remove(f);
        let (count, rest) = compact(n, &faces);
        if Topology::from_faces(count, &rest).is_err() {
            faces.push(removed);
        }
    }
    compact(n, &faces)
}

fn compact(n: usize, faces: &[[u32; 3]]) -> Soup {
    let mut label = vec![u32::MAX; n];
    let mut count = 0;
    let faces = faces
        .iter()
        .map(|f| {
            f.map(|v| {
                let slot = &mut label[v as usize];
                if *slot == u32::MAX {
                    *slot = count;
                    count += 1;
                }
                *slot
            })
        })
        .collect();
    (count as usize, faces)
}

/// The second mesh beside the first.
pub(crate) fn beside(a: Soup, b: Soup) -> Soup {
    let offset = a.0 as u32;
    let (n, mut faces) = a;
    faces.extend(b.1.iter().map(|f| f.map(|v| v + offset)));
    (n + b.0, faces)
}

/// Arbitrary disks of up to about 60 faces.
pub(crate) fn disks() -> impl Strategy<Value = Soup> {
    (0..40usize, any::<u64>())
        .prop_map(|(steps, seed)| random_disk(&mut ChaCha8Rng::seed_from_u64(seed), steps))
}

/// Arbitrary surfaces: closed or with boundary, with holes and handles, of one or more components.
pub(crate) fn surfaces() -> impl Strategy<Value = Soup> {
    (0..5usize, 0..30usize, 0..8usize, any::<u64>()).prop_map(|(kind, steps, tries, seed)| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let base = match kind {
            0 => random_disk(&mut rng, steps),
            1 => torus(3 + (steps % 3) as u32, 4),
            2 => octahedron(),
            3 => beside(
                random_disk(&mut rng, steps),
                random_disk(&mut rng, steps / 2),
            ),
            _ => beside(
                torus(4, 3),
                beside(octahedron(), random_disk(&mut rng, steps)),
            ),
        };
        punch(&mut rng, base, tries)
    })
}

impl Sheet {
    /// The sheet of the faces for which `keep` holds; vertices that are then in no face are dropped, the
    /// others keep their order.
    pub(crate) fn keep_faces(
        &self,
        mut keep: impl FnMut(FaceId) -> bool,
    ) -> Result<Self, MeshError> {
        let t = self.topology();
        let kept: Vec<[VertexId; 3]> = t
            .face_ids()
            .filter(|&f| keep(f))
            .map(|f| t.faces()[f.index()])
            .collect();
        let mut renumbered = vec![u32::MAX; t.vertex_count()];
        for v in kept.iter().flatten() {
            renumbered[v.index()] = 0;
        }
        let mut positions = Vec::new();
        for v in t
            .vertex_ids()
            .filter(|v| renumbered[v.index()] == 0)
            .collect::<Vec<_>>()
        {
            renumbered[v.index()] = (positions.len() / 3) as u32;
            positions.extend(self.position(v));
        }
        let faces: Vec<[u32; 3]> = kept
            .iter()
            .map(|f| f.map(|v| renumbered[v.index()]))
            .collect();
        Self::new(positions, &faces)
    }
}
