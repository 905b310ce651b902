//! Realisation: positions from system coordinates and back (Liu, Tang and Joneja 2007, Eq. 14, Theorem 1).
//!
//! A [`FrontMap`] is the system (4) of the paper in the composed form (14): the vertices in
//! assignment order, each placed by f, g or h from vertices placed before it. Edge lengths are exact
//! to rounding, however large the coordinates' change.

mod error;
mod intersections;

pub use error::RealiseError;

use crate::assignment::{Assignment, Placing, Rule};
use crate::frames::{EdgeFrame, SphericalFrame};
use crate::placement::{Branch, place_f, place_g, place_h, place_on_line};
use crate::placement_error::PlacementError;
use crate::vec3::{Vec3, at, cross, dot, norm, sub};
use isosheet_mesh::{AngleTriple, EdgeId, Sheet, VertexId, angle_from_lengths};

/// Options of a [`FrontMap`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealiseOptions {
    /// Squared heights within this fraction of the squared edge length count as zero (flat),
    /// default 1e-12. Lengths are exact up to half of it. From 2.2e-16, the round-off of a squared length, to
    /// 1e-3.
    pub flat_tolerance: f64,
    /// Largest strain of a closure edge, default 1e-9. From 2.2e-16, the round-off of a length, to 0.1: with
    /// a larger strain the edge is not the rod that it stands for.
    pub closure_tolerance: f64,
}

impl Default for RealiseOptions {
    fn default() -> Self {
        Self {
            flat_tolerance: 1e-12,
            closure_tolerance: 1e-9,
        }
    }
}

impl RealiseOptions {
    /// Checks that the tolerances are in their ranges.
    ///
    /// # Errors
    /// [`RealiseError::Tolerance`] naming the first that is not.
    pub fn validate(&self) -> Result<(), RealiseError> {
        for (name, value, max) in [
            ("flat_tolerance", self.flat_tolerance, 1e-3),
            ("closure_tolerance", self.closure_tolerance, 0.1),
        ] {
            if !(f64::EPSILON..=max).contains(&value) {
                return Err(RealiseError::Tolerance { name, value, max });
            }
        }
        Ok(())
    }
}

/// What happened in [`FrontMap::realise`].
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RealiseReport {
    /// Vertices whose three known neighbours were on a line (Fig. 7), placed by continuity.
    pub on_line: Vec<VertexId>,
    /// Number of vertices placed in the plane of their known neighbours, within the flat tolerance.
    pub flat: usize,
    /// Largest strain of a closure edge, 0 without closures.
    pub closure_strain: f64,
}

/// Reference directions of one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Frame {
    None,
    Spherical(SphericalFrame),
    Edge(EdgeFrame),
}

/// Positions as a function of system coordinates, by placement vertex after vertex.
///
/// Frames: a vertex of rule h measures its angles in a [`SphericalFrame`] along its edge in the
/// reference state; a vertex of rule g in the [`EdgeFrame`] of its rest triangle, turned over where
/// the edge of the reference state points backwards. [`FrontMap::rebase`] takes a new reference
/// state; coordinate values change then, positions do not.
#[derive(Clone, Debug)]
pub struct FrontMap {
    assignment: Assignment,
    rest: Vec<f64>,
    lengths: Vec<f64>,
    ends: Vec<[VertexId; 2]>,
    pinned: Vec<f64>,
    frames: Vec<Frame>,
    options: RealiseOptions,
}

impl FrontMap {
    /// The map of an assignment, with frames and pinned positions from the state `reference`.
    ///
    /// # Errors
    /// [`RealiseError::Tolerance`] of the options, [`RealiseError::WrongLength`],
    /// [`RealiseError::NotFinite`], or [`RealiseError::Placement`] when two neighbours coincide.
    pub fn new(
        sheet: &Sheet,
        assignment: Assignment,
        reference: &[f64],
        options: RealiseOptions,
    ) -> Result<Self, RealiseError> {
        options.validate()?;
        let mut map = Self {
            assignment,
            rest: sheet.positions().to_vec(),
            lengths: sheet.lengths().to_vec(),
            ends: sheet.topology().edges().to_vec(),
            pinned: Vec::new(),
            frames: Vec::new(),
            options,
        };
        map.rebase(reference)?;
        Ok(map)
    }

    /// The assignment.
    #[must_use]
    pub fn assignment(&self) -> &Assignment {
        &self.assignment
    }

    /// Number of coordinates, closures not subtracted.
    #[must_use]
    pub fn coordinate_count(&self) -> usize {
        self.assignment.coordinate_count()
    }

    /// Take frames and pinned positions from a new reference state.
    ///
    /// # Errors
    /// As [`FrontMap::new`].
    pub fn rebase(&mut self, reference: &[f64]) -> Result<(), RealiseError> {
        check("reference", reference, self.rest.len())?;
        let mut frames = Vec::with_capacity(self.assignment.order().len());
        for placing in self.assignment.order() {
            let v = placing.vertex;
            let fail = |source| cannot_place(v, &placing.rule, source);
            frames.push(match placing.rule {
                Rule::Pinned | Rule::Start { .. } | Rule::F { .. } => Frame::None,
                Rule::H { known, .. } => {
                    let d = sub(&at(reference, v), &at(reference, known));
                    Frame::Spherical(SphericalFrame::along(&d).map_err(fail)?)
                }
                Rule::G { known: [a, b], .. }
                | Rule::Turn {
                    known: [a, b, _], ..
                } => {
                    let rest = [at(&self.rest, a), at(&self.rest, b), at(&self.rest, v)];
                    let frame =
                        EdgeFrame::from_triangle([&rest[0], &rest[1], &rest[2]]).map_err(fail)?;
                    Frame::Edge(frame.at_edge(&at(reference, a), &at(reference, b)))
                }
            });
        }
        self.frames = frames;
        self.pinned = reference.to_vec();
        Ok(())
    }

    /// Frame of each vertex, in assignment order.
    pub(crate) fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Smallest of `1 + cosine` over all edge frames and of the squared cosine of the latitude over
    /// all spherical frames: the distance of the state from a singularity of the frames. 1 or more is
    /// good, below about 0.1 a rebase is due.
    ///
    /// # Errors
    /// [`RealiseError::WrongLength`], [`RealiseError::NotFinite`].
    pub(crate) fn frame_margin(&self, x: &[f64]) -> Result<f64, RealiseError> {
        check("x", x, self.rest.len())?;
        let mut margin: f64 = 2.0;
        for (placing, frame) in self.assignment.order().iter().zip(&self.frames) {
            match (placing.rule.known(), frame) {
                ([a, b, ..], Frame::Edge(f)) => {
                    margin = margin.min(1.0 + f.alignment(&at(x, *a), &at(x, *b)));
                }
                ([a], Frame::Spherical(f)) => {
                    let d = sub(&at(x, placing.vertex), &at(x, *a));
                    let s = dot(&f.axes()[2], &d);
                    margin = margin.min(1.0 - s * s / dot(&d, &d));
                }
                _ => {}
            }
        }
        Ok(margin)
    }

    /// Coordinate values of a state: metres for a start vertex, radians for the angles.
    ///
    /// # Errors
    /// [`RealiseError::WrongLength`], [`RealiseError::NotFinite`], or [`RealiseError::Placement`]
    /// where a coordinate is not defined.
    pub fn coordinates(&self, x: &[f64], q: &mut [f64]) -> Result<(), RealiseError> {
        check("x", x, self.rest.len())?;
        check_length("q", q.len(), self.coordinate_count())?;
        for (placing, frame) in self.assignment.order().iter().zip(&self.frames) {
            let v = placing.vertex;
            let p = at(x, v);
            match (placing.rule, frame) {
                (Rule::Start { q: k }, _) => q[k..k + 3].copy_from_slice(&p),
                (Rule::H { known, q: k, .. }, Frame::Spherical(f)) => {
                    q[k..k + 2].copy_from_slice(&f.coordinates(&at(x, known), &p));
                }
                (
                    Rule::G {
                        known: [a, b],
                        q: k,
                        ..
                    }
                    | Rule::Turn {
                        known: [a, b, _],
                        q: k,
                        ..
                    },
                    Frame::Edge(f),
                ) => {
                    q[k] = f
                        .coordinate([&at(x, a), &at(x, b), &p])
                        .map_err(|s| cannot_place(v, &placing.rule, s))?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Positions from coordinate values, with exact edge lengths (Eq. 14). Of the two mirror images of rule f
    /// the one nearer to the state `near` (three values per vertex) is taken, and in the case of Fig. 7 the
    /// angle about the line.
    ///
    /// # Errors
    /// [`RealiseError::Incompatible`] naming edge and angles where Eq. 10 is violated (by Theorem 1 a
    /// realisation exists otherwise, but only where no vertex has a fourth known neighbour, so that there are
    /// no [closures](Assignment::closures)), [`RealiseError::Placement`] for other impossible placements,
    /// [`RealiseError::Closure`] when a closure edge does not get its length. `x` holds the vertices placed
    /// up to then.
    pub fn realise(
        &self,
        q: &[f64],
        near: &[f64],
        x: &mut [f64],
    ) -> Result<RealiseReport, RealiseError> {
        check("q", q, self.coordinate_count())?;
        check_length("x", x.len(), self.rest.len())?;
        check("near", near, self.rest.len())?;
        let mut report = RealiseReport::default();
        for (placing, frame) in self.assignment.order().iter().zip(&self.frames) {
            let v = placing.vertex;
            let position = self
                .place(placing, frame, q, near, x, &mut report)
                .map_err(|source| self.explain(v, &placing.rule, x, source))?;
            x[3 * v.index()..3 * v.index() + 3].copy_from_slice(&position);
        }
        self.check_closures(x, &mut report)?;
        Ok(report)
    }

    /// The position of one vertex, from the positions in `x` that were placed before it.
    fn place(
        &self,
        placing: &Placing,
        frame: &Frame,
        q: &[f64],
        near: &[f64],
        x: &[f64],
        report: &mut RealiseReport,
    ) -> Result<Vec3<f64>, PlacementError> {
        let v = placing.vertex;
        match (placing.rule, frame) {
            (Rule::Pinned, _) => Ok(at(&self.pinned, v)),
            (Rule::Start { q: k }, _) => Ok([q[k], q[k + 1], q[k + 2]]),
            (Rule::H { known, edge, q: k }, Frame::Spherical(f)) => {
                let angles = [q[k], q[k + 1]];
                Ok(place_h(&at(x, known), self.length(edge), f, angles))
            }
            (
                Rule::G {
                    known: [a, b],
                    edges: [e, d],
                    q: k,
                }
                | Rule::Turn {
                    known: [a, b, _],
                    edges: [e, d, _],
                    q: k,
                },
                Frame::Edge(f),
            ) => {
                let lengths = [self.length(e), self.length(d)];
                let tolerance = self.options.flat_tolerance;
                let placed = place_g([&at(x, a), &at(x, b)], lengths, f, q[k], tolerance)?;
                Ok(placed.position)
            }
            (Rule::F { known, edges, .. }, _) => {
                let known = known.map(|w| at(x, w));
                let lengths = edges.map(|e| self.length(e));
                self.place_from_three(v, &known, lengths, near, report)
            }
            (rule, frame) => unreachable!("frames are built with the rules: {rule:?} {frame:?}"),
        }
    }

    /// Rule f, or where the three known vertices are on a line (Fig. 7) the angle of the state `near`.
    fn place_from_three(
        &self,
        v: VertexId,
        known: &[Vec3<f64>; 3],
        lengths: [f64; 3],
        near: &[f64],
        report: &mut RealiseReport,
    ) -> Result<Vec3<f64>, PlacementError> {
        let tolerance = self.options.flat_tolerance;
        let branch = Branch::Near(at(near, v));
        let [a, b, c] = known;
        match place_f([a, b, c], lengths, branch, tolerance) {
            Ok(placed) => {
                report.flat += usize::from(placed.height_squared.abs() <= tolerance);
                Ok(placed.position)
            }
            Err(PlacementError::Collinear { .. }) => {
                report.on_line.push(v);
                let (i, j) = farthest(known);
                let placed = place_on_line(
                    [&known[i], &known[j]],
                    [lengths[i], lengths[j]],
                    &at(near, v),
                    tolerance,
                )?;
                Ok(placed.position)
            }
            Err(e) => Err(e),
        }
    }

    fn check_closures(&self, x: &[f64], report: &mut RealiseReport) -> Result<(), RealiseError> {
        let closures = self.assignment.closures();
        let mut worst = None;
        for c in closures {
            let [a, b] = self.ends[c.edge.index()];
            let rest = self.length(c.edge);
            let strain = norm(&sub(&at(x, a), &at(x, b))) / rest - 1.0;
            if strain.abs() > report.closure_strain {
                report.closure_strain = strain.abs();
                worst = Some((*c, strain));
            }
        }
        match worst {
            Some((worst, strain)) if strain.abs() > self.options.closure_tolerance => {
                Err(RealiseError::Closure {
                    count: closures.len(),
                    worst,
                    strain,
                    tolerance: self.options.closure_tolerance,
                })
            }
            _ => Ok(()),
        }
    }

    fn length(&self, e: EdgeId) -> f64 {
        self.lengths[e.index()]
    }

    /// Turn a failed placement into an error that names edge and angles where there is such an edge.
    fn explain(
        &self,
        vertex: VertexId,
        rule: &Rule,
        x: &[f64],
        source: PlacementError,
    ) -> RealiseError {
        if let (
            Rule::F {
                known,
                edges,
                hub: Some(edge),
            },
            PlacementError::OutOfReach { height_squared },
        ) = (rule, source)
        {
            let k = known.map(|w| at(x, w));
            let (p, r) = (sub(&k[0], &k[1]), sub(&k[2], &k[1]));
            let l = edges.map(|e| self.length(e));
            return RealiseError::Incompatible {
                edge: *edge,
                vertex,
                angles: AngleTriple {
                    alpha: angle_from_lengths(l[1], norm(&p), l[0]),
                    beta: angle_from_lengths(l[1], norm(&r), l[2]),
                    gamma: norm(&cross(&p, &r)).atan2(dot(&p, &r)),
                },
                height_squared,
            };
        }
        cannot_place(vertex, rule, source)
    }
}

fn cannot_place(vertex: VertexId, rule: &Rule, source: PlacementError) -> RealiseError {
    RealiseError::Placement {
        vertex,
        known: rule.known().to_vec(),
        source,
    }
}

/// The two of three points that are farthest apart.
fn farthest(p: &[Vec3<f64>; 3]) -> (usize, usize) {
    let d = |i: usize, j: usize| norm(&sub(&p[i], &p[j]));
    let (a, b, c) = (d(0, 1), d(0, 2), d(1, 2));
    if a >= b && a >= c {
        (0, 1)
    } else if b >= c {
        (0, 2)
    } else {
        (1, 2)
    }
}

pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), RealiseError> {
    if found == expected {
        Ok(())
    } else {
        Err(RealiseError::WrongLength {
            what,
            found,
            expected,
        })
    }
}

pub(crate) fn check(what: &'static str, x: &[f64], expected: usize) -> Result<(), RealiseError> {
    check_length(what, x.len(), expected)?;
    match x.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(RealiseError::NotFinite {
            what,
            index,
            value: x[index],
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
