//! Degrees of freedom by counting.

use crate::Topology;

/// The degrees of freedom of a sheet of rigid triangles, by counting.
///
/// V vertices in space have 3V coordinates; each of the E edges takes one away by fixing a length (Liu, Tang
/// and Joneja 2007, Sec. 2.2):
///
/// `DOF = 3V - E`.
///
/// # The count depends on the boundary only
///
/// **Identity.** For a triangulated surface with B boundary edges and Euler characteristic `chi = V - E + F`,
/// `3V - E = B + 3 chi`.
///
/// *Proof.* Count the sides of all faces: an interior edge is a side of two faces, a boundary edge of one, so
/// `3F = 2E - B`. Then `3 chi + B = 3V - 3E + 3F + B = 3V - 3E + 2E = 3V - E`. All terms are sums over the
/// components, so the identity holds for each and for all together. ∎
///
/// A disk has B + 3, an annulus B, a closed sphere 6 and a closed torus 0.
///
/// **Lemma 1.** Splitting every face into four by halving every edge gives `DOF' = DOF + B`.
///
/// *Proof.* Halving doubles the boundary edges and changes neither the surface nor its Euler characteristic
/// (indeed `V' = V + E`, `E' = 2E + 3F`, `F' = 4F`, so `chi' = V + E - 2E - 3F + 4F = chi`). By the identity
/// `DOF' = 2B + 3 chi = DOF + B`. ∎
///
/// The paper states this for a disk. Nothing in the proof asks for one: the lemma holds for sheets with holes
/// and handles, of several components and without boundary (which gain nothing), and for any way of joining
/// the midpoints inside the faces, since the inside does not enter.
///
/// **Lemma 2.** The isotropic square has DOF 11, 19, 35, 67, ...: `DOF(M^(k+1)) = 2 DOF(M^k) - 3` and
/// `DOF(M^0) = 11`.
///
/// *Proof.* M^0 has B = 8 and chi = 1, hence 11. M^(k+1) is M^k with every edge halved and the faces
/// rejoined, so Lemma 1 applies, and for a disk `B = DOF - 3`: `DOF' = DOF + B = 2 DOF - 3`. ∎
///
/// So Lemma 2 is a case of Lemma 1 and holds for every disk; in general `DOF' = 2 DOF - 3 chi`. In closed
/// form `DOF(M^k) = 2^(k+3) + 3`.
///
/// # When the count is exact
///
/// The count is the dimension of the space of motions where the E equations are independent. They are at
/// almost every position of a disk or of any surface that can be capped to a sphere, because the triangulated
/// spheres are generically rigid and hence independent (H. Gluck, "Almost all simply connected closed
/// surfaces are rigid", 1975). They are *not* in the flat state as soon as there is an interior vertex or a
/// hole: see [`flat_redundancy`](Self::flat_redundancy). A closed torus has more equations than unknowns, and
/// its count of internal degrees of freedom is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dof {
    /// 3V - E.
    pub total: i64,
    /// Rigid motions of space, 6 for each component.
    pub external: i64,
    /// The others: total - external. Negative when there are more equations than a rigid body could have.
    pub internal: i64,
}

impl Dof {
    /// The count for a mesh; of several components, the sum.
    ///
    /// ```
    /// use isosheet_mesh::{Dof, generate::isotropic_square};
    /// let dof = Dof::of(isotropic_square(2, 1.0)?.topology());
    /// assert_eq!((dof.total, dof.external, dof.internal), (35, 6, 29));
    /// # Ok::<(), isosheet_mesh::generate::GenerateError>(())
    /// ```
    pub fn of(t: &Topology) -> Self {
        Self::new(
            3 * t.vertex_count() as i64 - t.edge_count() as i64,
            t.component_count() as i64,
        )
    }

    /// How many of the E length equations are redundant, to first order, in a state in which every component
    /// is flat.
    ///
    /// `V_i + 3 (C - chi)`, with `V_i` interior vertices and C components: 9 of the 56 equations of the 25/32
    /// mesh, 49 of the 208 of the 81/128 mesh.
    ///
    /// *Proof.* In a flat component the rows of G have no entry in the normal direction. Within the plane the
    /// mesh is infinitesimally rigid: a triangle is, and faces that share an edge move as one. So the rank is
    /// that of a plane framework that only moves rigidly, 2V - 3 for the component and 2V - 3C in all. What
    /// is left is `E - 2V + 3C = V - (3V - E) + 3C = V - B - 3 chi + 3C`, and `V - B = V_i` because a
    /// manifold has as many boundary vertices as boundary edges. ∎
    pub fn flat_redundancy(t: &Topology) -> i64 {
        t.interior_vertex_count() as i64
            + 3 * (t.component_count() as i64 - t.euler_characteristic())
    }

    fn new(total: i64, components: i64) -> Self {
        let external = 6 * components;
        Self {
            total,
            external,
            internal: total - external,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::generate::{self, Diagonals, FaceSplit, split_faces};
    use crate::tests::surfaces::{disks, octahedron, surfaces, torus};
    use crate::{LengthConstraints, Sheet};

    /// Rank of G by the singular values of its transpose.
    fn rank(sheet: &Sheet) -> usize {
        let g = LengthConstraints::new(sheet);
        let x = sheet.positions();
        let mut dense = DMatrix::zeros(x.len(), g.len());
        for (e, mut column) in dense.column_iter_mut().enumerate() {
            let mut unit = vec![0.0; g.len()];
            unit[e] = 1.0;
            g.apply_transpose_add(x, &unit, column.as_mut_slice());
        }
        let sigma = dense.singular_values();
        sigma.iter().filter(|s| **s > 1e-10 * sigma.max()).count()
    }

    #[test]
    fn known_counts() {
        let one = Topology::from_faces(3, &[[0, 1, 2]]).unwrap();
        assert_eq!(
            Dof::of(&one),
            Dof {
                total: 6,
                external: 6,
                internal: 0
            }
        );
        let hinge = Topology::from_faces(4, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        assert_eq!(
            Dof::of(&hinge),
            Dof {
                total: 7,
                external: 6,
                internal: 1
            }
        );
        let (n, faces) = octahedron();
        assert_eq!(
            Dof::of(&Topology::from_faces(n, &faces).unwrap()).internal,
            0
        );
        let (n, faces) = torus(4, 3);
        assert_eq!(
            Dof::of(&Topology::from_faces(n, &faces).unwrap()).internal,
            -6
        );
        let octagon = generate::octagon_244(1.0).unwrap();
        assert_eq!(Dof::of(octagon.topology()).total, 49);
    }

    #[test]
    fn lemma_2_on_squares() {
        let mut before = None;
        for level in 0..6 {
            let total = Dof::of(generate::isotropic_square(level, 1.0).unwrap().topology()).total;
            assert_eq!(total, (1 << (level + 3)) + 3);
            if let Some(b) = before {
                assert_eq!(total, 2 * b - 3);
            }
            before = Some(total);
        }
        assert_eq!(
            Dof::of(generate::isotropic_square(0, 1.0).unwrap().topology()).total,
            11
        );
    }

    #[test]
    fn flat_redundancy_is_the_rank_deficiency() {
        let square = generate::isotropic_square(1, 1.0).unwrap();
        assert_eq!(Dof::flat_redundancy(square.topology()), 9);
        let m2 = generate::isotropic_square(2, 1.0).unwrap();
        assert_eq!(Dof::flat_redundancy(m2.topology()), 49);
        let ring = generate::annulus(9, 2, 0.4, 1.0).unwrap();
        let irregular = generate::delaunay_square(1.0, 0.25, 1).unwrap();
        let holed = irregular.keep_faces(|f| f.index() % 11 != 5);
        let both = Sheet::union(&[&ring, &square]).unwrap();
        let strip = generate::strip(5, 1.0, 0.2, Diagonals::UnionJack).unwrap();
        for sheet in [&square, &ring, &irregular, &both, &strip]
            .into_iter()
            .chain(holed.as_ref().ok())
        {
            let t = sheet.topology();
            assert_eq!(
                (t.edge_count() - rank(sheet)) as i64,
                Dof::flat_redundancy(t)
            );
        }
    }

    fn topology((n, faces): &(usize, Vec<[u32; 3]>)) -> Topology {
        Topology::from_faces(*n, faces).unwrap()
    }

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        #[test]
        fn count_is_boundary_plus_three_chi(soup in surfaces()) {
            let t = topology(&soup);
            let dof = Dof::of(&t);
            prop_assert_eq!(dof.total, t.boundary_edge_count() as i64 + 3 * t.euler_characteristic());
            prop_assert_eq!(dof.internal, dof.total - 6 * t.component_count() as i64);
        }

        #[test]
        fn lemma_1_on_any_surface(soup in surfaces(), seed in any::<u64>()) {
            let t = topology(&soup);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let n = t.vertex_count() + t.edge_count();
            let split = Topology::from_faces(n, &split_faces(&t, |_| FaceSplit::OneToFour)).unwrap();
            let pick: Vec<usize> = t.face_ids().map(|_| rng.random_range(0..3)).collect();
            let bisected = Topology::from_faces(n, &split_faces(&t, |f| FaceSplit::Bisect(pick[f]))).unwrap();
            for fine in [split, bisected] {
                fine.check_invariants();
                prop_assert_eq!(Dof::of(&fine).total, Dof::of(&t).total + t.boundary_edge_count() as i64);
                prop_assert_eq!(fine.euler_characteristic(), t.euler_characteristic());
                prop_assert_eq!(Dof::of(&fine).total, 2 * Dof::of(&t).total - 3 * t.euler_characteristic());
            }
        }

        #[test]
        fn lemma_2_on_any_rectangle(columns in 1..4usize, rows in 1..4usize, level in 0..3u32) {
            let at = |level| {
                let cells = |n: usize| (2 * n) << level;
                let s = generate::grid(cells(columns), cells(rows), 1.0, 0.7, Diagonals::UnionJack).unwrap();
                Dof::of(s.topology()).total
            };
            prop_assert_eq!(at(level + 1), 2 * at(level) - 3);
            prop_assert_eq!(at(level), ((4 * (columns + rows)) << level) as i64 + 3);
        }
    }

    proptest! {
        #![proptest_config(isosheet_random::cases(24))]
        /// At a generic position of a disk the equations are independent, so the count is the number of
        /// motions.
        #[test]
        fn count_is_the_number_of_motions_of_a_crumpled_disk(soup in disks(), seed in any::<u64>()) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let x: Vec<f64> = (0..3 * soup.0).map(|_| rng.random_range(-1.0..1.0)).collect();
            let sheet = Sheet::new(x, &soup.1).unwrap();
            prop_assert_eq!((3 * soup.0 - rank(&sheet)) as i64, Dof::of(sheet.topology()).total);
        }
    }
}
