//! A spring with some slack.

/// A stress-strain law: a spring in series with a slack, which is pulled out to a bounded length by forces
/// that are large against `s_0`,
///
/// ```text
/// e = s / K + r s / (s_0 + s),
/// ```
///
/// for strains `e >= 0` with the stress `s`. Its slope rises from that of the two in series,
/// `1 / (1 / K + r / s_0)`, to `K`, and the strain is never more than `r` beyond `s / K`. The law is a
/// quadratic equation for the stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slack {
    /// `r`.
    pub(super) range: f64,
    /// `s_0`, newtons per metre.
    pub(super) force: f64,
}

/// Slack of a face in parts of its squared bend, and the force that pulls half of it out in parts of the
/// flexural rigidity over the squared size of the face.
///
/// A chord is shorter than its arc by 1/24 of its squared bend, so that the slack is seven times what a bend
/// explains: it lets a sheet bend further within a step. Slack that is pulled out by a small force lets
/// twisted ribbons and cones stretch; a small slack, and a large force, hinder bends that the mesh does not
/// resolve. Measured (80 sheets that are clamped along random lines; factorisations a step of these and of a
/// sheet of 289 vertices that hangs by a corner; the pull of a ribbon that is twisted by half a turn, on 2
/// and 4 squares across, over the exact one; the drop of a heavy strip with `Gamma` = 100, on 4 squares
/// across, against the elastica):
///
/// | slack | force | clamped: end | least depth | factorisations | hanging | ribbon 2 | ribbon 4 | drop |
/// |---|---|---|---|---|---|---|---|---|
/// | 0.1 | 5 | 80 | 0.67 | 6.2 | 12.7 | 0.86 | 1.02 | 0.008 |
/// | 0.1 | 20 | 80 | 0.66 | 5.8 | 11.5 | 1.07 | 1.08 | 0.007 |
/// | 0.1 | 80 | 80 | 0.67 | 5.5 | 9.1 | 1.30 | 1.11 | 0.007 |
/// | 0.3 | 5 | 80 | 0.72 | 6.1 | 12.9 | 0.26 | 0.84 | 0.008 |
/// | **0.3** | **20** | 80 | 0.67 | 5.7 | 11.1 | 0.59 | 1.00 | 0.007 |
/// | 0.3 | 80 | 80 | 0.66 | 5.5 | 11.2 | 1.01 | 1.09 | 0.007 |
/// | 1 | 5 | 80 | 0.89 | 6.0 | 12.9 | 0.05 | 0.47 | 0.008 |
/// | 1 | 20 | 80 | 0.73 | 5.8 | 11.5 | 0.19 | 0.79 | 0.008 |
/// | 1 | 80 | 80 | 0.67 | 5.5 | 10.8 | 0.54 | 1.01 | 0.007 |
///
/// The least depth is that over the depth with faces of at most 2000 `D / h^2`, which bend and stretch
/// freely; the next sheets are at 0.75 to 0.89. `cargo xtask locking --yardsticks slack` has cones and strips
/// that are pushed together.
const RANGE: f64 = 0.3;
const FORCE: f64 = 20.0;

/// The least stiffness with which slack is pulled out, in parts of the flexural rigidity over the squared
/// size of the face: it is more than the force above says where `(k h)^2` is above 2/15.
///
/// The slack of a face that bends by a radian is as wide as three tenths of its size, and without this the
/// weight of the sheet would pull it out. Measured with a [`TENSION`] of 5: area mean of the height of a
/// cloth of 1 m on a ball of 0.2 m (0.1 kg, 5e-5 N m, 3e5 N/m) on 289 and 1089 vertices, in metres; soft
/// sheets without slack come to -0.350 and -0.354 on 4225 and 16641. Largest errors of the energy of a strip
/// that is pushed together by 70 % on 4 and 8 squares across, and of cones with a wedge.
///
/// | stiffness | 289 | 1089 | strip | cones |
/// |---|---|---|---|---|
/// | 300 | | -0.365 | 0.067, 0.019 | |
/// | **500** | -0.366 | -0.362 | 0.110, 0.019 | |
/// | 1000 | -0.359 | -0.359 | 0.209, 0.018 | 0.018 |
const STIFFNESS: f64 = 500.0;

/// The tension up to which a face keeps all of its slack, in parts of the flexural rigidity over the squared
/// size of the face. Beyond, the slack is as wide as that tension over the tension.
///
/// A bend of the curvature `k` costs `D k^2 / 2`, and a tension `s` gains up to `s r` by its slack
/// `r = 0.3 (k h)^2`: no bend pays for itself if all of the slack is left up to 5/3 `D / h^2`. A bound as
/// small as that makes bends lock which move fast and which the mesh does not resolve, as their stresses look
/// like a tension. Measured: cotton, 0.3 m x 0.06 m, that is pulled by 1 N at the vertices of its end, on 4
/// and 8 squares across, extension over Hooke's law; factorisations (refused steps) of a sheet that swings
/// from a corner and of a cloth that falls on a ball, with limits of the strain of 5 and 1 %, 289 vertices, 1
/// s without damping. A film that is stretched by 5 % has the wrinkles of its material with all bounds, and
/// one ridge without.
///
/// | tension | cotton | swinging | falling, 5 % | 1 % |
/// |---|---|---|---|---|
/// | none | 1.54, 1.066 | 570 | 965 | |
/// | 50/3 | 1.21, 1.015 | 679 | 1097 | 1206 |
/// | 25/3 | 1.12, 1.009 | 764 | 1245 | 1242 |
/// | **20/3** | 1.09, 1.008 | 794 | 1195 | 1312 |
/// | 5 | 1.07, 1.007 | 816 | 2330 (9) | 1376 |
/// | 5/3 | 1.002, 1.004 | 1307 | 3072 (11) | 5082 (21) |
const TENSION: f64 = 20.0 / 3.0;

impl Slack {
    /// None: the spring alone.
    pub(super) const NONE: Self = Self {
        range: 0.0,
        force: 0.0,
    };

    /// Of a face of a squared size (m2) whose bend is `squared_bend`, of a sheet with a flexural rigidity (N
    /// m).
    pub(super) fn of_bend(rigidity: f64, squared_size: f64, squared_bend: f64) -> Self {
        let range = RANGE * squared_bend;
        Self {
            range,
            force: FORCE.max(STIFFNESS * range) * rigidity / squared_size,
        }
    }

    /// The part of the slack that a tension (N/m) leaves to a face, `min(1, 20/3 D / (h^2 s))`; all of it
    /// under pressure.
    pub(super) fn left_by(tension: f64, rigidity: f64, squared_size: f64) -> f64 {
        let bearable = TENSION * rigidity / squared_size;
        match tension > bearable {
            true => bearable / tension,
            false => 1.0,
        }
    }

    /// The stress at a strain, newtons per metre, in series with a spring.
    pub(super) fn force_at(&self, stiffness: f64, strain: f64) -> f64 {
        let Self { range, force } = *self;
        // `s^2 + (s_0 - K (e - r)) s - K e s_0 = 0`, without cancellation.
        let linear = stiffness * (strain - range) - force;
        let root = (linear * linear + 4.0 * stiffness * strain * force).sqrt();
        if linear > 0.0 {
            0.5 * (linear + root)
        } else if root > linear {
            2.0 * stiffness * strain * force / (root - linear)
        } else {
            0.0
        }
    }

    /// The energy at a stress with that of a spring, joules per square metre.
    pub(super) fn energy(&self, stiffness: f64, stress: f64) -> f64 {
        if stress == 0.0 {
            return 0.0;
        }
        0.5 * stress * stress / stiffness + self.stored(stress)
    }

    /// The energy at a stress, joules per square metre.
    pub(super) fn stored(&self, stress: f64) -> f64 {
        if self.range == 0.0 {
            return 0.0;
        }
        let part = stress / self.force;
        self.range * self.force * (part.ln_1p() - part / (1.0 + part))
    }

    /// What the slack yields at a stress, over that stress: `-d/ds` of its strain over the stress, metres per
    /// newton.
    pub(super) fn yields(&self, stress: f64) -> f64 {
        if self.range == 0.0 {
            return 0.0;
        }
        let pulled = self.force + stress;
        self.range * stress / (pulled * pulled)
    }

    /// The slope of the stress at a stress with a spring, newtons per metre.
    pub(super) fn slope(&self, stiffness: f64, stress: f64) -> f64 {
        if self.range == 0.0 {
            return stiffness;
        }
        let part = 1.0 + stress / self.force;
        1.0 / (1.0 / stiffness + self.range / (self.force * part * part))
    }

    /// Stress over strain with a spring, newtons per metre.
    pub(super) fn secant(&self, stiffness: f64, stress: f64) -> f64 {
        if self.range == 0.0 {
            return stiffness;
        }
        1.0 / (1.0 / stiffness + self.range / (self.force + stress))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: f64 = 3e3;
    const SLACK: Slack = Slack {
        range: 0.02,
        force: 0.5,
    };

    /// A bend of the curvature `k` costs `D k^2 / 2`; what a tension `s` gains by its slack is at most `2 D
    /// k^2`.
    #[test]
    fn a_tension_leaves_no_more_slack_than_a_bend_is_worth() {
        let (rigidity, size) = (5e-4, 0.02);
        for bend in [1e-8, 1e-4, 0.1, 2.0] {
            let all = Slack::of_bend(rigidity, size * size, bend).range;
            let curvature = bend / (size * size);
            for tension in [-1e3, 0.0, 1e-6, 1.0, 8.3, 8.4, 100.0, 1e6] {
                let left = Slack::left_by(tension, rigidity, size * size);
                assert!((0.0..=1.0).contains(&left));
                let gain = tension * left * all;
                assert!(
                    gain <= 2.0 * rigidity * curvature * (1.0 + 1e-12),
                    "{bend} {tension}: {gain}"
                );
                assert!(
                    left == 1.0 || gain > 1.99 * rigidity * curvature,
                    "{bend} {tension}: {gain}"
                );
            }
        }
    }

    #[test]
    fn the_stress_solves_the_law() {
        for range in [0.0, 1e-12, 1e-4, 0.02, 0.3] {
            let slack = Slack { range, ..SLACK };
            for strain in [0.0, 1e-12, 1e-6, 1e-3, 0.019, 0.02, 0.021, 0.4] {
                let s = slack.force_at(STIFFNESS, strain);
                let back = s / STIFFNESS + range * s / (slack.force + s);
                assert!((back - strain).abs() <= 1e-13 * strain, "{range} {strain}");
                assert!((slack.secant(STIFFNESS, s) * strain - s).abs() <= 1e-12 * s);
            }
        }
    }

    #[test]
    fn stress_and_slope_are_derivatives_of_the_energy() {
        for strain in [1e-4, 5e-3, 0.015, 0.0199, 0.0202, 0.03] {
            let step = 1e-4 * strain;
            let stress = |e: f64| SLACK.force_at(STIFFNESS, e);
            let energy = |e: f64| SLACK.energy(STIFFNESS, SLACK.force_at(STIFFNESS, e));
            let difference = |f: &dyn Fn(f64) -> f64| {
                let far = f(strain + 2.0 * step) - f(strain - 2.0 * step);
                (8.0 * (f(strain + step) - f(strain - step)) - far) / (12.0 * step)
            };
            let s = stress(strain);
            assert!((difference(&energy) / s - 1.0).abs() < 1e-6, "{strain}");
            assert!(
                (difference(&stress) / SLACK.slope(STIFFNESS, s) - 1.0).abs() < 1e-6,
                "{strain}"
            );
        }
    }

    #[test]
    fn a_spring_without_slack_is_linear() {
        let stress = Slack::NONE.force_at(7.0, 0.3);
        assert_eq!((stress, Slack::NONE.secant(7.0, 2.1)), (2.1, 7.0));
        assert!((Slack::NONE.energy(7.0, 2.1) - 0.5 * 7.0 * 0.09).abs() < 1e-15);
        let nothing = [Slack::NONE.force_at(0.0, 0.3), Slack::NONE.energy(0.0, 0.0)];
        assert_eq!(nothing, [0.0, 0.0]);
    }
}
