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

/// Integers `q` that stand for numbers, row by row.
pub(super) struct Quantised {
    /// The number that the smallest integer stands for; a decimal logarithm on a logarithmic scale.
    pub(super) low: f64,
    /// What a step of one adds.
    pub(super) step: f64,
    /// Bytes of an integer.
    pub(super) bytes: usize,
    /// The integers.
    pub(super) rows: Vec<Vec<u16>>,
}

impl Quantised {
    fn of(
        rows: &[&Vec<f64>],
        low: f64,
        step: f64,
        bytes: usize,
        integer: impl Fn(&f64) -> u16,
    ) -> Self {
        let rows = rows.iter().map(|row| row.iter().map(&integer).collect());
        Self {
            low,
            step,
            bytes,
            rows: rows.collect(),
        }
    }
}

/// The smallest and the largest of the numbers; zeros when there are none.
pub(super) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// A step that reaches from `low` to `high` in `count` steps; 1 when they are equal.
fn step(low: f64, high: f64, count: f64) -> f64 {
    let step = (high - low) / count;
    if step > 0.0 { step } else { 1.0 }
}

/// The values of a field. On a linear scale a value is `low + q step` with 16 bits; on a logarithmic one it
/// is `10^(low + (q - 1) step)` with 8 bits, and `q = 0` is zero. Signed values and magnitudes have 16 bits:
/// up to 32767 as on a logarithmic scale, and the negative of `q - 32768` from 32768 on.
pub(super) fn quantise_field(rows: &[&Vec<f64>], scale: Scale) -> Quantised {
    let all = || rows.iter().flat_map(|row| row.iter().copied());
    match scale {
        Scale::Linear => {
            let (low, high) = range(all());
            let step = step(low, high, LARGEST);
            let integer = |v: &f64| ((v - low) / step).round() as u16;
            Quantised::of(rows, low, step, 2, integer)
        }
        Scale::Signed | Scale::Magnitude => {
            let largest = all().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            let least = NEGLIGIBLE * largest;
            let is_zero = |v: f64| v.abs() <= least;
            let sizes = all().filter(|&v| !is_zero(v)).map(|v| v.abs().log10());
            let (low, high) = range(sizes);
            let step = step(low, high, SIZES - 1.0);
            let integer = |v: &f64| match ((v.abs().log10() - low) / step).round() {
                _ if is_zero(*v) => 0,
                size if *v < 0.0 => 32769 + size as u16,
                size => 1 + size as u16,
            };
            Quantised::of(rows, low, step, 2, integer)
        }
        Scale::Logarithmic => {
            let (low, high) = range(all().filter(|&v| v > 0.0).map(f64::log10));
            let step = step(low, high, LOG_STEPS);
            let integer = |v: &f64| match *v > 0.0 {
                true => 1 + ((v.log10() - low) / step).round() as u16,
                false => 0,
            };
            Quantised::of(rows, low, step, 1, integer)
        }
    }
}

/// Positions of frames: lower corner of their box, the step (the same along all axes) and the integers.
pub(super) fn quantise_positions(frames: &[&Vec<f64>]) -> ([f64; 3], f64, Vec<Vec<u16>>) {
    let along = |axis| {
        let values = frames
            .iter()
            .flat_map(move |x| x.iter().skip(axis).step_by(3));
        range(values.copied())
    };
    let sides = [0, 1, 2].map(along);
    let low = sides.map(|(low, _)| low);
    let largest = sides
        .into_iter()
        .max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    let (from, to) = largest.expect("space has three axes");
    let step = step(from, to, LARGEST);
    let integers = |x: &&Vec<f64>| {
        let coordinates = x.iter().enumerate();
        coordinates
            .map(|(i, v)| ((v - low[i % 3]) / step).round() as u16)
            .collect()
    };
    (low, step, frames.iter().map(integers).collect())
}
