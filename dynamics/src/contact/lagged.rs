//! Friction of a step: contacts with constant normals and normal forces.

use super::friction::coulomb;
use super::stencil::Stencil;
use super::{
    ActiveContact, ActiveContacts, BarrierPotential, BodyPlace, Contact, ContactKey, ContactLaws,
    Coulomb, CouplingSink, Course, DIFFERENCE, Friction, FrictionError, FrictionLaw, add_weighted,
};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Friction at one contact with normal, closest points and normal force as they are at the positions
/// at which it was lagged (Li et al. 2020, Incremental potential contact, Sec. 5).
///
/// The surfaces slide by `u = (I - n n^T) (sum_i w_i dx_i - d)` with the displacements `dx_i` of the points
/// and `d` of the body's material point, at a speed `|u| / tau`; the potential is `tau N F(|u| / tau)` with
/// the normal force `N` and the integral `F` of the friction law. For Coulomb's law the displacements are
/// those since the start of the step, and the unit of time is the step, `tau = 1`. For other laws `u / tau`
/// is the velocity at the end of the step by the formula of the method: the displacements are those from the
/// positions `y` of `x1 = y + tau v1` with the effective step `tau`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrictionContact {
    /// Which two primitives.
    pub key: ContactKey,
    /// The first and the last vertex of the two primitives.
    pub ends: [u32; 2],
    /// The points with their weights in the relative motion of the surfaces.
    pub stencil: Stencil,
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Normal force, newtons.
    pub force: f64,
    /// The material point of the body that is touched, in its frame, metres.
    point: Vector3<f64>,
    /// Its place in space at the start of the step, metres.
    point_start: Vector3<f64>,
    law: LawOfContact,
}

/// The law of friction at a contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum LawOfContact {
    /// With speeds in metres a step.
    Coulomb(Coulomb),
    /// Another law, by its number in [`LaggedFriction`].
    Other {
        number: u32,
        /// Effective step, seconds.
        tau: f64,
        /// Effective step over the length of the step.
        part: f64,
    },
}

/// The relative motion at a contact that displacements `w` of the points make.
fn weighted(stencil: &Stencil, w: &[f64]) -> Vector3<f64> {
    let motion = |(v, weight): (u32, f64)| {
        let i = 3 * v as usize;
        weight * Vector3::new(w[i], w[i + 1], w[i + 2])
    };
    stencil.iter().map(motion).sum()
}

impl FrictionContact {
    fn new(
        contact: &ActiveContact,
        barrier: &BarrierPotential,
        law: LawOfContact,
        x: &[f64],
        bodies: &[BodyPlace],
    ) -> Self {
        let [point, point_start] = match contact.key.body {
            Some(b) => {
                let body = &bodies[b as usize];
                let point = body.material_point(&contact.closest);
                [point, body.material_start(&point)]
            }
            None => [Vector3::zeros(); 2],
        };
        Self {
            key: contact.key,
            ends: [contact.vertices[0], contact.vertices[3]],
            stencil: Stencil::of(contact, x),
            normal: contact.normal,
            force: contact.force(barrier),
            point,
            point_start,
            law,
        }
    }

    /// How far the surfaces slide on each other while the points go from `from` to `x`, and the body goes a
    /// part of its way since the start of the step; metres.
    fn slip(&self, from: &[f64], x: &[f64], bodies: &[BodyPlace], part: f64) -> Vector3<f64> {
        let mut u = Vector3::zeros();
        for (v, w) in self.stencil.iter() {
            let i = 3 * v as usize;
            u += w * Vector3::new(
                x[i] - from[i],
                x[i + 1] - from[i + 1],
                x[i + 2] - from[i + 2],
            );
        }
        if let Some(b) = self.key.body {
            let body = &bodies[b as usize];
            u -= part * (body.material_place(&self.point) - self.point_start);
        }
        let n = &self.normal;
        u - n * n.dot(&u)
    }
}

/// A contact that slides.
struct Sliding<'a> {
    contact: &'a FrictionContact,
    law: &'a dyn FrictionLaw,
    /// `u`, metres.
    slip: Vector3<f64>,
    /// `tau`, seconds.
    tau: f64,
}

impl Sliding<'_> {
    /// `|u| / tau`, metres per second.
    fn speed(&self) -> f64 {
        self.slip.norm() / self.tau
    }

    /// Dissipation potential, joules.
    fn energy(&self) -> f64 {
        self.contact.force * (self.tau * self.law.integral(self.speed()))
    }

    /// Force on the body (or the second place of the sheet), newtons: along the slip of the sheet.
    fn traction(&self) -> Vector3<f64> {
        self.contact.force * self.ratio() * self.slip
    }

    /// `mu / |u|`, one over metres.
    fn ratio(&self) -> f64 {
        self.law.coefficient_over_speed(self.speed()) / self.tau
    }

    /// The second derivatives of the potential by the slip.
    fn tangent(&self) -> Matrix3<f64> {
        let contact = self.contact;
        let (u, n) = (&self.slip, &contact.normal);
        let ratio = contact.force * self.ratio();
        let mut block = ratio * (Matrix3::identity() - n * n.transpose());
        let y = u.norm();
        if y > 0.0 {
            let t = u / y;
            let slope = contact.force * self.law.slope(self.speed()) / self.tau;
            block += (slope - ratio) * t * t.transpose();
        }
        block
    }

    /// The Hessian of the potential; for a law that falls, its slope is replaced by zero where it is
    /// negative.
    fn hessian(&self, sink: &mut dyn CouplingSink) {
        let contact = self.contact;
        let (u, n) = (&self.slip, &contact.normal);
        let y = u.norm();
        let ratio = contact.force * self.ratio();
        let mut block = ratio * (Matrix3::identity() - n * n.transpose());
        if y > 0.0 {
            let t = u / y;
            let slope = contact.force * (self.law.slope(self.speed()) / self.tau).max(0.0);
            block += (slope - ratio) * t * t.transpose();
        }
        let (points, weights) = (contact.stencil.points(), contact.stencil.weights());
        add_weighted(points, weights, &block, sink);
    }
}

/// Friction of a step with constant normals and normal forces: the potential `D(x - x0)`.
///
/// It belongs to a step, also after its end: the loads on the bodies ([`super::ContactTerms::loads`]) belong
/// to the last step. The step after lags it anew.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct LaggedFriction {
    /// Positions at the start of the step, `3V`, metres; empty without contacts.
    x0: Vec<f64>,
    /// The positions `y` that velocities at the end of the step are measured from, `3V`, metres; empty
    /// without other laws than Coulomb's.
    rest: Vec<f64>,
    contacts: Vec<FrictionContact>,
    /// The other laws, in the order in which the contacts name them. A checkpoint has none: they come from
    /// the scene.
    #[serde(skip)]
    others: Vec<Arc<dyn FrictionLaw>>,
}

/// Equal contacts; laws are told apart by their numbers.
impl PartialEq for LaggedFriction {
    fn eq(&self, other: &Self) -> bool {
        self.x0 == other.x0 && self.rest == other.rest && self.contacts == other.contacts
    }
}

impl LaggedFriction {
    /// No friction.
    pub fn none() -> Self {
        Self::default()
    }

    /// Lags friction at active contacts at positions `x` of a step; reuses memory.
    pub fn lag(
        &mut self,
        laws: &ContactLaws,
        barrier: &BarrierPotential,
        active: &ActiveContacts,
        course: Course<'_>,
        x: &[f64],
    ) {
        self.contacts.clear();
        self.x0.clear();
        self.rest.clear();
        self.others.clear();
        if laws.is_frictionless() {
            return;
        }
        for contact in active.list() {
            let ends = [contact.vertices[0], contact.vertices[3]];
            let friction = laws.friction(contact.key.body, ends);
            let Some(law) = self.law_of(friction, laws.rest_speed, course) else {
                continue;
            };
            let lagged = FrictionContact::new(contact, barrier, law, x, active.bodies());
            if lagged.force > 0.0 {
                self.contacts.push(lagged);
                if let (Friction::Law(law), LawOfContact::Other { number, .. }) = (friction, law)
                    && number as usize == self.others.len()
                {
                    self.others.push(Arc::clone(law));
                }
            }
        }
        if !self.contacts.is_empty() {
            self.x0.extend_from_slice(course.start);
        }
        if !self.others.is_empty() {
            self.rest.extend_from_slice(course.rest);
        }
    }

    /// The law of a contact in a step; none without friction and in a step without duration.
    fn law_of(
        &self,
        friction: &Friction,
        rest_speed: f64,
        Course { tau, span, .. }: Course<'_>,
    ) -> Option<LawOfContact> {
        match friction {
            Friction::Coulomb(coefficients) => {
                coulomb(*coefficients, rest_speed, span).map(LawOfContact::Coulomb)
            }
            Friction::Law(law) if span > 0.0 => Some(LawOfContact::Other {
                number: self.number(law),
                tau,
                part: tau / span,
            }),
            Friction::Law(_) => None,
        }
    }

    /// The number of a law: that of the next one where no contact has named it yet.
    fn number(&self, law: &Arc<dyn FrictionLaw>) -> u32 {
        let known = self.others.iter().position(|other| Arc::ptr_eq(other, law));
        known.unwrap_or(self.others.len()) as u32
    }

    /// Takes the laws that a checkpoint does not have from the scene; whether they are such that the contacts
    /// name the same ones.
    pub(crate) fn take_laws(&mut self, laws: &ContactLaws) -> bool {
        let mut others: Vec<Arc<dyn FrictionLaw>> = Vec::new();
        for contact in &self.contacts {
            let LawOfContact::Other { number, .. } = contact.law else {
                continue;
            };
            let Friction::Law(law) = laws.friction(contact.key.body, contact.ends) else {
                return false;
            };
            match others.get(number as usize) {
                None if number as usize == others.len() => others.push(Arc::clone(law)),
                Some(known) if Arc::ptr_eq(known, law) => {}
                _ => return false,
            }
        }
        self.others = others;
        true
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.x0.clone_from(&other.x0);
        self.rest.clone_from(&other.rest);
        self.contacts.clone_from(&other.contacts);
        self.others.clone_from(&other.others);
    }

    /// A contact as it slides where the points are at `x`.
    fn sliding<'a>(
        &'a self,
        contact: &'a FrictionContact,
        x: &[f64],
        bodies: &[BodyPlace],
    ) -> Sliding<'a> {
        match &contact.law {
            LawOfContact::Coulomb(law) => Sliding {
                contact,
                law,
                slip: contact.slip(&self.x0, x, bodies, 1.0),
                tau: 1.0,
            },
            LawOfContact::Other { number, tau, part } => Sliding {
                contact,
                law: self.others[*number as usize].as_ref(),
                slip: contact.slip(&self.rest, x, bodies, *part),
                tau: *tau,
            },
        }
    }

    /// All contacts as they slide.
    fn all<'a>(
        &'a self,
        x: &'a [f64],
        bodies: &'a [BodyPlace],
    ) -> impl Iterator<Item = Sliding<'a>> {
        self.contacts
            .iter()
            .map(move |c| self.sliding(c, x, bodies))
    }

    /// Asks `check` about the other laws than Coulomb's, at the speed of each of their contacts (metres per
    /// second).
    pub(crate) fn check(
        &self,
        x: &[f64],
        bodies: &[BodyPlace],
        check: fn(&dyn FrictionLaw, f64) -> Result<(), FrictionError>,
    ) -> Result<(), FrictionError> {
        if self.others.is_empty() {
            return Ok(());
        }
        let is_other = |s: &Sliding<'_>| matches!(s.contact.law, LawOfContact::Other { .. });
        let others = self.all(x, bodies).filter(is_other);
        let speeds = others.map(|sliding| (sliding.law, sliding.speed()));
        // No law is to blame for positions that are no numbers.
        let mut speeds = speeds.filter(|(_, speed)| speed.is_finite());
        speeds.try_for_each(|(law, speed)| check(law, speed))
    }

    /// The contacts, in the order of their keys.
    pub fn contacts(&self) -> &[FrictionContact] {
        &self.contacts
    }

    /// The largest change of a normal force since `before`, relative to the largest normal force; zero
    /// without friction.
    pub(crate) fn change_since(&self, before: &Self) -> f64 {
        let (old, new) = (&before.contacts, &self.contacts);
        let (mut i, mut j) = (0, 0);
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        while let Some(key) = [old.get(i), new.get(j)]
            .into_iter()
            .flatten()
            .map(|c| c.key)
            .min()
        {
            let take = |list: &[FrictionContact], k: &mut usize| match list.get(*k) {
                Some(c) if c.key == key => {
                    *k += 1;
                    c.force
                }
                _ => 0.0,
            };
            let (a, b) = (take(old, &mut i), take(new, &mut j));
            change = change.max((a - b).abs());
            largest = largest.max(a).max(b);
        }
        if largest > 0.0 { change / largest } else { 0.0 }
    }

    /// The potential `D`, joules.
    pub fn energy(&self, x: &[f64], bodies: &[BodyPlace]) -> f64 {
        self.all(x, bodies).map(|sliding| sliding.energy()).sum()
    }

    /// Energy lost to friction if its present forces act over the whole displacement since the start of the
    /// step, joules.
    pub(crate) fn loss(&self, x: &[f64], bodies: &[BodyPlace]) -> f64 {
        let loss = |sliding: Sliding<'_>| {
            let Sliding { contact, law, .. } = sliding;
            let y = sliding.slip.norm();
            let distance = match contact.law {
                LawOfContact::Coulomb(_) => y,
                LawOfContact::Other { .. } if y > 0.0 => {
                    let whole = contact.slip(&self.x0, x, bodies, 1.0);
                    whole.dot(&sliding.slip) / y
                }
                LawOfContact::Other { .. } => 0.0,
            };
            contact.force * law.coefficient(sliding.speed()) * distance
        };
        self.all(x, bodies).map(loss).sum()
    }

    /// Work of the bodies against friction over the whole step, with its forces at the end, joules.
    pub(crate) fn body_work(&self, x: &[f64], bodies: &[BodyPlace]) -> f64 {
        let mut work = 0.0;
        for c in &self.contacts {
            if let Some(body) = c.key.body.map(|b| &bodies[b as usize]) {
                let displacement = body.material_end(&c.point) - c.point_start;
                // The sheet pulls the body by this force; the body works against it.
                work -= self.sliding(c, x, bodies).traction().dot(&displacement);
            }
        }
        work
    }

    /// Adds `scale` times the gradient of `D` (newtons) to `out` (`3V`).
    pub fn add_gradient(&self, x: &[f64], bodies: &[BodyPlace], scale: f64, out: &mut [f64]) {
        for c in &self.contacts {
            let force = scale * self.sliding(c, x, bodies).traction();
            for (v, w) in c.stencil.iter() {
                super::add_at(out, v, w * force);
            }
        }
    }

    /// Calls `add` with each contact and its force on the first primitive, which the weights spread over the
    /// vertices; newtons.
    pub(crate) fn forces(
        &self,
        x: &[f64],
        bodies: &[BodyPlace],
        mut add: impl FnMut(&FrictionContact, Vector3<f64>),
    ) {
        for c in &self.contacts {
            add(c, -self.sliding(c, x, bodies).traction());
        }
    }

    /// Adds the Hessian of `D` (newtons per metre), each contact's own part made positive semidefinite.
    pub fn add_hessian(&self, x: &[f64], bodies: &[BodyPlace], sink: &mut dyn CouplingSink) {
        self.all(x, bodies)
            .for_each(|sliding| sliding.hessian(sink));
    }

    /// Adds the second derivatives of `D` (newtons per metre), which are indefinite for a law that falls.
    pub(super) fn add_tangent(&self, x: &[f64], bodies: &[BodyPlace], sink: &mut dyn CouplingSink) {
        for sliding in self.all(x, bodies) {
            let stencil = &sliding.contact.stencil;
            add_weighted(
                stencil.points(),
                stencil.weights(),
                &sliding.tangent(),
                sink,
            );
        }
    }

    /// Adds `scale` times the derivatives of `w . dD/dx`, with a vector `w` of the points, by the positions
    /// from which slips are measured: to `of_start` for Coulomb's law, to `of_rest` for others.
    pub(super) fn add_start_products(
        &self,
        x: &[f64],
        bodies: &[BodyPlace],
        w: &[f64],
        scale: f64,
        [of_start, of_rest]: [&mut [f64]; 2],
    ) {
        for sliding in self.all(x, bodies) {
            let stencil = &sliding.contact.stencil;
            let product = -scale * (sliding.tangent() * weighted(stencil, w));
            let out = match sliding.contact.law {
                LawOfContact::Coulomb(_) => &mut *of_start,
                LawOfContact::Other { .. } => &mut *of_rest,
            };
            for (v, weight) in stencil.iter() {
                super::add_at(out, v, weight * product);
            }
        }
    }

    /// Adds `scale` times the derivatives of `w . dD/dx`, with a vector `w` of the points, by the positions
    /// `y` at which friction was lagged with the bodies in their places: of each contact by central
    /// differences of its normal, normal force and closest points.
    pub(super) fn add_lag_products(
        &self,
        geometry: &dyn Contact,
        barrier: &BarrierPotential,
        (y, lagged_bodies): (&[f64], &[BodyPlace]),
        (x, bodies): (&[f64], &[BodyPlace]),
        (w, scale): (&[f64], f64),
        out: &mut [f64],
    ) {
        let mut places = y.to_vec();
        let mut found = Vec::new();
        for contact in &self.contacts {
            let mut evaluate = |places: &[f64]| {
                found.clear();
                geometry.evaluate(&[contact.key], places, lagged_bodies, &mut found);
                found.first().copied()
            };
            let Some(here) = evaluate(&places) else {
                continue;
            };
            let step = DIFFERENCE * here.gap;
            for point in here.points() {
                for i in 3 * point as usize..3 * point as usize + 3 {
                    let mut at = |distance: f64| {
                        places[i] = y[i] + distance;
                        let work = evaluate(&places).map_or(0.0, |moved| {
                            let moved = FrictionContact::new(
                                &moved,
                                barrier,
                                contact.law,
                                &places,
                                lagged_bodies,
                            );
                            let traction = self.sliding(&moved, x, bodies).traction();
                            traction.dot(&weighted(&moved.stencil, w))
                        });
                        places[i] = y[i];
                        work
                    };
                    out[i] += scale * (at(step) - at(-step)) / (2.0 * step);
                }
            }
        }
    }

    /// Calls `add` with each body under friction, the force on it (newtons) and where in space it acts
    /// (metres).
    pub(super) fn body_forces(
        &self,
        x: &[f64],
        bodies: &[BodyPlace],
        mut add: impl FnMut(u32, Vector3<f64>, Vector3<f64>),
    ) {
        for c in &self.contacts {
            if let Some(b) = c.key.body {
                let place = bodies[b as usize].material_place(&c.point);
                add(b, self.sliding(c, x, bodies).traction(), place);
            }
        }
    }
}

#[cfg(test)]
mod tests;
