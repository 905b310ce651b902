//! Step control: what follows from a proposal, and what from a refusal.
//!
//! An integrator proposes a sub-step or refuses to; nothing but [`take_substep`] commits one:
//!
//! | proposal | without a chart ([`Subdivision`]) | in a chart ([`EnergyBound`], Sec. 4.2) |
//! |---|---|---|
//! | made, and within its bounds | commit | commit |
//! | refused: would create energy, has a history | restart as a one-step method | |
//! | refused: the chart is singular there | | restart from a new reference state |
//! | refused, the step may be shortened | halve | shorten by that bound, by contact to its safe part |
//! | refused, a fallback is allowed | fall back: implicit Euler | |
//! | refused otherwise | stop | stop |
//!
//! [`Subdivision`]: crate::step::subdivision::Subdivision
//! [`EnergyBound`]: crate::chart::energy_bound::EnergyBound

/// What to do after a refusal.
#[derive(Debug)]
pub(crate) enum Decision<E> {
    /// Propose the same sub-step without what the method remembers.
    Restart,
    /// Propose a sub-step of this length, seconds.
    Shorten(f64),
    /// Propose a sub-step of this length, seconds, with the fallback.
    FallBack(f64),
    /// Give up.
    Stop(E),
}

impl<E> Decision<E> {
    /// Its name in a trace.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Restart => "restart",
            Self::Shorten(_) => "shorten",
            Self::FallBack(_) => "fall back",
            Self::Stop(_) => "stop",
        }
    }
}

/// Something that moves in sub-steps.
pub(crate) trait Stepping {
    /// Why a sub-step was refused.
    type Refusal;
    /// Why there is no sub-step.
    type Error;
    /// What a committed sub-step did.
    type Report;

    /// Proposes a sub-step of `h` seconds. What the next step depends on stays as it is.
    fn propose(&mut self, h: f64) -> Result<(), Self::Refusal>;

    /// Decides what follows from the refusal of a sub-step of `h` seconds.
    fn decide(&mut self, refusal: Self::Refusal, h: f64) -> Decision<Self::Error>;

    /// Drops what the method remembers for the sub-step to come.
    fn restart(&mut self) -> Result<(), Self::Error>;

    /// Has the fallback method propose the sub-step to come.
    fn fall_back(&mut self);

    /// Takes the sub-step that was proposed last, of `h` seconds.
    fn commit(&mut self, h: f64) -> Result<Self::Report, Self::Error>;
}

/// Takes one sub-step of `h` seconds or less.
pub(crate) fn take_substep<S: Stepping>(moving: &mut S, h: f64) -> Result<S::Report, S::Error> {
    let mut h = h;
    loop {
        let Err(refusal) = moving.propose(h) else {
            return moving.commit(h);
        };
        match moving.decide(refusal, h) {
            Decision::Restart => moving.restart()?,
            Decision::Shorten(shorter) => h = shorter,
            Decision::FallBack(length) => {
                h = length;
                moving.fall_back();
            }
            Decision::Stop(error) => return Err(error),
        }
    }
}
