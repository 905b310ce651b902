//! The law of a face: forces by strains, with slack.

use super::slack::Slack;
use crate::orthotropy::{PrincipalLaw, root};
use nalgebra::{Matrix3, Vector3};

/// A spring in the plane of a face, in series with a slack. Strains are given by three numbers, of which the
/// law is a quadratic form.
///
/// The slack has no direction: its size is measured by a norm of the strain that does not depend on the
/// direction, and so is the force that pulls it out. An isotropic spring has the law of [`Slack`] in this
/// norm. An orthotropic one has it in no norm: what the slack is pulled out to is then the minimum of the
/// energy of both over the strain `z` of the slack,
///
/// ```text
/// min_z  1/2 (e - z) : C (e - z) + psi(|z|),   psi'(r s / (s_0 + s)) = s.
/// ```
///
/// In components `y` in which `C` is diagonal, `c_i`, and the norm Euclidean the forces are `s_i = y_i / (1 /
/// c_i + r / (s_0 + s))` with `s = |(s_i)|`, one equation for `s`.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Law {
    Isotropic {
        /// `K`, N/m.
        stiffness: f64,
        /// The square of the norm of a strain.
        norm: Matrix3<f64>,
    },
    Orthotropic {
        /// `c_i`, N/m.
        stiffnesses: Vector3<f64>,
        /// The components `y` by the components of a strain.
        modes: Matrix3<f64>,
    },
}

/// Steps after which a root is as exact as numbers are: each halves an interval at least, and most do much
/// more.
const MOST_STEPS: usize = 80;

impl Law {
    /// Of Young's modulus times thickness (newtons per metre) and Poisson's ratio, by the components `(E_11,
    /// sqrt(2) E_12, E_22)` of Green's strain.
    pub(super) fn isotropic(stiffness: f64, poisson: f64) -> Self {
        Self::Isotropic {
            stiffness: stiffness / (1.0 - poisson * poisson),
            norm: PrincipalLaw::isotropic(poisson).over(1.0),
        }
    }

    /// Of forces by strains (newtons per metre), by the same components of Green's strain; `turn` gives those
    /// along the direction of the material. The norm of the slack is that of the isotropic law whose
    /// Poisson's ratio is the geometric mean of both, `C12^2 / (C11 C22)`.
    pub(super) fn orthotropic(law: PrincipalLaw, turn: &Matrix3<f64>) -> Self {
        let norm = root(&PrincipalLaw::isotropic(law.coupling / law.mean()).over(1.0));
        let inverse = norm.try_inverse();
        let inverse = inverse.expect("the root of a positive definite matrix");
        let own = (inverse * law.over(1.0) * inverse).symmetric_eigen();
        Self::Orthotropic {
            stiffnesses: own.eigenvalues,
            modes: own.eigenvectors.transpose() * norm * turn,
        }
    }

    /// That which resists nothing.
    pub(super) const NONE: Self = Self::Isotropic {
        stiffness: 0.0,
        norm: Matrix3::from_array_storage(nalgebra::ArrayStorage([[0.0; 3]; 3])),
    };

    /// This law in other numbers for the strain, from which the matrix `numbers` makes the numbers of this
    /// law.
    pub(super) fn by(self, numbers: &Matrix3<f64>) -> Self {
        match self {
            Self::Isotropic { stiffness, norm } => Self::Isotropic {
                stiffness,
                norm: numbers.transpose() * norm * numbers,
            },
            Self::Orthotropic { stiffnesses, modes } => Self::Orthotropic {
                stiffnesses,
                modes: modes * numbers,
            },
        }
    }

    /// `K`, N/m; that of the stiffest mode.
    pub(super) fn stiffness(&self) -> f64 {
        match self {
            Self::Isotropic { stiffness, .. } => *stiffness,
            Self::Orthotropic { stiffnesses, .. } => stiffnesses.max(),
        }
    }

    /// The trace of the quadratic form.
    pub(super) fn trace(&self) -> f64 {
        match self {
            Self::Isotropic { stiffness, norm } => stiffness * norm.trace(),
            Self::Orthotropic { stiffnesses, modes } => {
                let own = |k: usize| stiffnesses[k] * modes.row(k).norm_squared();
                own(0) + own(1) + own(2)
            }
        }
    }

    /// What a strain does to it.
    pub(super) fn pull(&self, strain: &Vector3<f64>, slack: &Slack) -> Pull {
        match self {
            Self::Isotropic { stiffness, norm } => {
                let size = strain.dot(&(norm * strain)).max(0.0).sqrt();
                let force = slack.force_at(*stiffness, size);
                Pull { size, force }
            }
            Self::Orthotropic { stiffnesses, modes } => {
                let components = modes * strain;
                let size = components.norm();
                let force = force(stiffnesses, &components, size, slack);
                Pull { size, force }
            }
        }
    }
}

/// The norms of a strain and of the force that it takes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pull {
    size: f64,
    /// N/m.
    force: f64,
}

/// A law at a strain.
#[derive(Clone, Copy)]
pub(super) struct At<'a> {
    pub(super) law: &'a Law,
    pub(super) strain: &'a Vector3<f64>,
    pub(super) slack: &'a Slack,
    /// The norms of this strain and of the force that it takes, with this slack, by the law.
    pub(super) pull: Pull,
}

impl At<'_> {
    /// Joules per square metre.
    pub(super) fn energy(&self) -> f64 {
        match self.law {
            Law::Isotropic { stiffness, .. } => self.slack.energy(*stiffness, self.pull.force),
            Law::Orthotropic { stiffnesses, modes } => {
                let components = modes * self.strain;
                let spring = |k: usize| {
                    let secant = self.slack.secant(stiffnesses[k], self.pull.force);
                    let force = secant * components[k];
                    0.5 * force * force / stiffnesses[k]
                };
                spring(0) + spring(1) + spring(2) + self.stored()
            }
        }
    }

    /// What the slack has of it, joules per square metre.
    pub(super) fn stored(&self) -> f64 {
        self.slack.stored(self.pull.force)
    }

    /// The derivatives of the energy by the strain.
    pub(super) fn slope(&self) -> Vector3<f64> {
        match self.law {
            Law::Isotropic { stiffness, norm } => {
                let secant = self.slack.secant(*stiffness, self.pull.force);
                secant * norm * self.strain
            }
            Law::Orthotropic { stiffnesses, modes } => {
                let secants = self.secants(stiffnesses);
                modes.tr_mul(&secants.component_mul(&(modes * self.strain)))
            }
        }
    }

    /// The second derivatives.
    pub(super) fn curvature(&self) -> Matrix3<f64> {
        match self.law {
            Law::Isotropic { stiffness, norm } => {
                let secant = self.slack.secant(*stiffness, self.pull.force);
                let mut law = secant * norm;
                if self.pull.size > 0.0 {
                    let along = norm * self.strain / self.pull.size;
                    let slope = self.slack.slope(*stiffness, self.pull.force);
                    law += (slope - secant) * along * along.transpose();
                }
                law
            }
            Law::Orthotropic { stiffnesses, modes } => {
                let secants = self.secants(stiffnesses);
                let mut law = Matrix3::from_diagonal(&secants);
                if self.pull.force > 0.0 {
                    // With `d / ds` of `r / (s_0 + s)` the derivative of the equation for `s`.
                    let forces = secants.component_mul(&(modes * self.strain)) / self.pull.force;
                    let along = secants.component_mul(&forces);
                    let yields = self.slack.yields(self.pull.force);
                    law += yields / (1.0 - yields * forces.dot(&along)) * along * along.transpose();
                }
                modes.transpose() * law * modes
            }
        }
    }

    fn secants(&self, stiffnesses: &Vector3<f64>) -> Vector3<f64> {
        stiffnesses.map(|c| self.slack.secant(c, self.pull.force))
    }
}

/// The force `s` of a spring with the stiffnesses `c_i` along the components `y` of a strain of a size: the
/// root of `|(y_i / (1 / c_i + r / (s_0 + s)))| = s`, between those for the smallest and the largest `c_i`
/// alone, by Newton's method and bisection.
fn force(stiffnesses: &Vector3<f64>, components: &Vector3<f64>, size: f64, slack: &Slack) -> f64 {
    let bound = |c: f64| slack.force_at(c, size);
    let (mut low, mut high) = (bound(stiffnesses.min()), bound(stiffnesses.max()));
    let mut force = high;
    for _ in 0..MOST_STEPS {
        let secants = stiffnesses.map(|c| slack.secant(c, force));
        let forces = secants.component_mul(components);
        let found = forces.norm();
        let rest = found - force;
        // What rounding makes of both.
        if rest.abs() <= f64::EPSILON * force {
            break;
        }
        match rest > 0.0 {
            true => low = force,
            false => high = force,
        }
        let direction = forces / found;
        let grows = slack.yields(force) * direction.dot(&secants.component_mul(&direction));
        let newton = force + rest / (1.0 - grows * found / force);
        let next = match newton > low && newton < high {
            true => newton,
            false => 0.5 * (low + high),
        };
        if next == force {
            break;
        }
        force = next;
    }
    force
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orthotropy::turn;

    impl Law {
        fn at<'a>(&'a self, strain: &'a Vector3<f64>, slack: &'a Slack) -> At<'a> {
            At {
                law: self,
                strain,
                slack,
                pull: self.pull(strain, slack),
            }
        }
    }

    /// A spring that is stiff along one direction and soft in shear.
    const CLOTH: PrincipalLaw = PrincipalLaw {
        along: 3e3,
        across: 1e3,
        coupling: 300.0,
        shear: 20.0,
    };
    const SLACK: Slack = Slack {
        range: 0.02,
        force: 0.5,
    };

    /// Strains from where the slack is hardly pulled out to where the spring alone is left.
    fn strains() -> impl Iterator<Item = Vector3<f64>> {
        [1e-5, 1e-3, 5e-3, 0.02, 0.3].into_iter().flat_map(|size| {
            let directions = [[1.0, 0.2, -0.3], [0.0, 1.0, 0.0], [-0.4, 0.1, 0.9]];
            directions.map(|d| size * Vector3::from(d))
        })
    }

    fn difference<T>(f: impl Fn(f64) -> T, step: f64) -> T
    where
        T: std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        let near = (f(step) - f(-step)) * 8.0;
        (near - (f(2.0 * step) - f(-2.0 * step))) * (1.0 / (12.0 * step))
    }

    #[test]
    fn slope_and_curvature_are_derivatives_of_the_energy() {
        for slack in [SLACK, Slack::NONE] {
            let law = Law::orthotropic(CLOTH, &turn(0.4));
            for strain in strains() {
                let at = law.at(&strain, &slack);
                let step = 1e-4 * strain.norm();
                for k in 0..3 {
                    let moved = |s: f64| strain + s * Vector3::ith(k, 1.0);
                    let energy = difference(|s| law.at(&moved(s), &slack).energy(), step);
                    let scale = at.slope().norm();
                    assert!((energy - at.slope()[k]).abs() < 1e-7 * scale, "{strain}");
                    let slope = difference(|s| law.at(&moved(s), &slack).slope(), step);
                    let error = slope - at.curvature().column(k);
                    assert!(error.norm() < 1e-7 * at.curvature().norm(), "{strain}");
                }
                let least = at.curvature().symmetric_eigenvalues().min();
                assert!(least > 0.0, "{least}");
            }
        }
    }

    #[test]
    fn without_slack_it_is_the_quadratic_form() {
        let law = Law::orthotropic(CLOTH, &Matrix3::identity());
        for strain in strains() {
            let expected = 0.5 * strain.dot(&(CLOTH.over(1.0) * strain));
            let energy = law.at(&strain, &Slack::NONE).energy();
            assert!((energy / expected - 1.0).abs() < 1e-13, "{strain}");
        }
    }

    #[test]
    fn an_isotropic_spring_is_a_special_case() {
        let (stiffness, poisson) = (700.0, 0.3);
        let isotropic = Law::isotropic(stiffness, poisson);
        let k = stiffness / (1.0 - poisson * poisson);
        let all = PrincipalLaw {
            along: k,
            across: k,
            coupling: poisson * k,
            shear: 0.5 * (1.0 - poisson) * k,
        };
        let same = Law::orthotropic(all, &turn(1.1));
        for strain in strains() {
            let [a, b] = [&isotropic, &same].map(|law| law.at(&strain, &SLACK));
            assert!((a.energy() / b.energy() - 1.0).abs() < 1e-12);
            assert!((a.slope() - b.slope()).norm() < 1e-12 * a.slope().norm());
            let error = (a.curvature() - b.curvature()).norm();
            assert!(error < 1e-11 * a.curvature().norm(), "{strain}");
        }
    }

    /// The slack is pulled out further than its range in no direction, however soft that is.
    #[test]
    fn the_strain_is_beyond_that_of_the_spring_by_less_than_the_range() {
        let law = Law::orthotropic(CLOTH, &Matrix3::identity());
        let compliance = CLOTH.over(1.0).try_inverse().unwrap();
        let norm = PrincipalLaw::isotropic(CLOTH.coupling / CLOTH.mean()).over(1.0);
        for strain in strains() {
            let beyond = strain - compliance * law.at(&strain, &SLACK).slope();
            let size = beyond.dot(&(norm * beyond)).sqrt();
            assert!(size < SLACK.range * (1.0 + 1e-9), "{size}");
        }
    }
}
