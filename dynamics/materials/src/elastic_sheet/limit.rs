//! The limit of the strain: the barrier at it, and what is beyond it.

/// A function of the square of a strain that keeps it below a limit `m`, or measures what is beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StrainLimit {
    law: Law,
    limit: f64,
    /// `kappa`, joules per square metre.
    stiffness: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    /// `kappa b(p)` with `p = (4 |E|^2 / m^2 - 1) / 3` and `b = -p^2 ln(1 - p)` for `0 < p < 1`, zero below:
    /// from half the limit on, infinite at the limit.
    Barrier,
    /// `kappa max(0, |E| - m)^2 / 2`.
    Excess,
}

impl StrainLimit {
    pub(super) fn new(limit: f64) -> Self {
        Self {
            law: Law::Barrier,
            limit,
            stiffness: 0.0,
        }
    }

    /// What is beyond the limit, with a stiffness in joules per square metre.
    pub(super) fn excess(self, stiffness: f64) -> Self {
        Self {
            law: Law::Excess,
            stiffness,
            ..self
        }
    }

    pub(super) fn limit(&self) -> f64 {
        self.limit
    }

    /// With a barrier of this stiffness beside its own, joules per square metre.
    pub(super) fn with_barrier(self, stiffness: f64) -> Self {
        Self {
            stiffness: self.stiffness + stiffness,
            ..self
        }
    }

    /// `p` and its derivative by the square of the strain.
    fn part(&self, squared: f64) -> [f64; 2] {
        let slope = 4.0 / (3.0 * self.limit * self.limit);
        [slope * squared - 1.0 / 3.0, slope]
    }

    /// The energy at the square of a strain, joules per square metre; that of the barrier is infinite at the
    /// limit and beyond.
    pub(super) fn value(&self, squared: f64) -> f64 {
        if let Law::Excess = self.law {
            let excess = (squared.sqrt() - self.limit).max(0.0);
            return 0.5 * self.stiffness * excess * excess;
        }
        let [p, _] = self.part(squared);
        if p <= 0.0 {
            0.0
        } else if p < 1.0 {
            -self.stiffness * p * p * (-p).ln_1p()
        } else {
            f64::INFINITY
        }
    }

    /// First and second derivative by the square of the strain, joules per square metre; the derivatives of
    /// the barrier are not numbers at the limit and beyond.
    pub(super) fn derivatives(&self, squared: f64) -> [f64; 2] {
        if let Law::Excess = self.law {
            let strain = squared.sqrt();
            let ratio = self.limit / strain;
            return match strain > self.limit {
                true => {
                    let first = 0.5 * self.stiffness * (1.0 - ratio);
                    [first, 0.25 * self.stiffness * ratio / squared]
                }
                false => [0.0; 2],
            };
        }
        let [p, slope] = self.part(squared);
        if p <= 0.0 {
            return [0.0; 2];
        }
        if p >= 1.0 || p.is_nan() {
            return [f64::NAN; 2];
        }
        let (ln, q) = ((-p).ln_1p(), 1.0 - p);
        let first = p * (p / q - 2.0 * ln);
        let second = p * (4.0 / q + p / (q * q)) - 2.0 * ln;
        [
            self.stiffness * first * slope,
            self.stiffness * second * slope * slope,
        ]
    }
}
