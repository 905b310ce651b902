//! Vibrations of a run, found in its kinetic energy: whether the steps resolve them.

use isosheet_mesh::wording::brief;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::fmt;

/// Part of the largest kinetic energy before it that a peak has to reach to count.
const MUCH: f64 = 0.1;

/// Part of a length that a vibration has to move to and fro to count.
const SMALL: f64 = 0.01;

/// A vibration: half a period of it lies between two peaks of the kinetic energy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Vibration {
    /// Frequency in the run, hertz.
    pub frequency: f64,
    /// Length of the steps, seconds.
    pub step: f64,
    /// Time of its second peak, seconds.
    pub t: f64,
}

impl Vibration {
    /// Part by which the second-order backward differentiation formula makes a vibration slower, to leading
    /// order in the angle `w h` of a step: `(w h)^2 / 3`, from its truncation error `h^3 x''' / 3`.
    pub fn slowing(&self) -> f64 {
        let angle = 2.0 * PI * self.frequency * self.step;
        angle * angle / 3.0
    }

    /// The length of steps that slow it by a part, seconds.
    pub fn step_for(&self, slowing: f64) -> f64 {
        self.step * (slowing / self.slowing()).sqrt()
    }
}

impl fmt::Display for Vibration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (frequency, t) = (brief(self.frequency), brief(self.t));
        write!(f, "{frequency} Hz at {t} s")
    }
}

/// Looks for the fastest vibration in the kinetic energy of a run: two peaks with less than half of the lower
/// one between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Vibrations {
    /// Largest kinetic energy so far, joules.
    largest: f64,
    /// The extreme of the kinetic energy since it turned (joules), and its time.
    extreme: f64,
    since: f64,
    falls: bool,
    /// Time and energy of the last peak.
    peak: Option<(f64, f64)>,
    /// The fastest, and the energy of its lower peak.
    fastest: Option<(Vibration, f64)>,
}

impl Vibrations {
    /// Takes in the kinetic energy (joules) after a step of `h` seconds.
    pub(crate) fn observe(&mut self, t: f64, h: f64, kinetic: f64) {
        self.largest = self.largest.max(kinetic);
        let goes_on = match self.falls {
            false => kinetic >= self.extreme,
            true => kinetic <= self.extreme,
        };
        if goes_on {
            (self.extreme, self.since) = (kinetic, t);
        } else if !self.falls && kinetic < 0.5 * self.extreme {
            self.reach(h);
            (self.falls, self.extreme, self.since) = (true, kinetic, t);
        } else if self.falls && kinetic > 2.0 * self.extreme {
            (self.falls, self.extreme, self.since) = (false, kinetic, t);
        }
    }

    /// A peak was reached.
    fn reach(&mut self, h: f64) {
        let (t, energy) = (self.since, self.extreme);
        let before = self.peak.replace((t, energy));
        let Some((begin, lower)) = before.map(|(begin, e)| (begin, e.min(energy))) else {
            return;
        };
        let found = Vibration {
            frequency: 0.5 / (t - begin),
            step: h,
            t,
        };
        let faster = |(fastest, _): &(Vibration, f64)| found.slowing() > fastest.slowing();
        let last = self.fastest.filter(|(_, e)| *e >= MUCH * self.largest);
        if lower >= MUCH * self.largest && last.as_ref().is_none_or(faster) {
            self.fastest = Some((found, lower));
        } else {
            self.fastest = last;
        }
    }

    /// The fastest vibration that had a tenth of the largest kinetic energy and moved a mass (kilograms) by
    /// more than a hundredth of some length (metres).
    pub(crate) fn fastest(&self, mass: f64, length: f64) -> Option<Vibration> {
        let (fastest, energy) = self.fastest?;
        let amplitude = (2.0 * energy / mass).sqrt() / (2.0 * PI * fastest.frequency);
        (energy >= MUCH * self.largest && amplitude > SMALL * length).then_some(fastest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of the formula for `x'' = -w^2 x` from `x = 1` at rest.
    fn found(angle: f64) -> Option<Vibration> {
        let (mut x, mut v) = ([1.0, 1.0], [0.0, 0.0]);
        let mut vibrations = Vibrations::default();
        // 2/3 h of velocities: x = a + c v, v = b - c w^2 x.
        let c = 2.0 * angle / 3.0;
        for k in 1..=2000 {
            let [a, b] = [x, v].map(|[old, new]: [f64; 2]| (4.0 * new - old) / 3.0);
            let next = (a + c * b) / (1.0 + c * c);
            (x, v) = ([x[1], next], [v[1], b - c * next]);
            vibrations.observe(f64::from(k), 1.0, v[1] * v[1]);
        }
        vibrations.fastest(2.0, 1.0)
    }

    #[test]
    fn a_vibration_is_found_with_the_frequency_that_the_formula_gives_it() {
        for angle in [0.05, 0.1, 0.2, 0.3] {
            let found = found(angle).expect("vibration");
            let half = 0.5 / found.frequency;
            // Peaks are found at whole steps.
            let expected = PI / (angle * (1.0 - angle * angle / 3.0));
            assert!(
                (half - expected).abs() < 1.0 + 0.1 * angle * expected,
                "{half} {expected}"
            );
            assert!((found.slowing() / (angle * angle / 3.0) - 1.0).abs() < 0.3);
        }
    }

    #[test]
    fn free_fall_and_small_vibrations_are_none() {
        let mut vibrations = Vibrations::default();
        for k in 0..100 {
            let t = f64::from(k) * 0.01;
            vibrations.observe(t, 0.01, t * t);
        }
        for k in 0..100 {
            let t = f64::from(k) * 0.01;
            vibrations.observe(1.0 + t, 0.01, 0.05 * (40.0 * t).sin().powi(2));
        }
        assert_eq!(vibrations.fastest(2.0, 1.0), None);
    }
}
