//! Scalar functions of time: what prescribed motions, driven creases and loads are made of.

use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use std::f64::consts::TAU;

#[cfg(test)]
mod tests;

/// A scalar function of time (seconds). Its unit is that of what it drives: metres for a displacement,
/// radians for an angle, newtons for a load. (Files have profiles as scenes have them, in
/// `isosheet_scenes`.)
///
/// The derivatives are exact. Where one of them jumps, which is at the ends of a ramp and at keyframes, it is
/// the value to the right: that of the motion that begins there.
#[derive(Debug, Clone, PartialEq)]
pub enum Profile {
    /// A constant value.
    Constant(f64),
    /// `from` before `begin`, `to` after `end`, and linear between. The rate jumps at both ends; the
    /// acceleration is zero everywhere else and is given as zero there too.
    Ramp {
        /// Value up to `begin`.
        from: f64,
        /// Value from `end` on.
        to: f64,
        /// When it begins to change, seconds.
        begin: f64,
        /// When the change is complete, seconds.
        end: f64,
    },
    /// `from` before `begin`, `to` after `end`, and between `from + (to - from) (10 s^3 - 15 s^4 + 6 s^5)`
    /// with `s = (t - begin) / (end - begin)`: twice continuously differentiable (C2), the polynomial of
    /// least degree with rate and acceleration zero at both ends. (Flash and Hogan 1985, *The coordination of
    /// arm movements*: of all motions from rest to rest the one of least mean squared jerk.)
    SmoothStep {
        /// Value up to `begin`.
        from: f64,
        /// Value from `end` on.
        to: f64,
        /// When it begins to change, seconds.
        begin: f64,
        /// When the change is complete, seconds.
        end: f64,
    },
    /// `from` before `begin`, then with the constant acceleration `rate / (end - begin)`, and from `end` on
    /// with the constant rate: how a feed gets going. The value at `end` is
    /// `from + rate (end - begin) / 2`. The rate is continuous (C1).
    RunUp {
        /// Value up to `begin`.
        from: f64,
        /// Rate from `end` on, per second.
        rate: f64,
        /// When it begins to change, seconds.
        begin: f64,
        /// When the rate is reached, seconds.
        end: f64,
    },
    /// `mean + amplitude sin(2 pi frequency t + phase)`.
    Sine {
        /// Mean value.
        mean: f64,
        /// Amplitude.
        amplitude: f64,
        /// Frequency, hertz.
        frequency: f64,
        /// Phase at time zero, radians.
        phase: f64,
    },
    /// Through pairs `[time, value]` in the order of time; constant before the first and after the last.
    Keyframes {
        /// The course between keyframes.
        interpolation: Interpolation,
        /// Time (seconds) and value of each keyframe.
        keys: Vec<[f64; 2]>,
    },
}

/// The course of a [`Profile::Keyframes`] between two keyframes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// Linear; the rate jumps at keyframes.
    #[default]
    Linear,
    /// Cubic polynomials with a continuous rate (C1) that are monotone wherever the keyframes are, so that no
    /// value lies beyond the values of the two keyframes beside it; the acceleration jumps at keyframes.
    ///
    /// The slope at a keyframe is the weighted harmonic mean of the slopes `d` of the two chords beside it,
    /// `(w_1 + w_2) / (w_1 / d_1 + w_2 / d_2)` with `w_1 = 2 h_2 + h_1`, `w_2 = h_2 + 2 h_1` for the
    /// durations `h`, and zero where the chords differ in sign (Fritsch and Butland 1984, *A method for
    /// constructing local monotone piecewise cubic interpolants*). At the first and the last keyframe it is
    /// zero, as before and after them.
    MonotoneCubic,
}

/// Why a profile cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// A parameter is not finite.
    #[error("`{name}` is {value}", value = given(*value))]
    NotFinite {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A change takes no time.
    #[error(
        "the change begins at {begin} s and ends at {end} s",
        begin = given(*begin), end = given(*end)
    )]
    Duration {
        /// The beginning, seconds.
        begin: f64,
        /// The end, seconds.
        end: f64,
    },
    /// There are no keyframes.
    #[error("the profile has no keyframes")]
    NoKeyframes,
    /// A keyframe is not finite.
    #[error("keyframe {index} is [{t}, {value}]", t = given(*t), value = given(*value))]
    Keyframe {
        /// The keyframe, from 0.
        index: usize,
        /// Its time, seconds.
        t: f64,
        /// Its value.
        value: f64,
    },
    /// The times of the keyframes do not increase.
    #[error(
        "keyframe {index} at t = {t} s does not come after the one before at t = {previous} s",
        t = given(*t), previous = given(*previous)
    )]
    Order {
        /// The later keyframe, from 0.
        index: usize,
        /// Its time, seconds.
        t: f64,
        /// The time of the keyframe before, seconds.
        previous: f64,
    },
}

impl Advice for ProfileError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NotFinite { .. } => Some("give a finite number"),
            Self::Duration { .. } => Some("let it end later than it begins"),
            Self::NoKeyframes => Some("give at least one pair [time, value]"),
            Self::Keyframe { .. } => Some("give a finite time and a finite value"),
            Self::Order { .. } => Some("sort the keyframes by time, one for each time"),
        }
    }
}

impl Default for Profile {
    /// Zero at all times.
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

impl From<f64> for Profile {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl Profile {
    /// Checks the parameters. The values of a profile that does not pass are of no meaning, and may be NaN.
    ///
    /// # Errors
    /// [`ProfileError`] naming the first parameter or keyframe that cannot be used.
    pub fn validate(&self) -> Result<(), ProfileError> {
        match self {
            Self::Constant(value) => check_finite(&[("value", *value)]),
            Self::Ramp {
                from,
                to,
                begin,
                end,
            }
            | Self::SmoothStep {
                from,
                to,
                begin,
                end,
            } => {
                let (begin, end) = (*begin, *end);
                check_finite(&[("from", *from), ("to", *to), ("begin", begin), ("end", end)])?;
                check_duration(begin, end)
            }
            Self::RunUp {
                from,
                rate,
                begin,
                end,
            } => {
                let (begin, end) = (*begin, *end);
                check_finite(&[
                    ("from", *from),
                    ("rate", *rate),
                    ("begin", begin),
                    ("end", end),
                ])?;
                check_duration(begin, end)
            }
            Self::Sine {
                mean,
                amplitude,
                frequency,
                phase,
            } => check_finite(&[
                ("mean", *mean),
                ("amplitude", *amplitude),
                ("frequency", *frequency),
                ("phase", *phase),
            ]),
            Self::Keyframes { keys, .. } => check_keys(keys),
        }
    }

    /// The value at time `t` (seconds).
    pub fn value(&self, t: f64) -> f64 {
        self.derivatives(t)[0]
    }

    /// First derivative by time at `t` (seconds), per second; where it jumps the value to the right.
    pub fn rate(&self, t: f64) -> f64 {
        self.derivatives(t)[1]
    }

    /// Second derivative by time at `t` (seconds), per second squared; where it jumps the value to the right.
    pub fn acceleration(&self, t: f64) -> f64 {
        self.derivatives(t)[2]
    }

    /// Whether the value is the same at all times.
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Ramp { from, to, .. } | Self::SmoothStep { from, to, .. } => from == to,
            Self::RunUp { rate, .. } => *rate == 0.0,
            Self::Sine {
                amplitude,
                frequency,
                ..
            } => *amplitude == 0.0 || *frequency == 0.0,
            Self::Keyframes { keys, .. } => keys.iter().all(|k| k[1] == keys[0][1]),
        }
    }

    /// The times at which the rate or the acceleration jumps, in order (seconds), see
    /// `SheetModel::with_breaks` of isosheet-dynamics: ends of ramps and of run-ups, and keyframes.
    pub fn breaks(&self) -> Vec<f64> {
        match self {
            _ if self.is_constant() => Vec::new(),
            Self::Constant(_) | Self::SmoothStep { .. } | Self::Sine { .. } => Vec::new(),
            Self::Ramp { begin, end, .. } | Self::RunUp { begin, end, .. } => vec![*begin, *end],
            Self::Keyframes { keys, .. } => keys.iter().map(|[t, _]| *t).collect(),
        }
    }

    /// Value, rate and acceleration at time `t`.
    pub fn derivatives(&self, t: f64) -> [f64; 3] {
        match self {
            Self::Constant(value) => [*value, 0.0, 0.0],
            Self::Ramp {
                from,
                to,
                begin,
                end,
            } => match fraction(t, *begin, *end) {
                Fraction::Before => [*from, 0.0, 0.0],
                Fraction::After => [*to, 0.0, 0.0],
                Fraction::Inside(s) => {
                    let change = to - from;
                    [from + change * s, change / (end - begin), 0.0]
                }
            },
            Self::SmoothStep {
                from,
                to,
                begin,
                end,
            } => match fraction(t, *begin, *end) {
                Fraction::Before => [*from, 0.0, 0.0],
                Fraction::After => [*to, 0.0, 0.0],
                Fraction::Inside(s) => {
                    let (change, duration, left) = (to - from, end - begin, 1.0 - s);
                    [
                        from + change * s * s * s * (10.0 + s * (6.0 * s - 15.0)),
                        change / duration * 30.0 * s * s * left * left,
                        change / (duration * duration) * 60.0 * s * left * (left - s),
                    ]
                }
            },
            Self::RunUp {
                from,
                rate,
                begin,
                end,
            } => {
                let duration = end - begin;
                match fraction(t, *begin, *end) {
                    Fraction::Before => [*from, 0.0, 0.0],
                    Fraction::Inside(s) => [
                        from + 0.5 * rate * duration * s * s,
                        rate * s,
                        rate / duration,
                    ],
                    Fraction::After => [from + rate * (t - end + 0.5 * duration), *rate, 0.0],
                }
            }
            Self::Sine {
                mean,
                amplitude,
                frequency,
                phase,
            } => {
                let omega = TAU * frequency;
                let (sin, cos) = (omega * t + phase).sin_cos();
                [
                    mean + amplitude * sin,
                    amplitude * omega * cos,
                    -amplitude * omega * omega * sin,
                ]
            }
            Self::Keyframes {
                interpolation,
                keys,
            } => interpolate(*interpolation, keys, t),
        }
    }
}

fn check_duration(begin: f64, end: f64) -> Result<(), ProfileError> {
    if begin < end {
        Ok(())
    } else {
        Err(ProfileError::Duration { begin, end })
    }
}

fn check_finite(parameters: &[(&'static str, f64)]) -> Result<(), ProfileError> {
    match parameters.iter().find(|(_, value)| !value.is_finite()) {
        Some(&(name, value)) => Err(ProfileError::NotFinite { name, value }),
        None => Ok(()),
    }
}

fn check_keys(keys: &[[f64; 2]]) -> Result<(), ProfileError> {
    if keys.is_empty() {
        return Err(ProfileError::NoKeyframes);
    }
    for (index, &[t, value]) in keys.iter().enumerate() {
        if !(t.is_finite() && value.is_finite()) {
            return Err(ProfileError::Keyframe { index, t, value });
        }
        if index > 0 && t <= keys[index - 1][0] {
            let previous = keys[index - 1][0];
            return Err(ProfileError::Order { index, t, previous });
        }
    }
    Ok(())
}

/// How much of an interval has passed.
enum Fraction {
    Before,
    /// From 0 inclusive to 1 exclusive.
    Inside(f64),
    After,
}

fn fraction(t: f64, begin: f64, end: f64) -> Fraction {
    if t < begin {
        Fraction::Before
    } else if t >= end {
        Fraction::After
    } else {
        Fraction::Inside((t - begin) / (end - begin))
    }
}

fn interpolate(interpolation: Interpolation, keys: &[[f64; 2]], t: f64) -> [f64; 3] {
    let next = keys.partition_point(|k| k[0] <= t);
    if keys.is_empty() {
        return [f64::NAN; 3];
    }
    if next == 0 || next == keys.len() {
        return [keys[next.saturating_sub(1)][1], 0.0, 0.0];
    }
    let ([t0, v0], [t1, v1]) = (keys[next - 1], keys[next]);
    let (duration, change) = (t1 - t0, v1 - v0);
    let s = (t - t0) / duration;
    match interpolation {
        Interpolation::Linear => [v0 + change * s, change / duration, 0.0],
        Interpolation::MonotoneCubic => {
            // v0 + a s + b s^2 + c s^3 with the slopes `a` and `e` per duration at the two ends.
            let a = duration * slope(keys, next - 1);
            let e = duration * slope(keys, next);
            let (b, c) = (3.0 * change - 2.0 * a - e, a + e - 2.0 * change);
            [
                v0 + s * (a + s * (b + s * c)),
                (a + s * (2.0 * b + 3.0 * s * c)) / duration,
                (2.0 * b + 6.0 * s * c) / (duration * duration),
            ]
        }
    }
}

/// Slope of the monotone cubic interpolant at a keyframe.
fn slope(keys: &[[f64; 2]], i: usize) -> f64 {
    if i == 0 || i + 1 == keys.len() {
        return 0.0;
    }
    let (before, after) = (keys[i][0] - keys[i - 1][0], keys[i + 1][0] - keys[i][0]);
    let (d1, d2) = (
        (keys[i][1] - keys[i - 1][1]) / before,
        (keys[i + 1][1] - keys[i][1]) / after,
    );
    if d1 == 0.0 || d2 == 0.0 || (d1 > 0.0) != (d2 > 0.0) {
        return 0.0;
    }
    let (w1, w2) = (2.0 * after + before, after + 2.0 * before);
    (w1 + w2) / (w1 / d1 + w2 / d2)
}
