//! The parameters of a scene's contact.

use super::{Coefficients, Friction, FrictionError};
use std::ops::Range;

/// Stiffness `kappa` of the barrier potential `kappa b`, constant over a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// A contact that carries a hundred vertices of mean mass under the largest acceleration that the
    /// potentials cause at the start keeps half the activation distance: `kappa = 100 m a d_hat /
    /// |b'(1/2)|`, the slope taken by the gap over `d_hat`; one that carries its own vertex only keeps
    /// 95 %. A draped sheet hangs on a few contacts. Ten times less and they close to where the barrier is
    /// steep, ten times more and light contacts become hard: on draped sheets of 81 and 289 vertices either
    /// costs up to five times the Newton iterations. Without a constant force such as weight the acceleration
    /// is at least that of the paper's gravity, 9.8 m/s2, and at least the one that stops the sheet from its
    /// largest speed within its own size.
    Automatic,
    /// A given value, joules.
    Joules(f64),
}

/// Friction between two of several sheets, or of one of them with itself.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetPair {
    /// The vertices of the two sheets ([`Part::vertices`](isosheet_mesh::Part::vertices)).
    pub vertices: [Range<usize>; 2],
    /// The coefficients.
    pub coefficients: Coefficients,
}

impl SheetPair {
    /// Whether these are the sheets of two vertices.
    fn has(&self, [a, b]: [usize; 2]) -> bool {
        let [first, second] = &self.vertices;
        first.contains(&a) && second.contains(&b) || first.contains(&b) && second.contains(&a)
    }
}

/// Friction between an obstacle and one of several sheets.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstaclePair {
    /// The obstacle, by its number among the bodies of [`Contact`](super::Contact).
    pub obstacle: u32,
    /// The vertices of the sheet ([`Part::vertices`](isosheet_mesh::Part::vertices)).
    pub vertices: Range<usize>,
    /// The coefficients.
    pub coefficients: Coefficients,
}

/// The parameters of barrier and friction.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLaws {
    /// Gap below which the barrier acts and contacts are named, metres.
    pub activation: f64,
    /// Stiffness of the barrier.
    pub stiffness: Stiffness,
    /// Speed below which sliding counts as rest, metres per second.
    pub rest_speed: f64,
    /// Friction of the sheet with itself, and of sheets that are no pair of `pairs`.
    pub itself: Coefficients,
    /// Friction of pairs of sheets, where it is another.
    pub pairs: Vec<SheetPair>,
    /// Friction of the sheet with each body, in the order of the bodies; none where a body has no entry.
    pub bodies: Vec<Coefficients>,
    /// Friction of single sheets with bodies, where it is another.
    pub obstacle_pairs: Vec<ObstaclePair>,
}

impl ContactLaws {
    /// An activation distance (metres), an automatic stiffness and no friction.
    pub fn frictionless(activation: f64) -> Self {
        Self {
            activation,
            stiffness: Stiffness::Automatic,
            rest_speed: 0.0,
            itself: Coefficients::FRICTIONLESS,
            pairs: Vec::new(),
            bodies: Vec::new(),
            obstacle_pairs: Vec::new(),
        }
    }

    /// The coefficients of friction with a body, or where these four vertices of sheets meet, the first and
    /// the last of which are of the two that do.
    pub(crate) fn coefficients(&self, body: Option<u32>, vertices: [u32; 4]) -> Coefficients {
        match body {
            None => {
                let [first, .., last] = vertices.map(|v| v as usize);
                let pair = self.pairs.iter().find(|pair| pair.has([first, last]));
                pair.map_or(self.itself, |pair| pair.coefficients)
            }
            Some(b) => {
                let has = |pair: &&ObstaclePair| {
                    pair.obstacle == b && pair.vertices.contains(&(vertices[0] as usize))
                };
                if let Some(pair) = self.obstacle_pairs.iter().find(has) {
                    return pair.coefficients;
                }
                let own = self.bodies.get(b as usize);
                own.copied().unwrap_or(Coefficients::FRICTIONLESS)
            }
        }
    }

    /// Friction in a step of `h` seconds with a body, or between the sheets of the first and the last of four
    /// vertices that meet ([`ActiveContact::vertices`](super::ActiveContact::vertices)); `None` without
    /// friction and in a step without duration.
    pub fn friction(&self, body: Option<u32>, vertices: [u32; 4], h: f64) -> Option<Friction> {
        let c = self.coefficients(body, vertices);
        if c.is_frictionless() {
            return None;
        }
        Friction::new(c.rest, c.sliding, self.rest_speed * h).ok()
    }

    /// # Errors
    /// [`FrictionError`] unless all coefficients are `0 <= sliding <= rest`, and the speed of rest is
    /// positive where there is friction.
    pub fn validate(&self) -> Result<(), FrictionError> {
        self.all().try_for_each(Coefficients::validate)?;
        match self.is_frictionless() || self.rest_speed > 0.0 && self.rest_speed.is_finite() {
            true => Ok(()),
            false => Err(FrictionError::Smoothing(self.rest_speed)),
        }
    }

    /// Whether there is no friction anywhere.
    pub(crate) fn is_frictionless(&self) -> bool {
        self.all().all(Coefficients::is_frictionless)
    }

    /// The coefficients of all that may touch.
    fn all(&self) -> impl Iterator<Item = &Coefficients> {
        let pairs = self.pairs.iter().map(|pair| &pair.coefficients);
        let of_obstacles = self.obstacle_pairs.iter().map(|pair| &pair.coefficients);
        let bodies = self.bodies.iter().chain(of_obstacles);
        bodies.chain(pairs).chain([&self.itself])
    }
}
