//! Lumped and consistent mass.

use crate::{FaceId, MeshError, Sheet, Topology};
use std::collections::BTreeSet;

/// How the mass of a uniform sheet is distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MassKind {
    /// A third of each face's mass sits at each of its corners, as in Liu, Tang and Joneja 2007. The rotary
    /// inertia of each triangle about its centroid is four times that of a uniform plate.
    #[default]
    Lumped,
    /// The consistent matrix: m/6 on the diagonal and m/12 off it for a face of mass m. It gives the exact
    /// kinetic energy of a uniform triangle that moves rigidly, or indeed affinely.
    Consistent,
}

/// A symmetric positive definite V x V mass matrix, in kilograms; each of x, y, z has this same matrix.
///
/// It has entries on the diagonal and at most one per mesh edge off it. The kinetic energy of velocities v is
/// `T = 1/2 sum_ij M_ij v_i . v_j`, which is Liu, Tang and Joneja 2007, Eq. 2, when the matrix is lumped.
#[derive(Clone, Debug, PartialEq)]
pub struct MassMatrix {
    /// `M_ii` of every vertex, in kilograms.
    pub vertex: Vec<f64>,
    /// `M_ij = M_ji` of every edge ij, in kilograms; `None` for a lumped (diagonal) matrix.
    pub edge: Option<Vec<f64>>,
}

impl MassMatrix {
    /// The matrix of a uniform sheet with the given mass per area, in kg/m^2.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] unless the density is positive and finite.
    pub fn from_density(sheet: &Sheet, density: f64, kind: MassKind) -> Result<Self, MeshError> {
        Self::from_densities(sheet, |_| density, kind)
    }

    /// Mass matrix for a mass per area of each face, kg/m2.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`].
    pub fn from_densities(
        sheet: &Sheet,
        density: impl Fn(FaceId) -> f64,
        kind: MassKind,
    ) -> Result<Self, MeshError> {
        let mut all = sheet.topology().face_ids().map(&density);
        if let Some(value) = all.find(|d| !(*d > 0.0 && d.is_finite())) {
            let what = "mass per area";
            return Err(MeshError::NotPositive { what, value });
        }
        Ok(Self::from_face_masses(
            sheet.topology(),
            |f| density(FaceId::from_index(f)) * sheet.face_areas()[f],
            kind,
        ))
    }

    /// The matrix of a uniform sheet with the given mass in all, in kilograms.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] unless the mass is positive and finite.
    pub fn from_total(sheet: &Sheet, mass: f64, kind: MassKind) -> Result<Self, MeshError> {
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(MeshError::NotPositive {
                what: "total mass",
                value: mass,
            });
        }
        Self::from_density(sheet, mass / sheet.area(), kind)
    }

    /// A lumped matrix with the given mass at each vertex, in kilograms.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] unless every mass is positive and finite.
    pub fn from_vertex_masses(masses: Vec<f64>) -> Result<Self, MeshError> {
        match masses.iter().find(|&&m| !(m > 0.0 && m.is_finite())) {
            Some(&value) => Err(MeshError::NotPositive {
                what: "mass of a vertex",
                value,
            }),
            None => Ok(Self {
                vertex: masses,
                edge: None,
            }),
        }
    }

    /// The matrix of the [union](Sheet::union) of sheets with the given matrices, all of one kind, in the
    /// same order.
    ///
    /// # Panics
    /// If some are lumped and others are not.
    pub fn union(matrices: &[Self]) -> Self {
        let kinds: BTreeSet<bool> = matrices.iter().map(|m| m.edge.is_some()).collect();
        assert!(kinds.len() <= 1, "matrices of one kind");
        let edges = matrices.iter().flat_map(|m| m.edge.iter().flatten());
        Self {
            vertex: matrices.iter().flat_map(|m| &m.vertex).copied().collect(),
            edge: kinds.contains(&true).then(|| edges.copied().collect()),
        }
    }

    fn from_face_masses(t: &Topology, mass: impl Fn(usize) -> f64, kind: MassKind) -> Self {
        let mut vertex = vec![0.0; t.vertex_count()];
        let corner_share = match kind {
            MassKind::Lumped => 1.0 / 3.0,
            MassKind::Consistent => 1.0 / 6.0,
        };
        for (f, corners) in t.faces().iter().enumerate() {
            for v in corners {
                vertex[v.index()] += corner_share * mass(f);
            }
        }
        let edge = match kind {
            MassKind::Lumped => None,
            MassKind::Consistent => Some(
                t.edge_ids()
                    .map(|e| {
                        t.edge_faces(e)
                            .iter()
                            .flatten()
                            .map(|f| mass(f.index()) / 12.0)
                            .sum()
                    })
                    .collect(),
            ),
        };
        Self { vertex, edge }
    }

    /// Which kind of matrix this is.
    pub fn kind(&self) -> MassKind {
        if self.edge.is_some() {
            MassKind::Consistent
        } else {
            MassKind::Lumped
        }
    }

    /// The mass of the sheet, in kilograms: the sum of all entries.
    pub fn total(&self) -> f64 {
        let off: f64 = self.edge.iter().flatten().sum();
        self.vertex.iter().sum::<f64>() + 2.0 * off
    }

    /// The mass that gravity attaches to each vertex, in kilograms: the row sums, a third of the incident
    /// faces' mass in either kind.
    pub fn row_sums(&self, topology: &Topology) -> Vec<f64> {
        let mut sums = self.vertex.clone();
        if let Some(edge) = &self.edge {
            for (&[a, b], m) in topology.edges().iter().zip(edge) {
                sums[a.index()] += m;
                sums[b.index()] += m;
            }
        }
        sums
    }

    /// Writes M v into `out`, both of length 3V: momenta (kg m/s) from velocities (m/s).
    ///
    /// # Panics
    /// If a length is not 3V.
    pub fn apply(&self, topology: &Topology, v: &[f64], out: &mut [f64]) {
        let n = self.vertex.len();
        assert_eq!(
            topology.vertex_count(),
            n,
            "the matrix belongs to another mesh"
        );
        assert!(
            v.len() == 3 * n && out.len() == 3 * n,
            "three numbers per vertex"
        );
        for (i, m) in self.vertex.iter().enumerate() {
            for k in 3 * i..3 * i + 3 {
                out[k] = m * v[k];
            }
        }
        if let Some(edge) = &self.edge {
            for (&[a, b], m) in topology.edges().iter().zip(edge) {
                let (a, b) = (3 * a.index(), 3 * b.index());
                for k in 0..3 {
                    out[a + k] += m * v[b + k];
                    out[b + k] += m * v[a + k];
                }
            }
        }
    }

    /// The kinetic energy of the velocities v (length 3V, m/s), in joules.
    ///
    /// # Panics
    /// If `v` is not of length 3V.
    pub fn kinetic_energy(&self, topology: &Topology, v: &[f64]) -> f64 {
        assert_eq!(v.len(), 3 * self.vertex.len(), "three numbers per vertex");
        let mut twice = 0.0;
        for (m, v) in self.vertex.iter().zip(v.chunks_exact(3)) {
            for vk in v {
                twice += m * vk * vk;
            }
        }
        if let Some(edge) = &self.edge {
            for (&[a, b], m) in topology.edges().iter().zip(edge) {
                let (a, b) = (3 * a.index(), 3 * b.index());
                for k in 0..3 {
                    twice += 2.0 * m * v[a + k] * v[b + k];
                }
            }
        }
        0.5 * twice
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::isotropic_square;

    #[test]
    fn both_kinds_have_the_mass_and_the_weights() {
        let sheet = isotropic_square(1, 0.5).unwrap();
        let lumped = MassMatrix::from_total(&sheet, 0.2, MassKind::Lumped).unwrap();
        let consistent = MassMatrix::from_total(&sheet, 0.2, MassKind::Consistent).unwrap();
        assert_eq!(
            (lumped.kind(), consistent.kind()),
            (MassKind::Lumped, MassKind::Consistent)
        );
        assert!((lumped.total() - 0.2).abs() < 1e-15);
        assert!((consistent.total() - 0.2).abs() < 1e-15);
        let t = sheet.topology();
        for (a, b) in lumped.row_sums(t).iter().zip(consistent.row_sums(t)) {
            assert!((a - b).abs() < 1e-16);
        }
    }

    /// Uniform plate a x b turning about its centre: T = m w^2 (a^2 + b^2) / 24; in plane and about an axis
    /// in the plane.
    #[test]
    fn consistent_mass_is_exact_for_a_turning_plate() {
        let (a, b, m, w) = (0.3, 0.7, 0.25, 1.9);
        let sheet = crate::generate::grid(3, 2, a, b, crate::generate::Diagonals::Falling).unwrap();
        let t = sheet.topology();
        let mass = MassMatrix::from_total(&sheet, m, MassKind::Consistent).unwrap();
        let spin: Vec<f64> = sheet
            .positions()
            .chunks_exact(3)
            .flat_map(|p| [-w * (p[1] - b / 2.0), w * (p[0] - a / 2.0), 0.0])
            .collect();
        let exact = m * w * w * (a * a + b * b) / 24.0;
        assert!((mass.kinetic_energy(t, &spin) - exact).abs() < 1e-15);
        let flip: Vec<f64> = sheet
            .positions()
            .chunks_exact(3)
            .flat_map(|p| [0.0, 0.0, w * (p[0] - a / 2.0)])
            .collect();
        assert!((mass.kinetic_energy(t, &flip) - m * w * w * a * a / 24.0).abs() < 1e-15);
    }

    /// One triangle: the lumped rotary inertia about the centroid is four times the exact one.
    #[test]
    fn lumping_quadruples_the_inertia_of_a_triangle() {
        let sheet = Sheet::new(
            vec![0.0, 0.0, 0.0, 2.0, 0.1, 0.0, 0.4, 1.0, 0.0],
            &[[0, 1, 2]],
        )
        .unwrap();
        let t = sheet.topology();
        let (cx, cy) = (2.4 / 3.0, 1.1 / 3.0);
        let spin: Vec<f64> = sheet
            .positions()
            .chunks_exact(3)
            .flat_map(|p| [-(p[1] - cy), p[0] - cx, 0.0])
            .collect();
        let energy = |kind| {
            MassMatrix::from_density(&sheet, 3.0, kind)
                .unwrap()
                .kinetic_energy(t, &spin)
        };
        assert!((energy(MassKind::Lumped) / energy(MassKind::Consistent) - 4.0).abs() < 1e-14);
    }

    #[test]
    fn bad_masses_are_refused() {
        let sheet = isotropic_square(0, 1.0).unwrap();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                MassMatrix::from_total(&sheet, bad, MassKind::Lumped),
                Err(MeshError::NotPositive { .. })
            ));
            assert!(MassMatrix::from_density(&sheet, bad, MassKind::Consistent).is_err());
            assert!(MassMatrix::from_vertex_masses(vec![1.0, bad]).is_err());
        }
    }
}
