//! What a user chooses about contact.

use crate::ObstacleError;
use isosheet_dynamics::SheetModel;
use isosheet_dynamics::contact::internals::BarrierPotential;
use isosheet_dynamics::contact::{
    BarrierError, ContactLaws, FrictionError, Stiffness, SurfacePoints, SurfacePointsError,
};
use isosheet_geometry::{CcdOptions, CcdOptionsError, ShapeError};
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, FaceId, Sheet, Topology, VertexId, area_from_lengths};
use std::ops::Range;
use thiserror::Error;

/// Options of [`super::Contacts`]. Start from [`ContactOptions::for_sheet`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactOptions {
    /// Gap below which the barrier acts, `d_hat`, metres. For a sheet: 1 % of the mean rod length,
    /// small against what a mesh of straight rods errs by in a bend (an eighth of a rod at one
    /// radian), and not more than half the smallest height of a face, so that it may touch
    /// itself. A sheet may start closer; it is then pushed away.
    pub activation: f64,
    /// Thickness of the sheet, metres: the least distance from bodies and from itself, before the
    /// gap begins to count. Default 0. Bodies have none. Of several sheets each may have its own, see
    /// [`super::Contacts::with_thickness_of`].
    pub thickness: f64,
    /// Stiffness of the barrier. Default [`Stiffness::Automatic`].
    pub stiffness: Stiffness,
    /// Speed below which sliding counts as rest, metres per second: friction at rest is a creep below
    /// it. For a sheet: 1 % of a mean rod length per second, so that minutes pass before a sheet at
    /// rest has crept over one edge of its mesh.
    pub rest_speed: f64,
    /// Sides of the prism that stands for a cylinder against edges and faces, see
    /// [`crate::Shape::contact_geometry`]. Default 64: they come closer to the true cylinder by at
    /// most 0.12 % of its radius. Vertices meet the true cylinder.
    pub segments: usize,
    /// Part of a gap that a checked motion leaves, see [`CcdOptions::remainder`]. Default 0.1. Where half the
    /// activation distance is more, or half of a gap that is less than the activation distance, the motion
    /// leaves that ([`CcdOptions::approach`]).
    pub remainder: f64,
}

/// Why contact cannot be set up.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ContactsError {
    /// Activation distance or stiffness make no sense.
    #[error(transparent)]
    Barrier(#[from] BarrierError),
    /// The thickness is negative or not finite.
    #[error("the thickness is {0} m")]
    Thickness(f64),
    /// The activation distance is lost in the round-off of distances.
    #[error(
        "distances cannot tell the activation distance {activation} m from the thickness {thickness} \
         m",
        activation = given(*activation), thickness = given(*thickness)
    )]
    Resolution {
        /// The activation distance.
        activation: f64,
        /// The thickness.
        thickness: f64,
    },
    /// The speed that counts as rest is not positive.
    #[error("rest_speed is {0} m/s")]
    RestSpeed(f64),
    /// An option of the collision detection makes no sense.
    #[error(transparent)]
    Ccd(#[from] CcdOptionsError),
    /// A body cannot be approximated.
    #[error(transparent)]
    Obstacle(#[from] ObstacleError),
    /// The coefficients of friction make no sense.
    #[error(transparent)]
    Friction(#[from] FrictionError),
    /// The radius of a round body is not positive.
    #[error("the radius of a round body is {0} m")]
    Radius(f64),
    /// Points of a round body cannot be carried.
    #[error(transparent)]
    Points(#[from] SurfacePointsError),
    /// Neighbouring parts of a flat sheet would repel each other.
    #[error(
        "face {face} is only {height} m high, and the sheet repels itself up to {reach} m \
         (activation and thickness)",
        height = brief(*height), reach = brief(*reach)
    )]
    Reach {
        /// The face.
        face: u32,
        /// Its smallest height, metres.
        height: f64,
        /// Activation distance plus thickness, metres.
        reach: f64,
    },
}

impl From<ShapeError> for ContactsError {
    fn from(error: ShapeError) -> Self {
        Self::Obstacle(error.into())
    }
}

impl Advice for ContactsError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Barrier(error) => error.advice(),
            Self::Thickness(..) => Some("give zero or a positive length"),
            Self::Resolution { .. } => Some("choose lengths closer to each other"),
            Self::RestSpeed(..) => {
                Some("give a positive speed, for instance 1 % of a rod length per second")
            }
            Self::Ccd(error) => error.advice(),
            Self::Obstacle(error) => error.advice(),
            Self::Friction(error) => error.advice(),
            Self::Radius(..) => Some("give a positive length"),
            Self::Points(error) => error.advice(),
            Self::Reach { .. } => Some("choose them below that height, or merge the short edges"),
        }
    }
}

/// Activation distance over the mean rod length.
const RELATIVE_ACTIVATION: f64 = 1e-2;
/// Speed that counts as rest, mean rod lengths per second.
const RELATIVE_REST_SPEED: f64 = 1e-2;

/// Gap, in activation distances, that a motion of the solver leaves between parts that are more than twice as
/// far from each other: the gap at which a loaded contact rests. A part that comes closer is held there by a
/// barrier far steeper than its load, and gets away by a few gaps an iteration. Factorisations a step with 0,
/// 0.25, 0.5 and 0.8: sheets of 289 vertices that drape on a table without friction (8 starts) 15.8, 14.6,
/// 13.4 and 10.9, with friction 13.9, 14.4, 14.1 and 16.1; a disk of 688 vertices on a ball 29.9, 26.6, 25.1
/// and 25.7.
const APPROACH: f64 = 0.5;

impl ContactOptions {
    /// The defaults for a sheet.
    pub fn for_sheet(model: &SheetModel) -> Self {
        let topology = model.topology();
        Self::between(topology, model.edges().lengths(), topology.vertex_count())
    }

    /// The defaults for a surface that is not that of the model, see
    /// [`Contacts::on_surface`](crate::Contacts::on_surface). The faces of bodies may be as narrow as they
    /// are: a body does not touch itself.
    pub fn for_surface(surface: &Sheet, points: &SurfacePoints) -> Self {
        Self::for_surface_without(surface, points, &[])
    }

    /// The defaults for a surface of which some ranges of points do not count, such as those in the place of
    /// which there are [round bodies](crate::Contacts::with_round_body).
    pub fn for_surface_without(
        surface: &Sheet,
        points: &SurfacePoints,
        replaced: &[Range<usize>],
    ) -> Self {
        let counts = |v: VertexId| !replaced.iter().any(|range| range.contains(&v.index()));
        let edges = surface.topology().edges().iter().zip(surface.lengths());
        let lengths: Vec<f64> = edges
            .filter(|([v, _], _)| counts(*v))
            .map(|(_, l)| *l)
            .collect();
        let heights = smallest_heights(surface.topology(), surface.lengths(), points.own());
        Self::of(&lengths, heights)
    }

    fn between(topology: &Topology, lengths: &[f64], own: usize) -> Self {
        Self::of(lengths, smallest_heights(topology, lengths, own))
    }

    /// For edges of these lengths and faces of these heights.
    fn of(lengths: &[f64], heights: impl Iterator<Item = f64>) -> Self {
        let length = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let height = heights.fold(f64::INFINITY, f64::min);
        Self {
            activation: (RELATIVE_ACTIVATION * length).min(0.5 * height),
            thickness: 0.0,
            stiffness: Stiffness::Automatic,
            rest_speed: RELATIVE_REST_SPEED * length,
            segments: 64,
            remainder: CcdOptions::default().remainder,
        }
    }

    /// # Errors
    /// [`ContactsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), ContactsError> {
        let stiffness = match self.stiffness {
            Stiffness::Automatic => 1.0,
            Stiffness::Joules(kappa) => kappa,
        };
        BarrierPotential::new(self.activation, stiffness)?;
        let (activation, thickness) = (self.activation, self.thickness);
        if !(thickness >= 0.0 && thickness.is_finite()) {
            return Err(ContactsError::Thickness(thickness));
        }
        if self.reach() == thickness {
            return Err(ContactsError::Resolution {
                activation,
                thickness,
            });
        }
        if !(self.rest_speed > 0.0 && self.rest_speed.is_finite()) {
            return Err(ContactsError::RestSpeed(self.rest_speed));
        }
        self.ccd().validate()?;
        Ok(())
    }

    pub(super) fn ccd(&self) -> CcdOptions {
        CcdOptions {
            separation: self.thickness,
            remainder: self.remainder,
            approach: APPROACH * self.activation,
            ..CcdOptions::default()
        }
    }

    /// The contact laws of a scene without bodies.
    pub(super) fn laws(&self) -> ContactLaws {
        ContactLaws {
            stiffness: self.stiffness,
            rest_speed: self.rest_speed,
            ..ContactLaws::frictionless(self.activation)
        }
    }

    /// Distance below which the barrier acts, metres.
    fn reach(&self) -> f64 {
        self.thickness + self.activation
    }
}

/// The smallest height of each face between the first `own` vertices, metres, and infinity of the others. In
/// the flat sheet no vertex is closer than this to an edge or face that it does not belong to, nor are two
/// edges without a common end, except across slits and at re-entrant corners of the outline.
pub(super) fn smallest_heights<'a>(
    topology: &'a Topology,
    lengths: &'a [f64],
    own: usize,
) -> impl Iterator<Item = f64> + 'a {
    let height = move |face: FaceId| {
        if topology.faces()[face.index()][0].index() >= own {
            return f64::INFINITY;
        }
        let sides = topology.face_edges(face).map(|e| lengths[e.index()]);
        let longest = sides.iter().fold(0.0, |longest, side| side.max(longest));
        2.0 * area_from_lengths(sides) / longest
    };
    topology.face_ids().map(height)
}
