//! The heavy elastica: the shape of an inextensible strip that is clamped horizontally and hangs under its
//! own weight.

/// A heavy strip, for each metre of its width.
#[derive(Clone, Copy, Debug)]
pub struct Elastica {
    /// Free length, metres.
    pub length: f64,
    /// Flexural rigidity, newton metres.
    pub rigidity: f64,
    /// Weight per area, newtons per square metre.
    pub weight: f64,
}

/// Slope (radians, downwards), curvature (1/m), horizontal and downward place (metres) at an arc length, and
/// the integrals of half the square of the curvature (1/m) and of the downward place (m2) up to there.
type Point = [f64; 6];

/// The strip at rest, for each metre of its width.
#[derive(Clone, Copy, Debug)]
pub struct Hanging {
    /// Horizontal distance of the free end from the clamp, and how far it is below the clamp, metres.
    pub tip: [f64; 2],
    /// Energy of bending, joules per metre.
    pub bending: f64,
    /// Energy of bending plus the potential energy of the weight (zero at the height of the clamp), joules
    /// per metre.
    pub energy: f64,
}

impl Elastica {
    /// How far the free end hangs below the clamp, metres.
    ///
    /// With the slope `theta` below the horizontal at the arc length `s` from the clamp the moment of the
    /// part beyond gives
    ///
    /// ```text
    /// D theta'' = -q (L - s) cos theta,   theta(0) = 0,   theta'(L) = 0,
    /// ```
    ///
    /// (Love, *A treatise on the mathematical theory of elasticity*, Sec. 262 with the weight of the rod;
    /// Rohde, *Large deflections of a cantilever beam with uniformly distributed load*, 1953). The curvature
    /// at the clamp is found by bisection: the end slope of the elastica that hangs by its weight alone grows
    /// with it, and the moment at the clamp is at most `q L^2 / 2`. The equations are integrated by the
    /// classical Runge-Kutta method with step control by doubling.
    pub fn drop(&self) -> f64 {
        self.at_rest().tip[1]
    }

    /// Where the free end is and what energy the strip has; see [`Elastica::drop`].
    pub fn at_rest(&self) -> Hanging {
        let (mut low, mut high) = (
            0.0,
            0.5 * self.weight * self.length * self.length / self.rigidity,
        );
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if self.integrate(middle)[1] > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        let [.., x, drop, curvature, place] = self.integrate(0.5 * (low + high));
        let bending = self.rigidity * curvature;
        Hanging {
            tip: [x, drop],
            bending,
            energy: bending - self.weight * place,
        }
    }

    /// The end of the strip with the given curvature at the clamp.
    fn integrate(&self, curvature: f64) -> Point {
        let mut point = [0.0, curvature, 0.0, 0.0, 0.0, 0.0];
        let (mut s, mut h) = (0.0, self.length / 16.0);
        while s < self.length {
            h = h.min(self.length - s);
            let whole = self.step(s, &point, h);
            let half = self.step(s, &point, 0.5 * h);
            let halves = self.step(s + 0.5 * h, &half, 0.5 * h);
            // Slopes in radians, lengths relative to the strip.
            let scale = [1.0, self.length, 1.0 / self.length, 1.0 / self.length];
            let error = (0..4)
                .map(|k| (whole[k] - halves[k]).abs() * scale[k] / 15.0)
                .fold(0.0, f64::max);
            if error <= TOLERANCE || h < SHORTEST * self.length {
                s += h;
                point = halves;
            }
            let factor = 0.9 * (TOLERANCE / error.max(f64::MIN_POSITIVE)).powf(0.2);
            h = (h * factor.clamp(0.2, 4.0)).max(0.5 * SHORTEST * self.length);
            if self.length - s < 1e-14 * self.length {
                break;
            }
        }
        point
    }

    fn step(&self, s: f64, p: &Point, h: f64) -> Point {
        let add = |p: &Point, k: &Point, h: f64| std::array::from_fn(|i| p[i] + h * k[i]);
        let k1 = self.rate(s, p);
        let k2 = self.rate(s + 0.5 * h, &add(p, &k1, 0.5 * h));
        let k3 = self.rate(s + 0.5 * h, &add(p, &k2, 0.5 * h));
        let k4 = self.rate(s + h, &add(p, &k3, h));
        std::array::from_fn(|i| p[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    fn rate(&self, s: f64, p: &Point) -> Point {
        let (sin, cos) = p[0].sin_cos();
        let moment = self.weight * (self.length - s) * cos;
        let half_square = 0.5 * p[1] * p[1];
        [p[1], -moment / self.rigidity, cos, sin, half_square, p[3]]
    }
}

/// Halvings of the interval of the curvature at the clamp: to round-off.
const BISECTIONS: usize = 60;

/// Error of a step of the integration, relative to the strip.
const TOLERANCE: f64 = 1e-12;

/// Steps are not shortened below this part of the strip.
const SHORTEST: f64 = 1e-5;

#[cfg(test)]
mod tests {
    use super::*;

    /// The strip of the report: paper of 80 g/m2 under 9.8 m/s2, 0.3 m long.
    fn strip(rigidity: f64) -> Elastica {
        Elastica {
            length: 0.3,
            rigidity,
            weight: 0.08 * 9.8,
        }
    }

    /// Published and recomputed values: Bartels, Numer. Math. 124, 2013, ex. 6.1 (a strip of 4 with the
    /// weight 0.025 and unit rigidity), and the tip and the energy of bending for `q L^3 / D` = 1, 10, 100.
    #[test]
    fn known_strips_are_met() {
        let of = |length, weight| {
            let elastica = Elastica {
                length,
                rigidity: 1.0,
                weight,
            };
            elastica.at_rest()
        };
        let hanging = of(4.0, 0.025);
        assert!((hanging.energy + 1.5775e-2).abs() < 1e-6, "{hanging:?}");
        assert!((hanging.tip[0] - 3.9130).abs() < 1e-4 && (hanging.tip[1] - 0.7758).abs() < 1e-4);
        for (gamma, x, drop, bending) in [
            (1.0, 0.99125, 0.12347, 0.02458),
            (10.0, 0.65635, 0.70020, 1.1126),
            (100.0, 0.15922, 0.93752, 5.5),
        ] {
            let hanging = of(1.0, gamma);
            assert!((hanging.tip[0] - x).abs() < 1e-5, "{hanging:?}");
            assert!((hanging.tip[1] - drop).abs() < 1e-5, "{hanging:?}");
            assert!(
                (hanging.bending / bending - 1.0).abs() < 3e-4,
                "{hanging:?}"
            );
        }
    }

    /// The formula of small deflections, `q L^4 / (8 D)`, to second order in the deflection.
    #[test]
    fn small_deflections_follow_the_formula() {
        let deviation = |rigidity: f64| {
            let e = strip(rigidity);
            let small = e.weight * e.length.powi(4) / (8.0 * rigidity);
            e.drop() / small - 1.0
        };
        let [coarse, fine] = [0.2, 2.0].map(deviation);
        assert!(coarse.abs() < 1e-3 && fine.abs() < 1e-5, "{coarse} {fine}");
        assert!(
            (coarse / fine / 100.0 - 1.0).abs() < 0.01,
            "{coarse} {fine}"
        );
    }

    /// Values computed elsewhere, by another program.
    #[test]
    fn large_deflections_are_those_of_another_program() {
        assert!((strip(5e-3).drop() - 0.1329).abs() < 5e-5);
        assert!((strip(5e-4).drop() - 0.2695).abs() < 5e-5);
        assert!(strip(1e-6).drop() < 0.3);
    }
}
