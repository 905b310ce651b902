//! Torsion springs at the edges: creases that are folded by driven rest angles, and the bending stiffness of
//! the material.

mod fold;
mod from_flat;
#[cfg(test)]
mod plastic_tests;
mod rest_angle;
#[cfg(test)]
mod tests;

use crate::potential::{At, MaterialReport, Reached, Remembering, Settled};
pub use from_flat::FLAT;
pub use from_flat::folding_from_flat;
pub use rest_angle::RestAngle;

use super::plasticity::Yield;
use crate::options::OptionsError;
use crate::{HessianSink, Potential};
use fold::Fold;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, EdgeId, FaceId, Sheet, Topology, VertexId};
use isosheet_motion::ProfileError;
use nalgebra::{Matrix3, Vector1};
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

/// A torsion spring at an interior edge.
#[derive(Debug)]
pub struct CreaseSpring {
    /// The edge.
    pub edge: EdgeId,
    /// Torsional stiffness `k` of the whole edge, newton metres per radian.
    pub stiffness: f64,
    /// The angle at which it exerts no moment.
    pub rest: RestAngle,
    /// When it yields, moments in newton metres; nothing for a spring that always comes back.
    pub yields: Option<Yield>,
    /// Stiffness of what else bends between the middles of the two faces, newton metres per radian, of which
    /// the stiffness of the spring takes account ([`CreaseSpring::put_in_sheet`]). Nothing where the fold
    /// angle is the spring's alone.
    pub in_series: Option<f64>,
}

impl CreaseSpring {
    /// Turns springs into creases in a sheet with bending stiffness, in place: a crease replaces what resists
    /// bending at its edge.
    ///
    /// The dihedral angle of the two faces at an edge is the fold of the crease and the bend of the sheet
    /// over these faces, `theta = theta_c + M / k_s`, with the stiffness `k_s = D l_e^2 / A_e` of the sheet
    /// ([`CreaseSprings::bending`]). Springs of stiffness `k_i` at the edge, which carry the moment `M = sum
    /// k_i (rest_i - theta_c)` together, act on that angle with `k_i k_s / (k_s + sum k_i)`: springs in
    /// series. A sheet that nothing loads rests at the rest angle of its crease, flat on both sides; a crease
    /// that is much stiffer than the sheet bends like the sheet. The sheet itself is made without stiffness
    /// at these edges ([`CreaseSprings::bending_beside`],
    /// [`PlateBending::creased`](crate::PlateBending::creased)). Both carry the same moment, so that a crease
    /// yields at the moment at which it yields by itself. The spring keeps `k_s`
    /// ([`CreaseSpring::in_series`]), by which [`CreaseSprings::bends_beside`] tells fold and bend apart.
    ///
    /// `rigidity` is the flexural rigidity `D` in newton metres; with zero the springs stay as they are.
    pub fn put_in_sheet<'a>(
        springs: impl IntoIterator<Item = &'a mut Self>,
        sheet: &Sheet,
        rigidity: f64,
    ) {
        if rigidity == 0.0 {
            return;
        }
        let springs: Vec<&mut Self> = springs.into_iter().collect();
        let mut sums = vec![0.0; sheet.topology().edge_count()];
        for spring in &springs {
            if let Some(sum) = sums.get_mut(spring.edge.index()) {
                *sum += spring.stiffness;
            }
        }
        for spring in springs {
            let sum = sums.get(spring.edge.index());
            if let Some((sum, own)) = sum.zip(sheet_stiffness(sheet, rigidity, spring.edge)) {
                spring.stiffness *= own / (own + sum);
                spring.in_series = Some(own);
            }
        }
    }
}

/// The stiffness `D l_e^2 / A_e` of a sheet across an edge, newton metres per radian; nothing where there is
/// one face or no edge.
fn sheet_stiffness(sheet: &Sheet, rigidity: f64, edge: EdgeId) -> Option<f64> {
    let length = sheet.lengths().get(edge.index())?;
    let [Some(left), Some(right)] = sheet.topology().edge_faces(edge) else {
        return None;
    };
    let area = sheet.face_areas()[left.index()] + sheet.face_areas()[right.index()];
    Some(rigidity * length.powi(2) / area)
}

/// Why springs cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CreaseError {
    /// An edge does not exist or has one face only.
    #[error("{edge} has no fold angle")]
    NotInterior {
        /// The edge.
        edge: EdgeId,
    },
    /// An edge is not on the boundary, or the other face of its seam is none.
    #[error("{edge} is not glued to the edge of another face")]
    Seam {
        /// The edge.
        edge: EdgeId,
    },
    /// A stiffness is negative or not finite.
    #[error("the spring at {edge} has stiffness {stiffness} N m", stiffness = given(*stiffness))]
    Stiffness {
        /// The edge.
        edge: EdgeId,
        /// The stiffness given, N m/rad.
        stiffness: f64,
    },
    /// The profile of a rest angle cannot be used.
    #[error("the rest angle of the spring at {edge} cannot be used: {source}")]
    RestAngle {
        /// The edge.
        edge: EdgeId,
        /// What is wrong with its profile.
        source: ProfileError,
    },
    /// A constant rest angle is beyond a fold that is shut.
    #[error("the spring at {edge} rests at {angle} rad", angle = given(*angle))]
    Angle {
        /// The edge.
        edge: EdgeId,
        /// The angle given, radians.
        angle: f64,
    },
    /// A flexural rigidity is negative or not finite.
    #[error("the flexural rigidity is {rigidity} N m", rigidity = given(*rigidity))]
    Rigidity {
        /// The rigidity given, N m.
        rigidity: f64,
    },
    /// A spring cannot yield as it is to.
    #[error("the yield of the spring at {edge} cannot be used: {source}")]
    Yield {
        /// The edge.
        edge: EdgeId,
        /// What is wrong with it.
        source: OptionsError,
    },
}

impl Advice for CreaseError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NotInterior { .. } => Some("put springs on edges between two faces"),
            Self::Seam { .. } => Some("glue edges of boundaries to each other"),
            Self::Stiffness { .. } | Self::Rigidity { .. } => {
                Some("give a finite one of at least 0")
            }
            Self::RestAngle { source, .. } => source.advice(),
            Self::Yield { source, .. } => source.advice(),
            Self::Angle { .. } => Some("give an angle from -pi to pi"),
        }
    }
}

/// Torsion springs at edges, with the energy
///
/// ```text
/// V(t, x) = sum_e k_e / 2 [theta_e(x) - rest_e(t)]^2,
/// ```
///
/// `theta_e` the fold angle of edge `e` in radians. The difference is taken the short way round, so an angle
/// that passes pi (a fold shut) stays continuous; the energy has a kink only half a turn away from the rest
/// angle.
///
/// In a flat sheet the force is normal to it, upwards or downwards by the sign of the rest angle: the
/// assignment of mountains and valleys chooses the branch, no perturbation is needed.
///
/// The work of driving a rest angle, the integral of `dV/dt` at fixed positions, enters the energy balance.
/// The derivatives of the angle are from Bridson, Marino and Fedkiw, *Simulation of clothing with folds and
/// wrinkles* (2003), Eq. 3, the second ones from Tamstorf and Grinspun, *Discrete bending forces and their
/// Jacobians* (2013); the semidefinite part of the Hessian is `k grad theta grad theta^T`.
///
/// Springs that [yield](Yield) remember plastic angles `p_e` besides (radians, one for each layer, in
/// [`Remembering::memory`]): their energy is that of `theta_e - rest_e - p_e`, with that of hardening, and in
/// a step what they dissipate in it.
#[derive(Debug)]
pub struct CreaseSprings {
    hinges: Vec<Hinge>,
    /// The two faces at each hinge, where all of them together are the bending stiffness of a sheet; else
    /// empty.
    bent: Vec<[FaceId; 2]>,
}

#[derive(Debug)]
struct Hinge {
    /// First and second end, opposite vertex of the left and of the right face.
    vertices: [VertexId; 4],
    edge: EdgeId,
    /// The six pairs of these, by their places: first that of the edge, last that of the opposite vertices.
    pairs: [(Between, usize, usize); 6],
    stiffness: f64,
    rest: RestAngle,
    yields: Option<Yield>,
    in_series: Option<f64>,
}

/// What is between two vertices of a hinge.
#[derive(Debug, Clone, Copy)]
enum Between {
    /// An edge, which leads from the first to the second one.
    Edge(EdgeId),
    /// Nothing.
    Nothing,
}

/// What a hinge does at an angle.
struct Response {
    /// The elastic part of the angle, radians.
    elastic: f64,
    /// Derivative of the moment `k elastic` by the angle, newton metres per radian.
    tangent: f64,
    /// Energy without that of `elastic`, joules.
    plastic_energy: f64,
}

impl CreaseSprings {
    /// Springs on a mesh.
    ///
    /// # Errors
    /// [`CreaseError`] naming the first edge that has no fold angle, or whose stiffness or rest angle cannot
    /// be used.
    pub fn new(topology: &Topology, springs: Vec<CreaseSpring>) -> Result<Self, CreaseError> {
        let hinge = |spring: CreaseSpring| {
            let edge = spring.edge;
            if edge.index() >= topology.edge_count() {
                return Err(CreaseError::NotInterior { edge });
            }
            match topology.opposite_vertices(edge) {
                [Some(left), Some(right)] => Hinge::new(topology, spring, [left, right]),
                _ => Err(CreaseError::NotInterior { edge }),
            }
        };
        let hinges = springs.into_iter().map(hinge);
        let hinges = hinges.collect::<Result<_, _>>()?;
        let bent = Vec::new();
        Ok(Self { hinges, bent })
    }

    /// Springs across seams: each at an edge of a boundary, between the face there and the face at another
    /// edge of a boundary that is [glued](crate::Glue) to it, whose corner opposite of that edge is given.
    /// The angle is positive for a valley as seen from the side from which the first face is
    /// counter-clockwise, however the second one is.
    ///
    /// # Errors
    /// As [`CreaseSprings::new`]; [`CreaseError::Seam`] naming the first edge that is not one of a boundary,
    /// or whose other face has a corner on it.
    pub fn across_seams(
        topology: &Topology,
        springs: Vec<(CreaseSpring, VertexId)>,
    ) -> Result<Self, CreaseError> {
        let hinge = |(spring, other): (CreaseSpring, VertexId)| {
            let edge = spring.edge;
            let refused = CreaseError::Seam { edge };
            if edge.index() >= topology.edge_count() || other.index() >= topology.vertex_count() {
                return Err(refused);
            }
            let opposite = match topology.opposite_vertices(edge) {
                [Some(left), None] => [left, other],
                [None, Some(right)] => [other, right],
                _ => return Err(refused),
            };
            let ends = topology.edges()[edge.index()];
            match opposite[0] == opposite[1] || ends.contains(&other) {
                true => Err(refused),
                false => Hinge::new(topology, spring, opposite),
            }
        };
        let hinges = springs.into_iter().map(hinge);
        let hinges = hinges.collect::<Result<_, _>>()?;
        let bent = Vec::new();
        Ok(Self { hinges, bent })
    }

    /// Makes springs of the bending stiffness of a sheet ([`CreaseSprings::bending`]) yield as the sheet
    /// does, `yields` being that of the sheet, per metre: at an edge of length `l_e` the moment is `M_y l_e`,
    /// and the curvature `theta l_e / A_e`, so that the hardening is `H l_e^2 / A_e`.
    ///
    /// # Errors
    /// [`CreaseError::Yield`].
    pub fn with_yield(mut self, sheet: &Sheet, yields: Yield) -> Result<Self, CreaseError> {
        for hinge in &mut self.hinges {
            let edge = hinge.edge;
            let source = yields.validate();
            source.map_err(|source| CreaseError::Yield { edge, source })?;
            hinge.yields = sheet_stiffness(sheet, yields.hardening, edge).map(|hardening| Yield {
                moment: yields.moment * sheet.lengths()[edge.index()],
                hardening,
                ..yields
            });
        }
        Ok(self)
    }

    /// The bending stiffness of a uniform material on all interior edges, at rest when flat:
    /// `k_e = D l_e^2 / A_e` with the flexural rigidity `D` (newton metres; office paper has about 5e-4) and
    /// the area `A_e` of the two faces.
    ///
    /// On a union-jack grid of squares a bend along grid lines has exactly the energy `D kappa^2 / 2` per
    /// area, one along diagonals twice that. A sheet of rigid rods bends at its edges only: how stiff it is
    /// in other directions depends on the mesh. One angle at an edge says nothing of the bend along it, so
    /// that there is no Poisson's ratio: twist is as stiff as the mesh makes it
    /// ([`PlateBending`](crate::PlateBending) has the torsion of a plate).
    ///
    /// # Errors
    /// [`CreaseError::Rigidity`].
    pub fn bending(sheet: &Sheet, rigidity: f64) -> Result<Self, CreaseError> {
        Self::bending_beside(sheet, rigidity, &[])
    }

    /// As [`CreaseSprings::bending`], without springs at the edges of creases, where the springs of
    /// [`CreaseSpring::put_in_sheet`] take their place.
    ///
    /// # Errors
    /// [`CreaseError::Rigidity`].
    pub fn bending_beside(
        sheet: &Sheet,
        rigidity: f64,
        creases: &[EdgeId],
    ) -> Result<Self, CreaseError> {
        if !(rigidity.is_finite() && rigidity >= 0.0) {
            return Err(CreaseError::Rigidity { rigidity });
        }
        let t = sheet.topology();
        let creases: BTreeSet<EdgeId> = creases.iter().copied().collect();
        let beside = t.edge_ids().filter(|edge| !creases.contains(edge));
        let springs = beside.filter_map(|edge| {
            Some(CreaseSpring {
                edge,
                stiffness: sheet_stiffness(sheet, rigidity, edge)?,
                rest: 0.0.into(),
                yields: None,
                in_series: None,
            })
        });
        let mut springs = Self::new(t, springs.collect())?;
        let faces = springs.edges().map(|edge| t.edge_faces(edge));
        springs.bent = faces
            .map(|faces| faces.map(|f| f.expect("inside")))
            .collect();
        Ok(springs)
    }

    /// Makes springs of the bending stiffness of a sheet ([`CreaseSprings::bending`]) rest at the fold angles
    /// that its edges have in the positions of the sheet, in place of flat.
    #[must_use]
    pub fn curved(mut self, sheet: &Sheet) -> Self {
        for hinge in &mut self.hinges {
            hinge.rest = Fold::at(sheet.positions(), &hinge.vertices).angle().into();
        }
        self
    }

    /// Moments `k (rest - theta)` of the springs, newton metres, in the order given: positive where a spring
    /// folds towards a valley.
    pub fn moments(&self, at: At<'_>) -> Vec<f64> {
        let moment = |(h, p): (&Hinge, &[f64])| {
            let angle = Fold::at(at.x, &h.vertices).angle();
            -h.stiffness * h.respond(at.t, angle, p).elastic
        };
        self.with_plastic(at.memory).map(moment).collect()
    }

    /// Fold angles `theta` of the springs, radians, in the order given. Beyond a fold that is shut they go on
    /// as the springs do: they are at most half a turn from where the spring rests.
    pub fn angles(&self, at: At<'_>) -> Vec<f64> {
        let angle = |(h, p): (&Hinge, &[f64])| {
            let plastic = h.plastic(p);
            let excess = h.excess(at.t, Fold::at(at.x, &h.vertices).angle(), plastic);
            h.rest.at(at.t) + plastic + excess
        };
        self.with_plastic(at.memory).map(angle).collect()
    }

    /// The bend of the sheet that the fold angles include, at the edges of springs that are in series with a
    /// sheet ([`CreaseSpring::put_in_sheet`]), radians, positive for a valley: `M / k_s` with the moment `M`
    /// that folds the spring further and the stiffness `k_s` of the sheet across the edge. An edge that has
    /// several springs stands there for each, and the sum is the bend.
    ///
    /// The angle of the crease itself, its kink, is the fold angle without this bend: `theta - M / k_s`. With
    /// the stiffness `k` of the crease as it was given, `M = k (kink - rest)`.
    pub fn bends_beside(&self, at: At<'_>) -> Vec<(EdgeId, f64)> {
        let bend = |(h, p): (&Hinge, &[f64])| {
            let sheet = h.in_series?;
            let angle = Fold::at(at.x, &h.vertices).angle();
            let moment = h.stiffness * h.respond(at.t, angle, p).elastic;
            Some((h.edge, moment / sheet))
        };
        self.with_plastic(at.memory).filter_map(bend).collect()
    }

    /// The edges of the springs, in the order given.
    pub fn edges(&self) -> impl Iterator<Item = EdgeId> {
        self.hinges.iter().map(|h| h.edge)
    }

    /// The hinges with the plastic angles of their layers, radians, of a memory.
    fn with_plastic<'a>(
        &'a self,
        memory: &'a [f64],
    ) -> impl Iterator<Item = (&'a Hinge, &'a [f64])> {
        let mut plastic = memory;
        self.hinges.iter().map(move |h| {
            let (own, others) = plastic.split_at(h.layers());
            plastic = others;
            (h, own)
        })
    }
}

impl Hinge {
    /// Of a spring between two faces with these corners opposite of its edge, the left one first.
    fn new(
        topology: &Topology,
        spring: CreaseSpring,
        [left, right]: [VertexId; 2],
    ) -> Result<Self, CreaseError> {
        let CreaseSpring {
            edge,
            stiffness,
            rest,
            yields,
            in_series,
        } = spring;
        if !(stiffness.is_finite() && stiffness >= 0.0) {
            return Err(CreaseError::Stiffness { edge, stiffness });
        }
        rest.validate(edge)?;
        if let Some(yields) = yields {
            let source = yields.validate();
            source.map_err(|source| CreaseError::Yield { edge, source })?;
        }
        let [a, b] = topology.edges()[edge.index()];
        let vertices = [a, b, left, right];
        let between = |i: usize, j: usize| match topology.find_edge(vertices[i], vertices[j]) {
            None => (Between::Nothing, i, j),
            Some(e) if topology.edges()[e.index()][0] == vertices[i] => (Between::Edge(e), i, j),
            Some(e) => (Between::Edge(e), j, i),
        };
        let pairs = [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3)].map(|(i, j)| between(i, j));
        let [first, second, third, fourth, fifth] = pairs;
        // (In a closed surface of four faces the opposite corners have an edge, which counts as none.)
        let last = (Between::Nothing, 2, 3);
        Ok(Self {
            vertices,
            edge,
            pairs: [first, second, third, fourth, fifth, last],
            stiffness,
            rest,
            yields,
            in_series,
        })
    }

    /// The number of its layers, none if it does not yield.
    fn layers(&self) -> usize {
        self.yields.map_or(0, |yields| yields.layers)
    }

    /// The plastic angle, the mean over its layers.
    fn plastic(&self, layers: &[f64]) -> f64 {
        self.yields.map_or(0.0, |y| y.plastic::<1>(layers)[0])
    }

    /// `theta - rest - plastic`, the short way round.
    fn excess(&self, t: f64, theta: f64, plastic: f64) -> f64 {
        let d = theta - self.rest.at(t) - plastic;
        if d.abs() <= PI {
            return d;
        }
        d - TAU * (d / TAU).round()
    }

    /// What it does at the angle `theta`, with the plastic angles of its layers from before.
    fn respond(&self, t: f64, theta: f64, layers: &[f64]) -> Response {
        let excess = self.excess(t, theta, self.plastic(layers));
        let Some(yields) = self.yields else {
            return Response {
                elastic: excess,
                tangent: self.stiffness,
                plastic_energy: 0.0,
            };
        };
        let flow = yields.flow(self.stiffness, Vector1::new(excess), layers);
        Response {
            elastic: excess - flow.step[0],
            tangent: self.stiffness * (1.0 - flow.slope[0]),
            plastic_energy: flow.energy,
        }
    }
}

impl Hinge {
    /// Adds the blocks of its vertices by their places, rows at the first.
    fn add_blocks(
        &self,
        hessian: &mut dyn HessianSink,
        block: impl Fn(usize, usize) -> Matrix3<f64>,
    ) {
        for (i, &v) in self.vertices.iter().enumerate() {
            hessian.add_vertex(v, &block(i, i));
        }
        for &(between, i, j) in &self.pairs {
            match between {
                Between::Edge(e) => hessian.add_edge(e, &block(i, j)),
                Between::Nothing => {
                    hessian.add_pair(self.vertices[i], self.vertices[j], &block(i, j));
                }
            }
        }
    }
}

impl Potential for CreaseSprings {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { t, x, .. } = at;
        let energy = |(h, p): (&Hinge, &[f64])| {
            let response = h.respond(t, Fold::at(x, &h.vertices).angle(), p);
            0.5 * h.stiffness * response.elastic * response.elastic + response.plastic_energy
        };
        self.with_plastic(at.memory).map(energy).sum()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { t, x, .. } = at;
        for (h, p) in self.with_plastic(at.memory) {
            let fold = Fold::at(x, &h.vertices);
            let moment = h.stiffness * h.respond(t, fold.angle(), p).elastic;
            for (v, g) in h.vertices.iter().zip(&fold.gradient()) {
                for k in 0..3 {
                    gradient[3 * v.index() + k] += moment * g[k];
                }
            }
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        for (h, p) in self.with_plastic(at.memory) {
            let fold = Fold::at(at.x, &h.vertices);
            let Response {
                elastic, tangent, ..
            } = h.respond(at.t, fold.angle(), p);
            let (g, second) = (fold.gradient(), fold.hessian());
            let moment = h.stiffness * elastic;
            h.add_blocks(hessian, |i, j| {
                tangent * g[i] * g[j].transpose() + moment * second[i][j]
            });
        }
    }

    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        for (h, p) in self.with_plastic(at.memory) {
            let fold = Fold::at(at.x, &h.vertices);
            let tangent = match h.yields {
                None => h.stiffness,
                Some(_) => h.respond(at.t, fold.angle(), p).tangent,
            };
            let g = fold.gradient();
            h.add_blocks(hessian, |i, j| tangent * g[i] * g[j].transpose());
        }
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        let pairs = |h: &Hinge| {
            let vertices = h.vertices;
            let apart = h.pairs.into_iter();
            let apart = apart.filter(|(between, ..)| matches!(between, Between::Nothing));
            apart.map(move |(_, i, j)| [vertices[i], vertices[j]])
        };
        self.hinges.iter().flat_map(pairs).collect()
    }

    fn is_driven(&self) -> bool {
        self.hinges.iter().any(|h| h.rest.is_driven())
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        Some(self)
    }

    fn report(&self) -> Option<&dyn MaterialReport> {
        Some(self)
    }
}

impl Remembering for CreaseSprings {
    fn memory(&self) -> Vec<f64> {
        vec![0.0; self.hinges.iter().map(Hinge::layers).sum()]
    }

    fn can_yield(&self) -> bool {
        self.hinges.iter().any(|h| h.layers() > 0)
    }

    fn settle(&self, state: Reached<'_>, memory: &mut [f64]) -> Settled {
        let Reached { t, x, .. } = state;
        let mut dissipated = 0.0;
        let mut plastic = memory;
        for h in &self.hinges {
            let (own, others) = plastic.split_at_mut(h.layers());
            plastic = others;
            let Some(yields) = h.yields else { continue };
            let theta = Fold::at(x, &h.vertices).angle();
            let excess = h.excess(t, theta, h.plastic(own));
            dissipated += yields.settle(h.stiffness, Vector1::new(excess), own);
        }
        let work = 0.0;
        Settled { dissipated, work }
    }
}

impl MaterialReport for CreaseSprings {
    /// Half the elastic energy of a hinge goes to each of its faces: where a mesh has exactly the energy of a
    /// bend ([`CreaseSprings::bending`]), so has each face inside.
    fn add_bending_energies(&self, at: At<'_>, faces: &mut [f64]) {
        for ((h, p), beside) in self.with_plastic(at.memory).zip(&self.bent) {
            let angle = Fold::at(at.x, &h.vertices).angle();
            let elastic = h.respond(at.t, angle, p).elastic;
            for face in beside {
                faces[face.index()] += 0.25 * h.stiffness * elastic * elastic;
            }
        }
    }

    fn plastic_angles(&self, memory: &[f64]) -> Vec<(EdgeId, f64)> {
        let yielding = self
            .with_plastic(memory)
            .filter(|(h, _)| h.yields.is_some());
        yielding.map(|(h, p)| (h.edge, h.plastic(p))).collect()
    }

    fn bends_at_creases(&self, at: At<'_>) -> Vec<(EdgeId, f64)> {
        self.bends_beside(at)
    }
}
