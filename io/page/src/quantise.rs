//! Numbers rounded to integers of one or two bytes.

use super::field::Scale;

/// The largest 16-bit integer.
const LARGEST: f64 = 65535.0;
/// The number of steps between the smallest and the largest logarithm: bytes 1 to 255, and 0 for zero.
const LOG_STEPS: f64 = 254.0;

/// The number of sizes that numbers of either sign are rounded to, which zero is not among: two signs of
/// these and zero are the 16-bit integers but one.
const SIZES: f64 = 32767.0;
/// Of numbers of either sign, what is smaller than this part of the largest is zero: six decades in 32766
/// steps are steps of 0.04 %.
const NEGLIGIBLE: f64 = 1e-6;

/// The smallest and the largest of some numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// The range of no numbers.
    pub(super) const NOTHING: Self = Self {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    pub(super) fn observe(&mut self, value: f64) {
        (self.low, self.high) = (self.low.min(value), self.high.max(value));
    }

    /// Both ends; zeros when there are no numbers.
    fn ends(self) -> [f64; 2] {
        match self.low <= self.high {
            true => [self.low, self.high],
            false => [0.0, 0.0],
        }
    }

    /// The lower end, and a step that reaches from it to the upper one in `count` steps; 1 when they are
    /// equal.
    fn low_and_step(self, count: f64) -> [f64; 2] {
        let [low, high] = self.ends();
        let step = (high - low) / count;
        [low, if step > 0.0 { step } else { 1.0 }]
    }
}

/// How the values of a field become integers. On a linear scale a value is `low + q step` with 16 bits; on a
/// logarithmic one it is `10^(low + (q - 1) step)` with 8 bits, and `q = 0` is zero. Signed values and
/// magnitudes have 16 bits: up to 32767 as on a logarithmic scale, and the negative of `q - 32768` from 32768
/// on.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldScale {
    scale: Scale,
    /// The largest size of a value.
    largest: f64,
    /// The range of the values, of their logarithms, or of the logarithms of the sizes that are not
    /// negligible.
    range: Range,
}

impl FieldScale {
    pub(super) fn new(scale: Scale) -> Self {
        Self {
            scale,
            largest: 0.0,
            range: Range::NOTHING,
        }
    }

    /// Takes note of the sizes of some values, before any value goes to [`Self::observe`].
    pub(super) fn observe_sizes(&mut self, values: &[f64]) {
        let sizes = values.iter().map(|v| v.abs());
        self.largest = sizes.fold(self.largest, f64::max);
    }

    /// Takes note of some values.
    pub(super) fn observe(&mut self, values: &[f64]) {
        for &v in values {
            match self.scale {
                Scale::Linear => self.range.observe(v),
                Scale::Signed | Scale::Magnitude if !self.is_zero(v) => {
                    self.range.observe(v.abs().log10());
                }
                Scale::Logarithmic if v > 0.0 => self.range.observe(v.log10()),
                _ => {}
            }
        }
    }

    fn is_zero(&self, v: f64) -> bool {
        v.abs() <= NEGLIGIBLE * self.largest
    }

    /// The number that the smallest integer stands for, a decimal logarithm on a logarithmic scale, and what
    /// a step of one adds.
    pub(super) fn low_and_step(&self) -> [f64; 2] {
        self.range.low_and_step(match self.scale {
            Scale::Linear => LARGEST,
            Scale::Signed | Scale::Magnitude => SIZES - 1.0,
            Scale::Logarithmic => LOG_STEPS,
        })
    }

    /// Bytes of an integer.
    pub(super) fn bytes(&self) -> usize {
        match self.scale {
            Scale::Linear | Scale::Signed | Scale::Magnitude => 2,
            Scale::Logarithmic => 1,
        }
    }

    /// The integers of some values.
    pub(super) fn integers(&self, values: &[f64], integers: &mut Vec<u16>) {
        let [low, step] = self.low_and_step();
        let integer = |v: &f64| match self.scale {
            Scale::Linear => ((v - low) / step).round() as u16,
            Scale::Signed | Scale::Magnitude => match ((v.abs().log10() - low) / step).round() {
                _ if self.is_zero(*v) => 0,
                size if *v < 0.0 => 32769 + size as u16,
                size => 1 + size as u16,
            },
            Scale::Logarithmic if *v > 0.0 => 1 + ((v.log10() - low) / step).round() as u16,
            Scale::Logarithmic => 0,
        };
        integers.clear();
        integers.extend(values.iter().map(integer));
    }
}

/// How positions become integers: the range along each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionScale([Range; 3]);

impl PositionScale {
    pub(super) fn new() -> Self {
        Self([Range::NOTHING; 3])
    }

    /// Takes note of the positions of a frame.
    pub(super) fn observe(&mut self, x: &[f64]) {
        for (i, &c) in x.iter().enumerate() {
            self.0[i % 3].observe(c);
        }
    }

    /// Lower corner of the box of all positions, and the step, the same along all axes.
    pub(super) fn low_and_step(&self) -> ([f64; 3], f64) {
        let ends = self.0.map(Range::ends);
        let steps = self.0.map(|side| side.low_and_step(LARGEST)[1]);
        let lengths = ends.map(|[low, high]| high - low);
        let longest = (0..3).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]));
        let longest = longest.expect("space has three axes");
        (ends.map(|[low, _]| low), steps[longest])
    }

    /// The integers of a frame.
    pub(super) fn integers(&self, x: &[f64], integers: &mut Vec<u16>) {
        let (low, step) = self.low_and_step();
        let integer = |(i, v): (usize, &f64)| ((v - low[i % 3]) / step).round() as u16;
        integers.clear();
        integers.extend(x.iter().enumerate().map(integer));
    }
}
