//! The barrier at the limit of the strain.

/// The barrier `kappa b(p)` of the square of a strain, `p = (4 |E|^2 / m^2 - 1) / 3`, `b = -p^2 ln(1 - p)`
/// for `0 < p < 1` and zero below: from half the limit `m` on, infinite at the limit.
#[derive(Debug, Clone, Copy)]
pub(super) struct StrainLimit {
    limit: f64,
    /// `kappa`, joules per square metre.
    stiffness: f64,
}

impl StrainLimit {
    pub(super) fn new(limit: f64) -> Self {
        Self {
            limit,
            stiffness: 0.0,
        }
    }

    pub(super) fn limit(&self) -> f64 {
        self.limit
    }

    pub(super) fn stiffness(&self) -> f64 {
        self.stiffness
    }

    pub(super) fn set_stiffness(&mut self, stiffness: f64) {
        self.stiffness = stiffness;
    }

    /// `p` and its derivative by the square of the strain.
    fn part(&self, squared: f64) -> [f64; 2] {
        let slope = 4.0 / (3.0 * self.limit * self.limit);
        [slope * squared - 1.0 / 3.0, slope]
    }

    /// The barrier at the square of a strain, joules per square metre; infinite at the limit and beyond.
    pub(super) fn value(&self, squared: f64) -> f64 {
        let [p, _] = self.part(squared);
        if p <= 0.0 {
            0.0
        } else if p < 1.0 {
            -self.stiffness * p * p * (-p).ln_1p()
        } else {
            f64::INFINITY
        }
    }

    /// First and second derivative by the square of the strain, joules per square metre; not numbers at the
    /// limit and beyond.
    pub(super) fn derivatives(&self, squared: f64) -> [f64; 2] {
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
