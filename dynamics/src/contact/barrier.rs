//! The barrier as a function of the gap.

use super::{BarrierError, ContactLaws, Stiffness};
use crate::{SheetModel, State};
use isosheet_materials::vectors::diameter;
use isosheet_model::{LoadScale, constant_acceleration};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Part of the activation distance that a loaded contact keeps.
const GAP_UNDER_LOAD: f64 = 0.5;

/// Vertices whose weight it carries.
const VERTICES_CARRIED: f64 = 100.0;

/// The barrier potential of a gap `g`, a distance less the thickness of the sheet: `phi(g) = kappa b(z)` with
/// the stiffness `kappa`, the activation distance `d_hat`, `z = (g / d_hat)^2` and
///
/// ```text
/// b = -(1 - z)^2 ln z   for 0 < z < 1,    0 for z >= 1,    infinite for z <= 0.
/// ```
///
/// It is twice continuously differentiable, decreasing and convex, and `b` is a function of a ratio alone: no
/// unit enters. Li et al. 2020 (Incremental potential contact, Eq. 6) up to the factor `d_hat^4`. A function
/// of the gap rather than of the distance, so that balls, capsules and their signed distances repel alike.
///
/// A simulation has one, from its start on: it is part of what has to be kept to resume a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BarrierPotential {
    activation: f64,
    stiffness: f64,
}

impl BarrierPotential {
    /// With an activation distance (metres) and a stiffness (joules).
    ///
    /// # Errors
    /// [`BarrierError`] unless both are positive.
    pub fn new(activation: f64, stiffness: f64) -> Result<Self, BarrierError> {
        if !(activation > 0.0 && activation.is_finite()) {
            return Err(BarrierError::Activation(activation));
        }
        // Second derivatives divide by the square of the range of squared gaps.
        let range = activation * activation;
        if !(range * range).is_normal() {
            return Err(BarrierError::Range(activation));
        }
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return Err(BarrierError::Stiffness(stiffness));
        }
        Ok(Self {
            activation,
            stiffness,
        })
    }

    /// The barrier of a simulation that starts at a state, see [`Stiffness`].
    ///
    /// # Errors
    /// [`BarrierError`] if the laws make no sense.
    pub fn at_start(
        laws: &ContactLaws,
        model: &SheetModel,
        state: &State,
    ) -> Result<Self, BarrierError> {
        match laws.stiffness {
            Stiffness::Joules(kappa) => Self::new(laws.activation, kappa),
            Stiffness::Automatic => {
                let acceleration = load(model, state);
                let unit = Self::new(laws.activation, 1.0)?;
                let force = unit.force(GAP_UNDER_LOAD * laws.activation);
                Self::new(
                    laws.activation,
                    VERTICES_CARRIED * model.mean_mass() * acceleration / force,
                )
            }
        }
    }

    /// Gap from which the barrier is zero, `d_hat`, metres.
    pub fn activation(&self) -> f64 {
        self.activation
    }

    /// The stiffness `kappa`, joules.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Joules; infinite at and below a gap of zero, and if the gap is not a number.
    pub fn value(&self, gap: f64) -> f64 {
        if gap > 0.0 {
            self.derivatives(gap)[0]
        } else {
            f64::INFINITY
        }
    }

    /// Value, first and second derivative by the gap: joules over powers of metres. At and below zero the
    /// value is infinite and the derivatives are not numbers.
    pub fn derivatives(&self, gap: f64) -> [f64; 3] {
        let [b, b1, b2] = self.by_squared_gap(gap * gap);
        let k = self.stiffness;
        [
            k * b,
            2.0 * k * gap * b1,
            k * (2.0 * b1 + 4.0 * gap * gap * b2),
        ]
    }

    /// `b` with its first and second derivative by the squared gap.
    fn by_squared_gap(&self, gap2: f64) -> [f64; 3] {
        let range = self.activation * self.activation;
        let z = gap2 / range;
        if z >= 1.0 {
            return [0.0; 3];
        }
        if z <= 0.0 {
            return [f64::INFINITY, f64::NAN, f64::NAN];
        }
        let (u, ln) = (1.0 - z, z.ln());
        [
            -u * u * ln,
            u * (2.0 * ln - u / z) / range,
            (-2.0 * ln + u * (3.0 * z + 1.0) / (z * z)) / (range * range),
        ]
    }

    /// Force along the normal, `-phi'`, newtons: not negative.
    pub fn force(&self, gap: f64) -> f64 {
        -self.derivatives(gap)[1]
    }
}

/// The acceleration that contact has to withstand, metres per second squared, see [`Stiffness::Automatic`].
fn load(model: &SheetModel, state: &State) -> f64 {
    let forces = largest_acceleration(model, state);
    // Where nothing is free to move, no force says how hard things will press once it is.
    if constant_acceleration(model, state).is_some() && forces.is_finite() && forces > 0.0 {
        return forces;
    }
    let LoadScale {
        acceleration,
        speed,
    } = LoadScale::at(model, state);
    let stopping = speed * speed / diameter(&state.x);
    let others = [forces, stopping].into_iter().filter(|a| a.is_finite());
    others.fold(acceleration, f64::max)
}

/// Largest acceleration of a vertex by the potentials but for the elasticity in the plane of the sheet, whose
/// forces on a start that is strained by round-off say nothing about loads; metres per second squared.
fn largest_acceleration(model: &SheetModel, state: &State) -> f64 {
    let mut gradient = vec![0.0; state.x.len()];
    let memories = model.memories();
    let potentials = model.potentials_at(state.t, &state.x, &memories);
    for (p, at) in potentials.take(model.next_potential()) {
        p.add_gradient(at, &mut gradient);
    }
    model.clear_pinned(&mut gradient);
    let per_mass = gradient.as_chunks::<3>().0.iter().zip(&model.mass().vertex);
    per_mass
        .map(|(f, m)| Vector3::from(*f).norm() / m)
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, generate};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        #[test]
        fn derivatives_match_differences(z in 1e-2..1.1_f64, size in -6.0..3.0_f64, kappa in 0.1..10.0_f64) {
            // The third derivative jumps where the barrier starts.
            prop_assume!((z - 1.0).abs() > 1e-3);
            let d_hat = 10.0_f64.powf(size);
            let b = BarrierPotential::new(d_hat, kappa).unwrap();
            let gap = z * d_hat;
            let [value, slope, curvature] = b.derivatives(gap);
            let h = 1e-5 * gap;
            prop_assert_eq!(value, b.value(gap));
            prop_assert_eq!(slope, -b.force(gap));
            let (up, down) = (b.derivatives(gap + h), b.derivatives(gap - h));
            let size = slope.abs() + 1e-3 * kappa / d_hat;
            prop_assert!(((up[0] - down[0]) / (2.0 * h) - slope).abs() < 1e-6 * size);
            let size = curvature + 1e-2 * kappa / (d_hat * d_hat);
            prop_assert!(((up[1] - down[1]) / (2.0 * h) - curvature).abs() < 1e-6 * size);
            // Decreasing and convex.
            prop_assert!(value >= 0.0 && slope <= 0.0 && curvature >= 0.0);
        }
    }

    #[test]
    fn joins_zero_twice_differentiably_and_ends_at_infinity() {
        let d_hat = 2e-3;
        let b = BarrierPotential::new(d_hat, 1.0).unwrap();
        for (k, scale) in [1.0, 1.0 / d_hat, 1.0 / (d_hat * d_hat)]
            .into_iter()
            .enumerate()
        {
            assert!(b.derivatives(d_hat * (1.0 - 1e-7))[k].abs() < 1e-5 * scale);
            assert_eq!(b.derivatives(d_hat * (1.0 + 1e-12))[k], 0.0);
        }
        assert_eq!(b.value(0.0), f64::INFINITY);
        assert_eq!(b.value(-1e-3), f64::INFINITY);
        assert_eq!(b.value(f64::NAN), f64::INFINITY);
        assert!(b.derivatives(0.0)[1].is_nan());
        // At half the range, by hand: (1/2)^2 ln 2.
        let half = b.value(0.5_f64.sqrt() * d_hat);
        assert!((half - 0.25 * 2.0_f64.ln()).abs() < 1e-12);
    }

    /// The stated value is that of the literature divided by `d_hat^4`.
    #[test]
    fn agrees_with_the_published_barrier() {
        let d_hat = 0.01_f64;
        let b = BarrierPotential::new(d_hat, 3.0).unwrap();
        for d in [1e-5, 1e-3, 0.005, 0.0099_f64] {
            let (y, h) = (d * d, d_hat * d_hat);
            let published = -3.0 * (y - h) * (y - h) * (y / h).ln();
            assert!((b.value(d) * h * h / published - 1.0).abs() < 1e-9);
        }
    }

    /// Integrating the force over the gap gives the energy back.
    #[test]
    fn work_of_the_force_is_the_energy() {
        let b = BarrierPotential::new(0.02, 2.0).unwrap();
        let (low, n) = (0.004, 20_000);
        let h = (b.activation() - low) / f64::from(n);
        let work: f64 = (0..n)
            .map(|i| b.force(low + (f64::from(i) + 0.5) * h) * h)
            .sum();
        assert!((work / b.value(low) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn values_that_make_no_sense_are_refused() {
        let error = |d, k| BarrierPotential::new(d, k).unwrap_err();
        assert_eq!(error(0.0, 1.0), BarrierError::Activation(0.0));
        assert!(matches!(error(f64::NAN, 1.0), BarrierError::Activation(_)));
        assert_eq!(error(1e-90, 1.0), BarrierError::Range(1e-90));
        assert_eq!(error(1.0, 0.0), BarrierError::Stiffness(0.0));
        assert!(matches!(
            error(1.0, f64::INFINITY),
            BarrierError::Stiffness(_)
        ));
    }

    #[test]
    fn a_given_stiffness_is_taken_and_an_automatic_one_scales_with_the_load() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let plain = || SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
        let state = State::at_rest(sheet.positions().to_vec());
        let laws = |stiffness| ContactLaws {
            stiffness,
            ..ContactLaws::frictionless(1e-3)
        };
        let given = BarrierPotential::at_start(&laws(Stiffness::Joules(2.0)), &plain(), &state);
        assert_eq!(given.unwrap().stiffness(), 2.0);
        let automatic = laws(Stiffness::Automatic);
        let at = |model| BarrierPotential::at_start(&automatic, &model, &state).unwrap();
        // Half the activation distance under the weight of a hundred vertices; gravity where there is no
        // load.
        let weight = 100.0 * 0.1 / 25.0 * 9.8;
        assert!((at(plain()).force(5e-4) / weight - 1.0).abs() < 1e-12);
        let ratio = at(plain().with_acceleration([0.0, 3.0, -4.0])).stiffness()
            / at(plain().with_gravity()).stiffness();
        assert!((ratio - 5.0 / 9.8).abs() < 1e-12);
    }
    /// Without weight, forces of stiff potentials that are round-off are no load.
    #[test]
    fn a_load_without_weight_is_that_of_inertia() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let plate = crate::PlateBending::new(&sheet, 1.0).unwrap();
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .unwrap()
            .with_potential(plate)
            .with_elastic_sheet(crate::ElasticSheet::new(&sheet, 3e5, 0.3).unwrap())
            .unwrap();
        let mut state = State::at_rest(sheet.positions().iter().map(|x| x + 0.1).collect());
        let round_off = largest_acceleration(&model, &state);
        assert!(round_off > 0.0 && round_off < 1e-6, "{round_off}");
        assert!((load(&model, &state) - 9.8).abs() < 1e-12);
        state.v.fill(10.0);
        let stopping = 300.0 / 2.0_f64.sqrt();
        assert!((load(&model, &state) - stopping).abs() < 1e-9 * stopping);
    }
}
