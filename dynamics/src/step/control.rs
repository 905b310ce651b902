//! Step control: the decision after each proposed sub-step.
//!
//! | proposal | without a chart ([`Subdivision`]) | in a chart ([`EnergyBound`], Sec. 4.2) |
//! |---|---|---|
//! | accepted | commit | commit |
//! | energy gain of a multistep method | restart as a one-step method | |
//! | singular chart | | restart from a new reference state |
//! | step above its minimum | halve | shorten by the energy bound or contact |
//! | fallback allowed | implicit Euler | |
//! | otherwise | stop | stop |
//!
//! [`Subdivision`]: crate::engine::subdivision::Subdivision
//! [`EnergyBound`]: crate::chart::energy_bound::EnergyBound

/// Decision after a refusal.
#[derive(Debug)]
pub(crate) enum Decision<E> {
    /// Repeat the sub-step without history.
    Restart,
    /// Repeat with this length, seconds.
    Shorten(f64),
    /// Repeat with this length, seconds, and the fallback method.
    FallBack(f64),
    /// Return an error.
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

/// A motion in sub-steps.
pub(crate) trait Stepping {
    /// Cause of a refusal.
    type Refusal;
    /// Error of a step.
    type Error;
    /// Report of a sub-step.
    type Report;

    /// Proposes a sub-step of `h` seconds; the state does not change.
    fn propose(&mut self, h: f64) -> Result<(), Self::Refusal>;

    /// Decides after the refusal of a sub-step of `h` seconds.
    fn decide(&mut self, refusal: Self::Refusal, h: f64) -> Decision<Self::Error>;

    /// Drops the history for the next proposal.
    fn restart(&mut self) -> Result<(), Self::Error>;

    /// Uses the fallback method for the next proposal.
    fn fall_back(&mut self);

    /// Commits the last proposal, of `h` seconds.
    fn commit(&mut self, h: f64) -> Result<Self::Report, Self::Error>;
}

/// Takes a sub-step of at most `h` seconds.
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
