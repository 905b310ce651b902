//! The length equations on the free unknowns: pinned vertices are eliminated.

use crate::vec3::{at, dot, norm, sub};
use isosheet_mesh::{Advice, EdgeId, Sheet, Topology, VertexId};
use thiserror::Error;

/// Why a [`RodSystem`] cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SystemError {
    /// A pin names a vertex that the mesh does not have.
    #[error("pinned {vertex} does not exist, the mesh has {count} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// More length equations than unknowns are left; or as many, where coordinates are wanted.
    #[error(
        "{equations} length equations for {unknowns} unknowns: the pins leave no degree of freedom"
    )]
    NoFreedom {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
}

impl Advice for SystemError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoFreedom { .. } => Some("remove some pins"),
            Self::NoSuchVertex { .. } => None,
        }
    }
}

/// An edge with at least one free end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rod {
    pub(crate) edge: EdgeId,
    pub(crate) ends: [VertexId; 2],
    /// First unknown of each end, `None` where pinned.
    pub(crate) unknown: [Option<u32>; 2],
    pub(crate) length: f64,
}

/// The rods of a sheet and the unknowns they act on.
///
/// Positions and velocities are full slices (three values per vertex); the unknowns are the
/// components of the free vertices, in vertex order. Edges between two pinned vertices are left out.
/// Equation e is `c_e(x) = (|x_a - x_b|^2 - l_e^2)/2` (Liu, Tang and Joneja 2007, Eq. 3) with the
/// gradient row `+-(x_a - x_b)`.
#[derive(Clone, Debug)]
pub struct RodSystem {
    vertex_count: usize,
    free: Vec<VertexId>,
    first_unknown: Vec<Option<u32>>,
    rods: Vec<Rod>,
}

impl RodSystem {
    /// The system of a sheet with the given vertices pinned. A vertex may be listed twice.
    ///
    /// # Errors
    /// See [`SystemError`].
    pub fn new(sheet: &Sheet, pins: &[VertexId]) -> Result<Self, SystemError> {
        Self::from_parts(sheet.topology(), sheet.lengths(), pins)
    }

    /// The system of a topology with one length (metres) per edge and the given vertices pinned.
    ///
    /// # Errors
    /// See [`SystemError`].
    ///
    /// # Panics
    /// When there are fewer lengths than edges.
    pub fn from_parts(
        topology: &Topology,
        lengths: &[f64],
        pins: &[VertexId],
    ) -> Result<Self, SystemError> {
        let count = topology.vertex_count();
        let mut pinned = vec![false; count];
        for &vertex in pins {
            *pinned
                .get_mut(vertex.index())
                .ok_or(SystemError::NoSuchVertex { vertex, count })? = true;
        }
        let mut first_unknown = vec![None; count];
        let mut free = Vec::new();
        for i in 0..count {
            if !pinned[i] {
                first_unknown[i] = Some(3 * free.len() as u32);
                free.push(VertexId(i as u32));
            }
        }
        let rods: Vec<Rod> = topology
            .edges()
            .iter()
            .enumerate()
            .filter(|(_, [a, b])| !(pinned[a.index()] && pinned[b.index()]))
            .map(|(e, &ends)| Rod {
                edge: EdgeId(e as u32),
                ends,
                unknown: ends.map(|v| first_unknown[v.index()]),
                length: lengths[e],
            })
            .collect();
        if rods.len() > 3 * free.len() {
            return Err(SystemError::NoFreedom {
                equations: rods.len(),
                unknowns: 3 * free.len(),
            });
        }
        Ok(Self {
            vertex_count: count,
            free,
            first_unknown,
            rods,
        })
    }

    /// Number of vertices of the sheet, pinned ones included.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The free vertices in order.
    #[must_use]
    pub fn free_vertices(&self) -> &[VertexId] {
        &self.free
    }

    /// Number of unknowns, three per free vertex.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        3 * self.free.len()
    }

    /// Number of length equations.
    #[must_use]
    pub fn equations(&self) -> usize {
        self.rods.len()
    }

    /// Degrees of freedom: unknowns minus equations.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.unknowns() - self.equations()
    }

    /// Refuses a system without degrees of freedom: there is nothing that a chart could have coordinates of.
    pub(crate) fn check_freedom(&self) -> Result<(), SystemError> {
        if self.dof() > 0 {
            return Ok(());
        }
        Err(SystemError::NoFreedom {
            equations: self.equations(),
            unknowns: self.unknowns(),
        })
    }

    /// First unknown of a vertex, `None` when it is pinned.
    #[must_use]
    pub fn unknown(&self, v: VertexId) -> Option<usize> {
        self.first_unknown[v.index()].map(|u| u as usize)
    }

    /// The edge that each length equation belongs to.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = EdgeId> + '_ {
        self.rods.iter().map(|rod| rod.edge)
    }

    pub(crate) fn rods(&self) -> &[Rod] {
        &self.rods
    }

    /// The unknowns' part of a full slice.
    pub fn gather(&self, full: &[f64], reduced: &mut [f64]) {
        for (k, v) in self.free.iter().enumerate() {
            let i = 3 * v.index();
            reduced[3 * k..3 * k + 3].copy_from_slice(&full[i..i + 3]);
        }
    }

    /// A full slice from the unknowns; components of pinned vertices are set to zero.
    pub fn scatter(&self, reduced: &[f64], full: &mut [f64]) {
        full.fill(0.0);
        self.add_scaled(1.0, reduced, full);
    }

    /// `full += s reduced` on the free vertices.
    pub fn add_scaled(&self, s: f64, reduced: &[f64], full: &mut [f64]) {
        for (k, v) in self.free.iter().enumerate() {
            for i in 0..3 {
                full[3 * v.index() + i] += s * reduced[3 * k + i];
            }
        }
    }

    /// The residuals `c(x)`, square metres.
    pub fn residual(&self, x: &[f64], c: &mut [f64]) {
        for (ce, rod) in c.iter_mut().zip(&self.rods) {
            let d = sub(&at(x, rod.ends[0]), &at(x, rod.ends[1]));
            // The difference of lengths first: no cancellation of squares.
            let l = norm(&d);
            *ce = 0.5 * (l - rod.length) * (l + rod.length);
        }
    }

    /// Largest strain `| |x_a - x_b| / l - 1 |` over the rods; infinite for a state that is not finite.
    #[must_use]
    pub fn max_strain(&self, x: &[f64]) -> f64 {
        self.rods.iter().fold(0.0, |m: f64, rod| {
            let l = norm(&sub(&at(x, rod.ends[0]), &at(x, rod.ends[1])));
            let strain = (l / rod.length - 1.0).abs();
            if strain.is_nan() {
                f64::INFINITY
            } else {
                m.max(strain)
            }
        })
    }

    /// `G(x) v`; bilinear and symmetric in `x` and `v`, so that `G(v)` makes sense as well.
    pub fn apply(&self, x: &[f64], v: &[f64], out: &mut [f64]) {
        for (o, rod) in out.iter_mut().zip(&self.rods) {
            let d = sub(&at(x, rod.ends[0]), &at(x, rod.ends[1]));
            let w = sub(&at(v, rod.ends[0]), &at(v, rod.ends[1]));
            *o = dot(&d, &w);
        }
    }

    /// `out += G(x)^T lambda` on the unknowns.
    pub fn add_transpose(&self, x: &[f64], lambda: &[f64], out: &mut [f64]) {
        for (l, rod) in lambda.iter().zip(&self.rods) {
            let d = sub(&at(x, rod.ends[0]), &at(x, rod.ends[1]));
            for (u, s) in rod.unknown.iter().zip([*l, -*l]) {
                if let Some(u) = u {
                    for i in 0..3 {
                        out[*u as usize + i] += s * d[i];
                    }
                }
            }
        }
    }

    /// `(equation, unknown)` of every entry of G, in the order of [`RodSystem::jacobian_values`].
    pub fn jacobian_entries(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.rods.iter().enumerate().flat_map(|(e, rod)| {
            rod.unknown
                .iter()
                .flatten()
                .flat_map(move |u| (0..3).map(move |i| (e as u32, u + i)))
        })
    }

    /// The entries of G(x), three per free end of each rod.
    pub fn jacobian_values<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.rods.iter().flat_map(move |rod| {
            let d = sub(&at(x, rod.ends[0]), &at(x, rod.ends[1]));
            [1.0, -1.0]
                .into_iter()
                .zip(rod.unknown)
                .filter(|(_, u)| u.is_some())
                .flat_map(move |(s, _)| d.map(|c| s * c))
        })
    }
}
