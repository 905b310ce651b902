//! The parameters of a scene's contact.

use super::{Friction, FrictionError};
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
    /// Their friction.
    pub friction: Friction,
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
    /// Their friction.
    pub friction: Friction,
}

/// The parameters of barrier and friction.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLaws {
    /// Gap below which the barrier acts and contacts are named, metres.
    pub activation: f64,
    /// Stiffness of the barrier.
    pub stiffness: Stiffness,
    /// Speed below which sliding counts as rest, metres per second. Coulomb's law needs it, and no other.
    pub rest_speed: f64,
    /// Friction of the sheet with itself, and of sheets that are no pair of `pairs`.
    pub itself: Friction,
    /// Friction of pairs of sheets, where it is another.
    pub pairs: Vec<SheetPair>,
    /// Friction of the sheet with each body, in the order of the bodies; none where a body has no entry.
    pub bodies: Vec<Friction>,
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
            itself: Friction::NONE,
            pairs: Vec::new(),
            bodies: Vec::new(),
            obstacle_pairs: Vec::new(),
        }
    }

    /// Friction with a body, or between the sheets of the first and the last vertex of a contact
    /// ([`ActiveContact::vertices`](super::ActiveContact::vertices)).
    pub fn friction(&self, body: Option<u32>, [first, last]: [u32; 2]) -> &Friction {
        let [first, last] = [first as usize, last as usize];
        match body {
            None => {
                let pair = self.pairs.iter().find(|pair| pair.has([first, last]));
                pair.map_or(&self.itself, |pair| &pair.friction)
            }
            Some(b) => {
                let has =
                    |pair: &&ObstaclePair| pair.obstacle == b && pair.vertices.contains(&first);
                if let Some(pair) = self.obstacle_pairs.iter().find(has) {
                    return &pair.friction;
                }
                self.bodies.get(b as usize).unwrap_or(&Friction::NONE)
            }
        }
    }

    /// # Errors
    /// [`FrictionError`] unless all friction makes sense ([`Friction::validate`]), and the speed of rest is
    /// positive where there are coefficients.
    pub fn validate(&self) -> Result<(), FrictionError> {
        self.all().try_for_each(Friction::validate)?;
        let smooths =
            |friction: &Friction| matches!(friction, Friction::Coulomb(_)) && !friction.is_none();
        match !self.all().any(smooths) || self.rest_speed > 0.0 && self.rest_speed.is_finite() {
            true => Ok(()),
            false => Err(FrictionError::Smoothing(self.rest_speed)),
        }
    }

    /// Whether there is no friction anywhere.
    pub(crate) fn is_frictionless(&self) -> bool {
        self.all().all(Friction::is_none)
    }

    /// Whether there is another law than Coulomb's.
    pub(crate) fn has_other_laws(&self) -> bool {
        self.all()
            .any(|friction| matches!(friction, Friction::Law(_)))
    }

    /// The friction of all that may touch.
    fn all(&self) -> impl Iterator<Item = &Friction> {
        let pairs = self.pairs.iter().map(|pair| &pair.friction);
        let of_obstacles = self.obstacle_pairs.iter().map(|pair| &pair.friction);
        let bodies = self.bodies.iter().chain(of_obstacles);
        bodies.chain(pairs).chain([&self.itself])
    }
}
